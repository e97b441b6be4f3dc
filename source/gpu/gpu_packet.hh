// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_batch.hh"
#include "gpu_buffer.hh"
#include "gpu_command_list.hh"
#include "gpu_framebuffer.hh"
#include "gpu_shader.hh"
#include "gpu_texture.hh"
#include "gpu_vulkan_host.hh"

#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gnomon::gpu {

/**
 * Results of a submitted packet: read texels and shaders that did not compile, each in the order of recording.
 */
struct Feedback {
  struct Texels {
    ResourceId texture = 0;
    /** The tag that was passed to Device::read_back. */
    std::uint64_t tag = 0;
    /** Rows from the bottom, tightly packed. */
    std::vector<std::byte> bytes;
  };
  /** A shader for which its stand-in was compiled. \see Device::create_shader */
  struct FailedShader {
    ResourceId shader = 0;
    /** Message of the compiler, which names files and lines. */
    std::string reason;
  };
  std::vector<Texels> texels;
  std::vector<FailedShader> failed_shaders;

  void clear()
  {
    texels.clear();
    failed_shaders.clear();
  }
};

/** Memory for copies of uploaded data. Returned spans stay valid until clear(). */
class PacketMemory {
 public:
  template <typename T>
  std::span<const T> copy(std::span<const T> values)
  {
    return {reinterpret_cast<const T *>(copy_bytes(std::as_bytes(values))), values.size()};
  }
  /** Keeps one block with room for the same data, unless its size exceeds kept_bytes_max. */
  void clear();
  /** Whether the copies exceed kept_bytes_max. */
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
  /** Used bytes of the last block. */
  std::size_t used_ = 0;
  /** Bytes of all blocks. */
  std::size_t size_bytes_ = 0;
};

/** A visitor for std::visit that is made of one function for each alternative. */
template <typename... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
// Clang before version 17 deduces none for aggregates.
template <typename... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

/** A recorded call of a Device. It names resources by id. Its spans refer to data of the caller or of the packet. */
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
  struct CreateHostFramebuffer {
    ResourceId id;
    std::string name;
    HostImage image;
  };
  /** Begins or ends draws into an image of the host. */
  struct TakeImage {
    ResourceId framebuffer;
    /** VkImageLayout. */
    int layout;
    HostSemaphore semaphore;
    bool is_end;
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
  struct UpdateBatch {
    ResourceId id;
    /** In the shared buffers. */
    std::uint32_t first_vertex;
    BatchDesc values;
  };
  struct CreateHostBatch {
    ResourceId id;
    std::string name;
    HostBatch batch;
  };
  struct CreateShader {
    ResourceId id;
    ShaderDesc desc;
    std::vector<ShaderSource> stages;
    /** Names of the samplers that the shader declares. */
    std::vector<std::string> samplers;
    /** Values that the backend sets. Empty without Limits::has_specialization. */
    std::vector<StageConstant> constants;
    /** Compiled if `stages` do not compile; empty: that is an error. */
    std::vector<ShaderSource> stand_in;
  };
  struct CreateTimerQuery {
    ResourceId id;
    std::string name;
  };
  struct Resource {
    ResourceKind kind = ResourceKind::Texture;
    /** 0: no resource. */
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
  /** Executes the packet's list with this index. */
  struct SubmitList {
    std::size_t list;
  };
  std::variant<CreateTexture, CreateSampler, CreateFramebuffer, CreateHostFramebuffer, TakeImage, CreateBuffer,
               CreateBatch, UpdateBatch, CreateHostBatch, CreateShader, CreateTimerQuery, Destroy, UpdateBuffer,
               UploadTexture, GenerateMipmaps, CopyLayers, MarkTime, ReadBack, SubmitList>
      call;

  /** The resource that the call creates. Empty for batches that are ranges of shared buffers. */
  [[nodiscard]] Resource created() const;
};

/**
 * Recorded work for a device: creation and destruction of resources, uploads and command lists, in order.
 *
 * A packet is recorded on one thread (\see Recording) and executed by Device::submit on the device's thread. Only one
 * thread may use a packet at a time. To record a frame while the device's thread submits the previous one, alternate
 * between two packets. A packet keeps its memory for the next recording.
 */
class Packet {
 public:
  Packet() = default;
  Packet(const Packet &) = delete;
  Packet &operator=(const Packet &) = delete;
  /** A pending packet counts as lost (\see Device::loss_count). \pre Device::submit is not running */
  ~Packet();

  /** Whether the packet was recorded and not yet submitted. */
  [[nodiscard]] bool is_pending() const
  {
    return is_pending_;
  }
  /**
   * Results of the last submission of this packet; empty if the submission failed. If n packets are used in turn, they
   * are n frames old when the packet is recorded again.
   */
  [[nodiscard]] const Feedback &feedback() const
  {
    return feedback_;
  }
  /** Text with one line for each call and each command of the lists. Call it on the recording thread. */
  [[nodiscard]] std::string serialize(const Device &device) const;

 private:
  friend class Device;

  CommandList &add_list();
  /** Index of \a list. A list that is not part of the packet is copied into it. */
  std::size_t index_of(const CommandList &list);
  void clear();

  std::vector<Operation> operations_;
  /** The first list_count_ lists are in use. The others keep their memory for later recordings. */
  std::vector<std::unique_ptr<CommandList>> lists_;
  std::size_t list_count_ = 0;
  PacketMemory memory_;
  Feedback feedback_;
  bool is_pending_ = false;
  /** Whether operations may be executed during the recording. \see Device::run */
  bool is_executed_early_ = false;
  /** Number of executed operations, including one that failed. */
  std::size_t executed_count_ = 0;
  bool has_failed_ = false;
  /** Link of the device that the packet was recorded for. */
  std::shared_ptr<DeviceLink> link_;
  /** Increases with each recording for the same device. */
  std::uint64_t serial_ = 0;
  /** Device::loss_count at the begin of the recording. */
  std::uint64_t loss_count_ = 0;
};

/**
 * While a Recording exists, calls of \a device on this thread are recorded into \a packet instead of being executed, so
 * they need no current context. Returned resources can be used in the recording at once; they exist on the device after
 * the submission.
 *
 * The constructor clears the previous content of the packet, except for its feedback. A packet that is still pending
 * counts as lost. \pre no other Recording of the device exists
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
