// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include "eevee_material_shared.h"
#include "gpu_device.hh"

namespace gnomon::render_scene {

/** Whether any part of the surface can be above the cutoff; a texture's alpha is at most 1. */
[[nodiscard]] bool is_drawable(const scene::Material &material);

/** Whether \a mesh can be drawn with the texture of its material: both are there, and the mesh has uvs. */
[[nodiscard]] bool is_textured(const scene::Scene &scene, const scene::Mesh &mesh);

/**
 * Whether a texture may cut some of the surface out, so that a pass must read its alpha. A mesh without uvs is not cut:
 * \see is_textured
 */
[[nodiscard]] bool is_masked(const scene::Scene &scene, const scene::Material &material);

/** \a is_masked: see the function of this name. */
[[nodiscard]] shared::MaterialData material_data(const scene::Material &material, bool is_masked);

/** `material_block`: the materials of a scene on one device, by place_of. */
class MaterialTable {
 public:
  /** Index of a material's entry. The default material's is 0; a stale handle stands for it. */
  [[nodiscard]] static std::uint32_t place_of(const scene::Scene &scene, scene::Handle<scene::Material> material);

  /** Compute the entries of the materials that changed. */
  void update(const scene::Scene &scene);
  /** Write what changed to the device. \throws gpu::Error past the limit of a storage block. */
  void upload(gpu::Device &device);
  /** Valid after upload. */
  [[nodiscard]] const gpu::Buffer &buffer() const
  {
    return buffer_;
  }
  [[nodiscard]] const shared::MaterialData &operator[](std::uint32_t place) const
  {
    return entries_[place];
  }

 private:
  std::vector<shared::MaterialData> entries_;
  gpu::Buffer buffer_;
  scene::Revision seen_ = 0;
  /** Entries that the device has not yet, as a range; empty where the begin is not below the end. */
  std::size_t changed_begin_ = 0;
  std::size_t changed_end_ = 0;
};

}  // namespace gnomon::render_scene
