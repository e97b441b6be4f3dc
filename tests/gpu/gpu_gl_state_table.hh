// SPDX-License-Identifier: MIT
#pragma once

#include <epoxy/gl.h>

#include <fmt/format.h>

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace gnomon::test {

/** Objects of a host, for bindings that are not 0. */
struct HostObjects {
  HostObjects();
  ~HostObjects();
  HostObjects(const HostObjects &) = delete;
  HostObjects &operator=(const HostObjects &) = delete;

  static constexpr std::array<GLenum, 11> texture_targets = {GL_TEXTURE_1D,
                                                             GL_TEXTURE_2D,
                                                             GL_TEXTURE_3D,
                                                             GL_TEXTURE_1D_ARRAY,
                                                             GL_TEXTURE_2D_ARRAY,
                                                             GL_TEXTURE_RECTANGLE,
                                                             GL_TEXTURE_BUFFER,
                                                             GL_TEXTURE_CUBE_MAP,
                                                             GL_TEXTURE_CUBE_MAP_ARRAY,
                                                             GL_TEXTURE_2D_MULTISAMPLE,
                                                             GL_TEXTURE_2D_MULTISAMPLE_ARRAY};
  std::array<GLuint, 11> textures{};
  GLuint buffer = 0;
  GLuint sampler = 0;
  GLuint vertex_array = 0;
  GLuint program = 0;
  GLuint pipeline = 0;
  GLuint draw_framebuffer = 0;
  GLuint read_framebuffer = 0;
  GLuint renderbuffer = 0;
  GLuint transform_feedback = 0;

  /** Objects of one kind, which a host may delete while they are bound. */
  struct Kind {
    const char *name;
    /** Whether contexts share these objects, so that another context may delete them. */
    bool is_shared;
    void (HostObjects::*destroy)();
  };
  [[nodiscard]] static const std::vector<Kind> &kinds();

 private:
  void delete_buffer();
  void delete_textures();
  void delete_sampler();
  void delete_renderbuffer();
  void delete_program();
  void delete_vertex_array();
  void delete_pipeline();
  void delete_framebuffers();
  void delete_transform_feedback();
};

/** glIsBuffer and so on. */
using IsObject = std::function<GLboolean(GLuint name)>;

/** One queryable value of OpenGL 4.5 core state. */
struct StateItem {
  std::string name;
  std::function<std::vector<double>()> read;
  /** OpenGL's function that tells whether the first value names an object. Empty if the value is no object. */
  IsObject is_object{};
};

/** All values of the table. */
[[nodiscard]] std::vector<StateItem> state_table();

/** Sets all items of state_table to values that are not the initial ones, as far as OpenGL has others. */
void set_unusual_state(const HostObjects &objects);

/** Values of a table at one time. */
class StateSnapshot {
 public:
  /**
   * \a deletions: taken after the host deleted objects that stay bound, whose names are free; later, objects of a
   * device may have them.
   */
  explicit StateSnapshot(const std::vector<StateItem> &table, const StateSnapshot *deletions = nullptr);
  /**
   * "NAME: was 1, is 2" for each item that has changed. The name of an object that was deleted when the snapshot was
   * taken may have become 0.
   */
  [[nodiscard]] std::vector<std::string> differences() const;
  /** Names of the items whose objects were deleted and still bound. */
  [[nodiscard]] std::vector<std::string> deleted() const;
  [[nodiscard]] std::vector<double> value(std::size_t item) const
  {
    return values_[item];
  }

 private:
  const std::vector<StateItem> &table_;
  std::vector<std::vector<double>> values_;
  std::vector<bool> are_deleted_;
};

}  // namespace gnomon::test
