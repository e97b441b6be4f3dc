// SPDX-License-Identifier: MIT
#include "gpu/gpu_host_contexts.hh"
#include "gpu/gpu_testing.hh"
#include "gpu_device_fixture.hh"

#include "slots_shared.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>

namespace gnomon::gpu {
namespace {

using test::error_of;
using test::expect_contains;
using test::make_shader;

/** A picture that uses all kinds of resources and bindings. */
struct SmallScene {
  explicit SmallScene(Device &owner) : device(owner)
  {
    // An odd size: rows of 6 bytes.
    std::vector<std::uint16_t> halves;
    for (int i = 0; i < 9; i++) {
      halves.push_back(glm::packHalf1x16(float(i)));
    }
    device.upload(source, 0, std::as_bytes(std::span(halves)));
    EXPECT_EQ(gpu::read_as<std::uint16_t>(device, source), halves);
    device.update(block, glm::vec4(1, 2, 3, 4));
    device.update(store, glm::vec4(10));
  }

  std::vector<glm::vec4> drawn()
  {
    draw(State::WriteColor | State::WriteDepth | State::DepthNearerEqual | State::CullBack | State::BlendAdd |
             State::DepthClamp,
         full);
    EXPECT_EQ(gpu::read_as<float>(device, depth), std::vector<float>(16, 0.25F));
    return gpu::read_as<glm::vec4>(device, picture);
  }

  /** Depths of the edges of a triangle, 0 beside them. */
  std::vector<float> edge_depths()
  {
    draw(State::WriteDepth | State::DepthNearerEqual | State::Wireframe, corner);
    return gpu::read_as<float>(device, depth);
  }

  void draw(State state, const Batch &batch)
  {
    CommandList list;
    list.begin_pass("p", framebuffer, {});
    list.set_shader(shader.id());
    list.set_state(state);
    list.bind_uniform(9, {block.id()});
    list.bind_storage(0, {store.id()});
    list.bind_texture(16, source.id(), sampler.id());
    test::push_constants(list, shader, glm::vec4(100, 200, 300, 400));
    test::append_draw(list, batch);
    list.end_pass();
    device.submit(list);
  }

  Device &device;
  Texture picture = device.create_texture({.name = "p", .format = Format::RGBA32F, .width = 4, .height = 4});
  Texture depth = device.create_texture({.name = "d", .format = Format::Depth32F, .width = 4, .height = 4});
  Texture source = device.create_texture({.name = "s", .format = Format::R16F, .width = 3, .height = 3});
  Sampler sampler = device.create_sampler({.name = "nearest"});
  Buffer block = device.create_buffer({.name = "block", .size_bytes = 16});
  Buffer store = device.create_buffer({"store", BufferKind::Storage, 16});
  Framebuffer framebuffer = device.create_framebuffer({"p", {{&picture}}, {&depth}});
  Batch full = test::full_triangle(device, 0.25F);
  static constexpr std::array corner_positions = {glm::vec3(-0.6F, -0.6F, 0.25F), glm::vec3(0.6F, -0.6F, 0.25F),
                                                  glm::vec3(-0.6F, 0.6F, 0.25F)};
  static constexpr std::array<std::uint32_t, 3> corner_indices = {0, 1, 2};
  Batch corner =
      device.create_batch({.name = "corner", .positions = corner_positions, .normals = {}, .indices = corner_indices});
  Shader shader = make_shader(device, "all", test::CLIP_SPACE_VERT, R"(
PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  vec4 color;
};
layout(std140, binding = 9) uniform a_block
{
  vec4 a;
};
layout(std140, binding = 0) readonly buffer b_block
{
  vec4 b;
};
layout(binding = 16) uniform sampler2D source;
layout(location = 0) out vec4 result;
void main()
{
  result = color + a + b + texelFetch(source, ivec2(2, 2), 0).r * 1000 + vec4(0, 0, 0, gl_FragCoord.z);
})");
};

std::vector<glm::vec4> small_picture(Device &device)
{
  return SmallScene(device).drawn();
}

const std::vector<glm::vec4> SMALL_PICTURE(16, glm::vec4(8111, 8212, 8313, 8414.25F));

class HostContextGpu : public testing::Test {
 protected:
  void SetUp() override
  {
    if (test::testing_backend() != "gl") {
      GTEST_SKIP() << "of OpenGL alone";
    }
    if (!host.is_current()) {
      if (const char *ci = std::getenv("CI"); ci && *ci) {
        FAIL() << "CI is set and EGL gives no surfaceless context";
      }
      GTEST_SKIP() << "EGL gives no surfaceless context";
    }
  }
  test::EglHostContext host;
};

TEST_F(HostContextGpu, DrawsAndStaysTheHosts)
{
  {
    const auto device = create_gl_device({.context = ContextKind::Host});
    expect_contains(device->description(), "host");
    EXPECT_EQ(small_picture(*device), SMALL_PICTURE);
    EXPECT_TRUE(host.is_current());
  }
  EXPECT_TRUE(host.is_current()) << "the device took the context along";
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
  GLint major = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  EXPECT_GE(major, 4) << "the context does not work any more";
}

TEST_F(HostContextGpu, CallsInAnotherContextAreErrorsAndTouchNothingThere)
{
  const std::string message = "the context in which the device was made is not current on this thread";
  auto device = create_gl_device({.context = ContextKind::Host});
  std::optional<Texture> texture = device->create_texture({.name = "t"});
  std::vector<std::string> messages;
  auto other_device = create_gl_device(
      {.context = ContextKind::Host, .sink = [&](std::string_view text) { messages.emplace_back(text); }});
  const Texture left = other_device->create_texture({.name = "left"});
  {
    const test::EglHostContext other;
    ASSERT_TRUE(other.is_current());
    // Names of the other context, which are those of the device's objects, too.
    std::array<GLuint, 16> names{};
    glCreateTextures(GL_TEXTURE_2D, GLsizei(names.size()), names.data());
    expect_contains(error_of([&] { static_cast<void>(device->create_texture({.name = "u"})); }), message);
    expect_contains(error_of([&] { device->finish(); }), message);
    expect_contains(error_of([&] { device->submit(CommandList()); }), message);
    expect_contains(error_of([&] { static_cast<void>(device->read(*texture)); }), message);
    Packet packet;
    expect_contains(error_of([&] { device->run(packet, [] {}); }), message);
    texture.reset();
    other_device.reset();
    EXPECT_TRUE(std::ranges::all_of(names, [](GLuint name) { return glIsTexture(name) == GL_TRUE; }));
    expect_contains(messages.empty() ? "" : messages.front(),
                    "is not current on this thread: its objects are not deleted");
  }
  // Without a current context.
  eglMakeCurrent(eglGetCurrentDisplay(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  expect_contains(error_of([&] { device->finish(); }), message);
  host.make_current();
  EXPECT_EQ(small_picture(*device), SMALL_PICTURE);
}

GLint integer(GLenum name)
{
  // The query of the polygon mode may return two values.
  std::array<GLint, 2> values = {-1, -1};
  glGetIntegerv(name, values.data());
  return values[0];
}

GLint integer_at(GLenum name, GLuint index)
{
  GLint value = -1;
  glGetIntegeri_v(name, index, &value);
  return value;
}

TEST_F(HostContextGpu, HostFindsDefaultsAfterASubmission)
{
  const auto device = create_gl_device({.context = ContextKind::Host});
  // Deleting a bound object unbinds it, so the scene's resources exist until the end of the test.
  SmallScene scene(*device);
  EXPECT_EQ(scene.drawn(), SMALL_PICTURE);

  struct Value {
    const char *what;
    GLenum name;
    GLint initial;
  };
  for (const Value &value : {Value{"clip origin", GL_CLIP_ORIGIN, GL_LOWER_LEFT},
                             Value{"clip depth mode", GL_CLIP_DEPTH_MODE, GL_NEGATIVE_ONE_TO_ONE},
                             Value{"program", GL_CURRENT_PROGRAM, 0},
                             Value{"vertex array", GL_VERTEX_ARRAY_BINDING, 0},
                             Value{"draw framebuffer", GL_DRAW_FRAMEBUFFER_BINDING, 0},
                             Value{"read framebuffer", GL_READ_FRAMEBUFFER_BINDING, 0},
                             Value{"array buffer", GL_ARRAY_BUFFER_BINDING, 0},
                             Value{"indirect buffer", GL_DRAW_INDIRECT_BUFFER_BINDING, 0},
                             Value{"uniform buffer", GL_UNIFORM_BUFFER_BINDING, 0},
                             Value{"storage buffer", GL_SHADER_STORAGE_BUFFER_BINDING, 0},
                             Value{"unpack buffer", GL_PIXEL_UNPACK_BUFFER_BINDING, 0},
                             Value{"active texture", GL_ACTIVE_TEXTURE, GL_TEXTURE0},
                             Value{"depth function", GL_DEPTH_FUNC, GL_LESS},
                             Value{"polygon mode", GL_POLYGON_MODE, GL_FILL},
                             Value{"depth mask", GL_DEPTH_WRITEMASK, GL_TRUE},
                             Value{"cull face", GL_CULL_FACE_MODE, GL_BACK},
                             Value{"front face", GL_FRONT_FACE, GL_CCW},
                             Value{"blend source", GL_BLEND_SRC_RGB, GL_ONE},
                             Value{"blend source alpha", GL_BLEND_SRC_ALPHA, GL_ONE},
                             Value{"blend destination", GL_BLEND_DST_RGB, GL_ZERO},
                             Value{"blend destination alpha", GL_BLEND_DST_ALPHA, GL_ZERO},
                             Value{"blend equation", GL_BLEND_EQUATION_RGB, GL_FUNC_ADD},
                             Value{"unpack alignment", GL_UNPACK_ALIGNMENT, 4},
                             Value{"pack alignment", GL_PACK_ALIGNMENT, 4}}) {
    EXPECT_EQ(integer(value.name), value.initial) << value.what;
  }
  for (const GLenum capability :
       {GL_DEPTH_TEST, GL_CULL_FACE, GL_BLEND, GL_DEPTH_CLAMP, GL_SCISSOR_TEST, GL_STENCIL_TEST,
        GL_TEXTURE_CUBE_MAP_SEAMLESS, GL_POLYGON_OFFSET_FILL, GL_FRAMEBUFFER_SRGB, GL_RASTERIZER_DISCARD}) {
    EXPECT_FALSE(glIsEnabled(capability)) << "capability 0x" << std::hex << capability;
  }
  // A sampler left in a unit would overrule the parameters of the host's textures.
  glActiveTexture(GL_TEXTURE16);
  EXPECT_EQ(integer(GL_TEXTURE_BINDING_2D), 0);
  EXPECT_EQ(integer(GL_SAMPLER_BINDING), 0);
  glActiveTexture(GL_TEXTURE0);
  EXPECT_EQ(integer_at(GL_UNIFORM_BUFFER_BINDING, 9), 0);
  EXPECT_EQ(integer_at(GL_UNIFORM_BUFFER_BINDING, PUSH_CONSTANT_SLOT), 0);
  EXPECT_EQ(integer_at(GL_SHADER_STORAGE_BUFFER_BINDING, 0), 0);
  std::array<GLboolean, 4> mask{};
  glGetBooleanv(GL_COLOR_WRITEMASK, mask.data());
  EXPECT_EQ(mask, (std::array<GLboolean, 4>{GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE}));
}

TEST_F(HostContextGpu, StateOfTheHostDoesNotReachThePicture)
{
  const auto device = create_gl_device({.context = ContextKind::Host});
  struct Hostility {
    const char *name;
    void (*set)();
    void (*unset)();
  };
  static GLuint buffer = 0;
  const std::vector<Hostility> hostilities = {
      {"scissor",
       [] {
         glEnable(GL_SCISSOR_TEST);
         glScissor(0, 0, 1, 1);
       },
       [] { glDisable(GL_SCISSOR_TEST); }},
      {"stencil",
       [] {
         glEnable(GL_STENCIL_TEST);
         glStencilFunc(GL_NEVER, 0, 0);
       },
       [] { glDisable(GL_STENCIL_TEST); }},
      {"colour mask", [] { glColorMask(0, 1, 0, 1); }, [] { glColorMask(1, 1, 1, 1); }},
      {"indexed colour mask", [] { glColorMaski(0, 0, 0, 0, 0); }, [] { glColorMask(1, 1, 1, 1); }},
      {"indexed blend", [] { glBlendFunci(0, GL_ZERO, GL_ZERO); }, [] { glBlendFunc(GL_ONE, GL_ZERO); }},
      {"blend equation", [] { glBlendEquation(GL_FUNC_REVERSE_SUBTRACT); }, [] { glBlendEquation(GL_FUNC_ADD); }},
      {"depth range", [] { glDepthRange(0.5, 0.75); }, [] { glDepthRange(0, 1); }},
      {"polygon mode", [] { glPolygonMode(GL_FRONT_AND_BACK, GL_LINE); },
       [] { glPolygonMode(GL_FRONT_AND_BACK, GL_FILL); }},
      {"logic operation",
       [] {
         glEnable(GL_COLOR_LOGIC_OP);
         glLogicOp(GL_CLEAR);
       },
       [] { glDisable(GL_COLOR_LOGIC_OP); }},
      {"polygon offset",
       [] {
         glEnable(GL_POLYGON_OFFSET_FILL);
         glEnable(GL_POLYGON_OFFSET_LINE);
         glPolygonOffset(0, 1e6F);
       },
       [] {
         glDisable(GL_POLYGON_OFFSET_FILL);
         glDisable(GL_POLYGON_OFFSET_LINE);
       }},
      {"discard", [] { glEnable(GL_RASTERIZER_DISCARD); }, [] { glDisable(GL_RASTERIZER_DISCARD); }},
      {"primitive restart",
       [] {
         glEnable(GL_PRIMITIVE_RESTART);
         glPrimitiveRestartIndex(1);
       },
       [] { glDisable(GL_PRIMITIVE_RESTART); }},
      {"clip distance", [] { glEnable(GL_CLIP_DISTANCE0); }, [] { glDisable(GL_CLIP_DISTANCE0); }},
      {"sample mask",
       [] {
         glEnable(GL_SAMPLE_MASK);
         glSampleMaski(0, 0);
       },
       [] { glDisable(GL_SAMPLE_MASK); }},
      {"clip control", [] { glClipControl(GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE); }, [] {}},
      {"unpack rows", [] { glPixelStorei(GL_UNPACK_ROW_LENGTH, 17); }, [] { glPixelStorei(GL_UNPACK_ROW_LENGTH, 0); }},
      {"unpack skip", [] { glPixelStorei(GL_UNPACK_SKIP_PIXELS, 1); }, [] { glPixelStorei(GL_UNPACK_SKIP_PIXELS, 0); }},
      {"pack rows", [] { glPixelStorei(GL_PACK_ROW_LENGTH, 17); }, [] { glPixelStorei(GL_PACK_ROW_LENGTH, 0); }},
      {"unpack buffer", [] { glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer); },
       [] { glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0); }},
      {"pack buffer", [] { glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer); },
       [] { glBindBuffer(GL_PIXEL_PACK_BUFFER, 0); }},
  };
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, 4096, nullptr, GL_STATIC_DRAW);
  glBindBuffer(GL_ARRAY_BUFFER, 0);
  const std::vector<float> edges = SmallScene(*device).edge_depths();
  EXPECT_EQ(*std::ranges::max_element(edges), 0.25F);
  for (const Hostility &hostility : hostilities) {
    SCOPED_TRACE(hostility.name);
    hostility.set();
    try {
      SmallScene scene(*device);
      EXPECT_EQ(scene.drawn(), SMALL_PICTURE);
      EXPECT_EQ(scene.edge_depths(), edges);
    }
    catch (const Error &error) {
      ADD_FAILURE() << error.what();
    }
    hostility.unset();
  }
  glDeleteBuffers(1, &buffer);
}

TEST_F(HostContextGpu, HeadlessDeviceDoesNotTakeItsPlace)
{
  const std::string message = error_of([] { static_cast<void>(create_gl_device()); });
  expect_contains(message, "current");
  EXPECT_TRUE(host.is_current());
}

TEST(DeviceGpu, HostWithoutAContextIsAnError)
{
  expect_contains(error_of([] { static_cast<void>(create_gl_device({.context = ContextKind::Host})); }), "current");
}

class HeadlessGpu : public test::GlDeviceTest {};

TEST_F(HeadlessGpu, DescribesItself)
{
  expect_contains(device->description(), "OpenGL ");
  EXPECT_EQ(device->description().find('\n'), std::string::npos);
}

TEST_F(HeadlessGpu, LimitsAreAtLeastWhatOpenGlPromises)
{
  const Limits &limits = device->limits();
  EXPECT_GE(limits.texture_size_max, 16384);
  EXPECT_GE(limits.array_layers_max, 2048);
  EXPECT_GE(limits.uniform_block_bytes_max, 16384U);
  EXPECT_GE(limits.storage_block_bytes_max, std::size_t(1) << 27U);
  EXPECT_GE(limits.color_attachment_max, 8);
  EXPECT_GE(limits.anisotropy_max, 1);
  EXPECT_LE(limits.uniform_offset_alignment, 256U);
  EXPECT_GT(limits.uniform_offset_alignment, 0U);
}

TEST_F(HeadlessGpu, SecondDeviceAfterTheFirstWorks)
{
  EXPECT_EQ(small_picture(*device), SMALL_PICTURE);
  const Texture left_over = device->create_texture({.name = "left over"});
  device.reset();
  EXPECT_FALSE(left_over);
  EXPECT_EQ(eglGetCurrentContext(), EGL_NO_CONTEXT);
  device = test::testing_gl_device();
  ASSERT_TRUE(device);
  EXPECT_EQ(small_picture(*device), SMALL_PICTURE);
}

TEST_F(HeadlessGpu, SecondDeviceBesideTheFirstIsAnErrorThatLeavesItWorking)
{
  expect_contains(error_of([] { static_cast<void>(create_gl_device()); }), "current");
  EXPECT_EQ(small_picture(*device), SMALL_PICTURE);
}

TEST_F(HeadlessGpu, EndNamesWhatLives)
{
  std::vector<std::string> messages;
  device.reset();
  device = create_gl_device({.sink = [&](std::string_view text) { messages.emplace_back(text); }});
  const Texture texture = device->create_texture({.name = "left over"});
  messages.clear();
  device.reset();
  ASSERT_EQ(messages.size(), 1U);
  expect_contains(messages[0], "texture 'left over'");
}

TEST_F(HeadlessGpu, DriverErrorIsAnErrorOnceInADebugDevice)
{
  const Texture picture = device->create_texture({.name = "p", .width = 4, .height = 4});
  const Framebuffer framebuffer = device->create_framebuffer({"p", {{&picture}}, {}});
  const Buffer block = device->create_buffer({.name = "block", .size_bytes = 1024});
  CommandList list;
  list.begin_pass("p", framebuffer, {});
  // No driver has this many slots, and the validation does not know the limit.
  list.bind_uniform(1 << 20, {block.id(), 0, 16});
  list.end_pass();
  const std::uint64_t passes = device->counters().passes;
  expect_contains(error_of([&] { device->submit(list); }), "submit: the driver reports");
  EXPECT_EQ(device->counters().passes, passes);
  // The error is not reported again by a valid command.
  EXPECT_EQ(small_picture(*device), SMALL_PICTURE);
}

TEST_F(HeadlessGpu, ShaderThatTheDriverAloneRejectsIsAnErrorThatMakesNothing)
{
  // Past the driver's limit of a uniform block's size, which glslang does not know.
  const std::string text = fmt::format("layout(std140, binding = 9) uniform large_block {{ vec4 v[{}]; }};\n",
                                       integer(GL_MAX_UNIFORM_BLOCK_SIZE) / 16 + 1) +
                           "layout(location = 0) out vec4 result;\nvoid main()\n{\n"
                           "  result = v[int(gl_FragCoord.x)];\n}\n";
  const std::vector<std::string> before = device->live_resources();
  const std::string message =
      error_of([&] { static_cast<void>(make_shader(*device, "greedy", test::CLIP_SPACE_VERT, text)); });
  expect_contains(message, "shader 'greedy': the driver");
  EXPECT_EQ(device->live_resources(), before);
  EXPECT_EQ(device->counters().shaders_made, 0U);
  EXPECT_EQ(small_picture(*device), SMALL_PICTURE);
}

TEST(HeadlessDeathTest, WithoutAnyWayTheErrorNamesEach)
{
  // In a separate process, because EGL reads its environment once.
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent", 1);
        unsetenv("DISPLAY");
        unsetenv("WAYLAND_DISPLAY");
        const std::string message = error_of([] { static_cast<void>(create_gl_device()); });
        fmt::print(stderr, "{}\n", message);
        std::exit(message.empty() ? 1 : 3);
      },
      testing::ExitedWithCode(3),
      "no OpenGL 4.5 context: EGL device: .*; EGL surfaceless: .*; EGL device.*; hidden window: .*DISPLAY");
}

}  // namespace
}  // namespace gnomon::gpu
