// SPDX-License-Identifier: MIT
#include "eevee_shadows.hh"

#include "eevee_octahedral_shared.h"
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

draw::View shadow_spot_view(const scene::PlacedLamp &lamp, float near, int size_px)
{
  const float border = std::min(2.0F * float(CUBE_BORDER_TEXELS) / float(size_px), 0.5F);
  const float half_size = std::max(std::tan(lamp.spot_outer_angle) / (1.0F - border), 1e-4F);
  const glm::mat4 lamp_from_world(glm::inverse(lamp.world_from_lamp));
  return {lamp_from_world, draw::perspective(half_size, half_size, near, std::numeric_limits<float>::infinity())};
}

static bool is_exponential(scene::ShadowKind kind)
{
  return kind == scene::ShadowKind::Esm || kind == scene::ShadowKind::Evsm;
}

scene::ShadowKind shadow_kind(const scene::Lamp &lamp, const ShadowSettings &settings)
{
  if (settings.kind == scene::ShadowKind::None || lamp.kind == scene::LampKind::Hemi) {
    return scene::ShadowKind::None;
  }
  const scene::ShadowKind kind = lamp.shadow.kind.value_or(settings.kind);
  return is_exponential(kind) && lamp.kind == scene::LampKind::Sun ? scene::ShadowKind::Pcf : kind;
}

/** Whether \a lamp throws a hard or PCF shadow into six faces, rather than into one map. */
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

/** Those of exponential maps are the octahedral store's business. \throws gpu::Error */
static void check(const ShadowSettings &settings)
{
  const auto check_range = [](const char *setting, auto value, auto low, auto high) {
    // false for NaN too.
    if (!(value >= low && value <= high)) {
      throw gpu::Error("shadow settings: {} {} is not in [{}, {}]", setting, value, low, high);
    }
  };
  constexpr int most = std::numeric_limits<int>::max();
  check_range("cube_size_px", settings.cube_size_px, 1, most);
  check_range("map_size_px", settings.map_size_px, 1, most);
  check_range("cascades.count", settings.cascades.count, 0, cascade_count_max);
  check_range("cascades.lambda", settings.cascades.lambda, 0.0F, 1.0F);
  const int width = settings.pcf.width;
  if (width == 0) {
    check_range("pcf.taps", settings.pcf.taps, 1, 64);
  }
  if (width != 0 && width != 1 && width != 3 && width != 5) {
    throw gpu::Error("shadow settings: pcf.width {} is not 0, 1, 3 or 5", width);
  }
}

void Shadows::sync(const gpu::Limits &device_limits, std::span<const scene::PlacedLamp> placed,
                   const scene::Bounds &scene_bounds, Lamps &lamps, const ShadowSettings &settings)
{
  check(settings);
  layer_pass_ = best_layer_pass(settings.layer_pass, device_limits);
  // After a sync that failed, the last good one's casters are still those that were drawn.
  if (std::exchange(is_finished_, false)) {
    casters_before_ = std::exchange(casters_, {});
  }
  casters_.clear();
  caster_volumes_.clear();
  caster_calls_.clear();
  seen_clip_from_world_.reset();
  warnings_.clear();
  limits_.clear();
  std::array<std::vector<Slot>, 3> before;
  for (std::size_t i = 0; i < 3; i++) {
    before[i] = std::exchange(arrays()[i]->slots, {});
    if (settings.caster_faces != settings_.caster_faces) {
      before[i].clear();
    }
  }
  settings_ = settings;
  place_slots(device_limits, placed, lamps);
  for (std::size_t i = 0; i < 3; i++) {
    keep_drawn(*arrays()[i], std::move(before[i]));
  }
  place_octahedral(device_limits, scene_bounds);
}

void Shadows::allocate(gpu::Device &device, ShaderCache &shaders)
{
  const bool has_depths = !cubes_.slots.empty() || !maps_.slots.empty();
  if (!has_depths) {
    shadow_block_buffer_ = {};
  }
  else if (!shadow_block_buffer_) {
    sampler_ = device.create_sampler({.name = "shadow_sampler"});
    shadow_block_buffer_ =
        device.create_buffer({"shadow_block", gpu::BufferKind::Uniform, sizeof(shared::ShadowBlock)});
    is_block_dirty_ = true;
  }
  create_layers(device, cubes_, 6 * int(cubes_.slots.size()));
  create_layers(device, distance_cube_, distance_cube_.slots.empty() ? 0 : 6);
  if (maps_.slots.empty()) {
    create_layers(device, maps_, 0);
  }
  if (octahedral_.sync(device, shaders, esm_lamps_)) {
    for (Slot &slot : distance_cube_.slots) {
      slot.drawn = slot.settled = 0;
    }
  }
  place_render_blocks(device);
}

/** Which lamps have a shadow, and of what size; those that lose it are named. */
void Shadows::place_slots(const gpu::Limits &device_limits, std::span<const scene::PlacedLamp> placed, Lamps &lamps)
{
  const int cube_max = std::min(SHADOW_CUBE_MAX, device_limits.array_layers_max / 6);
  const int map_max = std::min(SHADOW_MAP_MAX, device_limits.array_layers_max);
  const int esm_max = std::min(ESM_MAX, device_limits.array_layers_max);
  int entry_count = 0;
  std::vector<std::string> lost;
  std::vector<std::string> too_large;
  for (int i = 0; i < lamps.light_block.light_count; i++) {
    const scene::PlacedLamp &lamp = placed[lamps.lamp_index[std::size_t(i)]];
    Slot slot;
    slot.lamp = lamp;
    slot.light = i;
    slot.kind = shadow_kind(lamp, settings_);
    if (slot.kind == scene::ShadowKind::None) {
      continue;
    }
    warn_of_idle_wishes(lamp);
    const bool is_sun = lamp.kind == scene::LampKind::Sun;
    const bool is_esm = is_exponential(slot.kind);
    const bool is_cube = !is_esm && wants_cube(lamp);
    Array &array = is_esm ? distance_cube_ : is_cube ? cubes_ : maps_;
    const int count = int(array.slots.size());
    const int cascades = settings_.cascades.count > 0 ? settings_.cascades.count : cascade_count_max;
    slot.layer_count_max = is_esm || is_cube ? 6 : is_sun ? cascades : 1;
    const bool is_full = is_esm    ? count == esm_max
                         : is_cube ? count == cube_max
                                   : entry_count + slot.layer_count_max > map_max;
    if (is_full) {
      lost.push_back(lamp.name);
      continue;
    }
    const int size_px = is_esm    ? esm_cube_size_px(lamp.shadow.esm_size.value_or(settings_.esm.size_px))
                        : is_cube ? settings_.cube_size_px
                                  : settings_.map_size_px;
    const int asked_px = lamp.shadow.size.value_or(size_px);
    if (asked_px < 1) {
      throw gpu::Error("lamp '{}': size {} px of its shadow is not at least 1", lamp.name, asked_px);
    }
    if (asked_px > device_limits.texture_size_max) {
      too_large.push_back(lamp.name);
    }
    slot.size_px = std::min(asked_px, device_limits.texture_size_max);
    slot.range = std::numeric_limits<float>::infinity();
    if (!is_sun) {
      slot.range = std::min(lamp.range > 0.0F ? lamp.range : slot.range, lamp.shadow.clip_end.value_or(slot.range));
    }
    slot.entry = is_esm || is_cube ? count : entry_count;
    slot.first_layer = is_cube ? 6 * slot.entry : 0;
    entry_count += is_esm || is_cube ? 0 : slot.layer_count_max;
    shared::LightData &light = lamps.light_block.lights[i];
    light.shadow_kind = is_esm ? SHADOW_ESM : is_cube ? SHADOW_CUBE : SHADOW_MAP;
    light.shadow_index = slot.entry;
    array.slots.push_back(std::move(slot));
  }
  if (!lost.empty()) {
    limits_.push_back(
        fmt::format("{} lamps lost their shadow, as {} cubes, {} maps and {} exponential maps are the most: '{}'",
                    lost.size(), cube_max, map_max, esm_max, fmt::join(lost, "', '")));
  }
  if (!too_large.empty()) {
    limits_.push_back(fmt::format("the shadow size of {} lamps is {} texels, as this device takes no more: '{}'",
                                  too_large.size(), device_limits.texture_size_max, fmt::join(too_large, "', '")));
  }
  fit_memory(lamps);
}

void Shadows::warn_of_idle_wishes(const scene::Lamp &lamp)
{
  const scene::ShadowKind kind = lamp.shadow.kind.value_or(settings_.kind);
  if (kind == scene::ShadowKind::Evsm && lamp.shadow.esm_format == scene::EsmFormat::Half) {
    warnings_.push_back(fmt::format("lamp '{}': evsm is stored in 32 bits; esm_format 16f does nothing", lamp.name));
  }
  if (lamp.kind != scene::LampKind::Sun) {
    return;
  }
  if (is_exponential(kind)) {
    warnings_.push_back(
        fmt::format("lamp '{}': exponential shadows are for point lamps and spots; it has pcf", lamp.name));
  }
  if (lamp.shadow.clip_start || lamp.shadow.clip_end) {
    warnings_.push_back(
        fmt::format("lamp '{}': a sun is at no distance; clip_start and clip_end do nothing", lamp.name));
  }
}

/** What lamps with exponential shadows ask of their octahedral layers. */
void Shadows::place_octahedral(const gpu::Limits &device_limits, const scene::Bounds &bounds_ws)
{
  esm_lamps_.clear();
  for (const Slot &slot : distance_cube_.slots) {
    const glm::vec3 position_ws(slot.lamp.world_from_lamp[3]);
    const glm::vec3 reach = glm::max(glm::abs(bounds_ws.min - position_ws), glm::abs(bounds_ws.max - position_ws));
    const scene::LampShadow &wishes = slot.lamp.shadow;
    EsmLamp &lamp = esm_lamps_.emplace_back();
    lamp.name = slot.lamp.name;
    // Nothing that it could darken is farther than the scene, however far it reaches: exponents are derived from this.
    lamp.range = std::clamp(std::min(1.01F * glm::length(reach), slot.range), 1e-6F, 1e30F);
    lamp.settings = settings_.esm;
    lamp.settings.method = slot.kind == scene::ShadowKind::Evsm ? EsmMethod::Evsm : EsmMethod::Esm;
    lamp.settings.exponent = wishes.exponent ? wishes.exponent : lamp.settings.exponent;
    lamp.settings.bias = wishes.bias.value_or(lamp.settings.bias);
    lamp.settings.filter_angle = wishes.filter_radius ? wishes.filter_radius : lamp.settings.filter_angle;
    lamp.settings.size_px = octahedral_size_px(slot);
    if (wishes.esm_format) {
      lamp.settings.format = *wishes.esm_format == scene::EsmFormat::Half ? EsmFormat::Half : EsmFormat::Float;
    }
  }
  const std::vector<std::string> limits = OctahedralStore::limits_of(device_limits, esm_lamps_);
  limits_.insert(limits_.end(), limits.begin(), limits.end());
}

int Shadows::octahedral_size_px(const Slot &slot) const
{
  const int asked = slot.lamp.shadow.esm_size.value_or(settings_.esm.size_px);
  return std::max(int(float(asked) * memory_scale_), std::min(asked, 4));
}

std::size_t Shadows::bytes_needed() const
{
  std::size_t bytes = 0;
  for (const Array *array : {&cubes_, &maps_, &distance_cube_}) {
    std::size_t edge = 0;
    std::size_t layers = 0;
    for (const Slot &slot : array->slots) {
      edge = std::max(edge, std::size_t(slot.size_px));
      layers += std::size_t(slot.layer_count_max);
    }
    // The cube on the way to octahedral layers is one for all.
    layers = array == &distance_cube_ ? std::min<std::size_t>(layers, 6) : layers;
    bytes += edge * edge * layers * sizeof(float);
  }
  // Octahedral layers likewise, as if none were in halves; and two more that a separable filter works in.
  std::size_t edge = 0;
  std::size_t texel_bytes = 0;
  for (const Slot &slot : distance_cube_.slots) {
    edge = std::max(edge, std::size_t(octahedral_size_px(slot) + 2 * ESM_BORDER));
    texel_bytes = std::max(texel_bytes, sizeof(float) * (slot.kind == scene::ShadowKind::Evsm ? 2 : 1));
  }
  const std::size_t scratch = settings_.esm.kernel == EsmKernel::Separable ? 2 : 0;
  bytes += edge * edge * texel_bytes * (distance_cube_.slots.size() + scratch);
  return bytes;
}

void Shadows::fit_memory(Lamps &lamps)
{
  memory_scale_ = 1.0F;
  const std::size_t most = settings_.memory_bytes_max;
  const std::size_t needed = bytes_needed();
  if (needed <= most) {
    return;
  }
  constexpr int size_px_min = 16;
  memory_scale_ = float(std::sqrt(double(most) / double(needed)));
  std::size_t lowered = 0;
  for (Array *array : arrays()) {
    for (Slot &slot : array->slots) {
      slot.size_px = std::max(int(float(slot.size_px) * memory_scale_), std::min(size_px_min, slot.size_px));
      lowered++;
    }
  }
  limits_.push_back(
      fmt::format("the shadows of {} lamps need {:.1f} MiB, and may take {:.1f}: their sizes are lowered to {:.0f} %",
                  lowered, double(needed) / 0x1p20, double(most) / 0x1p20, 100.0F * memory_scale_));
  std::vector<std::string> lost;
  while (bytes_needed() > most) {
    // The last light of all goes first.
    const auto last_light = [](const Array *array) { return array->slots.empty() ? -1 : array->slots.back().light; };
    Array &array = *std::ranges::max(arrays(), {}, last_light);
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
      old.kind = slot.kind;
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
  array.framebuffers.resize(std::size_t(layers));
}

static const gpu::Framebuffer &made(gpu::Device &device, gpu::Framebuffer &framebuffer, std::string name,
                                    const gpu::Attachment &depth)
{
  if (!framebuffer) {
    framebuffer = device.create_framebuffer({.name = std::move(name), .colors = {}, .depth = depth});
  }
  return framebuffer;
}

void Shadows::place_render_blocks(gpu::Device &device)
{
  const std::uint32_t alignment = device.limits().uniform_offset_alignment;
  const auto stride = std::uint32_t((sizeof(shared::ShadowRenderBlock) + alignment - 1) / alignment * alignment);
  std::uint32_t size = 0;
  for (Array *array : arrays()) {
    for (Slot &slot : array->slots) {
      slot.render_offset_bytes = size;
      size += stride;
    }
  }
  if (size == 0) {
    render_buffer_ = {};
  }
  else if (!render_buffer_ || render_buffer_.size_bytes() != size) {
    // A buffer of many blocks may be larger than one block may be, so it is made as storage.
    render_buffer_ = device.create_buffer({"shadow_render_block", gpu::BufferKind::Storage, size});
  }
}

void Shadows::finish()
{
  is_finished_ = true;
  caster_bounds_ws_ = {};
  caster_volumes_.clear();
  caster_calls_.clear();
  for (const Caster &caster : casters_) {
    caster_bounds_ws_.extend(caster.bounds_ws);
    caster_volumes_.push_back({caster.bounds_ws.center(), caster.bounds_ws.radius()});
    caster_calls_.push_back(caster.instances);
  }
  std::ranges::sort(caster_calls_);
  caster_calls_.erase(std::unique(caster_calls_.begin(), caster_calls_.end()), caster_calls_.end());
  const std::vector<scene::Bounds> changed = changed_bounds(casters_before_, casters_);
  casters_before_.clear();
  for (Array *array : arrays()) {
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
      slot.near = slot.lamp.shadow.clip_start.value_or(lamp_near(position_ws, slot.range, casters_));
      if (slot.layer_count_max == 6) {
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

/** ShadowCubeData::far and ShadowMapData::far where a shadow has no end. */
static constexpr float far_none = std::numeric_limits<float>::max();

void Shadows::write_cube_data(const Slot &slot)
{
  shared::ShadowCubeData &data = shadow_block_.cubes[slot.entry];
  data.near = slot.near;
  data.far = slot.lamp.shadow.clip_end.value_or(far_none);
  data.texel_size = 2.0F / (float(slot.size_px) * shared::cube_uv_scale(float(slot.size_px)));
  data.bias = slot.lamp.shadow.bias.value_or(1.0F);
  data.layer = slot.first_layer;
  data.face_mask = int(slot.drawn);
  data.filter_kind = slot.kind == scene::ShadowKind::Pcf ? SHADOW_FILTER_PCF : SHADOW_FILTER_HARD;
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
    data.far = view.is_perspective() ? slot.lamp.shadow.clip_end.value_or(far_none) : far_none;
    data.bias = slot.lamp.shadow.bias.value_or(1.0F);
    data.layer = slot.first_layer + int(i);
    data.cascade_count = slot.drawn == 0 ? 0 : int(slot.views.size() - i);
    data.filter_kind = slot.kind == scene::ShadowKind::Pcf ? SHADOW_FILTER_PCF : SHADOW_FILTER_HARD;
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
  if (maps_.slots.empty()) {
    return;
  }
  // Room that a wider view of the same lamps needed stays, for the next one.
  int layers_max = 0;
  for (const Slot &slot : maps_.slots) {
    layers_max += slot.layer_count_max;
  }
  const int layers_now = maps_.texture ? maps_.texture.desc().layers : 0;
  create_layers(device, maps_, std::max(layers, std::min(layers_now, layers_max)));
}

/** Fills caster_layers_. */
void Shadows::find_touched_layers(const Slot &slot)
{
  const glm::vec3 position_ws(slot.lamp.world_from_lamp[3]);
  const std::size_t count = caster_volumes_.size();
  caster_layers_.assign(count, 0);
  if (slot.views.size() == 6) {
    const float half_size = 1.0F / shared::cube_uv_scale(float(slot.size_px));
    for (std::size_t i = 0; i < count; i++) {
      const scene::Bounds &box = casters_[i].bounds_ws;
      caster_layers_[i] = std::uint8_t(cube_face_mask({box.min - position_ws, box.max - position_ws}, half_size));
    }
  }
  else {
    for (std::size_t layer = 0; layer < slot.views.size(); layer++) {
      for (std::size_t i = 0; i < count; i++) {
        if (slot.views[layer].touches(caster_volumes_[i])) {
          caster_layers_[i] = std::uint8_t(caster_layers_[i] | 1U << layer);
        }
      }
    }
  }
  if (!std::isinf(slot.range)) {
    for (std::size_t i = 0; i < count; i++) {
      if (distance_to(casters_[i].bounds_ws, position_ws) > slot.range) {
        caster_layers_[i] = 0;
      }
    }
  }
}

void Shadows::update_slot(gpu::Device &device, Slot &slot, Array &array, std::uint32_t wanted, const draw::Pass &pass,
                          gpu::CommandList &list)
{
  const std::uint32_t all = (1U << slot.views.size()) - 1U;
  const std::uint32_t missing = wanted & all & ~slot.settled;
  if (missing == 0) {
    return;
  }
  const bool is_cube = &array != &maps_;
  find_touched_layers(slot);
  std::uint32_t with_casters = 0;
  for (const std::uint8_t layers : caster_layers_) {
    with_casters |= layers & missing;
  }

  shared::ShadowRenderBlock block{};
  for (std::size_t i = 0; i < slot.views.size(); i++) {
    block.clip_from_world[i] = slot.views[i].clip_from_world();
  }
  list.update(render_buffer_, slot.render_offset_bytes, std::as_bytes(std::span(&block, 1)));
  render_block_range_ = {render_buffer_.id(), slot.render_offset_bytes, sizeof(block)};

  const auto record_instances = [&](std::uint32_t layers) {
    std::ranges::for_each(caster_calls_, &draw::InstanceCall::clear);
    const std::size_t count = casters_.size();
    for (std::size_t i = 0; i < count; i++) {
      for (std::uint32_t rest = caster_layers_[i] & layers; rest != 0; rest &= rest - 1) {
        casters_[i].instances->add(casters_[i].object, std::uint32_t(std::countr_zero(rest)));
        counters_.caster_draws++;
      }
    }
    // What is nearer than the near plane is drawn on it, unless the lamp asks for it to be left out.
    pass.record(slot.views.front(), list, slot.lamp.shadow.clip_start ? gpu::State::DepthClamp : gpu::State::None);
  };
  const auto name = [&](std::string_view what) { return fmt::format("shadow of {}, {}", slot.lamp.name, what); };
  const gpu::PassActions clear{.viewport_px = glm::ivec2(slot.size_px)};
  gpu::PassActions keep = clear;
  keep.depth_load = gpu::LoadAction::Load;
  // What has no caster is not looked up, but for a cascade among others: that has to be empty.
  const std::uint32_t drawn = slot.fits.empty() ? with_casters : missing;
  const bool is_one_pass = layer_pass_ != LayerPass::Single && with_casters != 0;
  // One clear of all layers is cheaper than one of each; but those that stay must not be cleared.
  const bool is_cleared_at_once = is_one_pass && drawn == all;
  for (std::uint32_t rest = is_cleared_at_once ? 0 : drawn; rest != 0; rest &= rest - 1) {
    const int layer = std::countr_zero(rest);
    const int in_array = slot.first_layer + layer;
    list.begin_pass(name(fmt::format("{} {}", is_cube ? "face" : "map", layer)),
                    made(device, array.framebuffers[std::size_t(in_array)], fmt::format("{} {}", array.name, in_array),
                         {&array.texture, in_array}),
                    clear);
    if (layer_pass_ == LayerPass::Single) {
      record_instances(1U << layer);
    }
    list.end_pass();
  }
  if (is_one_pass) {
    const gpu::Framebuffer &layers =
        made(device, slot.framebuffer, fmt::format("{} of {}", array.name, slot.lamp.name),
             {.texture = &array.texture, .layer = slot.first_layer, .layer_count = int(slot.views.size())});
    slot.framebuffer_layers = int(slot.views.size());
    list.begin_pass(name("all layers"), layers, is_cleared_at_once ? clear : keep);
    record_instances(missing);
    list.end_pass();
  }
  slot.drawn |= drawn;
  slot.drawn_now |= drawn;
  slot.settled |= missing;
  if (&array == &cubes_) {
    write_cube_data(slot);
  }
  else if (&array == &maps_) {
    write_map_data(slot);
  }
  else {
    octahedral_.record(list, std::size_t(slot.entry),
                       {array.texture, slot.first_layer, slot.near, slot.drawn,
                        shared::cube_uv_scale(float(slot.size_px)), slot.size_px});
  }
  if (drawn == 0) {
    return;
  }
  counters_.lamps_updated++;
  counters_.faces_drawn += std::uint64_t(std::popcount(drawn));
  counters_.faces_skipped += std::uint64_t(std::popcount(all & ~drawn));
}

std::uint32_t Shadows::looked_up_layers(const Slot &slot) const
{
  if (slot.lamp.kind == scene::LampKind::Sun) {
    // Fitted to what is visible.
    return ~0U;
  }
  return slot.layer_count_max == 6 ? looked_up_faces(slot) : is_spot_looked_up(slot) ? 1U : 0U;
}

/** Whether anything visible may be within the four sides of a spot's map. */
bool Shadows::is_spot_looked_up(const Slot &slot) const
{
  const glm::dvec3 position_ws(slot.lamp.world_from_lamp[3]);
  const std::span sides = std::span(slot.views.front().frustum_planes_ws()).first(4);
  return std::ranges::none_of(sides, [&](const glm::vec4 &side) {
    return std::ranges::all_of(visible_.corners, [&](const glm::dvec3 &corner) {
      // The plane's own rounding grows with the coordinates; a map too many costs no more than it did.
      const double slack = 1e-4 * (glm::length(corner) + glm::length(position_ws));
      return glm::dot(glm::dvec3(side), corner) + double(side.w) < -slack;
    });
  });
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
                     gpu::CommandList &list, const std::function<std::vector<float>()> &read_depths)
{
  if (seen_clip_from_world_ != view.clip_from_world()) {
    visible_ = visible_range(view, visible_corners(view, caster_bounds_ws_));
    const bool has_sun =
        std::ranges::any_of(maps_.slots, [](const Slot &slot) { return slot.lamp.kind == scene::LampKind::Sun; });
    if (has_sun && settings_.cascades.is_fitted_to_depth && read_depths) {
      narrow_to_depths(view, read_depths(), visible_);
    }
    fit_suns(device, view, pixel_size);
    seen_clip_from_world_ = view.clip_from_world();
  }
  for (Array *array : {&cubes_, &maps_}) {
    for (Slot &slot : array->slots) {
      update_slot(device, slot, *array, looked_up_layers(slot), pass, list);
    }
  }
  // The filter looks around corners, so that all faces are wanted; and the cube is the next lamp's then.
  for (Slot &slot : distance_cube_.slots) {
    update_slot(device, slot, distance_cube_, ~0U, pass, list);
  }
  if (std::exchange(is_block_dirty_, false) && shadow_block_buffer_) {
    device.update(shadow_block_buffer_, shadow_block_);
  }
}

double Shadows::texel_size(const shared::LightData &light, const glm::dvec3 &position_ws) const
{
  const glm::dvec3 from_light = position_ws - glm::dvec3(light.position_ws);
  if (light.shadow_kind == SHADOW_CUBE) {
    const glm::dvec3 size = glm::abs(from_light);
    return double(shadow_block_.cubes[light.shadow_index].texel_size) * std::max({size.x, size.y, size.z});
  }
  if (light.shadow_kind == SHADOW_ESM) {
    const int size = octahedral_.data(std::size_t(light.shadow_index)).size;
    return glm::length(from_light) *
           double(shared::octahedral_texel_angle(glm::vec3(glm::normalize(from_light)), size));
  }
  if (light.shadow_kind == SHADOW_MAP) {
    const int first = light.shadow_index;
    for (int i = first; i < first + shadow_block_.maps[first].cascade_count; i++) {
      const shared::ShadowMapData &map = shadow_block_.maps[i];
      const glm::dvec4 texco = glm::dmat4(map.texco_from_world) * glm::dvec4(position_ws, 1.0);
      const glm::dvec2 uv = glm::dvec2(texco) / texco.w;
      if (texco.w > 0.0 && std::min({uv.x, uv.y, 1.0 - uv.x, 1.0 - uv.y}) > 0.0) {
        return double(map.texel_size) * texco.w;
      }
    }
  }
  return 0.0;
}

std::optional<ShadowLayers> Shadows::layers(const shared::LightData &light) const
{
  if (light.shadow_kind == SHADOW_NONE) {
    return std::nullopt;
  }
  const Array &array = light.shadow_kind == SHADOW_CUBE  ? cubes_
                       : light.shadow_kind == SHADOW_ESM ? distance_cube_
                                                         : maps_;
  const Slot &slot = *std::ranges::find(array.slots, light.shadow_index, &Slot::entry);
  ShadowLayers layers;
  layers.count = int(slot.views.size());
  layers.texture = layers.count > 0 ? &array.texture : nullptr;
  layers.first_layer = slot.first_layer;
  layers.size_px = slot.size_px;
  layers.is_cube = &array == &cubes_;
  layers.drawn = slot.drawn;
  if (slot.lamp.kind == scene::LampKind::Sun) {
    layers.projection = PROJECTION_ORTHOGRAPHIC;
    const double top = slot.fits.empty() ? 0.0 : slot.fits.back().max.z;
    for (const SunFit &fit : slot.fits) {
      layers.near_far.emplace_back(top - fit.max.z, top - fit.min.z);
    }
    layers.shown = layers.near_far.empty() ? glm::vec2(0.0F) : layers.near_far.back();
    return layers;
  }

  const glm::vec3 position_ws(slot.lamp.world_from_lamp[3]);
  const glm::vec3 reach =
      glm::max(glm::abs(caster_bounds_ws_.min - position_ws), glm::abs(caster_bounds_ws_.max - position_ws));
  layers.near_far = {{slot.near, std::numeric_limits<float>::max()}};
  layers.shown = {slot.near, std::min(std::max({reach.x, reach.y, reach.z}), slot.range)};
  if (light.shadow_kind == SHADOW_ESM) {
    const auto index = std::size_t(light.shadow_index);
    const shared::EsmData &data = octahedral_.data(index);
    layers.count = 1;
    layers.texture = &octahedral_.texture(index);
    layers.first_layer = data.layer;
    layers.size_px = data.size;
    layers.border = ESM_BORDER;
    layers.drawn = 1;
    layers.esm_format = data.format;
    layers.near_far = {{0.0F, data.range}};
    layers.shown.y = std::min(glm::length(reach), slot.range);
  }
  return layers;
}

void Shadows::begin_picture()
{
  for (Array *array : arrays()) {
    for (Slot &slot : array->slots) {
      slot.drawn_now = 0;
    }
  }
}

std::vector<ShadowState> Shadows::states() const
{
  std::vector<ShadowState> states;
  for (const Array *array : {&cubes_, &maps_, &distance_cube_}) {
    for (const Slot &slot : array->slots) {
      states.push_back({.light = slot.light,
                        .array = array->name,
                        .size_px = slot.size_px,
                        .layer_count = int(slot.views.size()),
                        .drawn = slot.drawn,
                        .settled = slot.settled,
                        .drawn_now = slot.drawn_now});
    }
  }
  return states;
}

void Shadows::invalidate()
{
  for (Array *array : arrays()) {
    for (Slot &slot : array->slots) {
      slot.drawn = slot.settled = 0;
    }
  }
}

Feature Shadows::features() const
{
  Feature features = Feature::None;
  for (const Slot &slot : cubes_.slots) {
    features = features | Feature::ShadowCube | (slot.kind == scene::ShadowKind::Pcf ? Feature::ShadowPcf : features);
  }
  for (const Slot &slot : maps_.slots) {
    features = features | Feature::ShadowMap | (slot.kind == scene::ShadowKind::Pcf ? Feature::ShadowPcf : features);
  }
  for (const Slot &slot : distance_cube_.slots) {
    features = features | Feature::ShadowEsm | (slot.kind == scene::ShadowKind::Evsm ? Feature::ShadowEvsm : features);
  }
  return features;
}

void Shadows::bind(draw::ShadingGroup &group) const
{
  if (!cubes_.slots.empty() || !maps_.slots.empty()) {
    group.bind_uniform("shadow_block", shadow_block_buffer_);
    group.bind_texture_ref("shadow_cubes", &cubes_.binding);
    group.bind_texture_ref("shadow_maps", &maps_.binding);
  }
  if (!distance_cube_.slots.empty()) {
    octahedral_.bind(group);
  }
}

}  // namespace gnomon::eevee
