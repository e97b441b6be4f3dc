// SPDX-License-Identifier: MIT
#include "gpu_device.hh"

#include "gl_context.hh"

#include "slots_shared.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <unordered_map>

namespace gnomon::gpu {

namespace {

struct GlFormat {
  GLenum internal;
  GLenum format;
  GLenum type;
};

GlFormat gl_format(Format format)
{
  switch (format) {
    case Format::RGBA8: return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};
    case Format::SRGB8A8: return {GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE};
    case Format::RGBA16F: return {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT};
    case Format::RGBA32F: return {GL_RGBA32F, GL_RGBA, GL_FLOAT};
    case Format::R16F: return {GL_R16F, GL_RED, GL_HALF_FLOAT};
    case Format::R32F: return {GL_R32F, GL_RED, GL_FLOAT};
    case Format::RG32F: return {GL_RG32F, GL_RG, GL_FLOAT};
    case Format::Depth32F: return {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT};
  }
  return {};
}

GLenum gl_target(TextureKind kind)
{
  switch (kind) {
    case TextureKind::Flat: return GL_TEXTURE_2D;
    case TextureKind::Array: return GL_TEXTURE_2D_ARRAY;
    case TextureKind::Cube: return GL_TEXTURE_CUBE_MAP;
    case TextureKind::CubeArray: return GL_TEXTURE_CUBE_MAP_ARRAY;
  }
  return GL_TEXTURE_2D;
}

GLint gl_wrap(Wrap wrap)
{
  switch (wrap) {
    case Wrap::ClampToEdge: return GL_CLAMP_TO_EDGE;
    case Wrap::Repeat: return GL_REPEAT;
    case Wrap::MirroredRepeat: return GL_MIRRORED_REPEAT;
  }
  return GL_CLAMP_TO_EDGE;
}

GLint gl_min_filter(Filter filter, MipFilter mip)
{
  const bool is_linear = filter == Filter::Linear;
  switch (mip) {
    case MipFilter::None: return is_linear ? GL_LINEAR : GL_NEAREST;
    case MipFilter::Nearest: return is_linear ? GL_LINEAR_MIPMAP_NEAREST : GL_NEAREST_MIPMAP_NEAREST;
    case MipFilter::Linear: return is_linear ? GL_LINEAR_MIPMAP_LINEAR : GL_NEAREST_MIPMAP_LINEAR;
  }
  return GL_NEAREST;
}

GLenum gl_target(BufferKind kind)
{
  return kind == BufferKind::Uniform ? GL_UNIFORM_BUFFER : GL_SHADER_STORAGE_BUFFER;
}

Limits query_limits()
{
  const auto get = [](GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return value;
  };
  Limits limits;
  limits.texture_size_max = get(GL_MAX_TEXTURE_SIZE);
  limits.array_layers_max = get(GL_MAX_ARRAY_TEXTURE_LAYERS);
  limits.uniform_block_bytes_max = std::size_t(get(GL_MAX_UNIFORM_BLOCK_SIZE));
  limits.storage_block_bytes_max = std::size_t(get(GL_MAX_SHADER_STORAGE_BLOCK_SIZE));
  limits.color_attachment_max = get(GL_MAX_COLOR_ATTACHMENTS);
  limits.uniform_offset_alignment = std::uint32_t(get(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT));
  limits.has_vertex_layer = epoxy_has_gl_extension("GL_ARB_shader_viewport_layer_array");
  return limits;
}

class GlDevice final : public Device {
 public:
  GlDevice(std::unique_ptr<GlContext> context, const GlDeviceDesc &desc)
      : Device(query_limits(), desc.sink, desc.shader_cache_folder),
        context_(std::move(context)),
        is_debug_(desc.is_debug && context_)
  {
    if (is_debug_) {
      glEnable(GL_DEBUG_OUTPUT);
      glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
      glDebugMessageCallback(&GlDevice::receive_message, this);
    }
    glCreateVertexArrays(1, &vertex_array_);
    glCreateBuffers(GLsizei(streams_.size()), streams_.data());
    glEnableVertexArrayAttrib(vertex_array_, ATTRIBUTE_POSITION);
    glVertexArrayAttribFormat(vertex_array_, ATTRIBUTE_POSITION, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(vertex_array_, ATTRIBUTE_POSITION, ATTRIBUTE_POSITION);
    glEnableVertexArrayAttrib(vertex_array_, ATTRIBUTE_NORMAL);
    glVertexArrayAttribFormat(vertex_array_, ATTRIBUTE_NORMAL, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(vertex_array_, ATTRIBUTE_NORMAL, ATTRIBUTE_NORMAL);
    // Enabled with the first batch that has them.
    glVertexArrayAttribFormat(vertex_array_, ATTRIBUTE_UV, 2, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(vertex_array_, ATTRIBUTE_UV, ATTRIBUTE_UV);
    glEnableVertexArrayAttrib(vertex_array_, ATTRIBUTE_DRAW_INSTANCE);
    glVertexArrayAttribIFormat(vertex_array_, ATTRIBUTE_DRAW_INSTANCE, 2, GL_UNSIGNED_INT, 0);
    glVertexArrayAttribBinding(vertex_array_, ATTRIBUTE_DRAW_INSTANCE, ATTRIBUTE_DRAW_INSTANCE);
    glVertexArrayBindingDivisor(vertex_array_, ATTRIBUTE_DRAW_INSTANCE, 1);
    glVertexArrayVertexBuffer(vertex_array_, ATTRIBUTE_DRAW_INSTANCE, streams_[InstanceStream], 0,
                              sizeof(DrawInstance));
    // Procedural draws need a vertex array too, and must not read the batches'.
    glCreateVertexArrays(1, &empty_vertex_array_);
  }

  ~GlDevice() override
  {
    free_live_resources();
    glDeleteBuffers(GLsizei(streams_.size()), streams_.data());
    glDeleteBuffers(GLsizei(pool_.size()), pool_.data());
    glDeleteVertexArrays(1, &vertex_array_);
    glDeleteVertexArrays(1, &empty_vertex_array_);
    if (is_debug_) {
      glDebugMessageCallback(nullptr, nullptr);
    }
  }

  void finish() override
  {
    glFinish();
  }

  void time_begin(const TimerQuery &query) override
  {
    glQueryCounter(timers_.at(query.id())[0], GL_TIMESTAMP);
  }

  void time_end(const TimerQuery &query) override
  {
    glQueryCounter(timers_.at(query.id())[1], GL_TIMESTAMP);
  }

  std::optional<double> elapsed_seconds(const TimerQuery &query) override
  {
    std::array<GLuint64, 2> nanoseconds{};
    for (std::size_t i = 0; i < 2; i++) {
      glGetQueryObjectui64v(timers_.at(query.id())[i], GL_QUERY_RESULT, &nanoseconds[i]);
    }
    return double(nanoseconds[1] - nanoseconds[0]) * 1e-9;
  }

  std::string description() const override
  {
    const auto text = [](GLenum name) { return reinterpret_cast<const char *>(glGetString(name)); };
    return fmt::format("OpenGL {}, {} ({})", text(GL_VERSION), text(GL_RENDERER),
                       context_ ? context_->description() : "host's context");
  }

 private:
  enum Stream { InstanceStream, IndirectStream, PushStream, StreamCount };
  enum Pool { PositionPool, NormalPool, UvPool, IndexPool, PoolCount };

  static void GLAPIENTRY receive_message(GLenum /*source*/, GLenum type, GLuint /*id*/, GLenum severity,
                                         GLsizei /*length*/, const GLchar *text, const void *user)
  {
    // An exception must not pass through the driver: errors wait for check().
    auto *device = static_cast<GlDevice *>(const_cast<void *>(user));
    if (type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR) {
      device->driver_errors_.emplace_back(text);
    }
    else if (severity == GL_DEBUG_SEVERITY_HIGH) {
      device->message(fmt::format("driver: {}", text));
    }
  }

  /** \throws Error with what the driver reported since the last check. */
  void check(std::string_view what)
  {
    // Without debug messages, running out of memory is the one error that a correct program still meets.
    if (!is_debug_ && glGetError() == GL_OUT_OF_MEMORY) {
      throw Error("{}: the driver is out of memory", what);
    }
    if (!driver_errors_.empty()) {
      const std::vector<std::string> errors = std::exchange(driver_errors_, {});
      throw Error("{}: the driver reports: {}", what, fmt::join(errors, "; "));
    }
  }

  void texture_create(ResourceId id, const TextureDesc &desc) override
  {
    GLuint texture = 0;
    glCreateTextures(gl_target(desc.kind), 1, &texture);
    const GLenum internal = gl_format(desc.format).internal;
    switch (desc.kind) {
      case TextureKind::Flat:
      case TextureKind::Cube: glTextureStorage2D(texture, desc.mip_levels, internal, desc.width, desc.height); break;
      case TextureKind::Array:
      case TextureKind::CubeArray:
        glTextureStorage3D(texture, desc.mip_levels, internal, desc.width, desc.height, desc.layer_count());
        break;
    }
    label(GL_TEXTURE, texture, desc.name);
    textures_[id] = texture;
    check_or_destroy(ResourceKind::Texture, id, fmt::format("texture '{}'", desc.name));
  }

  void sampler_create(ResourceId id, const SamplerDesc &desc) override
  {
    GLuint sampler = 0;
    glCreateSamplers(1, &sampler);
    glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, gl_min_filter(desc.minified.value_or(desc.filter), desc.mip));
    glSamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, desc.filter == Filter::Linear ? GL_LINEAR : GL_NEAREST);
    glSamplerParameteri(sampler, GL_TEXTURE_WRAP_S, gl_wrap(desc.wrap_u));
    glSamplerParameteri(sampler, GL_TEXTURE_WRAP_T, gl_wrap(desc.wrap_v));
    glSamplerParameteri(sampler, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
    if (desc.is_depth_comparison) {
      glSamplerParameteri(sampler, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
      glSamplerParameteri(sampler, GL_TEXTURE_COMPARE_FUNC, GL_GEQUAL);
    }
    label(GL_SAMPLER, sampler, desc.name);
    samplers_[id] = sampler;
  }

  void framebuffer_create(ResourceId id, const FramebufferDesc &desc) override
  {
    GLuint framebuffer = 0;
    glCreateFramebuffers(1, &framebuffer);
    std::vector<GLuint> views;
    const auto attach = [&](GLenum point, const Attachment &attachment) {
      const GLuint texture = textures_.at(attachment.texture->id());
      if (attachment.layer_count > 1) {
        GLuint &view = views.emplace_back();
        glGenTextures(1, &view);
        const TextureDesc &texture_desc = attachment.texture->desc();
        glTextureView(view, GL_TEXTURE_2D_ARRAY, texture, gl_format(texture_desc.format).internal, 0,
                      GLuint(texture_desc.mip_levels), GLuint(attachment.layer), GLuint(attachment.layer_count));
        glNamedFramebufferTexture(framebuffer, point, view, attachment.mip_level);
      }
      else if (attachment.layer == all_layers || attachment.texture->desc().kind == TextureKind::Flat) {
        glNamedFramebufferTexture(framebuffer, point, texture, attachment.mip_level);
      }
      else {
        glNamedFramebufferTextureLayer(framebuffer, point, texture, attachment.mip_level, attachment.layer);
      }
    };
    std::vector<GLenum> buffers;
    for (const Attachment &color : desc.colors) {
      buffers.push_back(GL_COLOR_ATTACHMENT0 + GLenum(buffers.size()));
      attach(buffers.back(), color);
    }
    glNamedFramebufferDrawBuffers(framebuffer, GLsizei(buffers.size()), buffers.data());
    if (desc.depth.texture) {
      attach(GL_DEPTH_ATTACHMENT, desc.depth);
    }
    label(GL_FRAMEBUFFER, framebuffer, desc.name);
    framebuffers_[id] = {framebuffer, int(desc.colors.size()), desc.depth.texture != nullptr, {}, std::move(views)};
    const Attachment &any = desc.colors.empty() ? desc.depth : desc.colors.front();
    framebuffers_[id].size_px = {std::max(any.texture->desc().width >> any.mip_level, 1),
                                 std::max(any.texture->desc().height >> any.mip_level, 1)};
    const GLenum status = glCheckNamedFramebufferStatus(framebuffer, GL_DRAW_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE) {
      resource_destroy(ResourceKind::Framebuffer, id);
      throw Error("framebuffer '{}': the driver cannot draw into these attachments (status 0x{:x})", desc.name, status);
    }
  }

  void buffer_create(ResourceId id, const BufferDesc &desc) override
  {
    GLuint buffer = 0;
    glCreateBuffers(1, &buffer);
    // Not by name: Mesa's rasteriser holds updates back until earlier draws are done only where it knows the target.
    const GLenum target = gl_target(desc.kind);
    glBindBuffer(target, buffer);
    glBufferData(target, GLsizeiptr(desc.size_bytes), nullptr, GL_DYNAMIC_DRAW);
    glBindBuffer(target, 0);
    label(GL_BUFFER, buffer, desc.name);
    buffers_[id] = {buffer, desc.size_bytes};
    check_or_destroy(ResourceKind::Buffer, id, fmt::format("buffer '{}'", desc.name));
  }

  /** A pool's buffer, made anew with its content where it is too small. */
  void grow(Pool pool, std::size_t old_bytes, std::size_t bytes)
  {
    GLuint grown = 0;
    glCreateBuffers(1, &grown);
    glNamedBufferData(grown, GLsizeiptr(bytes), nullptr, GL_STATIC_DRAW);
    if (pool_[pool]) {
      glCopyNamedBufferSubData(pool_[pool], grown, 0, 0, GLsizeiptr(old_bytes));
      glDeleteBuffers(1, &pool_[pool]);
    }
    pool_[pool] = grown;
  }

  void batch_create(const BatchDesc &desc, const BatchRange &range, std::uint32_t vertex_capacity,
                    std::uint32_t index_capacity) override
  {
    constexpr std::size_t vertex_bytes = sizeof(glm::vec3);
    if (vertex_capacity > vertex_capacity_) {
      grow(PositionPool, vertex_capacity_ * vertex_bytes, vertex_capacity * vertex_bytes);
      grow(NormalPool, vertex_capacity_ * vertex_bytes, vertex_capacity * vertex_bytes);
      glVertexArrayVertexBuffer(vertex_array_, ATTRIBUTE_POSITION, pool_[PositionPool], 0, vertex_bytes);
      glVertexArrayVertexBuffer(vertex_array_, ATTRIBUTE_NORMAL, pool_[NormalPool], 0, vertex_bytes);
      vertex_capacity_ = vertex_capacity;
    }
    if (!desc.uvs.empty()) {
      upload_uvs(desc, range);
    }
    if (index_capacity > index_capacity_) {
      grow(IndexPool, index_capacity_ * sizeof(std::uint32_t), index_capacity * sizeof(std::uint32_t));
      glVertexArrayElementBuffer(vertex_array_, pool_[IndexPool]);
      index_capacity_ = index_capacity;
    }
    const auto offset = GLintptr(range.base_vertex) * GLintptr(vertex_bytes);
    glNamedBufferSubData(pool_[PositionPool], offset, GLsizeiptr(desc.positions.size_bytes()), desc.positions.data());
    if (desc.normals.empty()) {
      const std::vector<glm::vec3> zeros(desc.positions.size(), glm::vec3(0.0F));
      glNamedBufferSubData(pool_[NormalPool], offset, GLsizeiptr(zeros.size() * vertex_bytes), zeros.data());
    }
    else {
      glNamedBufferSubData(pool_[NormalPool], offset, GLsizeiptr(desc.normals.size_bytes()), desc.normals.data());
    }
    glNamedBufferSubData(pool_[IndexPool], GLintptr(range.first_index * sizeof(std::uint32_t)),
                         GLsizeiptr(desc.indices.size_bytes()), desc.indices.data());
    check(fmt::format("batch '{}'", desc.name));
  }

  /** Their pool is made for the first batch that has some, and grows only with those: each at its base vertex. */
  void upload_uvs(const BatchDesc &desc, const BatchRange &range)
  {
    constexpr std::size_t uv_bytes = sizeof(glm::vec2);
    if (vertex_capacity_ > uv_capacity_) {
      grow(UvPool, uv_capacity_ * uv_bytes, vertex_capacity_ * uv_bytes);
      glEnableVertexArrayAttrib(vertex_array_, ATTRIBUTE_UV);
      glVertexArrayVertexBuffer(vertex_array_, ATTRIBUTE_UV, pool_[UvPool], 0, uv_bytes);
      uv_capacity_ = vertex_capacity_;
    }
    glNamedBufferSubData(pool_[UvPool], GLintptr(range.base_vertex) * GLintptr(uv_bytes),
                         GLsizeiptr(desc.uvs.size_bytes()), desc.uvs.data());
  }

  void shader_create(ResourceId id, const ShaderDesc &desc, const std::vector<ShaderSource> &stages) override
  {
    const GLuint program = glCreateProgram();
    const auto failed = [&](const std::string &what) {
      glDeleteProgram(program);
      // The driver reports the same again by message.
      driver_errors_.clear();
      throw Error("shader '{}': {}", desc.name, what);
    };
    for (const ShaderSource &stage : stages) {
      const GLuint shader = glCreateShader(gl_stage(stage.stage));
      const char *text = stage.text.c_str();
      glShaderSource(shader, 1, &text, nullptr);
      glCompileShader(shader);
      glAttachShader(program, shader);
      // Flagged only: it goes with the program.
      glDeleteShader(shader);
      GLint is_compiled = 0;
      glGetShaderiv(shader, GL_COMPILE_STATUS, &is_compiled);
      if (!is_compiled) {
        std::string log(4096, '\0');
        GLsizei length = 0;
        glGetShaderInfoLog(shader, GLsizei(log.size()), &length, log.data());
        log.resize(std::size_t(length));
        failed(fmt::format("the driver rejects the {} stage:\n{}", to_string(stage.stage), stage.name_files(log)));
      }
    }
    glProgramParameteri(program, GL_PROGRAM_BINARY_RETRIEVABLE_HINT, GL_TRUE);
    glLinkProgram(program);
    GLint is_linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &is_linked);
    if (!is_linked) {
      std::string log(4096, '\0');
      GLsizei length = 0;
      glGetProgramInfoLog(program, GLsizei(log.size()), &length, log.data());
      log.resize(std::size_t(length));
      failed("the driver does not link it:\n" + log);
    }
    label(GL_PROGRAM, program, desc.name);
    programs_[id] = program;
  }

  bool shader_load(ResourceId id, const ShaderDesc &desc, const CachedShader &cached) override
  {
    if (cached.binary.empty()) {
      return false;
    }
    const GLuint program = glCreateProgram();
    glProgramBinary(program, cached.binary_format, cached.binary.data(), GLsizei(cached.binary.size()));
    GLint is_linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &is_linked);
    if (!is_linked) {
      // An older driver's, say: no error of the caller's.
      glDeleteProgram(program);
      driver_errors_.clear();
      return false;
    }
    label(GL_PROGRAM, program, desc.name);
    programs_[id] = program;
    return true;
  }

  void shader_binary(ResourceId id, CachedShader &cached) override
  {
    GLint size = 0;
    glGetProgramiv(programs_.at(id), GL_PROGRAM_BINARY_LENGTH, &size);
    cached.binary.resize(std::size_t(size));
    if (size > 0) {
      glGetProgramBinary(programs_.at(id), size, nullptr, &cached.binary_format, cached.binary.data());
    }
  }

  void timer_query_create(ResourceId id, const std::string & /*name*/) override
  {
    glCreateQueries(GL_TIMESTAMP, 2, timers_[id].data());
  }

  void resource_destroy(ResourceKind kind, ResourceId id) override
  {
    switch (kind) {
      case ResourceKind::Texture: glDeleteTextures(1, &textures_.at(id)); break;
      case ResourceKind::Sampler: glDeleteSamplers(1, &samplers_.at(id)); break;
      case ResourceKind::Framebuffer: {
        const GlFramebuffer &framebuffer = framebuffers_.at(id);
        glDeleteFramebuffers(1, &framebuffer.name);
        glDeleteTextures(GLsizei(framebuffer.views.size()), framebuffer.views.data());
        break;
      }
      case ResourceKind::Buffer: glDeleteBuffers(1, &buffers_.at(id).name); break;
      case ResourceKind::Shader: glDeleteProgram(programs_.at(id)); break;
      case ResourceKind::TimerQuery: glDeleteQueries(2, timers_.at(id).data()); break;
      case ResourceKind::Batch: break;
    }
  }

  void buffer_update(ResourceId id, std::size_t offset_bytes, std::span<const std::byte> bytes) override
  {
    glNamedBufferSubData(buffers_.at(id).name, GLintptr(offset_bytes), GLsizeiptr(bytes.size()), bytes.data());
  }

  void texture_upload(const Texture &texture, int layer, std::span<const std::byte> texels) override
  {
    const TextureDesc &desc = texture.desc();
    const GlFormat format = gl_format(desc.format);
    const GLuint name = textures_.at(texture.id());
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    for (const GLenum parameter : {GL_UNPACK_SWAP_BYTES, GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_ROWS,
                                   GL_UNPACK_SKIP_PIXELS, GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_IMAGES}) {
      glPixelStorei(parameter, 0);
    }
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    if (desc.kind == TextureKind::Flat) {
      glTextureSubImage2D(name, 0, 0, 0, desc.width, desc.height, format.format, format.type, texels.data());
    }
    else {
      glTextureSubImage3D(name, 0, 0, 0, layer, desc.width, desc.height, 1, format.format, format.type, texels.data());
    }
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    check(fmt::format("texture '{}'", desc.name));
  }

  void mipmaps_generate(const Texture &texture) override
  {
    glGenerateTextureMipmap(textures_.at(texture.id()));
    check(fmt::format("texture '{}'", texture.desc().name));
  }

  void layers_copy(const Texture &source, const Texture &target, glm::ivec2 size_px, int layers) override
  {
    const auto gl_kind = [](const Texture &texture) { return gl_target(texture.desc().kind); };
    glCopyImageSubData(textures_.at(source.id()), gl_kind(source), 0, 0, 0, 0, textures_.at(target.id()),
                       gl_kind(target), 0, 0, 0, 0, size_px.x, size_px.y, layers);
    check(fmt::format("copy of texture '{}'", source.desc().name));
  }

  void texture_read(const Texture &texture, int layer, std::span<std::byte> texels) override
  {
    const TextureDesc &desc = texture.desc();
    const GlFormat format = gl_format(desc.format);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    for (const GLenum parameter : {GL_PACK_SWAP_BYTES, GL_PACK_ROW_LENGTH, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS,
                                   GL_PACK_IMAGE_HEIGHT, GL_PACK_SKIP_IMAGES}) {
      glPixelStorei(parameter, 0);
    }
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    // In bands of rows, because GL counts the bytes of a read in 32 bits.
    constexpr std::size_t band_bytes_max = std::size_t(1) << 30U;
    const std::size_t row_bytes = texels.size() / std::size_t(desc.height);
    const int band_rows = int(std::max<std::size_t>(band_bytes_max / row_bytes, 1));
    for (int y = 0; y < desc.height; y += band_rows) {
      const int rows = std::min(band_rows, desc.height - y);
      const auto band = texels.subspan(std::size_t(y) * row_bytes, std::size_t(rows) * row_bytes);
      glGetTextureSubImage(textures_.at(texture.id()), 0, 0, y, layer, desc.width, rows, 1, format.format, format.type,
                           GLsizei(band.size()), band.data());
    }
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    check(fmt::format("texture '{}'", desc.name));
  }

  void list_submit(const CommandList &list) override;
  void upload_streams(const CommandList &list);
  void begin_pass(const CommandList::PassInfo &pass);
  void end_pass();
  void set_state(State state);
  void restore_defaults(const CommandList &list);

  static GLenum gl_stage(ShaderStage stage)
  {
    switch (stage) {
      case ShaderStage::Vertex: return GL_VERTEX_SHADER;
      case ShaderStage::Geometry: return GL_GEOMETRY_SHADER;
      case ShaderStage::Fragment: return GL_FRAGMENT_SHADER;
    }
    return GL_VERTEX_SHADER;
  }

  static void label(GLenum kind, GLuint name, const std::string &text)
  {
    glObjectLabel(kind, name, GLsizei(std::min<std::size_t>(text.size(), 255)), text.data());
  }

  void check_or_destroy(ResourceKind kind, ResourceId id, const std::string &what)
  {
    try {
      check(what);
    }
    catch (...) {
      resource_destroy(kind, id);
      throw;
    }
  }

  struct GlFramebuffer {
    GLuint name = 0;
    int color_count = 0;
    bool has_depth = false;
    glm::ivec2 size_px{0};
    /** Of attachments that are some layers of a texture. */
    std::vector<GLuint> views;
  };
  struct GlBuffer {
    GLuint name = 0;
    std::size_t size_bytes = 0;
  };

  std::unique_ptr<GlContext> context_;
  /** Driver errors come as messages; never in a host's context, whose messages go to the host. */
  bool is_debug_;
  std::vector<std::string> driver_errors_;

  std::unordered_map<ResourceId, GLuint> textures_;
  std::unordered_map<ResourceId, GLuint> samplers_;
  std::unordered_map<ResourceId, GlFramebuffer> framebuffers_;
  std::unordered_map<ResourceId, GlBuffer> buffers_;
  std::unordered_map<ResourceId, GLuint> programs_;
  std::unordered_map<ResourceId, std::array<GLuint, 2>> timers_;

  GLuint vertex_array_ = 0;
  GLuint empty_vertex_array_ = 0;
  std::array<GLuint, PoolCount> pool_{};
  std::size_t vertex_capacity_ = 0;
  std::size_t uv_capacity_ = 0;
  std::size_t index_capacity_ = 0;
  std::array<GLuint, StreamCount> streams_{};

  /** The pass between begin_pass and end_pass. */
  const CommandList::PassInfo *pass_ = nullptr;
};

/** Where the bytes of the \a ordinal-th PushConstants stand in the stream: each at an aligned offset. */
std::size_t push_stride(const Limits &limits, std::uint32_t count)
{
  const std::size_t alignment = limits.uniform_offset_alignment;
  return (count + alignment - 1) / alignment * alignment;
}

void GlDevice::upload_streams(const CommandList &list)
{
  const auto upload = [&](Stream stream, std::size_t bytes, const void *data) {
    if (bytes > 0) {
      glNamedBufferData(streams_[stream], GLsizeiptr(bytes), data, GL_STREAM_DRAW);
    }
  };
  upload(InstanceStream, list.instances.size() * sizeof(DrawInstance), list.instances.data());
  upload(IndirectStream, list.draws.size() * sizeof(DrawIndirect), list.draws.data());
  std::vector<std::byte> push;
  for (const Command &command : list.commands()) {
    if (command.kind == CommandKind::PushConstants) {
      const std::size_t end = push.size() + push_stride(limits(), command.count);
      const auto first = list.bytes().begin() + command.first;
      push.insert(push.end(), first, first + command.count);
      push.resize(end);
    }
  }
  upload(PushStream, push.size(), push.data());
}

void GlDevice::begin_pass(const CommandList::PassInfo &pass)
{
  const GlFramebuffer &framebuffer = framebuffers_.at(pass.framebuffer);
  if (is_debug_) {
    glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, GLsizei(std::min<std::size_t>(pass.name.size(), 255)),
                     pass.name.data());
  }
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer.name);
  const glm::ivec2 viewport_px =
      pass.actions.viewport_px == glm::ivec2(0) ? framebuffer.size_px : pass.actions.viewport_px;
  glViewport(0, 0, viewport_px.x, viewport_px.y);
  // Clears obey the write masks.
  set_state(State::WriteColor | State::WriteDepth);
  std::vector<GLenum> lost;
  for (int i = 0; i < framebuffer.color_count; i++) {
    if (pass.actions.color_load == LoadAction::Clear) {
      glClearNamedFramebufferfv(framebuffer.name, GL_COLOR, i, &pass.actions.clear_color[0]);
    }
    else if (pass.actions.color_load == LoadAction::DontCare) {
      lost.push_back(GL_COLOR_ATTACHMENT0 + GLenum(i));
    }
  }
  if (framebuffer.has_depth) {
    if (pass.actions.depth_load == LoadAction::Clear) {
      glClearNamedFramebufferfv(framebuffer.name, GL_DEPTH, 0, &pass.actions.clear_depth);
    }
    else if (pass.actions.depth_load == LoadAction::DontCare) {
      lost.push_back(GL_DEPTH_ATTACHMENT);
    }
  }
  if (!lost.empty()) {
    glInvalidateNamedFramebufferData(framebuffer.name, GLsizei(lost.size()), lost.data());
  }
  pass_ = &pass;
}

void GlDevice::end_pass()
{
  const GlFramebuffer &framebuffer = framebuffers_.at(pass_->framebuffer);
  std::vector<GLenum> lost;
  for (int i = 0; i < framebuffer.color_count && pass_->actions.color_store == StoreAction::DontCare; i++) {
    lost.push_back(GL_COLOR_ATTACHMENT0 + GLenum(i));
  }
  if (framebuffer.has_depth && pass_->actions.depth_store == StoreAction::DontCare) {
    lost.push_back(GL_DEPTH_ATTACHMENT);
  }
  if (!lost.empty()) {
    glInvalidateNamedFramebufferData(framebuffer.name, GLsizei(lost.size()), lost.data());
  }
  if (is_debug_) {
    glPopDebugGroup();
  }
  pass_ = nullptr;
}

void GlDevice::set_state(State state)
{
  const auto enable = [](GLenum capability, bool is_on) {
    if (is_on) {
      glEnable(capability);
    }
    else {
      glDisable(capability);
    }
  };
  const auto mask = GLboolean(has(state, State::WriteColor));
  glColorMask(mask, mask, mask, mask);
  glDepthMask(GLboolean(has(state, State::WriteDepth)));
  // Depth is written only while the test is on.
  const bool tests = has(state, State::DepthNearerEqual | State::DepthEqual);
  enable(GL_DEPTH_TEST, tests || has(state, State::WriteDepth));
  glDepthFunc(!tests ? GL_ALWAYS : has(state, State::DepthEqual) ? GL_EQUAL : GL_GEQUAL);
  enable(GL_CULL_FACE, has(state, State::CullBack | State::CullFront));
  glCullFace(has(state, State::CullFront) ? GL_FRONT : GL_BACK);
  glFrontFace(has(state, State::FrontClockwise) ? GL_CW : GL_CCW);
  const bool is_multiplied = has(state, State::BlendMultiply);
  enable(GL_BLEND, is_multiplied || has(state, State::BlendAdd));
  glBlendFunc(is_multiplied ? GL_DST_COLOR : GL_ONE, is_multiplied ? GL_ZERO : GL_ONE);
  glBlendEquation(GL_FUNC_ADD);
  enable(GL_DEPTH_CLAMP, has(state, State::DepthClamp));
}

void GlDevice::list_submit(const CommandList &list)
{
  upload_streams(list);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  for (const GLenum capability :
       {GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_POLYGON_OFFSET_FILL, GL_FRAMEBUFFER_SRGB, GL_RASTERIZER_DISCARD,
        GL_PRIMITIVE_RESTART, GL_SAMPLE_ALPHA_TO_COVERAGE, GL_COLOR_LOGIC_OP}) {
    glDisable(capability);
  }
  glDepthRange(0.0, 1.0);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, streams_[IndirectStream]);

  std::size_t push_offset = 0;
  for (const Command &command : list.commands()) {
    switch (command.kind) {
      case CommandKind::BeginPass: begin_pass(list.passes()[command.first]); break;
      case CommandKind::EndPass: end_pass(); break;
      case CommandKind::SetShader: glUseProgram(programs_.at(command.id)); break;
      case CommandKind::SetState: set_state(State(command.first)); break;
      case CommandKind::BindUniform:
      case CommandKind::BindStorage: {
        const GlBuffer &buffer = buffers_.at(command.id);
        const std::size_t size = command.count > 0 ? command.count : buffer.size_bytes - command.first;
        const auto kind = command.kind == CommandKind::BindUniform ? BufferKind::Uniform : BufferKind::Storage;
        glBindBufferRange(gl_target(kind), command.slot, buffer.name, GLintptr(command.first), GLsizeiptr(size));
        break;
      }
      case CommandKind::BindTexture:
        glBindTextureUnit(command.slot, command.id == 0 ? 0 : textures_.at(command.id));
        glBindSampler(command.slot, command.first == 0 ? 0 : samplers_.at(command.first));
        break;
      case CommandKind::PushConstants:
        glBindBufferRange(GL_UNIFORM_BUFFER, command.slot, streams_[PushStream], GLintptr(push_offset),
                          GLsizeiptr(command.count));
        push_offset += push_stride(limits(), command.count);
        break;
      case CommandKind::Draw:
        glBindVertexArray(vertex_array_);
        glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT,
                                    reinterpret_cast<const void *>(command.first * sizeof(DrawIndirect)),
                                    GLsizei(command.count), sizeof(DrawIndirect));
        break;
      case CommandKind::DrawProcedural:
        glBindVertexArray(empty_vertex_array_);
        glDrawArraysInstanced(GL_TRIANGLES, 0, GLsizei(command.first), GLsizei(command.count));
        break;
      case CommandKind::Update:
        buffer_update(command.id, command.slot, std::span(list.bytes()).subspan(command.first, command.count));
        break;
    }
  }
  if (!context_) {
    restore_defaults(list);
  }
  check("submit");
}

/** The host finds what was touched here at GL's initial values. */
void GlDevice::restore_defaults(const CommandList &list)
{
  for (const Command &command : list.commands()) {
    switch (command.kind) {
      case CommandKind::BindUniform:
      case CommandKind::PushConstants: glBindBufferBase(GL_UNIFORM_BUFFER, command.slot, 0); break;
      case CommandKind::BindStorage: glBindBufferBase(GL_SHADER_STORAGE_BUFFER, command.slot, 0); break;
      case CommandKind::BindTexture:
        // A sampler that stays would overrule the parameters of the host's textures.
        glBindTextureUnit(command.slot, 0);
        glBindSampler(command.slot, 0);
        break;
      default: break;
    }
  }
  glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  set_state(State::WriteColor | State::WriteDepth);
  glDisable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glBlendFunc(GL_ONE, GL_ZERO);
  glDisable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  glBindVertexArray(0);
  glUseProgram(0);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, 0);
}

}  // namespace

std::unique_ptr<Device> create_gl_device(const GlDeviceDesc &desc)
{
  std::unique_ptr<GlContext> context;
  if (desc.context == ContextKind::Headless) {
    // It would lose its place to the new one, and then draw, and free, in the wrong context.
    if (has_current_context()) {
      throw Error("a context is current on this thread already, of another device or of a host");
    }
    context = create_headless_context(desc.is_debug);
  }
  else if (!has_current_context()) {
    throw Error("no OpenGL context of the host's is current on this thread");
  }
  constexpr int version_needed = 45;
  const int version = epoxy_gl_version();
  if (version < version_needed) {
    throw Error("OpenGL {}.{} is needed, and the {} context has {}.{}", version_needed / 10, version_needed % 10,
                context ? "headless" : "host's", version / 10, version % 10);
  }
  return std::make_unique<GlDevice>(std::move(context), desc);
}

}  // namespace gnomon::gpu
