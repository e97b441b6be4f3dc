// SPDX-License-Identifier: MIT
#include "eevee_esm_scene.hh"
#include "gpu_device_fixture.hh"

#include <algorithm>
#include <numbers>

namespace gnomon::eevee {
namespace {

using test::CubeDepths;
using test::EsmStage;
using test::Receiver;

class OctahedralGpu : public test::GpuDeviceTest {};

glm::dvec3 texel_direction(glm::ivec2 texel, int size)
{
  const glm::dvec2 p = (glm::dvec2(shared::octahedral_texel(texel, size)) + 0.5) / double(size) * 2.0 - 1.0;
  const double fold = std::max(std::abs(p.x) + std::abs(p.y) - 1.0, 0.0);
  return glm::normalize(glm::dvec3(p.x + (p.x >= 0.0 ? -fold : fold), p.y + (p.y >= 0.0 ? -fold : fold),
                                   1.0 - std::abs(p.x) - std::abs(p.y)));
}

double log_mean(const std::vector<double> &values, const std::vector<double> &weights, double exponent)
{
  const double highest = *std::ranges::max_element(values);
  double sum = 0.0;
  double weight_sum = 0.0;
  for (std::size_t i = 0; i < values.size(); i++) {
    sum += weights[i] * std::exp(exponent * (values[i] - highest));
    weight_sum += weights[i];
  }
  return highest + std::log(sum / weight_sum) / exponent;
}

/** Depths without any order: a distance a texel, evenly spread over [\a low, \a high]. */
CubeDepths noise(int size_px, float near, double low, double high)
{
  std::mt19937 random(5);
  return test::cube_depths(size_px, near, [&](const glm::dvec3 &) {
    return low + (high - low) * double(random()) / double(std::mt19937::max());
  });
}

constexpr std::array<EsmKernel, 3> kernels = {EsmKernel::Disk4, EsmKernel::Disk32, EsmKernel::Separable};

/** design.md: exact to 1e-4 m at 1 km. Where exponents are small, roundings of the sum weigh more, and visibilities
 * change by 2e-6. */
double prefilter_tolerance(float exponent)
{
  return exponent < 0.1F ? 2e-4 : 1e-4;
}

TEST_F(OctahedralGpu, DiskPrefilterIsExactToATenthOfAMillimetreAtAKilometre)
{
  constexpr int size = 32;
  std::array<double, 2> worst{};
  for (const double low : {1.0, 880.0, 911.0, 999.0}) {
    const CubeDepths cube = noise(25, 0.5F, low, 999.9);
    for (const EsmKernel kernel : {EsmKernel::Disk4, EsmKernel::Disk32}) {
      for (const float exponent : {0.01F, 0.1F, 1.0F, 80.0F, 1e4F}) {
        const EsmLamp lamp{"lamp",
                           1000.0F,
                           {.exponent = exponent,
                            .filter_angle = 0.1F,
                            .size_px = size,
                            .format = EsmFormat::Float,
                            .kernel = kernel}};
        EsmStage stage(*device, {{lamp}});
        stage.upload(cube);
        stage.record(0, cube);
        const int count = kernel == EsmKernel::Disk4 ? 4 : 32;
        const std::vector<float> taps = stage.tap_distances(0, cube, count);
        const std::vector<float> layer = stage.layer(0);
        for (int y = 0; y < size; y++) {
          for (int x = 0; x < size; x++) {
            const float *first = &taps[(std::size_t(y) * size + std::size_t(x)) * std::size_t(count)];
            const std::vector<double> values(first, first + count);
            const double expected = log_mean(values, std::vector<double>(values.size(), 1.0), exponent);
            const double found = layer[std::size_t(y + 1) * (size + 2) + std::size_t(x + 1)];
            ASSERT_NEAR(found, expected, prefilter_tolerance(exponent))
                << x << " " << y << ", " << count << " taps, " << exponent << "/m, from " << low;
            worst[exponent < 0.1F] = std::max(worst[exponent < 0.1F], std::abs(found - expected));
          }
        }
      }
    }
  }
  fmt::print("disk prefilter: worst error {:.3g} m at 1 km, {:.3g} m at 0.01/m\n", worst[0], worst[1]);
}

TEST_F(OctahedralGpu, SeparablePrefilterIsExactToATenthOfAMillimetreAtAKilometre)
{
  constexpr int size = 32;
  constexpr float angle = 0.2F;
  std::array<double, 2> worst{};
  for (const double low : {1.0, 880.0, 999.0}) {
    const CubeDepths cube = noise(25, 0.5F, low, 999.9);
    for (const float exponent : {0.01F, 0.1F, 1.0F, 80.0F, 1e4F}) {
      const EsmLamp lamp{"lamp",
                         1000.0F,
                         {.exponent = exponent,
                          .filter_angle = angle,
                          .size_px = size,
                          .format = EsmFormat::Float,
                          .kernel = EsmKernel::Separable}};
      EsmStage stage(*device, {{lamp}});
      stage.upload(cube);
      stage.record(0, cube);
      const std::vector<float> layer = stage.layer(0);
      // What a cone of no opening sees is what the filter began with.
      EsmLamp unfiltered = lamp;
      unfiltered.settings.filter_angle = 0.0F;
      unfiltered.settings.kernel = EsmKernel::Disk4;
      stage.sync({{unfiltered}});
      stage.record(0, cube);
      const std::vector<float> source = stage.layer(0);
      std::vector<double> rows;
      for (int i = 0; i < size * size; i++) {
        rows.push_back(source[std::size_t(i / size + 1) * (size + 2) + std::size_t(i % size + 1)]);
      }
      for (int axis = 0; axis < 2; axis++) {
        const std::vector<double> from = rows;
        for (int i = 0; i < size * size; i++) {
          const glm::ivec2 texel(i % size, i / size);
          const auto weight_of = [](const glm::dvec3 &d) {
            return std::pow(std::abs(d.x) + std::abs(d.y) + std::abs(d.z), 3.0);
          };
          const double deviation = 0.5 * angle / (2.0 / size * std::sqrt(weight_of(texel_direction(texel, size))));
          const int reach = int(std::ceil(3.0 * deviation));
          std::vector<double> values;
          std::vector<double> weights;
          for (int k = -reach; k <= reach; k++) {
            const glm::ivec2 at =
                shared::octahedral_texel(axis == 0 ? texel + glm::ivec2(k, 0) : texel + glm::ivec2(0, k), size);
            const auto index = std::size_t(at.y) * size + std::size_t(at.x);
            values.push_back(from[index]);
            weights.push_back(std::exp(-0.5 * k * k / deviation / deviation) * weight_of(texel_direction(at, size)));
          }
          rows[std::size_t(i)] = log_mean(values, weights, exponent);
        }
      }
      for (int i = 0; i < size * size; i++) {
        const double found = layer[std::size_t(i / size + 1) * (size + 2) + std::size_t(i % size + 1)];
        ASSERT_NEAR(found, rows[std::size_t(i)], prefilter_tolerance(exponent))
            << i << ", " << exponent << "/m, from " << low;
        worst[exponent < 0.1F] = std::max(worst[exponent < 0.1F], std::abs(found - rows[std::size_t(i)]));
      }
    }
  }
  fmt::print("separable prefilter: worst error {:.3g} m at 1 km, {:.3g} m at 0.01/m\n", worst[0], worst[1]);
}

}  // namespace
}  // namespace gnomon::eevee
