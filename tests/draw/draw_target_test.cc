// SPDX-License-Identifier: MIT
#include "draw_target.hh"
#include "draw_view.hh"

#include "gpu/gpu_testing.hh"

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <limits>

namespace gnomon::draw {
namespace {

using test::error_of;
using test::expect_contains;

constexpr double near = 0.1;
constexpr double far = 500.0;

/** Infinite, near at 1 and far at 0. */
glm::dmat4 reversed_infinite()
{
  glm::dmat4 clip(0.0);
  clip[0][0] = clip[1][1] = 1.0;
  clip[2][3] = -1.0;
  clip[3][2] = near;
  return clip;
}

struct Convention {
  const char *name;
  HostDepth depth;
  bool is_near_smaller;
  double background;
};

std::vector<Convention> conventions()
{
  return {
      {"OpenGL", {glm::perspectiveRH_NO(0.8, 1.5, near, far), false, {0, 1}}, true, 1.0},
      {"OpenGL, swapped range", {glm::perspectiveRH_NO(0.8, 1.5, near, far), false, {1, 0}}, false, 0.0},
      {"OpenGL, part of the range", {glm::perspectiveRH_NO(0.8, 1.5, near, far), false, {0.25, 0.5}}, true, 0.5},
      {"Vulkan", {glm::perspectiveRH_ZO(0.8, 1.5, near, far), true, {0, 1}}, true, 1.0},
      {"reversed, infinite", {reversed_infinite(), true, {0, 1}}, false, 0.0},
      {"parallel", {glm::orthoRH_NO(-1.0, 1.0, -1.0, 1.0, near, far), false, {0, 1}}, true, 1.0},
  };
}

double stored(const HostDepth &host, double view_z)
{
  const glm::dvec4 clip = host.clip_from_view * glm::dvec4(0, 0, view_z, 1);
  const double ndc = clip.z / clip.w;
  return glm::mix(host.range.x, host.range.y, host.is_zero_to_one ? ndc : 0.5 * ndc + 0.5);
}

TEST(DepthMap, GivesTheDepthThatTheHostsProjectionGives)
{
  const std::array<glm::mat4, 3> ours = {perspective(1, 0.5F, 0.05F, 1000.0F),
                                         perspective(1, 0.5F, 0.05F, std::numeric_limits<float>::infinity()),
                                         orthographic(4, 3, 0.05F, 1000.0F)};
  for (const Convention &convention : conventions()) {
    for (const glm::mat4 &clip_from_view : ours) {
      const DepthMap map = depth_map(clip_from_view, convention.depth);
      EXPECT_EQ(map.is_near_smaller, convention.is_near_smaller) << convention.name;
      EXPECT_EQ(double(map.background), convention.background) << convention.name;
      for (double distance = near; distance < far; distance *= 1.1) {
        const glm::dvec4 clip = glm::dmat4(clip_from_view) * glm::dvec4(0, 0, -distance, 1);
        const double depth = clip.z / clip.w;
        const glm::dvec4 scale(map.scale);
        // The scale is rounded to float. For a parallel view, the terms of the fraction have the magnitude of its range
        // of 1000 m and are divided by the distance.
        const double rounding = clip_from_view[3][3] == 1.0F ? 1000.0 * 0x1p-23 : 0.0;
        const double tolerance = 1e-6 + rounding / distance;
        EXPECT_NEAR((scale.x * depth + scale.y) / (scale.z * depth + scale.w), stored(convention.depth, -distance),
                    tolerance)
            << convention.name << " at " << distance;
      }
    }
  }
}

TEST(Target, APictureThatDoesNotFitIsRefused)
{
  const auto device = gpu::create_null_device();
  const TargetTexture texture(*device, "texture", gpu::Format::RGBA8, {20, 10});
  for (const Target &whole : {texture.target(), Target{.framebuffer = gpu::HostFramebuffer{1, {20, 10}}}}) {
    const auto message_at = [&](glm::ivec2 origin_px, glm::ivec2 size_px) {
      Target target = whole;
      target.origin_px = origin_px;
      return error_of([&] { check(target, size_px); });
    };
    EXPECT_EQ(message_at({0, 0}, {20, 10}), "");
    EXPECT_EQ(message_at({12, 6}, {8, 4}), "");
    expect_contains(message_at({13, 6}, {8, 4}), "a picture of 8x4 px at 13,6 does not fit into its 20x10 px");
    expect_contains(message_at({12, 7}, {8, 4}), "does not fit");
    expect_contains(message_at({-1, 0}, {8, 4}), "does not fit");
    expect_contains(message_at({0, -1}, {8, 4}), "does not fit");
    expect_contains(message_at({std::numeric_limits<int>::max(), 0}, {8, 4}), "does not fit");
  }
  EXPECT_EQ(error_of([] { check({}, {8, 4}); }), "") << "none takes any picture";
}

TEST(Target, ValuesWithoutMeaningAreRefused)
{
  const Target good{.framebuffer = gpu::HostFramebuffer{0, {8, 4}}, .depth = conventions().front().depth};
  const auto message_of = [&](const auto &change) {
    Target target = good;
    change(target);
    return error_of([&] { check(target, {8, 4}); });
  };
  EXPECT_EQ(message_of([](Target &) {}), "");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float exposure : {121.0F, -121.0F, nan}) {
    expect_contains(message_of([&](Target &target) { target.exposure = exposure; }), "exposure");
  }
  for (const glm::dvec2 range : {glm::dvec2(0, 2), glm::dvec2(-1, 1), glm::dvec2(0.5, 0.5), glm::dvec2(0, nan)}) {
    expect_contains(message_of([&](Target &target) { target.depth->range = range; }), "depth range");
  }
  for (const glm::dmat4 &clip : {glm::dmat4(0.0), glm::dmat4(nan)}) {
    expect_contains(message_of([&](Target &target) { target.depth->clip_from_view = clip; }), "host's projection");
  }
}

TEST(Target, ItsPassIsLimitedToTheRectangle)
{
  const auto device = gpu::create_null_device();
  const Target target{.framebuffer = gpu::HostFramebuffer{3, {64, 48}}, .origin_px = {5, 6}};
  const auto text_of = [&](Encoding encoding, ViewTransform transform) {
    Target encoded = target;
    encoded.encoding = encoding;
    encoded.view_transform = transform;
    gpu::CommandList list;
    begin_pass(list, "tonemap", encoded, {8, 4}, {{0, 0}, {8, 4}}, {});
    list.end_pass();
    return list.serialize(*device);
  };
  const std::string display = text_of(Encoding::Display, ViewTransform::Standard);
  expect_contains(display, "tonemap -> host framebuffer");
  expect_contains(display, " viewport 8x4 at 5,6 scissor 8x4 at 5,6\n");
  expect_contains(text_of(Encoding::SrgbFormat, ViewTransform::Standard), " srgb\n");
  EXPECT_EQ(text_of(Encoding::SrgbFormat, ViewTransform::Raw), display) << "raw values are stored as they are";
  EXPECT_EQ(text_of(Encoding::SceneLinear, ViewTransform::Standard), display);
}

}  // namespace
}  // namespace gnomon::draw
