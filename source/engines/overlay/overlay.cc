// SPDX-License-Identifier: MIT
#include "overlay.hh"

#include "overlay_interfaces.hh"
#include "overlay_programs.hh"
#include "overlay_triangle.hh"

#include "draw_view_shared.h"
#include "gpu_read.hh"
#include "render_surfaces.hh"
#include "shader_files.hh"

#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <tuple>
#include <unordered_set>

namespace gnomon::overlay {

using gpu::State;
using render_scene::MaterialClass;

static Feature mask_features(MaterialClass mask_class)
{
  switch (mask_class) {
    case MaterialClass::Plain: return Feature::None;
    case MaterialClass::BaseColor: return Feature::AlphaMask;
    case MaterialClass::Full:
    case MaterialClass::Layered:
    case MaterialClass::Transmissive: break;
  }
  return Feature::AlphaMask | Feature::FullMaterial;
}

draw::View view_of_region(const draw::View &view, glm::ivec2 size_px, const gpu::Rectangle &region)
{
  // The region's x / w from (2 p - size) / size to (2 p + 2 region - size) / size becomes -1 to 1.
  const glm::vec2 part(region.size_px);
  const glm::vec2 offset = glm::vec2(size_px - 2 * region.origin_px - region.size_px) / part;
  glm::mat4 crop(1.0F);
  crop[0][0] = float(size_px.x) / part.x;
  crop[1][1] = float(size_px.y) / part.y;
  crop[3][0] = offset.x;
  crop[3][1] = offset.y;
  return view.with_matrices(view.view_from_world(), crop * view.clip_from_view());
}

void Overlay::check_up_to_date() const
{
  if (!scene_.is_up_to_date()) {
    throw gpu::Error("overlay: the scene is not up to date: call sync, or RenderScene::update, after edits");
  }
}

const gpu::Shader &Overlay::shader(ShaderId id, Feature features)
{
  std::shared_ptr<gpu::SharedShader> &shared = shaders_[{id, features}];
  if (!shared || !shared->shader) {
    gpu::Device &device = scene_.device();
    const gpu::ShaderDesc desc = shader_desc(shader_declarations()[std::size_t(id)], features);
    shared = device.shared_shader(desc, {}, [&](gpu::SharedShader &made) {
      made.shader =
          device.create_shader(desc, shaders::file, [&](std::string_view, const std::vector<gpu::ShaderSource> &) {
            return interface_tables()[std::size_t(id)].interface_of(std::uint32_t(features));
          });
    });
  }
  return shared->shader;
}

const gpu::Sampler &Overlay::nearest()
{
  if (!nearest_) {
    nearest_ = scene_.device().create_sampler({.name = "overlay_nearest"});
  }
  return nearest_;
}

/** At least of \a size_px. */
void Overlay::make(ObjectsTarget &target, glm::ivec2 size_px)
{
  const glm::ivec2 old_size_px = target.framebuffer ? target.framebuffer.size_px() : glm::ivec2(0);
  if (glm::all(glm::lessThanEqual(size_px, old_size_px))) {
    return;
  }
  gpu::Device &device = scene_.device();
  const glm::ivec2 new_size_px = glm::max(size_px, old_size_px);
  ObjectsTarget made;
  made.objects = device.create_texture(
      {.name = "overlay_objects", .format = gpu::Format::RG32F, .width = new_size_px.x, .height = new_size_px.y});
  made.depth = device.create_texture(
      {.name = "overlay_depth", .format = gpu::Format::Depth32F, .width = new_size_px.x, .height = new_size_px.y});
  made.framebuffer =
      device.create_framebuffer({.name = "overlay_fb", .colors = {{&made.objects}}, .depth = {&made.depth}});
  target = std::move(made);
}

static Feature clip_feature(const draw::View &view)
{
  return view.clip_planes().empty() ? Feature::None : Feature::ClipPlanes;
}

void Overlay::write_view(const draw::View &view, const gpu::Rectangle &picture)
{
  gpu::Device &device = scene_.device();
  if (!view_block_) {
    view_block_ = device.create_buffer({"overlay_view_block", gpu::BufferKind::Uniform, sizeof(shared::ViewData)});
  }
  shared::ViewData view_data{};
  view_data.clip_from_world = view.clip_from_world();
  draw::set_clip_planes(view_data, view, picture);
  device.update(view_block_, view_data);
}

bool Overlay::record_objects(const draw::View &view, glm::ivec2 size_px, const IsDrawn &is_drawn, ObjectsTarget &target,
                             gpu::CommandList &list)
{
  // Floats hold integers exactly up to here.
  constexpr draw::ObjectIndex object_max = 1U << 24U;
  const gpu::Rectangle picture{glm::ivec2(0), size_px};
  draw::ObjectBuffer &objects = scene_.objects();
  if (objects.index_end() > object_max) {
    throw gpu::Error("overlay: {} objects are more than the {} that can be told apart", objects.index_end(),
                     object_max);
  }
  const scene::Scene &scene = scene_.scene();
  draw::Pass pass("overlay objects", State::WriteColor | State::WriteDepth | State::DepthNearerEqual, &objects);
  gpu::BufferRange material_block;
  gpu::BufferRange full_material_block;
  std::map<std::tuple<MaterialClass, State, render_scene::TextureSet>, draw::ShadingGroup *> groups;
  MaterialClass widest = MaterialClass::Plain;
  const Feature clip = clip_feature(view);
  for (draw::ObjectIndex index = draw::object_identity + 1; index < objects.index_end(); index++) {
    if (!objects.is_live(index) || !is_drawn(index) || !view.touches(objects.volume(index))) {
      continue;
    }
    const render_scene::RenderObject &object = scene_.object(index);
    const scene::Mesh &mesh = scene.meshes()[object.mesh];
    const MaterialClass cut_out = render_scene::mask_class(scene, mesh);
    const render_scene::TextureSet textures =
        render_scene::textures_of(scene, mesh, cut_out == MaterialClass::Plain ? cut_out : MaterialClass::BaseColor);
    const State state = (scene.material_of(mesh).is_double_sided ? State::None : State::CullBack) |
                        (objects.is_mirrored(index) ? State::FrontClockwise : State::None) |
                        render_scene::topology_state(mesh.topology);
    widest = std::max(widest, cut_out);
    draw::ShadingGroup *&group = groups[{cut_out, state, textures}];
    if (!group) {
      if (groups.size() == 1) {
        write_view(view, picture);
      }
      group = &pass.group(shader(ShaderId::Objects, mask_features(cut_out) | clip));
      group->state_enable(state);
      group->bind_uniform("view_block", view_block_);
      group->bind_storage_ref("material_block", &material_block);
      group->bind_storage_ref("full_material_block", &full_material_block);
      render_scene::bind_textures(*group, scene_, cut_out == MaterialClass::Plain ? cut_out : MaterialClass::BaseColor,
                                  textures);
    }
    group->call(scene_.batch(object.mesh, render_scene::streams_of(cut_out)), index);
  }
  if (groups.empty()) {
    return false;
  }
  scene_.upload(widest);
  material_block = {scene_.materials().buffer().id()};
  full_material_block = {scene_.materials().full_buffer().id()};
  make(target, size_px);
  list.begin_pass("overlay objects", target.framebuffer, {.viewport = picture, .scissor = picture});
  pass.record(view, list);
  list.end_pass();
  return true;
}

std::optional<Hit> Overlay::pick(const draw::View &view, glm::ivec2 size_px, glm::ivec2 pixel_px)
{
  check_up_to_date();
  if (glm::any(glm::lessThan(pixel_px, glm::ivec2(0))) || glm::any(glm::greaterThanEqual(pixel_px, size_px))) {
    return std::nullopt;
  }
  gpu::Device &device = scene_.device();
  gpu::CommandList list;
  const auto is_any = [](draw::ObjectIndex /*object*/) { return true; };
  if (!record_objects(view_of_region(view, size_px, {pixel_px, glm::ivec2(1)}), glm::ivec2(1), is_any, pixel_, list)) {
    return std::nullopt;
  }
  device.submit(list);
  const glm::vec2 texel = gpu::read_as<glm::vec2>(device, pixel_.objects).front();
  const auto index = draw::ObjectIndex(texel.x);
  if (index == draw::object_identity) {
    return std::nullopt;
  }
  const glm::dvec2 ndc = 2.0 * (glm::dvec2(pixel_px) + 0.5) / glm::dvec2(size_px) - 1.0;
  const glm::dmat4 world_from_clip =
      glm::inverse(glm::dmat4(view.clip_from_view()) * glm::dmat4(view.view_from_world()));
  const auto position_at = [&](double depth) {
    const glm::dvec4 position = world_from_clip * glm::dvec4(ndc, depth, 1.0);
    return glm::dvec3(position) / position.w + scene_.origin_ws();
  };
  const render_scene::RenderObject &object = scene_.object(index);
  Hit hit{.node = object.node, .mesh = object.mesh, .position_ws = position_at(double(texel.y))};
  // A smaller depth is farther away. Half of a depth is within the range of both projections.
  const glm::dvec3 direction_ws = position_at(0.5 * double(texel.y)) - position_at(1.0);
  const scene::Mesh &mesh = scene_.scene().meshes()[object.mesh];
  hit.triangle = triangle_at(mesh, scene_.scene().world_from_node(object.node),
                             scene_.scene().material_of(mesh).is_double_sided, direction_ws, hit.position_ws);
  return hit;
}

void Overlay::draw_outline(const draw::View &view, glm::ivec2 size_px,
                           std::span<const scene::Handle<scene::Node>> nodes, const glm::vec4 &color,
                           const draw::Target &target)
{
  check_up_to_date();
  draw::check(target, size_px);
  const std::unordered_set<scene::Handle<scene::Node>> chosen(nodes.begin(), nodes.end());
  const auto is_chosen = [&](draw::ObjectIndex object) { return chosen.contains(scene_.object(object).node); };
  gpu::CommandList list;
  if (!target || chosen.empty() || !record_objects(view, size_px, is_chosen, mask_, list)) {
    return;
  }
  draw::Pass pass("overlay outline", State::WriteColor | State::BlendOver);
  draw::ShadingGroup &group = pass.group(shader(ShaderId::Outline, Feature::None));
  group.bind_texture("objects_texture", mask_.objects, nearest());
  group.constant("color", color);
  group.constant("origin_px", target.origin_px);
  group.constant("picture_size_px", size_px);
  group.call_procedural();
  draw::begin_pass(list, "overlay outline", target, size_px, {{0, 0}, size_px},
                   {.color_load = gpu::LoadAction::Load, .depth_load = gpu::LoadAction::Load});
  pass.record({}, list);
  list.end_pass();
  scene_.device().submit(list);
}

}  // namespace gnomon::overlay
