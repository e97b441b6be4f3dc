// SPDX-License-Identifier: MIT
#include "cli_bench.hh"
#include "cli_device.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

namespace gnomon::cli {

void bench_growth(const BenchOptions &options)
{
  const std::unique_ptr<gpu::Device> device = options.backend == "null" ? nullptr : create_device(options.backend);
  fmt::print(
      "Times of growing counts: milliseconds, median [quartiles] of {} rounds. Objects and casters: CPU time without "
      "a\n"
      "driver. n: the median without the fixed time, divided by the count. The exponent and the fixed time are those "
      "of\n"
      "the best fit of fixed + factor * count^exponent. {}\n",
      options.rounds, device ? device->description() : "");
  nlohmann::json json = nlohmann::json::array();
  for (const measure::GrowthCost &cost : measure::measure_growth(device.get(), options.rounds, options.count_max)) {
    const std::vector<double> medians = cost.medians();
    const measure::Growth growth = measure::growth_of(cost.counts, medians);
    fmt::print("\n{}: exponent {:.2f} beyond {:.3f} ms\n{:>9}  {:<30} {:>9}\n", cost.work, growth.exponent,
               1e3 * growth.fixed, "count", "ms", "ns / n");
    nlohmann::json rows = nlohmann::json::array();
    for (std::size_t i = 0; i < cost.counts.size(); i++) {
      const measure::Spread spread = measure::spread_of(cost.seconds[i]);
      fmt::print("{:>9.0f}  {:<30} {:>9.1f}\n", cost.counts[i], to_text(spread, 1e-3),
                 1e9 * (medians[i] - growth.fixed) / cost.counts[i]);
      rows.push_back({{"count", cost.counts[i]}, {"seconds", to_json(spread)}});
    }
    json.push_back(
        {{"work", cost.work}, {"exponent", growth.exponent}, {"fixed_seconds", growth.fixed}, {"rows", rows}});
  }
  write_json(options.json, {{"program", "gnomon " GNOMON_VERSION},
                            {"bench", "growth"},
                            {"rounds", options.rounds},
                            {"device", device ? device->description() : ""},
                            {"work", json}});
}

}  // namespace gnomon::cli
