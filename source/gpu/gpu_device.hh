// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_batch.hh"
#include "gpu_buffer.hh"
#include "gpu_command_list.hh"
#include "gpu_device_info.hh"
#include "gpu_error.hh"
#include "gpu_framebuffer.hh"
#include "gpu_packet.hh"
#include "gpu_range_allocator.hh"
#include "gpu_shader.hh"
#include "gpu_shader_cache.hh"
#include "gpu_texture.hh"

#include <array>
#include <atomic>
#include <map>
#include <span>
#include <thread>

namespace gnomon::gpu {

/** Time between a pair of marks on the device; see Device::time_begin. */
class TimerQuery : public Resource {
 public:
  TimerQuery() = default;

 private:
  friend class Device;
  explicit TimerQuery(Resource resource) : Resource(std::move(resource)) {}
};

/** Number of passes by name. */
using PassCounts = std::map<std::string, std::uint64_t, std::less<>>;

/** Receives warnings of the driver and of the device, one line each. It must not throw. */
using MessageSink = std::function<void(std::string_view message)>;

/**
 * The interface to a graphics API.
 *
 * The create functions check their descriptions against limits(). On failure they throw Error naming the resource and
 * create nothing. A device that is destroyed before its resources reports their names to its message sink and frees
 * them.
 *
 * **Threads.** A call takes effect at once, on the device's thread: the one that created it. While a Recording exists,
 * calls go into its packet instead. They then check descriptions, issue ids and copy data, and may be made on any one
 * thread, together with the destruction of resources. Meanwhile the device's thread may call the functions marked
 * "device's thread", and no others.
 *
 * A resource that is destroyed while no Recording exists, but packets are pending, is freed after these packets.
 *
 * Every function throws DeviceLost once the driver reports that the context is lost. The device and its resources can
 * then only be destroyed.
 */
class Device {
 public:
  Device(const Device &) = delete;
  Device &operator=(const Device &) = delete;
  virtual ~Device();

  [[nodiscard]] Texture create_texture(const TextureDesc &desc);
  [[nodiscard]] Sampler create_sampler(const SamplerDesc &desc);
  [[nodiscard]] Framebuffer create_framebuffer(const FramebufferDesc &desc);
  [[nodiscard]] Buffer create_buffer(const BufferDesc &desc);
  [[nodiscard]] Batch create_batch(const BatchDesc &desc);
  /** Preprocesses, asks \a reflection for the interface, compiles. \throws Error whose message names file and line. */
  [[nodiscard]] Shader create_shader(const ShaderDesc &desc, const ShaderFiles &files,
                                     const ShaderReflection &reflection);
  [[nodiscard]] TimerQuery create_timer_query(std::string name);

  /** Lists that are submitted later see the new content; lists submitted before do not. */
  void update(const Buffer &buffer, std::size_t offset_bytes, std::span<const std::byte> bytes);
  template <typename T>
  void update(const Buffer &buffer, const T &value)
  {
    update(buffer, 0, std::as_bytes(std::span(&value, 1)));
  }
  /** Write one layer of level 0. \a texels: rows from the bottom, tightly packed. */
  void upload(const Texture &texture, int layer, std::span<const std::byte> texels);
  /**
   * Fill the levels above 0 from level 0. Each texel is the mean of the texels below it; an encoded format is decoded
   * before averaging.
   */
  void generate_mipmaps(const Texture &texture);
  /**
   * Copy level 0 of the layers that both textures have, as far as both reach from the lower left corner. Takes place
   * before anything submitted later. \pre two different textures of one format and kind
   */
  void copy_layers(const Texture &source, const Texture &target);

  /**
   * Execute \a list. Builds with assertions run validate() first.
   *
   * \throws Error for a stale id and where the driver reports an error. Commands before the failing one may have been
   * executed, so the content of resources that the list writes is undefined, and loss_count() increases. Nothing else
   * changes: counters() do not count the list, no pass stays open, and the device remains usable.
   */
  void submit(const CommandList &list);
  /**
   * An empty list of the packet, to be filled and submitted during this recording. Other lists are copied into the
   * packet. Like all of a packet, it keeps its memory for the next recording. \pre is_recording
   */
  [[nodiscard]] CommandList &add_list();

  /**
   * Execute \a packet. Device's thread. Packets must be submitted in the order in which they were recorded. Waits for
   * the device where the packet has a read_back or a timer.
   *
   * \throws Error where an operation fails, or where an earlier packet was lost after this one's recording began. The
   * packet is then lost: the resources that it creates do not exist, the content of those that it writes is undefined,
   * and those that it destroys are freed. loss_count() tells. \pre is_pending
   */
  void submit(Packet &packet);
  /**
   * Record the calls of \a work and submit them. What is recorded before \a work throws is submitted, too. Where there
   * is much to upload, parts of the packet are executed while \a work runs, to keep copies small; their failure is
   * thrown in \a work. Device's thread, and not while another packet is pending.
   */
  template <typename Work>
  void run(Packet &packet, Work &&work);
  [[nodiscard]] bool is_recording() const
  {
    return recording_ != nullptr;
  }
  /**
   * Increases when submitted work was lost: a packet, or a list outside of a packet. It is constant during a recording.
   * Resources that a lost packet created are empty: they convert to `false`. Whoever notes what it has written to other
   * resources compares this number, and writes all of it again where it differs.
   */
  [[nodiscard]] std::uint64_t loss_count() const
  {
    return losses_taken_;
  }

  /** Read one layer of level 0: rows from the bottom, tightly packed. Waits for the device. Not while recording. */
  [[nodiscard]] std::vector<std::byte> read(const Texture &texture, int layer = 0);
  /** The same, recorded: the packet's Feedback has the texels after its submission. \pre is_recording */
  void read_back(const Texture &texture, int layer, std::uint64_t tag);
  /** Wait until all submitted work is done. Device's thread. */
  virtual void finish() = 0;

  /** Set the marks of \a query, between submissions. Queries must not overlap. */
  void time_begin(const TimerQuery &query);
  void time_end(const TimerQuery &query);
  /**
   * Seconds between the marks; waits for the device. Empty where the device has no timer (null backend). Not for marks
   * of packets, whose Feedback has them.
   */
  [[nodiscard]] std::optional<double> elapsed_seconds(const TimerQuery &query)
  {
    return seconds_between_marks(query.id());
  }

  [[nodiscard]] const Limits &limits() const
  {
    return limits_;
  }
  /** Of executed work. Device's thread. */
  [[nodiscard]] const Counters &counters() const
  {
    return counters_;
  }
  /**
   * Number of submitted passes by name, since the device was created. Device's thread. The first pass_name_max names
   * are counted each by itself, passes of further names together under other_passes, so that names of lamps cannot make
   * the map grow.
   */
  [[nodiscard]] const PassCounts &pass_counts() const
  {
    return pass_counts_;
  }
  static constexpr std::size_t pass_name_max = 1024;
  static constexpr const char *other_passes = "(other passes)";
  /** API, version, driver and the kind of context, in one line. Device's thread. */
  [[nodiscard]] virtual std::string description() const = 0;

  /** The name given at creation; "none" where \a id is 0 or its index was used again. */
  [[nodiscard]] const std::string &name_of(ResourceKind kind, ResourceId id) const;
  /** Description of the live resource \a id; nullptr where there is none: 0, or a destroyed resource. */
  [[nodiscard]] const ResourceInfo *find(ResourceKind kind, ResourceId id) const;
  /** Whether the range of indices and the vertex \a base_vertex are in use by batches. */
  [[nodiscard]] bool has_batch_data(std::uint32_t first_index, std::uint32_t index_count,
                                    std::int32_t base_vertex) const;
  /** All live resources, by kind and then by index. */
  [[nodiscard]] std::vector<LiveResource> live() const;
  /** Description of \a resource. \pre it belongs to this device and is not empty */
  [[nodiscard]] LiveResource live(const Resource &resource) const;
  /** One entry for each live resource, such as "texture 'hdr'". */
  [[nodiscard]] std::vector<std::string> live_resources() const;
  /** Size of the content of all live textures, buffers and batches. A driver may use more memory for them. */
  [[nodiscard]] std::size_t memory_bytes() const;

 protected:
  /** \a shader_cache_folder: see ShaderDiskCache. */
  Device(const Limits &limits, MessageSink sink, std::filesystem::path shader_cache_folder = {});

  /** Must be called by the destructor of the most derived class, while it can still free. */
  void free_live_resources();
  void message(std::string_view text) const;

  // The functions of a backend. They run on the device's thread and may not read the base class's tables.
  virtual void texture_create(ResourceId id, const TextureDesc &desc) = 0;
  virtual void sampler_create(ResourceId id, const SamplerDesc &desc) = 0;
  virtual void framebuffer_create(ResourceId id, const FramebufferLayout &layout) = 0;
  virtual void buffer_create(ResourceId id, const BufferDesc &desc) = 0;
  /**
   * \a vertex_capacity and \a index_capacity: elements that the shared buffers must hold from now on, their content
   * kept. Where this throws, the shared buffers hold at least their earlier capacities and content.
   */
  virtual void batch_create(const BatchDesc &desc, const BatchRange &range, std::uint32_t vertex_capacity,
                            std::uint32_t index_capacity) = 0;
  /**
   * \a compiled: the backend's own compiled form from an earlier run, or empty. A backend that cannot use it compiles
   * \a stages and replaces it by a new form, which is empty where the backend has none.
   */
  virtual void shader_create(ResourceId id, const ShaderDesc &desc, const std::vector<ShaderSource> &stages,
                             std::vector<std::byte> &compiled) = 0;
  virtual void timer_query_create(ResourceId id, const std::string &name) = 0;
  /** Not for batches, which are parts of the shared buffers. */
  virtual void resource_destroy(ResourceKind kind, ResourceId id) = 0;
  virtual void buffer_update(ResourceId id, std::size_t offset_bytes, std::span<const std::byte> bytes) = 0;
  virtual void texture_upload(ResourceId id, int layer, std::span<const std::byte> texels) = 0;
  virtual void mipmaps_generate(ResourceId id) = 0;
  virtual void layers_copy(ResourceId source, ResourceId target, glm::ivec2 size_px, int layers) = 0;
  virtual void texture_read(ResourceId id, int layer, std::span<std::byte> texels) = 0;
  virtual void list_submit(const CommandList &list) = 0;
  virtual void time_mark(ResourceId query, bool is_end) = 0;
  [[nodiscard]] virtual std::optional<double> seconds_between_marks(ResourceId query) = 0;

 private:
  friend class Packet;
  friend class Recording;
  friend class Resource;

  struct Slot {
    /** Of the resource that uses the index now, or used it last. */
    ResourceId id = 0;
    bool is_live = false;
    ResourceInfo info;
    /** \see LiveResource */
    std::string detail;
    std::size_t size_bytes = 0;
    std::uint64_t upload_bytes = 0;
  };
  /** A recorded packet of which it is not known that it was executed. */
  struct InFlight {
    std::uint64_t serial = 0;
    /** Of the resources that it creates; nullptr: there are none. */
    std::shared_ptr<DeviceLink> link;
    std::vector<Operation::Resource> created;
  };
  static constexpr std::size_t kind_count = std::size_t(ResourceKind::TimerQuery) + 1;

  // Called while recording, or outside of recordings on the device's thread.

  /** Issues an id, and performs the call that \a create returns for it. Where that throws, the id is free again. */
  template <typename Create>
  Resource make(ResourceKind kind, ResourceInfo info, std::string detail, std::size_t size_bytes, Create &&create);
  /** Records the call, or executes it now. */
  void perform(Operation operation);
  /** \a bytes, or a copy in the packet. */
  template <typename T>
  [[nodiscard]] std::span<const T> kept(std::span<const T> values)
  {
    return recording_ ? recording_->memory_.copy(values) : values;
  }
  BatchRange allocate_range(const BatchDesc &desc);
  void free_range(const BatchRange &range);
  void count_upload(ResourceKind kind, ResourceId id, std::size_t bytes);
  /** Of the buffers that \a list writes. */
  void count_uploads(const CommandList &list);
  /** Called by Resource. */
  void release(ResourceKind kind, ResourceId id);
  /** Marks the slot's index as free. \return false where \a id is not live. */
  bool free_slot(ResourceKind kind, ResourceId id);
  /** The slot of index 0 where \a id names no resource that is or was the last of its index. */
  [[nodiscard]] const Slot &slot_of(ResourceKind kind, ResourceId id) const;
  void begin(Packet &packet);
  void end();
  /** Takes note of lost work: frees the ids of resources that were never created. */
  void take_losses();
  void destroy_queued();
  void discard(Packet &packet);

  // Called on the device's thread.

  /** \a packet: the one that \a operation is of; nullptr outside of packets. */
  void execute(const Operation &operation, Packet *packet);
  void execute(const Operation::CreateShader &create);
  void execute_list(const CommandList &list);
  void execute_recorded(Packet &packet);
  /** Outside of a packet. */
  void submit_now(const CommandList &list);
  void set_existing(ResourceKind kind, ResourceId id);
  void destroy(ResourceKind kind, ResourceId id);
  void undo(const Packet &packet);
  void count(const CommandList &list);
  void count_pass(std::string_view name);

  const Limits limits_;
  const MessageSink sink_;
  const ShaderDiskCache shader_cache_;

  const std::thread::id thread_ = std::this_thread::get_id();

  // Of the thread that records.
  std::shared_ptr<DeviceLink> link_;
  /** Links of packets that created anything. */
  std::vector<std::shared_ptr<DeviceLink>> packet_links_;
  /** By index_of(id). Index 0 is never live. */
  std::array<std::vector<Slot>, kind_count> slots_;
  /** Ids to issue next, of indices that are not in use. An index whose generations are used up is not among them. */
  std::array<std::vector<ResourceId>, kind_count> free_ids_;
  RangeAllocator vertices_;
  RangeAllocator indices_;
  Packet *recording_ = nullptr;
  std::uint64_t serial_ = 0;
  std::vector<InFlight> in_flight_;
  /** \see loss_count */
  std::uint64_t losses_taken_ = 0;
  /** Resources that were released while packets were pending. */
  std::vector<Operation::Resource> queued_;

  // Shared.
  /** Serial of the last packet that was executed, and of the last that was executed or lost. */
  std::atomic<std::uint64_t> executed_serial_ = 0;
  std::atomic<std::uint64_t> done_serial_ = 0;
  std::atomic<std::uint64_t> losses_ = 0;

  // Of the device's thread.
  Counters counters_;
  /** By kind and index_of(id): the resource that the backend has; 0: none. */
  std::array<std::vector<ResourceId>, kind_count> existing_;
  PassCounts pass_counts_;
};

template <typename Work>
void Device::run(Packet &packet, Work &&work)
{
  try {
    const Recording recording(*this, packet);
    packet.is_executed_early_ = true;
    work();
  }
  catch (...) {
    try {
      submit(packet);
    }
    catch (const Error & /*error*/) {
      // The first failure is reported.
    }
    take_losses();
    throw;
  }
  try {
    submit(packet);
  }
  catch (...) {
    take_losses();
    throw;
  }
}

/** Origin of a device's OpenGL context. */
enum class ContextKind {
  /**
   * A context of the device's own: the first that works of a hardware EGL device, EGL without a surface, a software EGL
   * device and a hidden window. No other context may be current on the thread.
   */
  Headless,
  /**
   * The context that is current on this thread. It must be current in every later call and remains the host's: each
   * call saves the OpenGL state that it changes and restores it before it returns or throws.
   *
   * A call takes pending OpenGL errors before it starts, so that an error of the host is not reported as the device's,
   * and raises the first of them again before it returns. Errors other than GL_INVALID_ENUM, GL_INVALID_VALUE and
   * GL_INVALID_OPERATION cannot be raised again and are reported to the message sink.
   *
   * OpenGL cannot restore the following. The host must not call submit() or generate_mipmaps() while they are in
   * effect; builds with assertions throw Error:
   * - an active query other than GL_TIME_ELAPSED,
   * - conditional rendering,
   * - active transform feedback that is not paused.
   * The current program must not be flagged for deletion.
   */
  Host,
};

struct GlDeviceDesc {
  ContextKind context = ContextKind::Headless;
  /** Own contexts only: ask the driver for debug messages, and throw its errors as Error. */
#ifdef NDEBUG
  bool is_debug = false;
#else
  bool is_debug = true;
#endif
  MessageSink sink{};
  /** Folder of the cache of compiled shaders; empty: no cache. \see ShaderDiskCache */
  std::filesystem::path shader_cache_folder{};
};

/**
 * OpenGL 4.5 core.
 *
 * \throws Error naming each kind of context that was tried and the reason of its failure.
 */
[[nodiscard]] std::unique_ptr<Device> create_gl_device(const GlDeviceDesc &desc = {});

/**
 * Called by the null backend before each of its operations, on the device's thread, with the operation's name:
 * "create texture", "update", "upload", "submit", "destroy" and so on. To let the operation fail, it throws Error.
 */
using NullOperation = std::function<void(std::string_view operation)>;

/**
 * Checks and counts as every device, but draws nothing; reads give zeros. Needs no driver.
 * \a before_operation: may be empty; for tests of failures.
 */
[[nodiscard]] std::unique_ptr<Device> create_null_device(const Limits &limits = {}, MessageSink sink = {},
                                                         NullOperation before_operation = {});

}  // namespace gnomon::gpu
