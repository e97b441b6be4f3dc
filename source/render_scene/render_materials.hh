// SPDX-License-Identifier: MIT
#pragma once

#include "render_scene.hh"

#include "eevee_material_shared.h"

namespace gnomon::render_scene {

/**
 * Whether the material can draw any pixel. false: the alpha factor of a masked material is below its cutoff, or that of
 * a blended material is 0; textures and vertex colours cannot increase alpha.
 */
[[nodiscard]] bool is_drawable(const scene::Material &material);
/** The same; true if the material has a surface function, which may change alpha. */
[[nodiscard]] bool is_drawable(const scene::Scene &scene, const scene::Material &material);

/** Whether the material has a surface function, which is still in the scene. */
[[nodiscard]] bool has_surface_function(const scene::Scene &scene, const scene::Material &material);

/**
 * Whether the mesh is blended over the picture behind it. false: another alpha mode, or all of it is opaque by its
 * factor and its texture, and it has no surface function.
 */
[[nodiscard]] bool is_blended(const scene::Scene &scene, const scene::Mesh &mesh);

/**
 * Whether a part of the light goes through the mesh: it is blended, or transmits light. A material with a transmission
 * texture counts as an opaque one, and a masked one as what its mask leaves.
 */
[[nodiscard]] bool lets_light_through(const scene::Scene &scene, const scene::Mesh &mesh);

/**
 * Whether a part of a lamp's light goes straight on through the mesh: lets_light_through, and it is no body of a
 * thickness, which refracts light. Nothing draws the light that it would focus elsewhere.
 */
[[nodiscard]] bool has_open_shadow(const scene::Scene &scene, const scene::Mesh &mesh);

/**
 * Whether the mesh has triangles, and no open shadow: shadow layers show it in each sample. Lines and points cast no
 * shadows.
 */
[[nodiscard]] bool has_closed_shadow(const scene::Scene &scene, const scene::Mesh &mesh);

/** Part of white light that passes a white surface of the material, without its textures; for shadows. */
[[nodiscard]] float transmitted_part(const scene::Material &material);

/** Whether \a slot can be drawn on \a mesh: the texture, its image and the mesh's uvs exist. */
[[nodiscard]] bool is_drawable(const scene::Scene &scene, const scene::Mesh &mesh, const scene::TextureSlot &slot);

/** The class of a mesh with its material. Ignores textures that cannot be drawn. */
[[nodiscard]] MaterialClass material_class(const scene::Scene &scene, const scene::Mesh &mesh);

/** Whether a texture, vertex colours or a surface function may mask parts of the surface, so that depth passes must
 * read alpha. */
[[nodiscard]] bool is_masked(const scene::Scene &scene, const scene::Mesh &mesh);

/** The material without its textures. Emission is 0 if the material has an emissive texture. */
[[nodiscard]] shared::MaterialData material_data(const scene::Material &material);
/** The material with its textures and uv transforms. Emission is 0 if its emissive texture cannot be drawn. */
[[nodiscard]] shared::FullMaterialData full_material_data(const scene::Scene &scene, const scene::Material &material);
/** The layers over the base of the material, its anisotropy and its transmission. */
[[nodiscard]] shared::LayerData layer_data(const scene::Material &material);

/** `material_block`, `full_material_block` and `layer_block`: the materials of a scene on one device. */
class MaterialTable {
 public:
  /** LeftOut: as if no material emitted light. */
  enum class Emission { Kept, LeftOut };
  explicit MaterialTable(Emission emission = Emission::Kept) : emission_(emission) {}

  /** Index of a material's entry. Stale handles get the default material, whose index is 0. */
  [[nodiscard]] static std::uint32_t place_of(const scene::Scene &scene, scene::Handle<scene::Material> material);

  /** Recompute the entries if materials, textures, images or surface functions have changed. */
  void update(const scene::Scene &scene);
  /**
   * Write the changed entries to the device. \a widest: the class with the most inputs that shaders read.
   * `full_material_block` and `layer_block` are created when a class first needs them.
   * \throws gpu::Error if a block exceeds the limit of the device
   */
  void upload(gpu::Device &device, MaterialClass widest);
  /** `material_block`; valid after upload. */
  [[nodiscard]] const gpu::Buffer &buffer() const
  {
    return entries_block_.buffer;
  }
  /** `full_material_block`; empty until upload() was called with MaterialClass::Full or a later class. */
  [[nodiscard]] const gpu::Buffer &full_buffer() const
  {
    return full_block_.buffer;
  }
  /** `layer_block`; empty until upload() was called with MaterialClass::Layered or a later class. */
  [[nodiscard]] const gpu::Buffer &layer_buffer() const
  {
    return layer_block_.buffer;
  }
  [[nodiscard]] const shared::MaterialData &operator[](std::uint32_t place) const
  {
    return entries_[place];
  }

 private:
  struct Block {
    gpu::Buffer buffer;
    /** Range of the entries that must be uploaded; empty if changed_begin >= changed_end. */
    std::size_t changed_begin = 0;
    std::size_t changed_end = 0;
    /** gpu::Device::loss_count at the last upload. */
    std::uint64_t loss_count = 0;
  };
  /** Replaces \a entries by \a changed and extends the block's range by the entries that differ. */
  template <typename Entry>
  static void replace(std::vector<Entry> &entries, std::vector<Entry> changed, Block &block);
  template <typename Entry>
  static void upload(gpu::Device &device, const char *name, const std::vector<Entry> &entries, Block &block);

  Emission emission_;
  std::vector<shared::MaterialData> entries_;
  std::vector<shared::FullMaterialData> full_entries_;
  std::vector<shared::LayerData> layer_entries_;
  Block entries_block_;
  Block full_block_;
  Block layer_block_;
  /** Latest revision of the materials, textures, images and surface functions at the last update(). */
  scene::Revision seen_ = 0;
};

}  // namespace gnomon::render_scene
