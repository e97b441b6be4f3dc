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

namespace gnomon::gpu {

/** What a device can hold; asking for more is an Error that names the resource and the limit. */
struct Limits {
  int texture_size_max = 16384;
  int array_layers_max = 2048;
  std::size_t uniform_block_bytes_max = 65536;
  std::size_t storage_block_bytes_max = std::size_t(1) << 27U;
  int color_attachment_max = 8;
  std::uint32_t uniform_offset_alignment = 256;
  /** Vertex shaders may write `gl_Layer` (GL_ARB_shader_viewport_layer_array). */
  bool has_vertex_layer = true;
};

/** What a device has been asked for since it was made. */
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

/** One resource that lives on a device, for people and scripts to read. */
struct LiveResource {
  ResourceKind kind = ResourceKind::Texture;
  std::string name;
  /** Textures: "WIDTHxHEIGHTxLAYERS FORMAT"; shaders: their defines, a space between two; others: empty. */
  std::string detail;
  /** What its content takes: of textures, buffers and batches; 0 of others. */
  std::size_t size_bytes = 0;
  /** Written to it since it was made, by the host; draws into it not counted. */
  std::uint64_t upload_bytes = 0;
};

/** Time between a pair of marks on the device; see Device::time_begin. */
class TimerQuery : public Resource {
 public:
  TimerQuery() = default;

 private:
  friend class Device;
  explicit TimerQuery(Resource resource) : Resource(std::move(resource)) {}
};

/** Receives warnings of the driver and of the device, one line each. Must not throw. */
using MessageSink = std::function<void(std::string_view message)>;

/**
 * The one interface to a graphics API. All calls belong to the thread that made the device.
 *
 * Creating checks what it is given against limits() and throws Error naming the resource; nothing is made then.
 * A device that is destroyed while resources of it live names them to its message sink and frees them.
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

  /** Write now: before anything submitted later. */
  void update(const Buffer &buffer, std::size_t offset_bytes, std::span<const std::byte> bytes);
  template <typename T>
  void update(const Buffer &buffer, const T &value)
  {
    update(buffer, 0, std::as_bytes(std::span(&value, 1)));
  }
  /** \a texels: one layer of level 0, rows from the bottom, tightly packed. */
  void upload(const Texture &texture, int layer, std::span<const std::byte> texels);
  /** Fill the levels above 0 from it, each texel the mean of those below it: of light, where the format is encoded. */
  void generate_mipmaps(const Texture &texture);
  /**
   * Copy level 0 of the layers that both textures have, as far as both reach from the lower left corner. Takes place
   * before anything submitted later. \pre two different textures of one format and kind
   */
  void copy_layers(const Texture &source, const Texture &target);

  /** Do the work of \a list. In debug builds, \throws Error where the driver reports one. */
  void submit(const CommandList &list);

  /** One layer of level 0, rows from the bottom, tightly packed; waits for the device. */
  [[nodiscard]] std::vector<std::byte> read(const Texture &texture, int layer = 0);
  /** Wait until all that was submitted is done. */
  virtual void finish() = 0;

  /** Marks between submissions. Queries do not overlap. */
  virtual void time_begin(const TimerQuery &query) = 0;
  virtual void time_end(const TimerQuery &query) = 0;
  /** Seconds between the marks; waits for the device. Nothing where no time passes (null backend). */
  [[nodiscard]] virtual std::optional<double> elapsed_seconds(const TimerQuery &query) = 0;

  [[nodiscard]] const Limits &limits() const
  {
    return limits_;
  }
  [[nodiscard]] const Counters &counters() const
  {
    return counters_;
  }
  /** How often a pass of each name was submitted, since the device was made. */
  [[nodiscard]] const std::map<std::string, std::uint64_t> &pass_counts() const
  {
    return pass_counts_;
  }
  /** API, version and driver, one line. */
  [[nodiscard]] virtual std::string description() const = 0;

  /** The name given at creation; "none" for 0. */
  [[nodiscard]] const std::string &name_of(ResourceKind kind, ResourceId id) const;
  /** What lives, by kind and then by id. */
  [[nodiscard]] std::vector<LiveResource> live() const;
  /** \a resource in particular. \pre it is of this device, and not empty */
  [[nodiscard]] LiveResource live(const Resource &resource) const;
  /** "texture 'hdr'", one entry a resource that lives. */
  [[nodiscard]] std::vector<std::string> live_resources() const;
  /** What all that lives takes: the textures', buffers' and batches' contents. A driver may take more for them. */
  [[nodiscard]] std::size_t memory_bytes() const;

 protected:
  /** \a shader_cache_folder: see ShaderDiskCache. */
  Device(const Limits &limits, MessageSink sink, std::filesystem::path shader_cache_folder = {});

  /** To be called by the most derived destructor, while it can still free. */
  void free_live_resources();
  void message(std::string_view text) const;

  virtual void texture_create(ResourceId id, const TextureDesc &desc) = 0;
  virtual void sampler_create(ResourceId id, const SamplerDesc &desc) = 0;
  virtual void framebuffer_create(ResourceId id, const FramebufferDesc &desc) = 0;
  virtual void buffer_create(ResourceId id, const BufferDesc &desc) = 0;
  /** \a vertex_capacity and \a index_capacity: what the shared buffers must hold from now on, content kept. */
  virtual void batch_create(const BatchDesc &desc, const BatchRange &range, std::uint32_t vertex_capacity,
                            std::uint32_t index_capacity) = 0;
  virtual void shader_create(ResourceId id, const ShaderDesc &desc, const std::vector<ShaderSource> &stages) = 0;
  /** Make the program of what shader_binary gave once. false: the driver does not take it, and nothing was made. */
  virtual bool shader_load(ResourceId /*id*/, const ShaderDesc & /*desc*/, const CachedShader & /*cached*/)
  {
    return false;
  }
  /** Fill in the driver's form of the program, where it gives one. */
  virtual void shader_binary(ResourceId /*id*/, CachedShader & /*cached*/) {}
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
    std::string name;
    bool is_live = false;
    /** Batches only. */
    BatchRange range;
    /** \see LiveResource */
    std::string detail;
    std::size_t size_bytes = 0;
    std::uint64_t upload_bytes = 0;
  };
  static constexpr std::size_t kind_count = std::size_t(ResourceKind::TimerQuery) + 1;

  /** Takes an id for \a name, calls \a create with it, and gives the id back where that throws. */
  template <typename Create>
  Resource make(ResourceKind kind, const std::string &name, std::string detail, std::size_t size_bytes,
                Create &&create);
  void count_upload(ResourceKind kind, ResourceId id, std::size_t bytes);
  void release(ResourceKind kind, ResourceId id);
  void count(const CommandList &list);

  Limits limits_;
  MessageSink sink_;
  ShaderDiskCache shader_cache_;
  std::shared_ptr<DeviceLink> link_;
  /** Index 0 is never live. */
  std::array<std::vector<Slot>, kind_count> slots_;
  std::array<std::vector<ResourceId>, kind_count> free_ids_;
  RangeAllocator vertices_;
  RangeAllocator indices_;
  std::map<std::string, std::uint64_t> pass_counts_;
};

/** What a context is made from. */
enum class ContextKind {
  /** EGL without a surface, else an EGL device, else a hidden window. No other context may be current on the thread. */
  Headless,
  /** The context that is current on this thread; it stays the host's. */
  Host,
};

struct GlDeviceDesc {
  ContextKind context = ContextKind::Headless;
  /** Ask the driver for messages, and make its errors exceptions. */
#ifdef NDEBUG
  bool is_debug = false;
#else
  bool is_debug = true;
#endif
  MessageSink sink{};
  /** Where compiled shaders are kept from one start to the next; empty: nowhere. \see ShaderDiskCache */
  std::filesystem::path shader_cache_folder{};
};

/**
 * OpenGL 4.5 core.
 *
 * \throws Error naming each way that was tried and why it failed.
 */
[[nodiscard]] std::unique_ptr<Device> create_gl_device(const GlDeviceDesc &desc = {});

/** Records, draws nothing; reads give zeros. Needs no driver. */
[[nodiscard]] std::unique_ptr<Device> create_null_device(const Limits &limits = {}, MessageSink sink = {});

}  // namespace gnomon::gpu
