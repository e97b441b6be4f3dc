// SPDX-License-Identifier: MIT
#pragma once

#include <tiny_gltf.h>

#include <cstddef>
#include <filesystem>
#include <list>
#include <span>
#include <string>
#include <vector>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** Where the bytes of an image are. */
struct ImageSource {
  std::string name;
  /** A data URI or a file's name; empty: `buffer_view` has them. */
  std::string uri;
  /** -1: none; may be out of range. */
  int buffer_view = -1;
};

/**
 * A glTF file in memory. Types and indices of the model are checked, but not those of and into textures, nor
 * what the accessors say of the bytes.
 */
struct File {
  /** Without buffers, images, animations and skins. */
  tinygltf::Model model;
  /** The bytes of each buffer of the file; empty when the file keeps them from us (an extension's buffer). */
  std::vector<std::span<const unsigned char>> buffers;
  std::vector<ImageSource> images;
  bool has_animations = false;
  /** Where files that it names are beside it. */
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

/** \throws Fault, or an exception of the JSON library. */
[[nodiscard]] File load_file(const std::filesystem::path &path);

}  // namespace gnomon::gltf
