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
};

/** One queryable value of OpenGL 4.5 core state. */
struct StateItem {
  std::string name;
  std::function<std::vector<double>()> read;
};

/** All values of the table. */
[[nodiscard]] std::vector<StateItem> state_table();

/** Sets all items of state_table to values that are not the initial ones, as far as OpenGL has others. */
void set_unusual_state(const HostObjects &objects);

/** Values of a table at one time. */
class StateSnapshot {
 public:
  explicit StateSnapshot(const std::vector<StateItem> &table);
  /** "NAME: was 1, is 2" for each item that has changed. */
  [[nodiscard]] std::vector<std::string> differences() const;
  [[nodiscard]] std::vector<double> value(std::size_t item) const
  {
    return values_[item];
  }

 private:
  const std::vector<StateItem> &table_;
  std::vector<std::vector<double>> values_;
};

}  // namespace gnomon::test
