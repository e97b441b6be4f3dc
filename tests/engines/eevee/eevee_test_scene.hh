// SPDX-License-Identifier: MIT
#pragma once

#include "measure_scene.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <concepts>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

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

/** Whether a device with these limits draws shadow layers in this way. */
inline bool has_layer_pass(const gpu::Limits &limits, eevee::LayerPass pass)
{
  return pass == eevee::LayerPass::Layered    ? limits.has_vertex_layer
         : pass == eevee::LayerPass::Geometry ? limits.has_geometry_shader
                                              : true;
}

/** A sphere of radius 1 with its normals. It has \a columns squared triangles. */
inline scene::Handle<scene::Mesh> add_sphere_mesh(scene::Scene &scene, scene::Handle<scene::Material> material,
                                                  int columns = 128)
{
  const int rows = columns / 2;
  scene::Mesh mesh;
  for (int y = 0; y <= rows; y++) {
    for (int x = 0; x <= columns; x++) {
      const double polar = std::numbers::pi * y / rows;
      const double azimuth = 2.0 * std::numbers::pi * x / columns;
      mesh.positions.emplace_back(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                                  std::cos(polar));
      if (x < columns && y < rows) {
        const auto first = std::uint32_t(y * (columns + 1) + x);
        const auto next_row = std::uint32_t(columns + 1);
        for (const std::uint32_t i : {0U, next_row, next_row + 1, 0U, next_row + 1, 1U}) {
          mesh.indices.push_back(first + i);
        }
      }
    }
  }
  mesh.normals = mesh.positions;
  mesh.material = material;
  return scene.add(std::move(mesh));
}

/** Edits material number \a index of \a scene. */
template <std::invocable<scene::Material &> Change>
void edit_material(scene::Scene &scene, std::size_t index, Change &&change)
{
  scene.edit(handle_at(scene.materials(), index), change);
}

/** How far \a device moves a vertex at most, along each edge of a pixel: half a cell of its grid. */
inline double vertex_shift_max_px(const gpu::Device &device)
{
  return std::exp2(-device.limits().subpixel_bits - 1);
}

inline void expect_near(const glm::vec3 &value, const glm::vec3 &expected, float tolerance)
{
  for (int i = 0; i < 3; i++) {
    EXPECT_NEAR(value[i], expected[i], tolerance) << "channel " << i;
  }
}

}  // namespace gnomon::test
