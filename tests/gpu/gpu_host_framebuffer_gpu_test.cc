// SPDX-License-Identifier: MIT
// Passes that draw into framebuffers of the host.
#include "gpu/gpu_gl_state_table.hh"
#include "gpu/gpu_host_framebuffer.hh"
#include "gpu/gpu_testing.hh"

#include "gpu_device.hh"

#include <cmath>
#include <cstring>

namespace gnomon::gpu {
namespace {

using test::append_draw;
using test::error_of;
using test::expect_contains;
using test::HostPicture;
using test::make_shader;
using test::Pixels;
using test::push_constants;

constexpr glm::ivec2 size_px(9, 7);
constexpr Rectangle part{{3, 2}, {4, 3}};

bool is_in_part(int x, int y)
{
  return x >= 3 && x < 7 && y >= 2 && y < 5;
}

class HostFramebufferTest : public test::HostFramebufferTest {
 protected:
  void SetUp() override
  {
    test::HostFramebufferTest::SetUp();
    if (!IsSkipped() && !HasFailure()) {
      shader = make_shader(*device, "color", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
      full = test::full_triangle(*device, 0.25F);
    }
  }
  void draw(const HostPicture &host, const glm::vec4 &color, const PassActions &actions, State state)
  {
    CommandList list;
    list.begin_pass("host", host.framebuffer(), actions);
    list.set_shader(shader.id());
    list.set_state(state);
    push_constants(list, shader, color);
    append_draw(list, full);
    list.end_pass();
    device->submit(list);
  }
  /** The pixels of \a part are \a inside, the others as in \a before. */
  static void expect_part(const Pixels &pixels, const Pixels &before, const std::array<int, 4> &inside)
  {
    for (int y = 0; y < size_px.y; y++) {
      for (int x = 0; x < size_px.x; x++) {
        ASSERT_EQ(pixels.at(x, y), is_in_part(x, y) ? inside : before.at(x, y)) << x << ", " << y;
      }
    }
  }

  Shader shader;
  Batch full;
};

TEST_P(HostFramebufferTest, OnlyTheRectangleChanges)
{
  for (const int samples : {0, 4}) {
    const HostPicture host(size_px, GL_RGBA8, samples);
    const Pixels before = host.pixels();
    draw(host, {1, 0, 0.2F, 0.6F}, {.color_load = LoadAction::Load, .viewport = part, .scissor = part},
         State::WriteColor);
    expect_part(host.pixels(), before, {255, 0, 51, 153});
    draw(host, glm::vec4(1), {.clear_color = glm::vec4(0, 1, 0, 0), .viewport = part, .scissor = part}, State::None);
    expect_part(host.pixels(), before, {0, 255, 0, 0});
    // The rest of the framebuffer is not discarded.
    draw(host, glm::vec4(1),
         {.color_load = LoadAction::DontCare, .color_store = StoreAction::DontCare, .scissor = part}, State::None);
    expect_part(host.pixels(), before, {0, 255, 0, 0});
  }
}

TEST_P(HostFramebufferTest, AnSrgbFormatEncodesOnlyWhereItIsAskedTo)
{
  const auto encoded = [](double v) { return int(std::lround(255.0 * (1.055 * std::pow(v, 1.0 / 2.4) - 0.055))); };
  const HostPicture host(size_px, GL_SRGB8_ALPHA8, 4);
  const Pixels before = host.pixels();
  PassActions actions{.color_load = LoadAction::Load, .viewport = part, .scissor = part};
  draw(host, {0.2F, 0.4F, 0.8F, 0.4F}, actions, State::WriteColor);
  expect_part(host.pixels(), before, {51, 102, 204, 102});
  actions.is_srgb_encoded = true;
  draw(host, {0.2F, 0.4F, 0.8F, 0.4F}, actions, State::WriteColor);
  const std::array<int, 4> expected = {encoded(0.2), encoded(0.4), encoded(0.8), 102};
  const Pixels pixels = host.pixels();
  for (std::size_t c = 0; c < 4; c++) {
    // Drivers encode with a table.
    EXPECT_NEAR(pixels.at(4, 3)[c], expected[c], 1);
  }
}

TEST_P(HostFramebufferTest, OverBlendsPremultipliedColours)
{
  const HostPicture host(size_px, GL_RGBA8, 0);
  const Pixels before = host.pixels();
  draw(host, {0.4F, 0, 0, 0.5F}, {.color_load = LoadAction::Load}, State::WriteColor | State::BlendOver);
  const Pixels pixels = host.pixels();
  for (std::size_t c = 0; c < 4; c++) {
    const std::array<double, 4> drawn = {102, 0, 0, 127.5};
    EXPECT_NEAR(pixels.at(4, 3)[c], drawn[c] + 0.5 * before.at(4, 3)[c], 1);
  }
}

TEST_P(HostFramebufferTest, DepthIsTestedByTheHostsConvention)
{
  const HostPicture host(size_px, GL_RGBA8, 0);
  const Pixels before = host.pixels();
  const PassActions keep{.color_load = LoadAction::Load, .depth_load = LoadAction::Load};
  // The triangle's depth is 0.25.
  host.clear_depth(0.2F);
  draw(host, glm::vec4(1), keep, State::WriteColor | State::DepthLessEqual);
  EXPECT_EQ(host.pixels(), before);
  host.clear_depth(0.3F);
  draw(host, glm::vec4(1), keep, State::WriteColor | State::WriteDepth | State::DepthLessEqual);
  EXPECT_EQ(host.pixels().at(0, 0), (std::array<int, 4>{255, 255, 255, 255}));
  EXPECT_NEAR(host.depths()[0], 0.25F, 1e-7F);
  // Now equal, and then nearer.
  draw(host, glm::vec4(0), keep, State::WriteColor | State::DepthFurther);
  EXPECT_EQ(host.pixels().at(0, 0), (std::array<int, 4>{255, 255, 255, 255}));
  host.clear_depth(0.3F);
  draw(host, glm::vec4(0), keep, State::WriteColor | State::DepthFurther);
  EXPECT_EQ(host.pixels().at(0, 0), (std::array<int, 4>{0, 0, 0, 0}));
}

TEST_P(HostFramebufferTest, OtherDrawBuffersKeepTheirContent)
{
  const HostPicture host(size_px, GL_RGBA8, 0);
  const HostPicture other(size_px, GL_RGBA8, 0);
  const Pixels before = other.pixels();
  const GLuint name = host.framebuffer().name;
  glNamedFramebufferTexture(name, GL_COLOR_ATTACHMENT1, other.texture(), 0);
  const std::array<GLenum, 2> buffers = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glNamedFramebufferDrawBuffers(name, 2, buffers.data());
  draw(host, glm::vec4(1), {}, State::WriteColor);
  EXPECT_EQ(host.pixels().at(0, 0), (std::array<int, 4>{255, 255, 255, 255}));
  EXPECT_EQ(other.pixels(), before);
}

/** Mesa draws windows from the top. A program that has been drawn into one must know where it is in another target. */
TEST_P(HostFramebufferTest, PositionsOfFragmentsAreFromTheLowerLeftCorner)
{
  const HostPicture picture(size_px, GL_RGBA8, 0);
  const Texture texture = device->create_texture({.name = "own", .width = size_px.x, .height = size_px.y});
  const Framebuffer own = device->create_framebuffer({"own", {{&texture}}, {}});
  const bool has_window = GetParam() == test::HostKind::Glx;
  enum Target { Window, Theirs, Own };
  const std::vector<std::array<Target, 4>> orders =
      has_window ? std::vector<std::array<Target, 4>>{{Window, Theirs, Own, Window}, {Own, Window, Theirs, Own}}
                 : std::vector<std::array<Target, 4>>{{Theirs, Own, Theirs, Own}};
  for (const auto &order : orders) {
    // Each draws with a variant that Mesa makes for its first target.
    const Shader positions = make_shader(*device, "positions", test::CLIP_SPACE_VERT, R"(
PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  vec4 scale;
};
layout(location = 0) out vec4 result;
void main()
{
  result = scale * vec4(floor(gl_FragCoord.xy), 0.0, 1.0);
})");
    for (const Target target : order) {
      if (has_window) {
        glClear(GL_COLOR_BUFFER_BIT);
      }
      CommandList list;
      if (target == Own) {
        list.begin_pass("positions", own, {});
      }
      else {
        list.begin_pass("positions",
                        target == Window ? HostFramebuffer{.name = 0, .size_px = size_px} : picture.framebuffer(),
                        {.viewport = {{0, 0}, size_px}, .scissor = {{0, 0}, size_px}});
      }
      list.set_shader(positions.id());
      list.set_state(State::WriteColor);
      push_constants(list, positions, glm::vec4(1.0F / 255.0F));
      append_draw(list, full);
      list.end_pass();
      device->submit(list);
      Pixels pixels{size_px, std::vector<std::array<std::uint8_t, 4>>(std::size_t(size_px.x * size_px.y))};
      if (target == Window) {
        glReadPixels(0, 0, size_px.x, size_px.y, GL_RGBA, GL_UNSIGNED_BYTE, pixels.values.data());
      }
      else if (target == Theirs) {
        pixels = picture.pixels();
      }
      else {
        const std::vector<std::byte> bytes = device->read(texture);
        std::memcpy(pixels.values.data(), bytes.data(), bytes.size());
      }
      for (int y = 0; y < size_px.y; y++) {
        for (int x = 0; x < size_px.x; x++) {
          ASSERT_EQ(pixels.at(x, y)[0], x) << x << ", " << y << " of target " << int(target);
          ASSERT_EQ(pixels.at(x, y)[1], y) << x << ", " << y << " of target " << int(target);
        }
      }
    }
  }
}

TEST_P(HostFramebufferTest, TheHostsStateIsUnchanged)
{
  const HostPicture target(size_px, GL_SRGB8_ALPHA8, 4);
  const test::HostObjects objects;
  test::set_unusual_state(objects);
  const std::vector<test::StateItem> table = test::state_table();
  const test::StateSnapshot before(table);
  draw(target, glm::vec4(1), {.viewport = part, .scissor = part, .is_srgb_encoded = true},
       State::WriteColor | State::WriteDepth | State::BlendOver | State::DepthLessEqual);
  EXPECT_EQ(before.differences(), std::vector<std::string>());
}

#ifndef NDEBUG
TEST_P(HostFramebufferTest, WhatCannotBeDrawnIntoIsRefusedByName)
{
  const HostPicture host(size_px, GL_RGBA8, 0);
  const auto message_of = [&](const HostFramebuffer &framebuffer, const PassActions &actions) {
    CommandList list;
    list.begin_pass("host", framebuffer, actions);
    list.end_pass();
    return error_of([&] { device->submit(list); });
  };
  expect_contains(message_of({.name = 12345, .size_px = size_px}, {}),
                  "pass 'host': framebuffer 12345 of the host does not exist in the current context");
  GLuint empty = 0;
  glCreateFramebuffers(1, &empty);
  expect_contains(message_of({.name = empty, .size_px = size_px}, {}), "of the host is not complete");
  glDeleteFramebuffers(1, &empty);
  expect_contains(message_of(host.framebuffer(), {.is_srgb_encoded = true}), "has no attachment of an sRGB format");
  EXPECT_EQ(message_of(host.framebuffer(), {}), "");
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}
#endif

INSTANTIATE_TEST_SUITE_P(, HostFramebufferTest, testing::Values(test::HostKind::Egl, test::HostKind::Glx),
                         test::name_of_host);

}  // namespace
}  // namespace gnomon::gpu
