// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_model.hh"

#include <cstddef>
#include <filesystem>
#include <list>
#include <span>
#include <string>
#include <vector>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** A glTF file in memory. What the accessors say of the bytes is not checked yet. */
struct File {
  Model model;
  /** The bytes of each buffer of the file; empty where an extension that is not read fills the buffer. */
  std::vector<std::span<const unsigned char>> buffers;
  /** That of the file: URIs are relative to it. */
  std::filesystem::path folder;
  /** What `buffers` points into; a list because its elements stay where they are. */
  std::list<std::vector<unsigned char>> storage;
};

/**
 * What a URI of the file \a what stands for: decoded, or read from beside the scene.
 *
 * \throws Fault that names \a what.
 */
[[nodiscard]] std::vector<unsigned char> bytes_of_uri(const std::filesystem::path &folder, const std::string &what,
                                                      const std::string &uri);

/** \throws Fault; std::bad_alloc */
[[nodiscard]] File load_file(const std::filesystem::path &path);

}  // namespace gnomon::gltf
