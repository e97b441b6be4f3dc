// SPDX-License-Identifier: MIT
#include "draw_view_shared.h"
#include "gpu/gpu_testing.hh"
#include "gpu_device_fixture.hh"
#include "shared_functions.hh"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gnomon::test {
namespace {

using verify::Arguments;
using verify::CompiledFunction;
using verify::Deviation;
using verify::Sweep;
using verify::sweeps;

/** Evaluates a function on the device, with one pixel for each argument of a sweep. */
class SharedFunctionGpu : public SharedDeviceTest, public testing::WithParamInterface<std::size_t> {
 protected:
  static constexpr int width_px = 256;

  static const Sweep &sweep()
  {
    return sweeps()[GetParam()];
  }

  /** Results of \a expression on the device. It may use the vectors a, b and c. */
  std::vector<glm::dvec4> results(std::string_view expression) const
  {
    const auto count = sweep().arguments.size();
    const int height = int((count + width_px - 1) / width_px);
    const ShaderTexts texts{{{"frag", fragment_text(expression)}}};
    const gpu::Shader shader =
        device->create_shader({std::string(sweep().name), "draw/draw_fullscreen_vert.glsl", "", "frag", {}},
                              texts.files(), shader_check::reflect);

    std::vector<Arguments<float>> arguments = sweep().arguments;
    arguments.resize(std::size_t(width_px) * std::size_t(height));
    const auto bytes = std::as_bytes(std::span(arguments));
    const gpu::Buffer buffer = device->create_buffer({"argument_block", gpu::BufferKind::Storage, bytes.size()});
    device->update(buffer, 0, bytes);

    const gpu::Texture picture = device->create_texture(
        {.name = "results", .format = gpu::Format::RGBA32F, .width = width_px, .height = height});
    const gpu::Framebuffer framebuffer = device->create_framebuffer({"results", {{&picture}}, {}});
    gpu::CommandList list;
    list.begin_pass("evaluate", framebuffer, {});
    list.set_shader(shader.id());
    list.set_state(gpu::State::WriteColor);
    list.bind_storage(shader.interface().find(gpu::BindingKind::StorageBlock, "argument_block")->slot, {buffer.id()});
    list.draw_procedural(3, 1);
    list.end_pass();
    device->submit(list);
    std::vector<glm::dvec4> values;
    for (const glm::vec4 &texel : gpu::read_as<glm::vec4>(*device, picture)) {
      values.emplace_back(texel);
    }
    values.resize(count);
    return values;
  }

 private:
  static std::string fragment_text(std::string_view expression)
  {
    std::string text = "#version 450 core\n";
    for (const std::string_view path : shaders::paths()) {
      if (path.starts_with("shared/draw_") || path.starts_with("shared/eevee_")) {
        text += fmt::format("#include \"{}\"\n", path);
      }
    }
    return text + fmt::format(R"(
#include "shared/slots_shared.h"
layout(std140, binding = OBJECT_BLOCK_SLOT) readonly buffer argument_block
{{
  vec4 values[];
}};
layout(location = 0) out vec4 result;
void main()
{{
  int first = 3 * (int(gl_FragCoord.y) * {} + int(gl_FragCoord.x));
  vec4 a = values[first];
  vec4 b = values[first + 1];
  vec4 c = values[first + 2];
  result = {};
}}
)",
                              width_px, expression);
  }
};

TEST_P(SharedFunctionGpu, EqualsItsClosedForm)
{
  const auto functions = verify::functions_in_float();
  const auto function = std::ranges::find(functions, sweep().name, &CompiledFunction<float>::name);
  ASSERT_NE(function, functions.end());
  const std::vector<glm::dvec4> values = results(function->expression);
  const Deviation worst = deviation(sweep(), values);
  RecordProperty("epsilons", fmt::format("{:.3g}", worst.epsilons));
  // Vulkan lets sines be off by 2^-11, and SwiftShader's are off by 1.9e-4.
  const bool has_coarse_sine = testing_backend() == "swiftshader" && sweep().name == "esm_disk_point";
  const double bound = has_coarse_sine ? 0x1p-11 / 0x1p-23 : sweep().driver_epsilons;
  EXPECT_LE(worst.epsilons, bound) << worst.where;

  // The C++ result has a bound too, so the difference is at most the sum of both. It is recorded for information.
  double difference = 0.0;
  for (std::size_t i = 0; i < values.size(); i++) {
    const Arguments<float> &in = sweep().arguments[i];
    const glm::dvec4 distance = glm::abs(values[i] - glm::dvec4(function->call(in)));
    const glm::dvec4 magnitude = sweep().magnitude(in_double(in));
    for (int k = 0; k < 4; k++) {
      difference = std::max(difference, distance[k] == 0.0 ? 0.0 : distance[k] / magnitude[k] / 0x1p-23);
    }
  }
  RecordProperty("epsilons_from_cpp", fmt::format("{:.3g}", difference));
}

class CoarseGridGpu : public SharedDeviceTest {};

/**
 * An orthographic view along -z, with pixels of 1 m, of a plane whose depth is 50 x. Interpolation has the place of a
 * pixel to the right of its centre.
 */
TEST_F(CoarseGridGpu, DepthsAreOnThePlaneAndNeverMoreThanTwoPixelsFromTheSurface)
{
  constexpr int size_px = 8;
  const ShaderTexts texts{{{"frag", R"(#version 450 core
#define HAS_COARSE_GRID
#include "eevee/eevee_gbuffer_lib.glsl"
layout(location = 0) out vec4 result;
float depth_at(float right, vec3 normal)
{
  float x = gl_FragCoord.x - 4.0 + right;
  return gbuffer_depth_on_plane(vec3(x, gl_FragCoord.y - 4.0, -50.0 * x), normalize(normal));
}
void main()
{
  vec3 normal = vec3(50.0, 0.0, 1.0);
  float expected = 50.0 * (gl_FragCoord.x - 4.0);
  // A normal that is almost perpendicular to the ray puts the plane 10 km away.
  result = vec4(depth_at(0.03, normal) - expected, depth_at(1.4, normal) - expected, depth_at(1.0, vec3(1.0, 0.0, 1e-4)) - expected, 1);
})"}}};
  const gpu::Shader shader = device->create_shader({"coarse grid", "draw/draw_fullscreen_vert.glsl", "", "frag", {}},
                                                   texts.files(), shader_check::reflect);
  shared::ViewData view{};
  view.back_ws = {0, 0, 1};
  view.place_right = {size_px / 2, 0, 0, 2.0F / size_px};
  view.place_up = {0, size_px / 2, 0, 2.0F / size_px};
  const gpu::Buffer block = device->create_buffer({"view_block", gpu::BufferKind::Uniform, sizeof(view)});
  device->update(block, view);
  const gpu::Texture picture =
      device->create_texture({.name = "results", .format = gpu::Format::RGBA32F, .width = size_px, .height = size_px});
  const gpu::Framebuffer framebuffer = device->create_framebuffer({"results", {{&picture}}, {}});
  gpu::CommandList list;
  list.begin_pass("evaluate", framebuffer, {});
  list.set_shader(shader.id());
  list.set_state(gpu::State::WriteColor);
  list.bind_uniform(shader.interface().find(gpu::BindingKind::UniformBlock, "view_block")->slot,
                    {.buffer = block.id()});
  list.draw_procedural(3, 1);
  list.end_pass();
  device->submit(list);
  for (const glm::vec4 &texel : gpu::read_as<glm::vec4>(*device, picture)) {
    EXPECT_NEAR(texel.x, 0.0F, 1e-3F);
    EXPECT_NEAR(texel.y, 0.0F, 1e-3F);
    // The place is one pixel to the right, and the bound is twice the change of the depth from pixel to pixel.
    EXPECT_NEAR(texel.z, 50.0F - 2.0F * 50.0F, 1e-3F);
  }
}

INSTANTIATE_TEST_SUITE_P(Each, SharedFunctionGpu, testing::Range(std::size_t(0), sweeps().size()),
                         [](const auto &test) { return std::string(sweeps()[test.param].name); });

}  // namespace
}  // namespace gnomon::test
