// SPDX-License-Identifier: MIT
#include "gpu_packet.hh"

#include "gpu_device.hh"
#include "gpu_range_allocator.hh"

#include <algorithm>
#include <cstring>
#include <utility>

namespace gnomon::gpu {

Operation::Resource Operation::created() const
{
  return std::visit(Overloaded{
                        [](const CreateTexture &made) {
                          return Resource{ResourceKind::Texture, made.id};
                        },
                        [](const CreateSampler &made) {
                          return Resource{ResourceKind::Sampler, made.id};
                        },
                        [](const CreateFramebuffer &made) {
                          return Resource{ResourceKind::Framebuffer, made.id};
                        },
                        [](const CreateHostFramebuffer &made) {
                          return Resource{ResourceKind::Framebuffer, made.id};
                        },
                        [](const CreateBuffer &made) {
                          return Resource{ResourceKind::Buffer, made.id};
                        },
                        [](const CreateHostBatch &made) {
                          return Resource{ResourceKind::Batch, made.id};
                        },
                        [](const CreateShader &made) {
                          return Resource{ResourceKind::Shader, made.id};
                        },
                        [](const CreateTimerQuery &made) {
                          return Resource{ResourceKind::TimerQuery, made.id};
                        },
                        [](const auto & /*call*/) { return Resource{}; },
                    },
                    call);
}

const std::byte *PacketMemory::copy_bytes(std::span<const std::byte> bytes)
{
  constexpr std::size_t alignment = alignof(std::max_align_t);
  const std::size_t start = (used_ + alignment - 1) / alignment * alignment;
  if (blocks_.empty() || start + bytes.size() > blocks_.back().size) {
    add_block(std::max(bytes.size(), block_bytes_min));
    used_ = 0;
    return copy_bytes(bytes);
  }
  std::byte *target = blocks_.back().bytes.get() + start;
  if (!bytes.empty()) {
    std::memcpy(target, bytes.data(), bytes.size());
  }
  used_ = start + bytes.size();
  return target;
}

void PacketMemory::add_block(std::size_t size)
{
  blocks_.push_back({std::make_unique_for_overwrite<std::byte[]>(size), size});
  size_bytes_ += size;
}

void PacketMemory::clear()
{
  used_ = 0;
  if (blocks_.size() <= 1 && !is_large()) {
    return;
  }
  const std::size_t size_bytes = std::exchange(size_bytes_, 0);
  blocks_.clear();
  if (size_bytes <= kept_bytes_max) {
    add_block(size_bytes);
  }
}

Packet::~Packet()
{
  if (is_pending_ && link_->device) {
    link_->device->discard(*this);
  }
}

CommandList &Packet::add_list()
{
  if (list_count_ == lists_.size()) {
    lists_.push_back(std::make_unique<CommandList>());
  }
  return *lists_[list_count_++];
}

std::size_t Packet::index_of(const CommandList &list)
{
  for (std::size_t i = 0; i < list_count_; i++) {
    if (lists_[i].get() == &list) {
      return i;
    }
  }
  add_list() = list;
  return list_count_ - 1;
}

void Packet::clear()
{
  operations_.clear();
  for (std::size_t i = 0; i < list_count_; i++) {
    lists_[i]->clear();
  }
  list_count_ = 0;
  memory_.clear();
  is_executed_early_ = false;
  executed_count_ = 0;
  has_failed_ = false;
}

std::string Packet::serialize(const Device &device) const
{
  std::string text;
  const auto line = [&](std::string_view what, ResourceKind kind, ResourceId id) {
    text += fmt::format("{} {} '{}'\n", what, to_string(kind), device.name_of(kind, id));
  };
  for (const Operation &operation : operations_) {
    std::visit(
        Overloaded{
            [&](const Operation::CreateBatch &call) { line("create", ResourceKind::Batch, call.id); },
            [&](const Operation::UpdateBatch &call) { line("update", ResourceKind::Batch, call.id); },
            [&](const Operation::Destroy &call) { text += fmt::format("destroy {}\n", to_string(call.resource.kind)); },
            [&](const Operation::UpdateBuffer &call) {
              text += fmt::format("update {} {} bytes at {}\n", device.name_of(ResourceKind::Buffer, call.id),
                                  call.bytes.size(), call.offset_bytes);
            },
            [&](const Operation::UploadTexture &call) { line("upload", ResourceKind::Texture, call.id); },
            [&](const Operation::GenerateMipmaps &call) { line("mipmaps of", ResourceKind::Texture, call.id); },
            [&](const Operation::CopyLayers &call) { line("copy layers to", ResourceKind::Texture, call.target); },
            [&](const Operation::MarkTime &call) {
              line(call.is_end ? "time end" : "time begin", ResourceKind::TimerQuery, call.query);
            },
            [&](const Operation::ReadBack &call) { line("read back", ResourceKind::Texture, call.texture); },
            [&](const Operation::TakeImage &call) {
              line(call.is_end ? "end image of" : "begin image of", ResourceKind::Framebuffer, call.framebuffer);
            },
            [&](const Operation::SubmitList &call) { text += lists_[call.list]->serialize(device); },
            [&](const auto & /*call*/) {
              const Operation::Resource created = operation.created();
              line("create", created.kind, created.id);
            },
        },
        operation.call);
  }
  return text;
}

Recording::Recording(Device &device, Packet &packet) : device_(device)
{
  device.begin(packet);
}

Recording::~Recording()
{
  device_.end();
}

void Device::begin(Packet &packet)
{
  GNOMON_ASSERT(!recording_, "a packet of this device is being recorded");
  if (packet.is_pending_) {
    discard(packet);
  }
  packet.clear();
  take_losses();
  packet.serial_ = ++serial_;
  packet.loss_count_ = losses_taken_;
  packet.link_ = link_;
  in_flight_.emplace_back().serial = packet.serial_;
  recording_ = &packet;
  for (const Operation::Resource &resource : queued_) {
    perform({Operation::Destroy{resource}});
  }
  queued_.clear();
}

void Device::end()
{
  recording_->is_pending_ = true;
  recording_ = nullptr;
}

void Device::perform(Operation operation)
{
  if (recording_) {
    recording_->operations_.push_back(std::move(operation));
    if (recording_->is_executed_early_ && recording_->memory_.is_large()) {
      execute_recorded(*recording_);
    }
    return;
  }
  GNOMON_ASSERT(std::this_thread::get_id() == thread_,
                "a call outside of a recording, on another thread than the device's");
  GNOMON_ASSERT(done_serial_ == serial_, "a call outside of a recording, while a packet is pending");
  check_can_execute();
  destroy_queued();
  execute(operation, nullptr);
}

void Device::check_can_execute() const
{
  if (!can_execute()) {
    throw Error(
        "the context in which the device was made is not current on this thread: make it current before calls "
        "that use the device");
  }
}

void Device::destroy_queued()
{
  for (const Operation::Resource &resource : queued_) {
    destroy(resource.kind, resource.id);
  }
  queued_.clear();
}

void Device::take_losses()
{
  const std::uint64_t losses = losses_;
  const std::uint64_t executed = executed_serial_;
  if (losses != losses_taken_) {
    // All packets after the last executed one were recorded before the loss was known and will not be executed.
    for (const InFlight &packet : in_flight_) {
      if (packet.serial > executed && packet.link) {
        for (const Operation::Resource &resource : packet.created) {
          free_slot(resource.kind, resource.id);
        }
        packet.link->device = nullptr;
      }
    }
    in_flight_.clear();
    // The backend may have failed to grow its buffers. Smaller batches still fit into the old capacity.
    vertices_->shrink(0);
    indices_->shrink(0);
    losses_taken_ = losses;
  }
  std::erase_if(in_flight_, [&](const InFlight &packet) { return packet.serial <= executed; });
  std::erase_if(packet_links_, [](const auto &link) { return link.use_count() == 1; });
}

void Device::discard(Packet &packet)
{
  for (const Operation &operation : packet.operations_) {
    if (const auto *destroyed = std::get_if<Operation::Destroy>(&operation.call)) {
      queued_.push_back(destroyed->resource);
    }
  }
  packet.is_pending_ = false;
  losses_++;
  done_serial_ = packet.serial_;
  take_losses();
}

bool Device::free_slot(ResourceKind kind, ResourceId id)
{
  Slot &slot = slots_[std::size_t(kind)][index_of(id)];
  if (!slot.is_live || slot.id != id) {
    return false;
  }
  slot.is_live = false;
  // An index whose generations are used up is not reused, so that no id is issued twice.
  constexpr std::uint32_t generation_max = (1U << (32U - resource_index_bits)) - 1U;
  if (generation_of(id) < generation_max) {
    free_ids_[std::size_t(kind)].push_back(id + (1U << resource_index_bits));
  }
  if (const auto *range = std::get_if<BatchRange>(&slot.info.desc); range && range->host_batch == 0) {
    free_range(*range);
  }
  return true;
}

void Device::release(ResourceKind kind, ResourceId id)
{
  if (!free_slot(kind, id)) {
    return;
  }
  if (const auto *range = std::get_if<BatchRange>(&slot_of(kind, id).info.desc); range && range->host_batch == 0) {
    return;
  }
  // Destructors call this function, which must not throw. A later call destroys resources that cannot be destroyed now.
  const bool is_idle = done_serial_ == serial_ && std::this_thread::get_id() == thread_ && can_execute();
  if (recording_) {
    recording_->operations_.push_back({Operation::Destroy{{kind, id}}});
  }
  else if (is_idle) {
    destroy(kind, id);
  }
  else {
    queued_.push_back({kind, id});
  }
}

}  // namespace gnomon::gpu
