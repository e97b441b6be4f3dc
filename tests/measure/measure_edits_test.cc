// SPDX-License-Identifier: MIT
// Edits of a large scene: the bytes, shadows and recordings of each depend on the edit, not on the size of the scene.
#include "measure_edits.hh"

#include "draw_objects.hh"
#include "eevee_inspection.hh"
#include "eevee_light_shared.h"
#include "eevee_material_shared.h"
#include "eevee_shadow_shared.h"

#include <gtest/gtest.h>

#include <map>

namespace gnomon::measure {
namespace {

constexpr std::uint64_t object_bytes = sizeof(shared::ObjectData);
constexpr std::uint64_t material_bytes = sizeof(shared::MaterialData);
constexpr std::uint64_t texel_bytes = 4;
/**
 * Largest upload of lamps and shadows for an edit: their complete blocks, and the draws of casters. It is far below the
 * size of object_block.
 */
constexpr std::uint64_t lamps_bytes = sizeof(shared::LightBlock) + sizeof(shared::ShadowBlock) +
                                      edited_lamp_count * sizeof(shared::ShadowRenderBlock) + 32768;

/** Largest upload of the lists of lamps for a view: two values for each part of the view, and the entries. */
constexpr std::uint64_t lists_bytes = sizeof(float) * 2 * (24 * 24 * 24 + 1) + 32768;

struct Allowed {
  std::uint64_t upload_bytes_max = 0;
  /** Exact number of bytes. */
  std::uint64_t shadows_drawn = 0;
  std::uint64_t pass_recordings = 0;
  std::uint64_t textures_made = 0;
};

const std::map<std::string, Allowed> allowed = {
    {"nothing", {}},
    {"move the camera", {lists_bytes, 0, 0, 0}},
    {"move an object near a lamp", {object_bytes + lamps_bytes, 1, 0, 0}},
    {"move an object far from lamps", {object_bytes + lamps_bytes, 0, 0, 0}},
    {"hide an object", {object_bytes + lamps_bytes, 0, 1, 0}},
    {"show an object", {object_bytes + lamps_bytes, 0, 1, 0}},
    // object_block may have to grow.
    {"add an object", {(edited_object_count + 2) * object_bytes + lamps_bytes, 0, 1, 0}},
    {"remove an object", {lamps_bytes, 0, 1, 0}},
    {"give an object another mesh", {object_bytes + lamps_bytes, 0, 1, 0}},
    {"rename an object, a mesh and a material", {}},
    {"set a matrix that is set already", {}},
    // 64 vertices with their normals, and the object: its box has grown.
    {"move one of 4096 vertices of a mesh", {64 * 24 + object_bytes + lamps_bytes, 0, 0, 0}},
    {"change a material's colour", {material_bytes, 0, 0, 0}},
    // Settings select the sides of a one-sided material that cast shadows. With the default, both, the layers are the
    // same.
    {"make a material one-sided", {lamps_bytes + material_bytes, edited_lamp_count, 1, 0}},
    {"change an image", {texel_bytes + lamps_bytes, 0, 1, 1}},
    // Each lamp reaches boxes with the masked material.
    {"change a mask's cutoff", {material_bytes + lamps_bytes, edited_lamp_count, 1, 0}},
    {"change a mask's image", {texel_bytes + lamps_bytes, edited_lamp_count, 1, 1}},
    {"move a lamp", {lamps_bytes + lists_bytes, 1, 0, 0}},
    {"dim a lamp", {lamps_bytes, 0, 0, 0}},
    {"rename a lamp", {lamps_bytes, 0, 0, 0}},
    {"remove a lamp", {lamps_bytes + lists_bytes, 0, 0, 0}},
    {"add a lamp", {lamps_bytes + lists_bytes, 1, 0, 0}},
    // Depth, radiance, film and light_lists. Meshes, images, objects and shadows are shared with the first viewport.
    {"a second viewport", {lamps_bytes + lists_bytes, 0, 1, 4}},
    // Shadows belong to an engine.
    {"a second engine, with a viewport", {lamps_bytes + lists_bytes, edited_lamp_count, 1, 6}},
    {"resize the viewport", {lamps_bytes + lists_bytes, 0, 1, 3}},
};

TEST(Edits, EachCostsOnlyItsChange)
{
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  const std::vector<EditCost> costs = edit_costs(*device);
  ASSERT_FALSE(costs.empty());
  EXPECT_EQ(costs.front().edit, "first picture");
  EXPECT_GT(costs.front().upload_bytes, edited_object_count * object_bytes);
  EXPECT_EQ(costs.front().shadows_drawn, std::uint64_t(edited_lamp_count));
  EXPECT_EQ(costs.size(), 1 + allowed.size());
  for (std::size_t i = 1; i < costs.size(); i++) {
    const EditCost &cost = costs[i];
    SCOPED_TRACE(cost.edit);
    ASSERT_TRUE(allowed.contains(cost.edit));
    const Allowed &most = allowed.at(cost.edit);
    EXPECT_LE(cost.upload_bytes, most.upload_bytes_max);
    EXPECT_EQ(cost.shadows_drawn, most.shadows_drawn);
    EXPECT_EQ(cost.pass_recordings, most.pass_recordings);
    EXPECT_EQ(cost.textures_made, most.textures_made);
    if (cost.edit != "a second engine, with a viewport") {
      EXPECT_EQ(cost.shaders_made, 0U);
    }
  }
}

}  // namespace
}  // namespace gnomon::measure
