// SPDX-License-Identifier: MIT
#include "internal/eevee_materials.hh"
#include "internal/eevee_resource_report.hh"

#include "internal/eevee_material_variants.hh"
#include "internal/eevee_surface_functions.hh"

#include <fmt/format.h>

#include <algorithm>

namespace gnomon::eevee {

using render_scene::MaterialClass;

void DrawnMaterials::update(const render_scene::RenderScene &render_scene, std::span<const draw::ObjectIndex> objects)
{
  const std::uint64_t revision =
      render_scene.materials_revision() + render_scene.passes_revision() + render_scene.objects().structure_revision();
  if (revision_ == revision) {
    return;
  }
  *this = {};
  const scene::Scene &scene = render_scene.scene();
  std::vector<std::optional<MaterialClass>> classes(scene.meshes().index_end());
  for (const draw::ObjectIndex object : objects) {
    const scene::Handle<scene::Mesh> handle = render_scene.object(object).mesh;
    std::optional<MaterialClass> &material_class = classes[handle.index];
    if (material_class && *material_class != MaterialClass::Transmissive) {
      continue;
    }
    const scene::Mesh &mesh = scene.meshes()[handle];
    const scene::Material &material = scene.material_of(mesh);
    const shared::MaterialData &data =
        render_scene.materials()[render_scene::MaterialTable::place_of(scene, mesh.material)];
    material_class = render_scene::material_class(scene, mesh);
    const bool has_function = render_scene::has_surface_function(scene, material);
    has_functions |= has_function;
    const bool is_specular = data.specular_f90 > 0.0F || *material_class >= MaterialClass::Layered || has_function;
    features = features | (is_specular ? Feature::Specular : Feature::None) | feature_of(*material_class);
    if (is_specular) {
      // Textures and functions may make any lobe.
      const bool is_uniform = *material_class == MaterialClass::Plain && !has_function;
      alpha_min = std::min(alpha_min, is_uniform ? data.alpha : 0.0F);
    }
    widest_class = std::max(widest_class, *material_class);
    if (*material_class == MaterialClass::Transmissive) {
      transmissive.push_back({object, render_scene::is_blended(scene, mesh)});
      is_transmission_rough |= has_function || material.roughness > 0.0F;
    }
  }
  revision_ = revision;
}

void SceneMaterials::make(render_scene::RenderScene &scene, const Settings &settings, const DrawnMaterials &drawn)
{
  using render_scene::MaterialTable;
  const bool has_emission = settings.light.has(LightComponent::Kind::Emission);
  scene.upload(drawn.widest_class);
  if (has_emission) {
    without_emission_.reset();
  }
  else {
    if (!without_emission_) {
      without_emission_.emplace(MaterialTable::Emission::LeftOut);
    }
    without_emission_->update(scene.scene());
    without_emission_->upload(scene.device(), drawn.widest_class);
  }
  update_surface_functions(function_block_, scene.device(), drawn.has_functions,
                           {glm::vec3(scene.origin_ws()), has_emission ? 1.0F : 0.0F});
}

void SceneMaterials::follow(render_scene::RenderScene &scene)
{
  const render_scene::MaterialTable &materials = without_emission_ ? *without_emission_ : scene.materials();
  object_block_ = {scene.objects().buffer().id()};
  material_block_ = {materials.buffer().id()};
  full_material_block_ = {materials.full_buffer().id()};
  layer_block_ = {materials.layer_buffer().id()};
}

void SceneMaterials::bind(draw::ShadingGroup &group) const
{
  group.bind_storage_ref("material_block", &material_block_);
  group.bind_storage_ref("full_material_block", &full_material_block_);
  group.bind_storage_ref("layer_block", &layer_block_);
  if (function_block_) {
    group.bind_uniform("surface_function_block", function_block_);
  }
}

void SceneMaterials::bind_casters(draw::ShadingGroup &group, bool has_function) const
{
  group.bind_storage_ref("object_block", &object_block_);
  group.bind_storage_ref("material_block", &material_block_);
  group.bind_storage_ref("full_material_block", &full_material_block_);
  if (has_function) {
    group.bind_uniform("surface_function_block", function_block_);
  }
}

void SceneMaterials::report(const render_scene::RenderScene &scene, ResourceReport &report) const
{
  const render_scene::MaterialTable &materials = scene.materials();
  const std::string count = fmt::format("{} materials", scene.scene().materials().size());
  report.add_block(scene.objects().buffer(), "object_block", fmt::format("{} matrices", scene.objects().size()),
                   nothing_seen);
  report.add_block(materials.buffer(), "material_block", count, nothing_seen);
  report.add_block(materials.full_buffer(), "full_material_block", count,
                   report.is_recorded ? no_full_material : nothing_seen);
  report.add_block(materials.layer_buffer(), "layer_block", count, report.why_no_feature(Feature::Layers));
  report.add_block(function_block_, "surface_function_block", "surface functions of materials",
                   report.is_recorded ? "no material that is drawn has a surface function" : nothing_seen);
}

}  // namespace gnomon::eevee
