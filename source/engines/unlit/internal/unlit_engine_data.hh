// SPDX-License-Identifier: MIT
#pragma once

#include "unlit_engine.hh"
#include "unlit_programs.hh"

#include "draw_target_pass.hh"
#include "render_surfaces.hh"

#include <optional>
#include <vector>

/** The engine's data in a viewport. Internal to source/engines/unlit. */
namespace gnomon::unlit {

[[nodiscard]] inline Feature feature_of(render_scene::MaterialClass material_class)
{
  using render_scene::MaterialClass;
  switch (material_class) {
    case MaterialClass::BaseColor: return Feature::BaseColorTexture;
    case MaterialClass::Full: return Feature::FullMaterial;
    default: return Feature::None;
  }
}

[[nodiscard]] inline Feature mask_features(render_scene::MaterialClass mask_class)
{
  return mask_class == render_scene::MaterialClass::Plain
             ? Feature::None
             : Feature::AlphaMask | (feature_of(mask_class) & Feature::FullMaterial);
}

/** Blocks of the render scene. Passes read them by reference. */
struct SceneBlocks {
  gpu::BufferRange materials;
  gpu::BufferRange full_materials;

  void update(const render_scene::RenderScene &scene)
  {
    materials = {scene.materials().buffer().id()};
    full_materials = {scene.materials().full_buffer().id()};
  }
  void bind(draw::ShadingGroup &group) const
  {
    group.bind_storage_ref("material_block", &materials);
    group.bind_storage_ref("full_material_block", &full_materials);
  }
};

/** Revisions of everything that recorded passes depend on. */
struct PassesKey {
  std::uint64_t structure = 0;
  std::uint64_t passes = 0;
  std::uint64_t settings = 0;
  std::uint64_t losses = 0;
  gpu::ResourceId depth_texture = 0;
  bool is_clipped = false;
  Display display{};

  bool operator==(const PassesKey &) const = default;
};

/** Revisions of everything that a picture depends on, except its view and size. */
struct PictureKey {
  std::uint64_t scene = 0;
  std::uint64_t settings = 0;
  Display display{};

  bool operator==(const PictureKey &) const = default;
};

/** Revisions of everything that the depth camera's picture depends on, except its size. */
struct DepthKey {
  std::uint64_t objects = 0;
  std::uint64_t passes = 0;
  std::uint64_t losses = 0;
  std::uint64_t content = 0;
  draw::View view;

  bool operator==(const DepthKey &) const = default;
};

/** An object of the pass of blended surfaces, with its groups: the backs of a two-sided surface, and the fronts. */
struct BlendedObject {
  draw::ObjectIndex object = 0;
  std::uint32_t first_group = 0;
  std::uint32_t group_count = 0;
};

/** The engine's data in a viewport. */
struct Data final : draw::EngineViewportData {
  void resized() override
  {
    framebuffer = {};
    radiance = {};
  }

  Display display{};
  std::vector<draw::ObjectIndex> objects;
  /** True between cache_init and cache_finish. */
  bool is_collecting = false;
  /** By object index: whether the passes were recorded with a mirrored matrix. */
  std::vector<bool> is_mirrored;
  bool is_winding_changed = false;
  /** The class of materials with the most inputs. */
  render_scene::MaterialClass widest = render_scene::MaterialClass::Plain;
  /** The visible objects of the last sample. */
  draw::VisibleObjects visible;
  bool is_seen = false;
  gpu::Texture radiance;
  gpu::Framebuffer framebuffer;
  gpu::Buffer view_block;
  /** The view has clip planes. */
  bool is_clipped = false;
  gpu::Sampler nearest;
  SceneBlocks blocks;
  std::optional<draw::Pass> surfaces;
  /** Surfaces that transmit light, blended over the others. */
  std::optional<draw::Pass> blended_surfaces;
  std::vector<BlendedObject> blended;
  draw::Pass target{"target", gpu::State::WriteColor};
  draw::TargetPass target_pass;
  /** Values of the depth camera. The passes of surfaces read them by reference. \see unlit_depth_camera_lib.glsl */
  glm::mat4 depth_clip_from_world{1.0F};
  glm::vec3 depth_tolerance{0.0F};
  PassesKey recorded;
  std::optional<PictureKey> synced_picture;
};

struct Engine::DepthCamera {
  draw::View view;
  gpu::Texture texture;
  gpu::Framebuffer framebuffer;
  gpu::Buffer view_block;
  SceneBlocks blocks;
  std::optional<draw::Pass> casters;
  PassesKey recorded;
  /** Key of the picture in the texture; empty if the texture has no content. */
  std::optional<DepthKey> drawn;
};

}  // namespace gnomon::unlit
