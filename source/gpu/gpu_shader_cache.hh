// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_shader.hh"

#include <cstddef>
#include <filesystem>

namespace gnomon::gpu {

/** A compiled program as the driver returns it. */
struct CachedShader {
  /** The driver's own number for the format of `binary`; 0 with an empty binary: the driver returned none. */
  std::uint32_t binary_format = 0;
  std::vector<std::byte> binary{};
};

/**
 * Compiled shaders on disk, a file each. A file that is missing, cut off, changed or another version's is no entry; one
 * that cannot be written is not written. So nothing about the folder can change a picture or end a program.
 */
class ShaderDiskCache {
 public:
  /** \a folder is made at the first store; empty: nothing is kept. */
  explicit ShaderDiskCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /**
   * Hash of all that the result depends on: the preprocessed \a stages, which hold the defines, and \a driver, the
   * text that tells one driver from another.
   */
  [[nodiscard]] static std::string key_of(const std::vector<ShaderSource> &stages, std::string_view driver);

  [[nodiscard]] std::optional<CachedShader> load(const std::string &key) const;
  /** A shader without a binary is not stored. */
  void store(const std::string &key, const CachedShader &shader) const;

 private:
  std::filesystem::path folder_;
};

/** `$XDG_CACHE_HOME/gnomon`, else `~/.cache/gnomon`; empty where neither variable is set. */
[[nodiscard]] std::filesystem::path default_shader_cache_folder();

}  // namespace gnomon::gpu
