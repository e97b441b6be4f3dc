// SPDX-License-Identifier: MIT
#include "eevee_shadows.hh"

#include "eevee_view_volume.hh"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::eevee {

// Columns. Each row of a comment is what the face shows across, up and (against its axis) behind.
const std::array<glm::mat4, 6> cubefacemat = {
    glm::mat4({0, 0, -1, 0}, {0, -1, 0, 0}, {-1, 0, 0, 0}, {0, 0, 0, 1}),  // +X: -z, -y, -x
    glm::mat4({0, 0, 1, 0}, {0, -1, 0, 0}, {1, 0, 0, 0}, {0, 0, 0, 1}),    // -X: z, -y, x
    glm::mat4({1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 0, 0, 1}),    // +Y: x, z, -y
    glm::mat4({1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}, {0, 0, 0, 1}),    // -Y: x, -z, y
    glm::mat4({1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 0}, {0, 0, 0, 1}),   // +Z: x, -y, -z
    glm::mat4({-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}),   // -Z: -x, -y, z
};

const glm::mat4 texcomat({0.5F, 0, 0, 0}, {0, 0.5F, 0, 0}, {0, 0, 1, 0}, {0.5F, 0.5F, 0, 1});

static scene::Bounds union_of(const std::vector<scene::Bounds> &boxes)
{
  scene::Bounds all;
  for (const scene::Bounds &box : boxes) {
    all.extend(box);
  }
  return all;
}

float lamp_near(const glm::vec3 &position_ws, const std::vector<scene::Bounds> &casters_ws)
{
  constexpr float near_min = 1e-6F;
  if (casters_ws.empty()) {
    return near_min;
  }
  float nearest = std::numeric_limits<float>::max();
  float smallest_around = std::numeric_limits<float>::max();
  for (const scene::Bounds &box : casters_ws) {
    const float distance = glm::distance(position_ws, glm::clamp(position_ws, box.min, box.max));
    nearest = std::min(nearest, distance);
    if (distance == 0.0F) {
      smallest_around = std::min(smallest_around, box.radius());
    }
  }
  // Along a face's axis what is at this distance is nearer, by up to the square root of 3.
  return std::max(nearest > 0.0F ? 0.5F * nearest : 2e-4F * smallest_around, near_min);
}

std::array<draw::View, 6> shadow_cube_views(const glm::vec3 &position_ws, float near)
{
  const glm::mat4 clip_from_face = draw::perspective(1.0F, 1.0F, near, std::numeric_limits<float>::infinity());
  glm::mat4 lamp_from_world(1.0F);
  lamp_from_world[3] = glm::vec4(-position_ws, 1.0F);
  std::array<draw::View, 6> views;
  for (std::size_t face = 0; face < 6; face++) {
    views[face] = draw::View(cubefacemat[face] * lamp_from_world, clip_from_face);
  }
  return views;
}

static glm::mat4 lamp_from_world(const scene::Lamp &lamp)
{
  return glm::mat4(glm::inverse(glm::dmat4(lamp.world_from_lamp)));
}

draw::View shadow_spot_view(const scene::Lamp &lamp, float near, int size_px)
{
  const float cone = std::tan(lamp.spot_outer_angle);
  const float half_size = std::max(cone * float(size_px) / float(std::max(size_px - 2, 1)), 1e-4F);
  return {lamp_from_world(lamp), draw::perspective(half_size, half_size, near, std::numeric_limits<float>::infinity())};
}

namespace {

/** A box in double, in a lamp's axes. */
struct LampBox {
  glm::dvec3 min{std::numeric_limits<double>::infinity()};
  glm::dvec3 max{-std::numeric_limits<double>::infinity()};

  void extend(const glm::dvec3 &point)
  {
    min = glm::min(min, point);
    max = glm::max(max, point);
  }
};

LampBox box_in(const glm::dmat3 &lamp_from_world, const scene::Bounds &bounds)
{
  LampBox box;
  for (int i = 0; i < 8; i++) {
    box.extend(lamp_from_world * glm::dvec3((i & 1) ? bounds.max.x : bounds.min.x,
                                            (i & 2) ? bounds.max.y : bounds.min.y,
                                            (i & 4) ? bounds.max.z : bounds.min.z));
  }
  return box;
}

/**
 * Whether a caster may darken any receiver. One that is flat along an axis cannot where all receivers are on its lit
 * side: the ground of most scenes, which would stretch the map over everything.
 */
bool can_darken(const scene::Bounds &caster, const scene::Bounds &receivers, const glm::vec3 &forward_ws)
{
  for (int axis = 0; axis < 3; axis++) {
    // Flat to rounding: what is thin in a wide scene still casts.
    const float own_tolerance = 1e-6F * std::max(std::abs(caster.min[axis]), std::abs(caster.max[axis]));
    const float tolerance = own_tolerance + 1e-7F * receivers.radius();
    const bool is_flat = caster.max[axis] - caster.min[axis] <= own_tolerance;
    const bool is_below = forward_ws[axis] < 0.0F && receivers.min[axis] >= caster.min[axis] - tolerance;
    const bool is_above = forward_ws[axis] > 0.0F && receivers.max[axis] <= caster.max[axis] + tolerance;
    if (is_flat && (is_below || is_above)) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::optional<SunFit> fit_sun(const scene::Lamp &lamp, const std::vector<glm::dvec3> &receivers_ws,
                              const std::vector<scene::Bounds> &casters_ws, int size_px)
{
  // Directions only: a sun is nowhere.
  const glm::dmat3 from_world = glm::transpose(glm::dmat3(lamp.world_from_lamp));
  const glm::vec3 forward_ws = -glm::vec3(lamp.world_from_lamp[2]);
  scene::Bounds receiver_bounds;
  LampBox receivers;
  for (const glm::dvec3 &point : receivers_ws) {
    receiver_bounds.extend(glm::vec3(point));
    receivers.extend(from_world * point);
  }
  LampBox casters;
  for (const scene::Bounds &caster : casters_ws) {
    const LampBox box = box_in(from_world, caster);
    const bool overlaps = box.min.x <= receivers.max.x && box.max.x >= receivers.min.x &&
                          box.min.y <= receivers.max.y && box.max.y >= receivers.min.y && box.max.z >= receivers.min.z;
    if (overlaps && can_darken(caster, receiver_bounds, forward_ws)) {
      casters.extend(box.min);
      casters.extend(box.max);
    }
  }
  SunFit fit;
  fit.min = glm::max(receivers.min, casters.min);
  fit.max = glm::min(receivers.max, casters.max);
  // The lamp shines along -Z: what darkens is above, up to the highest caster.
  fit.max.z = casters.max.z;
  fit.min.z = receivers.min.z;
  if (receivers_ws.empty() || !(fit.min.x <= fit.max.x && fit.min.y <= fit.max.y)) {
    return std::nullopt;
  }
  // Two texels around, so that the filter finds what is outside; and never an empty box.
  const glm::dvec3 extent = fit.max - fit.min;
  const double size = std::max({extent.x, extent.y, extent.z, 1e-6});
  const glm::dvec2 margin = glm::max(glm::dvec2(extent) * (2.0 / size_px), glm::dvec2(1e-4 * size));
  fit.min -= glm::dvec3(margin, 1e-3 * size);
  fit.max += glm::dvec3(margin, 1e-3 * size);

  const glm::dvec3 center = 0.5 * (fit.min + fit.max);
  const glm::dvec3 half = 0.5 * (fit.max - fit.min);
  glm::dmat4 view_from_world(from_world);
  view_from_world[3] = glm::dvec4(-center, 1.0);
  fit.view = draw::View(glm::mat4(view_from_world),
                        draw::orthographic(float(half.x), float(half.y), float(-half.z), float(half.z)));
  return fit;
}

/** Whether \a lamp throws a shadow into six faces, rather than into one map. */
static bool wants_cube(const scene::Lamp &lamp)
{
  return lamp.kind == scene::LampKind::Point ||
         (lamp.kind == scene::LampKind::Spot && lamp.spot_outer_angle > spot_map_angle_max);
}

void Shadows::sync(gpu::Device &device, const scene::Scene &scene, Lamps &lamps, const ShadowSettings &settings)
{
  scene_ = &scene;
  settings_ = settings;
  casters_ws_.clear();
  fitted_clip_from_world_.reset();
  limits_.clear();
  cubes_.slots.clear();
  maps_.slots.clear();
  if (settings.method == ShadowMethod::None) {
    return;
  }
  const auto bytes = [](int size_px, int layers) {
    return std::size_t(size_px) * std::size_t(size_px) * sizeof(float) * std::size_t(layers);
  };
  const int cube_max = std::min(SHADOW_CUBE_MAX, device.limits().array_layers_max / 6);
  const int map_max = std::min(SHADOW_MAP_MAX, device.limits().array_layers_max);
  std::size_t memory = 0;
  std::vector<std::string> lost;
  for (int i = 0; i < lamps.light_block.light_count; i++) {
    const std::uint32_t lamp_index = lamps.scene_index[std::size_t(i)];
    const scene::Lamp &lamp = scene.lamps[lamp_index];
    if (lamp.kind == scene::LampKind::Hemi) {
      continue;
    }
    const bool is_cube = wants_cube(lamp);
    Array &array = is_cube ? cubes_ : maps_;
    const std::size_t needed = is_cube ? bytes(settings.cube_size_px, 6) : bytes(settings.map_size_px, 1);
    if (int(array.slots.size()) == (is_cube ? cube_max : map_max) || memory + needed > settings.memory_bytes_max) {
      lost.push_back(lamp.name);
      continue;
    }
    memory += needed;
    shared::LightData &light = lamps.light_block.lights[i];
    light.shadow_kind = is_cube ? SHADOW_CUBE : SHADOW_MAP;
    light.shadow_index = int(array.slots.size());
    array.slots.push_back({.lamp = lamp_index, .views = {}, .sun = {}});
  }
  if (!lost.empty()) {
    limits_.push_back(fmt::format("{} lamps lost their shadow, as {} cubes, {} maps and {} MiB are the most: '{}'",
                                  lost.size(), cube_max, map_max, settings.memory_bytes_max >> 20U,
                                  fmt::join(lost, "', '")));
  }
  create_layers(device, cubes_, "shadow_cubes", settings.cube_size_px, 6);
  create_layers(device, maps_, "shadow_maps", settings.map_size_px, 1);
  place_render_blocks(device);
}

void Shadows::create_layers(gpu::Device &device, Array &array, std::string_view name, int size_px, int layers_a_slot)
{
  const int layers = int(array.slots.size()) * layers_a_slot;
  if (array.texture && array.texture.desc().width == size_px && array.texture.desc().layers == layers) {
    return;
  }
  array.framebuffers.clear();
  array.texture = {};
  if (layers == 0) {
    return;
  }
  array.texture = device.create_texture({.name = std::string(name),
                                         .kind = gpu::TextureKind::Array,
                                         .format = gpu::Format::Depth32F,
                                         .width = size_px,
                                         .height = size_px,
                                         .layers = layers});
  for (int layer = 0; layer < layers; layer++) {
    array.framebuffers.push_back(device.create_framebuffer(
        {.name = fmt::format("{} {}", name, layer), .colors = {}, .depth = {&array.texture, layer}}));
  }
}

void Shadows::place_render_blocks(gpu::Device &device)
{
  const std::uint32_t alignment = device.limits().uniform_offset_alignment;
  const auto stride = std::uint32_t((sizeof(shared::ShadowRenderBlock) + alignment - 1) / alignment * alignment);
  std::uint32_t size = 0;
  for (Array *array : {&cubes_, &maps_}) {
    for (Slot &slot : array->slots) {
      slot.render_offset_bytes = size;
      size += stride;
    }
  }
  if (size == 0) {
    return;
  }
  if (!sampler_) {
    sampler_ = device.create_sampler({.name = "shadow_sampler"});
    shadow_block_buffer_ =
        device.create_buffer({"shadow_block", gpu::BufferKind::Uniform, sizeof(shared::ShadowBlock)});
  }
  if (!render_buffer_ || render_buffer_.size_bytes() != size) {
    // A buffer of many blocks may be larger than one block may be, so it is made as storage.
    render_buffer_ = device.create_buffer({"shadow_render_block", gpu::BufferKind::Storage, size});
  }
}

void Shadows::finish(const scene::Scene &scene)
{
  for (std::size_t i = 0; i < cubes_.slots.size(); i++) {
    Slot &slot = cubes_.slots[i];
    const glm::vec3 position_ws(scene.lamps[slot.lamp].world_from_lamp[3]);
    const float near = lamp_near(position_ws, casters_ws_);
    const auto views = shadow_cube_views(position_ws, near);
    slot.views.assign(views.begin(), views.end());
    shadow_block_.cubes[i] = {near, 2.0F / float(settings_.cube_size_px), 6 * int(i), 0};
  }
  for (std::size_t i = 0; i < maps_.slots.size(); i++) {
    Slot &slot = maps_.slots[i];
    const scene::Lamp &lamp = scene.lamps[slot.lamp];
    if (lamp.kind == scene::LampKind::Spot) {
      const float near = lamp_near(glm::vec3(lamp.world_from_lamp[3]), casters_ws_);
      slot.views = {shadow_spot_view(lamp, near, settings_.map_size_px)};
      write_map_data(slot, int(i));
    }
  }
  is_block_dirty_ = true;
}

void Shadows::write_map_data(const Slot &slot, int index)
{
  shared::ShadowMapData &data = shadow_block_.maps[index];
  const draw::View &view = slot.views.front();
  data.texco_from_world = texcomat * view.clip_from_world();
  const float half_size = 1.0F / std::min(view.clip_from_view()[0][0], view.clip_from_view()[1][1]);
  data.texel_size = 2.0F * half_size / float(settings_.map_size_px);
  data.layer = index;
  // Reversed: near / w where w is a distance, and (far - z) / (far - near) for a sun.
  const glm::mat4 &projection = view.clip_from_view();
  data.rounding = shared::DEPTH_ROUNDING / (view.is_perspective() ? projection[3][2] : projection[2][2]);
}

/** A fit holds for other views as long as it covers them, and is not much larger than they need. */
static bool still_fits(const std::optional<SunFit> &old, const std::optional<SunFit> &needed)
{
  if (!old || !needed) {
    return !old && !needed;
  }
  constexpr double area_ratio_max = 1.5;
  const auto area = [](const SunFit &fit) { return (fit.max.x - fit.min.x) * (fit.max.y - fit.min.y); };
  return glm::all(glm::lessThanEqual(old->min, needed->min)) &&
         glm::all(glm::greaterThanEqual(old->max, needed->max)) && area(*old) <= area_ratio_max * area(*needed);
}

void Shadows::fit_suns(const draw::View &view)
{
  if (fitted_clip_from_world_ == view.clip_from_world()) {
    return;
  }
  fitted_clip_from_world_ = view.clip_from_world();
  std::vector<glm::dvec3> receivers;
  for (std::size_t i = 0; i < maps_.slots.size(); i++) {
    Slot &slot = maps_.slots[i];
    const scene::Lamp &lamp = scene_->lamps[slot.lamp];
    if (lamp.kind != scene::LampKind::Sun) {
      continue;
    }
    if (receivers.empty()) {
      receivers = visible_corners(view, union_of(casters_ws_));
    }
    std::optional<SunFit> fit = fit_sun(lamp, receivers, casters_ws_, settings_.map_size_px);
    if (!slot.views.empty() && still_fits(slot.sun, fit)) {
      continue;
    }
    slot.sun = std::move(fit);
    // A view of nothing: its layer is cleared, and everything is lit.
    slot.views = {slot.sun ? slot.sun->view : draw::View(glm::mat4(1.0F), glm::mat4(1.0F))};
    slot.is_up_to_date = false;
    write_map_data(slot, int(i));
    is_block_dirty_ = true;
  }
}

void Shadows::record_slot(Slot &slot, Array &array, int first_layer, const draw::Pass &pass, gpu::CommandList &list)
{
  shared::ShadowRenderBlock block{};
  for (std::size_t face = 0; face < slot.views.size(); face++) {
    block.clip_from_world[face] = slot.views[face].clip_from_world();
  }
  list.update(render_buffer_, slot.render_offset_bytes, std::as_bytes(std::span(&block, 1)));
  render_block_range_ = {render_buffer_.id(), slot.render_offset_bytes, sizeof(block)};
  const scene::Lamp &lamp = scene_->lamps[slot.lamp];
  for (render_face_ = 0; render_face_ < int(slot.views.size()); render_face_++) {
    list.begin_pass(fmt::format("shadow of {}, face {}", lamp.name, render_face_),
                    array.framebuffers[std::size_t(first_layer + render_face_)], {});
    // A sun that darkens nothing has no view to draw.
    if (lamp.kind != scene::LampKind::Sun || slot.sun) {
      pass.record(slot.views[std::size_t(render_face_)], list);
    }
    list.end_pass();
    counters_.faces_drawn++;
  }
  slot.is_up_to_date = true;
  counters_.lamps_updated++;
}

void Shadows::update(gpu::Device &device, const draw::View &view, const draw::Pass &pass, gpu::CommandList &list)
{
  fit_suns(view);
  for (std::size_t i = 0; i < cubes_.slots.size(); i++) {
    if (!cubes_.slots[i].is_up_to_date) {
      record_slot(cubes_.slots[i], cubes_, 6 * int(i), pass, list);
    }
  }
  for (std::size_t i = 0; i < maps_.slots.size(); i++) {
    if (!maps_.slots[i].is_up_to_date) {
      record_slot(maps_.slots[i], maps_, int(i), pass, list);
    }
  }
  if (std::exchange(is_block_dirty_, false) && shadow_block_buffer_) {
    device.update(shadow_block_buffer_, shadow_block_);
  }
}

Feature Shadows::features() const
{
  return (cubes_.slots.empty() ? Feature::None : Feature::ShadowCube) |
         (maps_.slots.empty() ? Feature::None : Feature::ShadowMap);
}

}  // namespace gnomon::eevee
