// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_progress.hh"
#include "internal/gltf_report.hh"

/** Decoding of compressed data. Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * Decodes EXT_meshopt_compression and KHR_draco_mesh_compression, so that accessors read uncompressed bytes afterwards.
 * If data cannot be decoded, a warning is added, and accessors use the fallback data of the file, if there is any.
 */
void decompress(File &file, Progress &progress, Warnings &warnings);

/** The part of decompress for primitives with KHR_draco_mesh_compression. */
void decompress_draco(File &file, Progress &progress, Warnings &warnings);

}  // namespace gnomon::gltf
