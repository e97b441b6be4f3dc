// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include "eevee_material_shared.h"
#include "gpu_device.hh"

namespace gnomon::render_scene {

/** Whether any part of the surface can be above the cutoff; a texture's alpha is at most 1. */
[[nodiscard]] bool is_drawable(const scene::Material &material);

/** The inputs of a surface, from the fewest. Programs have a variant for each. */
enum class MaterialClass : std::uint8_t {
  /** Factors alone. */
  Plain,
  /** And a base colour texture, at the first set of uvs as they are. */
  BaseColor,
  /** Any textures, either set of uvs, transforms of uvs, vertex colours. */
  Full
};

/** Whether \a mesh is drawn with \a slot of its material: the texture, its image, and the mesh's uvs are there. */
[[nodiscard]] bool is_drawable(const scene::Scene &scene, const scene::Mesh &mesh, const scene::TextureSlot &slot);

/** The class of a mesh with its material. Textures that cannot be drawn do not count. */
[[nodiscard]] MaterialClass material_class(const scene::Scene &scene, const scene::Mesh &mesh);

/** Whether a texture or vertex colours may cut some of the surface out, so that a pass must read alpha. */
[[nodiscard]] bool is_masked(const scene::Scene &scene, const scene::Mesh &mesh);

/** The material without its textures. One that emits by a texture does not emit then. */
[[nodiscard]] shared::MaterialData material_data(const scene::Material &material);
[[nodiscard]] shared::FullMaterialData full_material_data(const scene::Scene &scene, const scene::Material &material);

/** `material_block` and `full_material_block`: the materials of a scene on one device, by place_of. */
class MaterialTable {
 public:
  /** Index of a material's entry. The default material's is 0; a stale handle stands for it. */
  [[nodiscard]] static std::uint32_t place_of(const scene::Scene &scene, scene::Handle<scene::Material> material);

  /** Compute the entries of the materials that changed. */
  void update(const scene::Scene &scene);
  /**
   * Write what changed to the device; full_material_block where \a needs_full or it was needed before. \throws
   * gpu::Error past the limit of a storage block.
   */
  void upload(gpu::Device &device, bool needs_full);
  /** `material_block`; valid after upload. */
  [[nodiscard]] const gpu::Buffer &buffer() const
  {
    return entries_block_.buffer;
  }
  /** `full_material_block`; names nothing unless it was needed. */
  [[nodiscard]] const gpu::Buffer &full_buffer() const
  {
    return full_block_.buffer;
  }
  [[nodiscard]] const shared::MaterialData &operator[](std::uint32_t place) const
  {
    return entries_[place];
  }

 private:
  struct Block {
    gpu::Buffer buffer;
    /** Entries that the device has not yet, as a range; empty where the begin is not below the end. */
    std::size_t changed_begin = 0;
    std::size_t changed_end = 0;
    /** gpu::Device::loss_count at the last upload. */
    std::uint64_t loss_count = 0;
  };
  template <typename Entry>
  static void replace(std::vector<Entry> &entries, std::vector<Entry> changed, Block &block);
  template <typename Entry>
  static void upload(gpu::Device &device, const char *name, const std::vector<Entry> &entries, Block &block);

  std::vector<shared::MaterialData> entries_;
  std::vector<shared::FullMaterialData> full_entries_;
  Block entries_block_;
  Block full_block_;
  scene::Revision seen_ = 0;
};

}  // namespace gnomon::render_scene
