// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_settings.hh"
#include "internal/eevee_blend.hh"

#include "render_materials.hh"

#include <limits>
#include <vector>

namespace gnomon::eevee {

/** Features and classes that the materials of the drawable objects need. Internal to the engine. */
struct DrawnMaterials {
  /** The class with the most inputs, and the features. */
  render_scene::MaterialClass widest_class = render_scene::MaterialClass::Plain;
  Feature features = Feature::None;
  /** Least alpha of a specular lobe; infinity without one. */
  float alpha_min = std::numeric_limits<float>::infinity();
  /** At least one has a surface function. */
  bool has_functions = false;
  std::vector<TransmissiveObject> transmissive;
  /** At least one object of `transmissive` is not smooth. */
  bool is_transmission_rough = false;

  /** Follow the scene, if its materials or \a objects, the drawable ones, have changed. */
  void update(const render_scene::RenderScene &scene, std::span<const draw::ObjectIndex> objects);

 private:
  /** Sum of the revisions from which the members were derived. */
  std::uint64_t revision_ = ~std::uint64_t(0);
};

/** The blocks of a scene's materials, as settings have them, for all viewports. Internal to the engine. */
class SceneMaterials {
 public:
  /** Create the blocks that materials need, and free the others. */
  void make(render_scene::RenderScene &scene, const Settings &settings, const DrawnMaterials &drawn);
  /** Use the current buffers of \a scene, which another engine may have made anew. */
  void follow(render_scene::RenderScene &scene);
  /** Bind the resources that lit programs read. */
  void bind(draw::ShadingGroup &group) const;
  /** Bind the resources that programs of shadow casters read. */
  void bind_casters(draw::ShadingGroup &group, bool has_function) const;
  void report(const render_scene::RenderScene &scene, ResourceReport &report) const;

 private:
  /** Empty unless Settings::light has no emission. */
  std::optional<render_scene::MaterialTable> without_emission_;
  /** Empty unless a material has a surface function. */
  gpu::Buffer function_block_;
  /** Programs read these by reference. */
  gpu::BufferRange object_block_;
  gpu::BufferRange material_block_;
  gpu::BufferRange full_material_block_;
  gpu::BufferRange layer_block_;
};

}  // namespace gnomon::eevee
