// SPDX-License-Identifier: MIT
#include "gl_state.hh"

#include <fmt/format.h>

#include <algorithm>

namespace gnomon::gpu {

namespace {

/** Capabilities that set_draw_defaults() disables. Command lists enable some of them. */
constexpr std::array<GLenum, 27> used_capabilities = {
    GL_COLOR_LOGIC_OP,
    GL_CULL_FACE,
    GL_DEPTH_CLAMP,
    GL_DEPTH_TEST,
    GL_DITHER,
    GL_FRAMEBUFFER_SRGB,
    GL_LINE_SMOOTH,
    GL_POLYGON_OFFSET_FILL,
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
    default: return GL_NONE;
  }
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

SavedBufferBinding::SavedBufferBinding(GLenum target) : target_(target), buffer_(integer(binding_of(target))) {}

SavedBufferBinding::~SavedBufferBinding()
{
  glBindBuffer(target_, GLuint(buffer_));
}

SavedPixelStore::SavedPixelStore(PixelTransfer transfer)
    : transfer_(transfer), buffer_(transfer == PixelTransfer::Pack ? GL_PIXEL_PACK_BUFFER : GL_PIXEL_UNPACK_BUFFER)
{
  const bool is_pack = transfer == PixelTransfer::Pack;
  glBindBuffer(is_pack ? GL_PIXEL_PACK_BUFFER : GL_PIXEL_UNPACK_BUFFER, 0);
  const auto &parameters = is_pack ? pack_parameters : unpack_parameters;
  for (std::size_t i = 0; i < parameters.size(); i++) {
    values_[i] = integer(parameters[i]);
    glPixelStorei(parameters[i], i == 0 ? 1 : 0);
  }
}

SavedPixelStore::~SavedPixelStore()
{
  const auto &parameters = transfer_ == PixelTransfer::Pack ? pack_parameters : unpack_parameters;
  for (std::size_t i = 0; i < parameters.size(); i++) {
    glPixelStorei(parameters[i], values_[i]);
  }
}

void UsedSlots::add(std::vector<GLuint> &slots, GLuint slot)
{
  if (std::ranges::find(slots, slot) == slots.end()) {
    slots.push_back(slot);
  }
}

void UsedSlots::clear()
{
  uniform_slots.clear();
  storage_slots.clear();
  texture_units.clear();
  color_count = 0;
}

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

void SavedDrawState::save_indexed(GLenum target, GLenum start, GLenum size, const std::vector<GLuint> &slots)
{
  for (const GLuint slot : slots) {
    IndexedBuffer &saved = indexed_buffers_.emplace_back(IndexedBuffer{target, slot, 0, 0, 0});
    glGetIntegeri_v(binding_of(target), slot, &saved.buffer);
    glGetInteger64i_v(start, slot, &saved.offset_bytes);
    glGetInteger64i_v(size, slot, &saved.size_bytes);
  }
}

SavedDrawState::SavedDrawState(const UsedSlots &slots)
    : active_texture_(integer(GL_ACTIVE_TEXTURE)),
      program_(integer(GL_CURRENT_PROGRAM)),
      vertex_array_(integer(GL_VERTEX_ARRAY_BINDING)),
      draw_framebuffer_(integer(GL_DRAW_FRAMEBUFFER_BINDING)),
      indirect_buffer_(integer(GL_DRAW_INDIRECT_BUFFER_BINDING)),
      uniform_buffer_(integer(GL_UNIFORM_BUFFER_BINDING)),
      storage_buffer_(integer(GL_SHADER_STORAGE_BUFFER_BINDING)),
      clip_origin_(integer(GL_CLIP_ORIGIN)),
      clip_depth_(integer(GL_CLIP_DEPTH_MODE)),
      depth_function_(integer(GL_DEPTH_FUNC)),
      cull_face_(integer(GL_CULL_FACE_MODE)),
      front_face_(integer(GL_FRONT_FACE)),
      polygon_mode_(integer(GL_POLYGON_MODE)),
      provoking_vertex_(integer(GL_PROVOKING_VERTEX))
{
  glGetBooleanv(GL_DEPTH_WRITEMASK, &depth_mask_);
  glGetFloatv(GL_LINE_WIDTH, &line_width_);
  glGetFloatv(GL_POINT_SIZE, &point_size_);
  glGetFloati_v(GL_VIEWPORT, 0, viewport_.data());
  glGetIntegeri_v(GL_SCISSOR_BOX, 0, scissor_box_.data());
  glGetDoublei_v(GL_DEPTH_RANGE, 0, depth_range_.data());
  const GLint viewport_count = integer(GL_MAX_VIEWPORTS);
  for (GLint i = 0; i < viewport_count; i++) {
    scissor_tests_.push_back(glIsEnabledi(GL_SCISSOR_TEST, GLuint(i)));
  }
  for (const GLenum capability : used_capabilities) {
    capabilities_.push_back(glIsEnabled(capability));
  }
  save_indexed(GL_UNIFORM_BUFFER, GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE, slots.uniform_slots);
  save_indexed(GL_SHADER_STORAGE_BUFFER, GL_SHADER_STORAGE_BUFFER_START, GL_SHADER_STORAGE_BUFFER_SIZE,
               slots.storage_slots);
  for (const GLuint unit : slots.texture_units) {
    glActiveTexture(GL_TEXTURE0 + unit);
    texture_units_.push_back({unit, integer(GL_TEXTURE_BINDING_2D), integer(GL_TEXTURE_BINDING_2D_ARRAY),
                              integer(GL_TEXTURE_BINDING_BUFFER), integer(GL_SAMPLER_BINDING)});
  }
  for (GLuint i = 0; i < slots.color_count; i++) {
    ColorBuffer &saved = color_buffers_.emplace_back();
    saved.is_blended = glIsEnabledi(GL_BLEND, i);
    glGetBooleani_v(GL_COLOR_WRITEMASK, i, saved.mask.data());
    for (std::size_t j = 0; j < blend_functions.size(); j++) {
      glGetIntegeri_v(blend_functions[j], i, &saved.functions[j]);
    }
    for (std::size_t j = 0; j < blend_equations.size(); j++) {
      glGetIntegeri_v(blend_equations[j], i, &saved.equations[j]);
    }
  }
}

SavedDrawState::~SavedDrawState()
{
  for (const TextureUnit &saved : texture_units_) {
    glActiveTexture(GL_TEXTURE0 + saved.unit);
    glBindTexture(GL_TEXTURE_2D, GLuint(saved.texture_2d));
    glBindTexture(GL_TEXTURE_2D_ARRAY, GLuint(saved.texture_2d_array));
    glBindTexture(GL_TEXTURE_BUFFER, GLuint(saved.texture_buffer));
    glBindSampler(saved.unit, GLuint(saved.sampler));
  }
  glActiveTexture(GLenum(active_texture_));
  for (const IndexedBuffer &saved : indexed_buffers_) {
    // A size of 0 means that the whole buffer is bound, even if its size changes later.
    if (saved.buffer == 0 || saved.size_bytes == 0) {
      glBindBufferBase(saved.target, saved.slot, GLuint(saved.buffer));
    }
    else {
      glBindBufferRange(saved.target, saved.slot, GLuint(saved.buffer), GLintptr(saved.offset_bytes),
                        GLsizeiptr(saved.size_bytes));
    }
  }
  // Restore these after the indexed bindings, because binding an index changes them too.
  glBindBuffer(GL_UNIFORM_BUFFER, GLuint(uniform_buffer_));
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, GLuint(storage_buffer_));
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, GLuint(indirect_buffer_));
  for (GLuint i = 0; i < color_buffers_.size(); i++) {
    const ColorBuffer &saved = color_buffers_[i];
    if (saved.is_blended) {
      glEnablei(GL_BLEND, i);
    }
    else {
      glDisablei(GL_BLEND, i);
    }
    glColorMaski(i, saved.mask[0], saved.mask[1], saved.mask[2], saved.mask[3]);
    glBlendFuncSeparatei(i, GLenum(saved.functions[0]), GLenum(saved.functions[1]), GLenum(saved.functions[2]),
                         GLenum(saved.functions[3]));
    glBlendEquationSeparatei(i, GLenum(saved.equations[0]), GLenum(saved.equations[1]));
  }
  for (std::size_t i = 0; i < used_capabilities.size(); i++) {
    set_capability(used_capabilities[i], capabilities_[i] == GL_TRUE);
  }
  for (GLuint i = 0; i < scissor_tests_.size(); i++) {
    if (scissor_tests_[i]) {
      glEnablei(GL_SCISSOR_TEST, i);
    }
  }
  glViewportIndexedfv(0, viewport_.data());
  glScissorIndexedv(0, scissor_box_.data());
  glDepthRangeIndexed(0, depth_range_[0], depth_range_[1]);
  glClipControl(GLenum(clip_origin_), GLenum(clip_depth_));
  glDepthFunc(GLenum(depth_function_));
  glDepthMask(depth_mask_);
  glCullFace(GLenum(cull_face_));
  glFrontFace(GLenum(front_face_));
  glPolygonMode(GL_FRONT_AND_BACK, GLenum(polygon_mode_));
  glLineWidth(line_width_);
  glPointSize(point_size_);
  glProvokingVertex(GLenum(provoking_vertex_));
  glUseProgram(GLuint(program_));
  glBindVertexArray(GLuint(vertex_array_));
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(draw_framebuffer_));
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
