// SPDX-License-Identifier: MIT
#pragma once

#include "draw_target.hh"

#include <vector>

namespace gnomon::view {

/** Draws the user interface of Dear ImGui by a device, which must outlive it. \pre there is a context of Dear ImGui */
class InterfaceRenderer {
 public:
  /** Make the texture of the font and the program. \throws gpu::Error */
  explicit InterfaceRenderer(gpu::Device &device);
  ~InterfaceRenderer();
  InterfaceRenderer(const InterfaceRenderer &) = delete;
  InterfaceRenderer &operator=(const InterfaceRenderer &) = delete;

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
    /** sRGB, four bytes. */
    std::uint32_t color;
    std::uint32_t padding[3];
  };

  gpu::Device &device_;
  gpu::Texture font_;
  gpu::Sampler linear_;
  /** For pictures: a pixel that is shown larger than it is has edges. */
  gpu::Sampler enlarging_;
  gpu::Shader shader_;
  gpu::Buffer vertex_block_;
  /** Kept, so that a frame allocates no memory. */
  std::vector<Vertex> vertices_;
  gpu::CommandList list_;
};

}  // namespace gnomon::view
