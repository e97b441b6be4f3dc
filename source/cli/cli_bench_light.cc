// SPDX-License-Identifier: MIT
#include "cli_bench.hh"

#include "measure_furnace.hh"
#include "measure_light.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <string>
#include <utility>
#include <vector>

namespace gnomon::cli {

namespace {

nlohmann::json errors_json(const measure::LightErrors &errors)
{
  return {{"median", errors.median}, {"p95", errors.p95}, {"largest", errors.largest}, {"bad", errors.bad_count}};
}

/** The approximations of a row, with their names. */
std::vector<std::pair<std::string, measure::LightErrors>> columns_of(const measure::LightErrorRow &row)
{
  if (row.light == "diffuse") {
    return {{"form factor", row.whole}, {"all light from the centre", row.point}};
  }
  return {{"transformed cosines", row.whole},
          {"transformed cosines, multi", row.multi},
          {"representative point", row.point}};
}

/** Prints the table of measure::white_furnace. \return the same as JSON */
nlohmann::json print_furnace()
{
  fmt::print(
      "\nWhite furnace: radiance that a white surface sends to viewers at 0 to 87 deg to its normal, in a world of "
      "radiance\n1. single, multi: integrals of the BRDF. multi, sun: one frame under a sun with an angle of 180 "
      "deg.\n\n{:<10} {:>9}  {:>17}  {:>17}  {:>17}\n",
      "", "roughness", "single", "multi", "multi, sun");
  const auto text = [](const measure::FurnaceRange &range) {
    return fmt::format("{:.4f} to {:.4f}", range.least, range.largest);
  };
  const auto json_of = [](const measure::FurnaceRange &range) { return nlohmann::json{range.least, range.largest}; };
  nlohmann::json json = nlohmann::json::array();
  constexpr int point_count = 512;
  for (const measure::FurnaceRow &row : measure::white_furnace(point_count)) {
    fmt::print("{:<10} {:>9g}  {:>17}  {:>17}  {:>17}\n", row.material, row.roughness, text(row.single),
               text(row.multi), text(row.multi_sun));
    json.push_back({{"material", row.material},
                    {"roughness", row.roughness},
                    {"single", json_of(row.single)},
                    {"multi", json_of(row.multi)},
                    {"multi_sun", json_of(row.multi_sun)}});
  }
  return json;
}

}  // namespace

Status bench_light(const BenchOptions &options)
{
  const std::vector<measure::LightErrorRow> rows = measure::light_errors(options.points);
  fmt::print(
      "Light of a whole lamp in one frame, without shadows: errors against numerical integration, relative to the\n"
      "integral, or to 1 % of the largest integral of the same lamp, size, distance and roughness if that is more. "
      "Lamps\n"
      "face the shaded point. size: half the longer axis, or the radius. elevation: of the centre. {} points an "
      "integral;\n"
      "+-: largest standard error of the integrals. bad: results that are negative or not finite. multi: with\n"
      "--specular multi, without the light that is scattered again. The last approximation is a baseline, which the "
      "engine\ndoes not use.\n",
      2 * measure::integral_set_count * options.points);
  nlohmann::json json = nlohmann::json::array();
  std::size_t bad_count = 0;
  std::string light;
  for (const measure::LightErrorRow &row : rows) {
    if (row.light != light) {
      light = row.light;
      fmt::print("\n{:<20} {:>5} {:>8}", light, "", "");
      for (const auto &[name, errors] : columns_of(row)) {
        fmt::print("  {:<32}", name);
      }
      fmt::print("\n{:<20} {:>5} {:>8}", "", "cases", "+-");
      for (std::size_t i = 0; i < columns_of(row).size(); i++) {
        fmt::print("  {:>8} {:>8} {:>8} {:>5}", "median", "p95", "largest", "bad");
      }
      fmt::print("\n");
    }
    fmt::print("{:<20} {:>5} {:>8.5f}", row.parameter + " " + row.value, row.case_count, row.integral_error);
    for (const auto &[name, errors] : columns_of(row)) {
      fmt::print("  {:>8.5f} {:>8.5f} {:>8.5f} {:>5}", errors.median, errors.p95, errors.largest, errors.bad_count);
    }
    fmt::print("\n");
    bad_count += row.whole.bad_count + row.multi.bad_count;
    json.push_back({{"light", row.light},
                    {"parameter", row.parameter},
                    {"value", row.value},
                    {"cases", row.case_count},
                    {"integral_error", row.integral_error},
                    {"whole", errors_json(row.whole)},
                    {"multi", errors_json(row.multi)},
                    {"point", errors_json(row.point)}});
  }
  const nlohmann::json furnace = print_furnace();
  write_json(options.json, {{"program", "gnomon " GNOMON_VERSION},
                            {"bench", "light"},
                            {"points", options.points},
                            {"rows", json},
                            {"furnace", furnace}});
  return bad_count > 0 ? Status::NonFinite : Status::Done;
}

}  // namespace gnomon::cli
