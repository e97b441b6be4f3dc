// SPDX-License-Identifier: MIT
#pragma once

#include "measure_scene.hh"

#include <gtest/gtest.h>

/** Tests use the scenes of source/measure. */
namespace gnomon::test {

using measure::add_box_mesh;
using measure::add_lamp;
using measure::add_material;
using measure::add_object;
using measure::add_square_mesh;
using measure::add_texture;
using measure::camera_at;
using measure::handle_at;
using measure::Picture;
using measure::remove_lamps;
using measure::Renderer;

/** Removes the nodes that have meshes; the last first, so that slots are reused in order. */
inline void remove_objects(scene::Scene &scene)
{
  const std::vector<scene::Object> objects = scene.objects();
  for (auto object = objects.rbegin(); object != objects.rend(); ++object) {
    scene.remove(object->node);
  }
}

/** Edits material number \a index of \a scene. */
template <std::invocable<scene::Material &> Change>
void edit_material(scene::Scene &scene, std::size_t index, Change &&change)
{
  scene.edit(handle_at(scene.materials(), index), change);
}

inline void expect_near(const glm::vec3 &value, const glm::vec3 &expected, float tolerance)
{
  for (int i = 0; i < 3; i++) {
    EXPECT_NEAR(value[i], expected[i], tolerance) << "channel " << i;
  }
}

}  // namespace gnomon::test
