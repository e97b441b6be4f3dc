// SPDX-License-Identifier: MIT
#pragma once

#include "gltf_import.hh"
#include "internal/gltf_animation.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

/** Files whose lamps were exported without photometric units. Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * Multiplies the punctual lamps of \a scene, which were read as photometric, if \a units says so. Warns about a file
 * that looks as if its numbers were radiometric. \pre animations and the world are imported
 */
void convert_lamps(LampUnits units, const ImportedThings &things, Warnings &warnings, scene::Scene &scene);

}  // namespace gnomon::gltf
