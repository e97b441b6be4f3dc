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

/** A glTF file in memory. Accessors are not yet checked against the bytes. */
struct File {
  Model model;
  /** The bytes of each buffer; empty if an unsupported extension provides them. */
  std::vector<std::span<const unsigned char>> buffers;
  /** Folder of the file, to which URIs are relative. */
  std::filesystem::path folder;
  /** Memory that `buffers` refers to. A list, because its elements do not move. */
  std::list<std::vector<unsigned char>> storage;
};

/**
 * The bytes of a URI: a decoded data URI, or a file relative to \a folder.
 *
 * \throws Fault that names \a what.
 */
[[nodiscard]] std::vector<unsigned char> bytes_of_uri(const std::filesystem::path &folder, const std::string &what,
                                                      const std::string &uri);

/** \throws Fault; std::bad_alloc */
[[nodiscard]] File load_file(const std::filesystem::path &path);

}  // namespace gnomon::gltf
