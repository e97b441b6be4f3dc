// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_shader.hh"

#include <cstddef>
#include <filesystem>

namespace gnomon::gpu {

/** A compiled shader in the backend's own form. */
struct CachedShader {
  /** Empty if the backend has no compiled form. */
  std::vector<std::byte> compiled{};
};

/**
 * Cache of compiled shaders on disk, one file for each shader. Files that are missing, truncated, modified or of
 * another version are ignored, and so are failures to write. The state of the folder therefore affects neither results
 * nor errors.
 *
 * After each store, the least recently used files are removed until the total size is within the limit. The cache
 * neither counts nor removes files whose names do not match its own.
 */
class ShaderDiskCache {
 public:
  static constexpr std::uintmax_t size_bytes_default = std::uintmax_t(64) << 20U;

  /** \a folder: created by the first store; empty: the cache is disabled. \a size_bytes_max: total size of the files */
  explicit ShaderDiskCache(std::filesystem::path folder, std::uintmax_t size_bytes_max = size_bytes_default)
      : folder_(std::move(folder)), size_bytes_max_(size_bytes_max)
  {
  }

  /**
   * Key of a compiled shader: a hash of the preprocessed \a stages, which contain the defines, and of the text
   * \a driver, which identifies the driver. 32 hexadecimal digits.
   */
  [[nodiscard]] static std::string key_of(const std::vector<ShaderSource> &stages, std::string_view driver);

  [[nodiscard]] std::optional<CachedShader> load(const std::string &key) const;
  /** Does nothing if \a shader has no compiled form. */
  void store(const std::string &key, const CachedShader &shader) const;

 private:
  /** Remove the least recently used files until the total size is within the limit. Never removes \a kept. */
  void trim(const std::filesystem::path &kept) const;

  std::filesystem::path folder_;
  std::uintmax_t size_bytes_max_;
};

}  // namespace gnomon::gpu
