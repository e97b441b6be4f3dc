// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_shader.hh"

#include <cstddef>
#include <filesystem>

namespace gnomon::gpu {

/** What compiling a shader came to, without compiling it again. */
struct CachedShader {
  ShaderInterface interface {
  };
  /** The driver's own name for the form of `binary`; 0 with an empty binary: the driver gave none. */
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
  void store(const std::string &key, const CachedShader &shader) const;

 private:
  std::filesystem::path folder_;
};

/** `$XDG_CACHE_HOME/gnomon`, else `~/.cache/gnomon`; empty where neither variable is set. */
[[nodiscard]] std::filesystem::path default_shader_cache_folder();

}  // namespace gnomon::gpu
