// SPDX-License-Identifier: MIT
#pragma once

#include "internal/measure_scene.hh"

/** The scenes that stability is measured on serve tests too. */
namespace gnomon::test {

using measure::add_box_mesh;
using measure::add_lamp;
using measure::add_material;
using measure::add_object;
using measure::add_square_mesh;
using measure::add_texture;
using measure::camera_at;
using measure::Picture;
using measure::Renderer;

}  // namespace gnomon::test
