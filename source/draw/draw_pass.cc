// SPDX-License-Identifier: MIT
#include "draw_pass.hh"

#include <algorithm>

namespace gnomon::draw {

void InstanceCall::clear()
{
  instances_.clear();
}

ShadingGroup::ShadingGroup(const gpu::Shader &shader, ObjectBuffer *objects)
    : shader_(shader), objects_(objects), constant_bytes_(shader.interface().push_constant_size_bytes)
{
}

template <typename Value>
void ShadingGroup::bind(gpu::BindingKind kind, std::string_view name, const Value &value)
{
  const gpu::ShaderInterface::Binding *found = shader_.interface().find(kind, name);
  if (!found) {
    return;
  }
  // A later binding of the same name replaces the earlier one.
  const auto same = std::ranges::find_if(
      bindings_, [&](const Binding &binding) { return binding.kind == kind && binding.slot == found->slot; });
  if (same != bindings_.end()) {
    same->value = value;
  }
  else {
    bindings_.push_back({kind, found->slot, std::string(name), value});
  }
}

void ShadingGroup::bind_uniform(std::string_view name, const gpu::Buffer &block)
{
  bind(gpu::BindingKind::UniformBlock, name, gpu::BufferRange{block.id()});
}

void ShadingGroup::bind_uniform_ref(std::string_view name, const gpu::BufferRange *block)
{
  bind(gpu::BindingKind::UniformBlock, name, block);
}

void ShadingGroup::bind_storage(std::string_view name, const gpu::Buffer &block)
{
  bind(gpu::BindingKind::StorageBlock, name, gpu::BufferRange{block.id()});
}

void ShadingGroup::bind_storage_ref(std::string_view name, const gpu::BufferRange *block)
{
  bind(gpu::BindingKind::StorageBlock, name, block);
}

void ShadingGroup::bind_texture(std::string_view name, const gpu::Texture &texture, const gpu::Sampler &sampler)
{
  bind(gpu::BindingKind::Texture, name, TextureBinding{texture.id(), sampler.id()});
}

void ShadingGroup::bind_texture_ref(std::string_view name, const TextureBinding *binding)
{
  bind(gpu::BindingKind::Texture, name, binding);
}

ShadingGroup::Constant *ShadingGroup::constant_entry(std::string_view name, std::size_t size_bytes)
{
  const gpu::ShaderInterface::Member *member = shader_.interface().find_push_constant(name);
  if (!member) {
    return nullptr;
  }
  GNOMON_ASSERT(size_bytes <= member->size_bytes, "constant '{}' of shader '{}' takes {} bytes, not {}", name,
                shader_.name(), member->size_bytes, size_bytes);
  // A later value of the same constant replaces the earlier one.
  const auto same = std::ranges::find(constants_, member->offset_bytes, &Constant::offset_bytes);
  if (same != constants_.end()) {
    same->size_bytes = size_bytes;
    return &*same;
  }
  constants_.push_back({std::string(name), member->offset_bytes, size_bytes});
  return &constants_.back();
}

void ShadingGroup::call(const gpu::Batch &batch, const glm::mat4 &world_from_object)
{
  GNOMON_ASSERT(objects_, "a call with a matrix, in a pass without an object buffer (shader '{}')", shader_.name());
  call(batch, objects_->add(world_from_object));
}

void ShadingGroup::add_call(const gpu::BatchRange &batch, ObjectIndex object, std::uint32_t volume)
{
  const Call call{batch.first_index, batch.index_count, batch.base_vertex, object, volume};
  if (batch.host_batch == 0) {
    calls_.push_back(call);
  }
  else {
    host_calls_.push_back({call, batch.host_batch});
  }
}

void ShadingGroup::call(const gpu::Batch &batch, ObjectIndex object)
{
  call(batch.range(), object);
}

void ShadingGroup::call(const gpu::BatchRange &batch, ObjectIndex object)
{
  add_call(batch, object, object_volume);
}

void ShadingGroup::call(const gpu::Batch &batch, ObjectIndex object, const CullingVolume &volume)
{
  if (volume.radius < 0.0F) {
    call(batch, object);
    return;
  }
  add_call(batch.range(), object, std::uint32_t(volumes_.size()));
  volumes_.push_back(volume);
}

InstanceCall &ShadingGroup::instances(const gpu::Batch &batch)
{
  std::deque<InstanceCall> &calls = batch.range().host_batch == 0 ? instance_calls_ : host_instance_calls_;
  calls.push_back(InstanceCall(batch.range()));
  return calls.back();
}

void ShadingGroup::call_procedural(std::uint32_t triangle_count, std::uint32_t instance_count)
{
  procedural_calls_.push_back({triangle_count, instance_count});
}

void ShadingGroup::record_bindings(gpu::CommandList &list) const
{
  for (const Binding &binding : bindings_) {
    if (binding.kind == gpu::BindingKind::Texture) {
      const auto *reference = std::get_if<const TextureBinding *>(&binding.value);
      const TextureBinding &value = reference ? **reference : std::get<TextureBinding>(binding.value);
      list.bind_texture(binding.slot, value.texture, value.sampler);
      continue;
    }
    const auto *reference = std::get_if<const gpu::BufferRange *>(&binding.value);
    const gpu::BufferRange &value = reference ? **reference : std::get<gpu::BufferRange>(binding.value);
    if (binding.kind == gpu::BindingKind::UniformBlock) {
      list.bind_uniform(binding.slot, value);
    }
    else {
      list.bind_storage(binding.slot, value);
    }
  }
  if (!constant_bytes_.empty()) {
    const std::span<std::byte> constants = list.push_constants(shader_.interface().push_constant_slot, constant_bytes_);
    for (const Constant &constant : constants_) {
      if (constant.reference) {
        std::memcpy(constants.data() + constant.offset_bytes, constant.reference, constant.size_bytes);
      }
    }
  }
}

bool ShadingGroup::is_current(const gpu::Device &device) const
{
  return std::ranges::all_of(bindings_, [&](const Binding &binding) {
    if (const auto *range = std::get_if<gpu::BufferRange>(&binding.value)) {
      return device.find(gpu::ResourceKind::Buffer, range->buffer) != nullptr;
    }
    const auto *texture = std::get_if<TextureBinding>(&binding.value);
    return !texture || (device.find(gpu::ResourceKind::Texture, texture->texture) &&
                        device.find(gpu::ResourceKind::Sampler, texture->sampler));
  });
}

inline void ShadingGroup::append(const Call &call, bool may_extend, gpu::CommandList &list) const
{
  std::uint32_t instance = call.object;
  if (!objects_) {
    instance = std::uint32_t(list.instances.size());
    list.instances.push_back({call.object, 0});
  }
  // The next instance of the same batch is added to the last draw. Compare the counts too, because an empty batch has
  // the same first index as the batch after it.
  gpu::DrawIndirect *const last = may_extend ? &list.draws.back() : nullptr;
  if (last && last->first_index == call.first_index && last->index_count == call.index_count &&
      last->first_instance + last->instance_count == instance) {
    last->instance_count++;
  }
  else {
    list.draws.push_back({call.index_count, 1, call.first_index, call.base_vertex, instance});
  }
}

void ShadingGroup::append(const InstanceCall &call, gpu::CommandList &list)
{
  list.draws.push_back({call.batch_.index_count, std::uint32_t(call.instances_.size()), call.batch_.first_index,
                        call.batch_.base_vertex, std::uint32_t(list.instances.size())});
  list.instances.insert(list.instances.end(), call.instances_.begin(), call.instances_.end());
}

std::uint64_t ShadingGroup::collect_calls(const View &view, const VisibleObjects &visible, gpu::CommandList &list) const
{
  std::uint64_t drawn = 0;
  for (const Call &call : calls_) {
    if (is_visible(call, view, visible)) {
      append(call, drawn > 0, list);
      drawn++;
    }
  }
  return drawn;
}

std::uint64_t ShadingGroup::collect_instances(gpu::CommandList &list) const
{
  std::uint64_t drawn = 0;
  for (const InstanceCall &call : instance_calls_) {
    if (!call.instances_.empty()) {
      append(call, list);
      drawn += call.instances_.size();
    }
  }
  return drawn;
}

void ShadingGroup::record_draws(std::size_t first, std::size_t end, gpu::ResourceId objects, gpu::CommandList &list)
{
  if (end > first) {
    list.bind_instances(objects);
    list.draw(std::uint32_t(first), std::uint32_t(end - first));
  }
}

bool ShadingGroup::has_host_draws(const View &view, const VisibleObjects &visible) const
{
  return std::ranges::any_of(host_calls_, [&](const HostCall &host) { return is_visible(host.call, view, visible); }) ||
         std::ranges::any_of(host_instance_calls_, [](const InstanceCall &call) { return !call.instances_.empty(); });
}

RecordCounts ShadingGroup::record_host_calls(const View &view, const VisibleObjects &visible,
                                             gpu::CommandList &list) const
{
  RecordCounts counts;
  gpu::ResourceId bound = 0;
  std::size_t first = list.draws.size();
  // Draws of one batch after the other share a command.
  const auto bind = [&](gpu::ResourceId host_batch, gpu::ResourceId objects) {
    if (host_batch != bound) {
      record_draws(first, list.draws.size(), objects, list);
      first = list.draws.size();
      list.bind_host_batch(host_batch);
      bound = host_batch;
    }
  };
  for (const auto &[call, host_batch] : host_calls_) {
    if (!is_visible(call, view, visible)) {
      counts.culled++;
      continue;
    }
    bind(host_batch, object_buffer());
    append(call, list.draws.size() > first, list);
    counts.drawn++;
  }
  record_draws(first, list.draws.size(), object_buffer(), list);
  first = list.draws.size();
  for (const InstanceCall &call : host_instance_calls_) {
    if (!call.instances_.empty()) {
      bind(call.batch_.host_batch, 0);
      append(call, list);
      counts.drawn += call.instances_.size();
    }
  }
  bind(0, 0);
  return counts;
}

Pass::Pass(std::string name, gpu::State state, ObjectBuffer *objects)
    : name_(std::move(name)), state_(state), objects_(objects)
{
}

ShadingGroup &Pass::group(const gpu::Shader &shader)
{
  groups_.push_back(ShadingGroup(shader, objects_));
  return groups_.back();
}

void Pass::clear()
{
  groups_.clear();
  order_.reset();
}

static gpu::State with_other_front(gpu::State state)
{
  return has(state, gpu::State::FrontClockwise) ? without(state, gpu::State::FrontClockwise)
                                                : state | gpu::State::FrontClockwise;
}

RecordCounts Pass::record_group(const ShadingGroup &group, const View &view, const VisibleObjects &visible,
                                gpu::CommandList &list, gpu::State without) const
{
  const std::size_t first_call = list.draws.size();
  const std::uint64_t drawn_calls = group.collect_calls(view, visible, list);
  const std::size_t first_instanced = list.draws.size();
  const std::uint64_t drawn_instances = group.collect_instances(list);
  RecordCounts counts{.drawn = drawn_calls + drawn_instances + group.procedural_calls_.size(),
                      .culled = group.calls_.size() - drawn_calls};
  const bool has_calls = !group.calls_.empty() || !group.instance_calls_.empty() || !group.host_calls_.empty() ||
                         !group.host_instance_calls_.empty();
  if (has_calls && counts.drawn == 0 && !group.has_host_draws(view, visible)) {
    counts.culled += group.host_calls_.size();
    return counts;
  }
  list.set_shader(group.shader_.id());
  const gpu::State state = gpu::without(state_ | group.state_, without);
  list.set_state(view.is_mirrored() ? with_other_front(state) : state);
  group.record_bindings(list);
  GNOMON_ASSERT(drawn_calls == 0 || !objects_ || objects_->buffer(), "pass '{}': its objects are not uploaded", name_);
  ShadingGroup::record_draws(first_call, first_instanced, group.object_buffer(), list);
  ShadingGroup::record_draws(first_instanced, list.draws.size(), 0, list);
  const RecordCounts of_host = group.record_host_calls(view, visible, list);
  counts.drawn += of_host.drawn;
  counts.culled += of_host.culled;
  for (const ShadingGroup::ProceduralCall &call : group.procedural_calls_) {
    list.draw_procedural(call.triangle_count * 3, call.instance_count);
  }
  return counts;
}

RecordCounts Pass::record(const View &view, gpu::CommandList &list, gpu::State without) const
{
  return record(view, visible_, list, without);
}

RecordCounts Pass::record(const View &view, VisibleObjects &visible, gpu::CommandList &list, gpu::State without) const
{
  const auto has_calls = [](const ShadingGroup &group) { return !group.calls_.empty() || !group.host_calls_.empty(); };
  if (objects_ && std::ranges::any_of(groups_, has_calls)) {
    visible.update(view, *objects_);
  }
  RecordCounts counts;
  const std::size_t count = order_ ? order_->size() : groups_.size();
  for (std::size_t i = 0; i < count; i++) {
    const RecordCounts of_group = record_group(groups_[order_ ? (*order_)[i] : i], view, visible, list, without);
    counts.drawn += of_group.drawn;
    counts.culled += of_group.culled;
  }
  return counts;
}

bool Pass::is_current(const gpu::Device &device) const
{
  return std::ranges::all_of(groups_, [&](const ShadingGroup &group) { return group.is_current(device); });
}

std::string Pass::serialize(const gpu::Device &device) const
{
  std::string text = fmt::format("{} [{}]\n", name_, gpu::to_string(state_));
  const auto batch_text = [](std::uint32_t first_index, std::uint32_t index_count, gpu::ResourceId host_batch) {
    return fmt::format("{} triangles from {}{}", index_count / 3, first_index, host_batch == 0 ? "" : " of the host's");
  };
  for (const ShadingGroup &group : groups_) {
    text += fmt::format("  group {}", group.shader_.name());
    text += group.state_ == gpu::State::None ? "\n" : fmt::format(" [{}]\n", gpu::to_string(group.state_));
    for (const ShadingGroup::Binding &binding : group.bindings_) {
      text += fmt::format("    {} {} -> {}", gpu::to_string(binding.kind), binding.name, binding.slot);
      if (binding.is_reference()) {
        text += " by reference\n";
      }
      else if (const auto *range = std::get_if<gpu::BufferRange>(&binding.value)) {
        text += fmt::format(" = {}\n", device.name_of(gpu::ResourceKind::Buffer, range->buffer));
      }
      else {
        text += fmt::format(
            " = {}\n", device.name_of(gpu::ResourceKind::Texture, std::get<TextureBinding>(binding.value).texture));
      }
    }
    for (const ShadingGroup::Constant &constant : group.constants_) {
      text += fmt::format("    constant {}{}\n", constant.name, constant.reference ? " by reference" : "");
    }
    const auto add_call_text = [&](const ShadingGroup::Call &call, gpu::ResourceId host_batch) {
      text += fmt::format("    call {}, object {}", batch_text(call.first_index, call.index_count, host_batch),
                          call.object);
      text += call.volume == ShadingGroup::object_volume ? "\n" : ", culled\n";
    };
    for (const ShadingGroup::Call &call : group.calls_) {
      add_call_text(call, 0);
    }
    for (const auto &[call, host_batch] : group.host_calls_) {
      add_call_text(call, host_batch);
    }
    for (const auto *calls : {&group.instance_calls_, &group.host_instance_calls_}) {
      for (const InstanceCall &call : *calls) {
        const gpu::BatchRange &batch = call.batch_;
        text += fmt::format("    instances {} x{}\n",
                            batch_text(batch.first_index, batch.index_count, batch.host_batch), call.instances_.size());
      }
    }
    for (const ShadingGroup::ProceduralCall &call : group.procedural_calls_) {
      text += fmt::format("    procedural {} triangles x{}\n", call.triangle_count, call.instance_count);
    }
  }
  return text;
}

}  // namespace gnomon::draw
