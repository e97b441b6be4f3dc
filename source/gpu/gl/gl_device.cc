// SPDX-License-Identifier: MIT
#include "gl_device.hh"

#include "draw_object_shared.h"
#include "slots_shared.h"
#include "trace.hh"

#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>

namespace gnomon::gpu {

namespace {

/** glGetString(); "?" if the driver has none. */
const char *driver_string(GLenum name)
{
  const GLubyte *value = glGetString(name);
  return value ? reinterpret_cast<const char *>(value) : "?";
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
  limits.buffer_texels_max = get(GL_MAX_TEXTURE_BUFFER_SIZE);
  limits.uniform_block_bytes_max = std::size_t(get(GL_MAX_UNIFORM_BLOCK_SIZE));
  limits.storage_block_bytes_max = std::size_t(get(GL_MAX_SHADER_STORAGE_BLOCK_SIZE));
  // They are a uniform block.
  limits.push_constant_bytes_max = limits.uniform_block_bytes_max;
  limits.color_attachment_max = std::min(get(GL_MAX_COLOR_ATTACHMENTS), get(GL_MAX_DRAW_BUFFERS));
  // OpenGL 4.6 has it; before, only extensions have. Drivers with the later GL_ARB_texture_filter_anisotropic have this
  // one, too, and Mesa accepts the query with this one only.
  if (epoxy_gl_version() >= 46 || epoxy_has_gl_extension("GL_EXT_texture_filter_anisotropic")) {
    limits.anisotropy_max = std::max(get(GL_MAX_TEXTURE_MAX_ANISOTROPY), 1);
  }
  else {
    limits.anisotropy_max = 1;
  }
  limits.uniform_offset_alignment =
      std::uint32_t(std::max(get(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT), get(GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT)));
  // In the order of ShaderStage.
  limits.stages = {{{get(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS), get(GL_MAX_VERTEX_UNIFORM_BLOCKS),
                     get(GL_MAX_VERTEX_TEXTURE_IMAGE_UNITS)},
                    {get(GL_MAX_GEOMETRY_SHADER_STORAGE_BLOCKS), get(GL_MAX_GEOMETRY_UNIFORM_BLOCKS),
                     get(GL_MAX_GEOMETRY_TEXTURE_IMAGE_UNITS)},
                    {get(GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS), get(GL_MAX_FRAGMENT_UNIFORM_BLOCKS),
                     get(GL_MAX_TEXTURE_IMAGE_UNITS)}}};
  constexpr int components_of_location = 4;
  limits.varying_location_max =
      std::min(get(GL_MAX_VERTEX_OUTPUT_COMPONENTS), get(GL_MAX_FRAGMENT_INPUT_COMPONENTS)) / components_of_location;
  const std::string_view name = driver_string(GL_RENDERER);
  limits.is_software = name.starts_with("llvmpipe") || name.starts_with("softpipe");
  limits.has_vertex_layer = epoxy_has_gl_extension("GL_ARB_shader_viewport_layer_array");
  return limits;
}

}  // namespace

void GlDevice::calls_begin()
{
  check_can_execute();
  if (calls_depth_++ == 0 && !context_) {
    host_errors_ = take_gl_errors();
  }
}

void GlDevice::calls_end()
{
  if (--calls_depth_ > 0 || context_) {
    return;
  }
  host_state_.restore();
  // Clear the errors of this device, so that the host does not read them as its own.
  for (const GLenum error : take_gl_errors()) {
    message(fmt::format("the driver reports {}", gl_error_name(error)));
  }
  for (const GLenum error : host_errors_) {
    if (!raise_gl_error(error)) {
      message(fmt::format("an error of the host was pending and cannot be raised again: {}", gl_error_name(error)));
    }
  }
  host_errors_.clear();
}

GlDevice::GlDevice(std::unique_ptr<GlContext> context, const GlDeviceDesc &desc)
    : Device(query_limits(), desc.sink, desc.shader_cache_folder),
      context_(std::move(context)),
      is_debug_(desc.is_debug && context_),
      has_pass_groups_(context_ || epoxy_has_gl_extension("GL_EXT_debug_tool")),
      host_state_(!context_, names_)
{
  const Calls calls(*this);
  if (is_debug_) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(&GlDevice::receive_message, this);
  }
  has_unsound_depth_clears_ = std::string_view(driver_string(GL_VENDOR)) == "NVIDIA Corporation";
  glGetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &timestamp_bits_);
  create_vertex_arrays();
  glCreateFramebuffers(1, &other_framebuffer_);
  label(GL_FRAMEBUFFER, other_framebuffer_, "copies");
}

GlDevice::~GlDevice()
{
  if (!can_execute()) {
    // The names of its objects may be those of others in the current context.
    message(
        "the device is destroyed while the context in which it was made is not current on this thread: its objects "
        "are not deleted");
    is_abandoned_ = true;
    free_live_resources();
    return;
  }
  const Calls calls(*this);
  free_live_resources();
  stream_.destroy();
  names_.delete_buffers(pool_);
  names_.delete_buffers({&absent_streams_, 1});
  glDeleteVertexArrays(1, &shared_array_.name);
  glDeleteVertexArrays(1, &host_array_.name);
  glDeleteVertexArrays(1, &empty_vertex_array_);
  glDeleteFramebuffers(1, &other_framebuffer_);
  for (const auto &dummies : dummies_) {
    for (const Dummy &one : dummies) {
      names_.delete_textures({&one.texture, 1});
      names_.delete_samplers({&one.sampler, 1});
    }
  }
  if (probe_query_) {
    glDeleteQueries(1, &probe_query_);
  }
  if (is_debug_) {
    glDebugMessageCallback(nullptr, nullptr);
  }
}

GlVertexType gl_vertex_type(VertexType type)
{
  switch (type) {
    case VertexType::Float: return {GL_FLOAT, GL_FALSE};
    case VertexType::Half: return {GL_HALF_FLOAT, GL_FALSE};
    case VertexType::Snorm8: return {GL_BYTE, GL_TRUE};
    case VertexType::Unorm8: return {GL_UNSIGNED_BYTE, GL_TRUE};
    case VertexType::Snorm16: return {GL_SHORT, GL_TRUE};
    case VertexType::Unorm16: return {GL_UNSIGNED_SHORT, GL_TRUE};
  }
  return {};
}

GlDevice::VertexArray GlDevice::create_instanced_array()
{
  GLuint array = 0;
  glCreateVertexArrays(1, &array);
  for (const VertexFormat &format : vertex_formats()) {
    glVertexArrayAttribBinding(array, format.attribute, format.attribute);
  }
  glEnableVertexArrayAttrib(array, ATTRIBUTE_DRAW_INSTANCE);
  glVertexArrayAttribIFormat(array, ATTRIBUTE_DRAW_INSTANCE, 2, GL_UNSIGNED_INT, 0);
  glVertexArrayAttribBinding(array, ATTRIBUTE_DRAW_INSTANCE, ATTRIBUTE_DRAW_INSTANCE);
  glVertexArrayBindingDivisor(array, ATTRIBUTE_DRAW_INSTANCE, 1);
  // bind_instances() enables the attributes of an object.
  const auto of_object = [&](GLuint attribute, GLint component_count, std::size_t offset_bytes) {
    glVertexArrayAttribFormat(array, attribute, component_count, GL_FLOAT, GL_FALSE, GLuint(offset_bytes));
    glVertexArrayAttribBinding(array, attribute, ATTRIBUTE_WORLD_FROM_OBJECT);
  };
  for (GLuint column = 0; column < 4; column++) {
    of_object(ATTRIBUTE_WORLD_FROM_OBJECT + column, 4,
              offsetof(shared::ObjectData, world_from_object) + column * sizeof(glm::vec4));
  }
  of_object(ATTRIBUTE_OBJECT_NORMAL_X, 3, offsetof(shared::ObjectData, normal_x));
  of_object(ATTRIBUTE_OBJECT_NORMAL_Y, 3, offsetof(shared::ObjectData, normal_y));
  of_object(ATTRIBUTE_OBJECT_NORMAL_Z, 3, offsetof(shared::ObjectData, normal_z));
  glVertexArrayAttribIFormat(array, ATTRIBUTE_OBJECT_VALUE, 1, GL_UNSIGNED_INT, offsetof(shared::ObjectData, value));
  glVertexArrayAttribBinding(array, ATTRIBUTE_OBJECT_VALUE, ATTRIBUTE_WORLD_FROM_OBJECT);
  glVertexArrayBindingDivisor(array, ATTRIBUTE_WORLD_FROM_OBJECT, 1);
  return {array};
}

void GlDevice::create_vertex_arrays()
{
  shared_array_ = create_instanced_array();
  label(GL_VERTEX_ARRAY, shared_array_.name, "batches");
  // grow_pools() enables the attribute of a stream when the first batch has that stream.
  for (const VertexFormat &format : vertex_formats()) {
    const auto [type, is_normalized] = gl_vertex_type(format.type);
    glVertexArrayAttribFormat(shared_array_.name, format.attribute, format.component_count, type, is_normalized, 0);
  }
  // Procedural draws need a vertex array, too, but one that does not read the attributes of batches.
  glCreateVertexArrays(1, &empty_vertex_array_);
  label(GL_VERTEX_ARRAY, empty_vertex_array_, "procedural");
}

void GlDevice::finish()
{
  const trace::Span span("wait for the device");
  const Calls calls(*this);
  glFinish();
  check("finish");
}

void GlDevice::time_mark(ResourceId query, bool is_end)
{
  const Calls calls(*this);
  Timer &timer = timers_.at(query);
  // A begin whose end was not executed, because a packet failed between them, is marked again.
  if (!is_end && !std::exchange(timer.has_begun, true)) {
    // So that they do not grow in number if nobody takes the times.
    read_times(timer, false);
    if (timer.unused.empty()) {
      const auto &marks = timer.unused.emplace_back();
      glCreateQueries(GL_TIMESTAMP, 2, timer.unused.back().data());
      label(GL_QUERY, marks[0], timer.name + " begin");
      label(GL_QUERY, marks[1], timer.name + " end");
    }
    timer.pending.push_back(timer.unused.back());
    timer.unused.pop_back();
  }
  if (timer.has_begun) {
    glQueryCounter(timer.pending.back()[is_end ? 1 : 0], GL_TIMESTAMP);
    timer.has_begun = !is_end;
  }
}

void GlDevice::read_times(Timer &timer, bool waits)
{
  if (timer.pending.empty()) {
    return;
  }
  // If a buffer were bound to this target, the results would be written into that buffer.
  host_state_.keep_buffer(GL_QUERY_BUFFER);
  glBindBuffer(GL_QUERY_BUFFER, 0);
  while (timer.pending.size() > (timer.has_begun ? 1 : 0)) {
    const TimeMarks marks = timer.pending.front();
    GLuint is_available = GL_TRUE;
    if (!waits) {
      glGetQueryObjectuiv(marks[1], GL_QUERY_RESULT_AVAILABLE, &is_available);
    }
    if (!is_available) {
      return;
    }
    std::array<GLuint64, 2> nanoseconds{};
    for (std::size_t i = 0; i < 2; i++) {
      glGetQueryObjectui64v(marks[i], GL_QUERY_RESULT, &nanoseconds[i]);
    }
    timer.seconds += double(elapsed_ticks(nanoseconds[0], nanoseconds[1], timestamp_bits_)) * 1e-9;
    timer.pending.erase(timer.pending.begin());
    timer.unused.push_back(marks);
  }
}

std::optional<double> GlDevice::seconds_take(ResourceId query)
{
  if (timestamp_bits_ == 0) {
    return std::nullopt;
  }
  const Calls calls(*this);
  Timer &timer = timers_.at(query);
  read_times(timer, true);
  return std::exchange(timer.seconds, 0.0);
}

std::string GlDevice::description() const
{
  return fmt::format("OpenGL {}, {} ({})", driver_string(GL_VERSION), driver_string(GL_RENDERER),
                     context_ ? context_->description() : "host's context");
}

void GLAPIENTRY GlDevice::receive_message(GLenum /*source*/, GLenum type, GLuint /*id*/, GLenum severity,
                                          GLsizei /*length*/, const GLchar *text, const void *user)
{
  // Exceptions must not propagate through the driver, so errors are stored until check().
  auto *device = static_cast<GlDevice *>(const_cast<void *>(user));
  if (type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR) {
    device->driver_errors_.emplace_back(text);
  }
  else if (severity == GL_DEBUG_SEVERITY_HIGH) {
    device->message(fmt::format("driver: {}", text));
  }
}

void GlDevice::check(std::string_view what)
{
  std::vector<std::string> errors = std::exchange(driver_errors_, {});
  const bool has_messages = !errors.empty();
  bool is_out_of_memory = false;
  for (const GLenum error : take_gl_errors()) {
    is_out_of_memory = is_out_of_memory || error == GL_OUT_OF_MEMORY;
    is_lost_ = is_lost_ || error == GL_CONTEXT_LOST;
    if (!has_messages) {
      errors.push_back(gl_error_name(error));
    }
  }
  is_lost_ = is_lost_ || glGetGraphicsResetStatus() != GL_NO_ERROR;
  if (is_lost_) {
    throw DeviceLost("{}: the OpenGL context is lost; create a new device", what);
  }
  if (is_out_of_memory) {
    throw TransientError("{}: the driver is out of memory", what);
  }
  if (!errors.empty()) {
    throw Error("{}: the driver reports: {}", what, fmt::join(errors, "; "));
  }
}

void GlDevice::check_or(std::string_view what, const std::function<void()> &destroy)
{
  try {
    check(what);
  }
  catch (...) {
    destroy();
    throw;
  }
}

void GlDevice::check_host_state([[maybe_unused]] std::string_view what)
{
#ifndef NDEBUG
  if (!context_) {
    const std::string reason = unsaveable_state(probe_query_);
    if (!reason.empty()) {
      throw Error("{}: {}; this state cannot be saved", what, reason);
    }
  }
#endif
}

void GlDevice::label(GLenum kind, GLuint name, const std::string &text)
{
  glObjectLabel(kind, name, GLsizei(std::min<std::size_t>(text.size(), 255)), text.data());
}

std::unique_ptr<Device> create_gl_device(const GlDeviceDesc &desc)
{
  std::unique_ptr<GlContext> context;
  if (desc.context == ContextKind::Headless) {
    // The new context would become current instead, and the owner of the other context would use the wrong one.
    if (current_context()) {
      throw Error("another context, of a device or of the host, is already current on this thread");
    }
    context = create_headless_context(desc.is_debug);
  }
  else if (!current_context()) {
    throw Error("no OpenGL context of the host is current on this thread");
  }
  constexpr int version_needed = 45;
  const int version = epoxy_gl_version();
  if (version < version_needed) {
    throw TransientError("OpenGL {}.{} is needed, but the {} context has {}.{}", version_needed / 10,
                         version_needed % 10, context ? "headless" : "host's", version / 10, version % 10);
  }
  return std::make_unique<GlDevice>(std::move(context), desc);
}

}  // namespace gnomon::gpu
