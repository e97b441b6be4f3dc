// SPDX-License-Identifier: MIT
#include "cli.hh"

#include "cli_device.hh"
#include "cli_origin.hh"
#include "cli_output.hh"
#include "cli_system.hh"

#include "measure_page.hh"
#include "measure_report.hh"
#include "verify_stability.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <span>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

struct StabilityOptions {
  std::string folder;
  std::string group;
  std::string backend = "auto";
};

struct CaseResult {
  verify::StabilityCase one;
  verify::StabilityResult result;
};

std::vector<std::string> groups_of(const std::vector<verify::StabilityCase> &cases)
{
  std::vector<std::string> groups;
  for (const verify::StabilityCase &one : cases) {
    if (std::ranges::find(groups, one.group) == groups.end()) {
      groups.push_back(one.group);
    }
  }
  return groups;
}

bool is_rendered(const std::string &group)
{
  return group.rfind(verify::image_group_prefix, 0) == 0;
}

/** The cases of the group that is asked for, or all, sorted by group. Creates \a device if a case needs one. */
std::vector<verify::StabilityCase> chosen_cases(const StabilityOptions &options, std::unique_ptr<gpu::Device> &device)
{
  const std::string &group = options.group;
  std::vector<verify::StabilityCase> cases = verify::function_stability_cases();
  const auto append = [&cases](std::vector<verify::StabilityCase> more) {
    cases.insert(cases.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  };
  append(verify::input_stability_cases());
  if (group.empty() || is_rendered(group)) {
    device = create_device(options.backend);
    append(verify::image_stability_cases(*device));
  }
  const std::vector<std::string> groups = groups_of(cases);
  if (!group.empty()) {
    if (std::ranges::find(groups, group) == groups.end()) {
      throw UsageError(fmt::format("no group '{}' of cases; there are: {}", group, fmt::join(groups, ", ")));
    }
    std::erase_if(cases, [&](const verify::StabilityCase &one) { return one.group != group; });
  }
  std::ranges::stable_sort(cases, {},
                           [&](const verify::StabilityCase &one) { return std::ranges::find(groups, one.group); });
  return cases;
}

std::vector<CaseResult> run_all(std::vector<verify::StabilityCase> cases)
{
  std::vector<CaseResult> results;
  for (verify::StabilityCase &one : cases) {
    verify::StabilityResult result = verify::run(one);
    results.push_back({std::move(one), std::move(result)});
    if (stderr_is_terminal()) {
      const bool is_last = results.size() == cases.size();
      print_message("\r{}/{} cases{}", results.size(), cases.size(), is_last ? "\r\033[K" : "");
    }
  }
  return results;
}

/** Counts over some cases. */
struct Summary {
  std::size_t cases = 0;
  std::size_t passed = 0;
  /** Included in passed. */
  std::size_t baselines = 0;
  std::size_t failed = 0;
  /** Baselines are not counted. */
  std::size_t non_finite = 0;
  /** Largest ratio of error to bound. Baselines and cases with a bound of 0 do not count. */
  double worst_share = 0.0;
};

Summary summary_of(std::span<const CaseResult> results)
{
  Summary summary;
  for (const auto &[one, result] : results) {
    summary.cases++;
    (result.is_passed ? summary.passed : summary.failed)++;
    if (one.is_baseline) {
      summary.baselines += result.is_passed ? 1 : 0;
      continue;
    }
    summary.non_finite += result.non_finite_count > 0 ? 1 : 0;
    if (one.bound > 0.0) {
      summary.worst_share = std::max(summary.worst_share, result.worst_error / one.bound);
    }
  }
  return summary;
}

std::string to_text(const Summary &summary)
{
  return fmt::format("{} cases: {} passed ({} baselines failed as expected), {} failed, {} non-finite", summary.cases,
                     summary.passed, summary.baselines, summary.failed, summary.non_finite);
}

/** One span for each group, in order. \pre sorted by group */
std::vector<std::span<const CaseResult>> by_group(std::span<const CaseResult> results)
{
  std::vector<std::span<const CaseResult>> groups;
  while (!results.empty()) {
    const auto end = std::ranges::find_if(
        results, [&](const CaseResult &each) { return each.one.group != results.front().one.group; });
    groups.push_back(results.first(std::size_t(end - results.begin())));
    results = results.subspan(groups.back().size());
  }
  return groups;
}

const char *verdict(const CaseResult &each)
{
  if (!each.result.is_passed) {
    return "FAILED";
  }
  return each.one.is_baseline ? "baseline" : "passed";
}

std::string range_of(const CaseResult &each)
{
  const std::vector<verify::StabilitySample> &samples = each.result.samples;
  return samples.empty() ? "" : fmt::format("{:.3g} to {:.3g}", samples.front().parameter, samples.back().parameter);
}

measure::Table summary_table(std::span<const CaseResult> results)
{
  measure::Table table{{"group", "cases", "passed", "baselines", "failed", "non-finite", "worst / bound"}, {}};
  for (const std::span<const CaseResult> group : by_group(results)) {
    const Summary one = summary_of(group);
    table.rows.push_back({group.front().one.group, std::to_string(one.cases), std::to_string(one.passed),
                          std::to_string(one.baselines), std::to_string(one.failed), std::to_string(one.non_finite),
                          fmt::format("{:.2f}", one.worst_share)});
  }
  return table;
}

void print(const std::vector<CaseResult> &results)
{
  for (const std::span<const CaseResult> group : by_group(results)) {
    fmt::print("{}\n{:8} {:>10} {:>10} {:>10}  {}\n", group.front().one.group, "", "error", "bound", "at", "of");
    for (const CaseResult &each : group) {
      const auto &[one, result] = each;
      fmt::print("{:8} {:10.3g} {:10.3g} {:10.3g}  {} ({})\n", verdict(each), result.worst_error, one.bound,
                 result.worst_parameter, one.name, one.unit);
    }
    fmt::print("\n");
  }
  const measure::Table summary = summary_table(results);
  std::vector<std::vector<std::string>> lines = summary.rows;
  lines.insert(lines.begin(), summary.head);
  for (const std::vector<std::string> &line : lines) {
    fmt::print("{:20} {:>6} {:>7} {:>10} {:>7} {:>11} {:>14}\n", line[0], line[1], line[2], line[3], line[4], line[5],
               line[6]);
  }
  fmt::print("\n{}\n", to_text(summary_of(results)));
}

void print_failures(const std::vector<CaseResult> &results)
{
  for (const auto &[one, result] : results) {
    if (result.is_passed) {
      continue;
    }
    std::string reason = result.failure;
    if (reason.empty()) {
      reason = one.is_baseline ? "a baseline that no longer fails" : "error";
      reason += fmt::format(" {:.4g} {} at {} {:.6g}, bound {:.4g}", result.worst_error, one.unit, one.parameter,
                            result.worst_parameter, one.bound);
    }
    print_message("gnomon: failed: {}, {}: {}\n", one.group, one.name, reason);
  }
}

std::string to_csv(const std::vector<CaseResult> &results)
{
  std::string csv =
      "group,name,quantity,parameter,low,high,reference,unit,worst_error,worst_parameter,bound,samples,non_finite,"
      "finite,"
      "baseline,passed,failure\n";
  for (const auto &[one, result] : results) {
    const bool has_samples = !result.samples.empty();
    csv += fmt::format(
        "{},{},{},{},{},{},{},{},{:.6g},{:.9g},{:.6g},{},{},{},{},{},{}\n", measure::csv_quoted(one.group),
        measure::csv_quoted(one.name), measure::csv_quoted(one.quantity), measure::csv_quoted(one.parameter),
        has_samples ? fmt::format("{:.9g}", result.samples.front().parameter) : "",
        has_samples ? fmt::format("{:.9g}", result.samples.back().parameter) : "", measure::csv_quoted(one.reference),
        measure::csv_quoted(one.unit), result.worst_error, result.worst_parameter, one.bound, result.samples.size(),
        result.non_finite_count, result.non_finite_count == 0, one.is_baseline, result.is_passed,
        measure::csv_quoted(result.failure));
  }
  return csv;
}

/** Non-finite numbers become null, because JSON cannot represent them. */
nlohmann::json to_json(const std::vector<CaseResult> &results, const Origin &where, const std::string &driver)
{
  const Summary summary = summary_of(results);
  nlohmann::json json = {{"program", where.program},
                         {"commit", where.commit},
                         {"date", where.date},
                         {"machine", where.machine},
                         {"device", driver}};
  json["summary"] = {{"cases", summary.cases},
                     {"passed", summary.passed},
                     {"baselines", summary.baselines},
                     {"failed", summary.failed},
                     {"non_finite", summary.non_finite}};
  json["cases"] = nlohmann::json::array();
  for (const auto &[one, result] : results) {
    nlohmann::json samples = nlohmann::json::array();
    for (const verify::StabilitySample &sample : result.samples) {
      samples.push_back({sample.parameter, sample.error});
    }
    json["cases"].push_back({{"group", one.group},
                             {"name", one.name},
                             {"quantity", one.quantity},
                             {"parameter", one.parameter},
                             {"reference", one.reference},
                             {"unit", one.unit},
                             {"bound", one.bound},
                             {"is_baseline", one.is_baseline},
                             {"worst_error", result.worst_error},
                             {"worst_parameter", result.worst_parameter},
                             {"non_finite_count", result.non_finite_count},
                             {"is_passed", result.is_passed},
                             {"failure", result.failure},
                             {"samples", samples}});
  }
  return json;
}

/** A chart of error over bound for cases of one quantity and parameter; none if no case has a finite error above 0. */
std::optional<measure::Chart> chart_of(std::span<const CaseResult> results)
{
  measure::Chart chart;
  chart.title = results.front().one.quantity;
  chart.x.title = results.front().one.parameter;
  chart.y.title = "error / bound";
  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;
  bool has_negative = false;
  bool is_seen = false;
  for (const auto &[one, result] : results) {
    if (one.bound == 0.0) {
      continue;
    }
    measure::ChartSeries series{one.is_baseline ? one.name + " (baseline)" : one.name, {}, true, false};
    for (const auto &[parameter, error] : result.samples) {
      // A sweep may begin at 0, which a logarithmic axis leaves out.
      low = parameter > 0.0 ? std::min(low, parameter) : low;
      high = std::max(high, parameter);
      has_negative = has_negative || parameter < 0.0;
      is_seen = is_seen || (error > 0.0 && std::isfinite(error));
      series.points.push_back({parameter, error / one.bound, fmt::format("{:.3g} {}", error, one.unit)});
    }
    chart.series.push_back(std::move(series));
  }
  if (!is_seen) {
    return std::nullopt;
  }
  chart.x.is_logarithmic = !has_negative && high > 1000.0 * low;
  chart.series.push_back({"bound", {{low, 1.0, ""}, {high, 1.0, ""}}, true, false});
  return chart;
}

measure::Table table_of(std::span<const CaseResult> group)
{
  measure::Table table{
      {"case", "result", "finite", "worst error", "bound", "unit", "at", "range", "parameter", "quantity", "reference"},
      {}};
  for (const CaseResult &each : group) {
    const auto &[one, result] = each;
    table.rows.push_back({one.name, verdict(each), result.non_finite_count == 0 ? "yes" : "no",
                          fmt::format("{:.3g}", result.worst_error), fmt::format("{:.3g}", one.bound), one.unit,
                          fmt::format("{:.4g}", result.worst_parameter), range_of(each), one.parameter, one.quantity,
                          one.reference});
  }
  return table;
}

std::string to_html(const std::vector<CaseResult> &results, const Origin &where, const std::string &driver)
{
  measure::Page page("Stability");
  page.paragraph(fmt::format("{} ({}), {}. {}, {}.", where.program, where.commit, where.date, where.machine, driver));
  page.paragraph(to_text(summary_of(results)));
  page.table(summary_table(results));
  page.paragraph(
      "Charts show each case's error divided by its bound. Errors of 0 and non-finite errors are not drawn: a line "
      "that "
      "ends has overflowed. Cases with a bound of 0 are in the tables only. A baseline is a formula that the engine "
      "does "
      "not use; it passes if its error exceeds the bound.");
  for (const std::span<const CaseResult> group : by_group(results)) {
    page.heading(group.front().one.group);
    page.table(table_of(group));
    // One chart for each pair of quantity and parameter.
    std::vector<CaseResult> left(group.begin(), group.end());
    while (!left.empty()) {
      const auto others = std::stable_partition(
          left.begin(), left.end(),
          [quantity = left.front().one.quantity, parameter = left.front().one.parameter](const CaseResult &each) {
            return each.one.quantity == quantity && each.one.parameter == parameter;
          });
      if (const std::optional<measure::Chart> chart = chart_of({left.begin(), others})) {
        page.chart(*chart);
      }
      left.erase(left.begin(), others);
    }
  }
  return page.html();
}

Status stability(const StabilityOptions &options)
{
  std::unique_ptr<gpu::Device> device;
  std::vector<verify::StabilityCase> cases = chosen_cases(options, device);
  const std::string driver = device ? device->description() : "no device";
  fs::create_directories(options.folder);
  const fs::path folder(options.folder);
  output::Roles roles;
  for (const char *name : {"stability.csv", "stability.json", "index.html"}) {
    roles.add_output(folder / name, "-o");
  }
  keep_text_from(roles);
  const std::vector<CaseResult> results = run_all(std::move(cases));
  const Origin where = origin();
  output::write_file(folder / "stability.csv", to_csv(results));
  write_json(folder / "stability.json", to_json(results, where, driver), 1);
  output::write_file(folder / "index.html", to_html(results, where, driver));
  print(results);
  print_failures(results);
  const Summary summary = summary_of(results);
  if (summary.non_finite > 0) {
    return Status::NonFinite;
  }
  return summary.failed > 0 ? Status::Failed : Status::Done;
}

}  // namespace

void add_stability(CLI::App &app, Status &status)
{
  auto o = std::make_shared<StabilityOptions>();
  CLI::App *command = app.add_subcommand("stability", "Stiff and extreme cases: error, bound and finiteness");
  command->add_option("-o,--output", o->folder, "Folder for stability.csv, stability.json and index.html")->required();
  command->add_option("--group", o->group, "Run only the cases of this group; an unknown name lists the groups");
  add_backend_option(*command, o->backend);
  command->callback([o, &status] { status = stability(*o); });
}

}  // namespace gnomon::cli
