// SPDX-License-Identifier: MIT
#pragma once

#include <tiny_gltf.h>

#include <cstddef>
#include <filesystem>
#include <list>
#include <span>
#include <string>
#include <vector>

/** Internal to source/scene. */
namespace gnomon::scene::gltf {

/** A glTF file in memory. Types and indices of the model are checked; what the accessors say of the bytes is not. */
struct File {
  /** Without buffers, images, textures, animations and skins. */
  tinygltf::Model model;
  /** The bytes of each buffer of the file; empty when the file keeps them from us (an extension's buffer). */
  std::vector<std::span<const unsigned char>> buffers;
  bool has_animations = false;
  /** What `buffers` points into; a list because its elements stay where they are. */
  std::list<std::vector<unsigned char>> storage;
};

/** \throws Fault, or an exception of the JSON library. */
[[nodiscard]] File load_file(const std::filesystem::path &path);

}  // namespace gnomon::scene::gltf
