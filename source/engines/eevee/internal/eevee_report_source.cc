// SPDX-License-Identifier: MIT
// Reasons why parts of a frame were left out.
#include "internal/eevee_report_source.hh"

#include <fmt/format.h>

namespace gnomon::eevee {

FrameNode folder(std::string what, std::string why, std::string why_not, std::vector<FrameNode> children)
{
  FrameNode node{.what = std::move(what)};
  for (const FrameNode &child : children) {
    node.is_made |= child.is_made;
    if (child.bytes) {
      node.bytes = node.bytes.value_or(0) + *child.bytes;
    }
    if (child.upload_bytes) {
      node.upload_bytes = node.upload_bytes.value_or(0) + *child.upload_bytes;
    }
    if (child.seconds) {
      node.seconds = node.seconds.value_or(0.0) + *child.seconds;
    }
  }
  node.why = node.is_made ? std::move(why) : std::move(why_not);
  node.children = std::move(children);
  return node;
}

std::string why_no_shadow(const ReportSource &source, std::string_view no_such_lamp)
{
  return std::string(eevee::why_no_shadow(source.data.state(source.settings), no_such_lamp));
}

std::set<std::pair<scene::Handle<scene::Image>, scene::ImageUse>> read_images(const ReportSource &source)
{
  std::set<std::pair<scene::Handle<scene::Image>, scene::ImageUse>> images;
  for (const draw::ObjectIndex object : source.data.surfaces.objects()) {
    const scene::Material &material = source.scene().material_of(source.mesh(object));
    for (const scene::TextureInput &input : scene::texture_inputs) {
      const scene::TextureSlot &slot = material.*input.slot;
      if (render_scene::is_drawable(source.scene(), source.mesh(object), slot)) {
        images.emplace(source.scene().textures()[slot.texture].image,
                       render_scene::use_of(source.scene(), material, input));
      }
    }
  }
  return images;
}

std::string why_no_texture(const scene::Mesh &mesh, const scene::TextureInput &input, const scene::TextureSlot &slot)
{
  if (slot && !mesh.has_uvs(slot.uv_set)) {
    return fmt::format("it has no {}uvs", slot.uv_set == 0 ? "" : "second ");
  }
  const bool needs_tangents =
      input.slot == &scene::Material::normal_texture || input.slot == &scene::Material::coat_normal_texture;
  return slot && needs_tangents && !mesh.has_tangents() ? "it has no tangents" : "";
}

std::string why_no_feature(const ReportSource &source, Feature feature)
{
  if (feature == Feature::TargetDepth) {
    return source.data.output.target() ? "the target takes no depth" : no_target;
  }
  if (feature == Feature::BaseColorTexture && source.data.is_recorded && read_images(source).empty()) {
    return "no material that is drawn has a texture";
  }
  if (feature == Feature::Transmission) {
    return source.data.is_recorded ? "nothing in the view transmits light" : nothing_seen;
  }
  if (feature == Feature::Light || !source.has(Feature::Light)) {
    const bool is_mask = feature == Feature::AlphaMask;
    if (!source.data.is_recorded &&
        (is_mask || feature == Feature::BaseColorTexture || feature == Feature::FullMaterial)) {
      return nothing_seen;
    }
    return is_mask                            ? "no texture's alpha cuts a material out"
           : feature == Feature::FullMaterial ? no_full_material
                                              : "no lamp gives light";
  }
  switch (feature) {
    case Feature::LightClusters: return "few lamps have a range";
    case Feature::Punctual: return "no point, spot or area lamp gives light";
    case Feature::Specular: return source.data.is_recorded ? "every material is Lambertian" : nothing_seen;
    case Feature::ShadowCube: return why_no_shadow(source, "no point lamp or wide spot casts a shadow of depths");
    case Feature::ShadowMap: return why_no_shadow(source, "no sun or spot casts a shadow of depths");
    case Feature::ShadowPcf: return why_no_shadow(source, "no shadow is filtered by percentage-closer lookups");
    case Feature::ShadowEsm: return why_no_shadow(source, "no lamp casts an exponential shadow");
    case Feature::ShadowEvsm: return why_no_shadow(source, "no lamp casts an exponential variance shadow");
    case Feature::BaseColorTexture:
      return source.data.is_recorded ? "no material that is drawn has a texture" : nothing_seen;
    case Feature::LampShape: return "no lamp has an extent, and no spot's cone is an ellipse";
    case Feature::World: return "the scene has no world";
    case Feature::Multiscatter:
      return source.settings.has_multiscatter ? why_no_feature(source, Feature::Specular) : "not asked for";
    case Feature::OpacityThreshold:
      return why_no_shadow(source, "no material that is blended or transmits light casts a shadow");
    case Feature::FullMaterial: return source.data.is_recorded ? no_full_material : nothing_seen;
    case Feature::Layers:
      return source.data.is_recorded ? "no material has a coat, sheen or anisotropy, or transmits light" : nothing_seen;
    case Feature::AlphaMask: return source.data.is_recorded ? "no texture's alpha cuts a material out" : nothing_seen;
    // Answered above.
    case Feature::Light:
    case Feature::TargetDepth:
    case Feature::Transmission:
    // Constants of programs are not in reports.
    case Feature::LampHighlights:
    case Feature::WorldOcclusion:
    case Feature::CoarseGrid:
    case Feature::ClipPlanes:
    case Feature::SurfaceInLayers:
    case Feature::SurfacePoints:
    case Feature::LinesOrPoints:
    case Feature::None: break;
  }
  return "";
}

std::string why_no_program(const ReportSource &source, ShaderId id)
{
  const std::string no_esm = why_no_feature(source, Feature::ShadowEsm);
  const std::string no_evsm = why_no_feature(source, Feature::ShadowEvsm);
  const std::string other_kernel = "exponential shadows use another filter";
  const auto if_seen = [&](std::string why) { return source.data.is_recorded ? std::move(why) : nothing_seen; };
  switch (id) {
    case ShaderId::Probe: return source.settings.has_probe ? "no lamp was probed" : "not asked for";
    case ShaderId::Surfaces: return source.settings.has_surfaces ? nothing_seen : "not asked for";
    case ShaderId::DebugShadow: return "not asked for";
    case ShaderId::DebugCascades:
      return source.data.shared->lights.plan().tinted
                 ? nothing_seen
                 : (source.settings.has_cascade_tint ? "no sun has a shadow" : "not asked for");
    case ShaderId::BackgroundColor:
    case ShaderId::BackgroundWorld:
      return source.settings.background.kind == Background::Kind::None ? "no background was asked for" : nothing_seen;
    case ShaderId::Tonemap: return source.data.output.target() ? nothing_seen : no_target;
    case ShaderId::Shadow:
    case ShaderId::ShadowLayered:
    case ShaderId::ShadowGeometry:
      return if_seen(source.has(any_shadow) ? "another method draws the layers"
                                            : why_no_shadow(source, "no lamp casts a shadow"));
    case ShaderId::EsmDistance:
    case ShaderId::EsmDisk4:
    case ShaderId::EsmDisk32:
    case ShaderId::EsmSeparable: return if_seen(source.has(Feature::ShadowEsm) ? other_kernel : no_esm);
    case ShaderId::EvsmDisk4:
    case ShaderId::EvsmDisk32:
    case ShaderId::EvsmSeparable: return if_seen(source.has(Feature::ShadowEvsm) ? other_kernel : no_evsm);
    case ShaderId::DepthFunction: return if_seen("no surface function can cut a material out");
    case ShaderId::Depth:
    case ShaderId::Lit: return if_seen(source.data.depth.has_gbuffer() ? std::string(all_in_gbuffer) : nothing_seen);
    case ShaderId::GBuffer:
    case ShaderId::DeferredLit: return if_seen(std::string(why_forward));
    case ShaderId::AdaptiveTest:
    case ShaderId::AdaptiveSpread:
    case ShaderId::AdaptiveDepth:
    case ShaderId::AdaptiveScale:
      return source.settings.noise_threshold > 0.0F ? "all pixels get all samples" : "not asked for";
    case ShaderId::Film: return nothing_seen;
  }
  return nothing_seen;
}

}  // namespace gnomon::eevee
