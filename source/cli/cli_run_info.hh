// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace gnomon::cli {

/** What figures were measured with: they are not to be read without it. */
struct RunInfo {
  /** Name and version. */
  std::string program;
  /** Of the sources when the build was configured; with "-dirty" where they had changes. Empty: not known. */
  std::string commit;
  /** UTC, as ISO 8601 has it. */
  std::string date;
  /** Processor and number of threads. */
  std::string machine;
  /** gpu::Device::description; empty: none was used. */
  std::string device;
};

/** Of now and here. */
[[nodiscard]] RunInfo run_info(const std::string &device);

[[nodiscard]] nlohmann::json to_json(const RunInfo &info);
/** Name and value of what is known. */
[[nodiscard]] std::vector<std::vector<std::string>> to_rows(const RunInfo &info);

}  // namespace gnomon::cli
