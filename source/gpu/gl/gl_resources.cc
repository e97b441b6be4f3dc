// SPDX-License-Identifier: MIT
#include "gl_device.hh"

#include "trace.hh"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace gnomon::gpu {

namespace {

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

}  // namespace

GLenum gl_target(TextureKind kind)
{
  switch (kind) {
    case TextureKind::Flat: return GL_TEXTURE_2D;
    case TextureKind::Array: return GL_TEXTURE_2D_ARRAY;
    case TextureKind::Buffer: return GL_TEXTURE_BUFFER;
  }
  return GL_TEXTURE_2D;
}

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
    case Format::Depth16: return {GL_DEPTH_COMPONENT16, GL_DEPTH_COMPONENT, GL_UNSIGNED_SHORT};
    case Format::Host: break;
  }
  return {};
}

GLuint GlDevice::create_buffer_of(GLenum target, std::size_t size_bytes)
{
  const GLuint buffer = names_.create_buffer();
  // Bound instead of using glNamedBufferData: llvmpipe delays updates until earlier draws have finished only if it
  // knows the buffer's target.
  host_state_.keep_buffer(target);
  glBindBuffer(target, buffer);
  glBufferData(target, GLsizeiptr(size_bytes), nullptr, GL_DYNAMIC_DRAW);
  return buffer;
}

void GlDevice::texture_create(ResourceId id, const TextureDesc &desc)
{
  const trace::Span span("create texture", desc.name);
  const Calls calls(*this);
  if (desc.format == Format::Host) {
    check_host_texture(desc);
    textures_.insert(id, {GLuint(desc.host.name), desc, 0});
    return;
  }
  const GLuint texture = names_.create_texture(gl_target(desc.kind));
  GLuint buffer = 0;
  const GLenum internal = gl_format(desc.format).internal;
  switch (desc.kind) {
    case TextureKind::Flat: glTextureStorage2D(texture, desc.mip_levels, internal, desc.width, desc.height); break;
    case TextureKind::Array:
      glTextureStorage3D(texture, desc.mip_levels, internal, desc.width, desc.height, desc.layers);
      break;
    case TextureKind::Buffer:
      buffer = create_buffer_of(GL_TEXTURE_BUFFER, desc.size_bytes());
      glTextureBuffer(texture, internal, buffer);
      label(GL_BUFFER, buffer, desc.name);
      break;
  }
  label(GL_TEXTURE, texture, desc.name);
  check_or(fmt::format("texture '{}'", desc.name), [&] {
    names_.delete_textures({&texture, 1});
    names_.delete_buffers({&buffer, 1});
  });
  textures_.insert(id, {texture, desc, buffer});
}

void GlDevice::check_host_texture(const TextureDesc &desc)
{
  const auto name = GLuint(desc.host.name);
  const auto refuse = [&](std::string_view why) {
    throw Error("texture '{}': texture {} of the host {}", desc.name, name, why);
  };
  if (context_) {
    refuse("is in another context than this device, which has one of its own");
  }
  if (!glIsTexture(name)) {
    refuse("does not exist in the current context");
  }
  const auto parameter = [&](GLenum what) {
    GLint value = 0;
    glGetTextureParameteriv(name, what, &value);
    return value;
  };
  const auto of_level = [&](GLint level, GLenum what) {
    GLint value = 0;
    glGetTextureLevelParameteriv(name, level, what, &value);
    return value;
  };
  if (parameter(GL_TEXTURE_TARGET) != GL_TEXTURE_2D) {
    refuse("is not of the target GL_TEXTURE_2D");
  }
  if (parameter(GL_TEXTURE_BASE_LEVEL) != 0) {
    refuse("has another base level than 0");
  }
  const glm::ivec2 size_px{of_level(0, GL_TEXTURE_WIDTH), of_level(0, GL_TEXTURE_HEIGHT)};
  if (size_px != glm::ivec2(desc.width, desc.height)) {
    refuse(fmt::format("has {}x{} texels, not {}x{}", size_px.x, size_px.y, desc.width, desc.height));
  }
  const GLint type = of_level(0, GL_TEXTURE_RED_TYPE);
  if (type != GL_FLOAT && type != GL_UNSIGNED_NORMALIZED && type != GL_SIGNED_NORMALIZED) {
    refuse("has no channel red of floats or of normalised integers");
  }
  GLint last = std::min(desc.mip_levels - 1, parameter(GL_TEXTURE_MAX_LEVEL));
  if (parameter(GL_TEXTURE_IMMUTABLE_FORMAT) == GL_TRUE) {
    last = std::min(last, parameter(GL_TEXTURE_IMMUTABLE_LEVELS) - 1);
  }
  for (GLint level = 1; level <= last; level++) {
    if (of_level(level, GL_TEXTURE_WIDTH) != std::max(desc.width >> level, 1) ||
        of_level(level, GL_TEXTURE_HEIGHT) != std::max(desc.height >> level, 1)) {
      refuse(fmt::format("has no mip level {}", level));
    }
  }
  check(fmt::format("texture '{}'", desc.name));
}

void GlDevice::sampler_create(ResourceId id, const SamplerDesc &desc)
{
  const Calls calls(*this);
  const GLuint sampler = names_.create_sampler();
  glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, gl_min_filter(desc.minified.value_or(desc.filter), desc.mip));
  glSamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, desc.filter == Filter::Linear ? GL_LINEAR : GL_NEAREST);
  glSamplerParameteri(sampler, GL_TEXTURE_WRAP_S, gl_wrap(desc.wrap_u));
  glSamplerParameteri(sampler, GL_TEXTURE_WRAP_T, gl_wrap(desc.wrap_v));
  glSamplerParameteri(sampler, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
  if (desc.anisotropy > 1) {
    glSamplerParameterf(sampler, GL_TEXTURE_MAX_ANISOTROPY, float(desc.anisotropy));
  }
  if (desc.is_depth_comparison) {
    glSamplerParameteri(sampler, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glSamplerParameteri(sampler, GL_TEXTURE_COMPARE_FUNC, GL_GEQUAL);
  }
  label(GL_SAMPLER, sampler, desc.name);
  samplers_.insert(id, sampler);
}

void GlDevice::attach(GLuint framebuffer, GLenum point, const AttachmentLayout &attachment, std::vector<GLuint> &views)
{
  const auto &[texture, desc, buffer] = textures_.at(attachment.texture);
  if (attachment.layer_count > 1) {
    const GLuint view = views.emplace_back(names_.create_texture_view());
    glTextureView(view, GL_TEXTURE_2D_ARRAY, texture, gl_format(desc.format).internal, 0, GLuint(desc.mip_levels),
                  GLuint(attachment.layer), GLuint(attachment.layer_count));
    glNamedFramebufferTexture(framebuffer, point, view, attachment.mip_level);
  }
  else if (attachment.layer == all_layers || desc.kind == TextureKind::Flat) {
    glNamedFramebufferTexture(framebuffer, point, texture, attachment.mip_level);
  }
  else {
    glNamedFramebufferTextureLayer(framebuffer, point, texture, attachment.mip_level, attachment.layer);
  }
}

void GlDevice::framebuffer_create(ResourceId id, const FramebufferLayout &layout)
{
  const Calls calls(*this);
  GlFramebuffer framebuffer;
  glCreateFramebuffers(1, &framebuffer.name);
  std::vector<GLenum> buffers;
  for (const AttachmentLayout &color : layout.colors) {
    buffers.push_back(GL_COLOR_ATTACHMENT0 + GLenum(buffers.size()));
    attach(framebuffer.name, buffers.back(), color, framebuffer.views);
  }
  glNamedFramebufferDrawBuffers(framebuffer.name, GLsizei(buffers.size()), buffers.data());
  if (layout.depth.texture != 0) {
    attach(framebuffer.name, GL_DEPTH_ATTACHMENT, layout.depth, framebuffer.views);
  }
  label(GL_FRAMEBUFFER, framebuffer.name, layout.name);
  framebuffer.color_count = GLuint(layout.colors.size());
  framebuffer.has_depth = layout.depth.texture != 0;
  framebuffer.size_px = layout.size_px;
  framebuffers_.insert(id, framebuffer);
  const GLenum status = glCheckNamedFramebufferStatus(framebuffer.name, GL_DRAW_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    resource_destroy(ResourceKind::Framebuffer, id);
    throw Error("framebuffer '{}': the driver cannot draw into these attachments (status 0x{:x})", layout.name, status);
  }
}

void GlDevice::buffer_create(ResourceId id, const BufferDesc &desc)
{
  const trace::Span span("create buffer", desc.name);
  const Calls calls(*this);
  const GLuint buffer = create_buffer_of(
      desc.kind == BufferKind::Uniform ? GL_UNIFORM_BUFFER : GL_SHADER_STORAGE_BUFFER, desc.size_bytes);
  label(GL_BUFFER, buffer, desc.name);
  check_or(fmt::format("buffer '{}'", desc.name), [&] { names_.delete_buffers({&buffer, 1}); });
  buffers_.insert(id, {buffer, desc.size_bytes, false});
}

void GlDevice::grow_pools(const BatchDesc &desc, const PoolSizes &sizes)
{
  PoolBuffers grown{};
  for (std::size_t i = 0; i < pool_count; i++) {
    if (sizes[i] > pool_size_[i]) {
      grown[i] = names_.create_buffer();
      glNamedBufferData(grown[i], GLsizeiptr(sizes[i]), nullptr, GL_STATIC_DRAW);
      label(GL_BUFFER, grown[i], i == index_pool ? "indices" : std::string(to_string(VertexStream(i))));
    }
  }
  // Replace the old buffers only after all new buffers were created successfully.
  check_or(fmt::format("batch '{}': {} bytes of vertices and {} of indices in all", desc.name,
                       std::reduce(sizes.begin(), sizes.begin() + vertex_stream_count), sizes[index_pool]),
           [&] { names_.delete_buffers(grown); });
  bool is_copied = false;
  for (std::size_t i = 0; i < pool_count; i++) {
    if (grown[i] != 0) {
      if (pool_[i] != 0) {
        glCopyNamedBufferSubData(pool_[i], grown[i], 0, 0, GLsizeiptr(pool_size_[i]));
        is_copied = true;
      }
      std::swap(pool_[i], grown[i]);
      pool_size_[i] = sizes[i];
    }
  }
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    const VertexFormat &format = vertex_formats()[i];
    if (pool_[i] != 0) {
      glEnableVertexArrayAttrib(shared_array_.name, format.attribute);
      glVertexArrayVertexBuffer(shared_array_.name, format.attribute, pool_[i], 0, GLsizei(format.size_bytes));
    }
  }
  glVertexArrayElementBuffer(shared_array_.name, pool_[index_pool]);
  names_.delete_buffers(grown);
  if (is_copied) {
    wait_for_copies();
  }
}

void GlDevice::wait_for_copies()
{
  // NVIDIA's driver (580.159) executes a large glBufferSubData before earlier copies into the same range. Neither
  // glFlush nor a memory barrier puts them in order.
  glFinish();
}

void GlDevice::batch_create(const BatchDesc &desc, const BatchRange &range, std::uint32_t vertex_capacity,
                            std::uint32_t index_capacity)
{
  const trace::Span span("create batch", desc.name);
  const Calls calls(*this);
  // The pool of a stream is created for the first batch with that stream. Only batches with the stream grow it.
  PoolSizes sizes = pool_size_;
  const auto need = [&sizes](std::size_t pool, std::size_t bytes) { sizes[pool] = std::max(sizes[pool], bytes); };
  // A batch without normals gets zeros.
  const std::vector<glm::vec3> zeros(desc.normals.empty() ? desc.positions.size() : 0, glm::vec3(0.0F));
  std::array<std::span<const std::byte>, vertex_stream_count> streams;
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    const bool is_zero = VertexStream(i) == VertexStream::Normal && desc.normals.empty();
    streams[i] = is_zero ? std::as_bytes(std::span(zeros)) : desc.bytes(VertexStream(i));
    need(i, streams[i].empty() ? 0 : std::size_t(vertex_capacity) * vertex_formats()[i].size_bytes);
  }
  need(index_pool, std::size_t(index_capacity) * sizeof(std::uint32_t));
  if (sizes != pool_size_) {
    grow_pools(desc, sizes);
  }
  const auto write = [&](std::size_t pool, std::size_t offset_bytes, std::span<const std::byte> bytes) {
    if (!bytes.empty()) {
      glNamedBufferSubData(pool_[pool], GLintptr(offset_bytes), GLsizeiptr(bytes.size()), bytes.data());
    }
  };
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    write(i, std::size_t(range.base_vertex) * vertex_formats()[i].size_bytes, streams[i]);
  }
  write(index_pool, std::size_t(range.first_index) * sizeof(std::uint32_t), std::as_bytes(desc.indices));
  check(fmt::format("batch '{}'", desc.name));
}

void GlDevice::batch_update(std::uint32_t first_vertex, const BatchDesc &values)
{
  const Calls calls(*this);
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    const std::span<const std::byte> bytes = values.bytes(VertexStream(i));
    if (!bytes.empty()) {
      glNamedBufferSubData(pool_[i], GLintptr(first_vertex) * GLintptr(vertex_formats()[i].size_bytes),
                           GLsizeiptr(bytes.size()), bytes.data());
    }
  }
}

void GlDevice::host_batch_create(ResourceId id, const std::string &name, const HostBatch &batch)
{
  const Calls calls(*this);
  if (context_) {
    throw Error("batch '{}': the host's buffers are in another context than this device, which has one of its own",
                name);
  }
  const auto check_size = [&](std::string_view what, GLuint buffer, std::size_t end) {
    if (!glIsBuffer(buffer)) {
      throw Error("batch '{}': buffer {} of the host, with its {}, does not exist in the current context", name, buffer,
                  what);
    }
    GLint64 size = 0;
    glGetNamedBufferParameteri64v(buffer, GL_BUFFER_SIZE, &size);
    if (end > std::size_t(size)) {
      throw Error("batch '{}': buffer {} of the host has {} bytes, and its {} end at byte {}", name, buffer, size, what,
                  end);
    }
  };
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    const HostStream &stream = batch.stream(VertexStream(i));
    if (stream.buffer != 0 && batch.vertex_count > 0) {
      const std::size_t vertex_bytes = std::size_t(vertex_formats()[i].component_count) * gpu::size_bytes(stream.type);
      check_size(to_string(VertexStream(i)), GLuint(stream.buffer),
                 stream.offset_bytes + std::size_t(batch.vertex_count - 1) * stream.stride_bytes + vertex_bytes);
    }
  }
  check_size("indices", GLuint(batch.index_buffer),
             batch.index_offset_bytes + std::size_t(batch.index_count) * batch.index_size_bytes());
  if (host_array_.name == 0) {
    host_array_ = create_instanced_array();
    for (const VertexFormat &format : vertex_formats()) {
      glEnableVertexArrayAttrib(host_array_.name, format.attribute);
    }
    constexpr std::array<float, 8> values = {0, 0, 0, 0, 1, 1, 1, 1};
    absent_streams_ = names_.create_buffer();
    glNamedBufferStorage(absent_streams_, sizeof(values), values.data(), 0);
    label(GL_VERTEX_ARRAY, host_array_.name, "batches of the host");
    label(GL_BUFFER, absent_streams_, "absent streams");
  }
  check(fmt::format("batch '{}'", name));
  host_batches_.insert(id, batch);
}

void GlDevice::timer_query_create(ResourceId id, const std::string &name)
{
  timers_.insert(id, Timer{name, {}, {}});
}

void GlDevice::resource_destroy(ResourceKind kind, ResourceId id)
{
  if (is_abandoned_) {
    return;
  }
  const Calls calls(*this);
  switch (kind) {
    case ResourceKind::Texture:
      if (const TextureDesc &desc = textures_.at(id).desc; desc.format != Format::Host) {
        destroyed_bytes_ += std::size_t(desc.width) * std::size_t(desc.height) * std::size_t(desc.layers) *
                            std::size_t(texel_size_bytes(desc.format));
        names_.delete_textures({&textures_.at(id).name, 1});
        names_.delete_buffers({&textures_.at(id).buffer, 1});
      }
      textures_.erase(id);
      break;
    case ResourceKind::Sampler:
      names_.delete_samplers({&samplers_.at(id), 1});
      samplers_.erase(id);
      break;
    case ResourceKind::Framebuffer: {
      const GlFramebuffer &framebuffer = framebuffers_.at(id);
      glDeleteFramebuffers(1, &framebuffer.name);
      names_.delete_textures(framebuffer.views);
      framebuffers_.erase(id);
      break;
    }
    case ResourceKind::Buffer:
      names_.delete_buffers({&buffers_.at(id).name, 1});
      buffers_.erase(id);
      break;
    case ResourceKind::Shader:
      glDeleteProgram(programs_.at(id).name);
      programs_.erase(id);
      break;
    case ResourceKind::TimerQuery: {
      Timer &timer = timers_.at(id);
      timer.unused.insert(timer.unused.end(), timer.pending.begin(), timer.pending.end());
      for (const TimeMarks &marks : timer.unused) {
        glDeleteQueries(2, marks.data());
      }
      timers_.erase(id);
      break;
    }
    case ResourceKind::Batch: host_batches_.erase(id); break;
  }
}

bool GlDevice::driver_trim()
{
  constexpr std::size_t notable_bytes = std::size_t(1) << 20U;
  if (is_lost_ || destroyed_bytes_ < notable_bytes) {
    return false;
  }
  destroyed_bytes_ = 0;
  if (limits().is_software) {
    // llvmpipe has a queue of up to 64 framebuffers to draw. An entry refers to its attachments and textures until it
    // is used again, also after their deletion, and the driver takes the first one that is idle, so that later ones can
    // keep hundreds of megabytes. A large clear keeps the rasteriser busy, so that the small ones after it reach all
    // entries; twice, as a thread that waits for a busy machine may submit them too late.
    constexpr int queue_size = 64;
    std::array<GLuint, 2> renderbuffers = {};
    std::array<GLuint, 2> framebuffers = {};
    glCreateRenderbuffers(2, renderbuffers.data());
    glCreateFramebuffers(2, framebuffers.data());
    constexpr std::array<int, 2> sizes_px = {2048, 64};
    for (std::size_t i = 0; i < sizes_px.size(); i++) {
      glNamedRenderbufferStorage(renderbuffers[i], GL_R8, sizes_px[i], sizes_px[i]);
      glNamedFramebufferRenderbuffer(framebuffers[i], GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, renderbuffers[i]);
    }
    const glm::vec4 black(0.0F);
    for (int time = 0; time < 2; time++) {
      glFinish();
      for (int i = 0; i < queue_size; i++) {
        glClearNamedFramebufferfv(framebuffers[i == 0 ? 0 : 1], GL_COLOR, 0, &black.x);
        glFlush();
      }
    }
    glDeleteFramebuffers(2, framebuffers.data());
    glDeleteRenderbuffers(2, renderbuffers.data());
    glFinish();
  }
  return true;
}

void GlDevice::buffer_update(ResourceId id, std::size_t offset_bytes, std::span<const std::byte> bytes)
{
  const Calls calls(*this);
  GlBuffer &buffer = buffers_.at(id);
  if (std::exchange(buffer.is_copied_into, false)) {
    wait_for_copies();
  }
  glNamedBufferSubData(buffer.name, GLintptr(offset_bytes), GLsizeiptr(bytes.size()), bytes.data());
}

void GlDevice::texture_upload(ResourceId id, int layer, std::span<const std::byte> texels)
{
  const Calls calls(*this);
  host_state_.keep_pixel_store(PixelTransfer::Unpack);
  const auto &[name, desc, buffer] = textures_.at(id);
  const GlFormat format = gl_format(desc.format);
  switch (desc.kind) {
    case TextureKind::Flat:
      for (int level = 0; !texels.empty(); level++) {
        const int width = std::max(desc.width >> level, 1);
        const int height = std::max(desc.height >> level, 1);
        glTextureSubImage2D(name, level, 0, 0, width, height, format.format, format.type, texels.data());
        texels = texels.subspan(std::size_t(width) * std::size_t(height) * std::size_t(texel_size_bytes(desc.format)));
      }
      break;
    case TextureKind::Array:
      glTextureSubImage3D(name, 0, 0, 0, layer, desc.width, desc.height, 1, format.format, format.type, texels.data());
      break;
    case TextureKind::Buffer: glNamedBufferSubData(buffer, 0, GLsizeiptr(texels.size()), texels.data()); break;
  }
  check(fmt::format("texture '{}'", desc.name));
}

void GlDevice::mipmaps_generate(ResourceId id)
{
  const Calls calls(*this);
  const auto &[name, desc, buffer] = textures_.at(id);
  const std::string what = fmt::format("texture '{}'", desc.name);
  check_host_state(what);
  glGenerateTextureMipmap(name);
  check(what);
}

void GlDevice::layers_copy(ResourceId source, ResourceId target, glm::ivec2 size_px, int layers)
{
  const Calls calls(*this);
  const GlTexture &from = textures_.at(source);
  const GlTexture &to = textures_.at(target);
  glCopyImageSubData(from.name, gl_target(from.desc.kind), 0, 0, 0, 0, to.name, gl_target(to.desc.kind), 0, 0, 0, 0,
                     size_px.x, size_px.y, layers);
  check(fmt::format("copy of texture '{}'", from.desc.name));
}

void GlDevice::texture_read(ResourceId id, int layer, std::span<std::byte> texels)
{
  const Calls calls(*this);
  host_state_.keep_pixel_store(PixelTransfer::Pack);
  const auto &[name, desc, buffer] = textures_.at(id);
  if (desc.kind == TextureKind::Buffer) {
    glGetNamedBufferSubData(buffer, 0, GLsizeiptr(texels.size()), texels.data());
    check(fmt::format("texture '{}'", desc.name));
    return;
  }
  const GlFormat format = gl_format(desc.format);
  // Read bands of rows, because OpenGL counts the bytes of a read with 32 bits.
  constexpr std::size_t band_bytes_max = std::size_t(1) << 30U;
  const std::size_t row_bytes = texels.size() / std::size_t(desc.height);
  const int band_rows = int(std::max<std::size_t>(band_bytes_max / row_bytes, 1));
  for (int y = 0; y < desc.height; y += band_rows) {
    const int rows = std::min(band_rows, desc.height - y);
    const auto band = texels.subspan(std::size_t(y) * row_bytes, std::size_t(rows) * row_bytes);
    glGetTextureSubImage(name, 0, 0, y, layer, desc.width, rows, 1, format.format, format.type, GLsizei(band.size()),
                         band.data());
  }
  check(fmt::format("texture '{}'", desc.name));
}

}  // namespace gnomon::gpu
