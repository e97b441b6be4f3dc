// SPDX-License-Identifier: MIT
#include "eevee_shadows.hh"

#include "eevee_view_volume.hh"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <bit>
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

std::array<draw::View, 6> shadow_cube_views(const glm::vec3 &position_ws, float near, int size_px)
{
  const float half_size = 1.0F / shared::cube_uv_scale(float(size_px));
  const glm::mat4 clip_from_face =
      draw::perspective(half_size, half_size, near, std::numeric_limits<float>::infinity());
  glm::mat4 lamp_from_world(1.0F);
  lamp_from_world[3] = glm::vec4(-position_ws, 1.0F);
  std::array<draw::View, 6> views;
  for (std::size_t face = 0; face < 6; face++) {
    views[face] = draw::View(cubefacemat[face] * lamp_from_world, clip_from_face);
  }
  return views;
}

draw::View shadow_spot_view(const scene::Lamp &lamp, float near, int size_px)
{
  const float border = std::min(2.0F * float(CUBE_BORDER_TEXELS) / float(size_px), 0.5F);
  const float half_size = std::max(std::tan(lamp.spot_outer_angle) / (1.0F - border), 1e-4F);
  const glm::mat4 lamp_from_world(glm::inverse(glm::dmat4(lamp.world_from_lamp)));
  return {lamp_from_world, draw::perspective(half_size, half_size, near, std::numeric_limits<float>::infinity())};
}

/** Whether \a lamp throws a shadow into six faces, rather than into one map. */
static bool wants_cube(const scene::Lamp &lamp)
{
  return lamp.kind == scene::LampKind::Point ||
         (lamp.kind == scene::LampKind::Spot && lamp.spot_outer_angle > spot_map_angle_max);
}

static LayerPass best_layer_pass(LayerPass asked, const gpu::Limits &limits)
{
  if (asked == LayerPass::Layered && !limits.has_vertex_layer) {
    throw gpu::Error("the layered shadow pass needs GL_ARB_shader_viewport_layer_array, which this device lacks");
  }
  if (asked != LayerPass::Best) {
    return asked;
  }
  return limits.has_vertex_layer ? LayerPass::Layered : LayerPass::Geometry;
}

void Shadows::sync(gpu::Device &device, const scene::Scene &scene, Lamps &lamps, const ShadowSettings &settings)
{
  layer_pass_ = best_layer_pass(settings.layer_pass, device.limits());
  casters_before_ = std::exchange(casters_, {});
  seen_clip_from_world_.reset();
  limits_.clear();
  std::vector<Slot> cubes_before = std::exchange(cubes_.slots, {});
  std::vector<Slot> maps_before = std::exchange(maps_.slots, {});
  if (settings.caster_faces != settings_.caster_faces) {
    cubes_before.clear();
    maps_before.clear();
  }
  settings_ = settings;
  place_slots(device.limits(), scene, lamps);
  keep_drawn(cubes_, std::move(cubes_before));
  keep_drawn(maps_, std::move(maps_before));
  if (!sampler_ && !(cubes_.slots.empty() && maps_.slots.empty())) {
    sampler_ = device.create_sampler({.name = "shadow_sampler"});
    shadow_block_buffer_ =
        device.create_buffer({"shadow_block", gpu::BufferKind::Uniform, sizeof(shared::ShadowBlock)});
  }
  create_layers(device, cubes_, 6 * int(cubes_.slots.size()));
  if (maps_.slots.empty()) {
    create_layers(device, maps_, 0);
  }
  place_render_blocks(device);
}

/** Which lamps have a shadow, and of what size; those that lose it are named. */
void Shadows::place_slots(const gpu::Limits &device_limits, const scene::Scene &scene, Lamps &lamps)
{
  const int cube_max = std::min(SHADOW_CUBE_MAX, device_limits.array_layers_max / 6);
  const int map_max = std::min(SHADOW_MAP_MAX, device_limits.array_layers_max);
  int entry_count = 0;
  std::vector<std::string> lost;
  std::vector<int> lights;
  for (int i = 0; i < lamps.light_block.light_count; i++) {
    const scene::Lamp &lamp = scene.lamps[lamps.scene_index[std::size_t(i)]];
    if (lamp.kind == scene::LampKind::Hemi || settings_.method == ShadowMethod::None) {
      continue;
    }
    const bool is_cube = wants_cube(lamp);
    const bool is_sun = lamp.kind == scene::LampKind::Sun;
    Slot slot;
    slot.lamp = lamp;
    slot.light = i;
    slot.size_px = std::min(is_cube ? settings_.cube_size_px : settings_.map_size_px, device_limits.texture_size_max);
    slot.layer_count_max = is_cube                        ? 6
                           : !is_sun                      ? 1
                           : settings_.cascades.count > 0 ? settings_.cascades.count
                                                          : cascade_count_max;
    slot.range = lamp.range > 0.0F && !is_sun ? lamp.range : std::numeric_limits<float>::infinity();
    Array &array = is_cube ? cubes_ : maps_;
    if (is_cube ? int(array.slots.size()) == cube_max : entry_count + slot.layer_count_max > map_max) {
      lost.push_back(lamp.name);
      continue;
    }
    slot.entry = is_cube ? int(array.slots.size()) : entry_count;
    slot.first_layer = is_cube ? 6 * slot.entry : 0;
    entry_count += is_cube ? 0 : slot.layer_count_max;
    shared::LightData &light = lamps.light_block.lights[i];
    light.shadow_kind = is_cube ? SHADOW_CUBE : SHADOW_MAP;
    light.shadow_index = slot.entry;
    array.slots.push_back(std::move(slot));
  }
  if (!lost.empty()) {
    limits_.push_back(fmt::format("{} lamps lost their shadow, as {} cubes and {} maps are the most: '{}'", lost.size(),
                                  cube_max, map_max, fmt::join(lost, "', '")));
  }
  fit_memory(lamps);
}

std::size_t Shadows::bytes_needed() const
{
  std::size_t bytes = 0;
  for (const Array *array : {&cubes_, &maps_}) {
    std::size_t edge = 0;
    std::size_t layers = 0;
    for (const Slot &slot : array->slots) {
      edge = std::max(edge, std::size_t(slot.size_px));
      layers += std::size_t(slot.layer_count_max);
    }
    bytes += edge * edge * layers * sizeof(float);
  }
  return bytes;
}

void Shadows::fit_memory(Lamps &lamps)
{
  const std::size_t most = settings_.memory_bytes_max;
  const std::size_t needed = bytes_needed();
  if (needed <= most) {
    return;
  }
  constexpr int size_px_min = 16;
  const double scale = std::sqrt(double(most) / double(needed));
  std::size_t lowered = 0;
  for (Array *array : {&cubes_, &maps_}) {
    for (Slot &slot : array->slots) {
      const int size_px = std::max(int(slot.size_px * scale), std::min(size_px_min, slot.size_px));
      lowered += size_px < slot.size_px ? 1 : 0;
      slot.size_px = size_px;
    }
  }
  limits_.push_back(
      fmt::format("the shadows of {} lamps need {:.1f} MiB, and may take {:.1f}: their sizes are lowered to {:.0f} %",
                  lowered, double(needed) / 0x1p20, double(most) / 0x1p20, 100.0 * scale));
  std::vector<std::string> lost;
  while (bytes_needed() > most) {
    Array &array =
        maps_.slots.empty() || (!cubes_.slots.empty() && cubes_.slots.back().light > maps_.slots.back().light) ? cubes_
                                                                                                               : maps_;
    shared::LightData &light = lamps.light_block.lights[array.slots.back().light];
    light.shadow_kind = SHADOW_NONE;
    light.shadow_index = -1;
    lost.push_back(array.slots.back().lamp.name);
    array.slots.pop_back();
  }
  if (!lost.empty()) {
    limits_.push_back(fmt::format("{} lamps lost their shadow, as {:.1f} MiB hold no more of {} texels: '{}'",
                                  lost.size(), double(most) / 0x1p20, size_px_min, fmt::join(lost, "', '")));
  }
}

/** What stands in the same place, of the same lamp and size, has not lost its texels. */
void Shadows::keep_drawn(Array &array, std::vector<Slot> before)
{
  for (std::size_t i = 0; i < std::min(array.slots.size(), before.size()); i++) {
    Slot &slot = array.slots[i];
    Slot &old = before[i];
    if (slot.lamp == old.lamp && slot.size_px == old.size_px && slot.entry == old.entry &&
        slot.layer_count_max == old.layer_count_max) {
      old.light = slot.light;
      slot = std::move(old);
    }
  }
}

void Shadows::create_layers(gpu::Device &device, Array &array, int layers)
{
  int size_px = 0;
  for (const Slot &slot : array.slots) {
    size_px = std::max(size_px, slot.size_px);
  }
  if (array.texture && array.texture.desc().width == size_px && array.texture.desc().layers == layers) {
    return;
  }
  array.framebuffers.clear();
  array.texture = {};
  array.binding = {};
  for (Slot &slot : array.slots) {
    slot.framebuffer = {};
    slot.drawn = slot.settled = 0;
  }
  if (layers == 0) {
    return;
  }
  array.texture = device.create_texture({.name = std::string(array.name),
                                         .kind = gpu::TextureKind::Array,
                                         .format = gpu::Format::Depth32F,
                                         .width = size_px,
                                         .height = size_px,
                                         .layers = layers});
  array.binding = {array.texture.id(), sampler_.id()};
  for (int layer = 0; layer < layers; layer++) {
    array.framebuffers.push_back(device.create_framebuffer(
        {.name = fmt::format("{} {}", array.name, layer), .colors = {}, .depth = {&array.texture, layer}}));
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
  if (size > 0 && (!render_buffer_ || render_buffer_.size_bytes() != size)) {
    // A buffer of many blocks may be larger than one block may be, so it is made as storage.
    render_buffer_ = device.create_buffer({"shadow_render_block", gpu::BufferKind::Storage, size});
  }
}

void Shadows::finish()
{
  caster_bounds_ws_ = {};
  for (const Caster &caster : casters_) {
    caster_bounds_ws_.extend(caster.bounds_ws);
  }
  const std::vector<scene::Bounds> changed = changed_bounds(casters_before_, casters_);
  casters_before_.clear();
  for (Array *array : {&cubes_, &maps_}) {
    for (Slot &slot : array->slots) {
      const glm::vec3 position_ws(slot.lamp.world_from_lamp[3]);
      const bool is_sun = slot.lamp.kind == scene::LampKind::Sun;
      const bool is_changed = std::ranges::any_of(
          changed, [&](const scene::Bounds &box) { return is_sun || distance_to(box, position_ws) <= slot.range; });
      if (is_changed) {
        slot.drawn = slot.settled = 0;
      }
      if (slot.settled != 0 || is_sun) {
        continue;
      }
      slot.near = lamp_near(position_ws, slot.range, casters_);
      if (array == &cubes_) {
        const auto views = shadow_cube_views(position_ws, slot.near, slot.size_px);
        slot.views.assign(views.begin(), views.end());
      }
      else {
        slot.views = {shadow_spot_view(slot.lamp, slot.near, slot.size_px)};
      }
    }
  }
  std::ranges::for_each(cubes_.slots, [this](const Slot &slot) { write_cube_data(slot); });
  std::ranges::for_each(maps_.slots, [this](const Slot &slot) { write_map_data(slot); });
}

void Shadows::write_cube_data(const Slot &slot)
{
  shared::ShadowCubeData &data = shadow_block_.cubes[slot.entry];
  data.near = slot.near;
  data.far = std::numeric_limits<float>::max();
  data.texel_size = 2.0F / (float(slot.size_px) * shared::cube_uv_scale(float(slot.size_px)));
  data.bias = 1.0F;
  data.layer = slot.first_layer;
  data.face_mask = int(slot.drawn);
  data.filter_kind = settings_.method == ShadowMethod::Pcf ? SHADOW_FILTER_PCF : SHADOW_FILTER_HARD;
  data.size_px = slot.size_px;
  is_block_dirty_ = true;
}

void Shadows::write_map_data(const Slot &slot)
{
  for (std::size_t i = 0; i < slot.views.size(); i++) {
    shared::ShadowMapData &data = shadow_block_.maps[std::size_t(slot.entry) + i];
    const draw::View &view = slot.views[i];
    const glm::mat4 &projection = view.clip_from_view();
    data.texco_from_world = texcomat * view.clip_from_world();
    data.texel_size = 2.0F / (float(slot.size_px) * std::min(projection[0][0], projection[1][1]));
    // Reversed: near / w where w is a distance, and (far - z) / (far - near) for a sun.
    data.rounding = shared::DEPTH_ROUNDING / (view.is_perspective() ? projection[3][2] : projection[2][2]);
    data.far = std::numeric_limits<float>::max();
    data.bias = 1.0F;
    data.layer = slot.first_layer + int(i);
    data.cascade_count = slot.drawn == 0 ? 0 : int(slot.views.size() - i);
    data.filter_kind = settings_.method == ShadowMethod::Pcf ? SHADOW_FILTER_PCF : SHADOW_FILTER_HARD;
    data.size_px = slot.size_px;
  }
  if (slot.views.empty()) {
    // No map: everything is lit.
    shadow_block_.maps[slot.entry].cascade_count = 0;
  }
  is_block_dirty_ = true;
}

void Shadows::fit_suns(gpu::Device &device, const draw::View &view, float pixel_size)
{
  int layers = 0;
  for (Slot &slot : maps_.slots) {
    if (slot.lamp.kind == scene::LampKind::Sun) {
      const std::vector<SunFit> fits =
          fit_sun(slot.lamp, view, visible_, casters_, slot.size_px, settings_.cascades, pixel_size);
      if (fits.size() != slot.fits.size()) {
        slot.settled = 0;
      }
      slot.fits.resize(fits.size());
      slot.views.resize(fits.size());
      for (std::size_t i = 0; i < fits.size(); i++) {
        if ((slot.settled >> i & 1U) == 0 || !still_fits(slot.fits[i], fits[i])) {
          slot.fits[i] = fits[i];
          slot.views[i] = fits[i].view;
          slot.settled &= ~(1U << i);
        }
      }
      slot.drawn &= slot.settled;
      write_map_data(slot);
    }
    if (slot.first_layer != layers) {
      slot.first_layer = layers;
      slot.framebuffer = {};
      slot.drawn = slot.settled = 0;
    }
    if (slot.framebuffer && slot.framebuffer_layers != int(slot.views.size())) {
      slot.framebuffer = {};
    }
    layers += int(slot.views.size());
  }
  // Room that a wider view needed stays, for the next one.
  const int layers_now = maps_.texture ? maps_.texture.desc().layers : 0;
  create_layers(device, maps_, maps_.slots.empty() ? 0 : std::max({layers, layers_now, 1}));
}

std::uint32_t Shadows::touched_layers(const Slot &slot, const Caster &caster) const
{
  const glm::vec3 center_ws = caster.bounds_ws.center();
  const float radius = caster.bounds_ws.radius();
  const glm::vec3 position_ws(slot.lamp.world_from_lamp[3]);
  if (!std::isinf(slot.range) && distance_to(caster.bounds_ws, position_ws) > slot.range) {
    return 0;
  }
  if (slot.views.size() == 6) {
    return cube_face_mask(center_ws - position_ws, radius, 1.0F / shared::cube_uv_scale(float(slot.size_px)));
  }
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < slot.views.size(); i++) {
    mask |= slot.views[i].touches({center_ws, radius}) ? 1U << i : 0U;
  }
  return mask;
}

void Shadows::update_slot(gpu::Device &device, Slot &slot, Array &array, std::uint32_t wanted, const draw::Pass &pass,
                          gpu::CommandList &list)
{
  const std::uint32_t all = (1U << slot.views.size()) - 1U;
  const std::uint32_t missing = wanted & all & ~slot.settled;
  if (missing == 0) {
    return;
  }
  const bool is_cube = &array == &cubes_;
  std::vector<std::uint32_t> masks;
  masks.reserve(casters_.size());
  std::uint32_t with_casters = 0;
  for (const Caster &caster : casters_) {
    masks.push_back(touched_layers(slot, caster) & missing);
    with_casters |= masks.back();
  }

  shared::ShadowRenderBlock block{};
  for (std::size_t i = 0; i < slot.views.size(); i++) {
    block.clip_from_world[i] = slot.views[i].clip_from_world();
  }
  list.update(render_buffer_, slot.render_offset_bytes, std::as_bytes(std::span(&block, 1)));
  render_block_range_ = {render_buffer_.id(), slot.render_offset_bytes, sizeof(block)};

  const auto record_instances = [&](std::uint32_t layers) {
    for (const Caster &caster : casters_) {
      caster.instances->clear();
    }
    for (std::size_t i = 0; i < casters_.size(); i++) {
      for (std::uint32_t rest = masks[i] & layers; rest != 0; rest &= rest - 1) {
        casters_[i].instances->add(casters_[i].object, std::uint32_t(std::countr_zero(rest)));
        counters_.caster_draws++;
      }
    }
    pass.record(slot.views.front(), list);
  };
  const auto name = [&](std::string_view what) { return fmt::format("shadow of {}, {}", slot.lamp.name, what); };
  const gpu::PassActions clear{.viewport_px = glm::ivec2(slot.size_px)};
  gpu::PassActions keep = clear;
  keep.depth_load = gpu::LoadAction::Load;
  // What has no caster is not looked up, but for a cascade among others: that has to be empty.
  const std::uint32_t drawn = slot.fits.empty() ? with_casters : missing;
  for (std::uint32_t rest = drawn; rest != 0; rest &= rest - 1) {
    const int layer = std::countr_zero(rest);
    list.begin_pass(name(fmt::format("{} {}", is_cube ? "face" : "map", layer)),
                    array.framebuffers[std::size_t(slot.first_layer + layer)], clear);
    if (layer_pass_ == LayerPass::Single) {
      record_instances(1U << layer);
    }
    list.end_pass();
  }
  if (layer_pass_ != LayerPass::Single && with_casters != 0) {
    if (!slot.framebuffer) {
      slot.framebuffer = device.create_framebuffer(
          {.name = fmt::format("{} of {}", array.name, slot.lamp.name),
           .colors = {},
           .depth = {.texture = &array.texture, .layer = slot.first_layer, .layer_count = int(slot.views.size())}});
      slot.framebuffer_layers = int(slot.views.size());
    }
    list.begin_pass(name("all layers"), slot.framebuffer, keep);
    record_instances(missing);
    list.end_pass();
  }
  slot.drawn |= drawn;
  slot.settled |= missing;
  if (is_cube) {
    write_cube_data(slot);
  }
  else {
    write_map_data(slot);
  }
  if (drawn == 0) {
    return;
  }
  counters_.lamps_updated++;
  counters_.faces_drawn += std::uint64_t(std::popcount(drawn));
  counters_.faces_skipped += std::uint64_t(std::popcount(all & ~drawn));
}

/** Faces that something visible may look up: those on whose side of a plane through the lamp any of it is. */
std::uint32_t Shadows::looked_up_faces(const Slot &slot) const
{
  const glm::dvec3 position_ws(slot.lamp.world_from_lamp[3]);
  // Bit i of each: some corner is within the i-th of the four planes that bound a face.
  std::array<std::uint32_t, 6> within{};
  for (const glm::dvec3 &corner : visible_.corners) {
    const glm::dvec3 v = corner - position_ws;
    const double slack = 1e-5 * (std::abs(v.x) + std::abs(v.y) + std::abs(v.z));
    for (std::size_t face = 0; face < 6; face++) {
      const std::size_t axis = face / 2;
      const double along = (face % 2 == 0 ? v[int(axis)] : -v[int(axis)]) + slack;
      const double a = v[int((axis + 1) % 3)];
      const double b = v[int((axis + 2) % 3)];
      within[face] |=
          (along >= a ? 1U : 0U) | (along >= -a ? 2U : 0U) | (along >= b ? 4U : 0U) | (along >= -b ? 8U : 0U);
    }
  }
  std::uint32_t faces = 0;
  for (std::size_t face = 0; face < 6; face++) {
    faces |= within[face] == 15U ? 1U << face : 0U;
  }
  return faces;
}

void Shadows::update(gpu::Device &device, const draw::View &view, float pixel_size, const draw::Pass &pass,
                     gpu::CommandList &list)
{
  if (seen_clip_from_world_ != view.clip_from_world()) {
    seen_clip_from_world_ = view.clip_from_world();
    visible_ = visible_range(view, visible_corners(view, caster_bounds_ws_));
    fit_suns(device, view, pixel_size);
  }
  for (Slot &slot : cubes_.slots) {
    update_slot(device, slot, cubes_, looked_up_faces(slot), pass, list);
  }
  for (Slot &slot : maps_.slots) {
    update_slot(device, slot, maps_, ~0U, pass, list);
  }
  if (std::exchange(is_block_dirty_, false) && shadow_block_buffer_) {
    device.update(shadow_block_buffer_, shadow_block_);
  }
}

Feature Shadows::features() const
{
  const bool has_shadow = !cubes_.slots.empty() || !maps_.slots.empty();
  return (cubes_.slots.empty() ? Feature::None : Feature::ShadowCube) |
         (maps_.slots.empty() ? Feature::None : Feature::ShadowMap) |
         (has_shadow && settings_.method == ShadowMethod::Pcf ? Feature::ShadowPcf : Feature::None);
}

}  // namespace gnomon::eevee
