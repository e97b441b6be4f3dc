// SPDX-License-Identifier: MIT
#include "gpu/gpu_testing.hh"
#include "gpu_device_fixture.hh"

#include <algorithm>

namespace gnomon::gpu {
namespace {

using test::append_draw;
using test::make_shader;
using test::push_constants;

/** Draws full triangles into a small picture, one after another. */
class StateGpu : public test::GpuDeviceTest {
 protected:
  struct Draw {
    State state;
    /** Clip coordinate, w = 1. */
    float z = 0.5F;
    float value = 1;
    bool is_clockwise = false;
  };
  struct Pixel {
    float value;
    float depth;
    bool operator==(const Pixel &) const = default;
  };

  void SetUp() override
  {
    GpuDeviceTest::SetUp();
    if (!device) {
      return;
    }
    color = device->create_texture({.name = "color", .format = Format::RGBA32F, .width = 8, .height = 8});
    depth = device->create_texture({.name = "depth", .format = Format::Depth32F, .width = 8, .height = 8});
    framebuffer = device->create_framebuffer({"target", {{&color}}, {&depth}});
    shader = make_shader(*device, "color", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  }

  /** Value of every pixel after \a draws, from value -1 and depth \a clear_depth. */
  Pixel drawn(const std::vector<Draw> &draws, float clear_depth = 0)
  {
    CommandList list;
    list.begin_pass("draw", framebuffer, {.clear_color = glm::vec4(-1), .clear_depth = clear_depth});
    list.set_shader(shader.id());
    for (const Draw &draw : draws) {
      const std::array<glm::vec3, 3> positions = {glm::vec3(-1, -1, draw.z), glm::vec3(3, -1, draw.z),
                                                  glm::vec3(-1, 3, draw.z)};
      const std::array<std::uint32_t, 3> indices =
          draw.is_clockwise ? std::array<std::uint32_t, 3>{0, 2, 1} : std::array<std::uint32_t, 3>{0, 1, 2};
      batches.push_back(device->create_batch({"full", positions, {}, indices}));
      list.set_state(draw.state);
      push_constants(list, shader, glm::vec4(draw.value));
      append_draw(list, batches.back());
    }
    list.end_pass();
    device->submit(list);
    const std::vector<glm::vec4> colors = gpu::read_as<glm::vec4>(*device, color);
    const std::vector<float> depths = gpu::read_as<float>(*device, depth);
    EXPECT_EQ(std::ranges::count(colors, glm::vec4(colors[0].x)), 64) << "not all pixels alike";
    EXPECT_EQ(std::ranges::count(depths, depths[0]), 64) << "not all pixels alike";
    return {colors[0].x, depths[0]};
  }

  friend void PrintTo(const Pixel &pixel, std::ostream *stream)
  {
    *stream << "value " << pixel.value << ", depth " << pixel.depth;
  }

  static constexpr State BOTH = State::WriteColor | State::WriteDepth;
  static constexpr State NEARER = BOTH | State::DepthNearerEqual;

  Texture color;
  Texture depth;
  Framebuffer framebuffer;
  Shader shader;
  std::vector<Batch> batches;
};

TEST_F(StateGpu, DepthIsTheClipCoordinateItself)
{
  // Not (z + 1) / 2: the clip volume is [0, 1]. All are exact floats; the fourth has the full mantissa.
  for (const float z : {0.0F, 0.25F, 0.5F, 1.0F / 3.0F, 0.9990234375F, 1.0F}) {
    EXPECT_EQ(drawn({{.state = NEARER, .z = z}}), (Pixel{1, z}));
  }
}

TEST_F(StateGpu, DepthBiasOfAPassIsItsSlopeInPixelsAndItsConstantInDigits)
{
  // Rises by 1 / 32 from one pixel to the next, along x or y, up to 0.75, whose last digit is 2^-24.
  for (const int axis : {0, 1}) {
    std::array<glm::vec3, 3> positions = {glm::vec3(-1, -1, 0.25F), glm::vec3(3, -1, 0.25F), glm::vec3(-1, 3, 0.25F)};
    positions[std::size_t(axis) + 1].z = 0.75F;
    const std::array<std::uint32_t, 3> indices = {0, 1, 2};
    const Batch tilted = device->create_batch({"tilted", positions, {}, indices});
    const auto depths = [&](const DepthBias &bias) {
      CommandList list;
      list.begin_pass("draw", framebuffer, {.depth_bias = bias});
      list.set_shader(shader.id());
      list.set_state(NEARER);
      push_constants(list, shader, glm::vec4(1));
      append_draw(list, tilted);
      list.end_pass();
      device->submit(list);
      return gpu::read_as<float>(*device, depth);
    };
    const std::vector<float> unbiased = depths({});
    for (const DepthBias bias : {DepthBias{0, -2}, {-1024, 0}, {1024, 0.5F}}) {
      const std::vector<float> biased = depths(bias);
      const float expected = bias.slope / 32.0F + bias.constant * 0x1p-24F;
      for (std::size_t i = 0; i < unbiased.size(); i++) {
        // Both depths are rounded to 2^-24.
        ASSERT_NEAR(biased[i] - unbiased[i], expected, 0x1p-23F) << "texel " << i << ", axis " << axis;
      }
    }
    EXPECT_EQ(depths({}), unbiased) << "the bias of an earlier pass";
  }
}

TEST_F(StateGpu, NearerIsTheGreaterDepthInAnyOrder)
{
  const Draw near{.state = NEARER, .z = 0.75F, .value = 1};
  const Draw far{.state = NEARER, .z = 0.25F, .value = 2};
  EXPECT_EQ(drawn({near, far}), (Pixel{1, 0.75F}));
  EXPECT_EQ(drawn({far, near}), (Pixel{1, 0.75F}));
}

TEST_F(StateGpu, EqualDepthPasses)
{
  EXPECT_EQ(drawn({{.state = NEARER, .value = 1}, {.state = NEARER, .value = 2}}), (Pixel{2, 0.5F}));
  // A surface exactly on the far plane is as near as the cleared depth, and passes.
  EXPECT_EQ(drawn({{.state = NEARER, .z = 0, .value = 3}}), (Pixel{3, 0}));
}

TEST_F(StateGpu, ClearDepthOneIsNearestOfAll)
{
  EXPECT_EQ(drawn({{.state = NEARER, .z = 0.999F}}, 1), (Pixel{-1, 1}));
}

TEST_F(StateGpu, DepthEqualPassesNothingElse)
{
  const State equal = State::WriteColor | State::DepthEqual;
  EXPECT_EQ(drawn({{.state = equal, .z = 0.5F}}, 0.5F), (Pixel{1, 0.5F}));
  EXPECT_EQ(drawn({{.state = equal, .z = 0.500001F}}, 0.5F), (Pixel{-1, 0.5F}));
  EXPECT_EQ(drawn({{.state = equal, .z = 0.499999F}}, 0.5F), (Pixel{-1, 0.5F}));
}

TEST_F(StateGpu, WithoutATestTheLastWins)
{
  EXPECT_EQ(drawn({{.state = BOTH, .z = 0.75F, .value = 1}, {.state = BOTH, .z = 0.25F, .value = 2}}),
            (Pixel{2, 0.25F}));
}

TEST_F(StateGpu, OnlyWhatIsNamedIsWritten)
{
  EXPECT_EQ(drawn({{.state = State::WriteColor}}), (Pixel{1, 0}));
  EXPECT_EQ(drawn({{.state = State::WriteDepth}}), (Pixel{-1, 0.5F}));
  EXPECT_EQ(drawn({{.state = State::None}}), (Pixel{-1, 0}));
  EXPECT_EQ(drawn({{.state = State::WriteColor | State::DepthNearerEqual}}), (Pixel{1, 0}));
  EXPECT_EQ(drawn({{.state = State::WriteDepth | State::DepthNearerEqual}}), (Pixel{-1, 0.5F}));
}

TEST_F(StateGpu, OfADrawDoesNotReachTheNext)
{
  const State everything = State((1U << 9) - 1);
  EXPECT_EQ(drawn({{.state = everything, .z = 0.9F, .is_clockwise = true}, {.state = BOTH, .z = 0.25F, .value = 2}}),
            (Pixel{2, 0.25F}));
}

TEST_F(StateGpu, BeforeNearAndBehindFarIsCutOffUnlessClamped)
{
  for (const float z : {-0.25F, 1.25F}) {
    EXPECT_EQ(drawn({{.state = NEARER, .z = z}}), (Pixel{-1, 0}));
    EXPECT_EQ(drawn({{.state = NEARER | State::DepthClamp, .z = z}}), (Pixel{1, std::clamp(z, 0.0F, 1.0F)}));
  }
}

TEST_F(StateGpu, CullingFollowsTheWindingAndTheFront)
{
  struct Case {
    State state;
    bool is_ccw_drawn;
    bool is_cw_drawn;
  };
  for (const Case &one :
       {Case{State::None, true, true}, Case{State::CullBack, true, false}, Case{State::CullFront, false, true},
        Case{State::FrontClockwise, true, true}, Case{State::CullBack | State::FrontClockwise, false, true},
        Case{State::CullFront | State::FrontClockwise, true, false}}) {
    SCOPED_TRACE(to_string(one.state));
    const State state = State::WriteColor | one.state;
    EXPECT_EQ(drawn({{.state = state, .is_clockwise = false}}).value, one.is_ccw_drawn ? 1 : -1);
    EXPECT_EQ(drawn({{.state = state, .is_clockwise = true}}).value, one.is_cw_drawn ? 1 : -1);
  }
}

TEST_F(StateGpu, BlendAddSums)
{
  const State add = State::WriteColor | State::BlendAdd;
  EXPECT_EQ(drawn({{.state = add, .value = 2}, {.state = add, .value = 0.25F}, {.state = add, .value = -8}}),
            (Pixel{-1 + 2 + 0.25F - 8, 0}));
}

TEST_F(StateGpu, BlendMultiplyScales)
{
  const State multiply = State::WriteColor | State::BlendMultiply;
  EXPECT_EQ(drawn({{.state = multiply, .value = 0.25F}, {.state = multiply, .value = 3}}), (Pixel{-0.75F, 0}));
}

}  // namespace
}  // namespace gnomon::gpu
