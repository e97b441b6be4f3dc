// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_model.hh"
#include "internal/gltf_report.hh"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** Where files beside a glTF file are. */
struct UriBase {
  /** Folder of the file, to which URIs are relative. */
  std::filesystem::path folder;
  /** Without links: files elsewhere are refused. Empty: files may be anywhere. */
  std::filesystem::path only_below;
};

/** A glTF file in memory. Accessors are not yet checked against the bytes. */
struct File {
  Model model;
  /** The bytes of each buffer; empty if an unsupported extension provides them. */
  std::vector<std::span<const unsigned char>> buffers;
  UriBase base;
  /** The binary chunk of a .glb; empty if there is none. */
  std::span<const unsigned char> binary;
  /** Memory that `buffers` refers to. A list, because its elements do not move. */
  std::list<std::vector<unsigned char>> storage;
};

/** Element \a index of an array of the model. \throws Fault that names \a what, if there is none. */
template <typename Elements>
const auto &element(const Elements &elements, int index, std::string_view what)
{
  if (index < 0 || static_cast<std::size_t>(index) >= elements.size()) {
    throw Fault(what, index < 0 ? "is missing"
                                : "index " + std::to_string(index) + " is out of range: the file has " +
                                      std::to_string(elements.size()));
  }
  return elements[static_cast<std::size_t>(index)];
}

/**
 * The path of the file to which a URI refers.
 *
 * \throws Fault that names \a what, if there is no such file, or if it is not regular, larger than 4 GiB or not below
 * UriBase::only_below.
 */
[[nodiscard]] std::filesystem::path path_of_uri(const UriBase &base, const std::string &what, const std::string &uri);

/** An extra of a scene or a node: the colour of a world, or the name of its picture. */
inline constexpr const char *world_picture_key = "gnomon_world";

/** \see files_named_by */
[[nodiscard]] std::vector<std::filesystem::path> files_of(const File &file);

/** Largest size of a .glb, which is also the limit for other files. */
inline constexpr std::uintmax_t file_size_max = std::uintmax_t(4) << 30U;

/** Whether a URI contains its data instead of the name of a file (RFC 2397). */
[[nodiscard]] bool is_data_uri(const std::string &uri);

/**
 * The bytes of a URI: a decoded data URI, or a file, as path_of_uri, with at most \a size_max bytes.
 *
 * \throws Fault that names \a what.
 */
[[nodiscard]] std::vector<unsigned char> bytes_of_uri(const UriBase &base, const std::string &what,
                                                      const std::string &uri, std::uintmax_t size_max = file_size_max);

/** The model of the file, without the bytes of its buffers. \throws Fault; std::bad_alloc */
[[nodiscard]] File load_document(const std::filesystem::path &path, Warnings &warnings);

/** \a only_below: ImportOptions::only_below. \throws Fault; std::bad_alloc */
[[nodiscard]] File load_file(const std::filesystem::path &path, const std::filesystem::path &only_below,
                             Warnings &warnings);

}  // namespace gnomon::gltf
