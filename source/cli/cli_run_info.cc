// SPDX-License-Identifier: MIT
#include "cli_run_info.hh"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <fstream>
#include <thread>

namespace gnomon::cli {

static std::string processor()
{
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) {
      return line.substr(colon + 2);
    }
  }
  return "unknown processor";
}

RunInfo run_info(const std::string &device)
{
  return {.program = "gnomon " GNOMON_VERSION,
          .commit = GNOMON_COMMIT,
          .date = fmt::format("{:%FT%TZ}", fmt::gmtime(std::time(nullptr))),
          .machine = fmt::format("{}, {} threads", processor(), std::thread::hardware_concurrency()),
          .device = device};
}

nlohmann::json to_json(const RunInfo &info)
{
  nlohmann::json json = nlohmann::json::object();
  for (const std::vector<std::string> &row : to_rows(info)) {
    json[row[0]] = row[1];
  }
  return json;
}

std::vector<std::vector<std::string>> to_rows(const RunInfo &info)
{
  std::vector<std::vector<std::string>> rows = {{"program", info.program},
                                                {"commit", info.commit},
                                                {"date", info.date},
                                                {"machine", info.machine},
                                                {"device", info.device}};
  std::erase_if(rows, [](const std::vector<std::string> &row) { return row[1].empty(); });
  return rows;
}

}  // namespace gnomon::cli
