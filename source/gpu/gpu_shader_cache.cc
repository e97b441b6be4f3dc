// SPDX-License-Identifier: MIT
#include "gpu_shader_cache.hh"

#include "gpu_device.hh"

#include "output_file.hh"

#include <fmt/format.h>
#include <xxhash.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

namespace gnomon::gpu {

namespace fs = std::filesystem;

namespace {

/** First bytes of a file, including the version of the format. */
constexpr std::string_view magic = "gnomon shader 3\n";

std::uint64_t checksum(std::span<const std::uint8_t> bytes)
{
  return XXH3_64bits(bytes.data(), bytes.size());
}

nlohmann::json to_json(const CachedShader &shader)
{
  const auto *bytes = reinterpret_cast<const std::uint8_t *>(shader.compiled.data());
  return {{"compiled", nlohmann::json::binary(std::vector<std::uint8_t>(bytes, bytes + shader.compiled.size()))}};
}

CachedShader from_json(const nlohmann::json &json)
{
  CachedShader shader;
  const auto &compiled = json.at("compiled").get_binary();
  const auto *bytes = reinterpret_cast<const std::byte *>(compiled.data());
  shader.compiled.assign(bytes, bytes + compiled.size());
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
  // operator<< sets a fail bit if the path is not a regular file, whereas stream iterators would throw.
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
  // trim() reads this time to find the least recently used files.
  std::error_code ignored;
  fs::last_write_time(folder_ / key, fs::file_time_type::clock::now(), ignored);
  try {
    return from_json(nlohmann::json::from_cbor(body.begin(), body.end()));
  }
  catch (const nlohmann::json::exception &) {
    return std::nullopt;
  }
}

void ShaderDiskCache::store(const std::string &key, const CachedShader &shader) const
{
  if (folder_.empty() || shader.compiled.empty()) {
    return;
  }
  const std::vector<std::uint8_t> body = nlohmann::json::to_cbor(to_json(shader));
  const std::uint64_t sum = checksum(body);
  std::error_code failed;
  fs::create_directories(folder_, failed);
  // Other processes never read an incomplete file. After a loss of power, the checksum tells a damaged one.
  try {
    output::write_file(
        folder_ / key,
        [&](output::Stream &stream) {
          stream.write(magic);
          stream.write(&sum, sizeof(sum));
          stream.write(body.data(), body.size());
        },
        output::Flush::None);
  }
  catch (const output::Error &) {
    // The shader is compiled again by the next process.
  }
  trim(folder_ / key);
}

namespace {

/** Whether \a name is a key (KEY), or the name of a temporary file of store() (.KEY.NUMBERS). */
bool is_cache_file(std::string_view name)
{
  constexpr std::size_t key_size = 32;
  const bool is_temporary = name.starts_with('.');
  name.remove_prefix(is_temporary ? 1 : 0);
  const std::size_t digits = std::min(name.find_first_not_of("0123456789abcdef"), name.size());
  return digits == key_size && (is_temporary ? name.substr(digits).starts_with('.') : name.size() == digits);
}

}  // namespace

void ShaderDiskCache::trim(const fs::path &kept) const
{
  struct Entry {
    fs::file_time_type time;
    fs::path path;
    std::uintmax_t size_bytes;
  };
  std::vector<Entry> entries;
  std::uintmax_t total = 0;
  std::error_code failed;
  for (auto file = fs::directory_iterator(folder_, failed); !failed && file != fs::directory_iterator();
       file.increment(failed)) {
    std::error_code unreadable;
    if (!is_cache_file(file->path().filename().string()) || !file->is_regular_file(unreadable)) {
      continue;
    }
    const std::uintmax_t size_bytes = file->file_size(unreadable);
    const fs::file_time_type time = file->last_write_time(unreadable);
    if (!unreadable) {
      entries.push_back({time, file->path(), size_bytes});
      total += size_bytes;
    }
  }
  std::ranges::sort(entries, {}, &Entry::time);
  for (const Entry &entry : entries) {
    if (total <= size_bytes_max_) {
      break;
    }
    // Removing a temporary file of another process is harmless: its shader is compiled again.
    if (entry.path != kept && fs::remove(entry.path, failed)) {
      total -= entry.size_bytes;
    }
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
