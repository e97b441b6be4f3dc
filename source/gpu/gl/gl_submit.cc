// SPDX-License-Identifier: MIT
#include "gl_device.hh"

#include "draw_object_shared.h"
#include "slots_shared.h"
#include "trace.hh"

#include <algorithm>
#include <optional>
#include <utility>

namespace gnomon::gpu {

namespace {

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

void GlDevice::list_submit(const CommandList &list)
{
  const trace::Span span("submit", list.passes().empty() ? std::string_view() : list.name_of(list.passes().front()));
  const Calls calls(*this);
  check_host_state("submit");
  host_state_.keep_draw_state();
  try {
    execute(list);
  }
  catch (...) {
    if (pass_) {
      end_pass();
    }
    release_buffers();
    stream_.end();
    // Errors of this list, which the next call must not report as its own.
    driver_errors_.clear();
    static_cast<void>(take_gl_errors());
    throw;
  }
  release_buffers();
  stream_.end();
  check("submit");
}

void GlDevice::execute(const CommandList &list)
{
  write_stream(list);
  program_ = nullptr;
  objects_ = 0;
  host_batch_ = nullptr;
  bound_textures_.clear();
  const auto written = [&](const Command &command) {
    return stream_.write(std::span(list.bytes()).subspan(command.first, command.count),
                         limits().uniform_offset_alignment);
  };
  for (const Command &command : list.commands()) {
    switch (command.kind) {
      case CommandKind::BeginPass: {
        const CommandList::PassInfo &pass = list.passes()[command.first];
        begin_pass(list.name_of(pass), pass);
        break;
      }
      case CommandKind::EndPass: end_pass(); break;
      case CommandKind::SetShader:
        program_ = &programs_.at(command.id);
        glUseProgram(program_->name);
        break;
      case CommandKind::SetState: set_state(State(command.first)); break;
      case CommandKind::BindUniform:
      case CommandKind::BindStorage: bind_range(command); break;
      case CommandKind::BindTexture: bind_texture(command); break;
      case CommandKind::BindInstances: objects_ = command.id; break;
      case CommandKind::BindHostBatch:
        host_batch_ = command.id == 0 ? nullptr : &host_batches_.at(command.id);
        if (host_batch_) {
          bind_host_buffers(*host_batch_);
        }
        break;
      case CommandKind::PushConstants:
        host_state_.keep_indexed_buffer(GL_UNIFORM_BUFFER, command.slot);
        glBindBufferRange(GL_UNIFORM_BUFFER, command.slot, stream_.buffer(), GLintptr(written(command)),
                          GLsizeiptr(command.count));
        break;
      case CommandKind::Draw:
        complete_textures();
        bind_vertex_array();
        glMultiDrawElementsIndirect(
            primitive_,
            host_batch_ && host_batch_->index_type == HostBatch::IndexType::Uint16 ? GL_UNSIGNED_SHORT
                                                                                   : GL_UNSIGNED_INT,
            reinterpret_cast<const void *>(draws_offset_ + command.first * sizeof(DrawIndirect)),
            GLsizei(command.count), sizeof(DrawIndirect));
        break;
      case CommandKind::DrawProcedural:
        complete_textures();
        glBindVertexArray(empty_vertex_array_);
        glDrawArraysInstanced(GL_TRIANGLES, 0, GLsizei(command.first), GLsizei(command.count));
        break;
      case CommandKind::Update: {
        GlBuffer &buffer = buffers_.at(command.id);
        buffer.is_copied_into = true;
        glCopyNamedBufferSubData(stream_.buffer(), buffer.name, GLintptr(written(command)), GLintptr(command.slot),
                                 GLsizeiptr(command.count));
        break;
      }
    }
  }
}

void GlDevice::write_stream(const CommandList &list)
{
  const std::size_t alignment = limits().uniform_offset_alignment;
  std::size_t size = std::as_bytes(std::span(list.instances)).size() + std::as_bytes(std::span(list.draws)).size();
  std::size_t part_count = 2;
  for (const Command &command : list.commands()) {
    if (command.kind == CommandKind::PushConstants || command.kind == CommandKind::Update) {
      size += command.count;
      part_count++;
    }
  }
  stream_.begin(size + part_count * alignment);
  instances_offset_ = stream_.write(std::as_bytes(std::span(list.instances)), alignment);
  draws_offset_ = stream_.write(std::as_bytes(std::span(list.draws)), alignment);
  glVertexArrayVertexBuffer(shared_array_.name, ATTRIBUTE_DRAW_INSTANCE, stream_.buffer(), GLintptr(instances_offset_),
                            sizeof(DrawInstance));
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, stream_.buffer());
}

void GlDevice::bind_instances(VertexArray &array)
{
  if (array.objects == objects_) {
    return;
  }
  const bool is_list = objects_ == 0;
  const GLuint buffer = is_list ? 0 : buffers_.at(objects_).name;
  glVertexArrayVertexBuffer(array.name, ATTRIBUTE_DRAW_INSTANCE, is_list ? stream_.buffer() : buffer,
                            GLintptr(is_list ? instances_offset_ : offsetof(shared::ObjectData, index)),
                            GLsizei(is_list ? sizeof(DrawInstance) : sizeof(shared::ObjectData)));
  glVertexArrayVertexBuffer(array.name, ATTRIBUTE_WORLD_FROM_OBJECT, buffer, 0, sizeof(shared::ObjectData));
  // The value of an instance is 0 in calls: the default of a component that is not in the buffer.
  glVertexArrayAttribIFormat(array.name, ATTRIBUTE_DRAW_INSTANCE, is_list ? 2 : 1, GL_UNSIGNED_INT, 0);
  // An enabled attribute must have a buffer, even if no shader reads it.
  if (is_list != (array.objects == 0)) {
    for (GLuint attribute = ATTRIBUTE_WORLD_FROM_OBJECT; attribute <= ATTRIBUTE_OBJECT_VALUE; attribute++) {
      (is_list ? glDisableVertexArrayAttrib : glEnableVertexArrayAttrib)(array.name, attribute);
    }
  }
  array.objects = objects_;
}

void GlDevice::bind_host_buffers(const HostBatch &batch)
{
  const GLuint array = host_array_.name;
  if (!std::exchange(has_host_buffers_, true)) {
    glVertexArrayVertexBuffer(array, ATTRIBUTE_DRAW_INSTANCE, stream_.buffer(), GLintptr(instances_offset_),
                              sizeof(DrawInstance));
  }
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    const VertexFormat &format = vertex_formats()[i];
    const HostStream &stream = batch.stream(VertexStream(i));
    if (stream.buffer != 0) {
      const auto [type, is_normalized] = gl_vertex_type(stream.type);
      glVertexArrayAttribFormat(array, format.attribute, format.component_count, type, is_normalized, 0);
      glVertexArrayVertexBuffer(array, format.attribute, GLuint(stream.buffer), GLintptr(stream.offset_bytes),
                                GLsizei(stream.stride_bytes));
    }
    else {
      // Each vertex reads the same four floats.
      const bool is_one = VertexStream(i) == VertexStream::Color;
      glVertexArrayAttribFormat(array, format.attribute, format.component_count, GL_FLOAT, GL_FALSE, 0);
      glVertexArrayVertexBuffer(array, format.attribute, absent_streams_, is_one ? sizeof(glm::vec4) : 0, 0);
    }
  }
  glVertexArrayElementBuffer(array, GLuint(batch.index_buffer));
}

void GlDevice::bind_vertex_array()
{
  VertexArray &array = host_batch_ ? host_array_ : shared_array_;
  bind_instances(array);
  glBindVertexArray(array.name);
}

void GlDevice::release_buffers()
{
  objects_ = 0;
  bind_instances(shared_array_);
  if (std::exchange(has_host_buffers_, false)) {
    bind_instances(host_array_);
    for (const VertexFormat &format : vertex_formats()) {
      glVertexArrayVertexBuffer(host_array_.name, format.attribute, absent_streams_, 0, 0);
    }
    glVertexArrayElementBuffer(host_array_.name, 0);
  }
}

const GlDevice::GlFramebuffer &GlDevice::framebuffer_of(const CommandList::PassInfo &pass)
{
  if (!pass.host_framebuffer) {
    return framebuffers_.at(pass.framebuffer);
  }
  host_framebuffer_.name = pass.host_framebuffer->name;
  host_framebuffer_.color_count = 1;
  host_framebuffer_.has_depth = true;
  host_framebuffer_.size_px = pass.host_framebuffer->size_px;
  return host_framebuffer_;
}

void GlDevice::check_host_framebuffer(std::string_view pass_name, const CommandList::PassInfo &pass)
{
  const GLuint name = pass.host_framebuffer->name;
  const auto refuse = [&](std::string_view why) {
    throw Error("pass '{}': framebuffer {} of the host {}", pass_name, name, why);
  };
  if (name != 0 && !glIsFramebuffer(name)) {
    refuse("does not exist in the current context");
  }
  if (glCheckNamedFramebufferStatus(name, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    refuse("is not complete");
  }
  // The default framebuffer is not checked, because drivers disagree on its encoding.
  if (name != 0 && pass.actions.is_srgb_encoded) {
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, name);
    GLint buffer = GL_NONE;
    glGetIntegerv(GL_DRAW_BUFFER0, &buffer);
    GLint encoding = GL_LINEAR;
    if (buffer != GL_NONE) {
      glGetNamedFramebufferAttachmentParameteriv(name, GLenum(buffer), GL_FRAMEBUFFER_ATTACHMENT_COLOR_ENCODING,
                                                 &encoding);
    }
    if (encoding != GL_SRGB) {
      refuse("has no attachment of an sRGB format, which would encode the colours");
    }
  }
}

void GlDevice::begin_pass(std::string_view name, const CommandList::PassInfo &pass)
{
  if (pass.host_framebuffer) {
    check_host_framebuffer(name, pass);
  }
  const GlFramebuffer &framebuffer = framebuffer_of(pass);
  if (has_pass_groups_) {
    glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, GLsizei(std::min<std::size_t>(name.size(), 255)), name.data());
  }
  pass_ = &pass;
  color_count_ = framebuffer.color_count;
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer.name);
  const PassActions &actions = pass.actions;
  const Rectangle viewport = actions.viewport.is_whole() ? Rectangle{{0, 0}, framebuffer.size_px} : actions.viewport;
  glViewportIndexedf(0, float(viewport.origin_px.x), float(viewport.origin_px.y), float(viewport.size_px.x),
                     float(viewport.size_px.y));
  if (!actions.scissor.is_whole()) {
    glScissorIndexed(0, actions.scissor.origin_px.x, actions.scissor.origin_px.y, actions.scissor.size_px.x,
                     actions.scissor.size_px.y);
    glEnablei(GL_SCISSOR_TEST, 0);
  }
  set_capability(GL_FRAMEBUFFER_SRGB, actions.is_srgb_encoded);
  const bool is_biased = actions.depth_bias != DepthBias();
  if (is_biased) {
    host_state_.keep_polygon_offset();
    glPolygonOffset(actions.depth_bias.slope, actions.depth_bias.constant);
  }
  set_capability(GL_POLYGON_OFFSET_FILL, is_biased);
  if (actions.reads_attachments) {
    glTextureBarrier();
  }
  host_state_.keep_color_buffers(color_count_);
  const GLuint mask_count = pass.host_framebuffer ? GLuint(limits().color_attachment_max) : 0;
  host_state_.keep_color_masks(mask_count);
  for (GLuint i = 1; i < mask_count; i++) {
    glColorMaski(i, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  }
  // Clears respect the write masks.
  set_state(State::WriteColor | State::WriteDepth);
  load_attachments(framebuffer, actions, pass.host_framebuffer.has_value());
  bind_for_draws(framebuffer.name);
}

void GlDevice::bind_for_draws(GLuint name)
{
  is_window_ = name == 0;
  if (is_window_ || has_drawn_window_) {
    // Mesa (22.3) draws windows from the top, and turns gl_FragCoord by a constant of the program. If a clear, also of
    // the host, comes between the change of the framebuffer and the draw, it keeps the constant of the last program.
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, other_framebuffer_);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, name);
  }
}

void GlDevice::load_attachments(const GlFramebuffer &framebuffer, const PassActions &actions, bool is_of_host) const
{
  std::vector<GLenum> discarded;
  for (GLuint i = 0; i < framebuffer.color_count; i++) {
    if (actions.color_load == LoadAction::Clear) {
      glClearNamedFramebufferfv(framebuffer.name, GL_COLOR, GLint(i), &actions.clear_color[0]);
    }
    else if (actions.color_load == LoadAction::DontCare) {
      discarded.push_back(GL_COLOR_ATTACHMENT0 + i);
    }
  }
  if (framebuffer.has_depth) {
    if (actions.depth_load == LoadAction::Clear) {
      if (has_unsound_depth_clears_) {
        const float other_depth = actions.clear_depth == 0.5F ? 0.25F : 0.5F;
        glClearNamedFramebufferfv(framebuffer.name, GL_DEPTH, 0, &other_depth);
      }
      glClearNamedFramebufferfv(framebuffer.name, GL_DEPTH, 0, &actions.clear_depth);
    }
    else if (actions.depth_load == LoadAction::DontCare) {
      discarded.push_back(GL_DEPTH_ATTACHMENT);
    }
  }
  if (!discarded.empty() && !is_of_host) {
    glInvalidateNamedFramebufferData(framebuffer.name, GLsizei(discarded.size()), discarded.data());
  }
}

void GlDevice::end_pass()
{
  const GlFramebuffer &framebuffer = framebuffer_of(*pass_);
  glDisable(GL_FRAMEBUFFER_SRGB);
  glDisablei(GL_SCISSOR_TEST, 0);
  std::vector<GLenum> discarded;
  for (GLuint i = 0; i < framebuffer.color_count && pass_->actions.color_store == StoreAction::DontCare; i++) {
    discarded.push_back(GL_COLOR_ATTACHMENT0 + i);
  }
  if (framebuffer.has_depth && pass_->actions.depth_store == StoreAction::DontCare) {
    discarded.push_back(GL_DEPTH_ATTACHMENT);
  }
  if (!discarded.empty() && !pass_->host_framebuffer) {
    glInvalidateNamedFramebufferData(framebuffer.name, GLsizei(discarded.size()), discarded.data());
  }
  set_wireframe(false);
  if (has_pass_groups_) {
    glPopDebugGroup();
  }
  pass_ = nullptr;
}

void GlDevice::set_wireframe(bool is_wireframe)
{
  if (std::exchange(is_wireframe_, is_wireframe) != is_wireframe) {
    glPolygonMode(GL_FRONT_AND_BACK, is_wireframe ? GL_LINE : GL_FILL);
  }
}

void GlDevice::set_state(State state)
{
  set_wireframe(has(state, State::Wireframe));
  primitive_ = has(state, State::DrawPoints) ? GL_POINTS : has(state, State::DrawLines) ? GL_LINES : GL_TRIANGLES;
  glDepthMask(GLboolean(has(state, State::WriteDepth)));
  // OpenGL writes depth only if the depth test is enabled, so GL_ALWAYS is used to write without a test.
  const GLenum function = has(state, State::DepthEqual)         ? GL_EQUAL
                          : has(state, State::DepthNearerEqual) ? GL_GEQUAL
                          : has(state, State::DepthLessEqual)   ? GL_LEQUAL
                          : has(state, State::DepthFurther)     ? GL_LESS
                                                                : GL_ALWAYS;
  set_capability(GL_DEPTH_TEST, function != GL_ALWAYS || has(state, State::WriteDepth));
  glDepthFunc(function);
  set_capability(GL_CULL_FACE, has(state, State::CullBack | State::CullFront));
  glCullFace(has(state, State::CullFront) ? GL_FRONT : GL_BACK);
  glFrontFace(has(state, State::FrontClockwise) ? GL_CW : GL_CCW);
  set_capability(GL_DEPTH_CLAMP, has(state, State::DepthClamp));
  // Set blending for each used draw buffer, so that the host's state of the other draw buffers is unchanged.
  const auto mask = GLboolean(has(state, State::WriteColor));
  const bool is_multiplied = has(state, State::BlendMultiply);
  const GLenum stored = is_multiplied ? GL_ZERO : has(state, State::BlendOver) ? GL_ONE_MINUS_SRC_ALPHA : GL_ONE;
  for (GLuint i = 0; i < color_count_; i++) {
    glColorMaski(i, mask, mask, mask, mask);
    if (has(state, State::BlendAdd | State::BlendMultiply | State::BlendOver)) {
      glEnablei(GL_BLEND, i);
    }
    else {
      glDisablei(GL_BLEND, i);
    }
    glBlendFunci(i, is_multiplied ? GL_DST_COLOR : GL_ONE, stored);
    glBlendEquationi(i, GL_FUNC_ADD);
  }
}

void GlDevice::bind_range(const Command &command)
{
  const GlBuffer &buffer = buffers_.at(command.id);
  const std::size_t size = command.count > 0 ? command.count : buffer.size_bytes - command.first;
  const GLenum target = command.kind == CommandKind::BindUniform ? GL_UNIFORM_BUFFER : GL_SHADER_STORAGE_BUFFER;
  host_state_.keep_indexed_buffer(target, command.slot);
  glBindBufferRange(target, command.slot, buffer.name, GLintptr(command.first), GLsizeiptr(size));
}

void GlDevice::bind_texture(const Command &command)
{
  if (command.slot >= bound_textures_.size()) {
    bound_textures_.resize(std::size_t(command.slot) + 1, GL_NONE);
  }
  if (command.id == 0) {
    bound_textures_[command.slot] = GL_NONE;
    return;
  }
  bound_textures_[command.slot] = GL_TEXTURE;
  const GlTexture &texture = textures_.at(command.id);
  host_state_.keep_texture(command.slot, gl_target(texture.desc.kind));
  glBindTextureUnit(command.slot, texture.name);
  glBindSampler(command.slot, command.first == 0 ? 0 : samplers_.at(command.first));
}

void GlDevice::complete_textures()
{
  has_drawn_window_ = is_window_;
  for (const DeclaredSampler &sampler : program_ ? program_->samplers : std::vector<DeclaredSampler>()) {
    if (sampler.unit >= bound_textures_.size()) {
      bound_textures_.resize(std::size_t(sampler.unit) + 1, GL_NONE);
    }
    GLenum &bound = bound_textures_[sampler.unit];
    if (bound != GL_TEXTURE && bound != sampler.target) {
      const Dummy &one = dummy(sampler);
      host_state_.keep_texture(sampler.unit, sampler.target);
      glBindTextureUnit(sampler.unit, one.texture);
      glBindSampler(sampler.unit, one.sampler);
      bound = sampler.target;
    }
  }
}

}  // namespace gnomon::gpu
