// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_report.hh"

/** Compressed data of a file. Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * Decode EXT_meshopt_compression and KHR_draco_mesh_compression, so that afterwards accessors read plain bytes. Data
 * that cannot be decoded leaves a warning, and its buffer views without bytes.
 */
void decompress(File &file, Warnings &warnings);

/** The part of decompress for primitives with KHR_draco_mesh_compression. */
void decompress_draco(File &file, Warnings &warnings);

}  // namespace gnomon::gltf
