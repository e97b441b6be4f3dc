// SPDX-License-Identifier: MIT
#include "gpu/gpu_testing.hh"
#include "gpu_device_fixture.hh"

#include "gpu_framebuffer_stack.hh"

#include <cmath>

namespace gnomon::gpu {
namespace {

using test::append_draw;
using test::decoded_texels;
using test::make_shader;
using test::push_constants;

class RenderPassGpu : public test::GpuDeviceTest {
 protected:
  /** Begin and end, nothing drawn. */
  void run_pass(const Framebuffer &framebuffer, const PassActions &actions)
  {
    CommandList list;
    list.begin_pass("pass", framebuffer, actions);
    list.end_pass();
    device->submit(list);
  }
  void expect_all(const Texture &texture, int layer, const glm::vec4 &expected, float tolerance = 0)
  {
    const std::vector<glm::vec4> picture = decoded_texels(*device, texture, layer);
    ASSERT_EQ(picture.size(), std::size_t(texture.desc().width) * std::size_t(texture.desc().height));
    for (std::size_t i = 0; i < picture.size(); i++) {
      for (int channel = 0; channel < 4; channel++) {
        ASSERT_NEAR(picture[i][channel], expected[channel], tolerance)
            << texture.desc().name << ", layer " << layer << ", texel " << i << ", channel " << channel;
      }
    }
  }
};

TEST_F(RenderPassGpu, ClearsEveryFormatToItsValue)
{
  struct Case {
    Format format;
    glm::vec4 clear;
    float tolerance;
  };
  // The third value is exact in half floats, the fourth in floats. Rows of 7 texels are not multiples of four bytes.
  for (const Case &one :
       {Case{Format::RGBA8, {0.25F, 0.5F, 0.75F, 1}, 0.501F / 255},
        Case{Format::RGBA16F, {1.5F, -2.25F, 65504, 0.125F}, 0}, Case{Format::RGBA32F, {1e30F, -3.7F, 1e-30F, 0.1F}, 0},
        Case{Format::R16F, {12.5F, 0, 0, 0}, 0}, Case{Format::R32F, {1e-20F, 0, 0, 0}, 0},
        Case{Format::RG32F, {1e-20F, -3.7F, 0, 0}, 0}, Case{Format::Depth32F, {0.123456F, 0, 0, 0}, 0},
        Case{Format::Depth16, {0.123456F, 0, 0, 0}, 0.501F / 65535}}) {
    const std::string name(to_string(one.format));
    SCOPED_TRACE(name);
    const Texture texture = device->create_texture({.name = name, .format = one.format, .width = 7, .height = 5});
    FramebufferDesc desc{.name = name, .colors = {{&texture}}, .depth = {}};
    if (is_depth(one.format)) {
      desc = {.name = name, .colors = {}, .depth = {&texture}};
    }
    const Framebuffer framebuffer = device->create_framebuffer(desc);
    run_pass(framebuffer, {.clear_color = one.clear, .clear_depth = one.clear.x});
    expect_all(texture, 0, one.clear, one.tolerance);
  }
}

TEST_F(RenderPassGpu, KeepsWhatIsLoadedAndReplacesWhatIsCleared)
{
  const Texture color = device->create_texture({.name = "color", .format = Format::RGBA32F, .width = 4, .height = 4});
  const Texture depth = device->create_texture({.name = "depth", .format = Format::Depth32F, .width = 4, .height = 4});
  const Framebuffer framebuffer = device->create_framebuffer({"target", {{&color}}, {&depth}});
  run_pass(framebuffer, {.clear_color = glm::vec4(1, 2, 3, 4), .clear_depth = 0.5F});
  // Colour and depth are independent.
  run_pass(framebuffer, {.color_load = LoadAction::Load, .clear_color = glm::vec4(9), .clear_depth = 0.25F});
  expect_all(color, 0, {1, 2, 3, 4});
  expect_all(depth, 0, {0.25F, 0, 0, 0});
  run_pass(framebuffer, {.clear_color = glm::vec4(9), .depth_load = LoadAction::Load, .clear_depth = 0.75F});
  expect_all(color, 0, glm::vec4(9));
  expect_all(depth, 0, {0.25F, 0, 0, 0});
}

TEST_F(RenderPassGpu, ClearsWhateverTheDrawBeforeItMasked)
{
  const Texture color = device->create_texture({.name = "color", .format = Format::RGBA32F, .width = 4, .height = 4});
  const Texture depth = device->create_texture({.name = "depth", .format = Format::Depth32F, .width = 4, .height = 4});
  const Framebuffer framebuffer = device->create_framebuffer({"target", {{&color}}, {&depth}});
  const Shader shader = make_shader(*device, "color", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  const Batch batch = test::full_triangle(*device, 0.5F);
  CommandList list;
  for (const float value : {1.0F, 2.0F}) {
    list.begin_pass("pass", framebuffer, {.clear_color = glm::vec4(value), .clear_depth = value / 4});
    list.set_shader(shader.id());
    list.set_state(State::DepthNearerEqual);
    push_constants(list, shader, glm::vec4(7));
    append_draw(list, batch);
    list.end_pass();
  }
  device->submit(list);
  expect_all(color, 0, glm::vec4(2));
  expect_all(depth, 0, {0.5F, 0, 0, 0});
}

TEST_F(RenderPassGpu, ClearsEveryColorAttachment)
{
  const Texture a = device->create_texture({.name = "a", .format = Format::RGBA32F, .width = 4, .height = 4});
  const Texture b = device->create_texture({.name = "b", .format = Format::RGBA16F, .width = 4, .height = 4});
  const Framebuffer framebuffer = device->create_framebuffer({"target", {{&a}, {&b}}, {}});
  run_pass(framebuffer, {.clear_color = glm::vec4(3)});
  expect_all(a, 0, glm::vec4(3));
  expect_all(b, 0, glm::vec4(3));
}

TEST_F(RenderPassGpu, DrawsIntoEveryColorAttachment)
{
  const Texture a = device->create_texture({.name = "a", .format = Format::RGBA32F, .width = 4, .height = 4});
  const Texture b = device->create_texture({.name = "b", .format = Format::RGBA32F, .width = 4, .height = 4});
  const Framebuffer framebuffer = device->create_framebuffer({"target", {{&a}, {&b}}, {}});
  const Shader shader = make_shader(*device, "two", test::CLIP_SPACE_VERT, R"(
layout(location = 0) out vec4 a;
layout(location = 1) out vec4 b;
void main()
{
  a = vec4(1);
  b = vec4(2);
})");
  const Batch batch = test::full_triangle(*device, 0.5F);
  CommandList list;
  list.begin_pass("pass", framebuffer, {});
  list.set_shader(shader.id());
  list.set_state(State::WriteColor);
  append_draw(list, batch);
  list.end_pass();
  device->submit(list);
  expect_all(a, 0, glm::vec4(1));
  expect_all(b, 0, glm::vec4(2));
}

TEST_F(RenderPassGpu, LayerIsOneSliceAndAllLayersAreAll)
{
  for (const int layers : {5, 12}) {
    for (const Format format : {Format::R32F, Format::Depth32F}) {
      SCOPED_TRACE(fmt::format("{} layers {}", layers, to_string(format)));
      const Texture texture = device->create_texture(
          {.name = "layers", .kind = TextureKind::Array, .format = format, .width = 4, .height = 4, .layers = layers});
      const auto framebuffer_of = [&](int layer) {
        return is_depth(format) ? device->create_framebuffer({"one", {}, {&texture, layer}})
                                : device->create_framebuffer({"one", {{&texture, layer}}, {}});
      };
      const auto value = [](int layer) { return 1.0F / float(layer + 2); };
      const int layer_count = layers;
      // Backwards, so that a clear of all layers would be visible.
      run_pass(framebuffer_of(all_layers), {.clear_color = glm::vec4(0.75F), .clear_depth = 0.75F});
      for (int layer = 0; layer < layer_count; layer++) {
        expect_all(texture, layer, {0.75F, 0, 0, 0});
      }
      for (int layer = layer_count - 1; layer >= 0; layer--) {
        run_pass(framebuffer_of(layer), {.clear_color = glm::vec4(value(layer)), .clear_depth = value(layer)});
      }
      for (int layer = 0; layer < layer_count; layer++) {
        expect_all(texture, layer, {value(layer), 0, 0, 0});
      }
    }
  }
}

TEST_F(RenderPassGpu, LayerOfADrawIsGlLayer)
{
  const Texture texture = device->create_texture(
      {.name = "layers", .kind = TextureKind::Array, .format = Format::R32F, .width = 4, .height = 4, .layers = 12});
  const Texture depth = device->create_texture(
      {.name = "depth", .kind = TextureKind::Array, .format = Format::Depth32F, .width = 4, .height = 4, .layers = 12});
  const Framebuffer framebuffer = device->create_framebuffer({"all", {{&texture, all_layers}}, {&depth, all_layers}});
  const std::string fragment = R"(
layout(location = 0) flat in uint value;
layout(location = 0) out float result;
void main()
{
  result = float(value);
})";
  std::vector<Shader> shaders;
  if (device->limits().has_vertex_layer) {
    shaders.push_back(make_shader(*device, "by vertex", R"(
#extension GL_ARB_shader_viewport_layer_array : require
layout(location = ATTRIBUTE_POSITION) in vec3 position;
layout(location = ATTRIBUTE_DRAW_INSTANCE) in uvec2 draw_instance;
layout(location = 0) flat out uint value;
void main()
{
  gl_Position = vec4(position, 1.0);
  gl_Layer = int(draw_instance.y);
  value = draw_instance.y + 1;
})",
                                  fragment));
  }
  if (device->limits().has_geometry_shader) {
    shaders.push_back(make_shader(*device, "by geometry", test::CLIP_SPACE_VERT, fragment, R"(
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
layout(location = 0) flat in uvec2 instance[];
layout(location = 0) flat out uint value;
void main()
{
  for (int i = 0; i < 3; i++) {
    gl_Position = gl_in[i].gl_Position;
    gl_Layer = int(instance[0].y);
    value = instance[0].y + 1;
    EmitVertex();
  }
})"));
  }
  const Batch batch = test::full_triangle(*device, 0.5F);
  for (const Shader &shader : shaders) {
    SCOPED_TRACE(shader.name());
    CommandList list;
    list.begin_pass("cubes", framebuffer, {});
    list.set_shader(shader.id());
    list.set_state(State::WriteColor | State::WriteDepth | State::DepthNearerEqual);
    append_draw(list, batch, 11);
    list.end_pass();
    device->submit(list);
    for (int layer = 0; layer < 12; layer++) {
      const bool is_drawn = layer < 11;
      expect_all(texture, layer, {is_drawn ? float(layer + 1) : 0.0F, 0, 0, 0});
      expect_all(depth, layer, {is_drawn ? 0.5F : 0.0F, 0, 0, 0});
    }
  }
}

TEST_F(RenderPassGpu, SomeLayersAreClearedAndDrawnAndTheOthersLeftAlone)
{
  {
    const Texture color = device->create_texture(
        {.name = "colors", .kind = TextureKind::Array, .format = Format::R32F, .width = 4, .height = 4, .layers = 12});
    const Texture depth = device->create_texture({.name = "depths",
                                                  .kind = TextureKind::Array,
                                                  .format = Format::Depth32F,
                                                  .width = 4,
                                                  .height = 4,
                                                  .layers = 12});
    run_pass(device->create_framebuffer({"all", {{&color, all_layers}}, {&depth, all_layers}}),
             {.clear_color = glm::vec4(0.25F), .clear_depth = 0.25F});
    const Attachment colors{.texture = &color, .layer = 6, .layer_count = 4};
    const Attachment depths{.texture = &depth, .layer = 6, .layer_count = 4};
    const Framebuffer some = device->create_framebuffer({"some", {colors}, depths});
    run_pass(some, {.clear_color = glm::vec4(0.75F), .clear_depth = 0.125F});
    const auto expect = [&](int first_drawn, int last_drawn) {
      for (int layer = 0; layer < 12; layer++) {
        const bool is_in = layer >= 6 && layer < 10;
        const bool is_drawn = layer >= first_drawn && layer <= last_drawn;
        expect_all(color, layer, {is_drawn ? 9 : is_in ? 0.75F : 0.25F, 0, 0, 0});
        expect_all(depth, layer, {is_drawn ? 0.5F : is_in ? 0.125F : 0.25F, 0, 0, 0});
      }
    };
    expect(-1, -1);
    if (!device->limits().has_vertex_layer) {
      return;
    }
    // gl_Layer 0 is the first of them.
    const Shader shader = make_shader(*device, "by vertex", R"(
#extension GL_ARB_shader_viewport_layer_array : require
layout(location = ATTRIBUTE_POSITION) in vec3 position;
layout(location = ATTRIBUTE_DRAW_INSTANCE) in uvec2 draw_instance;
void main()
{
  gl_Position = vec4(position, 1.0);
  gl_Layer = int(draw_instance.y);
})",
                                      R"(
layout(location = 0) out float result;
void main()
{
  result = 9.0;
})");
    const Batch batch = test::full_triangle(*device, 0.5F);
    CommandList list;
    list.begin_pass("some", some, {.color_load = LoadAction::Load, .depth_load = LoadAction::Load});
    list.set_shader(shader.id());
    list.set_state(State::WriteColor | State::WriteDepth | State::DepthNearerEqual);
    append_draw(list, batch, 2);
    list.end_pass();
    device->submit(list);
    expect(6, 7);
  }
}

TEST_F(RenderPassGpu, ASmallerViewportIsDrawnIntoAndTheWholeIsCleared)
{
  const Texture texture = device->create_texture({.name = "color", .format = Format::R32F, .width = 5, .height = 4});
  const Framebuffer framebuffer = device->create_framebuffer({"target", {{&texture}}, {}});
  const Shader shader = make_shader(*device, "color", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  const Batch batch = test::full_triangle(*device, 0.5F);
  CommandList list;
  const auto draw = [&](float value, const PassActions &actions) {
    list.begin_pass("pass", framebuffer, actions);
    list.set_shader(shader.id());
    list.set_state(State::WriteColor);
    push_constants(list, shader, glm::vec4(value));
    append_draw(list, batch);
    list.end_pass();
  };
  draw(1, {.clear_color = glm::vec4(7), .viewport = {.size_px = {3, 2}}});
  device->submit(list);
  const std::vector<glm::vec4> pixels = decoded_texels(*device, texture, 0);
  for (int y = 0; y < 4; y++) {
    for (int x = 0; x < 5; x++) {
      EXPECT_EQ(pixels[std::size_t(y) * 5 + std::size_t(x)].r, x < 3 && y < 2 ? 1 : 7) << x << " " << y;
    }
  }
  // The next pass uses the whole framebuffer again.
  list.clear();
  draw(2, {.color_load = LoadAction::Load});
  device->submit(list);
  expect_all(texture, 0, {2, 0, 0, 0});
}

TEST_F(RenderPassGpu, MipLevelHasItsOwnSizeAndLeavesTheOthers)
{
  const Texture source =
      device->create_texture({.name = "mips", .format = Format::R32F, .width = 8, .height = 4, .mip_levels = 3});
  const Texture result = device->create_texture({.name = "result", .format = Format::R32F, .width = 4, .height = 2});
  for (int level = 0; level < 3; level++) {
    const Framebuffer framebuffer = device->create_framebuffer({"level", {{&source, 0, level}}, {}});
    EXPECT_EQ(framebuffer.size_px(), glm::ivec2(8 >> level, 4 >> level));
    run_pass(framebuffer, {.clear_color = glm::vec4(float(level + 1))});
  }
  expect_all(source, 0, {1, 0, 0, 0});
  const Shader shader = make_shader(*device, "fetch", test::CLIP_SPACE_VERT, R"(
layout(binding = 16) uniform sampler2D source;
layout(location = 0) out float result;
void main()
{
  result = texelFetch(source, ivec2(gl_FragCoord.xy), 1).r + 10.0 * texelFetch(source, ivec2(0), 2).r;
})");
  const Sampler sampler = device->create_sampler({.name = "nearest"});
  const Batch batch = test::full_triangle(*device, 0.5F);
  const Framebuffer framebuffer = device->create_framebuffer({"result", {{&result}}, {}});
  CommandList list;
  list.begin_pass("read", framebuffer, {});
  list.set_shader(shader.id());
  list.set_state(State::WriteColor);
  list.bind_texture(16, source.id(), sampler.id());
  append_draw(list, batch);
  list.end_pass();
  device->submit(list);
  expect_all(result, 0, {2 + 30, 0, 0, 0});
}

TEST_F(RenderPassGpu, MixOfLayeredAndOtherAttachmentsIsAnErrorByName)
{
  const Texture layers =
      device->create_texture({.name = "layers", .kind = TextureKind::Array, .width = 4, .height = 4, .layers = 2});
  const Texture flat = device->create_texture({.name = "flat", .width = 4, .height = 4});
  const std::vector<std::string> before = device->live_resources();
  const std::string message = test::error_of([&] {
    static_cast<void>(device->create_framebuffer({"mixed", {{&layers, all_layers}, {&flat}}, {}}));
  });
  test::expect_contains(message, "framebuffer 'mixed'");
  EXPECT_EQ(device->live_resources(), before);
}

TEST_F(RenderPassGpu, StackResumesAPassWithWhatItHadDrawn)
{
  const Texture outer = device->create_texture({.name = "outer", .format = Format::RGBA32F, .width = 4, .height = 4});
  const Texture inner = device->create_texture({.name = "inner", .format = Format::RGBA32F, .width = 2, .height = 2});
  const Framebuffer outer_framebuffer = device->create_framebuffer({"outer", {{&outer}}, {}});
  const Framebuffer inner_framebuffer = device->create_framebuffer({"inner", {{&inner}}, {}});
  const Shader shader = make_shader(*device, "color", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  const Batch batch = test::full_triangle(*device, 0.5F);
  CommandList list;
  const auto add = [&](const glm::vec4 &color) {
    list.set_shader(shader.id());
    list.set_state(State::WriteColor | State::BlendAdd);
    push_constants(list, shader, color);
    append_draw(list, batch);
  };
  FramebufferStack stack(list);
  stack.push("outer", outer_framebuffer, {.clear_color = glm::vec4(1)});
  add(glm::vec4(10));
  stack.push("inner", inner_framebuffer, {.clear_color = glm::vec4(5)});
  add(glm::vec4(50));
  stack.pop();
  add(glm::vec4(100));
  stack.pop();
  device->submit(list);
  expect_all(outer, 0, glm::vec4(111));
  expect_all(inner, 0, glm::vec4(55));
}

}  // namespace
}  // namespace gnomon::gpu
