// SPDX-License-Identifier: MIT
#include "cli_fingerprint.hh"

#include <fmt/format.h>
#include <xxhash.h>

#include <fstream>
#include <iterator>

namespace gnomon::cli {

std::string fingerprint_of(const std::filesystem::path &path)
{
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  return fmt::format("{:016x}", XXH3_64bits(bytes.data(), bytes.size()));
}

}  // namespace gnomon::cli
