// SPDX-License-Identifier: MIT
// Names that the C++ of doc/embedding.md uses and a host declares.
#pragma once

#include <gnomon/gnomon.hh>

#include <glm/gtc/matrix_transform.hpp>

#include "shader_check_files.hh"
#include "shader_check_reflection.hh"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

using namespace gnomon;

struct Vertex {
  glm::vec3 position;
  glm::vec3 normal;
  glm::vec2 uv;
};

void paint(const glm::vec2 &uv);
void progress_bar(double part);
void status(const std::string &text);
void show(const gpu::Texture &texture, double texel);

/** Parameters of the function around each piece. */
#define GUIDE_NAMES                                                                                                 \
  std::unique_ptr<gpu::Device> &device, scene::Scene &scene, eevee::SceneRenderer &renderer, glm::ivec2 size_px,    \
      const scene::PlacedCamera &camera, const scene::PlacedCamera &right_camera, const draw::Target &target,       \
      const draw::Target &right_target, const draw::View &view, render_scene::RenderScene &shared,                  \
      draw::Viewport &viewport, const draw::Engine &former, scene::Handle<scene::Lamp> lamp,                        \
      scene::Handle<scene::Node> node, scene::Handle<scene::Node> selected, scene::Handle<scene::Mesh> mesh,        \
      const glm::dmat4 &parent_from_node, const glm::dvec3 &position_ws, std::size_t lamp_index,                    \
      const std::vector<std::uint32_t> &under_brush, const std::vector<glm::vec3> &positions,                       \
      const std::vector<glm::vec3> &normals, const std::vector<glm::dvec4> &planes_ws, unsigned framebuffer,        \
      unsigned vertices, unsigned indices, unsigned texture, std::uint32_t vertex_count, std::uint32_t index_count, \
      int x, int y, bool is_cancel_pressed
