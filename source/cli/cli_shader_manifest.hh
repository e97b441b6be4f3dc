// SPDX-License-Identifier: MIT
#pragma once

#include "shader_check.hh"

#include <filesystem>

namespace gnomon::cli {

/** The programs of a project, from a file of JSON. doc/shader-manifest.schema.json describes it. */
struct ShaderManifest {
  struct Entry {
    /** One permutation of a program. Its paths are relative to the current folder. */
    shader_check::Program program;
    /** Names of targets; empty: as the files say. */
    std::vector<std::string> targets;
  };
  /** Permutations of one program follow each other. */
  std::vector<Entry> entries;
  std::vector<std::string> include_folders;
  /** The text after -W. */
  std::vector<std::string> levels;
  std::vector<std::string> features;
};

/** A program has at most this number of permutations. */
inline constexpr std::size_t permutations_max = 65536;

/** \throws std::runtime_error that names the file, the place in it and the reason */
[[nodiscard]] ShaderManifest read_shader_manifest(const std::filesystem::path &path);

}  // namespace gnomon::cli
