// SPDX-License-Identifier: MIT
#pragma once

#include <epoxy/gl.h>

#include <span>
#include <unordered_set>

namespace gnomon::gpu {

/**
 * Creates and deletes the buffers, textures and samplers of a device, and knows the names of those that exist.
 *
 * Drivers give free names to new objects. In a host's context, a binding with a name of the device is therefore one of
 * an object that the host deleted while it was bound, in another context: hosts do not know the device's names.
 */
class DeviceNames {
 public:
  [[nodiscard]] GLuint create_buffer();
  [[nodiscard]] GLuint create_texture(GLenum target);
  /** A name for glTextureView. */
  [[nodiscard]] GLuint create_texture_view();
  [[nodiscard]] GLuint create_sampler();
  /** Names that are 0 are ignored, as by OpenGL. */
  void delete_buffers(std::span<const GLuint> names);
  void delete_textures(std::span<const GLuint> names);
  void delete_samplers(std::span<const GLuint> names);

  /** \a name if it is that of an object of the host; 0 if no such object exists. */
  [[nodiscard]] GLuint host_buffer(GLuint name) const;
  [[nodiscard]] GLuint host_texture(GLuint name) const;
  [[nodiscard]] GLuint host_sampler(GLuint name) const;

 private:
  std::unordered_set<GLuint> buffers_;
  std::unordered_set<GLuint> textures_;
  std::unordered_set<GLuint> samplers_;
};

}  // namespace gnomon::gpu
