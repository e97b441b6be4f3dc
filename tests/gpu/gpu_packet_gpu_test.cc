// SPDX-License-Identifier: MIT
#include "gpu/gpu_gl_hook.hh"
#include "gpu/gpu_testing.hh"
#include "gpu_device_fixture.hh"

#include <epoxy/gl.h>

#include <optional>
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

/** The marks of a timestamp query. A driver may have them only when it has done the work before. */
class TimersGpu : public test::GlDeviceTest {
 protected:
  void SetUp() override
  {
    test::GlDeviceTest::SetUp();
    if (!device) {
      return;
    }
    result_count = query_count = 0;
    is_available = false;
    query.emplace(device->create_timer_query("query"));
    mark();
    // Afterwards the function pointers are those of the driver.
    EXPECT_GE(*device->take_seconds(*query), 0.0);
  }
  void TearDown() override
  {
    query.reset();
    test::GlDeviceTest::TearDown();
  }
  void mark()
  {
    device->run(packet, [&] {
      device->time_begin(*query);
      device->time_end(*query);
    });
  }

  static inline int result_count = 0;
  static inline int query_count = 0;
  static inline bool is_available = false;
  Packet packet;
  std::optional<TimerQuery> query;
};

TEST_F(TimersGpu, APacketWithTimesDoesNotWait)
{
  static const auto result = epoxy_glGetQueryObjectui64v;
  static const auto create = epoxy_glCreateQueries;
  const test::Hook results(
      epoxy_glGetQueryObjectui64v, +[](GLuint name, GLenum what, GLuint64 *value) {
        result_count++;
        result(name, what, value);
        // One microsecond a pair.
        *value = what == GL_QUERY_RESULT ? GLuint64(result_count) * 1000 : *value;
      });
  const test::Hook availability(
      epoxy_glGetQueryObjectuiv,
      +[](GLuint /*name*/, GLenum /*what*/, GLuint *value) { *value = is_available ? GL_TRUE : GL_FALSE; });
  const test::Hook creations(
      epoxy_glCreateQueries, +[](GLenum target, GLsizei count, GLuint *names) {
        query_count += count;
        create(target, count, names);
      });
  for (int i = 0; i < 3; i++) {
    mark();
  }
  EXPECT_EQ(result_count, 0) << "a submission asked for a time that the device did not have";
  EXPECT_NEAR(*device->take_seconds(*query), 3e-6, 1e-12);
  EXPECT_EQ(*device->take_seconds(*query), 0.0);
  // Times that nobody takes need no more queries once the device has them.
  is_available = true;
  const int before = query_count;
  for (int i = 0; i < 100; i++) {
    mark();
  }
  EXPECT_EQ(query_count, before);
  EXPECT_NEAR(*device->take_seconds(*query), 100e-6, 1e-12);
}

}  // namespace
}  // namespace gnomon::gpu
