// SPDX-License-Identifier: MIT
#pragma once

#include "cli_shader_files.hh"

#include "gpu_shader.hh"
#include "shader_check_files.hh"

namespace gnomon::cli {

/** The engines' shader files: those in the program, or those of a folder. */
class EngineFiles {
 public:
  /** \a folder: empty for the program's own. \throws std::runtime_error if it does not exist. */
  explicit EngineFiles(const std::string &folder);

  [[nodiscard]] const gpu::ShaderFiles &files() const
  {
    return files_;
  }
  /** A path that an editor can open. For shaders in the program it is relative to the repository's root. */
  [[nodiscard]] std::string shown(const std::string &path) const
  {
    return (std::filesystem::path(prefix_) / path).string();
  }

 private:
  std::string prefix_;
  shader_check::FolderFiles folder_;
  gpu::ShaderFiles files_;
};

/** One variant of a program of an engine. */
struct Variant {
  /** Why the program exists. */
  std::string_view purpose;
  /** Its name is the program's. */
  gpu::ShaderDesc desc;
  /** The inputs that the variant of the shaders in the program has. */
  gpu::ShaderInterface interface;
};

/**
 * The variants of all engines; variants of one program follow each other. The last one of a program that has constants
 * (eevee::constants_of) has all of them.
 */
[[nodiscard]] std::vector<Variant> engine_variants();
/** The C++ layouts of the blocks of all engines. */
[[nodiscard]] const std::vector<gpu::BlockLayout> &engine_blocks();
/** Number of programs among \a variants. */
[[nodiscard]] std::size_t program_count(const std::vector<Variant> &variants);

/** \throws std::runtime_error for an unknown \a name. */
[[noreturn]] void throw_no_program(const std::string &name);

/** The defines, separated by spaces. */
[[nodiscard]] std::string defines_of(const gpu::ShaderDesc &desc);

}  // namespace gnomon::cli
