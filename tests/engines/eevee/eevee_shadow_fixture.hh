// SPDX-License-Identifier: MIT
#pragma once

#include "shadows/shadow_casters.hh"
#include "shadows/shadow_plan.hh"
#include "shadows/shadows.hh"

#include "eevee_shaders.hh"

#include "gpu/gpu_testing.hh"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace gnomon::eevee {

inline scene::Bounds box_at(const glm::vec3 &center, float half)
{
  scene::Bounds box;
  box.extend(center - half);
  box.extend(center + half);
  return box;
}

/** Shadows of a few lamps on the null device. Each box is a caster. */
class ShadowsTest : public testing::Test {
 protected:
  /** The reference holds until the next lamp is added or removed. */
  scene::PlacedLamp &add_lamp(scene::LampKind kind, const std::string &name, const glm::vec3 &position = glm::vec3(0))
  {
    scene::PlacedLamp lamp;
    lamp.kind = kind;
    lamp.name = name;
    lamp.spot_outer_angle = 0.5F;
    lamp.world_from_lamp[3] = glm::dvec4(position, 1.0);
    lamp.node = {next_node++, 1};
    placed.push_back(lamp);
    return placed.back();
  }
  void remove_lamp(std::size_t index)
  {
    placed.erase(placed.begin() + std::ptrdiff_t(index));
  }
  std::vector<ShadowLamp> identified_lamps()
  {
    lamps = make_lamps(placed);
    return shadow_lamps(placed, lamps);
  }
  scene::Bounds bounds_ws() const
  {
    scene::Bounds bounds;
    for (const scene::Bounds &box : casters) {
      bounds.extend(box);
    }
    return bounds;
  }
  void sync(const ShadowSettings &asked = {})
  {
    const std::vector<ShadowLamp> identified = identified_lamps();
    scene_shadows.sync(device->limits(), identified, bounds_ws(), lamps.lights, asked);
    scene_shadows.allocate(*device, shaders);
    shadows.allocate(*device);
    pass.clear();
    draw::ShadingGroup &group = pass.group(shader);
    group.bind_uniform_ref("shadow_render_block", scene_shadows.render_block());
    group.bind_storage("object_block", objects);
    draw::InstanceCall &instances = group.instances(batch);
    for (std::size_t i = 0; i < casters.size(); i++) {
      scene_shadows.add_caster({casters[i], draw::ObjectIndex(i), &instances,
                                fingerprint_of(std::as_bytes(std::span(&casters[i], 1))), mesh, &world_from_mesh});
    }
    scene_shadows.finish();
  }
  std::string update()
  {
    gpu::CommandList list;
    shadows.update(*device, view, 0.001F, pass, list);
    device->submit(list);
    shadows.submitted();
    return list.serialize(*device);
  }
  /** Lamps updated by a sync and an update. */
  std::uint64_t updated()
  {
    const std::uint64_t before = shadows.counters().lamps_updated;
    sync(settings);
    update();
    return shadows.counters().lamps_updated - before;
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  std::array<glm::vec3, 3> positions = {glm::vec3(0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)};
  std::array<std::uint32_t, 3> indices = {0, 1, 2};
  gpu::Batch batch = device->create_batch({"triangle", positions, {}, indices});
  gpu::Buffer objects = device->create_buffer({"object_block", gpu::BufferKind::Storage, 4096});
  ShaderCache shaders;
  const gpu::Shader &shader = shaders.get(*device, ShaderId::Shadow);
  draw::Pass pass{"casters", gpu::State::WriteDepth};
  std::vector<scene::PlacedLamp> placed;
  /** Index of the next lamp's node. */
  std::uint32_t next_node = 100;
  /** The triangles of each caster, in world space; nullptr: only the boxes are known. */
  const scene::Mesh *mesh = nullptr;
  glm::mat4 world_from_mesh{1.0F};
  std::vector<scene::Bounds> casters = {box_at({0, 0, -3}, 1.0F)};
  ShadowSettings settings;
  Lamps lamps;
  SceneShadows scene_shadows;
  Shadows shadows{scene_shadows};
  draw::View view{glm::mat4(1.0F), draw::perspective(1.0F, 1.0F, 0.1F, 100.0F)};
};

}  // namespace gnomon::eevee
