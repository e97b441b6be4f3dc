// SPDX-License-Identifier: MIT
#include "cli_fingerprint.hh"

#include <fmt/format.h>
#include <xxhash.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>

namespace gnomon::cli {

namespace fs = std::filesystem;

static std::optional<std::string> bytes_of(const fs::path &path)
{
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  return file.is_open() && !file.bad() ? std::optional(std::move(bytes)) : std::nullopt;
}

static std::string hash_of(const std::string &bytes)
{
  return fmt::format("{:016x}", XXH3_64bits(bytes.data(), bytes.size()));
}

std::string scene_fingerprint(const fs::path &path)
{
  std::optional<std::string> bytes = bytes_of(path);
  if (!bytes) {
    throw std::runtime_error(fmt::format("{}: cannot be read", path.string()));
  }
  std::string hash = hash_of(*bytes);
  // A binary file's JSON is not looked into: such files hold their data themselves.
  const nlohmann::json json = nlohmann::json::parse(*bytes, nullptr, false);
  for (const char *list : {"buffers", "images"}) {
    if (!json.is_object() || !json.contains(list) || !json[list].is_array()) {
      continue;
    }
    for (const nlohmann::json &entry : json[list]) {
      if (entry.is_object() && entry.contains("uri") && entry["uri"].is_string()) {
        const std::string uri = entry["uri"];
        hash += uri.rfind("data:", 0) == 0 ? "" : hash_of(bytes_of(path.parent_path() / uri).value_or(""));
      }
    }
  }
  return hash_of(hash);
}

std::string program_fingerprint()
{
  const std::optional<std::string> bytes = bytes_of("/proc/self/exe");
  return bytes ? hash_of(*bytes) : "";
}

}  // namespace gnomon::cli
