// SPDX-License-Identifier: MIT
#pragma once

#include "draw_pass.hh"

#include "gpu/gpu_testing.hh"

#include <string>

namespace gnomon::test {

/** A shader that reads one binding of each kind. */
inline constexpr const char *EVERYTHING_VERT = R"(
#define DRAW_INSTANCES
#include "draw/draw_object_lib.glsl"
layout(location = 0) flat out uvec2 instance;
void main()
{
  gl_Position = vertex_position_ws();
  instance = draw_instance;
}
)";
inline constexpr const char *EVERYTHING_FRAG = R"(
layout(std140, binding = 9) uniform view_block
{
  vec4 view;
};
layout(std140, binding = 10) uniform light_block
{
  vec4 light;
};
layout(std140, binding = 1) readonly buffer material_block
{
  vec4 material;
};
layout(std140, binding = 2) readonly buffer other_block
{
  vec4 other;
};
layout(binding = 16) uniform sampler2D picture;
layout(binding = 17) uniform sampler2D mask;
PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  vec4 color;
  int face;
  float bias;
};
layout(location = 0) flat in uvec2 instance;
layout(location = 0) out vec4 result;
void main()
{
  result = view + light + material + other + texture(picture, vec2(0)) + texture(mask, vec2(0)) + color +
           vec4(face, bias, instance);
}
)";

/** A pass with every kind of binding and call, on any device. */
struct EverythingPass {
  explicit EverythingPass(gpu::Device &owner) : device(owner)
  {
    objects.upload(device);
    draw::ShadingGroup &first = pass.group(shader);
    first.bind_storage("object_block", objects.buffer());
    first.bind_uniform("view_block", view_block);
    first.bind_uniform_ref("light_block", &light_range);
    first.bind_storage("material_block", material_block);
    first.bind_storage_ref("other_block", &other_range);
    first.bind_texture("picture", picture, sampler);
    first.bind_texture_ref("mask", &mask_binding);
    first.constant("color", glm::vec4(1));
    first.constant_ref("face", &face);
    first.state_enable(gpu::State::CullBack | gpu::State::BlendAdd);
    first.call(quad);
    first.call(quad, glm::mat4(2));
    first.call(triangle, 5, {{0, 0, 0}, 1});
    draw::InstanceCall &triangles = first.instances(triangle);
    for (std::uint32_t i = 0; i < 4; i++) {
      triangles.add(3, i);
    }
    draw::InstanceCall &quads = first.instances(quad);
    for (std::uint32_t i = 0; i < 6; i++) {
      quads.add(2, i);
    }
    first.call_procedural(2, 3);
    pass.group(shader);
  }

  static constexpr const char *TEXT =
      "everything [write_color depth_nearer_equal]\n"
      "  group everything [cull_back blend_add]\n"
      "    storage object_block -> 0 = object_block\n"
      "    uniform view_block -> 9 = view\n"
      "    uniform light_block -> 10 by reference\n"
      "    storage material_block -> 1 = materials\n"
      "    storage other_block -> 2 by reference\n"
      "    texture picture -> 16 = hdr\n"
      "    texture mask -> 17 by reference\n"
      "    constant color\n"
      "    constant face by reference\n"
      "    call 2 triangles from 0, object 0\n"
      "    call 2 triangles from 0, object 1\n"
      "    call 1 triangles from 6, object 5, culled\n"
      "    instances 1 triangles from 6 x4\n"
      "    instances 2 triangles from 0 x6\n"
      "    procedural 2 triangles x3\n"
      "  group everything\n";

  gpu::Device &device;
  gpu::Shader shader = make_shader(device, "everything", EVERYTHING_VERT, EVERYTHING_FRAG);
  gpu::Buffer view_block = device.create_buffer({.name = "view", .size_bytes = 16});
  gpu::Buffer light_block = device.create_buffer({.name = "light", .size_bytes = 512});
  gpu::Buffer material_block = device.create_buffer({"materials", gpu::BufferKind::Storage, 16});
  gpu::Texture picture = device.create_texture({.name = "hdr"});
  gpu::Sampler sampler = device.create_sampler({.name = "linear"});
  std::array<glm::vec3, 4> positions = {glm::vec3(0), glm::vec3(1, 0, 0), glm::vec3(1, 1, 0), glm::vec3(0, 1, 0)};
  std::array<std::uint32_t, 6> indices = {0, 1, 2, 0, 2, 3};
  gpu::Batch quad = device.create_batch({"quad", positions, {}, indices});
  gpu::Batch triangle = device.create_batch({"triangle", positions, {}, std::span(indices).first(3)});
  gpu::BufferRange light_range{light_block.id(), 256, 16};
  gpu::BufferRange other_range{material_block.id(), 0, 16};
  draw::TextureBinding mask_binding{picture.id(), sampler.id()};
  int face = 0;
  draw::ObjectBuffer objects;
  draw::Pass pass{"everything", gpu::State::WriteColor | gpu::State::DepthNearerEqual, &objects};
};

/** The complete content of a list as text. Equal texts mean equal lists. */
inline std::string dump(const gpu::CommandList &list)
{
  std::string text;
  for (const gpu::Command &c : list.commands()) {
    text += fmt::format("{} slot {} id {} first {} count {}", int(c.kind), c.slot, c.id, c.first, c.count);
    if (c.kind == gpu::CommandKind::PushConstants || c.kind == gpu::CommandKind::Update) {
      for (const std::byte byte : std::span(list.bytes()).subspan(c.first, c.count)) {
        text += fmt::format(" {:02x}", int(byte));
      }
    }
    text += "\n";
  }
  for (const gpu::DrawIndirect &d : list.draws) {
    text += fmt::format("draw {} indices from {} base {} x{} from {}\n", d.index_count, d.first_index, d.base_vertex,
                        d.instance_count, d.first_instance);
  }
  for (const gpu::DrawInstance &i : list.instances) {
    text += fmt::format("instance {} {}\n", i.object, i.value);
  }
  return text;
}

}  // namespace gnomon::test
