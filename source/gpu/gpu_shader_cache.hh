// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_shader.hh"

#include <cstddef>
#include <filesystem>

namespace gnomon::gpu {

/** A compiled shader in the backend's own form. */
struct CachedShader {
  /** Empty: the backend has none. */
  std::vector<std::byte> compiled{};
};

/**
 * Compiled shaders on disk, one file each. A file that is missing, truncated, changed or of another version is ignored,
 * and a failure to write is ignored. The state of the folder therefore never changes a picture or ends a program.
 *
 * The files together stay below a bound: storing one removes the files that were used least recently. Files whose names
 * are not those of the cache are neither counted nor removed.
 */
class ShaderDiskCache {
 public:
  static constexpr std::uintmax_t size_bytes_default = std::uintmax_t(64) << 20U;

  /** \a folder is created by the first store; empty: nothing is kept. */
  explicit ShaderDiskCache(std::filesystem::path folder, std::uintmax_t size_bytes_max = size_bytes_default)
      : folder_(std::move(folder)), size_bytes_max_(size_bytes_max)
  {
  }

  /**
   * Hash of everything that the result depends on: the preprocessed \a stages, which contain the defines, and \a
   * driver, a text that identifies the driver. 32 hexadecimal digits.
   */
  [[nodiscard]] static std::string key_of(const std::vector<ShaderSource> &stages, std::string_view driver);

  [[nodiscard]] std::optional<CachedShader> load(const std::string &key) const;
  /** A shader without a binary is not stored. */
  void store(const std::string &key, const CachedShader &shader) const;

 private:
  /** Remove the least recently used files until the rest fits; \a kept is not removed. */
  void trim(const std::filesystem::path &kept) const;

  std::filesystem::path folder_;
  std::uintmax_t size_bytes_max_;
};

/** `$XDG_CACHE_HOME/gnomon` or `~/.cache/gnomon`; empty where neither variable is set. */
[[nodiscard]] std::filesystem::path default_shader_cache_folder();

}  // namespace gnomon::gpu
