// SPDX-License-Identifier: MIT
#include "gpu/gpu_gl_hook.hh"
#include "gpu/gpu_testing.hh"
#include "gpu_device_fixture.hh"

#include "internal/gpu_id_table.hh"

#include <epoxy/gl.h>

#include <deque>
#include <utility>

namespace gnomon::gpu {
namespace {

using test::error_of;
using test::expect_contains;
using test::Hook;
using test::make_shader;

/** A device with a driver that fails on demand, without debug messages, as in release builds. */
class FailureGpu : public test::GlDeviceTest {
 protected:
  void SetUp() override
  {
    test::GlDeviceTest::SetUp();
    if (!device) {
      return;
    }
    device.reset();
    device = create_gl_device({.is_debug = false, .sink = [](std::string_view /*text*/) {}});
    errors.clear();
    large_size = 0;
    picture = device->create_texture({.name = "p", .format = Format::RGBA32F, .width = 4, .height = 4});
    framebuffer = device->create_framebuffer({"p", {{&picture}}, {}});
    shader = make_shader(*device, "color", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  }

  CommandList drawing(const Batch &batch, float value) const
  {
    CommandList list;
    list.begin_pass("p", framebuffer, {});
    list.set_shader(shader.id());
    list.set_state(State::WriteColor);
    test::push_constants(list, shader, glm::vec4(value));
    test::append_draw(list, batch);
    list.end_pass();
    return list;
  }

  void expect_drawn(const Batch &batch, float value)
  {
    device->submit(drawing(batch, value));
    EXPECT_EQ(gpu::read_as<glm::vec4>(*device, picture), std::vector<glm::vec4>(16, glm::vec4(value)));
  }

  /** Errors that the driver reports before its own. */
  static inline std::deque<GLenum> errors;
  static inline std::size_t large_size = 0;

  /** A copy that the driver has not executed yet. */
  struct DelayedCopy {
    GLuint buffer = 0;
    GLintptr offset = 0;
    std::vector<std::byte> bytes;
  };
  static inline std::vector<DelayedCopy> delayed_copies;

  static void GLAPIENTRY delay_copy(GLuint source, GLuint target, GLintptr first, GLintptr offset, GLsizeiptr size)
  {
    DelayedCopy &copy =
        delayed_copies.emplace_back(DelayedCopy{target, offset, std::vector<std::byte>(std::size_t(size))});
    glGetNamedBufferSubData(source, first, size, copy.bytes.data());
  }

  static void GLAPIENTRY execute_delayed_copies()
  {
    for (const DelayedCopy &copy : std::exchange(delayed_copies, {})) {
      glNamedBufferSubData(copy.buffer, copy.offset, GLsizeiptr(copy.bytes.size()), copy.bytes.data());
    }
  }

  static GLenum GLAPIENTRY next_error()
  {
    if (errors.empty()) {
      return GL_NO_ERROR;
    }
    const GLenum error = errors.front();
    errors.pop_front();
    return error;
  }

  Texture picture;
  Framebuffer framebuffer;
  Shader shader;
};

TEST_F(FailureGpu, AllPendingErrorsAreRead)
{
  const Hook hook(epoxy_glGetError, &FailureGpu::next_error);
  errors = {GL_INVALID_OPERATION, GL_OUT_OF_MEMORY};
  expect_contains(error_of([&] { static_cast<void>(device->create_texture({.name = "big"})); }),
                  "texture 'big': the driver is out of memory");
  EXPECT_TRUE(errors.empty()) << "the next call would report it";
  errors = {GL_INVALID_OPERATION, GL_INVALID_VALUE};
  expect_contains(error_of([&] { static_cast<void>(device->create_texture({.name = "odd"})); }),
                  "texture 'odd': the driver reports: GL_INVALID_OPERATION; GL_INVALID_VALUE");
  EXPECT_EQ(device->live_resources().size(), 3U);
}

TEST_F(FailureGpu, ALostContextIsReportedByEveryCall)
{
  const Batch full = test::full_triangle(*device, 0);
  expect_drawn(full, 1);
  {
    const Hook hook(
        epoxy_glGetGraphicsResetStatus, +[]() -> GLenum { return GL_GUILTY_CONTEXT_RESET; });
    EXPECT_THROW(device->submit(drawing(full, 1)), DeviceLost);
  }
  // A driver may report the reset once.
  EXPECT_THROW(device->submit(drawing(full, 1)), DeviceLost);
  EXPECT_THROW(static_cast<void>(device->read(picture)), DeviceLost);
  EXPECT_THROW(static_cast<void>(device->create_texture({.name = "t"})), DeviceLost);
  EXPECT_THROW(device->finish(), DeviceLost);
  expect_contains(error_of([&] { device->submit(drawing(full, 1)); }), "submit: the OpenGL context is lost");
}

TEST_F(FailureGpu, APoolThatCannotGrowLeavesAllBatches)
{
  const Batch first = test::full_triangle(*device, 0);
  expect_drawn(first, 1);
  const std::vector<std::string> live = device->live_resources();
  const std::uint64_t uploaded = device->counters().upload_bytes;
  std::vector<glm::vec3> positions(40000, glm::vec3(0));
  std::vector<std::uint32_t> indices(60000, 0);
  std::vector<glm::vec2> uvs(positions.size());
  {
    static auto original = epoxy_glNamedBufferData;
    large_size = 100000;
    const Hook memory(
        epoxy_glNamedBufferData, +[](GLuint buffer, GLsizeiptr size, const void *data, GLenum usage) {
          if (std::size_t(size) > large_size) {
            errors.push_back(GL_OUT_OF_MEMORY);
          }
          else {
            original(buffer, size, data, usage);
          }
        });
    const Hook hook(epoxy_glGetError, &FailureGpu::next_error);
    for (int i = 0; i < 3; i++) {
      expect_contains(error_of([&] {
                        static_cast<void>(device->create_batch({"terrain", positions, {}, indices, uvs}));
                      }),
                      "batch 'terrain'");
      EXPECT_TRUE(errors.empty());
    }
    EXPECT_EQ(device->live_resources(), live);
    EXPECT_EQ(device->counters().upload_bytes, uploaded);
    // All existing batches are drawn, and batches that fit into the pool are still accepted.
    expect_drawn(first, 2);
    const Batch small = test::full_triangle(*device, 0.5F, "small");
    expect_drawn(small, 3);
    expect_drawn(first, 4);
  }
  const Batch terrain = device->create_batch({"terrain", positions, {}, indices, uvs});
  const Batch after = test::full_triangle(*device, 0.5F, "after");
  expect_drawn(first, 5);
  expect_drawn(after, 6);
}

TEST_F(FailureGpu, ADriverThatIgnoresRepeatedClearsOfDepthDrawsRight)
{
  static auto get_string = epoxy_glGetString;
  framebuffer = {};
  picture = {};
  shader = {};
  device.reset();
  {
    const Hook vendor(
        epoxy_glGetString, +[](GLenum name) {
          return name == GL_VENDOR ? reinterpret_cast<const GLubyte *>("NVIDIA Corporation") : get_string(name);
        });
    device = create_gl_device({.is_debug = false, .sink = [](std::string_view /*text*/) {}});
  }
  picture = device->create_texture({.name = "p", .format = Format::RGBA32F, .width = 4, .height = 4});
  const Texture depth = device->create_texture({.name = "d", .format = Format::Depth32F, .width = 4, .height = 4});
  framebuffer = device->create_framebuffer({"p", {{&picture}}, {&depth}});
  shader = make_shader(*device, "color", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  const Batch near = test::full_triangle(*device, 0.75F);
  const Batch far = test::full_triangle(*device, 0.25F);
  const auto expect_drawn_alone = [&](const Batch &batch, float value) {
    CommandList list;
    list.begin_pass("p", framebuffer, {.depth_load = LoadAction::Clear});
    list.set_shader(shader.id());
    list.set_state(State::WriteColor | State::WriteDepth | State::DepthNearerEqual);
    test::push_constants(list, shader, glm::vec4(value));
    test::append_draw(list, batch);
    list.end_pass();
    device->submit(list);
    EXPECT_EQ(gpu::read_as<glm::vec4>(*device, picture), std::vector<glm::vec4>(16, glm::vec4(value)));
  };
  expect_drawn_alone(near, 1);
  static float cleared;
  cleared = 0;
  static auto clear = epoxy_glClearNamedFramebufferfv;
  const Hook hook(
      epoxy_glClearNamedFramebufferfv, +[](GLuint name, GLenum buffer, GLint index, const GLfloat *value) {
        if (buffer != GL_DEPTH || std::exchange(cleared, *value) != *value) {
          clear(name, buffer, index, value);
        }
      });
  expect_drawn_alone(far, 2);
}

/** As NVIDIA's driver does it: copies are executed before draws and by glFinish, but after a later glBufferSubData. */
TEST_F(FailureGpu, ACopyThatTheDriverDelaysDoesNotReplaceALaterWrite)
{
  const Shader block_shader = make_shader(*device, "block", test::CLIP_SPACE_VERT, R"(
layout(std140, binding = 9) uniform color_block
{
  vec4 color;
};
layout(location = 0) out vec4 result;
void main()
{
  result = color;
})");
  const Buffer block = device->create_buffer({.name = "color_block", .size_bytes = sizeof(glm::vec4)});
  device->update(block, glm::vec4(1));
  const Batch first = test::full_triangle(*device, 0);
  expect_drawn(first, 1);
  std::vector<glm::vec3> positions = {{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}};
  positions.resize(2000);
  std::vector<std::uint32_t> indices = {0, 1, 2};
  indices.resize(2001);
  Batch large;
  {
    delayed_copies.clear();
    glFinish();
    const Hook copy(epoxy_glCopyNamedBufferSubData, &FailureGpu::delay_copy);
    const Hook finish(epoxy_glFinish, &FailureGpu::execute_delayed_copies);
    large = device->create_batch({"large", positions, {}, indices});
    CommandList list;
    const glm::vec4 two(2);
    list.update(block, 0, std::as_bytes(std::span(&two, 1)));
    device->submit(list);
    ASSERT_FALSE(delayed_copies.empty());
    device->update(block, glm::vec4(3));
    execute_delayed_copies();
  }
  expect_drawn(large, 4);
  expect_drawn(first, 5);
  CommandList list;
  list.begin_pass("p", framebuffer, {});
  list.set_shader(block_shader.id());
  list.set_state(State::WriteColor);
  list.bind_uniform(9, {block.id()});
  test::append_draw(list, first);
  list.end_pass();
  device->submit(list);
  EXPECT_EQ(gpu::read_as<glm::vec4>(*device, picture)[0], glm::vec4(3));
}

TEST_F(FailureGpu, AFailedSubmitLeavesAUsableDevice)
{
  const Batch full = test::full_triangle(*device, 0);
  CommandList list = drawing(full, 1);
  device->submit(list);
  const Counters before = device->counters();
  {
    const Hook hook(
        epoxy_glMultiDrawElementsIndirect,
        +[](GLenum, GLenum, const void *, GLsizei, GLsizei) { throw Error("thrown by a draw"); });
    EXPECT_EQ(error_of([&] { device->submit(list); }), "thrown by a draw");
  }
  EXPECT_EQ(device->counters().passes, before.passes);
  EXPECT_EQ(device->counters().draws, before.draws);
  EXPECT_EQ(device->counters().upload_bytes, before.upload_bytes);
  expect_drawn(full, 7);
}

TEST_F(FailureGpu, ATimerWithoutBitsGivesNothing)
{
  const TimerQuery timer = device->create_timer_query("t");
  device->time_begin(timer);
  device->time_end(timer);
  EXPECT_TRUE(device->take_seconds(timer));
  device.reset();
  static auto original = epoxy_glGetQueryiv;
  const Hook hook(
      epoxy_glGetQueryiv, +[](GLenum target, GLenum name, GLint *value) {
        name == GL_QUERY_COUNTER_BITS ? static_cast<void>(*value = 0) : original(target, name, value);
      });
  device = create_gl_device();
  const TimerQuery without = device->create_timer_query("t");
  device->time_begin(without);
  device->time_end(without);
  EXPECT_FALSE(device->take_seconds(without));
}

TEST(TimerTicks, WrapAtTheBitsOfTheCounter)
{
  EXPECT_EQ(elapsed_ticks(5, 12, 64), 7U);
  EXPECT_EQ(elapsed_ticks(~std::uint64_t(0) - 1, 3, 64), 5U);
  EXPECT_EQ(elapsed_ticks((std::uint64_t(1) << 36U) - 4, 6, 36), 10U);
  EXPECT_EQ(elapsed_ticks(0xFFFFFFFFU, 0, 32), 1U);
  EXPECT_EQ(elapsed_ticks(3, 3, 30), 0U);
}

/** Also without debug messages, for debuggers such as RenderDoc and apitrace. */
TEST_F(FailureGpu, EveryResourceAndEveryPassHasAName)
{
  const Batch batch = test::full_triangle(*device, 0.5F);
  expect_drawn(batch, 0.25F);
  const Buffer block = device->create_buffer({"block", BufferKind::Uniform, 64});
  const Sampler sampler = device->create_sampler({.name = "sampler"});
  const Texture texels = device->create_texture(
      {.name = "texels", .kind = TextureKind::Buffer, .format = Format::RGBA32F, .width = 16, .height = 1});
  const TimerQuery timer = device->create_timer_query("timer");
  device->time_begin(timer);
  static std::vector<std::string> groups;
  groups.clear();
  {
    const Hook names(
        epoxy_glPushDebugGroup, +[](GLenum /*source*/, GLuint /*id*/, GLsizei length, const GLchar *text) {
          groups.emplace_back(text, std::size_t(length));
        });
    const Hook end(
        epoxy_glPopDebugGroup, +[] {});
    device->submit(drawing(batch, 0.5F));
  }
  device->time_end(timer);
  EXPECT_EQ(groups, std::vector<std::string>{"p"});
  struct Kind {
    GLenum kind;
    GLboolean (*exists)(GLuint name);
    int least;
  };
  for (const auto &[kind, exists, least] : {Kind{GL_BUFFER, [](GLuint name) { return glIsBuffer(name); }, 6},
                                            Kind{GL_TEXTURE, [](GLuint name) { return glIsTexture(name); }, 2},
                                            Kind{GL_SAMPLER, [](GLuint name) { return glIsSampler(name); }, 1},
                                            Kind{GL_FRAMEBUFFER, [](GLuint name) { return glIsFramebuffer(name); }, 2},
                                            Kind{GL_PROGRAM, [](GLuint name) { return glIsProgram(name); }, 1},
                                            Kind{GL_VERTEX_ARRAY, [](GLuint name) { return glIsVertexArray(name); }, 2},
                                            Kind{GL_QUERY, [](GLuint name) { return glIsQuery(name); }, 2}}) {
    int count = 0;
    for (GLuint name = 1; name < 200; name++) {
      if (exists(name) == GL_TRUE) {
        count++;
        GLsizei length = 0;
        glGetObjectLabel(kind, name, 0, &length, nullptr);
        EXPECT_GT(length, 0) << "kind " << kind << ", name " << name;
      }
    }
    EXPECT_GE(count, least) << "kind " << kind;
  }
}

}  // namespace
}  // namespace gnomon::gpu
