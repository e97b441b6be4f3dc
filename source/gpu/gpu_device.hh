// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_batch.hh"
#include "gpu_buffer.hh"
#include "gpu_command_list.hh"
#include "gpu_device_info.hh"
#include "gpu_error.hh"
#include "gpu_framebuffer.hh"
#include "gpu_packet.hh"
#include "gpu_shader.hh"
#include "gpu_texture.hh"

#include <array>
#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <thread>

namespace gnomon::gpu {

class RangeAllocator;
class ShaderDiskCache;

/** Measures the times between pairs of marks on the device. \see Device::time_begin */
class TimerQuery : public Resource {
 public:
  TimerQuery() = default;

 private:
  friend class Device;
  explicit TimerQuery(Resource resource) : Resource(std::move(resource)) {}
};

/** Number of passes by name. */
using PassCounts = std::map<std::string, std::uint64_t, std::less<>>;

/**
 * Receives warnings from the driver and from the device, one line each, on any thread that calls the device. It must
 * not throw. Empty: they are printed to stderr.
 */
using MessageSink = std::function<void(std::string_view message)>;

/** Gives \a text to \a sink, or prints it to stderr if the sink is empty. */
void send_message(const MessageSink &sink, std::string_view text);

/**
 * The interface to a graphics API.
 *
 * The create functions check their descriptions against limits(). If a create function fails, it throws an Error that
 * names the resource, and it creates nothing. Resources must be destroyed before their device. If some still exist, the
 * device reports their names to its message sink and frees them; they are then empty (Resource).
 *
 * **Threads.** The device's thread is the thread that created the device.
 * - While no Recording exists, calls take effect at once. They must be made on the device's thread, and no packet may
 * be pending.
 * - While a Recording exists, calls are recorded into its packet: they check descriptions, issue ids and copy data.
 * They must be made on one thread, the recording thread, which may be any thread. Resources may be destroyed only on
 * this thread. Meanwhile the device's thread may call only the functions marked "device's thread".
 *
 * A resource that is destroyed while packets are pending and no Recording exists is freed after these packets.
 *
 * After the driver has reported a lost context, submissions, uploads, reads and most create functions throw DeviceLost.
 * The device and its resources can then only be destroyed.
 */
class Device {
 public:
  Device(const Device &) = delete;
  Device &operator=(const Device &) = delete;
  virtual ~Device();

  [[nodiscard]] Texture create_texture(const TextureDesc &desc);
  [[nodiscard]] Sampler create_sampler(const SamplerDesc &desc);
  [[nodiscard]] Framebuffer create_framebuffer(const FramebufferDesc &desc);
  /**
   * A framebuffer whose colour attachment is an image of the host. It has no depth. Draws go between begin_image and
   * end_image.
   *
   * \throws Error if the device does not use Vulkan, or if the image cannot be drawn into; during a recording, its
   * submission throws the latter
   */
  [[nodiscard]] Framebuffer create_framebuffer(const std::string &name, const HostImage &image);
  [[nodiscard]] Buffer create_buffer(const BufferDesc &desc);
  [[nodiscard]] Batch create_batch(const BatchDesc &desc);
  /**
   * A batch that draws from buffers of the host.
   * \throws Error also if a buffer does not exist in the context or is too small; during a recording, its submission
   * throws it
   */
  [[nodiscard]] Batch create_batch(const std::string &name, const HostBatch &batch);
  /**
   * Preprocess the files of \a desc, get the interface from \a reflection, and compile.
   *
   * \a stand_in: if it is not empty and the driver rejects a shader that was recorded, the same files are compiled with
   * the texts of \a stand_in, and Feedback::failed_shaders has the message. Both must have the same interface.
   *
   * \throws Error whose message names file and line
   */
  [[nodiscard]] Shader create_shader(const ShaderDesc &desc, const ShaderFiles &files,
                                     const ShaderReflection &reflection, const ShaderFiles &stand_in = {});
  /**
   * The program of \a desc, which all users on this device share. If the device has none, or lost the packet that
   * created it, \a make creates it. \a text: further sources of the program, such as the text of a function; equal
   * arguments must mean equal programs.
   *
   * A program without users is kept for the next one: the device keeps the unused_shader_max that were asked for last.
   */
  [[nodiscard]] std::shared_ptr<SharedShader> shared_shader(const ShaderDesc &desc, std::string_view text,
                                                            const std::function<void(SharedShader &made)> &make);
  static constexpr std::size_t unused_shader_max = 64;
  [[nodiscard]] TimerQuery create_timer_query(std::string name);

  /**
   * Write the streams of \a values that are not empty to the vertices of \a batch from \a first_vertex on. The batch
   * must have been created with these streams. `values.indices` has no effect. Lists submitted later read the new
   * values; lists submitted before do not. \pre not a batch of the host
   */
  void update(const Batch &batch, std::uint32_t first_vertex, const BatchDesc &values);
  /** Write \a bytes to \a buffer. Lists submitted later read the new content; lists submitted before do not. */
  void update(const Buffer &buffer, std::size_t offset_bytes, std::span<const std::byte> bytes);
  template <typename T>
  void update(const Buffer &buffer, const T &value)
  {
    update(buffer, 0, std::as_bytes(std::span(&value, 1)));
  }
  /**
   * Write level 0 of one layer. \a texels: rows from the bottom, tightly packed. TextureKind::Buffer: the first texels;
   * the rest keep their content. TextureKind::Flat: also all mip levels, one after the other.
   * \pre not a texture of the host, here and in the functions below
   */
  void upload(const Texture &texture, int layer, std::span<const std::byte> texels);
  /**
   * Compute the mip levels above 0 from level 0. A texel is the mean of the texels of the next finer level that it
   * covers; sRGB values are decoded before averaging. \pre not a depth texture
   */
  void generate_mipmaps(const Texture &texture);
  /**
   * Copy level 0 of the layers that exist in both textures. Copies the rectangle, from the lower left corner, that fits
   * into both. Work submitted later reads the copy. \pre two different textures of the same format and kind
   */
  void copy_layers(const Texture &source, const Texture &target);

  /**
   * Execute \a list, or record its execution. Builds with assertions run validate() first.
   *
   * \throws Error for a stale id and for an error that the driver reports. Commands before the failing one may have
   * been executed, so the content of resources that the list writes is undefined, and loss_count() increases.
   * counters() do not count the list, no pass stays open, and the device remains usable.
   */
  void submit(const CommandList &list);
  /**
   * Add an empty list to the packet, to be filled and submitted during this recording. Unlike other lists, it is not
   * copied when it is submitted. Its memory is reused by the packet's next recording. \pre is_recording
   */
  [[nodiscard]] CommandList &add_list();

  /**
   * Execute \a packet. Device's thread. Packets must be submitted in the order in which they were recorded. Waits for
   * the device if the packet contains a read_back.
   *
   * \throws Error if an operation fails, or if an earlier packet was lost after the recording of this one began. The
   * packet is then lost: the resources that it creates do not exist, the content of resources that it writes is
   * undefined, the resources that it destroys are freed, and loss_count() increases. \pre packet.is_pending()
   */
  void submit(Packet &packet);
  /**
   * Record the calls of \a work into \a packet and submit them. If \a work throws, the calls recorded so far are
   * submitted too. If the copies of uploaded data grow large, the calls recorded so far are executed while \a work
   * runs, and a failure throws inside \a work. Device's thread. \pre no other packet is pending
   */
  template <typename Work>
  void run(Packet &packet, Work &&work);
  [[nodiscard]] bool is_recording() const
  {
    return recording_ != nullptr;
  }
  /**
   * Increases when work is lost: a packet that fails or is discarded, or a list outside of a packet that fails. It is
   * constant during a recording. Resources that a lost packet created become empty and convert to `false`. Code that
   * skips writes to resources that are up to date must compare this number, and write everything again if it changed.
   */
  [[nodiscard]] std::uint64_t loss_count() const
  {
    return losses_taken_;
  }

  /**
   * Take the image of the host in \a framebuffer over for draws. \a layout: the VkImageLayout that it has, or
   * VK_IMAGE_LAYOUT_UNDEFINED, which is 0, if its content is not needed. Work that is submitted from now on waits for
   * \a wait; without a semaphore, only for what was submitted to the same queue before.
   */
  void begin_image(const Framebuffer &framebuffer, int layout, const HostSemaphore &wait = {});
  /** Submit all work on the image, give it back in the VkImageLayout \a layout, and signal \a signal after it. */
  void end_image(const Framebuffer &framebuffer, int layout, const HostSemaphore &signal = {});

  /** Read level 0 of one layer: rows from the bottom, tightly packed. Waits for the device. \pre not is_recording */
  [[nodiscard]] std::vector<std::byte> read(const Texture &texture, int layer = 0);
  /** Record a read. The packet's Feedback holds the texels and \a tag after the submission. \pre is_recording */
  void read_back(const Texture &texture, int layer, std::uint64_t tag);
  /** Wait until all submitted work is done. Device's thread. */
  virtual void finish() = 0;
  /**
   * Give back the memory of destroyed resources: resources to which the driver still refers, and free pages of the
   * process. Takes some milliseconds and waits for the device. Call it after the resources of a scene were destroyed;
   * SceneRenderer does. Does nothing during a recording, and where the backend cannot be called.
   */
  void trim() noexcept;

  /** Set the begin mark and the end mark of \a query, between submissions. Queries must not overlap. Does not wait. */
  void time_begin(const TimerQuery &query);
  void time_end(const TimerQuery &query);
  /**
   * Seconds between all pairs of marks of \a query that were executed since the last call; 0: there were none. Waits
   * for the device. Empty if the device has no timer (null backend). Device's thread.
   */
  [[nodiscard]] std::optional<double> take_seconds(const TimerQuery &query)
  {
    return seconds_take(query.id());
  }

  [[nodiscard]] const Limits &limits() const
  {
    return limits_;
  }
  /** Counts executed work, not recorded work. Device's thread. */
  [[nodiscard]] const Counters &counters() const
  {
    return counters_;
  }
  /**
   * Number of executed passes by name since the device was created. Device's thread. At most pass_name_max names are
   * counted separately, because pass names contain lamp names; passes with further names are counted together under
   * other_passes.
   */
  [[nodiscard]] const PassCounts &pass_counts() const
  {
    return pass_counts_;
  }
  static constexpr std::size_t pass_name_max = 1024;
  static constexpr const char *other_passes = "(other passes)";
  /** One line with the API, its version, the driver and the kind of context. Device's thread. */
  [[nodiscard]] virtual std::string description() const = 0;

  /** The name given at creation, also of a destroyed resource; "none" if \a id is 0 or its index was reused. */
  [[nodiscard]] const std::string &name_of(ResourceKind kind, ResourceId id) const;
  /** Description of the live resource \a id; nullptr if \a id is 0 or the resource was destroyed. */
  [[nodiscard]] const ResourceInfo *find(ResourceKind kind, ResourceId id) const;
  /** Whether live batches own all indices of the range and the vertex \a base_vertex. */
  [[nodiscard]] bool has_batch_data(std::uint32_t first_index, std::uint32_t index_count,
                                    std::int32_t base_vertex) const;
  /** All live resources but shared programs without users, sorted by kind and then by index. */
  [[nodiscard]] std::vector<LiveResource> live() const;
  /** Description of \a resource. \pre it belongs to this device and is not empty */
  [[nodiscard]] LiveResource live(const Resource &resource) const;
  /** One entry for each live resource, such as "texture 'hdr'". */
  [[nodiscard]] std::vector<std::string> live_resources() const;
  /** Bytes of content of all live textures, buffers and batches. The driver may use more memory. */
  [[nodiscard]] std::size_t memory_bytes() const;

 protected:
  /** \a shader_cache_folder: see ShaderDiskCache. */
  Device(const Limits &limits, MessageSink sink, std::filesystem::path shader_cache_folder = {});

  /** Whether the backend functions may be called on this thread now. */
  [[nodiscard]] virtual bool can_execute() const
  {
    return true;
  }
  /** \throws Error unless can_execute() */
  void check_can_execute() const;
  void count_pipeline()
  {
    counters_.pipelines_made++;
  }
  /** Must be called by the destructor of the most derived class, whose backend functions free the resources. */
  void free_live_resources();
  void message(std::string_view text) const;

  /** A scope whose calls are one call for the owner of the context. Scopes may be nested. */
  class Calls {
   public:
    explicit Calls(Device &device) : device_(device)
    {
      device.calls_begin();
    }
    ~Calls()
    {
      device_.calls_end();
    }
    Calls(const Calls &) = delete;
    Calls &operator=(const Calls &) = delete;

   private:
    Device &device_;
  };

  // Functions implemented by a backend. They run on the device's thread and must not read the base class's tables,
  // which the recording thread may be changing.
  /** For a texture of the host, checks \a desc and creates nothing. */
  virtual void texture_create(ResourceId id, const TextureDesc &desc) = 0;
  virtual void sampler_create(ResourceId id, const SamplerDesc &desc) = 0;
  virtual void framebuffer_create(ResourceId id, const FramebufferLayout &layout) = 0;
  /** Only backends of Vulkan have images of the host. */
  virtual void host_framebuffer_create(ResourceId id, const std::string &name, const HostImage &image);
  virtual void image_take(const Operation::TakeImage & /*take*/) {}
  virtual void buffer_create(ResourceId id, const BufferDesc &desc) = 0;
  /**
   * \a vertex_capacity and \a index_capacity: the numbers of elements that the shared buffers must hold from now on.
   * The backend keeps their content when it grows them. If this throws, the shared buffers keep at least their previous
   * capacities and content.
   */
  virtual void batch_create(const BatchDesc &desc, const BatchRange &range, std::uint32_t vertex_capacity,
                            std::uint32_t index_capacity) = 0;
  /** \a first_vertex: in the shared buffers. */
  virtual void batch_update(std::uint32_t first_vertex, const BatchDesc &values) = 0;
  virtual void host_batch_create(ResourceId id, const std::string &name, const HostBatch &batch) = 0;
  /**
   * \a compiled: the backend's own compiled form from an earlier run, or empty. A backend that cannot use it compiles
   * \a stages and replaces \a compiled by a new form, or by an empty one if the backend has no such form.
   */
  virtual void shader_create(const Operation::CreateShader &create, std::vector<std::byte> &compiled) = 0;
  virtual void timer_query_create(ResourceId id, const std::string &name) = 0;
  /** Never called for batches that are ranges of the shared buffers. */
  virtual void resource_destroy(ResourceKind kind, ResourceId id) = 0;
  /** The backend's part of trim(). \return false: there was nothing of a notable size to give back */
  virtual bool driver_trim()
  {
    return false;
  }
  virtual void buffer_update(ResourceId id, std::size_t offset_bytes, std::span<const std::byte> bytes) = 0;
  virtual void texture_upload(ResourceId id, int layer, std::span<const std::byte> texels) = 0;
  virtual void mipmaps_generate(ResourceId id) = 0;
  virtual void layers_copy(ResourceId source, ResourceId target, glm::ivec2 size_px, int layers) = 0;
  virtual void texture_read(ResourceId id, int layer, std::span<std::byte> texels) = 0;
  virtual void list_submit(const CommandList &list) = 0;
  virtual void time_mark(ResourceId query, bool is_end) = 0;
  /** The begin and the end of a scope. \see Calls */
  virtual void calls_begin() {}
  virtual void calls_end() {}
  [[nodiscard]] virtual std::optional<double> seconds_take(ResourceId query) = 0;

 private:
  friend class Packet;
  friend class Recording;
  friend class Resource;

  struct KeptShader {
    std::shared_ptr<SharedShader> shared;
    /** Increases with each request. */
    std::uint64_t asked = 0;
  };
  struct Slot {
    /** Id of the resource that uses this index now, or used it last. */
    ResourceId id = 0;
    bool is_live = false;
    ResourceInfo info;
    /** \see LiveResource::detail */
    std::string detail;
    std::size_t size_bytes = 0;
    std::uint64_t upload_bytes = 0;
  };
  /** A recorded packet. The recording thread does not know yet whether it was executed. */
  struct InFlight {
    std::uint64_t serial = 0;
    /** Link of the resources that the packet creates; nullptr: it creates none. */
    std::shared_ptr<DeviceLink> link;
    std::vector<Operation::Resource> created;
  };
  static constexpr std::size_t kind_count = std::size_t(ResourceKind::TimerQuery) + 1;

  // Called on the recording thread while a Recording exists, otherwise on the device's thread.

  /** Issues an id and performs the call that \a create returns for it. If that throws, the id stays free. */
  template <typename Create>
  Resource make(ResourceKind kind, ResourceInfo info, std::string detail, std::size_t size_bytes, Create &&create);
  /** Records the call, or executes it now if no Recording exists. */
  void perform(Operation operation);
  /** A copy of \a values in the packet, or \a values itself if no Recording exists. */
  template <typename T>
  [[nodiscard]] std::span<const T> kept(std::span<const T> values)
  {
    return recording_ ? recording_->memory_.copy(values) : values;
  }
  /** Destroys shared programs without users until at most \a count_max of them exist. */
  void trim_shared_shaders(std::size_t count_max);
  [[nodiscard]] BatchDesc kept(const BatchDesc &desc);
  BatchRange allocate_range(const BatchDesc &desc);
  void free_range(const BatchRange &range);
  void count_upload(ResourceKind kind, ResourceId id, std::size_t bytes);
  /** Counts the bytes of the updates in \a list. */
  void count_uploads(const CommandList &list);
  /** Called by Resource. */
  void release(ResourceKind kind, ResourceId id);
  /** Marks the slot's index as free. \return false if \a id is not live */
  bool free_slot(ResourceKind kind, ResourceId id);
  /** The slot of \a id, live or destroyed. Returns the slot of index 0 if the index was never used or was reused. */
  [[nodiscard]] const Slot &slot_of(ResourceKind kind, ResourceId id) const;
  void begin(Packet &packet);
  void end();
  /** Updates losses_taken_, and frees the ids of resources that were not created because their packet was lost. */
  void take_losses();
  void destroy_queued();
  void discard(Packet &packet);

  // Called on the device's thread.

  /** \a packet: the packet that contains \a operation; nullptr if it was not recorded. */
  void execute(const Operation &operation, Packet *packet);
  void execute(const Operation::CreateShader &create, Packet *packet);
  void make_shader(const Operation::CreateShader &create);
  void execute_list(const CommandList &list);
  void execute_recorded(Packet &packet);
  /** Executes a list that is not part of a packet. */
  void submit_now(const CommandList &list);
  void set_existing(ResourceKind kind, ResourceId id);
  void destroy(ResourceKind kind, ResourceId id);
  void undo(const Packet &packet);
  void count(const CommandList &list);
  void count_pass(std::string_view name);

  const Limits limits_;
  const MessageSink sink_;
  const std::unique_ptr<const ShaderDiskCache> shader_cache_;

  const std::thread::id thread_ = std::this_thread::get_id();

  // Used by the recording thread.
  std::shared_ptr<DeviceLink> link_;
  /** Links of the packets that created resources. */
  std::vector<std::shared_ptr<DeviceLink>> packet_links_;
  /** Indexed by kind and index_of(id). Index 0 is never live. */
  std::array<std::vector<Slot>, kind_count> slots_;
  /** The next id of each unused index. Excludes indices whose generations are used up. */
  std::array<std::vector<ResourceId>, kind_count> free_ids_;
  std::unique_ptr<RangeAllocator> vertices_;
  std::unique_ptr<RangeAllocator> indices_;
  /** By description and text. */
  std::map<std::string, KeptShader, std::less<>> shared_shaders_;
  std::uint64_t shared_shaders_asked_ = 0;
  Packet *recording_ = nullptr;
  std::uint64_t serial_ = 0;
  std::vector<InFlight> in_flight_;
  /** \see loss_count */
  std::uint64_t losses_taken_ = 0;
  /** Resources that were released while packets were pending. */
  std::vector<Operation::Resource> queued_;

  // Shared by both threads.
  /** Serial of the last executed packet, and of the last packet that was executed or lost. */
  std::atomic<std::uint64_t> executed_serial_ = 0;
  std::atomic<std::uint64_t> done_serial_ = 0;
  std::atomic<std::uint64_t> losses_ = 0;

  // Used by the device's thread.
  Counters counters_;
  /** Indexed by kind and index_of(id): the resource that exists in the backend; 0: none. */
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

/** The OpenGL context that a device uses. */
enum class ContextKind {
  /**
   * The device creates its own context. It tries a hardware EGL device, EGL without a surface, a software EGL device
   * and a hidden window, in this order. No other context may be current on the thread.
   */
  Headless,
  /**
   * The device uses the host's context, which must be current on this thread now and in every later call. Each call
   * saves the OpenGL state that it changes and restores it before it returns or throws.
   *
   * A name that the host has deleted while it was bound is left unbound if OpenGL does not bind it again. So is the
   * current program if it is flagged for deletion and no other context uses it.
   *
   * A call reads pending OpenGL errors before it starts, so that an error of the host is not reported as an error of
   * the device, and raises them again before it returns. Errors other than GL_INVALID_ENUM, GL_INVALID_VALUE and
   * GL_INVALID_OPERATION cannot be raised again and are reported to the message sink.
   *
   * The device cannot save and restore the following state. The host must not call submit() or generate_mipmaps() while
   * it is active; builds with assertions throw Error:
   * - an active query other than GL_TIME_ELAPSED,
   * - conditional rendering,
   * - active transform feedback that is not paused.
   */
  Host,
};

/** `$XDG_CACHE_HOME/gnomon` or `$HOME/.cache/gnomon`; empty if neither variable is set. */
[[nodiscard]] std::filesystem::path default_shader_cache_folder();

struct GlDeviceDesc {
  ContextKind context = ContextKind::Headless;
  /** ContextKind::Headless only: request debug messages from the driver, and throw its error messages as Error. */
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
 * Create a device that uses OpenGL 4.5 core.
 *
 * \throws Error if no context can be created, naming each kind that was tried and the reason; if the host has no
 * current context; or if the context has an older version.
 */
[[nodiscard]] std::unique_ptr<Device> create_gl_device(const GlDeviceDesc &desc = {});

struct VulkanDeviceDesc {
  /** Required. Compiles the text of shaders. */
  SpirvCompiler compile_spirv{};
  /** Empty: the device has an instance and a VkDevice of its own. */
  std::optional<VulkanHost> host{};
  /**
   * Without a host: use the validation layers, with checks of synchronisation, and throw their messages as Error. They
   * take several times the time of the driver on the CPU.
   */
  bool is_debug = false;
  MessageSink sink{};
  /** The same as GlDeviceDesc::shader_cache_folder. */
  std::filesystem::path shader_cache_folder{};
};

/**
 * Create a device that uses Vulkan 1.3. With a VulkanHost, it can use its buffers and textures. It can draw into images
 * (HostImage); a pass with a HostFramebuffer, which is OpenGL's, throws Error.
 *
 * \throws Error if this build has no Vulkan, if there is no Vulkan driver, or if no physical device, or the host's
 * VkDevice, has the features that are needed, naming each device and what it lacks
 */
[[nodiscard]] std::unique_ptr<Device> create_vulkan_device(const VulkanDeviceDesc &desc);

/**
 * The null backend calls this function on the device's thread before each operation, with the operation's name:
 * "create texture", "update", "upload", "submit", "destroy texture" and so on. The function may throw Error to make the
 * operation fail.
 */
using NullOperation = std::function<void(std::string_view operation)>;

/**
 * Create a device that checks and counts like any other device, but draws nothing. Reads return zeros. Needs no driver.
 * \a before_operation: for tests of failures; may be empty
 */
[[nodiscard]] std::unique_ptr<Device> create_null_device(const Limits &limits = {}, MessageSink sink = {},
                                                         NullOperation before_operation = {});

}  // namespace gnomon::gpu
