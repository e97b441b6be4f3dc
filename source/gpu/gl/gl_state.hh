// SPDX-License-Identifier: MIT
#pragma once

#include <epoxy/gl.h>

#include <array>
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

/** Saves the non-indexed buffer binding of a target, and restores it on destruction. */
class SavedBufferBinding {
 public:
  explicit SavedBufferBinding(GLenum target);
  ~SavedBufferBinding();
  SavedBufferBinding(const SavedBufferBinding &) = delete;
  SavedBufferBinding &operator=(const SavedBufferBinding &) = delete;

 private:
  GLenum target_;
  GLint buffer_ = 0;
};

enum class PixelTransfer { Pack, Unpack };

/**
 * Sets up pixel transfers in one direction with tightly packed rows in client memory. Restores the previous state on
 * destruction.
 */
class SavedPixelStore {
 public:
  explicit SavedPixelStore(PixelTransfer transfer);
  ~SavedPixelStore();
  SavedPixelStore(const SavedPixelStore &) = delete;
  SavedPixelStore &operator=(const SavedPixelStore &) = delete;

 private:
  static constexpr std::size_t parameter_count = 8;
  PixelTransfer transfer_;
  SavedBufferBinding buffer_;
  std::array<GLint, parameter_count> values_{};
};

/** Indices of the indexed state that a command list changes. */
struct UsedSlots {
  std::vector<GLuint> uniform_slots;
  std::vector<GLuint> storage_slots;
  std::vector<GLuint> texture_units;
  /** Number of used draw buffers, beginning with draw buffer 0. */
  GLuint color_count = 0;

  /** Add \a slot to \a slots if it is not in it. */
  static void add(std::vector<GLuint> &slots, GLuint slot);
  void clear();
};

/** Set all state that affects draws and clears and that command lists do not set themselves. */
void set_draw_defaults();

/**
 * Saves all state of the current context that set_draw_defaults() and a command list change, and restores it on
 * destruction. A submission changes no other state. The saved state is:
 * - program, vertex array and draw framebuffer;
 * - bindings of the indirect, uniform and storage buffers, and the indexed bindings of the used slots;
 * - textures (2D, 2D array, buffer) and samplers of the used units, and the active texture unit;
 * - viewport, scissor box and depth range of viewport 0, and the scissor tests of all viewports;
 * - clip control, polygon mode and provoking vertex;
 * - the capabilities listed in gl_state.cc;
 * - blending and colour mask of the used draw buffers;
 * - depth function, depth mask, cull face and front face.
 */
class SavedDrawState {
 public:
  explicit SavedDrawState(const UsedSlots &slots);
  ~SavedDrawState();
  SavedDrawState(const SavedDrawState &) = delete;
  SavedDrawState &operator=(const SavedDrawState &) = delete;

 private:
  struct IndexedBuffer {
    GLenum target;
    GLuint slot;
    GLint buffer;
    GLint64 offset_bytes;
    GLint64 size_bytes;
  };
  struct TextureUnit {
    GLuint unit;
    GLint texture_2d;
    GLint texture_2d_array;
    GLint texture_buffer;
    GLint sampler;
  };
  struct ColorBuffer {
    GLboolean is_blended;
    std::array<GLboolean, 4> mask;
    std::array<GLint, 4> functions;
    std::array<GLint, 2> equations;
  };
  void save_indexed(GLenum target, GLenum start, GLenum size, const std::vector<GLuint> &slots);

  std::vector<IndexedBuffer> indexed_buffers_;
  std::vector<TextureUnit> texture_units_;
  std::vector<ColorBuffer> color_buffers_;
  std::vector<GLboolean> capabilities_;
  /** Indexed by viewport. */
  std::vector<GLboolean> scissor_tests_;
  GLint active_texture_ = 0;
  GLint program_ = 0;
  GLint vertex_array_ = 0;
  GLint draw_framebuffer_ = 0;
  GLint indirect_buffer_ = 0;
  GLint uniform_buffer_ = 0;
  GLint storage_buffer_ = 0;
  std::array<GLfloat, 4> viewport_{};
  std::array<GLint, 4> scissor_box_{};
  std::array<GLdouble, 2> depth_range_{};
  GLint clip_origin_ = 0;
  GLint clip_depth_ = 0;
  GLint depth_function_ = 0;
  GLboolean depth_mask_ = GL_FALSE;
  GLint cull_face_ = 0;
  GLint front_face_ = 0;
  GLint polygon_mode_ = 0;
  GLfloat line_width_ = 1.0F;
  GLfloat point_size_ = 1.0F;
  GLint provoking_vertex_ = 0;
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
