// SPDX-License-Identifier: MIT
#pragma once

#include "gl_names.hh"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::gpu {

/** Returns "GL_INVALID_ENUM" and so on. */
[[nodiscard]] std::string gl_error_name(GLenum error);

/** Get and clear all errors that are pending in the current context, oldest first; at most 32. */
[[nodiscard]] std::vector<GLenum> take_gl_errors();

/**
 * Make \a error pending again, without a debug message. \return false if OpenGL offers no way to raise it, that is, for
 * errors other than GL_INVALID_ENUM, GL_INVALID_VALUE and GL_INVALID_OPERATION
 */
bool raise_gl_error(GLenum error);

enum class PixelTransfer { Pack, Unpack };

/**
 * The state of a context that calls of a device change. In a host's context, each function keeps what the host has
 * set, before the first change of it; restore() sets it again, and the next change is kept anew. In a context of the
 * device, nothing is kept.
 *
 * A name that the host has deleted while it was bound, perhaps in a context that shares objects with this one, cannot
 * be bound again. Neither can a program that is flagged for deletion, unless another context uses it, or one that did
 * not link a second time. Such bindings are left empty, and no call here raises an error of OpenGL.
 *
 * A name that is free again may be given to an object of the device: \see DeviceNames.
 */
class HostState {
 public:
  /**
   * \a is_host: whether the current context is a host's. Otherwise sets the state that the functions below set.
   * \a names: of the device; must outlive this object
   */
  HostState(bool is_host, const DeviceNames &names);

  /**
   * Before the first draw or clear: program, vertex array, draw framebuffer, indirect buffer, capabilities, depth,
   * culling, viewport 0, scissor tests, clip control and the modes of polygons, lines and points. In a host's context,
   * sets what a command list does not set itself.
   */
  void keep_draw_state();
  /** Before a change of the polygon offset. */
  void keep_polygon_offset();
  /** Before changes of blending and colour masks of the draw buffers below \a count. */
  void keep_color_buffers(GLuint count);
  /** Before changes of the colour masks alone. */
  void keep_color_masks(GLuint count);
  /** Before a binding of an index of \a target: GL_UNIFORM_BUFFER or GL_SHADER_STORAGE_BUFFER. */
  void keep_indexed_buffer(GLenum target, GLuint slot);
  /** Before a binding of \a target without an index. */
  void keep_buffer(GLenum target);
  /** Before a binding of a texture of \a target, and of a sampler, to \a unit. */
  void keep_texture(GLuint unit, GLenum target);
  /** Before a transfer of pixels from or to memory. In a host's context, sets tightly packed rows. */
  void keep_pixel_store(PixelTransfer transfer);

  void restore();

 private:
  static constexpr std::size_t pixel_parameter_count = 8;
  struct Buffer {
    GLenum target;
    GLuint name;
  };
  struct IndexedBuffer {
    GLenum target;
    GLuint slot;
    GLuint name;
    GLint64 offset_bytes;
    GLint64 size_bytes;
  };
  struct BoundTexture {
    GLuint unit;
    GLenum target;
    GLuint name;
  };
  struct BoundSampler {
    GLuint unit;
    GLuint name;
  };
  struct ColorBuffer {
    GLboolean is_blended;
    std::array<GLint, 4> functions;
    std::array<GLint, 2> equations;
  };
  struct PixelStore {
    PixelTransfer transfer;
    std::array<GLint, pixel_parameter_count> values;
  };
  struct DrawState {
    GLuint program = 0;
    bool is_program_deleted = false;
    GLuint vertex_array = 0;
    GLuint draw_framebuffer = 0;
    /** In the order of used_capabilities in gl_state.cc. */
    std::vector<GLboolean> capabilities{};
    /** Indexed by viewport. */
    std::vector<GLboolean> scissor_tests{};
    std::array<GLfloat, 4> viewport{};
    std::array<GLint, 4> scissor_box{};
    std::array<GLdouble, 2> depth_range{};
    GLint clip_origin = 0;
    GLint clip_depth = 0;
    GLint depth_function = 0;
    GLboolean depth_mask = GL_FALSE;
    GLint cull_face = 0;
    GLint front_face = 0;
    GLint polygon_mode = 0;
    GLfloat line_width = 1.0F;
    GLfloat point_size = 1.0F;
    GLint provoking_vertex = 0;
  };
  struct PolygonOffset {
    GLfloat factor = 0.0F;
    GLfloat units = 0.0F;
    /** 0 if the context has no clamp. */
    GLfloat clamp = 0.0F;
  };
  void restore_bindings();
  void restore(const DrawState &saved) const;

  bool is_host_;
  const DeviceNames &names_;
  GLint viewport_count_ = 0;
  std::optional<DrawState> draw_;
  std::optional<PolygonOffset> polygon_offset_;
  std::optional<GLint> active_texture_;
  std::vector<Buffer> buffers_;
  std::vector<IndexedBuffer> indexed_buffers_;
  std::vector<BoundTexture> textures_;
  std::vector<BoundSampler> samplers_;
  std::vector<ColorBuffer> color_buffers_;
  std::vector<std::array<GLboolean, 4>> color_masks_;
  std::vector<PixelStore> pixel_stores_;
};

/**
 * Describes active state of the host that cannot be saved and that draws would affect, or that would affect draws: a
 * query, transform feedback or conditional rendering. Returns an empty string if there is none.
 *
 * OpenGL cannot query conditional rendering, but beginning it fails while it is active. \a probe_query: the query
 * object for this attempt; created if it is 0; owned by the caller
 */
[[nodiscard]] std::string unsaveable_state(GLuint &probe_query);

}  // namespace gnomon::gpu
