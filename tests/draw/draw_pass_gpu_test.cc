// SPDX-License-Identifier: MIT
#include "draw/draw_pass_fixture.hh"
#include "gpu_device_fixture.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

namespace gnomon::draw {
namespace {

using test::make_shader;

class PassGpu : public test::SharedDeviceTest {
 protected:
  static constexpr int SIZE = 8;

  void SetUp() override
  {
    SharedDeviceTest::SetUp();
    if (!device) {
      return;
    }
    picture =
        device->create_texture({.name = "picture", .format = gpu::Format::RGBA32F, .width = SIZE, .height = SIZE});
    framebuffer = device->create_framebuffer({"picture", {{&picture}}, {}});
    full = test::full_triangle(*device, 0.5F);
  }

  void record(const Pass &pass, gpu::CommandList &list, const View &view = View()) const
  {
    list.begin_pass(pass.name(), framebuffer, {.clear_color = glm::vec4(-1)});
    pass.record(view, list);
    list.end_pass();
  }
  std::vector<glm::vec4> drawn(const Pass &pass, const View &view = View())
  {
    gpu::CommandList list;
    record(pass, list, view);
    device->submit(list);
    return gpu::read_as<glm::vec4>(*device, picture);
  }

  gpu::Texture picture;
  gpu::Framebuffer framebuffer;
  gpu::Batch full;
};

TEST_F(PassGpu, SerializesAsOnTheNullBackend)
{
  // Batches have the same positions in the pool as on a device of their own.
  full = gpu::Batch();
  const test::EverythingPass everything(*device);
  EXPECT_EQ(everything.pass.serialize(*device), test::EverythingPass::TEXT);
  const auto null = gpu::create_null_device();
  const test::EverythingPass on_null(*null);
  gpu::CommandList here;
  gpu::CommandList there;
  everything.pass.record(View(), here);
  on_null.pass.record(View(), there);
  EXPECT_EQ(here.serialize(*device), there.serialize(*null));
}

TEST_F(PassGpu, ConstantByReferenceChangesThePictureAndByValueDoesNot)
{
  const gpu::Shader shader = make_shader(*device, "color", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  glm::vec4 color(1);
  Pass value("value", gpu::State::WriteColor);
  ShadingGroup &by_value = value.group(shader);
  by_value.constant("color", color);
  by_value.call(full);
  Pass reference("reference", gpu::State::WriteColor);
  ShadingGroup &by_reference = reference.group(shader);
  by_reference.constant_ref("color", &color);
  by_reference.call(full);
  EXPECT_EQ(drawn(value)[0], glm::vec4(1));
  EXPECT_EQ(drawn(reference)[0], glm::vec4(1));
  color = glm::vec4(2);
  EXPECT_EQ(drawn(value)[0], glm::vec4(1));
  EXPECT_EQ(drawn(reference)[0], glm::vec4(2));
}

TEST_F(PassGpu, UniformRangeByReferenceChangesThePictureAndByValueDoesNot)
{
  const gpu::Shader shader = make_shader(*device, "block", test::CLIP_SPACE_VERT, R"(
layout(std140, binding = 9) uniform color_block
{
  vec4 color;
};
layout(location = 0) out vec4 result;
void main()
{
  result = color;
})");
  const std::uint32_t stride = std::max(device->limits().uniform_offset_alignment, 16U);
  const gpu::Buffer block = device->create_buffer({.name = "block", .size_bytes = std::size_t(stride) * 2});
  for (int i = 0; i < 2; i++) {
    const glm::vec4 value(float(i + 1));
    device->update(block, std::size_t(i) * stride, std::as_bytes(std::span(&value, 1)));
  }
  gpu::BufferRange range{block.id(), 0, 16};
  Pass value("value", gpu::State::WriteColor);
  ShadingGroup &by_value = value.group(shader);
  by_value.bind_uniform("color_block", block);
  by_value.call(full);
  Pass reference("reference", gpu::State::WriteColor);
  ShadingGroup &by_reference = reference.group(shader);
  by_reference.bind_uniform_ref("color_block", &range);
  by_reference.call(full);
  EXPECT_EQ(drawn(value)[0], glm::vec4(1));
  EXPECT_EQ(drawn(reference)[0], glm::vec4(1));
  range.offset_bytes = stride;
  EXPECT_EQ(drawn(value)[0], glm::vec4(1));
  EXPECT_EQ(drawn(reference)[0], glm::vec4(2));
}

TEST_F(PassGpu, TextureByReferenceChangesThePictureAndByValueDoesNot)
{
  const gpu::Shader shader = make_shader(*device, "texture", test::CLIP_SPACE_VERT, R"(
layout(binding = 16) uniform sampler2D source;
layout(location = 0) out vec4 result;
void main()
{
  result = vec4(texture(source, vec2(0.5)).r);
})");
  const gpu::Sampler sampler = device->create_sampler({.name = "nearest"});
  std::array<gpu::Texture, 2> sources;
  for (std::size_t i = 0; i < 2; i++) {
    sources[i] = device->create_texture({.name = "source", .format = gpu::Format::R32F});
    const auto value = float(i + 1);
    device->upload(sources[i], 0, std::as_bytes(std::span(&value, 1)));
  }
  TextureBinding binding{sources[0].id(), sampler.id()};
  Pass value("value", gpu::State::WriteColor);
  ShadingGroup &by_value = value.group(shader);
  by_value.bind_texture("source", sources[0], sampler);
  by_value.call(full);
  Pass reference("reference", gpu::State::WriteColor);
  ShadingGroup &by_reference = reference.group(shader);
  by_reference.bind_texture_ref("source", &binding);
  by_reference.call(full);
  EXPECT_EQ(drawn(value)[0], glm::vec4(1));
  EXPECT_EQ(drawn(reference)[0], glm::vec4(1));
  binding.texture = sources[1].id();
  EXPECT_EQ(drawn(value)[0], glm::vec4(1));
  EXPECT_EQ(drawn(reference)[0], glm::vec4(2));
}

TEST_F(PassGpu, ObjectsReachTheShaderFieldByField)
{
  // One draw for each object; one pixel for each field, with the value that C++ wrote.
  const std::string vertex = R"(
#include "draw/draw_object_lib.glsl"
layout(location = 0) flat out mat4 matrix;
layout(location = 4) flat out vec3 normal_x;
layout(location = 5) flat out vec3 normal_y;
layout(location = 6) flat out vec3 normal_z;
layout(location = 7) flat out vec4 values;
void main()
{
  // A row of pixels for each object.
  gl_Position = vec4(position.x, (position.y + 1.0) / 8.0 - 1.0 + 0.25 * draw_instance.x, 0.5, 1.0);
  matrix = world_from_object();
  normal_x = to_normal_ws(vec3(1, 0, 0));
  normal_y = to_normal_ws(vec3(0, 1, 0));
  normal_z = to_normal_ws(vec3(0, 0, 1));
  values = vec4(object_value(), draw_instance, 0);
})";
  const std::string fragment = R"(
layout(location = 0) flat in mat4 matrix;
layout(location = 4) flat in vec3 normal_x;
layout(location = 5) flat in vec3 normal_y;
layout(location = 6) flat in vec3 normal_z;
layout(location = 7) flat in vec4 values;
layout(location = 0) out vec4 result;
void main()
{
  int x = int(gl_FragCoord.x);
  result = x < 4  ? matrix[x] :
           x == 4 ? vec4(normal_x, 0) :
           x == 5 ? vec4(normal_y, 0) :
           x == 6 ? vec4(normal_z, 0) :
                    values;
})";
  ObjectBuffer objects;
  std::vector<glm::mat4> matrices = {glm::mat4(1)};
  for (int i = 1; i < SIZE; i++) {
    matrices.push_back(glm::scale(
        glm::rotate(glm::translate(glm::mat4(1), {i, 2, 3}), 0.3F * float(i), {1, 2, float(i)}), {1, 2, -0.5F}));
    objects.add(matrices.back(), std::uint32_t(i * 11));
  }
  objects.upload(*device);
  const std::array<glm::vec3, 4> positions = {glm::vec3(-1, -1, 0), glm::vec3(1, -1, 0), glm::vec3(1, 1, 0),
                                              glm::vec3(-1, 1, 0)};
  const std::array<std::uint32_t, 6> indices = {0, 1, 2, 0, 2, 3};
  const gpu::Batch quad = device->create_batch({"quad", positions, {}, indices});
  const gpu::Batch other = device->create_batch({"other", positions, {}, indices});
  for (const bool are_instances : {false, true}) {
    SCOPED_TRACE(are_instances ? "instance calls" : "calls");
    const gpu::Shader shader =
        make_shader(*device, "object", (are_instances ? "#define DRAW_INSTANCES" : "") + vertex, fragment);
    Pass pass("objects", gpu::State::WriteColor, &objects);
    ShadingGroup &group = pass.group(shader);
    group.bind_storage("object_block", objects.buffer());
    InstanceCall &instances = group.instances(quad);
    // Not in the order of the objects, so that some calls are joined and others are not.
    for (const ObjectIndex i : {6U, 7U, 0U, 3U, 2U, 1U, 4U, 5U}) {
      if (are_instances) {
        instances.add(i, 9);
      }
      else {
        group.call(i == 4 ? other : quad, i);
      }
    }
    const std::vector<glm::vec4> pixels = drawn(pass);
    for (std::size_t i = 0; i < matrices.size(); i++) {
      const glm::mat3 normals = normal_matrix(matrices[i]);
      for (int x = 0; x < SIZE; x++) {
        const glm::vec4 expected = x < 4   ? matrices[i][x]
                                   : x < 7 ? glm::vec4(normals[x - 4], 0)
                                           : glm::vec4(float(i) * 11, float(i), are_instances ? 9 : 0, 0);
        EXPECT_EQ(pixels[i * SIZE + std::size_t(x)], expected) << "object " << i << ", field " << x;
      }
    }
  }
}

TEST_F(PassGpu, CallsFollowInstanceCallsAndOtherObjects)
{
  // The instances of each draw are those that were bound last, over groups and passes.
  const std::string value_of = R"(
layout(location = 0) flat in uint value;
layout(location = 0) out vec4 result;
void main()
{
  result = vec4(value);
})";
  const gpu::Shader of_calls = make_shader(*device, "calls", R"(
#include "draw/draw_object_lib.glsl"
layout(location = 0) flat out uint value;
void main()
{
  gl_Position = vec4(position, 1);
  value = object_value() + 10000 * draw_instance.x;
})",
                                           value_of);
  const gpu::Shader of_instances = make_shader(*device, "instances", R"(
layout(location = ATTRIBUTE_POSITION) in vec3 position;
layout(location = ATTRIBUTE_DRAW_INSTANCE) in uvec2 draw_instance;
layout(location = 0) flat out uint value;
void main()
{
  gl_Position = vec4(position, 1);
  value = draw_instance.y;
})",
                                               value_of);
  std::array<ObjectBuffer, 2> objects;
  for (std::uint32_t i = 0; i < 2; i++) {
    objects[i].add(glm::mat4(1), 11 + i);
    objects[i].upload(*device);
  }
  Pass first("first", gpu::State::WriteColor | gpu::State::BlendAdd, &objects[0]);
  first.group(of_calls).call(full, 1);
  first.group(of_instances).instances(full).add(1, 100);
  first.group(of_calls).call(full, 1);
  Pass second("second", gpu::State::WriteColor | gpu::State::BlendAdd, &objects[1]);
  second.group(of_calls).call(full, 1);
  Pass plain("plain", gpu::State::WriteColor | gpu::State::BlendAdd);
  plain.group(of_instances).instances(full).add(0, 1000);
  gpu::CommandList list;
  for (const int round : {0, 1}) {
    // In the second round, the list of the first has ended, and one of the buffers is a new one.
    list.clear();
    list.begin_pass("sum", framebuffer, {});
    for (const Pass *pass : {&first, &second, &plain, &first}) {
      pass->record(View(), list);
    }
    list.end_pass();
    device->submit(list);
    EXPECT_EQ(gpu::read_as<glm::vec4>(*device, picture)[0].x,
              float(5 * 10000 + 11 + 100 + 11 + 12 + 1000 + 11 + 100 + 11))
        << round;
    objects[1] = ObjectBuffer();
    objects[1].add(glm::mat4(1), 12);
    objects[1].upload(*device);
  }
}

TEST_F(PassGpu, LaterCallsAreDrawnOverEarlierOnes)
{
  const gpu::Shader shader = make_shader(*device, "instance", test::CLIP_SPACE_VERT, R"(
layout(location = 0) flat in uvec2 instance;
layout(location = 0) out vec4 result;
void main()
{
  result = vec4(instance, 0, 0);
})");
  const gpu::Batch other = test::full_triangle(*device, 0.5F);
  Pass pass("order", gpu::State::WriteColor);
  ShadingGroup &group = pass.group(shader);
  group.call(full, 1);
  group.call(other, 2);
  group.call(full, 3);
  InstanceCall &instances = group.instances(full);
  for (std::uint32_t i = 0; i < 4; i++) {
    instances.add(5, i);
  }
  EXPECT_EQ(drawn(pass)[0], glm::vec4(5, 3, 0, 0));
  group.call(other, 6, {{9, 9, 9}, 1});
  EXPECT_EQ(drawn(pass, View(glm::mat4(1), perspective(1, 1, 1, 2)))[0], glm::vec4(5, 3, 0, 0)) << "not culled";
}

TEST_F(PassGpu, OnePassDrawsTheSixFacesOfOneLampAfterAnother)
{
  if (!device->limits().has_vertex_layer) {
    GTEST_SKIP() << "the device's vertex shaders choose no layer";
  }
  // Layers of one lamp must not overlap those of the one before it.
  constexpr int LAMPS = 3;
  const gpu::Texture cubes = device->create_texture({.name = "cubes",
                                                     .kind = gpu::TextureKind::Array,
                                                     .format = gpu::Format::R32F,
                                                     .width = 2,
                                                     .height = 2,
                                                     .layers = 6 * LAMPS});
  const gpu::Framebuffer layers = device->create_framebuffer({"cubes", {{&cubes, gpu::all_layers}}, {}});
  const gpu::Shader shader = make_shader(*device, "cube", R"(
#extension GL_ARB_shader_viewport_layer_array : require
layout(location = ATTRIBUTE_POSITION) in vec3 position;
layout(location = ATTRIBUTE_DRAW_INSTANCE) in uvec2 draw_instance;
PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  int lamp;
};
layout(location = 0) flat out float value;
void main()
{
  gl_Position = vec4(position, 1);
  gl_Layer = 6 * lamp + int(draw_instance.y);
  value = 100 * lamp + draw_instance.y;
})",
                                         R"(
layout(location = 0) flat in float value;
layout(location = 0) out float result;
void main()
{
  result = value;
})");
  int lamp = 0;
  Pass pass("cube", gpu::State::WriteColor);
  ShadingGroup &group = pass.group(shader);
  group.constant_ref("lamp", &lamp);
  InstanceCall &faces = group.instances(full);
  for (std::uint32_t i = 0; i < 6; i++) {
    faces.add(object_identity, i);
  }
  gpu::CommandList list;
  list.begin_pass("cubes", layers, {.clear_color = glm::vec4(-1)});
  for (lamp = 0; lamp < LAMPS; lamp++) {
    pass.record(View(), list);
  }
  list.end_pass();
  device->submit(list);
  for (int layer = 0; layer < 6 * LAMPS; layer++) {
    const auto expected = float(100 * (layer / 6) + layer % 6);
    EXPECT_EQ(gpu::read_as<float>(*device, cubes, layer), std::vector<float>(4, expected)) << "layer " << layer;
  }
}

TEST_F(PassGpu, BatchBehindAnEmptyOneIsDrawn)
{
  const gpu::Shader shader = make_shader(*device, "color", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  const gpu::Batch empty = device->create_batch({.name = "empty", .positions = {}, .normals = {}, .indices = {}});
  const gpu::Batch next = test::full_triangle(*device, 0.5F);
  Pass pass("empty", gpu::State::WriteColor);
  ShadingGroup &group = pass.group(shader);
  group.constant("color", glm::vec4(4));
  group.call(empty);
  group.call(next);
  EXPECT_EQ(drawn(pass)[0], glm::vec4(4));
}

TEST_F(PassGpu, RecordedOnAnotherThreadDrawsTheSame)
{
  const gpu::Shader shader = make_shader(*device, "color", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  std::optional<Pass> pass;
  gpu::CommandList list;
  std::thread([&] {
    pass.emplace("threaded", gpu::State::WriteColor);
    ShadingGroup &group = pass->group(shader);
    group.constant("color", glm::vec4(1, 2, 3, 4));
    group.call(full);
    record(*pass, list);
  }).join();
  device->submit(list);
  EXPECT_EQ(std::ranges::count(gpu::read_as<glm::vec4>(*device, picture), glm::vec4(1, 2, 3, 4)), SIZE * SIZE);
}

}  // namespace
}  // namespace gnomon::draw
