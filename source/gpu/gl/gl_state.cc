// SPDX-License-Identifier: MIT
#include "gl_state.hh"

#include <fmt/format.h>

#include <algorithm>

namespace gnomon::gpu {

namespace {

/** Capabilities that are disabled at the begin of a command list. Lists enable some of them. */
constexpr std::array<GLenum, 28> used_capabilities = {
    GL_COLOR_LOGIC_OP,
    GL_CULL_FACE,
    GL_DEPTH_CLAMP,
    GL_DEPTH_TEST,
    GL_DITHER,
    GL_FRAMEBUFFER_SRGB,
    GL_LINE_SMOOTH,
    GL_POLYGON_OFFSET_FILL,
    GL_POLYGON_OFFSET_LINE,
    GL_POLYGON_SMOOTH,
    GL_PRIMITIVE_RESTART,
    GL_PRIMITIVE_RESTART_FIXED_INDEX,
    GL_RASTERIZER_DISCARD,
    GL_SAMPLE_ALPHA_TO_COVERAGE,
    GL_SAMPLE_ALPHA_TO_ONE,
    GL_SAMPLE_COVERAGE,
    GL_SAMPLE_MASK,
    GL_SAMPLE_SHADING,
    GL_STENCIL_TEST,
    GL_CLIP_DISTANCE0,
    GL_CLIP_DISTANCE1,
    GL_CLIP_DISTANCE2,
    GL_CLIP_DISTANCE3,
    GL_CLIP_DISTANCE4,
    GL_CLIP_DISTANCE5,
    GL_CLIP_DISTANCE6,
    GL_CLIP_DISTANCE7,
    GL_PROGRAM_POINT_SIZE,
};

constexpr std::array<GLenum, 8> unpack_parameters = {GL_UNPACK_ALIGNMENT,    GL_UNPACK_SWAP_BYTES,  GL_UNPACK_LSB_FIRST,
                                                     GL_UNPACK_ROW_LENGTH,   GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_ROWS,
                                                     GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_IMAGES};
constexpr std::array<GLenum, 8> pack_parameters = {GL_PACK_ALIGNMENT,    GL_PACK_SWAP_BYTES,  GL_PACK_LSB_FIRST,
                                                   GL_PACK_ROW_LENGTH,   GL_PACK_SKIP_PIXELS, GL_PACK_SKIP_ROWS,
                                                   GL_PACK_IMAGE_HEIGHT, GL_PACK_SKIP_IMAGES};

constexpr std::array<GLenum, 4> blend_functions = {GL_BLEND_SRC_RGB, GL_BLEND_DST_RGB, GL_BLEND_SRC_ALPHA,
                                                   GL_BLEND_DST_ALPHA};
constexpr std::array<GLenum, 2> blend_equations = {GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA};

GLint integer(GLenum name)
{
  // Some drivers return two values for GL_POLYGON_MODE.
  std::array<GLint, 2> values{};
  glGetIntegerv(name, values.data());
  return values[0];
}

GLenum binding_of(GLenum buffer_target)
{
  switch (buffer_target) {
    case GL_PIXEL_PACK_BUFFER: return GL_PIXEL_PACK_BUFFER_BINDING;
    case GL_PIXEL_UNPACK_BUFFER: return GL_PIXEL_UNPACK_BUFFER_BINDING;
    case GL_QUERY_BUFFER: return GL_QUERY_BUFFER_BINDING;
    case GL_UNIFORM_BUFFER: return GL_UNIFORM_BUFFER_BINDING;
    case GL_SHADER_STORAGE_BUFFER: return GL_SHADER_STORAGE_BUFFER_BINDING;
    case GL_TEXTURE_BUFFER: return GL_TEXTURE_BUFFER_BINDING;
    case GL_DRAW_INDIRECT_BUFFER: return GL_DRAW_INDIRECT_BUFFER_BINDING;
    default: return GL_NONE;
  }
}

using IsObject = GLboolean (*)(GLuint name);

/** The name that is bound at \a binding; 0 if there is no such object any more. \see HostState */
GLuint bound_name(GLenum binding, IsObject is_object)
{
  const auto name = GLuint(integer(binding));
  return name != 0 && is_object(name) == GL_TRUE ? name : 0;
}

void set_capability(GLenum capability, bool is_enabled)
{
  if (is_enabled) {
    glEnable(capability);
  }
  else {
    glDisable(capability);
  }
}

GLint program_parameter(GLuint program, GLenum name)
{
  GLint value = 0;
  glGetProgramiv(program, name, &value);
  return value;
}

/**
 * Without a program, OpenGL uses the bound pipeline. Mesa fails to do so if the pipeline was deleted while a program
 * was in use, and does not unbind it until another one is bound.
 */
void use_program(GLuint program)
{
  const auto pipeline = GLuint(integer(GL_PROGRAM_PIPELINE_BINDING));
  if (program != 0 || pipeline == 0 || glIsProgramPipeline(pipeline) == GL_TRUE) {
    glUseProgram(program);
    return;
  }
  GLuint other = 0;
  glCreateProgramPipelines(1, &other);
  glBindProgramPipeline(other);
  glUseProgram(0);
  glBindProgramPipeline(0);
  glDeleteProgramPipelines(1, &other);
}

GLenum texture_binding_of(GLenum texture_target)
{
  switch (texture_target) {
    case GL_TEXTURE_2D: return GL_TEXTURE_BINDING_2D;
    case GL_TEXTURE_2D_ARRAY: return GL_TEXTURE_BINDING_2D_ARRAY;
    case GL_TEXTURE_BUFFER: return GL_TEXTURE_BINDING_BUFFER;
    default: return GL_NONE;
  }
}

bool is_of_target(GLuint texture, GLenum target)
{
  GLint value = 0;
  glGetTextureParameteriv(texture, GL_TEXTURE_TARGET, &value);
  return GLenum(value) == target;
}

const std::array<GLenum, 8> &pixel_parameters(PixelTransfer transfer)
{
  return transfer == PixelTransfer::Pack ? pack_parameters : unpack_parameters;
}

/** Tightly packed rows. */
void set_pixel_store(PixelTransfer transfer)
{
  for (const GLenum parameter : pixel_parameters(transfer)) {
    const bool is_alignment = parameter == GL_PACK_ALIGNMENT || parameter == GL_UNPACK_ALIGNMENT;
    glPixelStorei(parameter, is_alignment ? 1 : 0);
  }
}

/** Sets all state that affects draws and clears and that command lists do not set themselves. */
void set_draw_defaults()
{
  for (const GLenum capability : used_capabilities) {
    glDisable(capability);
  }
  // Disable the test for all viewports: if it is enabled for one of them, Mesa 22.3 drops draws into the others.
  glDisable(GL_SCISSOR_TEST);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glDepthRangeIndexed(0, 0.0, 1.0);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glLineWidth(1.0F);
  glPointSize(1.0F);
  glProvokingVertex(GL_LAST_VERTEX_CONVENTION);
}

}  // namespace

std::string gl_error_name(GLenum error)
{
  switch (error) {
    case GL_INVALID_ENUM: return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE: return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION: return "GL_INVALID_OPERATION";
    case GL_STACK_OVERFLOW: return "GL_STACK_OVERFLOW";
    case GL_STACK_UNDERFLOW: return "GL_STACK_UNDERFLOW";
    case GL_OUT_OF_MEMORY: return "GL_OUT_OF_MEMORY";
    case GL_INVALID_FRAMEBUFFER_OPERATION: return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_CONTEXT_LOST: return "GL_CONTEXT_LOST";
    default: return fmt::format("error 0x{:x}", error);
  }
}

std::vector<GLenum> take_gl_errors()
{
  std::vector<GLenum> errors;
  // After the context is lost, glGetError may return errors endlessly.
  constexpr std::size_t error_max = 32;
  for (GLenum error = glGetError(); error != GL_NO_ERROR && errors.size() < error_max; error = glGetError()) {
    errors.push_back(error);
  }
  return errors;
}

bool raise_gl_error(GLenum error)
{
  const GLboolean has_messages = glIsEnabled(GL_DEBUG_OUTPUT);
  if (has_messages) {
    glDisable(GL_DEBUG_OUTPUT);
  }
  bool is_raised = true;
  switch (error) {
    case GL_INVALID_ENUM: glEnable(GL_NONE); break;
    case GL_INVALID_VALUE: glLineWidth(-1.0F); break;
    case GL_INVALID_OPERATION: glBindVertexArray(~0U); break;
    default: is_raised = false; break;
  }
  if (has_messages) {
    glEnable(GL_DEBUG_OUTPUT);
  }
  return is_raised;
}

HostState::HostState(bool is_host, const DeviceNames &names) : is_host_(is_host), names_(names)
{
  if (is_host) {
    viewport_count_ = integer(GL_MAX_VIEWPORTS);
  }
  else {
    set_draw_defaults();
    set_pixel_store(PixelTransfer::Pack);
    set_pixel_store(PixelTransfer::Unpack);
  }
}

void HostState::keep_draw_state()
{
  if (!is_host_ || draw_) {
    return;
  }
  // A program may be deleted and still be in use.
  const GLuint program = bound_name(GL_CURRENT_PROGRAM, glIsProgram);
  DrawState &saved = draw_.emplace(DrawState{
      .program = program != 0 && program_parameter(program, GL_LINK_STATUS) == GL_TRUE ? program : 0,
      .is_program_deleted = program != 0 && program_parameter(program, GL_DELETE_STATUS) == GL_TRUE,
      .vertex_array = bound_name(GL_VERTEX_ARRAY_BINDING, glIsVertexArray),
      .draw_framebuffer = bound_name(GL_DRAW_FRAMEBUFFER_BINDING, glIsFramebuffer),
      .clip_origin = integer(GL_CLIP_ORIGIN),
      .clip_depth = integer(GL_CLIP_DEPTH_MODE),
      .depth_function = integer(GL_DEPTH_FUNC),
      .cull_face = integer(GL_CULL_FACE_MODE),
      .front_face = integer(GL_FRONT_FACE),
      .polygon_mode = integer(GL_POLYGON_MODE),
      .provoking_vertex = integer(GL_PROVOKING_VERTEX),
  });
  keep_buffer(GL_DRAW_INDIRECT_BUFFER);
  glGetBooleanv(GL_DEPTH_WRITEMASK, &saved.depth_mask);
  glGetFloatv(GL_LINE_WIDTH, &saved.line_width);
  glGetFloatv(GL_POINT_SIZE, &saved.point_size);
  glGetFloati_v(GL_VIEWPORT, 0, saved.viewport.data());
  glGetIntegeri_v(GL_SCISSOR_BOX, 0, saved.scissor_box.data());
  glGetDoublei_v(GL_DEPTH_RANGE, 0, saved.depth_range.data());
  for (GLint i = 0; i < viewport_count_; i++) {
    saved.scissor_tests.push_back(glIsEnabledi(GL_SCISSOR_TEST, GLuint(i)));
  }
  for (const GLenum capability : used_capabilities) {
    saved.capabilities.push_back(glIsEnabled(capability));
  }
  set_draw_defaults();
}

void HostState::keep_polygon_offset()
{
  if (!is_host_ || polygon_offset_) {
    return;
  }
  // Without an argument, clang 14 does not compile it: the defaults of members are not known yet within the class.
  PolygonOffset &saved = polygon_offset_.emplace(PolygonOffset());
  glGetFloatv(GL_POLYGON_OFFSET_FACTOR, &saved.factor);
  glGetFloatv(GL_POLYGON_OFFSET_UNITS, &saved.units);
  constexpr int version_with_clamp = 46;
  if (epoxy_gl_version() >= version_with_clamp || epoxy_has_gl_extension("GL_ARB_polygon_offset_clamp")) {
    glGetFloatv(GL_POLYGON_OFFSET_CLAMP, &saved.clamp);
  }
}

void HostState::keep_color_masks(GLuint count)
{
  for (auto i = GLuint(color_masks_.size()); is_host_ && i < count; i++) {
    glGetBooleani_v(GL_COLOR_WRITEMASK, i, color_masks_.emplace_back().data());
  }
}

void HostState::keep_color_buffers(GLuint count)
{
  keep_color_masks(count);
  for (auto i = GLuint(color_buffers_.size()); is_host_ && i < count; i++) {
    ColorBuffer &saved = color_buffers_.emplace_back();
    saved.is_blended = glIsEnabledi(GL_BLEND, i);
    for (std::size_t j = 0; j < blend_functions.size(); j++) {
      glGetIntegeri_v(blend_functions[j], i, &saved.functions[j]);
    }
    for (std::size_t j = 0; j < blend_equations.size(); j++) {
      glGetIntegeri_v(blend_equations[j], i, &saved.equations[j]);
    }
  }
}

void HostState::keep_buffer(GLenum target)
{
  if (is_host_ && std::ranges::find(buffers_, target, &Buffer::target) == buffers_.end()) {
    buffers_.push_back({target, names_.host_buffer(GLuint(integer(binding_of(target))))});
  }
}

void HostState::keep_indexed_buffer(GLenum target, GLuint slot)
{
  const auto is_kept = [&](const IndexedBuffer &kept) { return kept.target == target && kept.slot == slot; };
  if (!is_host_ || std::ranges::any_of(indexed_buffers_, is_kept)) {
    return;
  }
  // Binding an index changes the binding without an index, too.
  keep_buffer(target);
  GLint name = 0;
  glGetIntegeri_v(binding_of(target), slot, &name);
  IndexedBuffer &saved =
      indexed_buffers_.emplace_back(IndexedBuffer{target, slot, names_.host_buffer(GLuint(name)), 0, 0});
  if (saved.name != 0) {
    const bool is_uniform = target == GL_UNIFORM_BUFFER;
    glGetInteger64i_v(is_uniform ? GL_UNIFORM_BUFFER_START : GL_SHADER_STORAGE_BUFFER_START, slot, &saved.offset_bytes);
    glGetInteger64i_v(is_uniform ? GL_UNIFORM_BUFFER_SIZE : GL_SHADER_STORAGE_BUFFER_SIZE, slot, &saved.size_bytes);
  }
}

void HostState::keep_texture(GLuint unit, GLenum target)
{
  const auto is_kept = [&](const BoundTexture &kept) { return kept.unit == unit && kept.target == target; };
  if (!is_host_ || std::ranges::any_of(textures_, is_kept)) {
    return;
  }
  if (!active_texture_) {
    active_texture_ = integer(GL_ACTIVE_TEXTURE);
  }
  glActiveTexture(GL_TEXTURE0 + unit);
  const GLuint texture = names_.host_texture(GLuint(integer(texture_binding_of(target))));
  textures_.push_back({unit, target, texture != 0 && is_of_target(texture, target) ? texture : 0});
  if (std::ranges::find(samplers_, unit, &BoundSampler::unit) == samplers_.end()) {
    samplers_.push_back({unit, names_.host_sampler(GLuint(integer(GL_SAMPLER_BINDING)))});
  }
}

void HostState::keep_pixel_store(PixelTransfer transfer)
{
  if (!is_host_ || std::ranges::find(pixel_stores_, transfer, &PixelStore::transfer) != pixel_stores_.end()) {
    return;
  }
  const GLenum target = transfer == PixelTransfer::Pack ? GL_PIXEL_PACK_BUFFER : GL_PIXEL_UNPACK_BUFFER;
  keep_buffer(target);
  glBindBuffer(target, 0);
  PixelStore &saved = pixel_stores_.emplace_back(PixelStore{transfer, {}});
  std::ranges::transform(pixel_parameters(transfer), saved.values.begin(), integer);
  set_pixel_store(transfer);
}

void HostState::restore()
{
  restore_bindings();
  for (const PixelStore &saved : pixel_stores_) {
    for (std::size_t i = 0; i < saved.values.size(); i++) {
      glPixelStorei(pixel_parameters(saved.transfer)[i], saved.values[i]);
    }
  }
  for (GLuint i = 0; i < color_buffers_.size(); i++) {
    const ColorBuffer &saved = color_buffers_[i];
    if (saved.is_blended) {
      glEnablei(GL_BLEND, i);
    }
    else {
      glDisablei(GL_BLEND, i);
    }
    glBlendFuncSeparatei(i, GLenum(saved.functions[0]), GLenum(saved.functions[1]), GLenum(saved.functions[2]),
                         GLenum(saved.functions[3]));
    glBlendEquationSeparatei(i, GLenum(saved.equations[0]), GLenum(saved.equations[1]));
  }
  for (GLuint i = 0; i < color_masks_.size(); i++) {
    const std::array<GLboolean, 4> &mask = color_masks_[i];
    glColorMaski(i, mask[0], mask[1], mask[2], mask[3]);
  }
  if (draw_) {
    restore(*draw_);
  }
  if (polygon_offset_ && polygon_offset_->clamp != 0.0F) {
    glPolygonOffsetClamp(polygon_offset_->factor, polygon_offset_->units, polygon_offset_->clamp);
  }
  else if (polygon_offset_) {
    glPolygonOffset(polygon_offset_->factor, polygon_offset_->units);
  }
  polygon_offset_.reset();
  pixel_stores_.clear();
  color_buffers_.clear();
  color_masks_.clear();
  draw_.reset();
}

void HostState::restore_bindings()
{
  for (const BoundTexture &saved : textures_) {
    glActiveTexture(GL_TEXTURE0 + saved.unit);
    glBindTexture(saved.target, saved.name);
  }
  for (const BoundSampler &saved : samplers_) {
    glBindSampler(saved.unit, saved.name);
  }
  if (active_texture_) {
    glActiveTexture(GLenum(*active_texture_));
  }
  for (const IndexedBuffer &saved : indexed_buffers_) {
    // A size of 0 means that the whole buffer is bound, even if its size changes later.
    if (saved.name == 0 || saved.size_bytes == 0) {
      glBindBufferBase(saved.target, saved.slot, saved.name);
    }
    else {
      glBindBufferRange(saved.target, saved.slot, saved.name, GLintptr(saved.offset_bytes),
                        GLsizeiptr(saved.size_bytes));
    }
  }
  // After the indexed bindings, which change these.
  for (const Buffer &saved : buffers_) {
    glBindBuffer(saved.target, saved.name);
  }
  textures_.clear();
  samplers_.clear();
  active_texture_.reset();
  indexed_buffers_.clear();
  buffers_.clear();
}

void HostState::restore(const DrawState &saved) const
{
  for (std::size_t i = 0; i < used_capabilities.size(); i++) {
    set_capability(used_capabilities[i], saved.capabilities[i] == GL_TRUE);
  }
  for (GLuint i = 0; i < saved.scissor_tests.size(); i++) {
    if (saved.scissor_tests[i]) {
      glEnablei(GL_SCISSOR_TEST, i);
    }
  }
  glViewportIndexedfv(0, saved.viewport.data());
  glScissorIndexedv(0, saved.scissor_box.data());
  glDepthRangeIndexed(0, saved.depth_range[0], saved.depth_range[1]);
  glClipControl(GLenum(saved.clip_origin), GLenum(saved.clip_depth));
  glDepthFunc(GLenum(saved.depth_function));
  glDepthMask(saved.depth_mask);
  glCullFace(GLenum(saved.cull_face));
  glFrontFace(GLenum(saved.front_face));
  glPolygonMode(GL_FRONT_AND_BACK, GLenum(saved.polygon_mode));
  glLineWidth(saved.line_width);
  glPointSize(saved.point_size);
  glProvokingVertex(GLenum(saved.provoking_vertex));
  // A program that was flagged for deletion still exists if another context uses it. Otherwise it ended when it was
  // replaced, and a program of the device may have its name now.
  const bool exists = !saved.is_program_deleted || (glIsProgram(saved.program) == GL_TRUE &&
                                                    program_parameter(saved.program, GL_DELETE_STATUS) == GL_TRUE);
  use_program(exists ? saved.program : 0);
  glBindVertexArray(saved.vertex_array);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, saved.draw_framebuffer);
}

std::string unsaveable_state(GLuint &probe_query)
{
  for (const auto &[target, name] :
       {std::pair(GL_SAMPLES_PASSED, "GL_SAMPLES_PASSED"), std::pair(GL_ANY_SAMPLES_PASSED, "GL_ANY_SAMPLES_PASSED"),
        std::pair(GL_ANY_SAMPLES_PASSED_CONSERVATIVE, "GL_ANY_SAMPLES_PASSED_CONSERVATIVE"),
        std::pair(GL_PRIMITIVES_GENERATED, "GL_PRIMITIVES_GENERATED"),
        std::pair(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, "GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN")}) {
    GLint query = 0;
    glGetQueryiv(GLenum(target), GL_CURRENT_QUERY, &query);
    if (query != 0) {
      return fmt::format("the host's query {} of {} is active", query, name);
    }
  }
  if (integer(GL_TRANSFORM_FEEDBACK_ACTIVE) && !integer(GL_TRANSFORM_FEEDBACK_PAUSED)) {
    return "the host's transform feedback is active";
  }
  if (probe_query == 0) {
    glCreateQueries(GL_ANY_SAMPLES_PASSED, 1, &probe_query);
    glBeginQuery(GL_ANY_SAMPLES_PASSED, probe_query);
    glEndQuery(GL_ANY_SAMPLES_PASSED);
  }
  glBeginConditionalRender(probe_query, GL_QUERY_WAIT);
  if (!take_gl_errors().empty()) {
    return "the host's conditional rendering is active";
  }
  glEndConditionalRender();
  return {};
}

}  // namespace gnomon::gpu
