// SPDX-License-Identifier: MIT
#include "view_interface.hh"

#include "shader_check_reflection.hh"
#include "shader_files.hh"

#include <imgui.h>

#include <algorithm>

namespace gnomon::view {

namespace {

/** Of the window alone, so that the library of hosts does not have them. */
constexpr const char *interface_lib = R"(#include "shared/slots_shared.h"
PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** The upper left and the lower right corner of what is drawn. All from the upper left corner of the target. */
  vec4 clip_px;
  vec2 size_px;
  int first_vertex;
};
)";

constexpr const char *interface_vert = R"(#version 450 core
#include "interface_lib.glsl"
struct InterfaceVertex {
  vec2 position_px;
  vec2 uv;
  uint color;
};
layout(std140, binding = LINE_BLOCK_SLOT) readonly buffer vertex_block
{
  InterfaceVertex vertices[];
};
layout(location = 0) out vec4 color;
layout(location = 1) out vec2 uv;
layout(location = 2) out vec2 position_px;
void main()
{
#ifdef VULKAN
  InterfaceVertex vertex = vertices[first_vertex + gl_VertexIndex];
#else
  InterfaceVertex vertex = vertices[first_vertex + gl_VertexID];
#endif
  color = unpackUnorm4x8(vertex.color);
  uv = vertex.uv;
  position_px = vertex.position_px;
  vec2 place = 2.0 * position_px / size_px - 1.0;
  gl_Position = vec4(place.x, -place.y, 0.5, 1.0);
})";

constexpr const char *interface_frag = R"(#version 450 core
#include "interface_lib.glsl"
layout(binding = RADIANCE_SLOT) uniform sampler2D shown;
layout(location = 0) in vec4 color;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec2 position_px;
layout(location = 0) out vec4 result;
void main()
{
  vec4 texel = color * texture(shown, uv);
  if (any(lessThan(position_px, clip_px.xy)) || any(greaterThan(position_px, clip_px.zw))) {
    discard;
  }
  result = vec4(texel.rgb * texel.a, texel.a);
})";

std::optional<std::string_view> shader_file(std::string_view path)
{
  return path == "interface_lib.glsl"    ? interface_lib
         : path == "interface_vert.glsl" ? interface_vert
         : path == "interface_frag.glsl" ? interface_frag
                                         : shaders::file(path);
}

/** As in interface_lib. */
struct Constants {
  glm::vec4 clip_px;
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

InterfaceRenderer::InterfaceRenderer(gpu::Device &device)
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

InterfaceRenderer::~InterfaceRenderer()
{
  ImGui::GetIO().Fonts->SetTexID(nullptr);
}

void InterfaceRenderer::draw(const draw::Target &target, glm::ivec2 size_px)
{
  const ImDrawData &data = *ImGui::GetDrawData();
  const ImVec2 scale = data.FramebufferScale;
  const auto pixel_of = [&](float x, float y) {
    return glm::vec2((x - data.DisplayPos.x) * scale.x, (y - data.DisplayPos.y) * scale.y);
  };
  list_.clear();
  draw::begin_pass(list_, "interface", target, size_px, {{0, 0}, size_px}, {.clear_color = background});
  list_.set_shader(shader_.id());
  list_.set_state(gpu::State::WriteColor | gpu::State::BlendOver);
  vertices_.clear();
  const std::size_t count = std::size_t(std::max(data.TotalIdxCount, 1));
  const std::size_t size_bytes = count * sizeof(Vertex);
  if (!vertex_block_ || vertex_block_.size_bytes() < size_bytes) {
    vertex_block_ = device_.create_buffer({"interface_vertices", gpu::BufferKind::Storage, 2 * size_bytes});
  }
  const auto slot_of = [&](gpu::BindingKind kind, std::string_view name) {
    return shader_.interface().find(kind, name)->slot;
  };
  const int texture_slot = slot_of(gpu::BindingKind::Texture, "shown");
  list_.bind_storage(slot_of(gpu::BindingKind::StorageBlock, "vertex_block"), {vertex_block_.id()});
  for (const ImDrawList *drawn : std::span(data.CmdLists, std::size_t(data.CmdListsCount))) {
    for (const ImDrawCmd &command : drawn->CmdBuffer) {
      const ImVec4 &clip = command.ClipRect;
      const Constants constants{
          {pixel_of(clip.x, clip.y), pixel_of(clip.z, clip.w)}, glm::vec2(size_px), int(vertices_.size()), 0};
      for (unsigned i = 0; i < command.ElemCount; i++) {
        const ImDrawIdx index = drawn->IdxBuffer[int(command.IdxOffset + i)];
        const ImDrawVert &vertex = drawn->VtxBuffer[int(command.VtxOffset + index)];
        vertices_.push_back({pixel_of(vertex.pos.x, vertex.pos.y), {vertex.uv.x, vertex.uv.y}, vertex.col, {}});
      }
      const gpu::ResourceId texture = texture_of(command);
      const bool is_live = device_.find(gpu::ResourceKind::Texture, texture) != nullptr;
      list_.bind_texture(texture_slot, is_live ? texture : 0,
                         !is_live                ? 0
                         : texture == font_.id() ? linear_.id()
                                                 : enlarging_.id());
      list_.push_constants(shader_.interface().push_constant_slot, std::as_bytes(std::span(&constants, 1)));
      list_.draw_procedural(command.ElemCount, 1);
    }
  }
  list_.end_pass();
  if (!vertices_.empty()) {
    device_.update(vertex_block_, 0, std::as_bytes(std::span(vertices_)));
  }
  device_.submit(list_);
}

}  // namespace gnomon::view
