// SPDX-License-Identifier: MIT
#include "gpu/gpu_gl_hook.hh"
#include "gpu/gpu_gl_state_table.hh"
#include "gpu/gpu_host_contexts.hh"
#include "gpu/gpu_testing.hh"

#include "gl/gl_state.hh"
#include "gpu_device.hh"

#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <set>

namespace gnomon::gpu {
namespace {

using test::error_of;
using test::expect_contains;
using test::Hook;
using test::HostObjects;
using test::make_shader;
using test::StateItem;
using test::StateSnapshot;

/** A picture that uses every kind of resource and binding, two draw buffers and a mip chain. */
struct HostedScene {
  explicit HostedScene(Device &owner) : device(owner)
  {
    const std::vector<float> ones(16, 1.0F);
    const std::vector<float> two = {2.0F};
    device.upload(source, 0, std::as_bytes(std::span(ones)));
    device.generate_mipmaps(source);
    device.upload(layers, 1, std::as_bytes(std::span(two)));
    device.upload(texels, 0, std::as_bytes(std::span(two)));
    device.update(block, glm::vec4(10));
    device.update(store, glm::vec4(100));
  }

  CommandList list() const
  {
    CommandList commands;
    const glm::vec4 value(1000);
    commands.update(later, 0, std::as_bytes(std::span(&value, 1)));
    commands.begin_pass("scene", framebuffer,
                        {.color_store = StoreAction::Store,
                         .depth_store = StoreAction::DontCare,
                         .depth_bias = {.constant = 1, .slope = 1}});
    commands.set_shader(shader.id());
    commands.set_state(State::WriteColor | State::WriteDepth | State::DepthNearerEqual | State::CullBack |
                       State::BlendAdd | State::DepthClamp);
    commands.bind_uniform(9, {block.id()});
    commands.bind_uniform(10, {later.id()});
    commands.bind_storage(0, {store.id()});
    commands.bind_texture(16, source.id(), sampler.id());
    commands.bind_texture(17, layers.id(), sampler.id());
    commands.bind_texture(18, texels.id(), sampler.id());
    commands.bind_texture(24, 0, 0);
    commands.bind_texture(25, 0, 0);
    test::push_constants(commands, shader, glm::vec4(10000));
    test::append_draw(commands, full);
    commands.set_state(State::WriteColor | State::BlendAdd);
    test::push_constants(commands, shader, glm::vec4(20000));
    commands.draw_procedural(0, 1);
    commands.end_pass();
    return commands;
  }

  /** Fails if the picture differs from the expected one. */
  void expect_picture()
  {
    EXPECT_EQ(gpu::read_as<glm::vec4>(device, picture), std::vector<glm::vec4>(16, glm::vec4(11115.0F)));
    EXPECT_EQ(gpu::read_as<glm::vec4>(device, second), std::vector<glm::vec4>(16, glm::vec4(5)));
  }

  Device &device;
  Texture picture = device.create_texture({.name = "p", .format = Format::RGBA32F, .width = 4, .height = 4});
  Texture second = device.create_texture({.name = "q", .format = Format::RGBA32F, .width = 4, .height = 4});
  Texture depth = device.create_texture({.name = "d", .format = Format::Depth32F, .width = 4, .height = 4});
  Texture source =
      device.create_texture({.name = "s", .format = Format::R32F, .width = 4, .height = 4, .mip_levels = 3});
  Texture layers =
      device.create_texture({.name = "l", .kind = TextureKind::Array, .format = Format::R32F, .layers = 2});
  Texture texels = device.create_texture({.name = "t", .kind = TextureKind::Buffer, .format = Format::R32F});
  Sampler sampler = device.create_sampler({.name = "nearest"});
  Buffer block = device.create_buffer({.name = "block", .size_bytes = 16});
  Buffer later = device.create_buffer({.name = "later", .size_bytes = 16});
  Buffer store = device.create_buffer({"store", BufferKind::Storage, 16});
  Framebuffer framebuffer = device.create_framebuffer({"p", {{&picture}, {&second}}, {&depth}});
  Batch full = test::full_triangle(device, 0.25F);
  Shader shader = make_shader(device, "all", test::CLIP_SPACE_VERT, R"(
PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  vec4 color;
};
layout(std140, binding = 9) uniform a_block
{
  vec4 a;
};
layout(std140, binding = 10) uniform c_block
{
  vec4 c;
};
layout(std140, binding = 0) readonly buffer b_block
{
  vec4 b;
};
layout(binding = 16) uniform sampler2D source;
layout(binding = 17) uniform sampler2DArray layers;
layout(binding = 18) uniform samplerBuffer texels;
layout(binding = 24) uniform sampler2D not_bound;
layout(binding = 25) uniform samplerBuffer texels_not_bound;
layout(location = 0) out vec4 result;
layout(location = 1) out vec4 other;
void main()
{
  // Samplers without a texture read 0, not the host's texture.
  result = color + a + b + c + texture(source, vec2(0.5)).r + texture(layers, vec3(0.5, 0.5, 1)).r +
           texelFetch(texels, 0).r + vec4(texture(not_bound, vec2(0.5)).rgb, 0) + texelFetch(texels_not_bound, 0);
  other = vec4(5);
})");
};

class HostStateGpu : public test::HostContextTest {
 protected:
  void SetUp() override
  {
    HostContextTest::SetUp();
    if (!IsSkipped() && !HasFailure()) {
      table = test::state_table();
    }
  }

  /** Calls \a action, which must leave all state unchanged. */
  template <typename Action>
  void expect_unchanged(const char *name, Action &&action)
  {
    const StateSnapshot before(table, deletion_state ? &*deletion_state : nullptr);
    action();
    EXPECT_EQ(before.differences(), std::vector<std::string>()) << name;
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR)) << name;
  }

  std::vector<StateItem> table;
  /** \see StateSnapshot::StateSnapshot */
  std::optional<StateSnapshot> deletion_state;
};

INSTANTIATE_TEST_SUITE_P(, HostStateGpu,
                         testing::Values(test::HostKind::Egl, test::HostKind::EglDebug, test::HostKind::Glx),
                         test::name_of_host);

TEST_P(HostStateGpu, TheTableHasAllStateAndUnusualValues)
{
  std::set<std::string> names;
  std::set<std::string> distinct;
  for (const StateItem &item : table) {
    names.insert(item.name);
    distinct.insert(item.name.substr(0, item.name.find_first_of(", ")));
  }
  EXPECT_EQ(names.size(), table.size());
  EXPECT_GE(distinct.size(), 150U);
  ASSERT_EQ(glGetError(), GLenum(GL_NO_ERROR));
  const StateSnapshot initial(table);
  ASSERT_EQ(glGetError(), GLenum(GL_NO_ERROR)) << "a row that cannot be queried";
  const HostObjects objects;
  test::set_unusual_state(objects);
  ASSERT_EQ(glGetError(), GLenum(GL_NO_ERROR));
  const std::size_t unusual = initial.differences().size();
  fmt::print("{} rows, {} of distinct names, {} at unusual values\n", table.size(), distinct.size(), unusual);
  // Excluded: queries, the debug group, and draw buffers whose blending or scissor test is off.
  EXPECT_GE(unusual, table.size() - 40);
}

TEST_P(HostStateGpu, IsUnchangedByEveryCall)
{
  const HostObjects objects;
  test::set_unusual_state(objects);
  std::unique_ptr<Device> device;
  expect_unchanged("device", [&] { device = create_gl_device({.context = ContextKind::Host}); });
  std::unique_ptr<HostedScene> scene;
  expect_unchanged("creation and upload", [&] { scene = std::make_unique<HostedScene>(*device); });
  const CommandList list = scene->list();
  expect_unchanged("submit", [&] { device->submit(list); });
  expect_unchanged("read", [&] { scene->expect_picture(); });
  expect_unchanged("upload", [&] { device->upload(scene->source, 0, std::vector<std::byte>(64)); });
  expect_unchanged("mipmaps", [&] { device->generate_mipmaps(scene->source); });
  expect_unchanged("update", [&] { device->update(scene->block, glm::vec4(3)); });
  expect_unchanged("finish", [&] { device->finish(); });
  expect_unchanged("timer", [&] {
    const TimerQuery timer = device->create_timer_query("t");
    device->time_begin(timer);
    device->submit(list);
    device->time_end(timer);
    const std::optional<double> seconds = device->take_seconds(timer);
    ASSERT_TRUE(seconds);
    EXPECT_GT(*seconds, 0);
    EXPECT_LT(*seconds, 10) << "written elsewhere";
  });
  expect_unchanged("growth of the pool", [&] {
    const std::vector<glm::vec3> positions(5000);
    const std::vector<std::uint32_t> indices(5001);
    static_cast<void>(device->create_batch({"large", positions, {}, indices}));
  });
  expect_unchanged("refused framebuffer", [&] {
    expect_contains(error_of([&] {
                      static_cast<void>(
                          device->create_framebuffer({"mixed", {{&scene->layers, all_layers}, {&scene->picture}}, {}}));
                    }),
                    "mixed");
  });
  expect_unchanged("destruction", [&] { scene.reset(); });
  expect_unchanged("end of the device", [&] { device.reset(); });
}

/** Counts the errors that the driver reports to the host. */
void GLAPIENTRY count_errors(GLenum /*source*/, GLenum type, GLuint /*id*/, GLenum /*severity*/, GLsizei /*length*/,
                             const GLchar *text, const void *count)
{
  if (type == GL_DEBUG_TYPE_ERROR) {
    ADD_FAILURE() << text;
    (*static_cast<int *>(const_cast<void *>(count)))++;
  }
}

TEST_P(HostStateGpu, DeletedNamesThatAreStillBoundAreTolerated)
{
  struct Deletion {
    std::string name;
    bool is_in_shared_context;
    std::vector<HostObjects::Kind> kinds;
  };
  std::vector<Deletion> deletions = {{"all", false, HostObjects::kinds()}, {"all shared", true, {}}};
  for (const HostObjects::Kind &kind : HostObjects::kinds()) {
    deletions.push_back({kind.name, false, {kind}});
    if (kind.is_shared) {
      deletions.push_back({std::string(kind.name) + ", in a shared context", true, {kind}});
      deletions[1].kinds.push_back(kind);
    }
  }
  std::set<std::string> deleted;
  for (const Deletion &deletion : deletions) {
    SCOPED_TRACE(deletion.name);
    HostObjects objects;
    test::set_unusual_state(objects);
    int error_count = 0;
    glDebugMessageCallback(&count_errors, &error_count);
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    const auto destroy = [&] {
      for (const HostObjects::Kind &kind : deletion.kinds) {
        (objects.*kind.destroy)();
      }
    };
    if (deletion.is_in_shared_context) {
      ASSERT_TRUE(context->in_shared_context(destroy));
    }
    else {
      destroy();
    }
    deletion_state.emplace(table);
    for (const std::string &name : deletion_state->deleted()) {
      deleted.insert(name);
    }
    std::unique_ptr<Device> device;
    std::vector<std::string> messages;
    expect_unchanged("device", [&] {
      device = create_gl_device(
          {.context = ContextKind::Host, .sink = [&](std::string_view text) { messages.emplace_back(text); }});
    });
    std::unique_ptr<HostedScene> scene;
    expect_unchanged("creation and upload", [&] { scene = std::make_unique<HostedScene>(*device); });
    Packet packet;
    {
      const Recording recording(*device, packet);
      scene->texels = device->create_texture({.name = "t", .kind = TextureKind::Buffer, .format = Format::R32F});
      const std::vector<float> two = {2.0F};
      device->upload(scene->texels, 0, std::as_bytes(std::span(two)));
      device->submit(scene->list());
    }
    expect_unchanged("packet", [&] { device->submit(packet); });
    expect_unchanged("read", [&] { scene->expect_picture(); });
    const CommandList list = scene->list();
    expect_unchanged("submit", [&] { device->submit(list); });
    expect_unchanged("timer", [&] {
      const TimerQuery timer = device->create_timer_query("t");
      device->time_begin(timer);
      device->time_end(timer);
      EXPECT_TRUE(device->take_seconds(timer));
    });
    expect_unchanged("destruction", [&] { scene.reset(); });
    expect_unchanged("end of the device", [&] { device.reset(); });
    EXPECT_EQ(messages, std::vector<std::string>());
    EXPECT_EQ(error_count, 0);
    glDebugMessageCallback(nullptr, nullptr);
  }
  // The trial is one: each kind of binding that can outlive its object did.
  for (const char *name :
       {"GL_CURRENT_PROGRAM", "GL_UNIFORM_BUFFER 9", "GL_SHADER_STORAGE_BUFFER 0", "GL_UNIFORM_BUFFER_BINDING",
        "GL_TEXTURE_BUFFER_BINDING", "GL_PIXEL_UNPACK_BUFFER_BINDING", "GL_DRAW_INDIRECT_BUFFER_BINDING",
        "GL_QUERY_BUFFER_BINDING", "GL_SAMPLER_BINDING, unit 16", "GL_TEXTURE_BINDING_2D, unit 16",
        "GL_TEXTURE_BINDING_2D_ARRAY, unit 17", "GL_TEXTURE_BINDING_BUFFER, unit 24", "GL_IMAGE_BINDING_NAME 0",
        "GL_RENDERBUFFER_BINDING", "GL_VERTEX_BINDING_BUFFER 0"}) {
    EXPECT_TRUE(deleted.contains(name)) << name;
  }
}

/** The device's own objects get names that are free again. They must not be bound in the place of deleted ones. */
TEST_P(HostStateGpu, ADeletedNameIsNotBoundToAnObjectOfTheDevice)
{
  const auto device = create_gl_device({.context = ContextKind::Host});
  HostedScene scene(*device);
  HostObjects objects;
  test::set_unusual_state(objects);
  ASSERT_TRUE(context->in_shared_context([&] {
    for (const HostObjects::Kind &kind : HostObjects::kinds()) {
      if (kind.is_shared) {
        (objects.*kind.destroy)();
      }
    }
  }));
  Packet packet;
  std::vector<Texture> textures;
  std::vector<Buffer> buffers;
  std::vector<Shader> shaders;
  std::vector<Sampler> samplers;
  {
    const Recording recording(*device, packet);
    device->submit(scene.list());
    for (int i = 0; i < 32; i++) {
      textures.push_back(device->create_texture({.name = "t", .format = Format::R32F, .width = 4, .height = 4}));
      buffers.push_back(device->create_buffer({.name = "b", .size_bytes = 16}));
      samplers.push_back(device->create_sampler({.name = "s"}));
    }
    for (int i = 0; i < 4; i++) {
      shaders.push_back(make_shader(*device, "s", test::CLIP_SPACE_VERT, test::COLOR_FRAG));
    }
  }
  device->submit(packet);
  const auto integer = [](GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return value;
  };
  EXPECT_EQ(integer(GL_CURRENT_PROGRAM), 0);
  EXPECT_EQ(integer(GL_UNIFORM_BUFFER_BINDING), 0);
  GLint slot = -1;
  glGetIntegeri_v(GL_UNIFORM_BUFFER_BINDING, 9, &slot);
  EXPECT_EQ(slot, 0);
  glGetIntegeri_v(GL_SHADER_STORAGE_BUFFER_BINDING, 0, &slot);
  EXPECT_EQ(slot, 0);
  glActiveTexture(GL_TEXTURE16);
  EXPECT_EQ(integer(GL_TEXTURE_BINDING_2D), 0);
  EXPECT_EQ(integer(GL_SAMPLER_BINDING), 0);
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

/** A program that did not link a second time stays current, and OpenGL does not make it current again. */
TEST_P(HostStateGpu, AProgramThatDoesNotLinkAgainIsTolerated)
{
  const HostObjects objects;
  test::set_unusual_state(objects);
  const GLuint shader = glCreateShader(GL_FRAGMENT_SHADER);
  glAttachShader(objects.program, shader);
  glLinkProgram(objects.program);
  GLint current = 0;
  glGetIntegerv(GL_CURRENT_PROGRAM, &current);
  ASSERT_EQ(GLuint(current), objects.program);
  const auto device = create_gl_device({.context = ContextKind::Host});
  HostedScene scene(*device);
  device->submit(scene.list());
  scene.expect_picture();
  glGetIntegerv(GL_CURRENT_PROGRAM, &current);
  EXPECT_EQ(current, 0);
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
  glDeleteShader(shader);
}

TEST_P(HostStateGpu, IsUnchangedByASubmitThatThrows)
{
  const HostObjects objects;
  test::set_unusual_state(objects);
  const auto device = create_gl_device({.context = ContextKind::Host});
  HostedScene scene(*device);
  device->submit(scene.list());
  const Counters before = device->counters();
  expect_unchanged("error of the driver", [&] {
    CommandList list;
    list.begin_pass("p", scene.framebuffer, {});
    list.bind_uniform(1 << 20, {scene.block.id()});
    list.end_pass();
    expect_contains(error_of([&] { device->submit(list); }), "submit: the driver reports: GL_INVALID_VALUE");
  });
  expect_unchanged("exception within a pass", [&] {
    const Hook hook(
        epoxy_glMultiDrawElementsIndirect,
        +[](GLenum, GLenum, const void *, GLsizei, GLsizei) { throw Error("thrown by a draw"); });
    EXPECT_EQ(error_of([&] { device->submit(scene.list()); }), "thrown by a draw");
  });
  EXPECT_EQ(device->counters().passes, before.passes) << "a list that failed is not counted";
  EXPECT_EQ(device->counters().upload_bytes, before.upload_bytes);
  device->submit(scene.list());
  scene.expect_picture();
}

TEST_P(HostStateGpu, TheTableFindsChangesOfEveryItem)
{
  const HostObjects objects;
  const StateSnapshot initial(table);
  const StateSnapshot *reference = &initial;
  struct Change {
    const char *item;
    std::function<void()> make;
  };
  for (const Change &change :
       {Change{"GL_CURRENT_PROGRAM", [&] { glUseProgram(objects.program); }},
        Change{"GL_TEXTURE_BINDING_2D_ARRAY, unit 17", [&] { glBindTextureUnit(17, objects.textures[4]); }},
        Change{"GL_UNIFORM_BUFFER 9", [&] { glBindBufferRange(GL_UNIFORM_BUFFER, 9, objects.buffer, 256, 16); }},
        Change{"GL_BLEND_DST_RGB, draw buffer 1", [&] { glBlendFunci(1, GL_ONE, GL_ONE); }},
        Change{"GL_UNPACK_ALIGNMENT", [&] { glPixelStorei(GL_UNPACK_ALIGNMENT, 1); }},
        Change{"GL_VIEWPORT 0", [&] { glViewportIndexedf(0, 0, 0, 5, 5); }},
        Change{"GL_CLIP_DEPTH_MODE", [&] { glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE); }}}) {
    const StateSnapshot before(table);
    change.make();
    const std::vector<std::string> found = before.differences();
    EXPECT_EQ(std::ranges::count_if(found, [&](const std::string &text) { return text.starts_with(change.item); }), 1)
        << change.item << ": " << fmt::format("{}", fmt::join(found, "; "));
    EXPECT_LE(found.size(), 2U) << fmt::format("{}", fmt::join(found, "; "));
  }
  EXPECT_GE(reference->differences().size(), 7U);
}

TEST_P(HostStateGpu, LeaksOfTheDeviceAreFound)
{
  const HostObjects objects;
  test::set_unusual_state(objects);
  const auto device = create_gl_device({.context = ContextKind::Host});
  HostedScene scene(*device);
  // Afterwards the function pointers are those of the driver.
  device->submit(scene.list());
  static GLuint ignored = 0;
  const auto expect_leak = [&](const char *item, auto &&action) {
    test::set_unusual_state(objects);
    const StateSnapshot before(table);
    action();
    const std::vector<std::string> found = before.differences();
    EXPECT_TRUE(std::ranges::any_of(found, [&](const std::string &text) { return text.starts_with(item); }))
        << item << ": " << fmt::format("{}", fmt::join(found, "; "));
  };
  const auto submit = [&] { device->submit(scene.list()); };
  // Each hook drops the calls that restore the value of the host.
  {
    static auto original = epoxy_glUseProgram;
    ignored = objects.program;
    const Hook hook(
        epoxy_glUseProgram, +[](GLuint program) { program == ignored ? void() : original(program); });
    expect_leak("GL_CURRENT_PROGRAM", submit);
  }
  {
    static auto original = epoxy_glClipControl;
    const Hook hook(
        epoxy_glClipControl,
        +[](GLenum origin, GLenum depth) { origin == GL_UPPER_LEFT ? void() : original(origin, depth); });
    expect_leak("GL_CLIP_ORIGIN", submit);
  }
  {
    static auto original = epoxy_glBindSampler;
    ignored = objects.sampler;
    const Hook hook(
        epoxy_glBindSampler,
        +[](GLuint unit, GLuint sampler) { sampler == ignored ? void() : original(unit, sampler); });
    expect_leak("GL_SAMPLER_BINDING, unit 16", submit);
  }
  {
    static auto original = epoxy_glBindBufferRange;
    ignored = objects.buffer;
    const Hook hook(
        epoxy_glBindBufferRange, +[](GLenum target, GLuint slot, GLuint buffer, GLintptr offset, GLsizeiptr size) {
          buffer == ignored ? void() : original(target, slot, buffer, offset, size);
        });
    const auto submit_only = [&] { device->submit(scene.list()); };
    const StateSnapshot before(table);
    submit_only();
    const std::vector<std::string> found = before.differences();
    EXPECT_TRUE(std::ranges::any_of(found, [](const auto &text) { return text.starts_with("GL_UNIFORM_BUFFER 9"); }));
  }
  {
    static auto original = epoxy_glPixelStorei;
    const Hook hook(
        epoxy_glPixelStorei, +[](GLenum name, GLint value) { value == 17 ? void() : original(name, value); });
    const StateSnapshot before(table);
    device->upload(scene.source, 0, std::vector<std::byte>(64));
    const std::vector<std::string> found = before.differences();
    EXPECT_TRUE(std::ranges::any_of(found, [](const auto &text) { return text.starts_with("GL_UNPACK_ROW_LENGTH"); }));
  }
  {
    static auto original = epoxy_glBindFramebuffer;
    ignored = objects.draw_framebuffer;
    const Hook hook(
        epoxy_glBindFramebuffer,
        +[](GLenum target, GLuint name) { name == ignored ? void() : original(target, name); });
    const StateSnapshot before(table);
    device->submit(scene.list());
    const std::vector<std::string> found = before.differences();
    EXPECT_TRUE(
        std::ranges::any_of(found, [](const auto &text) { return text.starts_with("GL_DRAW_FRAMEBUFFER_BINDING"); }));
  }
}

TEST_P(HostStateGpu, AnErrorOfTheHostStaysTheHosts)
{
  const auto device = create_gl_device({.context = ContextKind::Host});
  const auto raise_enum = [] { glEnable(GL_NONE); };
  const auto raise_value = [] { glLineWidth(-1); };
  const auto raise_operation = [] { glBindVertexArray(0xFFFFFFU); };
  for (const auto &[raise, error] : {std::pair<void (*)(), GLenum>(raise_enum, GL_INVALID_ENUM),
                                     std::pair<void (*)(), GLenum>(raise_value, GL_INVALID_VALUE),
                                     std::pair<void (*)(), GLenum>(raise_operation, GL_INVALID_OPERATION)}) {
    raise();
    HostedScene scene(*device);
    EXPECT_EQ(glGetError(), error);
    raise();
    device->submit(scene.list());
    EXPECT_EQ(glGetError(), error);
    raise();
    scene.expect_picture();
    EXPECT_EQ(glGetError(), error);
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
  }
}

TEST_P(HostStateGpu, AnErrorThatCannotBeRaisedAgainIsReported)
{
  std::vector<std::string> messages;
  const auto device = create_gl_device(
      {.context = ContextKind::Host, .sink = [&](std::string_view text) { messages.emplace_back(text); }});
  const GLuint incomplete = [] {
    GLuint name = 0;
    glCreateFramebuffers(1, &name);
    return name;
  }();
  glBindFramebuffer(GL_FRAMEBUFFER, incomplete);
  glClear(GL_COLOR_BUFFER_BIT);
  const Sampler sampler = device->create_sampler({.name = "s"});
  ASSERT_EQ(messages.size(), 1U);
  expect_contains(messages[0], "GL_INVALID_FRAMEBUFFER_OPERATION");
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
  glDeleteFramebuffers(1, &incomplete);
}

#ifndef NDEBUG
TEST_P(HostStateGpu, WhatCannotBeSavedIsAnErrorThatNamesIt)
{
  const auto device = create_gl_device({.context = ContextKind::Host});
  HostedScene scene(*device);
  const auto message = [&] { return error_of([&] { device->submit(scene.list()); }); };
  GLuint query = 0;
  glCreateQueries(GL_SAMPLES_PASSED, 1, &query);
  glBeginQuery(GL_SAMPLES_PASSED, query);
  expect_contains(message(), "GL_SAMPLES_PASSED is active");
  expect_contains(error_of([&] { device->generate_mipmaps(scene.source); }), "GL_SAMPLES_PASSED is active");
  glEndQuery(GL_SAMPLES_PASSED);
  EXPECT_EQ(message(), "");
  glBeginConditionalRender(query, GL_QUERY_WAIT);
  expect_contains(message(), "conditional rendering is active");
  glEndConditionalRender();
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR)) << "it was still active";
  EXPECT_EQ(message(), "");
  GLuint timer = 0;
  glCreateQueries(GL_TIME_ELAPSED, 1, &timer);
  glBeginQuery(GL_TIME_ELAPSED, timer);
  EXPECT_EQ(message(), "") << "a host may time what is drawn here";
  glEndQuery(GL_TIME_ELAPSED);
  glDeleteQueries(1, &query);
  glDeleteQueries(1, &timer);
}
#endif

TEST_P(HostStateGpu, ADeviceDrawsAndTheContextStaysTheHosts)
{
  {
    const auto device = create_gl_device({.context = ContextKind::Host});
    expect_contains(device->description(), "host");
    HostedScene scene(*device);
    device->submit(scene.list());
    scene.expect_picture();
    EXPECT_TRUE(context->is_current());
  }
  EXPECT_TRUE(context->is_current()) << "the device destroyed the host's context";
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
  EXPECT_TRUE(glGetString(GL_VERSION)) << "the context does not work any more";
}

TEST_P(HostStateGpu, AHeadlessDeviceDoesNotTakeTheHostsPlace)
{
  const GLubyte *version = glGetString(GL_VERSION);
  expect_contains(error_of([] { static_cast<void>(create_gl_device()); }), "current");
  EXPECT_TRUE(context->is_current());
  EXPECT_EQ(eglGetCurrentContext() != EGL_NO_CONTEXT, GetParam() != test::HostKind::Glx);
  EXPECT_EQ(glGetString(GL_VERSION), version);
}

TEST_P(HostStateGpu, CostOfSaving)
{
  using Clock = std::chrono::steady_clock;
  const HostObjects objects;
  test::set_unusual_state(objects);
  const DeviceNames names;
  HostState state(true, names);
  constexpr int count = 2000;
  double best = 1e9;
  for (int round = 0; round < 5; round++) {
    const auto start = Clock::now();
    for (int i = 0; i < count; i++) {
      state.keep_draw_state();
      for (const GLuint slot : {8U, 9U, 10U, 11U, 12U}) {
        state.keep_indexed_buffer(GL_UNIFORM_BUFFER, slot);
      }
      state.keep_indexed_buffer(GL_SHADER_STORAGE_BUFFER, 0);
      state.keep_indexed_buffer(GL_SHADER_STORAGE_BUFFER, 1);
      for (const GLuint unit : {16U, 17U, 18U, 19U, 20U, 24U, 25U}) {
        state.keep_texture(unit, GL_TEXTURE_2D);
      }
      state.keep_color_buffers(1);
      state.restore();
    }
    best = std::min(best, std::chrono::duration<double>(Clock::now() - start).count() / count);
  }
  fmt::print("saving and restoring a host's state takes {:.1f} µs a packet (5 uniform and 2 storage slots, 7 units)\n",
             best * 1e6);
  RecordProperty("saving_us", std::to_string(best * 1e6));
}

}  // namespace
}  // namespace gnomon::gpu
