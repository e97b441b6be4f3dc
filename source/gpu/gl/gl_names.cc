// SPDX-License-Identifier: MIT
#include "gl_names.hh"

namespace gnomon::gpu {

GLuint DeviceNames::create_buffer()
{
  GLuint name = 0;
  glCreateBuffers(1, &name);
  buffers_.insert(name);
  return name;
}

GLuint DeviceNames::create_texture(GLenum target)
{
  GLuint name = 0;
  glCreateTextures(target, 1, &name);
  textures_.insert(name);
  return name;
}

GLuint DeviceNames::create_texture_view()
{
  GLuint name = 0;
  glGenTextures(1, &name);
  textures_.insert(name);
  return name;
}

GLuint DeviceNames::create_sampler()
{
  GLuint name = 0;
  glCreateSamplers(1, &name);
  samplers_.insert(name);
  return name;
}

void DeviceNames::delete_buffers(std::span<const GLuint> names)
{
  glDeleteBuffers(GLsizei(names.size()), names.data());
  for (const GLuint name : names) {
    buffers_.erase(name);
  }
}

void DeviceNames::delete_textures(std::span<const GLuint> names)
{
  glDeleteTextures(GLsizei(names.size()), names.data());
  for (const GLuint name : names) {
    textures_.erase(name);
  }
}

void DeviceNames::delete_samplers(std::span<const GLuint> names)
{
  glDeleteSamplers(GLsizei(names.size()), names.data());
  for (const GLuint name : names) {
    samplers_.erase(name);
  }
}

GLuint DeviceNames::host_buffer(GLuint name) const
{
  return name != 0 && !buffers_.contains(name) && glIsBuffer(name) == GL_TRUE ? name : 0;
}

GLuint DeviceNames::host_texture(GLuint name) const
{
  return name != 0 && !textures_.contains(name) && glIsTexture(name) == GL_TRUE ? name : 0;
}

GLuint DeviceNames::host_sampler(GLuint name) const
{
  return name != 0 && !samplers_.contains(name) && glIsSampler(name) == GL_TRUE ? name : 0;
}

}  // namespace gnomon::gpu
