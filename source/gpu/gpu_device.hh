// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_batch.hh"
#include "gpu_buffer.hh"
#include "gpu_command_list.hh"
#include "gpu_error.hh"
#include "gpu_framebuffer.hh"
#include "gpu_range_allocator.hh"
#include "gpu_shader.hh"
#include "gpu_shader_cache.hh"
#include "gpu_texture.hh"

#include <array>
#include <map>
#include <span>
#include <variant>

namespace gnomon::gpu {

/** Limits of a device. A resource that exceeds one is refused by an Error that names the resource and the limit. */
struct Limits {
  int texture_size_max = 16384;
  int array_layers_max = 2048;
  std::size_t uniform_block_bytes_max = 65536;
  std::size_t storage_block_bytes_max = std::size_t(1) << 27U;
  int color_attachment_max = 8;
  /** Of the offset of a bound range, in bytes. */
  std::uint32_t uniform_offset_alignment = 256;
  /** Storage blocks that one stage may declare. OpenGL guarantees 8 in the fragment stage and none in the others. */
  int vertex_storage_block_max = 8;
  int geometry_storage_block_max = 8;
  int fragment_storage_block_max = 8;
  /** Vertex shaders may write `gl_Layer` (GL_ARB_shader_viewport_layer_array). */
  bool has_vertex_layer = true;
};

/** Work that a device has done since it was created. */
struct Counters {
  std::uint64_t passes = 0;
  /** Entries of DrawIndirect, and procedural draws. */
  std::uint64_t draws = 0;
  std::uint64_t instances = 0;
  std::uint64_t triangles = 0;
  std::uint64_t shader_binds = 0;
  std::uint64_t shaders_made = 0;
  /** Of shaders_made, those whose program the driver took from the disk cache. */
  std::uint64_t shaders_from_cache = 0;
  std::uint64_t textures_made = 0;
  /** Bytes written to buffers, batches and textures. */
  std::uint64_t upload_bytes = 0;
};

/** Description of one live resource for reports. */
struct LiveResource {
  ResourceKind kind = ResourceKind::Texture;
  std::string name;
  /** Textures: "WIDTHxHEIGHTxLAYERS FORMAT"; shaders: their defines, a space between two; others: empty. */
  std::string detail;
  /** Size of the content of a texture, buffer or batch; 0 for other kinds. */
  std::size_t size_bytes = 0;
  /** Bytes that the CPU has written to it since its creation. Draws into it are not counted. */
  std::uint64_t upload_bytes = 0;
};

/** A texture that is attached to a framebuffer. */
struct AttachedTexture {
  ResourceId texture = 0;
  std::string name;
};

/** Description of a framebuffer as validation needs it. */
struct FramebufferInfo {
  std::vector<AttachedTexture> attachments;
  glm::ivec2 size_px{0};
};

/** Description of a live resource as validation needs it. Timer queries have no `desc`. */
struct ResourceInfo {
  std::string name;
  std::variant<std::monostate, TextureDesc, SamplerDesc, FramebufferInfo, BufferDesc, BatchRange, ShaderInterface> desc;
};

/** Time between a pair of marks on the device; see Device::time_begin. */
class TimerQuery : public Resource {
 public:
  TimerQuery() = default;

 private:
  friend class Device;
  explicit TimerQuery(Resource resource) : Resource(std::move(resource)) {}
};

/** Receives warnings of the driver and of the device, one line each. It must not throw. */
using MessageSink = std::function<void(std::string_view message)>;

/**
 * The interface to a graphics API. All calls must be made on the thread that created the device.
 *
 * The create functions check their descriptions against limits(). On failure they throw Error naming the resource and
 * create nothing. A device that is destroyed before its resources reports their names to its message sink and frees
 * them.
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

  /** Write at once. Lists that are submitted later see the new content; lists submitted before do not. */
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
   * executed, so the content of resources that the list writes is undefined. Nothing else changes: counters() do not
   * count the list, no pass stays open, and the device remains usable.
   */
  void submit(const CommandList &list);

  /** Read one layer of level 0: rows from the bottom, tightly packed. Waits for the device. */
  [[nodiscard]] std::vector<std::byte> read(const Texture &texture, int layer = 0);
  /** Wait until all submitted work is done. */
  virtual void finish() = 0;

  /** Set the marks of \a query, between submissions. Queries must not overlap. */
  virtual void time_begin(const TimerQuery &query) = 0;
  virtual void time_end(const TimerQuery &query) = 0;
  /** Seconds between the marks; waits for the device. Empty where the device has no timer (null backend). */
  [[nodiscard]] virtual std::optional<double> elapsed_seconds(const TimerQuery &query) = 0;

  [[nodiscard]] const Limits &limits() const
  {
    return limits_;
  }
  [[nodiscard]] const Counters &counters() const
  {
    return counters_;
  }
  /**
   * Number of submitted passes by name, since the device was created. The first pass_name_max names are counted each by
   * itself, passes of further names together under other_passes, so that names of lamps cannot make the map grow.
   */
  [[nodiscard]] const std::map<std::string, std::uint64_t> &pass_counts() const
  {
    return pass_counts_;
  }
  static constexpr std::size_t pass_name_max = 1024;
  static constexpr const char *other_passes = "(other passes)";
  /** API, version, driver and the kind of context, in one line. */
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

  virtual void texture_create(ResourceId id, const TextureDesc &desc) = 0;
  virtual void sampler_create(ResourceId id, const SamplerDesc &desc) = 0;
  virtual void framebuffer_create(ResourceId id, const FramebufferDesc &desc) = 0;
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
  virtual void resource_destroy(ResourceKind kind, ResourceId id) = 0;
  virtual void buffer_update(ResourceId id, std::size_t offset_bytes, std::span<const std::byte> bytes) = 0;
  virtual void texture_upload(const Texture &texture, int layer, std::span<const std::byte> texels) = 0;
  virtual void mipmaps_generate(const Texture &texture) = 0;
  virtual void layers_copy(const Texture &source, const Texture &target, glm::ivec2 size_px, int layers) = 0;
  virtual void texture_read(const Texture &texture, int layer, std::span<std::byte> texels) = 0;
  virtual void list_submit(const CommandList &list) = 0;

  Counters counters_;

 private:
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
  static constexpr std::size_t kind_count = std::size_t(ResourceKind::TimerQuery) + 1;

  /** Calls \a create with a new id. Where that throws, the id is free again. */
  template <typename Create>
  Resource make(ResourceKind kind, ResourceInfo info, std::string detail, std::size_t size_bytes, Create &&create);
  BatchRange allocate_range(const BatchDesc &desc);
  void free_range(const BatchRange &range);
  void count_upload(ResourceKind kind, ResourceId id, std::size_t bytes);
  void release(ResourceKind kind, ResourceId id);
  void count(const CommandList &list);
  void count_pass(const std::string &name);
  /** The slot of index 0 where \a id names no resource that is or was the last of its index. */
  [[nodiscard]] const Slot &slot_of(ResourceKind kind, ResourceId id) const;

  Limits limits_;
  MessageSink sink_;
  ShaderDiskCache shader_cache_;
  std::shared_ptr<DeviceLink> link_;
  /** By index_of(id). Index 0 is never live. */
  std::array<std::vector<Slot>, kind_count> slots_;
  /** Ids to issue next, of indices that are not in use. An index whose generations are used up is not among them. */
  std::array<std::vector<ResourceId>, kind_count> free_ids_;
  RangeAllocator vertices_;
  RangeAllocator indices_;
  std::map<std::string, std::uint64_t> pass_counts_;
};

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

/** Checks and counts as every device, but draws nothing; reads give zeros. Needs no driver. */
[[nodiscard]] std::unique_ptr<Device> create_null_device(const Limits &limits = {}, MessageSink sink = {});

}  // namespace gnomon::gpu
