// SPDX-License-Identifier: MIT
#include "view_imgui.hh"

#include "shader_check_reflection.hh"
#include "shader_files.hh"

#include <imgui.h>
#include <glm/common.hpp>
#include <glm/packing.hpp>

#include <algorithm>

namespace gnomon::view {

namespace {

/** Only the window has this source, so that the library of hosts does not. */
constexpr const char *interface_lib = R"(#include "shared/slots_shared.h"
PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  vec2 size_px;
  int first_vertex;
};
)";

constexpr const char *interface_vert = R"(#version 450 core
#include "interface_lib.glsl"
struct InterfaceVertex {
  vec2 position_px;
  vec2 uv;
  vec4 color;
};
layout(std140, binding = LINE_BLOCK_SLOT) readonly buffer vertex_block
{
  InterfaceVertex vertices[];
};
layout(location = 0) out vec4 color;
layout(location = 1) out vec2 uv;
void main()
{
#ifdef VULKAN
  InterfaceVertex vertex = vertices[first_vertex + gl_VertexIndex];
#else
  InterfaceVertex vertex = vertices[first_vertex + gl_VertexID];
#endif
  color = vertex.color;
  uv = vertex.uv;
  vec2 place = 2.0 * vertex.position_px / size_px - 1.0;
  gl_Position = vec4(place.x, -place.y, 0.5, 1.0);
})";

constexpr const char *interface_frag = R"(#version 450 core
#include "interface_lib.glsl"
layout(binding = RADIANCE_SLOT) uniform sampler2D shown;
layout(location = 0) in vec4 color;
layout(location = 1) in vec2 uv;
layout(location = 0) out vec4 result;
void main()
{
  vec4 texel = color * texture(shown, uv);
  result = vec4(texel.rgb * texel.a, texel.a);
})";

std::optional<std::string_view> shader_file(std::string_view path)
{
  return path == "interface_lib.glsl"    ? interface_lib
         : path == "interface_vert.glsl" ? interface_vert
         : path == "interface_frag.glsl" ? interface_frag
                                         : shaders::file(path);
}

/** The same as in interface_lib. */
struct Constants {
  glm::vec2 size_px;
  int first_vertex;
  int padding;
};

constexpr glm::vec4 background(0.14F, 0.14F, 0.15F, 1.0F);

gpu::ResourceId texture_of(const ImDrawCmd &command)
{
  return gpu::ResourceId(reinterpret_cast<std::uintptr_t>(command.GetTexID()));
}

}  // namespace

ImGuiBackend::ImGuiBackend(gpu::Device &device)
    : device_(device),
      linear_(device.create_sampler({.name = "interface_linear", .filter = gpu::Filter::Linear})),
      enlarging_(device.create_sampler(
          {.name = "interface_enlarging", .filter = gpu::Filter::Nearest, .minified = gpu::Filter::Linear})),
      shader_(device.create_shader({.name = "interface",
                                    .vertex_path = "interface_vert.glsl",
                                    .geometry_path = {},
                                    .fragment_path = "interface_frag.glsl",
                                    .defines = {}},
                                   shader_file, shader_check::reflect))
{
  ImFontAtlas &fonts = *ImGui::GetIO().Fonts;
  unsigned char *rgba = nullptr;
  glm::ivec2 size_px(0);
  fonts.GetTexDataAsRGBA32(&rgba, &size_px.x, &size_px.y);
  font_ = device.create_texture({.name = "interface_font", .width = size_px.x, .height = size_px.y});
  device.upload(font_, 0, std::as_bytes(std::span(rgba, 4 * std::size_t(size_px.x) * std::size_t(size_px.y))));
  fonts.SetTexID(reinterpret_cast<ImTextureID>(std::uintptr_t(font_.id())));
  ImGui::GetIO().BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
}

ImGuiBackend::~ImGuiBackend()
{
  ImGui::GetIO().Fonts->SetTexID(nullptr);
}

void ImGuiBackend::append_within(Polygon polygon, glm::vec2 low, glm::vec2 high)
{
  for (int side = 0; side < 4 && polygon.count > 0; side++) {
    const int axis = side / 2;
    const auto inside = [&](const Vertex &vertex) {
      return side % 2 == 0 ? vertex.position_px[axis] - low[axis] : high[axis] - vertex.position_px[axis];
    };
    const auto vertices = std::span(polygon.vertices).first(polygon.count);
    if (std::ranges::all_of(vertices, [&](const Vertex &vertex) { return inside(vertex) >= 0.0F; })) {
      continue;
    }
    Polygon clipped;
    for (std::size_t i = 0; i < polygon.count; i++) {
      const Vertex &from = polygon.vertices[i];
      const Vertex &to = polygon.vertices[(i + 1) % polygon.count];
      const float before = inside(from);
      const float after = inside(to);
      if (before >= 0.0F) {
        clipped.add(from);
      }
      if ((before >= 0.0F) != (after >= 0.0F)) {
        const float share = before / (before - after);
        Vertex cut{glm::mix(from.position_px, to.position_px, share), glm::mix(from.uv, to.uv, share),
                   glm::mix(from.color, to.color, share)};
        cut.position_px[axis] = side % 2 == 0 ? low[axis] : high[axis];
        clipped.add(cut);
      }
    }
    polygon = clipped;
  }
  for (std::size_t i = 2; i < polygon.count; i++) {
    vertices_.insert(vertices_.end(), {polygon.vertices[0], polygon.vertices[i - 1], polygon.vertices[i]});
  }
}

void ImGuiBackend::gather()
{
  const ImDrawData &data = *ImGui::GetDrawData();
  const auto pixel_of = [&](float x, float y) {
    return glm::vec2((x - data.DisplayPos.x) * data.FramebufferScale.x,
                     (y - data.DisplayPos.y) * data.FramebufferScale.y);
  };
  vertices_.clear();
  draws_.clear();
  // An array before Dear ImGui 1.90, and then a vector.
  for (int i = 0; i < data.CmdListsCount; i++) {
    const ImDrawList *drawn = data.CmdLists[i];
    for (const ImDrawCmd &command : drawn->CmdBuffer) {
      const gpu::ResourceId texture = texture_of(command);
      if (draws_.empty() || draws_.back().texture != texture) {
        draws_.push_back({texture, vertices_.size()});
      }
      const ImVec4 &clip = command.ClipRect;
      const glm::vec2 low = pixel_of(clip.x, clip.y);
      const glm::vec2 high = pixel_of(clip.z, clip.w);
      const ImDrawIdx *index = &drawn->IdxBuffer.Data[command.IdxOffset];
      for (unsigned i = 0; i < command.ElemCount; i += 3) {
        Polygon triangle;
        for (; triangle.count < 3; index++) {
          const ImDrawVert &vertex = drawn->VtxBuffer.Data[command.VtxOffset + *index];
          triangle.add(
              {pixel_of(vertex.pos.x, vertex.pos.y), {vertex.uv.x, vertex.uv.y}, glm::unpackUnorm4x8(vertex.col)});
        }
        append_within(triangle, low, high);
      }
    }
  }
}

void ImGuiBackend::draw(const draw::Target &target, glm::ivec2 size_px)
{
  gather();
  const std::size_t size_bytes = std::max(vertices_.size(), std::size_t(1)) * sizeof(Vertex);
  if (!vertex_block_ || vertex_block_.size_bytes() < size_bytes) {
    vertex_block_ = device_.create_buffer({"interface_vertices", gpu::BufferKind::Storage, 2 * size_bytes});
  }
  if (!vertices_.empty()) {
    device_.update(vertex_block_, 0, std::as_bytes(std::span(vertices_)));
  }
  list_.clear();
  draw::begin_pass(list_, "interface", target, size_px, {{0, 0}, size_px}, {.clear_color = background});
  list_.set_shader(shader_.id());
  list_.set_state(gpu::State::WriteColor | gpu::State::BlendOver);
  const auto slot_of = [&](gpu::BindingKind kind, std::string_view name) {
    return shader_.interface().find(kind, name)->slot;
  };
  const int texture_slot = slot_of(gpu::BindingKind::Texture, "shown");
  list_.bind_storage(slot_of(gpu::BindingKind::StorageBlock, "vertex_block"), {vertex_block_.id()});
  for (std::size_t i = 0; i < draws_.size(); i++) {
    const auto [texture, first_vertex] = draws_[i];
    const std::size_t end = i + 1 < draws_.size() ? draws_[i + 1].first_vertex : vertices_.size();
    if (end == first_vertex) {
      continue;
    }
    const bool is_live = device_.find(gpu::ResourceKind::Texture, texture) != nullptr;
    list_.bind_texture(texture_slot, is_live ? texture : 0,
                       !is_live                ? 0
                       : texture == font_.id() ? linear_.id()
                                               : enlarging_.id());
    const Constants constants{glm::vec2(size_px), int(first_vertex), 0};
    list_.push_constants(shader_.interface().push_constant_slot, std::as_bytes(std::span(&constants, 1)));
    list_.draw_procedural(std::uint32_t(end - first_vertex), 1);
  }
  list_.end_pass();
  device_.submit(list_);
}

}  // namespace gnomon::view
