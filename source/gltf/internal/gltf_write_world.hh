// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_write_buffer.hh"
#include "scene.hh"

#include <filesystem>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * Adds the extras of a scene with \a world. A picture from a file is referred to by its path relative to \a folder,
 * that of the written file. Other pictures, and those whose file has gone, become an accessor of \a buffer.
 * \throws Fault
 */
void add_world_extras(const scene::World &world, const std::filesystem::path &folder, WrittenBuffer &buffer,
                      JsonText &extras);

}  // namespace gnomon::gltf
