// SPDX-License-Identifier: MIT
#include "shadow_octahedral_store.hh"

#include "eevee_lamps.hh"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace gnomon::eevee {

static float mean_texel_angle(int size_px)
{
  return std::sqrt(4.0F * std::numbers::pi_v<float>) / float(size_px);
}

float esm_filter_angle(int size_px)
{
  return std::min(0.5F * mean_texel_angle(size_px), 0.5F);
}

float esm_exponent(EsmMethod method, float filter_angle, int size_px, float range)
{
  const bool is_esm = method == EsmMethod::Esm;
  const float spread_at_half_range = is_esm ? 0.5F : 0.0625F;
  const float angle = is_esm ? std::max(filter_angle, mean_texel_angle(size_px)) : filter_angle;
  constexpr scene::Description limits = scene::description_of<EsmSettings>("shadow_exponent");
  return limits.nearest(spread_at_half_range / std::max(0.5F * angle * range, 1e-30F));
}

int esm_cube_size_px(int size_px)
{
  return std::max(size_px / 2, 1);
}

namespace {

/** The entry of \a lamp in esm_block, without the layer. \throws gpu::Error if a setting is out of range */
shared::EsmData make_data(const EsmLamp &lamp)
{
  const EsmSettings &settings = lamp.settings;
  if (!(lamp.range >= 1e-6F && lamp.range <= 1e30F)) {
    throw gpu::Error("lamp '{}': range {} m of its shadow is not in [1e-06, 1e+30]", lamp.name, lamp.range);
  }
  if (const std::string fault = scene::limit_fault(settings); !fault.empty()) {
    throw gpu::Error("lamp '{}': {}", lamp.name, fault);
  }
  const float filter_angle = settings.filter_angle.value_or(esm_filter_angle(settings.size_px));
  const float exponent =
      settings.exponent.value_or(esm_exponent(settings.method, filter_angle, settings.size_px, lamp.range));

  shared::EsmData data{};
  data.exponent = exponent;
  data.bias = settings.bias;
  data.range = lamp.range;
  data.filter_angle = filter_angle;
  data.size = settings.size_px;
  const float half_error = shared::esm_visibility_error(exponent, shared::esm_format_error(lamp.range, ESM_HALF));
  const bool is_half = settings.format == EsmFormat::Half || (!settings.format && half_error <= esm_half_error_max);
  data.format = settings.method == EsmMethod::Evsm ? ESM_VARIANCE : is_half ? ESM_HALF : ESM_FLOAT;
  return data;
}

}  // namespace

OctahedralStore::Plan OctahedralStore::plan(const gpu::Limits &device_limits, std::span<const EsmLamp> lamps, Runs runs)
{
  const std::size_t most = std::size_t(std::min(ESM_MAX, device_limits.array_layers_max));
  Plan plan;
  std::array<std::vector<LayerOwner>, 3> owners;
  std::vector<std::string> lost;
  for (const EsmLamp &lamp : lamps) {
    const shared::EsmData data = make_data(lamp);
    if (plan.slots.size() == most) {
      lost.push_back(lamp.name);
      continue;
    }
    const auto format = std::size_t(data.format);
    owners[format].push_back({lamp.key});
    plan.sizes[format] = std::max(plan.sizes[format], data.size + 2 * ESM_BORDER);
    if (lamp.settings.kernel == EsmKernel::Separable) {
      plan.scratch_size = std::max(plan.scratch_size, data.size);
      plan.scratch_format = lamp.settings.method == EsmMethod::Evsm ? gpu::Format::RG32F : plan.scratch_format;
    }
    const float error = shared::esm_visibility_error(data.exponent, shared::esm_format_error(data.range, data.format));
    if (error > esm_half_error_max) {
      plan.limits.push_back(
          fmt::format("lamp '{}': 16 bits round its shadow by up to {:.2g} at an exponent of {:.4g}/m over "
                      "{:.4g} m; 32 bits would not",
                      lamp.name, error, data.exponent, data.range));
    }
    plan.block.lamps[plan.slots.size()] = data;
    plan.slots.push_back({.key = lamp.key, .kernel = lamp.settings.kernel, .method = lamp.settings.method});
  }
  for (std::size_t format = 0; format < runs.size(); format++) {
    runs[format].keep_only(owners[format]);
  }
  const auto place = [&] {
    for (std::size_t i = 0; i < plan.slots.size(); i++) {
      shared::EsmData &data = plan.block.lamps[i];
      data.layer = runs[std::size_t(data.format)].place({plan.slots[i].key}, 1);
    }
  };
  place();
  // Gaps of removed lamps are kept for new lamps, unless more than half of the layers would be unused.
  for (std::size_t format = 0; format < runs.size(); format++) {
    if (runs[format].end() > std::min(2 * int(owners[format].size()), int(most))) {
      runs[format].clear();
    }
  }
  place();
  plan.runs = std::move(runs);
  if (!lost.empty()) {
    plan.limits.push_back(fmt::format("{} lamps lost their shadow, as {} octahedral layers are the most: {}",
                                      lost.size(), most, listed(lost)));
  }
  return plan;
}

bool OctahedralStore::has_texels(const Slot &slot, const shared::EsmData &data) const
{
  const auto old = std::ranges::find(slots_, slot.key, &Slot::key);
  if (old == slots_.end() || old->kernel != slot.kernel || old->method != slot.method) {
    return false;
  }
  shared::EsmData old_data = block_.lamps[old - slots_.begin()];
  // The bias does not affect texels, because only lookups read it.
  old_data.bias = data.bias;
  return std::memcmp(&old_data, &data, sizeof(data)) == 0;
}

bool OctahedralStore::sync(gpu::Device &device, ShaderCache &shaders, std::span<const EsmLamp> lamps)
{
  device_ = &device;
  Plan plan = OctahedralStore::plan(device.limits(), lamps, runs_);
  bool is_any_new = false;
  for (std::size_t i = 0; i < plan.slots.size(); i++) {
    plan.slots[i].must_record = !has_texels(plan.slots[i], plan.block.lamps[i]);
    is_any_new |= plan.slots[i].must_record;
  }
  for (std::size_t format = 0; format < arrays_.size(); format++) {
    bool has_content = false;
    for (std::size_t i = 0; i < plan.slots.size(); i++) {
      has_content |= plan.block.lamps[i].format == int(format) && !plan.slots[i].must_record;
    }
    arrays_[format].resize(device, plan.sizes[format], plan.runs[format].end(), has_content);
  }
  create_scratch(device, plan.scratch_size, plan.scratch_format);
  block_ = plan.block;
  slots_ = std::move(plan.slots);
  runs_ = std::move(plan.runs);
  limits_ = std::move(plan.limits);
  if (!slots_.empty()) {
    if (!block_buffer_) {
      sampler_ = device.create_sampler({.name = "esm_sampler"});
      block_buffer_ = device.create_buffer({"esm_block", gpu::BufferKind::Uniform, sizeof(shared::EsmBlock)});
    }
    device.update(block_buffer_, block_);
  }
  else {
    block_buffer_ = {};
  }
  // Arrays without layers do not exist. Their slots get another array, which shaders do not read there.
  const auto some = std::ranges::find_if(arrays_, [](const LayerArray &array) { return bool(array.texture()); });
  for (std::size_t i = 0; i < arrays_.size() && some != arrays_.end(); i++) {
    const gpu::Texture &texture = arrays_[i].texture() ? arrays_[i].texture() : some->texture();
    bindings_[i] = {texture.id(), sampler_.id()};
  }
  record_passes(device, shaders);
  return is_any_new;
}

void OctahedralStore::create_scratch(gpu::Device &device, int size_px, gpu::Format format)
{
  const gpu::Texture &now = scratch_[0].texture;
  if (now ? now.desc().width == size_px && now.desc().format == format : size_px == 0) {
    return;
  }
  scratch_ = {};
  if (size_px == 0) {
    return;
  }
  for (Scratch &scratch : scratch_) {
    const std::string name = &scratch == scratch_.data() ? "esm_distance" : "esm_rows";
    scratch.texture = device.create_texture({.name = name, .format = format, .width = size_px, .height = size_px});
    scratch.framebuffer = device.create_framebuffer({.name = name, .colors = {{&scratch.texture}}, .depth = {}});
  }
}

void OctahedralStore::record_passes(gpu::Device &device, ShaderCache &shaders)
{
  const auto has = [&](EsmKernel kernel, EsmMethod method) {
    return std::ranges::any_of(slots_,
                               [&](const Slot &slot) { return slot.kernel == kernel && slot.method == method; });
  };
  const auto group_of = [&](draw::Pass &pass, ShaderId id, bool is_needed) {
    pass.clear();
    if (!is_needed) {
      return;
    }
    draw::ShadingGroup &group = pass.group(shaders.get(device, id));
    group.bind_uniform("esm_block", block_buffer_);
    group.bind_texture_ref("shadow_cubes", &recorded_.cube);
    group.bind_texture_ref("esm_source", &recorded_.source);
    group.constant_ref("lamp", &recorded_.lamp);
    group.constant_ref("first_layer", &recorded_.first_layer);
    group.constant_ref("face_mask", &recorded_.face_mask);
    group.constant_ref("near", &recorded_.near);
    group.constant_ref("uv_scale", &recorded_.uv_scale);
    group.constant_ref("cube_size_px", &recorded_.cube_size_px);
    group.constant_ref("axis", &recorded_.axis);
    group.call_procedural();
  };
  group_of(disk4_, ShaderId::EsmDisk4, has(EsmKernel::Disk4, EsmMethod::Esm));
  group_of(disk32_, ShaderId::EsmDisk32, has(EsmKernel::Disk32, EsmMethod::Esm));
  group_of(separable_, ShaderId::EsmSeparable, has(EsmKernel::Separable, EsmMethod::Esm));
  group_of(evsm_disk4_, ShaderId::EvsmDisk4, has(EsmKernel::Disk4, EsmMethod::Evsm));
  group_of(evsm_disk32_, ShaderId::EvsmDisk32, has(EsmKernel::Disk32, EsmMethod::Evsm));
  group_of(evsm_separable_, ShaderId::EvsmSeparable, has(EsmKernel::Separable, EsmMethod::Evsm));
  group_of(distance_, ShaderId::EsmDistance,
           has(EsmKernel::Separable, EsmMethod::Esm) || has(EsmKernel::Separable, EsmMethod::Evsm));
}

const draw::Pass &OctahedralStore::pass_of(const Slot &slot) const
{
  const bool is_esm = slot.method == EsmMethod::Esm;
  switch (slot.kernel) {
    case EsmKernel::Disk4: return is_esm ? disk4_ : evsm_disk4_;
    case EsmKernel::Disk32: return is_esm ? disk32_ : evsm_disk32_;
    case EsmKernel::Separable: break;
  }
  return is_esm ? separable_ : evsm_separable_;
}

void OctahedralStore::record(gpu::CommandList &list, std::size_t index, const EsmCube &cube)
{
  GNOMON_ASSERT(index < slots_.size(), "octahedral layer {} of {}", index, slots_.size());
  GNOMON_ASSERT(cube.near > 0.0F && cube.uv_scale > 0.0F && cube.uv_scale <= 1.0F, "near {}, uv_scale {}", cube.near,
                cube.uv_scale);
  const shared::EsmData &data = block_.lamps[index];
  recorded_.lamp = int(index);
  recorded_.first_layer = cube.first_layer;
  recorded_.face_mask = int(cube.face_mask);
  recorded_.near = cube.near;
  recorded_.uv_scale = cube.uv_scale;
  recorded_.cube_size_px = cube.size_px > 0 ? cube.size_px : cube.texture.desc().width;
  recorded_.cube = {cube.texture.id(), sampler_.id()};

  // The clear colour is the encoded range and a variance of 0. A map that is smaller than the layer leaves it there.
  const auto record_into = [&](const draw::Pass &pass, const gpu::Framebuffer &framebuffer, float far) {
    fmt::memory_buffer name;
    fmt::format_to(std::back_inserter(name), "{} of lamp {}", pass.name(), index);
    list.begin_pass({name.data(), name.size()}, framebuffer, {.clear_color = glm::vec4(far, 0.0F, 0.0F, 0.0F)});
    pass.record({}, list);
    list.end_pass();
  };
  const gpu::Framebuffer &layer = arrays_[std::size_t(data.format)].framebuffer(*device_, data.layer);
  const float far = shared::esm_encoded(data.range, data.range, data.format);
  if (slots_[index].kernel != EsmKernel::Separable) {
    record_into(pass_of(slots_[index]), layer, far);
    return;
  }
  record_into(distance_, scratch_[0].framebuffer, data.range);
  for (recorded_.axis = 0; recorded_.axis < 2; recorded_.axis++) {
    recorded_.source = {scratch_[std::size_t(recorded_.axis)].texture.id(), sampler_.id()};
    record_into(pass_of(slots_[index]), recorded_.axis == 0 ? scratch_[1].framebuffer : layer, far);
  }
}

void OctahedralStore::bind(draw::ShadingGroup &group) const
{
  GNOMON_ASSERT(!slots_.empty(), "no lamp has an octahedral layer");
  group.bind_uniform("esm_block", block_buffer_);
  group.bind_texture_ref("shadow_esm", &bindings_[ESM_FLOAT]);
  group.bind_texture_ref("shadow_esm_half", &bindings_[ESM_HALF]);
  group.bind_texture_ref("shadow_evsm", &bindings_[ESM_VARIANCE]);
}

std::vector<const gpu::Texture *> OctahedralStore::textures() const
{
  std::vector<const gpu::Texture *> textures;
  const auto add = [&](const gpu::Texture &texture) {
    if (texture) {
      textures.push_back(&texture);
    }
  };
  std::ranges::for_each(arrays_, add, &LayerArray::texture);
  std::ranges::for_each(scratch_, add, &Scratch::texture);
  return textures;
}

std::size_t OctahedralStore::size_bytes() const
{
  std::size_t bytes = 0;
  for (const gpu::Texture *texture : textures()) {
    bytes += texture->desc().size_bytes();
  }
  return bytes;
}

}  // namespace gnomon::eevee
