// SPDX-License-Identifier: MIT
// The nodes of a report for targets, blocks, meshes and textures.
#include "internal/eevee_report_source.hh"
#include "internal/eevee_resource_report.hh"

#include "shadows/shadow_octahedral_store.hh"

#include <fmt/format.h>

namespace gnomon::eevee {

static FrameNode resource_node(const gpu::Device &device, const gpu::Resource &resource, std::string what,
                               std::string why, std::string why_not)
{
  FrameNode node{.what = std::move(what), .is_made = bool(resource)};
  if (!resource) {
    node.why = std::move(why_not);
    return node;
  }
  const gpu::LiveResource live = device.live(resource);
  node.why = live.detail.empty() ? std::move(why) : fmt::format("{}: {}", live.detail, why);
  node.bytes = live.size_bytes;
  return node;
}

void ResourceReport::add_target(const gpu::Texture &texture, std::string what, std::string why, std::string why_not)
{
  targets.push_back(resource_node(device, texture, std::move(what), std::move(why), std::move(why_not)));
}

void ResourceReport::add_block(const gpu::Buffer &buffer, std::string what, std::string why, std::string why_not)
{
  FrameNode &node =
      blocks.emplace_back(resource_node(device, buffer, std::move(what), std::move(why),
                                        is_recorded || !has(Feature::Light) ? std::move(why_not) : nothing_seen));
  if (buffer) {
    node.upload_bytes = device.live(buffer).upload_bytes;
  }
}

/** Adds the resources of \a shadows. */
static void report_shadows(const Shadows &shadows, const std::string &no_shadow, ResourceReport &report)
{
  const SceneShadows &scene = shadows.scene();
  const auto why_no_layers = [&](Feature feature) {
    return !report.has(feature)  ? report.why_no_feature(feature)
           : !report.is_recorded ? nothing_seen
                                 : "no caster can shadow a visible surface";
  };
  report.add_target(scene.cubes(), "shadow_cubes", fmt::format("{} point lamps or wide spots", scene.cube_count()),
                    why_no_layers(Feature::ShadowCube));
  report.add_target(scene.maps(), "shadow_maps", fmt::format("{} suns or spots", scene.map_count()),
                    why_no_layers(Feature::ShadowMap));
  report.add_target(scene.distance_cube(), "shadow_distance_cube", "temporary depths for octahedral layers",
                    why_no_layers(Feature::ShadowEsm));
  if (scene.octahedral().textures().empty()) {
    report.add_target({}, "shadow_esm", "", why_no_layers(Feature::ShadowEsm));
  }
  for (const gpu::Texture *texture : scene.octahedral().textures()) {
    report.add_target(*texture, texture->desc().name, "exponential shadows", "");
  }
  report.add_block(shadows.block(), "shadow_block", "shadows of depths",
                   report.has(any_shadow) ? "all shadows are exponential" : no_shadow);
  report.add_block(scene.render_blocks(), "shadow_render_block", "views that casters are drawn with", no_shadow);
  report.add_block(scene.octahedral().block(), "esm_block", "exponential shadows",
                   report.why_no_feature(Feature::ShadowEsm));
}

std::array<FrameNode, 2> resource_nodes(const ReportSource &source)
{
  const Data &data = source.data;
  const SharedData &shared = *data.shared;
  ResourceReport report{source.device(), source.settings, data.features, data.is_recorded,
                        [&](Feature feature) { return why_no_feature(source, feature); }};
  data.film.report(report);
  data.output.report(report);
  data.buffers.report(source.viewport, report);
  data.transmission.report(report);
  data.probe.report(report);
  data.adaptive.report(report);
  report.add_target(data.shadow_picture.texture(), "shadow_picture", "asked for", not_asked_for);
  shared.materials.report(source.render_scene, report);
  shared.lights.report(report);
  data.lights.report(report);
  shared.tables.report(report);
  shared.world.report(report);
  report_shadows(data.shadows, why_no_shadow(source, "no lamp casts a shadow"), report);
  return {folder("targets", "what passes draw into", "", std::move(report.targets)),
          folder("blocks", "what programs read", nothing_seen, std::move(report.blocks))};
}

static std::string element_count(const scene::Mesh &mesh)
{
  constexpr std::array<const char *, 3> names = {"triangles", "lines", "points"};
  if (mesh.host_shape) {
    return names[std::size_t(mesh.topology)];
  }
  return fmt::format("{} {}", mesh.indices.size() / index_count_of(mesh.topology), names[std::size_t(mesh.topology)]);
}

FrameNode mesh_nodes(const ReportSource &source)
{
  const scene::Scene &scene = source.scene();
  std::set<scene::Handle<scene::Mesh>> used;
  for (const scene::Object &object : scene.objects()) {
    used.insert(object.mesh);
  }
  const gpu::Batch none;
  std::vector<FrameNode> meshes;
  for (const auto &[handle, mesh] : scene.meshes()) {
    const gpu::Batch *made = source.render_scene.meshes().find(handle);
    const gpu::Batch &batch = made ? *made : none;
    FrameNode &node = meshes.emplace_back(resource_node(
        source.device(), batch, mesh.name, element_count(mesh),
        !used.contains(handle)                                       ? "no object has it"
        : !source.render_scene.meshes().has_shape(handle, mesh)      ? "the host has named no buffers of it"
        : !render_scene::is_drawable(scene, scene.material_of(mesh)) ? "its material is cut out everywhere"
                                                                     : nothing_seen));
    if (batch) {
      node.upload_bytes = source.device().live(batch).upload_bytes;
    }
  }
  return folder("meshes", "objects' triangles, lines and points",
                scene.meshes().empty() ? "there is none" : nothing_seen, std::move(meshes));
}

FrameNode texture_nodes(const ReportSource &source)
{
  std::vector<FrameNode> images;
  const auto read = read_images(source);
  const gpu::Texture none;
  for (const auto &[handle, image] : source.scene().images()) {
    using scene::ImageUse;
    const auto is_read_as = [&, image_handle = handle](ImageUse use) { return read.contains({image_handle, use}); };
    for (const ImageUse use : {ImageUse::Color, ImageUse::Coverage, ImageUse::Mask, ImageUse::Data}) {
      const gpu::Texture *made = source.render_scene.images().find(handle, use);
      const bool is_read = is_read_as(use);
      // An image without a reader gets one node instead of four.
      const bool is_first = use == ImageUse::Color && !is_read_as(ImageUse::Coverage) && !is_read_as(ImageUse::Mask) &&
                            !is_read_as(ImageUse::Data);
      if (!made && !is_read && !is_first) {
        continue;
      }
      FrameNode &node = images.emplace_back(
          resource_node(source.device(), made ? *made : none, image.name,
                        use == ImageUse::Data ? "data that a material looks up" : "colours that a material looks up",
                        !is_read                   ? "no object has a material that looks it up"
                        : !source.data.is_recorded ? nothing_seen
                                                   : "no lamp lights it, and it cuts nothing out"));
      if (made) {
        node.upload_bytes = source.device().live(*made).upload_bytes;
      }
    }
  }
  return folder("textures", "images of the materials' textures",
                images.empty() ? "no material has one" : "no texture is read", std::move(images));
}

}  // namespace gnomon::eevee
