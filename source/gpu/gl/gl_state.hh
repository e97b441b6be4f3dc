// SPDX-License-Identifier: MIT
#pragma once

#include <epoxy/gl.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::gpu {

/** "GL_INVALID_ENUM", … */
[[nodiscard]] std::string gl_error_name(GLenum error);

/** All errors that are pending in the current context, oldest first. None is pending afterwards. */
[[nodiscard]] std::vector<GLenum> take_gl_errors();

/**
 * Make \a error pending again, without a debug message. \return false where OpenGL offers no way to raise it: any other
 * than GL_INVALID_ENUM, GL_INVALID_VALUE and GL_INVALID_OPERATION.
 */
bool raise_gl_error(GLenum error);

/** Saves the binding of the buffer target \a target, without its index, and restores it on destruction. */
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

/** Sets tightly packed rows in client memory for transfers in one direction. Restores the state on destruction. */
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

/** Indexed state that a command list changes. */
struct UsedSlots {
  std::vector<GLuint> uniform_slots;
  std::vector<GLuint> storage_slots;
  std::vector<GLuint> texture_units;
  /** Draw buffers from 0 on. */
  GLuint color_count = 0;

  /** Add \a slot to \a slots, unless it is in it. */
  static void add(std::vector<GLuint> &slots, GLuint slot);
  void clear();
};

/** Set all state that affects draws and clears, and that command lists do not set themselves, to the initial values. */
void set_draw_defaults();

/**
 * All state of the current context that set_draw_defaults() and a command list change. Saved on construction, restored
 * on destruction.
 *
 * This is: program, vertex array, draw framebuffer; the bindings of the indirect, uniform and storage buffers, with
 * their indexed bindings at the used slots; texture (2D, 2D array) and sampler of the used units; active texture;
 * viewport, scissor box and depth range of viewport 0; scissor tests; clip control; the capabilities of gl_state.cc;
 * blending and colour mask of the used draw buffers; depth function and mask; cull face, front face, polygon mode;
 * provoking vertex. Everything else is not changed by a submit.
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
  /** By viewport. */
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
  GLint provoking_vertex_ = 0;
};

/**
 * The reason why draws of a library would disturb the host, or be disturbed by it: an active query, active transform
 * feedback or conditional rendering. Empty: none.
 *
 * OpenGL has no query for conditional rendering; beginning it fails while it is active. \a probe_query is the query
 * object for this attempt: created where it is 0, owned by the caller.
 */
[[nodiscard]] std::string unsaveable_state(GLuint &probe_query);

}  // namespace gnomon::gpu
