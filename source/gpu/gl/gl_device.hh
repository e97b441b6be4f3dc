// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device.hh"

#include "gl_context.hh"
#include "gl_state.hh"
#include "gl_stream.hh"
#include "internal/gpu_id_table.hh"

#include <functional>
#include <optional>

namespace gnomon::gpu {

struct GlFormat {
  GLenum internal;
  GLenum format;
  GLenum type;
};
[[nodiscard]] GlFormat gl_format(Format format);
/** GL_TEXTURE_2D, GL_TEXTURE_2D_ARRAY or GL_TEXTURE_BUFFER. */
[[nodiscard]] GLenum gl_target(TextureKind kind);

struct GlVertexType {
  GLenum type = GL_NONE;
  GLboolean is_normalized = GL_FALSE;
};
[[nodiscard]] GlVertexType gl_vertex_type(VertexType type);

class GlDevice final : public Device {
 public:
  GlDevice(std::unique_ptr<GlContext> context, const GlDeviceDesc &desc);
  ~GlDevice() override;

  void finish() override;
  std::string description() const override;

 private:
  /** A pool is a buffer that all batches share: one for each VertexStream, and a last one for the indices. */
  static constexpr std::size_t index_pool = vertex_stream_count;
  static constexpr std::size_t pool_count = vertex_stream_count + 1;
  using PoolBuffers = std::array<GLuint, pool_count>;
  using PoolSizes = std::array<std::size_t, pool_count>;

  struct GlTexture {
    GLuint name = 0;
    TextureDesc desc;
    /** Holds the texels of TextureKind::Buffer; otherwise 0. */
    GLuint buffer = 0;
  };
  struct GlFramebuffer {
    GLuint name = 0;
    GLuint color_count = 0;
    bool has_depth = false;
    glm::ivec2 size_px{0};
    /** Texture views of the attachments that are ranges of layers. Owned. */
    std::vector<GLuint> views;
  };
  struct GlBuffer {
    GLuint name = 0;
    std::size_t size_bytes = 0;
    /** Whether a list has updated it since the last wait_for_copies(). */
    bool is_copied_into = false;
  };
  /** A sampler that a program declares. */
  struct DeclaredSampler {
    GLuint unit = 0;
    /** Texture target: GL_TEXTURE_2D, GL_TEXTURE_2D_ARRAY or GL_TEXTURE_BUFFER. */
    GLenum target = GL_NONE;
    bool is_comparison = false;
  };
  /** A vertex array, and the instances that its draws read. */
  struct VertexArray {
    GLuint name = 0;
    /** \see CommandList::bind_instances */
    ResourceId objects = 0;
  };
  struct GlProgram {
    GLuint name = 0;
    std::vector<DeclaredSampler> samplers;
  };
  /** The names of two timestamp queries: at the begin and at the end. */
  using TimeMarks = std::array<GLuint, 2>;
  struct Timer {
    std::string name;
    /** Marked, oldest first, and not read yet. The last one may lack its end. */
    std::vector<TimeMarks> pending;
    std::vector<TimeMarks> unused;
    bool has_begun = false;
    /** Sum of the times that were read. */
    double seconds = 0.0;
  };
  /** A texture of one black texel with a sampler, for declared samplers to which a list binds no texture. */
  struct Dummy {
    GLuint texture = 0;
    GLuint sampler = 0;
  };

  static void GLAPIENTRY receive_message(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
                                         const GLchar *text, const void *user);
  /** \throws Error with the errors that the driver has reported since the last check; DeviceLost */
  void check(std::string_view what);
  /** Calls check(). If it throws, calls \a destroy before rethrowing. */
  void check_or(std::string_view what, const std::function<void()> &destroy);
  /** In builds with assertions, \throws Error if the host's state cannot be saved. */
  void check_host_state(std::string_view what);
  /** A buffer of \a size_bytes that was bound to \a target. */
  GLuint create_buffer_of(GLenum target, std::size_t size_bytes);
  static void label(GLenum kind, GLuint name, const std::string &text);

  [[nodiscard]] bool can_execute() const override
  {
    return calls_depth_ > 0 || current_context() == made_in_;
  }
  void texture_create(ResourceId id, const TextureDesc &desc) override;
  void sampler_create(ResourceId id, const SamplerDesc &desc) override;
  void framebuffer_create(ResourceId id, const FramebufferLayout &layout) override;
  void buffer_create(ResourceId id, const BufferDesc &desc) override;
  void batch_create(const BatchDesc &desc, const BatchRange &range, std::uint32_t vertex_capacity,
                    std::uint32_t index_capacity) override;
  void batch_update(std::uint32_t first_vertex, const BatchDesc &values) override;
  void host_batch_create(ResourceId id, const std::string &name, const HostBatch &batch) override;
  void shader_create(const Operation::CreateShader &create, std::vector<std::byte> &compiled) override;
  void timer_query_create(ResourceId id, const std::string &name) override;
  void resource_destroy(ResourceKind kind, ResourceId id) override;
  bool driver_trim() override;
  void buffer_update(ResourceId id, std::size_t offset_bytes, std::span<const std::byte> bytes) override;
  void texture_upload(ResourceId id, int layer, std::span<const std::byte> texels) override;
  void mipmaps_generate(ResourceId id) override;
  void layers_copy(ResourceId source, ResourceId target, glm::ivec2 size_px, int layers) override;
  void texture_read(ResourceId id, int layer, std::span<std::byte> texels) override;
  void list_submit(const CommandList &list) override;
  void time_mark(ResourceId query, bool is_end) override;
  /**
   * The outermost scope in a host's context takes the host's pending errors, and at its end restores the host's state
   * and raises the errors again.
   */
  void calls_begin() override;
  void calls_end() override;
  std::optional<double> seconds_take(ResourceId query) override;

  /** Reads the pending times of \a timer: those which the device has, or \a waits for all. */
  void read_times(Timer &timer, bool waits);
  void create_vertex_arrays();
  /** A vertex array whose attributes of instances are set up, and those of vertices are not. */
  static VertexArray create_instanced_array();
  /** \throws Error if the texture of the host that \a desc names cannot be looked up */
  void check_host_texture(const TextureDesc &desc);
  /** Attaches a texture to \a framebuffer at \a point. If this needs a texture view, appends it to \a views. */
  void attach(GLuint framebuffer, GLenum point, const AttachmentLayout &attachment, std::vector<GLuint> &views);
  void grow_pools(const BatchDesc &desc, const PoolSizes &sizes);
  /** Call this between a copy into a buffer and glBufferSubData into the same range. */
  void wait_for_copies();
  /** Compiles and links \a stages. \throws Error with the driver's log */
  GLuint compile(const ShaderDesc &desc, const std::vector<ShaderSource> &stages);
  /** Creates a program from its compiled form. \return 0 if the driver does not accept \a compiled */
  GLuint load_compiled(const std::vector<std::byte> &compiled);
  static std::vector<DeclaredSampler> declared_samplers(GLuint program, const std::vector<std::string> &names);
  const Dummy &dummy(const DeclaredSampler &sampler);

  void execute(const CommandList &list);
  /** Begins a stream segment for \a list and copies its draws and instances into it. */
  void write_stream(const CommandList &list);
  void begin_pass(std::string_view name, const CommandList::PassInfo &pass);
  /** Clear or invalidate the attachments as \a actions say. \pre their write masks are enabled */
  void load_attachments(const GlFramebuffer &framebuffer, const PassActions &actions, bool is_of_host) const;
  void end_pass();
  /** The render target of \a pass. The reference is valid until the next call. */
  [[nodiscard]] const GlFramebuffer &framebuffer_of(const CommandList::PassInfo &pass);
  /** In builds with assertions, \throws Error if the host's framebuffer cannot be drawn into. */
  void check_host_framebuffer(std::string_view pass_name, const CommandList::PassInfo &pass);
  void set_wireframe(bool is_wireframe);
  void set_state(State state);
  void bind_range(const Command &command);
  void bind_texture(const Command &command);
  /** Lets \a array read the instances of `objects_`. */
  void bind_instances(VertexArray &array);
  /** Lets `host_array_` read the vertices and indices of \a batch. */
  void bind_host_buffers(const HostBatch &batch);
  /** Binds the vertex array of the following draws. */
  void bind_vertex_array();
  /** So that buffers which the list has read can be freed. */
  void release_buffers();
  /** Binds dummies to the samplers of the current program that the list has not bound. */
  void complete_textures();
  /** Binds framebuffer \a name for draws, after its clears. */
  void bind_for_draws(GLuint name);

  std::unique_ptr<GlContext> context_;
  /** The context that was current when the device was made, and is in each call. */
  const void *const made_in_ = current_context();
  /** Whether the driver reports errors as debug messages. Always false in a host's context. */
  bool is_debug_;
  /**
   * Passes are debug groups: in a context of the device, and where a debugger such as RenderDoc asks for them. A host
   * would get a message for each.
   */
  bool has_pass_groups_;
  /** State::Wireframe of the last draws of the pass. */
  bool is_wireframe_ = false;
  std::vector<std::string> driver_errors_;
  DeviceNames names_;
  HostState host_state_;
  /** Errors of OpenGL that the host had pending when the outermost scope began. */
  std::vector<GLenum> host_errors_;
  int calls_depth_ = 0;
  /** The objects in the context are not deleted, because it was not current when the device was destroyed. */
  bool is_abandoned_ = false;
  bool is_lost_ = false;
  /** Bytes of the textures that were destroyed since the last driver_trim(). */
  std::size_t destroyed_bytes_ = 0;
  /**
   * NVIDIA's driver (580.159): if a depth attachment is cleared to the value of its previous clear, later depth tests
   * in full tiles of 16x16 pixels can read the cleared depth instead of what was drawn since. A clear to another value
   * in between prevents it.
   */
  bool has_unsound_depth_clears_ = false;
  /** Bits of the GL_TIMESTAMP counter; 0: the driver has no timer. */
  GLint timestamp_bits_ = 0;
  /** \see unsaveable_state */
  GLuint probe_query_ = 0;

  IdTable<GlTexture> textures_{ResourceKind::Texture};
  IdTable<GLuint> samplers_{ResourceKind::Sampler};
  IdTable<GlFramebuffer> framebuffers_{ResourceKind::Framebuffer};
  IdTable<GlBuffer> buffers_{ResourceKind::Buffer};
  IdTable<HostBatch> host_batches_{ResourceKind::Batch};
  IdTable<GlProgram> programs_{ResourceKind::Shader};
  IdTable<Timer> timers_{ResourceKind::TimerQuery};

  /** Indexed by target (2D, 2D array) and by whether the sampler compares depths. */
  std::array<std::array<Dummy, 2>, 3> dummies_{};

  /** Reads the shared buffers. */
  VertexArray shared_array_;
  /** Reads the buffers of one batch of the host; made when the first such batch is made. */
  VertexArray host_array_;
  GLuint empty_vertex_array_ = 0;
  /** \see bind_for_draws */
  GLuint other_framebuffer_ = 0;
  /** The framebuffer of the pass, and that of the last draw, is a window. */
  bool is_window_ = false;
  bool has_drawn_window_ = false;
  /** For streams that a batch of the host does not have: four zeros, and four ones. */
  GLuint absent_streams_ = 0;
  PoolBuffers pool_{};
  /** Sizes of the pools in bytes. */
  PoolSizes pool_size_{};
  StreamRing stream_{names_};
  /** Byte offsets of the list's instances and draws in the stream's buffer. */
  std::size_t instances_offset_ = 0;
  std::size_t draws_offset_ = 0;
  /** \see CommandList::bind_instances */
  ResourceId objects_ = 0;
  /** \see CommandList::bind_host_batch; nullptr: the shared buffers */
  const HostBatch *host_batch_ = nullptr;
  /** The list has bound buffers of the host. */
  bool has_host_buffers_ = false;

  /** The open pass; nullptr outside of passes. */
  const CommandList::PassInfo *pass_ = nullptr;
  /** Number of colour attachments of the pass. */
  GLuint color_count_ = 0;
  /** Returned by framebuffer_of for passes that draw into a host framebuffer. */
  GlFramebuffer host_framebuffer_;
  const GlProgram *program_ = nullptr;
  /** The primitive of indexed draws, by the state. */
  GLenum primitive_ = GL_TRIANGLES;
  /** Indexed by texture unit: GL_NONE, GL_TEXTURE for a texture of the list, or the target of the bound dummy. */
  std::vector<GLenum> bound_textures_;
};

}  // namespace gnomon::gpu
