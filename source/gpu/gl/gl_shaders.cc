// SPDX-License-Identifier: MIT
#include "gl_device.hh"

#include "trace.hh"

#include <fmt/ranges.h>

#include <cstring>
#include <optional>

namespace gnomon::gpu {

namespace {

GLenum gl_stage(ShaderStage stage)
{
  switch (stage) {
    case ShaderStage::Vertex: return GL_VERTEX_SHADER;
    case ShaderStage::Geometry: return GL_GEOMETRY_SHADER;
    case ShaderStage::Fragment: return GL_FRAGMENT_SHADER;
  }
  return GL_VERTEX_SHADER;
}

constexpr std::size_t log_size_max = 4096;

std::string shader_log(GLuint shader)
{
  std::string log(log_size_max, '\0');
  GLsizei length = 0;
  glGetShaderInfoLog(shader, GLsizei(log.size()), &length, log.data());
  log.resize(std::size_t(length));
  return log;
}

std::string program_log(GLuint program)
{
  std::string log(log_size_max, '\0');
  GLsizei length = 0;
  glGetProgramInfoLog(program, GLsizei(log.size()), &length, log.data());
  log.resize(std::size_t(length));
  return log;
}

bool is_linked(GLuint program)
{
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  return linked == GL_TRUE;
}

/** The driver's format number followed by its program binary; empty if the driver provides none. */
std::vector<std::byte> compiled_form(GLuint program)
{
  GLint size = 0;
  glGetProgramiv(program, GL_PROGRAM_BINARY_LENGTH, &size);
  if (size <= 0) {
    return {};
  }
  GLenum format = 0;
  std::vector<std::byte> compiled(sizeof(format) + std::size_t(size));
  GLsizei written = 0;
  glGetProgramBinary(program, size, &written, &format, compiled.data() + sizeof(format));
  std::memcpy(compiled.data(), &format, sizeof(format));
  compiled.resize(sizeof(format) + std::size_t(written));
  return compiled;
}

}  // namespace

GLuint GlDevice::compile(const ShaderDesc &desc, const std::vector<ShaderSource> &stages)
{
  const GLuint program = glCreateProgram();
  const auto failed = [&](const std::string &reason) {
    glDeleteProgram(program);
    // The driver has reported the same error as a debug message.
    driver_errors_.clear();
    throw Error("shader '{}': {}", desc.name, reason);
  };
  for (const ShaderSource &stage : stages) {
    const GLuint shader = glCreateShader(gl_stage(stage.stage));
    const char *text = stage.text.c_str();
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
    // Marks the shader for deletion together with the program.
    glDeleteShader(shader);
    GLint is_compiled = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &is_compiled);
    if (!is_compiled) {
      failed(fmt::format("the driver rejects the {} stage:\n{}", to_string(stage.stage),
                         stage.name_files(shader_log(shader))));
    }
  }
  glProgramParameteri(program, GL_PROGRAM_BINARY_RETRIEVABLE_HINT, GL_TRUE);
  glLinkProgram(program);
  if (!is_linked(program)) {
    failed("the driver does not link it:\n" + program_log(program));
  }
  return program;
}

GLuint GlDevice::load_compiled(const std::vector<std::byte> &compiled)
{
  GLenum format = 0;
  if (compiled.size() <= sizeof(format)) {
    return 0;
  }
  std::memcpy(&format, compiled.data(), sizeof(format));
  const GLuint program = glCreateProgram();
  glProgramBinary(program, format, compiled.data() + sizeof(format), GLsizei(compiled.size() - sizeof(format)));
  if (is_linked(program)) {
    return program;
  }
  // The binary may come from another driver version. This is not an error, so discard the driver's report.
  glDeleteProgram(program);
  driver_errors_.clear();
  static_cast<void>(take_gl_errors());
  return 0;
}

void GlDevice::shader_create(const Operation::CreateShader &create, std::vector<std::byte> &compiled)
{
  const trace::Span span(compiled.empty() ? "compile program" : "load program",
                         fmt::format("{} {}", create.desc.name, fmt::join(create.desc.defines, " ")));
  const Calls calls(*this);
  GlProgram program{load_compiled(compiled), {}};
  if (program.name == 0) {
    program.name = compile(create.desc, create.stages);
    compiled = compiled_form(program.name);
  }
  label(GL_PROGRAM, program.name, create.desc.name);
  program.samplers = declared_samplers(program.name, create.samplers);
  // Created here, so that a submit creates nothing.
  for (const DeclaredSampler &sampler : program.samplers) {
    static_cast<void>(dummy(sampler));
  }
  check_or(fmt::format("shader '{}'", create.desc.name), [&] { glDeleteProgram(program.name); });
  programs_.insert(create.id, std::move(program));
}

std::vector<GlDevice::DeclaredSampler> GlDevice::declared_samplers(GLuint program,
                                                                   const std::vector<std::string> &names)
{
  // By name, because Mesa's queries by index are linear in the index, and each member of an array in a block has one: a
  // walk through all uniforms of eevee_lit took 60 ms.
  std::vector<DeclaredSampler> samplers;
  for (const std::string &name : names) {
    const char *text = name.c_str();
    GLuint index = GL_INVALID_INDEX;
    glGetUniformIndices(program, 1, &text, &index);
    const GLint location = glGetUniformLocation(program, text);
    if (index == GL_INVALID_INDEX || location < 0) {
      // The driver removed it, because no stage uses its value.
      continue;
    }
    GLint type = 0;
    glGetActiveUniformsiv(program, 1, &index, GL_UNIFORM_TYPE, &type);
    GLint unit = 0;
    glGetUniformiv(program, location, &unit);
    const bool is_flat = type == GL_SAMPLER_2D || type == GL_SAMPLER_2D_SHADOW;
    GNOMON_ASSERT(
        is_flat || type == GL_SAMPLER_2D_ARRAY || type == GL_SAMPLER_2D_ARRAY_SHADOW || type == GL_SAMPLER_BUFFER,
        "sampler '{}': its kind has no texture to stand in for it", name);
    const GLenum target = is_flat ? GL_TEXTURE_2D : type == GL_SAMPLER_BUFFER ? GL_TEXTURE_BUFFER : GL_TEXTURE_2D_ARRAY;
    samplers.push_back({GLuint(unit), target, type == GL_SAMPLER_2D_SHADOW || type == GL_SAMPLER_2D_ARRAY_SHADOW});
  }
  return samplers;
}

const GlDevice::Dummy &GlDevice::dummy(const DeclaredSampler &sampler)
{
  const bool is_array = sampler.target == GL_TEXTURE_2D_ARRAY;
  const bool is_buffer = sampler.target == GL_TEXTURE_BUFFER;
  Dummy &one = dummies_[is_buffer ? 2 : is_array ? 1 : 0][sampler.is_comparison];
  if (one.texture != 0) {
    return one;
  }
  const GLenum format = sampler.is_comparison ? GL_DEPTH_COMPONENT32F : GL_RGBA8;
  one.texture = names_.create_texture(sampler.target);
  if (is_buffer) {
    constexpr std::uint32_t black = 0;
    const GLuint buffer = names_.create_buffer();
    glNamedBufferStorage(buffer, sizeof(black), &black, 0);
    glTextureBuffer(one.texture, format, buffer);
    // The texture keeps the buffer.
    names_.delete_buffers({&buffer, 1});
  }
  else {
    if (is_array) {
      glTextureStorage3D(one.texture, 1, format, 1, 1, 1);
    }
    else {
      glTextureStorage2D(one.texture, 1, format, 1, 1);
    }
    if (sampler.is_comparison) {
      glClearTexImage(one.texture, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
    }
    else {
      glClearTexImage(one.texture, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    }
  }
  label(GL_TEXTURE, one.texture, "unbound");
  one.sampler = names_.create_sampler();
  label(GL_SAMPLER, one.sampler, "unbound");
  glSamplerParameteri(one.sampler, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glSamplerParameteri(one.sampler, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  if (sampler.is_comparison) {
    glSamplerParameteri(one.sampler, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glSamplerParameteri(one.sampler, GL_TEXTURE_COMPARE_FUNC, GL_GEQUAL);
  }
  return one;
}

}  // namespace gnomon::gpu
