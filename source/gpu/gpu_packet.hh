// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_batch.hh"
#include "gpu_buffer.hh"
#include "gpu_command_list.hh"
#include "gpu_framebuffer.hh"
#include "gpu_shader.hh"
#include "gpu_texture.hh"

#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gnomon::gpu {

/** What the device reports back about a submitted packet: the results of read_back and of timers, in order. */
struct Feedback {
  struct Texels {
    ResourceId texture = 0;
    /** As given to Device::read_back. */
    std::uint64_t tag = 0;
    /** Rows from the bottom, tightly packed. */
    std::vector<std::byte> bytes;
  };
  struct Time {
    ResourceId query = 0;
    double seconds = 0.0;
  };
  std::vector<Texels> texels;
  /** Nothing where the device has no timer. */
  std::vector<Time> times;

  void clear()
  {
    texels.clear();
    times.clear();
  }
};

/** Copies of uploaded data. Spans of it stay valid until clear. */
class PacketMemory {
 public:
  template <typename T>
  std::span<const T> copy(std::span<const T> values)
  {
    return {reinterpret_cast<const T *>(copy_bytes(std::as_bytes(values))), values.size()};
  }
  /** Keeps a block that is large enough for the same data again, unless that is above kept_bytes_max. */
  void clear();
  [[nodiscard]] bool is_large() const
  {
    return size_bytes_ > kept_bytes_max;
  }

 private:
  struct Block {
    std::unique_ptr<std::byte[]> bytes;
    std::size_t size = 0;
  };
  static constexpr std::size_t block_bytes_min = std::size_t(1) << 16U;
  static constexpr std::size_t kept_bytes_max = std::size_t(1) << 22U;

  const std::byte *copy_bytes(std::span<const std::byte> bytes);
  void add_block(std::size_t size);

  std::vector<Block> blocks_;
  /** In the last block. */
  std::size_t used_ = 0;
  /** Of all blocks. */
  std::size_t size_bytes_ = 0;
};

/** For std::visit: one function for each alternative. */
template <typename... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};

/** One call of a Device as data. Resources are named by id; spans point to data of the caller, or of a packet. */
struct Operation {
  struct CreateTexture {
    ResourceId id;
    TextureDesc desc;
  };
  struct CreateSampler {
    ResourceId id;
    SamplerDesc desc;
  };
  struct CreateFramebuffer {
    ResourceId id;
    FramebufferLayout layout;
  };
  struct CreateBuffer {
    ResourceId id;
    BufferDesc desc;
  };
  struct CreateBatch {
    ResourceId id;
    BatchDesc desc;
    BatchRange range;
    std::uint32_t vertex_capacity;
    std::uint32_t index_capacity;
  };
  struct CreateShader {
    ResourceId id;
    ShaderDesc desc;
    std::vector<ShaderSource> stages;
  };
  struct CreateTimerQuery {
    ResourceId id;
    std::string name;
  };
  struct Resource {
    ResourceKind kind = ResourceKind::Texture;
    /** 0: none. */
    ResourceId id = 0;
  };
  struct Destroy {
    Resource resource;
  };
  struct UpdateBuffer {
    ResourceId id;
    std::size_t offset_bytes;
    std::span<const std::byte> bytes;
  };
  struct UploadTexture {
    ResourceId id;
    int layer;
    std::span<const std::byte> texels;
  };
  struct GenerateMipmaps {
    ResourceId id;
  };
  struct CopyLayers {
    ResourceId source;
    ResourceId target;
    glm::ivec2 size_px;
    int layers;
  };
  struct MarkTime {
    ResourceId query;
    bool is_end;
  };
  struct ReadBack {
    ResourceId texture;
    int layer;
    std::size_t size_bytes;
    std::uint64_t tag;
  };
  /** A list of the packet, by index. */
  struct SubmitList {
    std::size_t list;
  };
  std::variant<CreateTexture, CreateSampler, CreateFramebuffer, CreateBuffer, CreateBatch, CreateShader,
               CreateTimerQuery, Destroy, UpdateBuffer, UploadTexture, GenerateMipmaps, CopyLayers, MarkTime, ReadBack,
               SubmitList>
      call;

  /** None for a batch: it is a part of buffers that all batches share. */
  [[nodiscard]] Resource created() const;
};

/**
 * Work for a device as data: resources to create and destroy, uploads and command lists, in order.
 *
 * A packet is recorded on one thread (\see Recording) and executed by Device::submit on the device's thread. The host
 * passes it from thread to thread and back; only one thread may use it at a time. A host that prepares one frame while
 * the device's thread submits another uses two packets in turn. A packet keeps its memory for the next recording.
 */
class Packet {
 public:
  Packet() = default;
  Packet(const Packet &) = delete;
  Packet &operator=(const Packet &) = delete;
  /** A packet that was recorded and not submitted counts as lost; \see Device::loss_count. No submit may run then. */
  ~Packet();

  /** Recorded, and not submitted. */
  [[nodiscard]] bool is_pending() const
  {
    return is_pending_;
  }
  /**
   * Of the last submission of this packet; empty where that failed. With n packets in turn, it is n frames old in the
   * next recording.
   */
  [[nodiscard]] const Feedback &feedback() const
  {
    return feedback_;
  }
  /** One line for each call, and the commands of the lists. To be called on the thread that recorded it. */
  [[nodiscard]] std::string serialize(const Device &device) const;

 private:
  friend class Device;

  CommandList &add_list();
  /** Adds a copy where \a list is none of the packet's. */
  std::size_t index_of(const CommandList &list);
  void clear();

  std::vector<Operation> operations_;
  /** The first list_count_ are in use; the others keep their memory. */
  std::vector<std::unique_ptr<CommandList>> lists_;
  std::size_t list_count_ = 0;
  PacketMemory memory_;
  Feedback feedback_;
  bool is_pending_ = false;
  /** \see Device::run */
  bool is_executed_early_ = false;
  /** Operations that were executed, successfully or not. */
  std::size_t executed_count_ = 0;
  bool has_failed_ = false;
  /** Of the device that it was recorded for. */
  std::shared_ptr<DeviceLink> link_;
  /** Above those of all packets that were recorded for the device before. */
  std::uint64_t serial_ = 0;
  /** Device::loss_count at the begin of the recording. */
  std::uint64_t loss_count_ = 0;
};

/**
 * While it exists, calls of \a device on this thread go into \a packet instead of to the graphics API, so that they
 * need no current context. What they return is usable at once; resources exist on the device after the submission.
 *
 * Forgets the packet's earlier content. Feedback stays readable until the next submission.
 */
class Recording {
 public:
  Recording(Device &device, Packet &packet);
  ~Recording();
  Recording(const Recording &) = delete;
  Recording &operator=(const Recording &) = delete;

 private:
  Device &device_;
};

}  // namespace gnomon::gpu
