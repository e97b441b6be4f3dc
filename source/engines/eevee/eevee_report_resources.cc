// SPDX-License-Identifier: MIT
// The nodes of a report for targets, blocks, meshes and textures.
#include "eevee_report_source.hh"

#include <fmt/format.h>

namespace gnomon::eevee {

namespace {

FrameNode resource_node(const ReportSource &source, const gpu::Resource &resource, std::string what, std::string why,
                        std::string why_not)
{
  FrameNode node{.what = std::move(what), .is_made = bool(resource)};
  if (!resource) {
    node.why = std::move(why_not);
    return node;
  }
  const gpu::LiveResource live = source.device().live(resource);
  node.why = live.detail.empty() ? std::move(why) : fmt::format("{}: {}", live.detail, why);
  node.bytes = live.size_bytes;
  return node;
}

}  // namespace

FrameNode target_nodes(const ReportSource &source)
{
  const TextureList &txl = source.data.txl;
  const SceneShadows &shadows = source.data.shared->shadows;
  std::vector<FrameNode> targets;
  const auto add = [&](const gpu::Texture &texture, std::string what, std::string why, std::string why_not) {
    targets.push_back(resource_node(source, texture, std::move(what), std::move(why), std::move(why_not)));
  };
  const std::string not_asked = "not asked for";
  add(txl.film, "film", "the picture", "");
  targets.push_back({.what = "target",
                     .is_made = bool(source.data.target),
                     .why = source.data.target ? "the target of the last draw" : no_target});
  add(txl.picture_depth, "picture_depth", "the target takes depth", "no target takes the depth of several samples");
  if (source.viewport.has_depth_texture()) {
    add(source.viewport.depth_texture(), "depth", "each pixel is lit once", "");
  }
  else {
    add({}, "depth", "", nothing_seen);
  }
  add(txl.radiance, "radiance", "one sample, before the pixel filter", nothing_seen);
  add(txl.behind, "behind", "what is seen through surfaces", why_no_feature(source, Feature::Transmission));
  add(txl.probe_position, "probe_position", "asked for", source.settings.has_probe ? nothing_seen : not_asked);
  add(txl.probe_normal, "probe_normal", "asked for", source.settings.has_probe ? nothing_seen : not_asked);
  for (const auto &[texture, name] : {std::pair(&txl.surface_position, "surface_position"),
                                      {&txl.surface_normal, "surface_normal"},
                                      {&txl.surface_albedo, "surface_albedo"}}) {
    add(*texture, name, "asked for", source.settings.has_surfaces ? nothing_seen : not_asked);
  }
  for (const auto &[texture, name] : {std::pair(&source.data.adaptive.film_converged, "film_converged"),
                                      {&source.data.adaptive.drawn_converged, "drawn_converged"}}) {
    add(*texture, name, "pixels that need no more samples",
        source.settings.noise_threshold > 0.0F ? "all pixels get all samples" : not_asked);
  }
  add(source.data.shadow_picture.texture(), "shadow_picture", "asked for", not_asked);
  const auto why_no_layers = [&](Feature feature) {
    return !source.has(feature)       ? why_no_feature(source, feature)
           : !source.data.is_recorded ? nothing_seen
                                      : "no caster can shadow a visible surface";
  };
  add(source.data.shared->light_texture, "light_texture",
      fmt::format("{} lights", source.data.shared->lamps.light_count()),
      why_no_feature(source, Feature::LightClusters));
  const LightClusters &lists = source.data.stl.clusters.lists;
  add(source.data.stl.clusters.texture, "light_lists",
      fmt::format("{} entries for {} parts of the view", lists.entry_count(), lists.froxel_count()),
      why_no_feature(source, Feature::LightClusters));
  add(source.data.shared->ltc_table, "ltc_table", "specular light of lamps with an extent and of the world; sheen",
      source.has(Feature::LampShape | Feature::World) ? why_no_feature(source, Feature::Specular)
                                                      : why_no_feature(source, Feature::LampShape));
  add(source.data.shared->multiscatter_table, "multiscatter_table",
      "albedos, for light that microfacets reflect more than once", why_no_feature(source, Feature::Multiscatter));
  add(source.data.shared->world.levels, "world_levels", "specular reflection of the world",
      source.has(Feature::World) ? why_no_feature(source, Feature::Specular) : why_no_feature(source, Feature::World));
  add(shadows.cubes(), "shadow_cubes", fmt::format("{} point lamps or wide spots", shadows.cube_count()),
      why_no_layers(Feature::ShadowCube));
  add(shadows.maps(), "shadow_maps", fmt::format("{} suns or spots", shadows.map_count()),
      why_no_layers(Feature::ShadowMap));
  add(shadows.distance_cube(), "shadow_distance_cube", "temporary depths for octahedral layers",
      why_no_layers(Feature::ShadowEsm));
  if (shadows.octahedral().textures().empty()) {
    add({}, "shadow_esm", "", why_no_layers(Feature::ShadowEsm));
  }
  for (const gpu::Texture *texture : shadows.octahedral().textures()) {
    add(*texture, texture->desc().name, "exponential shadows", "");
  }
  return folder("targets", "what passes draw into", "", std::move(targets));
}

FrameNode block_nodes(const ReportSource &source)
{
  const StorageList &stl = source.data.stl;
  std::vector<FrameNode> blocks;
  const auto add = [&](const gpu::Buffer &buffer, std::string what, std::string why, std::string why_not) {
    FrameNode &node = blocks.emplace_back(
        resource_node(source, buffer, std::move(what), std::move(why),
                      source.data.is_recorded || !source.has(Feature::Light) ? std::move(why_not) : nothing_seen));
    if (buffer) {
      node.upload_bytes = source.device().live(buffer).upload_bytes;
    }
  };
  const std::string no_shadow = why_no_shadow(source, "no lamp casts a shadow");
  add(stl.view_block, "view_block", "whatever is drawn", nothing_seen);
  add(source.render_scene.objects().buffer(), "object_block",
      fmt::format("{} matrices", source.render_scene.objects().size()), nothing_seen);
  add(source.render_scene.materials().buffer(), "material_block",
      fmt::format("{} materials", source.scene().materials().size()), nothing_seen);
  add(source.render_scene.materials().full_buffer(), "full_material_block",
      fmt::format("{} materials", source.scene().materials().size()),
      source.data.is_recorded ? no_full_material : nothing_seen);
  add(source.render_scene.materials().layer_buffer(), "layer_block",
      fmt::format("{} materials", source.scene().materials().size()), why_no_feature(source, Feature::Layers));
  add(source.data.shared->surface_function_block, "surface_function_block", "surface functions of materials",
      source.data.is_recorded ? no_surface_function : nothing_seen);
  add(source.data.shared->light_block, "light_block", fmt::format("{} lights", source.data.shared->lamps.light_count()),
      source.has(Feature::LightClusters) ? "the lights are in light_texture" : "no lamp gives light");
  add(source.data.shared->light_shape_block, "light_shape_block", "extents and axes of lamps",
      source.has(Feature::LightClusters) ? "the lights are in light_texture"
                                         : why_no_feature(source, Feature::LampShape));
  add(stl.clusters.block, "light_cluster_block", "the grid of light_lists",
      why_no_feature(source, Feature::LightClusters));
  add(source.data.shared->world.block, "world_block", "light from all around", why_no_feature(source, Feature::World));
  add(stl.shadows->block(), "shadow_block", "shadows of depths",
      source.has(any_shadow) ? "all shadows are exponential" : no_shadow);
  add(stl.shadows->scene().render_blocks(), "shadow_render_block", "views that casters are drawn with", no_shadow);
  add(stl.shadows->scene().octahedral().block(), "esm_block", "exponential shadows",
      why_no_feature(source, Feature::ShadowEsm));
  return folder("blocks", "what programs read", nothing_seen, std::move(blocks));
}

std::string element_count(const scene::Mesh &mesh)
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
        source, batch, mesh.name, element_count(mesh),
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
          resource_node(source, made ? *made : none, image.name,
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
