// SPDX-License-Identifier: MIT
#pragma once

#include "draw_target.hh"

#include <glm/vec4.hpp>

#include <array>
#include <vector>

namespace gnomon::view {

/** Draws the user interface of Dear ImGui by a device, which must outlive it. \pre there is a context of Dear ImGui */
class ImGuiBackend {
 public:
  /** Make the texture of the font and the program. \throws gpu::Error */
  explicit ImGuiBackend(gpu::Device &device);
  ~ImGuiBackend();
  ImGuiBackend(const ImGuiBackend &) = delete;
  ImGuiBackend &operator=(const ImGuiBackend &) = delete;

  /**
   * Replace the content of \a target, a framebuffer of \a size_px, by what ImGui::Render has made last. An ImTextureID
   * is the gpu::ResourceId of a texture; one that was destroyed in this frame is black. \throws gpu::Error
   */
  void draw(const draw::Target &target, glm::ivec2 size_px);

 private:
  /** A vertex of a triangle. The same as in GLSL. */
  struct Vertex {
    /** From the upper left corner. */
    glm::vec2 position_px;
    glm::vec2 uv;
    /** sRGB. */
    glm::vec4 color;
  };
  /** A triangle within a rectangle: each of its four sides may add a vertex. */
  struct Polygon {
    std::array<Vertex, 7> vertices;
    std::size_t count = 0;

    void add(const Vertex &vertex)
    {
      vertices[count++] = vertex;
    }
  };
  /** Triangles that are drawn with one texture, up to those of the next one. */
  struct Draw {
    gpu::ResourceId texture = 0;
    std::size_t first_vertex = 0;
  };

  /** Gathers the triangles of ImGui::Render, within the rectangles that clip them. */
  void gather();
  /**
   * Appends the part of \a polygon, a triangle, between two corners of a rectangle, as triangles: the rectangles of
   * many commands then share a draw, and no fragment is tested.
   */
  void append_within(Polygon polygon, glm::vec2 low, glm::vec2 high);

  gpu::Device &device_;
  gpu::Texture font_;
  gpu::Sampler linear_;
  /** For pictures: a pixel that is shown larger than it is has edges. */
  gpu::Sampler enlarging_;
  gpu::Shader shader_;
  gpu::Buffer vertex_block_;
  /** Kept, so that a frame allocates no memory. */
  std::vector<Vertex> vertices_;
  std::vector<Draw> draws_;
  gpu::CommandList list_;
};

}  // namespace gnomon::view
