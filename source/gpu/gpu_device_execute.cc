// SPDX-License-Identifier: MIT
// The functions of Device that run on the device's thread.
#include "gpu_device.hh"

#include "gpu_shader_cache.hh"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace gnomon::gpu {

void Device::submit(Packet &packet)
{
  GNOMON_ASSERT(std::this_thread::get_id() == thread_, "a packet is submitted on another thread than the device's");
  GNOMON_ASSERT(packet.is_pending_ && packet.link_->device == this, "the packet is not recorded for this device");
  check_can_execute();
  const Calls calls(*this);
  packet.is_pending_ = false;
  try {
    if (packet.has_failed_) {
      throw Error("the packet is not executed, because an operation failed");
    }
    if (packet.loss_count_ != losses_) {
      throw Error("the packet is not executed, because an earlier one was lost after its recording began");
    }
    execute_recorded(packet);
  }
  catch (...) {
    undo(packet);
    packet.feedback_.clear();
    if (packet.loss_count_ == losses_) {
      losses_++;
    }
    done_serial_ = packet.serial_;
    throw;
  }
  executed_serial_ = packet.serial_;
  done_serial_ = packet.serial_;
}

void Device::trim() noexcept
{
  if (recording_ || std::this_thread::get_id() != thread_ || !can_execute()) {
    return;
  }
  const Calls calls(*this);
  try {
    if (driver_trim()) {
#ifdef __GLIBC__
      malloc_trim(0);
#endif
    }
  }
  catch (const Error &) {
    // A lost device has nothing to give back. The next call that draws reports it.
  }
}

void Device::execute_recorded(Packet &packet)
{
  if (packet.executed_count_ == 0) {
    packet.feedback_.clear();
  }
  const Calls calls(*this);
  try {
    while (packet.executed_count_ < packet.operations_.size()) {
      execute(packet.operations_[packet.executed_count_++], &packet);
    }
  }
  catch (...) {
    packet.has_failed_ = true;
    throw;
  }
  packet.memory_.clear();
}

void Device::undo(const Packet &packet)
{
  for (const Operation &operation : packet.operations_) {
    const auto *destroyed = std::get_if<Operation::Destroy>(&operation.call);
    const Operation::Resource resource = destroyed ? destroyed->resource : operation.created();
    try {
      destroy(resource.kind, resource.id);
    }
    catch (const Error &error) {
      message(error.what());
    }
  }
}

void Device::execute(const Operation &operation, Packet *packet)
{
  std::visit(
      Overloaded{
          [&](const Operation::CreateTexture &call) {
            texture_create(call.id, call.desc);
            counters_.textures_made += call.desc.format != Format::Host ? 1 : 0;
          },
          [&](const Operation::CreateSampler &call) { sampler_create(call.id, call.desc); },
          [&](const Operation::CreateFramebuffer &call) { framebuffer_create(call.id, call.layout); },
          [&](const Operation::CreateHostFramebuffer &call) {
            host_framebuffer_create(call.id, call.name, call.image);
          },
          [&](const Operation::TakeImage &call) { image_take(call); },
          [&](const Operation::CreateBuffer &call) { buffer_create(call.id, call.desc); },
          [&](const Operation::CreateBatch &call) {
            batch_create(call.desc, call.range, call.vertex_capacity, call.index_capacity);
            counters_.upload_bytes += size_bytes(call.desc);
          },
          [&](const Operation::UpdateBatch &call) {
            batch_update(call.first_vertex, call.values);
            counters_.upload_bytes += size_bytes(call.values);
          },
          [&](const Operation::CreateHostBatch &call) { host_batch_create(call.id, call.name, call.batch); },
          [&](const Operation::CreateShader &call) { execute(call, packet); },
          [&](const Operation::CreateTimerQuery &call) { timer_query_create(call.id, call.name); },
          [&](const Operation::Destroy &call) { destroy(call.resource.kind, call.resource.id); },
          [&](const Operation::UpdateBuffer &call) {
            buffer_update(call.id, call.offset_bytes, call.bytes);
            counters_.upload_bytes += call.bytes.size();
          },
          [&](const Operation::UploadTexture &call) {
            texture_upload(call.id, call.layer, call.texels);
            counters_.upload_bytes += call.texels.size();
          },
          [&](const Operation::GenerateMipmaps &call) { mipmaps_generate(call.id); },
          [&](const Operation::CopyLayers &call) { layers_copy(call.source, call.target, call.size_px, call.layers); },
          [&](const Operation::MarkTime &call) { time_mark(call.query, call.is_end); },
          [&](const Operation::ReadBack &call) {
            std::vector<std::byte> texels(call.size_bytes);
            texture_read(call.texture, call.layer, texels);
            packet->feedback_.texels.push_back({call.texture, call.tag, std::move(texels)});
          },
          [&](const Operation::SubmitList &call) { execute_list(*packet->lists_[call.list]); },
      },
      operation.call);
  if (const Operation::Resource created = operation.created(); created.id != 0) {
    set_existing(created.kind, created.id);
  }
}

void Device::execute(const Operation::CreateShader &create, Packet *packet)
{
  try {
    make_shader(create);
  }
  catch (const Error &error) {
    if (!packet || create.stand_in.empty()) {
      throw;
    }
    packet->feedback_.failed_shaders.push_back({create.id, error.what()});
    make_shader({create.id, create.desc, create.stand_in, create.samplers, create.constants, {}});
  }
}

void Device::make_shader(const Operation::CreateShader &create)
{
  const std::string key = ShaderDiskCache::key_of(create.stages, description());
  CachedShader shader = shader_cache_->load(key).value_or(CachedShader());
  const std::vector<std::byte> known = shader.compiled;
  shader_create(create, shader.compiled);
  const bool is_loaded = !known.empty() && shader.compiled == known;
  if (!is_loaded && !shader.compiled.empty()) {
    shader_cache_->store(key, shader);
  }
  counters_.shaders_made++;
  counters_.shaders_from_cache += is_loaded;
}

void Device::execute_list(const CommandList &list)
{
  list_submit(list);
  count(list);
}

void Device::submit_now(const CommandList &list)
{
  GNOMON_ASSERT(std::this_thread::get_id() == thread_, "a list is submitted on another thread than the device's");
  GNOMON_ASSERT(done_serial_ == serial_, "a submit outside of a recording, while a packet is pending");
  check_can_execute();
  destroy_queued();
  try {
    execute_list(list);
  }
  catch (...) {
    losses_++;
    take_losses();
    throw;
  }
}

void Device::set_existing(ResourceKind kind, ResourceId id)
{
  std::vector<ResourceId> &existing = existing_[std::size_t(kind)];
  if (existing.size() <= index_of(id)) {
    existing.resize(std::size_t(index_of(id)) + 1);
  }
  existing[index_of(id)] = id;
}

void Device::destroy(ResourceKind kind, ResourceId id)
{
  std::vector<ResourceId> &existing = existing_[std::size_t(kind)];
  // A resource of a lost packet may never have been created.
  if (id != 0 && index_of(id) < existing.size() && existing[index_of(id)] == id) {
    existing[index_of(id)] = 0;
    resource_destroy(kind, id);
  }
}

void Device::count(const CommandList &list)
{
  State state = State::None;
  for (const Command &command : list.commands()) {
    switch (command.kind) {
      case CommandKind::BeginPass:
        counters_.passes++;
        count_pass(list.name_of(list.passes()[command.first]));
        break;
      case CommandKind::SetShader: counters_.shader_binds++; break;
      case CommandKind::SetState: state = State(command.first); break;
      case CommandKind::Draw: {
        std::uint64_t index_count = 0;
        for (const DrawIndirect &draw : std::span(list.draws).subspan(command.first, command.count)) {
          counters_.instances += draw.instance_count;
          index_count += std::uint64_t(draw.index_count) * draw.instance_count;
        }
        counters_.draws += command.count;
        counters_.triangles += primitive_size(state) == 3 ? index_count / 3 : 0;
        break;
      }
      case CommandKind::DrawProcedural:
        counters_.draws++;
        counters_.instances += command.count;
        counters_.triangles += std::uint64_t(command.first / 3) * command.count;
        break;
      case CommandKind::Update: counters_.upload_bytes += command.count; break;
      default: break;
    }
  }
  counters_.upload_bytes += list.draws.size() * sizeof(DrawIndirect) + list.instances.size() * sizeof(DrawInstance);
}

void Device::count_pass(std::string_view name)
{
  const auto known = pass_counts_.find(name);
  if (known != pass_counts_.end()) {
    known->second++;
  }
  else {
    pass_counts_[std::string(pass_counts_.size() < pass_name_max ? name : other_passes)]++;
  }
}

}  // namespace gnomon::gpu
