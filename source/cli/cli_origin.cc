// SPDX-License-Identifier: MIT
#include "cli_origin.hh"

#include "cli_commit.hh"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <fstream>
#include <thread>

namespace gnomon::cli {

/** Name of the processor from Linux's /proc/cpuinfo; "" if there is none. */
static std::string processor()
{
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) == 0) {
      const std::size_t at = line.find(':');
      return at == std::string::npos ? "" : line.substr(at + 2);
    }
  }
  return "";
}

Origin origin()
{
  const std::string model = processor();
  return {"gnomon " GNOMON_VERSION, GNOMON_COMMIT, fmt::format("{:%Y-%m-%d %H:%M}", fmt::gmtime(std::time(nullptr))),
          fmt::format("{} cores{}{}", std::thread::hardware_concurrency(), model.empty() ? "" : ", ", model)};
}

std::string program_name()
{
  return "gnomon " GNOMON_VERSION ", " GNOMON_COMMIT;
}

}  // namespace gnomon::cli
