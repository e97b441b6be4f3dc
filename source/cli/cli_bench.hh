// SPDX-License-Identifier: MIT
#pragma once

#include "cli.hh"
#include "cli_output.hh"
#include "cli_world.hh"

#include "measure_bench.hh"

#include <nlohmann/json_fwd.hpp>

#include <memory>
#include <string>
#include <vector>

namespace gnomon::gpu {
class Device;
}

/** Parts of `gnomon bench` that several of its files use. */
namespace gnomon::cli {

struct BenchOptions {
  std::string scene;
  std::vector<std::string> scenes;
  std::string backend = "auto";
  int rounds = 21;
  int points = 256;
  int count_max = 1 << 30;
  int frames = 300;
  double budget_ms = 33.0;
  /** WIDTHxHEIGHT, pixels. */
  std::string size = "960x540";
  std::string json;
  WorldOptions world;
};

[[nodiscard]] nlohmann::json to_json(const measure::Spread &spread);
/** Median and quartiles, in units of \a unit seconds. */
[[nodiscard]] std::string to_text(const measure::Spread &spread, double unit);
void bench_cull(const BenchOptions &options);
void bench_import(const BenchOptions &options);
void bench_record(const BenchOptions &options);
void bench_sync(const BenchOptions &options);
void bench_growth(const BenchOptions &options);
void bench_frames(const BenchOptions &options);
void bench_memory(const BenchOptions &options);
/** \return Status::NonFinite if a result is negative or not finite */
[[nodiscard]] Status bench_light(const BenchOptions &options);

}  // namespace gnomon::cli
