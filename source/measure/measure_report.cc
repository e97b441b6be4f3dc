// SPDX-License-Identifier: MIT
#include "measure_report.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace gnomon::measure {

double median(std::vector<double> values)
{
  if (values.empty()) {
    return 0.0;
  }
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

double spread(std::vector<double> values)
{
  const double center = median(values);
  if (values.size() < 2 || center <= 0.0) {
    return 0.0;
  }
  std::ranges::sort(values);
  const auto quantile = [&values](double share) {
    const double at = share * double(values.size() - 1);
    const auto low = std::size_t(at);
    const std::size_t high = std::min(low + 1, values.size() - 1);
    return std::lerp(values[low], values[high], at - double(low));
  };
  return 0.5 * (quantile(0.75) - quantile(0.25)) / center;
}

double step_seconds(const TechniqueReport &report, const std::string &step)
{
  std::vector<double> seconds;
  for (const std::map<std::string, double> &round : report.step_seconds) {
    double sum = 0.0;
    for (const auto &[name, value] : round) {
      sum += step.empty() || name == step ? value : 0.0;
    }
    seconds.push_back(sum);
  }
  return median(seconds);
}

reference::VisibilityError all_lamps(const std::vector<LampError> &lamps)
{
  reference::VisibilityError sum;
  double absolute = 0.0;
  for (const LampError &lamp : lamps) {
    const reference::VisibilityError &one = lamp.error;
    absolute += one.mean_absolute_error * double(one.facing_count);
    sum.receiver_count += one.receiver_count;
    sum.off_surface_count += one.off_surface_count;
    sum.facing_count += one.facing_count;
    sum.non_finite_count += one.non_finite_count;
    sum.wrong_count += one.wrong_count;
    sum.leak_count += one.leak_count;
    sum.acne_count += one.acne_count;
    sum.edge_count += one.edge_count;
    sum.edge_offset_median = std::max(sum.edge_offset_median, one.edge_offset_median);
    sum.edge_offset_p95 = std::max(sum.edge_offset_p95, one.edge_offset_p95);
    sum.edge_offset_max = std::max(sum.edge_offset_max, one.edge_offset_max);
  }
  if (sum.facing_count > 0) {
    sum.mean_absolute_error = absolute / double(sum.facing_count);
    sum.wrong_fraction = double(sum.wrong_count) / double(sum.facing_count);
  }
  return sum;
}

void find_front(SceneReport &report)
{
  std::vector<PictureReport *> pictures;
  for (TechniqueReport &technique : report.techniques) {
    for (PictureReport &picture : technique.pictures) {
      picture.is_on_front = false;
      if (std::isfinite(picture.error.rmse) && !picture.seconds.empty()) {
        pictures.push_back(&picture);
      }
    }
  }
  std::ranges::sort(pictures, {},
                    [](const PictureReport *one) { return std::pair(median(one->seconds), one->error.rmse); });
  double best = std::numeric_limits<double>::infinity();
  for (PictureReport *picture : pictures) {
    picture->is_on_front = picture->error.rmse < best;
    best = std::min(best, picture->error.rmse);
  }
}

std::optional<double> convergence_order(const std::vector<glm::dvec2> &points)
{
  double sx = 0.0;
  double sy = 0.0;
  double sxx = 0.0;
  double sxy = 0.0;
  for (const glm::dvec2 &point : points) {
    if (!(point.y > 0.0)) {
      return std::nullopt;
    }
    const double x = std::log(point.x);
    const double y = std::log(point.y);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  const auto n = double(points.size());
  return points.size() > 1 ? std::optional(-(n * sxy - sx * sy) / (n * sxx - sx * sx)) : std::nullopt;
}

std::vector<Convergence> convergence(const SceneReport &report)
{
  std::vector<Convergence> all;
  for (const TechniqueReport &first : report.techniques) {
    const std::string &name = first.technique.name;
    if (!all.empty() && all.back().technique == name) {
      continue;
    }
    std::vector<glm::dvec2> by_size;
    std::vector<glm::dvec2> by_samples;
    for (const TechniqueReport &one : report.techniques) {
      if (one.technique.name != name) {
        continue;
      }
      by_size.emplace_back(one.technique.size_px, all_lamps(one.lamps).wrong_fraction);
      by_samples.clear();
      for (const PictureReport &picture : one.pictures) {
        by_samples.emplace_back(picture.sample_count, picture.error.rmse);
      }
    }
    all.push_back({name, convergence_order(by_size), convergence_order(by_samples)});
  }
  return all;
}

namespace {

/** JSON has no NaN; it is written as null. */
nlohmann::json number(double value)
{
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

double number(const nlohmann::json &json)
{
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

nlohmann::json to_json(const reference::VisibilityError &e)
{
  return {{"receivers", e.receiver_count},
          {"off_surface", e.off_surface_count},
          {"facing", e.facing_count},
          {"non_finite", e.non_finite_count},
          {"wrong", e.wrong_count},
          {"leak", e.leak_count},
          {"acne", e.acne_count},
          {"edge", e.edge_count},
          {"wrong_fraction", number(e.wrong_fraction)},
          {"mean_absolute_error", number(e.mean_absolute_error)},
          {"edge_offset_median", number(e.edge_offset_median)},
          {"edge_offset_p95", number(e.edge_offset_p95)},
          {"edge_offset_max", number(e.edge_offset_max)}};
}

reference::VisibilityError visibility_from_json(const nlohmann::json &json)
{
  reference::VisibilityError e;
  json.at("receivers").get_to(e.receiver_count);
  json.at("off_surface").get_to(e.off_surface_count);
  json.at("facing").get_to(e.facing_count);
  json.at("non_finite").get_to(e.non_finite_count);
  json.at("wrong").get_to(e.wrong_count);
  json.at("leak").get_to(e.leak_count);
  json.at("acne").get_to(e.acne_count);
  json.at("edge").get_to(e.edge_count);
  e.wrong_fraction = number(json.at("wrong_fraction"));
  e.mean_absolute_error = number(json.at("mean_absolute_error"));
  e.edge_offset_median = number(json.at("edge_offset_median"));
  e.edge_offset_p95 = number(json.at("edge_offset_p95"));
  e.edge_offset_max = number(json.at("edge_offset_max"));
  return e;
}

nlohmann::json to_json(const TechniqueReport &report)
{
  nlohmann::json pictures = nlohmann::json::array();
  for (const PictureReport &picture : report.pictures) {
    pictures.push_back({{"samples", picture.sample_count},
                        {"seconds", picture.seconds},
                        {"seconds_median", median(picture.seconds)},
                        {"seconds_spread", spread(picture.seconds)},
                        {"rmse", number(picture.error.rmse)},
                        {"relative_mse", number(picture.error.relative_mse)},
                        {"p99", number(picture.error.p99)},
                        {"flip", number(picture.error.flip)},
                        {"non_finite", picture.error.non_finite_count},
                        {"front", picture.is_on_front}});
  }
  nlohmann::json lamps = nlohmann::json::array();
  for (const LampError &lamp : report.lamps) {
    lamps.push_back({{"lamp", lamp.lamp}, {"visibility", to_json(lamp.error)}});
  }
  return {{"technique", report.technique.name},
          {"size_px", report.technique.size_px},
          {"options", report.technique.options},
          {"pictures", pictures},
          {"step_seconds", report.step_seconds},
          {"visibility", to_json(all_lamps(report.lamps))},
          {"lamps", lamps},
          {"memory_bytes", report.memory_bytes},
          {"limits", report.limits},
          {"lost_shadows", report.lost_shadow_count}};
}

TechniqueReport technique_from_json(const nlohmann::json &json)
{
  TechniqueReport report;
  const Technique wanted{json.at("technique"), json.at("size_px"), {}, {}, {}};
  for (const Technique &one : report_techniques()) {
    if (label(one) == label(wanted)) {
      report.technique = one;
    }
  }
  if (report.technique.name.empty()) {
    throw std::runtime_error(fmt::format("no technique is called '{}'", label(wanted)));
  }
  json.at("step_seconds").get_to(report.step_seconds);
  for (const nlohmann::json &picture : json.at("pictures")) {
    PictureReport &one = report.pictures.emplace_back();
    picture.at("samples").get_to(one.sample_count);
    picture.at("seconds").get_to(one.seconds);
    one.error.rmse = number(picture.at("rmse"));
    one.error.relative_mse = number(picture.at("relative_mse"));
    one.error.p99 = number(picture.at("p99"));
    one.error.flip = number(picture.at("flip"));
    picture.at("non_finite").get_to(one.error.non_finite_count);
    picture.at("front").get_to(one.is_on_front);
    if (one.seconds.size() != report.step_seconds.size()) {
      throw std::runtime_error(
          fmt::format("'{}' has different numbers of rounds for its pictures and its steps", label(wanted)));
    }
  }
  if (!std::ranges::equal(report.pictures, report.technique.sample_counts, {}, &PictureReport::sample_count)) {
    throw std::runtime_error(fmt::format("'{}' has numbers of samples that differ from this program's", label(wanted)));
  }
  for (const nlohmann::json &lamp : json.at("lamps")) {
    report.lamps.push_back({lamp.at("lamp"), visibility_from_json(lamp.at("visibility"))});
  }
  json.at("memory_bytes").get_to(report.memory_bytes);
  json.at("limits").get_to(report.limits);
  json.at("lost_shadows").get_to(report.lost_shadow_count);
  return report;
}

nlohmann::json to_json(const SceneReport &report)
{
  nlohmann::json techniques = nlohmann::json::array();
  for (const TechniqueReport &technique : report.techniques) {
    techniques.push_back(to_json(technique));
  }
  const auto order = [](const std::optional<double> &one) { return one ? nlohmann::json(*one) : nlohmann::json(); };
  nlohmann::json orders = nlohmann::json::object();
  for (const Convergence &one : convergence(report)) {
    orders[one.technique] = {{"visibility_by_size", order(one.visibility_by_size)},
                             {"rmse_by_samples", order(one.rmse_by_samples)}};
  }
  return {{"scene", report.name},
          {"path", report.path.string()},
          {"fingerprint", report.fingerprint},
          {"world", report.world},
          {"reference_noise", report.reference_noise},
          {"reference_seconds", report.reference_seconds},
          {"warnings", report.warnings},
          {"techniques", techniques},
          {"convergence_order", orders}};
}

SceneReport scene_from_json(const nlohmann::json &json)
{
  SceneReport report;
  json.at("scene").get_to(report.name);
  report.path = json.at("path").get<std::string>();
  json.at("fingerprint").get_to(report.fingerprint);
  json.at("world").get_to(report.world);
  json.at("reference_noise").get_to(report.reference_noise);
  json.at("reference_seconds").get_to(report.reference_seconds);
  json.at("warnings").get_to(report.warnings);
  for (const nlohmann::json &technique : json.at("techniques")) {
    report.techniques.push_back(technique_from_json(technique));
  }
  return report;
}

}  // namespace

std::string specular_text(const RunReport &run)
{
  return run.has_multiscatter ? "multi" : "single";
}

nlohmann::json to_json(const RunReport &run)
{
  nlohmann::json scenes = nlohmann::json::array();
  for (const SceneReport &scene : run.scenes) {
    scenes.push_back(to_json(scene));
  }
  return {{"program", run.program},
          {"commit", run.commit},
          {"build", run.build},
          {"device", run.device},
          {"machine", run.machine},
          {"date", run.date},
          {"size", {run.size_px.x, run.size_px.y}},
          {"rounds", run.rounds},
          {"reference_samples", run.reference_samples},
          {"specular", specular_text(run)},
          {"seconds", run.seconds},
          {"scenes", scenes}};
}

RunReport run_from_json(const nlohmann::json &json)
{
  RunReport run;
  json.at("program").get_to(run.program);
  json.at("commit").get_to(run.commit);
  json.at("build").get_to(run.build);
  json.at("device").get_to(run.device);
  json.at("machine").get_to(run.machine);
  json.at("date").get_to(run.date);
  run.size_px = {json.at("size").at(0).get<int>(), json.at("size").at(1).get<int>()};
  json.at("rounds").get_to(run.rounds);
  json.at("reference_samples").get_to(run.reference_samples);
  run.has_multiscatter = json.at("specular") == "multi";
  json.at("seconds").get_to(run.seconds);
  for (const nlohmann::json &scene : json.at("scenes")) {
    run.scenes.push_back(scene_from_json(scene));
    for (const TechniqueReport &technique : run.scenes.back().techniques) {
      if (technique.step_seconds.size() > std::size_t(std::max(run.rounds, 0))) {
        throw std::runtime_error(fmt::format("'{}' has more rounds than the run", label(technique.technique)));
      }
    }
  }
  return run;
}

std::string to_text(const SceneReport &scene)
{
  std::string text = fmt::format(
      "\n{}{}, reference's noise {:.5f}; * on the front of time and RMSE\n{:24} {:>10} {:>9} {:>8} "
      "{:>8} {:>8} {:>5} {:>5}  RMSE (ms) at 1, 4, 16 and 64 samples\n",
      scene.name, scene.world.empty() ? "" : ", world: " + scene.world, scene.reference_noise, "technique",
      "shadows ms", "sample ms", "MiB", "wrong %", "error %", "leak", "acne");
  for (const TechniqueReport &one : scene.techniques) {
    const reference::VisibilityError e = all_lamps(one.lamps);
    const double shadows = step_seconds(one, "shadows");
    text += fmt::format("{:24} {:10.1f} {:9.1f} {:8.1f} {:8.4f} {:8.4f} {:5} {:5} ", label(one.technique),
                        1e3 * shadows, 1e3 * (step_seconds(one, "") - shadows), double(one.memory_bytes) / 0x1p20,
                        100.0 * e.wrong_fraction, 100.0 * e.mean_absolute_error, e.leak_count, e.acne_count);
    for (const PictureReport &picture : one.pictures) {
      text += fmt::format(" {:.5f} ({:.1f}){}", picture.error.rmse, 1e3 * median(picture.seconds),
                          picture.is_on_front ? "*" : " ");
    }
    text += "\n";
  }
  const auto order = [](const std::optional<double> &one) { return one ? fmt::format("{:.2f}", -*one) : "-"; };
  for (const Convergence &one : convergence(scene)) {
    text += fmt::format("{}: wrong pixels as size^{}, RMSE as samples^{}\n", one.technique,
                        order(one.visibility_by_size), order(one.rmse_by_samples));
  }
  return text;
}

std::string csv_quoted(std::string text)
{
  for (std::size_t at = text.find('"'); at != std::string::npos; at = text.find('"', at + 2)) {
    text.insert(at, 1, '"');
  }
  text.insert(0, 1, '"');
  text += '"';
  return text;
}

std::string to_csv(const RunReport &run)
{
  std::string csv =
      "scene,technique,size_px,samples,seconds_median,seconds_spread,shadow_device_seconds,sample_device_seconds,"
      "memory_bytes,rmse,relative_mse,p99,flip,front,wrong_fraction,mean_absolute_error,facing,wrong,leak,"
      "acne,"
      "edge_offset_median,edge_offset_p95,edge_offset_max,non_finite,lost_shadows\n";
  for (const SceneReport &scene : run.scenes) {
    for (const TechniqueReport &one : scene.techniques) {
      const reference::VisibilityError e = all_lamps(one.lamps);
      const double shadows = step_seconds(one, "shadows");
      for (const PictureReport &picture : one.pictures) {
        csv += fmt::format(
            "{},{},{},{},{:.6f},{:.4f},{:.6f},{:.6f},{},{:.8f},{:.8g},{:.8f},{:.8f},{},", csv_quoted(scene.name),
            csv_quoted(one.technique.name), one.technique.size_px, picture.sample_count, median(picture.seconds),
            spread(picture.seconds), shadows, step_seconds(one, "") - shadows, one.memory_bytes, picture.error.rmse,
            picture.error.relative_mse, picture.error.p99, picture.error.flip, picture.is_on_front ? 1 : 0);
        csv += fmt::format("{:.8f},{:.8f},{},{},{},{},{},{},{},{},{}\n", e.wrong_fraction, e.mean_absolute_error,
                           e.facing_count, e.wrong_count, e.leak_count, e.acne_count, e.edge_offset_median,
                           e.edge_offset_p95, e.edge_offset_max, e.non_finite_count + picture.error.non_finite_count,
                           one.lost_shadow_count);
      }
    }
  }
  return csv;
}

std::string picture_file(const SceneReport &scene, const Technique &technique, int sample_count)
{
  std::string name = label(technique);
  std::ranges::replace_if(
      name, [](char c) { return c == ' ' || c == ':' || c == ','; }, '_');
  return fmt::format("{}-{}-{}.exr", scene.name, name, sample_count);
}

std::string reference_file(const SceneReport &scene)
{
  return scene.name + "-reference.exr";
}

}  // namespace gnomon::measure
