// SPDX-License-Identifier: MIT
#include "gpu_shader_cache.hh"

#include <fmt/format.h>
#include <xxhash.h>
#include <nlohmann/json.hpp>

#include <unistd.h>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

namespace gnomon::gpu {

namespace fs = std::filesystem;

namespace {

/** The number is the file format's version. Files of another version are not read. */
constexpr std::string_view magic = "gnomon shader 2\n";

std::uint64_t checksum(std::span<const std::uint8_t> bytes)
{
  return XXH3_64bits(bytes.data(), bytes.size());
}

nlohmann::json to_json(const CachedShader &shader)
{
  const auto *bytes = reinterpret_cast<const std::uint8_t *>(shader.binary.data());
  return {{"binary_format", shader.binary_format},
          {"binary", nlohmann::json::binary(std::vector<std::uint8_t>(bytes, bytes + shader.binary.size()))}};
}

CachedShader from_json(const nlohmann::json &json)
{
  CachedShader shader;
  shader.binary_format = json.at("binary_format");
  const auto &binary = json.at("binary").get_binary();
  const auto *bytes = reinterpret_cast<const std::byte *>(binary.data());
  shader.binary.assign(bytes, bytes + binary.size());
  return shader;
}

}  // namespace

std::string ShaderDiskCache::key_of(const std::vector<ShaderSource> &stages, std::string_view driver)
{
  std::string text = fmt::format("{}\n", driver);
  for (const ShaderSource &stage : stages) {
    text += fmt::format("{} {}\n{}\n", to_string(stage.stage), stage.text.size(), stage.text);
  }
  const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::optional<CachedShader> ShaderDiskCache::load(const std::string &key) const
{
  if (folder_.empty()) {
    return std::nullopt;
  }
  std::ifstream file(folder_ / key, std::ios::binary);
  // Through a stream's operator: reading what is no file would throw from an iterator.
  std::ostringstream whole;
  whole << file.rdbuf();
  const std::string content = whole.str();
  const std::size_t head_size = magic.size() + sizeof(std::uint64_t);
  if (!file || content.size() < head_size || std::string_view(content.data(), magic.size()) != magic) {
    return std::nullopt;
  }
  std::uint64_t expected = 0;
  std::memcpy(&expected, content.data() + magic.size(), sizeof(expected));
  const std::span body(reinterpret_cast<const std::uint8_t *>(content.data()) + head_size, content.size() - head_size);
  if (checksum(body) != expected) {
    return std::nullopt;
  }
  try {
    return from_json(nlohmann::json::from_cbor(body.begin(), body.end()));
  }
  catch (const nlohmann::json::exception &) {
    return std::nullopt;
  }
}

void ShaderDiskCache::store(const std::string &key, const CachedShader &shader) const
{
  if (folder_.empty() || shader.binary.empty()) {
    return;
  }
  const std::vector<std::uint8_t> body = nlohmann::json::to_cbor(to_json(shader));
  const std::uint64_t sum = checksum(body);
  std::error_code failed;
  fs::create_directories(folder_, failed);
  // Written beside and renamed: another program that starts meanwhile finds a whole file or none.
  const fs::path beside = folder_ / fmt::format("{}.{}", key, getpid());
  std::ofstream file(beside, std::ios::binary);
  file.write(magic.data(), std::streamsize(magic.size()));
  file.write(reinterpret_cast<const char *>(&sum), sizeof(sum));
  file.write(reinterpret_cast<const char *>(body.data()), std::streamsize(body.size()));
  file.close();
  if (file) {
    fs::rename(beside, folder_ / key, failed);
  }
  if (!file || failed) {
    fs::remove(beside, failed);
  }
}

fs::path default_shader_cache_folder()
{
  const char *cache = std::getenv("XDG_CACHE_HOME");
  if (cache && *cache) {
    return fs::path(cache) / "gnomon";
  }
  const char *home = std::getenv("HOME");
  return home && *home ? fs::path(home) / ".cache" / "gnomon" : fs::path();
}

}  // namespace gnomon::gpu
