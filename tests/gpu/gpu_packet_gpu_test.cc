// SPDX-License-Identifier: MIT
#include "gpu/gpu_testing.hh"
#include "gpu_device_fixture.hh"

#include <thread>

namespace gnomon::gpu {
namespace {

using PacketGpu = test::GpuDeviceTest;

/** The interface of a shader without bindings. The driver, and not glslang, then finds what is wrong with its text. */
ShaderInterface empty_interface(std::string_view /*name*/, const std::vector<ShaderSource> & /*stages*/)
{
  return {};
}

TEST_F(PacketGpu, AShaderThatTheDriverRejectsIsDrawnWithItsStandIn)
{
  const auto with = [](const std::string &value) {
    return test::ShaderTexts{
        {{"vert", test::VERSION + "#include \"shared/slots_shared.h\"\n" + test::CLIP_SPACE_VERT},
         {"frag", test::VERSION + "layout(location = 0) out vec4 out_color;\nvoid main()\n{\n  out_color = " + value +
                      ";\n}\n"}}};
  };
  const test::ShaderTexts broken = with("missing");
  const test::ShaderTexts stand_in = with("vec4(1, 2, 3, 4)");
  const ShaderDesc desc{"made", "vert", "", "frag", {}};
  const Texture target = device->create_texture({.name = "target", .format = Format::RGBA32F, .width = 2, .height = 2});
  const Framebuffer framebuffer = device->create_framebuffer({.name = "fb", .colors = {{&target}}, .depth = {}});
  const Batch batch = test::full_triangle(*device, 0.5F);
  Packet packet;
  Shader shader;
  {
    const Recording recording(*device, packet);
    shader = device->create_shader(desc, broken.files(), empty_interface, stand_in.files());
    CommandList list;
    list.begin_pass("pass", framebuffer, {});
    list.set_shader(shader.id());
    list.set_state(State::WriteColor);
    test::append_draw(list, batch);
    list.end_pass();
    device->submit(list);
  }
  device->submit(packet);
  EXPECT_EQ(read_as<glm::vec4>(*device, target), std::vector<glm::vec4>(4, glm::vec4(1, 2, 3, 4)));
  ASSERT_EQ(packet.feedback().failed_shaders.size(), 1U);
  EXPECT_EQ(packet.feedback().failed_shaders[0].shader, shader.id());
  test::expect_contains(packet.feedback().failed_shaders[0].reason, "frag:5");
  // Without a recording there is no feedback, and without a stand-in nothing can be drawn.
  test::expect_contains(
      test::error_of([&] { shader = device->create_shader(desc, broken.files(), empty_interface, stand_in.files()); }),
      "frag:5");
  {
    const Recording recording(*device, packet);
    shader = device->create_shader(desc, broken.files(), empty_interface);
  }
  test::expect_contains(test::error_of([&] { device->submit(packet); }), "frag:5");
  EXPECT_TRUE(packet.feedback().failed_shaders.empty());
}

/** A frame drawn with data that is gone, and resources that are destroyed, when the packet is submitted. */
TEST_F(PacketGpu, APacketDrawsAsTheCallsThatItRecorded)
{
  constexpr const char *frag = R"(
layout(binding = 0) uniform sampler2D image;
layout(std140, binding = 1) uniform block { vec4 factor; };
layout(location = 0) out vec4 out_color;
void main() { out_color = texelFetch(image, ivec2(0), 0) * factor; }
)";
  Texture target;
  const auto draw = [&] {
    target = device->create_texture({.name = "target", .format = Format::RGBA32F, .width = 4, .height = 4});
    const Framebuffer framebuffer = device->create_framebuffer({.name = "fb", .colors = {{&target}}, .depth = {}});
    const Texture image = device->create_texture({.name = "image", .format = Format::RGBA32F});
    const Sampler sampler = device->create_sampler({.name = "sampler"});
    const Buffer block = device->create_buffer({.name = "block", .size_bytes = 16});
    const Batch batch = test::full_triangle(*device, 0.5F);
    const Shader shader = test::make_shader(*device, "shader", test::CLIP_SPACE_VERT, frag);
    {
      const std::vector<glm::vec4> texel = {glm::vec4(1, 2, 3, 4)};
      device->upload(image, 0, std::as_bytes(std::span(texel)));
      device->update(block, glm::vec4(10.0F));
    }
    CommandList list;
    list.begin_pass("pass", framebuffer, {});
    list.set_shader(shader.id());
    list.set_state(State::WriteColor);
    list.bind_texture(0, image.id(), sampler.id());
    list.bind_uniform(1, {block.id()});
    test::append_draw(list, batch);
    list.end_pass();
    device->submit(list);
  };
  draw();
  const std::vector<glm::vec4> expected = read_as<glm::vec4>(*device, target);
  EXPECT_EQ(expected, std::vector<glm::vec4>(16, glm::vec4(10, 20, 30, 40)));
  Packet packet;
  // The thread has no context.
  std::thread([&] {
    const Recording recording(*device, packet);
    draw();
    device->read_back(target, 0, 7);
  }).join();
  device->submit(packet);
  EXPECT_EQ(read_as<glm::vec4>(*device, target), expected);
  ASSERT_EQ(packet.feedback().texels.size(), 1U);
  EXPECT_EQ(packet.feedback().texels[0].bytes, device->read(target));
}

TEST_F(PacketGpu, TimersOfAPacketAreInItsFeedback)
{
  const TimerQuery query = device->create_timer_query("query");
  Packet packet;
  device->run(packet, [&] {
    device->time_begin(query);
    device->time_end(query);
  });
  ASSERT_EQ(packet.feedback().times.size(), 1U);
  EXPECT_EQ(packet.feedback().times[0].query, query.id());
  EXPECT_GE(packet.feedback().times[0].seconds, 0.0);
}

}  // namespace
}  // namespace gnomon::gpu
