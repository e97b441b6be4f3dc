// SPDX-License-Identifier: MIT
#include "eevee_esm_scene.hh"
#include "eevee_esm_shared.h"
#include "gpu_device_fixture.hh"

#include <algorithm>
#include <numbers>

namespace gnomon::eevee {
namespace {

using test::CubeDepths;
using test::EsmStage;
using test::Receiver;

class OctahedralGpu : public test::SharedDeviceTest {};

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

/** Random depths: one distance for each texel, evenly distributed over [\a low, \a high]. */
CubeDepths noise(int size_px, float near, double low, double high)
{
  std::mt19937 random(5);
  return test::cube_depths(size_px, near, [&](const glm::dvec3 &) {
    return low + (high - low) * double(random()) / double(std::mt19937::max());
  });
}

constexpr std::array<EsmKernel, 3> kernels = {EsmKernel::Disk4, EsmKernel::Disk32, EsmKernel::Separable};

/**
 * design.md: exact to 1e-4 m at 1 km. For small exponents the rounding of the sum has a larger effect, and visibilities
 * change by 2e-6.
 */
double prefilter_tolerance(float exponent)
{
  return exponent < 0.1F ? 2e-4 : 1e-4;
}

TEST_F(OctahedralGpu, DiskPrefilterIsExactToATenthOfAMillimetreAtAKilometre)
{
  constexpr int size = 32;
  std::array<double, 2> worst{};
  for (const double low : {1.0, 911.0, 999.0}) {
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
      // A cone without opening gives the input of the filter.
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

/** The same texels by one kernel of EsmMethod::Evsm, one of no opening, and the mean of exp(c·z) and its square in
 * double. */
TEST_F(OctahedralGpu, VarianceIsExactAtAnySpread)
{
  constexpr int size = 32;
  double worst = 0.0;
  for (const double low : {1.0, 911.0, 999.0}) {
    const CubeDepths cube = noise(25, 0.5F, low, 999.9);
    for (const int count : {4, 32}) {
      for (const float exponent : {0.01F, 0.1F, 1.0F, 80.0F, 1e4F}) {
        EsmStage stage(*device, {{EsmLamp{"lamp",
                                          1000.0F,
                                          {.method = EsmMethod::Evsm,
                                           .exponent = exponent,
                                           .filter_angle = 0.1F,
                                           .size_px = size,
                                           .kernel = count == 4 ? EsmKernel::Disk4 : EsmKernel::Disk32}}}});
        stage.upload(cube);
        stage.record(0, cube);
        const std::vector<float> taps = stage.tap_distances(0, cube, count);
        const std::vector<glm::vec4> layer = test::decoded_texels(*device, stage.store.texture(0), 0);
        for (int i = 0; i < size * size; i++) {
          const float *first = &taps[std::size_t(i) * std::size_t(count)];
          const std::vector<double> values(first, first + count);
          const std::vector<double> weights(values.size(), 1.0);
          const double mean = log_mean(values, weights, exponent);
          double variance = 0.0;
          for (const double value : values) {
            variance += std::pow(std::exp(exponent * (value - mean)) - 1.0, 2.0) / count;
          }
          const glm::vec4 &found = layer[std::size_t(i / size + 1) * (size + 2) + std::size_t(i % size + 1)];
          ASSERT_NEAR(found.x, mean, prefilter_tolerance(exponent)) << i;
          // Differences of taps are exact. The product with the exponent and exp() have rounding errors of 1e-7 of up
          // to c·z, where it matters.
          ASSERT_NEAR(found.y, variance, 1e-5 * (1.0 + variance)) << i << ", " << exponent << "/m, from " << low;
          worst = std::max(worst, std::abs(found.y - variance) / (1.0 + variance));
        }
      }
    }
  }
  fmt::print("relative variance: worst error {:.3g} of 1 + variance\n", worst);
}

TEST_F(OctahedralGpu, SeparableVarianceMatchesTwoDistances)
{
  // Half of the directions have one distance, half another. If the filter contains both, mean and variance belong to
  // the same fraction.
  constexpr double near = 3.0;
  constexpr double far = 4.0;
  const CubeDepths cube = test::cube_depths(64, 0.5F, [&](const glm::dvec3 &d) { return d.x > 0.1 ? near : far; });
  constexpr float exponent = 2.0F;
  EsmStage stage(*device, {{EsmLamp{"lamp",
                                    10.0F,
                                    {.method = EsmMethod::Evsm,
                                     .exponent = exponent,
                                     .filter_angle = 0.3F,
                                     .size_px = 32,
                                     .kernel = EsmKernel::Separable}}}});
  stage.upload(cube);
  stage.record(0, cube);
  int mixed = 0;
  for (const glm::vec4 &texel : test::decoded_texels(*device, stage.store.texture(0), 0)) {
    const double ratio = std::exp(exponent * (far - near));
    const double mean = std::exp(exponent * (double(texel.x) - near));
    const double share = std::clamp((mean - 1.0) / (ratio - 1.0), 0.0, 1.0);
    const double variance = (1.0 - share + share * ratio * ratio) / (mean * mean) - 1.0;
    ASSERT_NEAR(texel.y, variance, 1e-4);
    mixed += share > 0.1 && share < 0.9 ? 1 : 0;
  }
  EXPECT_GT(mixed, 100);
}

TEST_F(OctahedralGpu, UnfilteredLayerHoldsTheDistanceOfItsTexelsDirection)
{
  constexpr int size = 48;
  for (const float uv_scale : {1.0F, 0.9F}) {
    const auto scene = [](const glm::dvec3 &d) { return test::room_distance(d, {-4, -3, -5}, {5, 2.5, 4}); };
    const CubeDepths cube = test::cube_depths(96, 0.5F, scene, uv_scale);
    EsmStage stage(*device,
                   {{EsmLamp{"lamp", 20.0F, {.filter_angle = 0.0F, .size_px = size, .format = EsmFormat::Float}}}});
    stage.upload(cube);
    stage.record(0, cube);
    const std::vector<float> layer = stage.layer(0);
    for (int y = -1; y <= size; y++) {
      for (int x = -1; x <= size; x++) {
        const glm::dvec3 direction = texel_direction({x, y}, size);
        const double distance = scene(direction);
        // The cube's texel is up to half a diagonal away; a wall's distance changes by 1 / cos there.
        double low = distance;
        double high = distance;
        const glm::dvec3 other = std::abs(direction.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
        const glm::dvec3 across = glm::normalize(glm::cross(direction, other));
        for (int i = 0; i < 128; i++) {
          const double turn = i * std::numbers::pi / 64;
          const glm::dvec3 aside = std::cos(turn) * across + std::sin(turn) * glm::cross(direction, across);
          const double near_by =
              scene(glm::normalize(direction + aside * (1.05 * std::numbers::sqrt2 / 96 / uv_scale)));
          low = std::min(low, near_by);
          high = std::max(high, near_by);
        }
        const double found = layer[std::size_t(y + 1) * (size + 2) + std::size_t(x + 1)];
        ASSERT_GE(found, low - 1e-5) << x << " " << y;
        ASSERT_LE(found, high + 1e-5) << x << " " << y;
      }
    }
  }
}

TEST_F(OctahedralGpu, UnfilteredDistanceEqualsThatOfTheCubeWithinRounding)
{
  const CubeDepths cube = noise(33, 0.5F, 1.0, 1e3);
  EsmStage stage(*device, {{EsmLamp{"lamp", 2e3F, {.filter_angle = 0.0F, .size_px = 32, .format = EsmFormat::Float}}}});
  stage.upload(cube);
  stage.record(0, cube);
  const std::vector<float> layer = stage.layer(0);
  int differ = 0;
  for (int i = 0; i < 32 * 32; i++) {
    const double expected = cube.distance(texel_direction({i % 32, i / 32}, 32), 2e3);
    const double found = layer[std::size_t(i / 32 + 1) * 34 + std::size_t(i % 32 + 1)];
    // Four roundings: of a quotient, a root and products.
    differ += std::abs(found - expected) > 2.4e-7 * expected ? 1 : 0;
  }
  // A direction on the border of two texels or faces may use either, mostly on the diagonals of the map.
  EXPECT_LE(differ, 4 * 32);
}

// hazards.md: the second lamp's layers must not be the first's; a cube that was not drawn is far, not at the lamp.
TEST_F(OctahedralGpu, LampsHaveTheirOwnCubesSizesAndFormats)
{
  const auto lamp = [](const char *name, float range, int size, EsmFormat format, EsmKernel kernel) {
    return EsmLamp{name, range, {.size_px = size, .format = format, .kernel = kernel}};
  };
  const std::vector<EsmLamp> lamps = {lamp("a", 16, 32, EsmFormat::Float, EsmKernel::Disk32),
                                      lamp("b", 32, 16, EsmFormat::Half, EsmKernel::Disk4),
                                      lamp("c", 64, 24, EsmFormat::Float, EsmKernel::Separable),
                                      lamp("d", 128, 32, EsmFormat::Half, EsmKernel::Separable)};
  EsmStage stage(*device, lamps);
  std::array<CubeDepths, 2> cubes;
  for (int i = 0; i < 2; i++) {
    cubes[std::size_t(i)] = test::cube_depths(16, 0.5F, [&](const glm::dvec3 &) { return 4.0 + 4.0 * i; });
    stage.upload(cubes[std::size_t(i)], i);
  }
  for (std::size_t i = 0; i < lamps.size(); i++) {
    stage.record(i, cubes[i % 2], int(i % 2));
  }
  for (std::size_t i = 0; i < lamps.size(); i++) {
    for (const float value : stage.layer(i)) {
      ASSERT_NEAR(value, i % 2 == 0 ? 4.0F : 8.0F,
                  1e-5F + shared::esm_format_error(lamps[i].range, stage.store.data(i).format))
          << lamps[i].name;
    }
  }
  // hazards.md: the layer is cleared to far, which is visible beside a smaller map. Its encoding is 1.
  EXPECT_EQ(test::decoded_texels(*device, stage.store.texture(1), stage.store.data(1).layer).back().x, 1.0F);
  // Faces that were not drawn: +X alone, then none.
  for (std::size_t i = 0; i < lamps.size(); i++) {
    stage.record(i, cubes[0], 0, i == 0 ? 1U : 0U);
    for (const float value : stage.layer(i)) {
      ASSERT_TRUE(i == 0 ? value >= 3.99F && value <= 16.0F : value == lamps[i].range) << lamps[i].name << " " << value;
    }
  }
  const std::vector<Receiver> receivers = {{{8, 0, 0}, {1, 0, 0}}, {{-8, 0, 0}, {1, 0, 0}}};
  EXPECT_LT(stage.visibilities(receivers)[0], 0.5F);
  EXPECT_EQ(stage.visibilities(receivers)[1], 1.0F);
}

// hazards.md: finite for spreads from 0 to 1e30 m and exponents from 0.01 to 1e4; a receiver at the lamp is lit.
TEST_F(OctahedralGpu, IsFiniteAndInRangeForAnySpreadExponentAndReceiver)
{
  std::vector<EsmLamp> lamps;
  for (const float range : {1e-3F, 1.0F, 1e3F, 1e30F}) {
    for (const float exponent : {0.01F, 5.0F, 80.0F, 1e4F}) {
      for (const EsmKernel kernel : kernels) {
        for (const EsmFormat format : {EsmFormat::Float, EsmFormat::Half}) {
          lamps.push_back({"lamp", range, {.exponent = exponent, .size_px = 8, .format = format, .kernel = kernel}});
        }
        lamps.push_back(
            {"lamp", range, {.method = EsmMethod::Evsm, .exponent = exponent, .size_px = 8, .kernel = kernel}});
      }
    }
  }
  EsmStage stage(*device, lamps);
  CubeDepths cube = noise(16, 1e-4F, 1.0, 2.0);
  std::mt19937 random(2);
  for (std::vector<float> &face : cube.faces) {
    for (float &depth : face) {
      // Depths from the near plane to 0, logarithmically uniform.
      depth = random() % 4 == 0 ? 0.0F : float(std::pow(10.0, -34.0 * double(random()) / double(std::mt19937::max())));
    }
  }
  stage.upload(cube);
  std::vector<Receiver> receivers;
  constexpr float infinity = std::numeric_limits<float>::infinity();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < int(lamps.size()); i++) {
    stage.record(std::size_t(i), cube);
    for (const float value : stage.layer(std::size_t(i))) {
      ASSERT_TRUE(value >= 0.0F && value <= lamps[std::size_t(i)].range) << value << " in lamp " << i;
    }
    for (const float length : {1e-38F, 1e-20F, 1e-6F, 1.0F, 1e3F, 1e20F, 1e38F, infinity, nan}) {
      for (const glm::vec3 axis :
           {glm::vec3(1, 0, 0), glm::vec3(-1, -1, -1), glm::vec3(0, 0, -1), glm::vec3(1, -2, 3)}) {
        receivers.push_back({axis * length, {0, 0, 1}, i});
        receivers.push_back({axis * length, {nan, 0, 0}, i});
        receivers.push_back({axis * length, {0, 0, 0}, i});
      }
    }
    receivers.push_back({glm::vec3(0.0F), {0, 0, 1}, i});
  }
  const std::vector<float> visibilities = stage.visibilities(receivers);
  for (std::size_t i = 0; i < receivers.size(); i++) {
    ASSERT_TRUE(visibilities[i] >= 0.0F && visibilities[i] <= 1.0F) << visibilities[i] << " at " << i;
    if (receivers[i].from_light == glm::vec3(0.0F)) {
      ASSERT_EQ(visibilities[i], 1.0F) << "at the lamp, " << i;
    }
  }
}

// hazards.md: fp16 storage of linear distance.
TEST_F(OctahedralGpu, HalfFloatsRoundByNoMoreThanTheirFormulas)
{
  const float range = 20.0F;
  double worst_distance = 0.0;
  for (const float exponent : {5.0F, 80.0F}) {
    std::vector<EsmLamp> lamps;
    for (const EsmFormat format : {EsmFormat::Float, EsmFormat::Half}) {
      // Without a bias, which would be larger for halves.
      lamps.push_back({"lamp", range, {.exponent = exponent, .bias = 0.0F, .size_px = 64, .format = format}});
    }
    EsmStage stage(*device, lamps);
    const CubeDepths cube = noise(32, 0.5F, 0.5, 20.0);
    stage.upload(cube);
    stage.record(0, cube);
    stage.record(1, cube);
    const std::vector<float> exact = stage.layer(0);
    const std::vector<float> half = stage.layer(1);
    const float distance_error = shared::esm_format_error(range, ESM_HALF);
    EXPECT_FLOAT_EQ(distance_error, range / 8192);
    for (std::size_t i = 0; i < exact.size(); i++) {
      worst_distance = std::max(worst_distance, double(std::abs(exact[i] - half[i])));
    }
    std::vector<Receiver> receivers;
    std::mt19937 random(9);
    for (int i = 0; i < 20000; i++) {
      const glm::vec3 direction(test::random_direction(random));
      const float length = 0.5F + 19.0F * float(random()) / float(std::mt19937::max());
      receivers.push_back({direction * length, direction, 0});
    }
    const std::vector<float> exactly = stage.visibilities(receivers);
    for (Receiver &receiver : receivers) {
      receiver.index = 1;
    }
    const std::vector<float> rounded = stage.visibilities(receivers);
    const float visibility_error = shared::esm_visibility_error(exponent, distance_error);
    float worst = 0.0F;
    for (std::size_t i = 0; i < receivers.size(); i++) {
      worst = std::max(worst, std::abs(exactly[i] - rounded[i]));
    }
    EXPECT_LE(worst, visibility_error * 1.001F + exponent * 1e-5F) << exponent;
    EXPECT_GT(worst, visibility_error * 0.1F) << "the formula says no more than it must, at " << exponent;
    EXPECT_EQ(stage.store.limits().size(), visibility_error > esm_half_error_max ? 1U : 0U);
    fmt::print(
        "16F at {}/m over {} m: distances off by {:.3g} m (formula {:.3g}), visibilities by {:.3g} (formula {:.3g})\n",
        exponent, range, worst_distance, distance_error, worst, visibility_error);
    EXPECT_LE(worst_distance, distance_error * 1.001F + 4e-6F);
  }
}

/** Whether \a direction is within \a angle of the border of two cube faces. */
bool is_at_cube_edge(const glm::dvec3 &direction, double angle)
{
  const glm::dvec3 a = glm::abs(direction);
  const double largest = std::max({a.x, a.y, a.z});
  const double smallest = std::min({a.x, a.y, a.z});
  return largest - (a.x + a.y + a.z - largest - smallest) < angle * std::numbers::sqrt2;
}

/** Whether \a direction is within \a angle of the map's own edge, where it is continued by the border. */
bool is_at_border(const glm::dvec3 &direction, double angle)
{
  return direction.z < 0.0 && std::min(std::abs(direction.x), std::abs(direction.y)) < angle;
}

/** The same for the upper half, where the map has a crease but no seam. */
bool is_at_crease(const glm::dvec3 &direction, double angle)
{
  return is_at_border(glm::dvec3(direction.x, direction.y, -direction.z), angle);
}

/** Whether \a direction is within \a angle of the diamond at which the map folds out the lower half. */
bool is_at_fold(const glm::dvec3 &direction, double angle)
{
  return std::abs(direction.z) < angle;
}

// hazards.md: border mirrored only when directly adjacent; seam error measured along all 12 cube edges and the fold.
TEST_F(OctahedralGpu, SeamsAreNoWorseThanTheInterior)
{
  constexpr int size = 64;
  constexpr double radius = 4.0;
  constexpr std::array<const char *, 5> names = {"inside", "at creases inside", "at cube edges", "at the fold",
                                                 "at the border"};
  for (const EsmKernel kernel : kernels) {
    std::array<double, 5> worst{};
    std::array<double, 5> squares{};
    std::array<int, 5> counts{};
    std::mt19937 random(11);
    EsmStage stage(*device, {{EsmLamp{"lamp",
                                      10.0F,
                                      {.exponent = 4.0F,
                                       .bias = 0.0F,
                                       .filter_angle = 0.08F,
                                       .size_px = size,
                                       .format = EsmFormat::Float,
                                       .kernel = kernel}}}});
    glm::dvec3 center(0.0);
    for (int scene = 0; scene < 8; scene++) {
      // A smooth function, so that only seams are rough. It is rotated, so that no seam is at its steepest part, and
      // mirrored, so that the border and the creases cover the same values.
      center = scene % 2 == 0 ? 1.2 * test::random_direction(random) : glm::dvec3(center.x, center.y, -center.z);
      const CubeDepths cube = test::cube_depths(
          48, 0.5F, [&](const glm::dvec3 &d) { return test::around_distance(d, center, radius); }, 0.95F);
      stage.upload(cube);
      stage.record(0, cube);
      // A receiver behind the sphere at the distance of visibility one half, which shows differences of the filter.
      std::vector<Receiver> receivers;
      for (int i = 0; i < 10000; i++) {
        const glm::dvec3 direction = test::random_direction(random);
        const double distance = test::around_distance(direction, center, radius) + std::numbers::ln2 / 4.0;
        receivers.push_back({glm::vec3(direction * distance), glm::vec3(direction)});
      }
      const std::vector<float> visibilities = stage.visibilities(receivers);
      for (std::size_t i = 0; i < receivers.size(); i++) {
        const glm::dvec3 direction = glm::normalize(glm::dvec3(receivers[i].from_light));
        const std::size_t kind = is_at_border(direction, 2.0 / size)      ? 4
                                 : is_at_fold(direction, 2.0 / size)      ? 3
                                 : is_at_crease(direction, 2.0 / size)    ? 1
                                 : is_at_cube_edge(direction, 2.0 / size) ? 2
                                                                          : 0;
        const double error = std::abs(visibilities[i] - 0.5);
        worst[kind] = std::max(worst[kind], error);
        squares[kind] += error * error;
        counts[kind]++;
      }
    }
    const auto rms = [&](std::size_t kind) { return std::sqrt(squares[kind] / counts[kind]); };
    fmt::print("kernel {}:", int(kernel));
    for (std::size_t kind = 0; kind < 5; kind++) {
      fmt::print(" error {} {:.4f} (worst {:.4f})", names[kind], rms(kind), worst[kind]);
      EXPECT_GT(counts[kind], 1000);
      // The interior contains edges of the octahedron as the border does; their errors may be equal.
      EXPECT_LE(rms(kind), 1.1 * std::max(rms(0), rms(1))) << names[kind];
      EXPECT_LE(worst[kind], 1.1 * std::max(worst[0], worst[1])) << names[kind];
    }
    fmt::print("\n");
  }
}

TEST_F(OctahedralGpu, BorderRepeatsTheContinuationOfTheMap)
{
  constexpr int size = 16;
  const CubeDepths cube = noise(32, 0.5F, 1.0, 9.0);
  for (const EsmKernel kernel : kernels) {
    EsmStage stage(*device,
                   {{EsmLamp{"lamp", 10.0F, {.size_px = size, .format = EsmFormat::Float, .kernel = kernel}}}});
    stage.upload(cube);
    stage.record(0, cube);
    const std::vector<float> layer = stage.layer(0);
    const auto at = [&](glm::ivec2 texel) {
      return layer[std::size_t(texel.y + 1) * (size + 2) + std::size_t(texel.x + 1)];
    };
    for (int y = -1; y <= size; y++) {
      for (int x = -1; x <= size; x++) {
        EXPECT_EQ(at({x, y}), at(shared::octahedral_texel({x, y}, size))) << x << " " << y;
      }
    }
  }
}

// hazards.md: the blur's angle varies by up to √3 over the map.
TEST_F(OctahedralGpu, KernelsHaveOneSolidAngleEverywhere)
{
  constexpr int size = 128;
  constexpr float angle = 0.15F;
  for (const EsmKernel kernel : kernels) {
    double low = 1e9;
    double high = 0.0;
    for (const glm::dvec3 &direction : {glm::dvec3(0, 0, 1),
                                        {0, 0, -1},
                                        {1, 0, 0},
                                        {0, -1, 0},
                                        {1, 1, 1},
                                        {1, -1, -1},

                                        {1, 2, 0.2}}) {
      const glm::dvec3 middle = glm::normalize(direction);
      // With a small exponent the filter is a mean, and the mean of a paraboloid is the kernel's second moment.
      constexpr double scale = 20.0;
      const CubeDepths cube =
          test::cube_depths(256, 0.5F, [&](const glm::dvec3 &d) { return 1.0 + scale * (1.0 - glm::dot(d, middle)); });
      EsmStage stage(*device, {{EsmLamp{"lamp",
                                        100.0F,
                                        {.exponent = 0.01F,
                                         .filter_angle = angle,
                                         .size_px = size,
                                         .format = EsmFormat::Float,
                                         .kernel = kernel}}}});
      stage.upload(cube);
      stage.record(0, cube);
      const glm::vec2 uv = shared::octahedral_from_direction(glm::vec3(middle));
      const glm::ivec2 texel = glm::clamp(glm::ivec2(uv * float(size)), 0, size - 1);
      const double aside = 1.0 - glm::dot(texel_direction(texel, size), middle);
      const double moment =
          (double(stage.layer(0)[std::size_t(texel.y + 1) * (size + 2) + std::size_t(texel.x + 1)]) - 1.0) / scale -
          aside;
      low = std::min(low, moment);
      high = std::max(high, moment);
    }
    // The mean of 1 - cos over a disk is half of its versine; the angle is proportional to the square root.
    const double expected = 0.5 * (1.0 - std::cos(angle));
    fmt::print("kernel {}: blur's angle {:.3f} to {:.3f} of what was asked\n", int(kernel), std::sqrt(low / expected),
               std::sqrt(high / expected));
    // The Gaussian's rows and columns are not at right angles everywhere, and run back on themselves at the border.
    const bool is_separable = kernel == EsmKernel::Separable;
    EXPECT_GT(std::sqrt(low / expected), is_separable ? 0.85 : 0.98) << int(kernel);
    EXPECT_LT(std::sqrt(high / expected), is_separable ? 1.25 : 1.02) << int(kernel);
  }
}

/** A plane below the lamp, and one beside it, at all angles. */
TEST_F(OctahedralGpu, LitPlaneIsLitAndCoveredPlaneIsDark)
{
  constexpr float range = 20.0F;
  struct Case {
    EsmMethod method;
    EsmFormat format;
    const char *name;
  };
  for (const EsmKernel kernel : kernels) {
    for (const auto &[method, format, name] : {Case{EsmMethod::Esm, EsmFormat::Float, "32F"},
                                               {EsmMethod::Esm, EsmFormat::Half, "16F"},
                                               {EsmMethod::Evsm, EsmFormat::Float, "variance"}}) {
      double darkest = 1.0;
      double dark_sum = 0.0;
      double brightest = 0.0;
      int count = 0;
      for (const glm::dvec3 &up : {glm::dvec3(0, 0, 1), {0, -1, 0}, {0.3, -0.8, 0.4}}) {
        const glm::dvec3 normal = glm::normalize(up);
        const auto plane = [&](const glm::dvec3 &d) {
          const double along = -glm::dot(d, normal);
          return along > 1e-6 ? 2.0 / along : std::numeric_limits<double>::infinity();
        };
        const CubeDepths cube = test::cube_depths(esm_cube_size_px(256), 0.25F, plane);
        EsmStage stage(
            *device,
            {{EsmLamp{"lamp", range, {.method = method, .size_px = 256, .format = format, .kernel = kernel}}}});
        stage.upload(cube);
        stage.record(0, cube);
        std::vector<Receiver> receivers;
        std::vector<Receiver> behind;
        std::mt19937 random(3);
        while (receivers.size() < 3000) {
          const glm::dvec3 direction = test::random_direction(random);
          // Up to 84°, from where on a texel is as long as its distance.
          if (-glm::dot(direction, normal) > 0.1) {
            receivers.push_back({glm::vec3(direction * plane(direction)), glm::vec3(normal)});
          }
          if (-glm::dot(direction, normal) > 0.25) {
            behind.push_back({glm::vec3(direction * (plane(direction) + 0.5 * range)), glm::vec3(-direction)});
          }
        }
        for (const float visibility : stage.visibilities(receivers)) {
          darkest = std::min(darkest, double(visibility));
          dark_sum += 1.0 - visibility;
          count++;
        }
        for (const float visibility : stage.visibilities(behind)) {
          brightest = std::max(brightest, double(visibility));
        }
      }
      fmt::print(
          "kernel {}, {}: lit planes {:.4f} at the darkest, {:.5f} lost in the mean; behind them {:.2g} at the "
          "brightest\n",
          int(kernel), name, darkest, dark_sum / count, brightest);
      EXPECT_GT(darkest, 0.9);
      EXPECT_LT(dark_sum / count, 0.005);
      EXPECT_LT(brightest, 0.02);
    }
  }
}

/**
 * Walls of a room with balls in it, and the visibility of the lamp from there by a cone of rays as wide as the filter
 * of a map of \a size.
 */
struct FurnishedRoom {
  explicit FurnishedRoom(int size)
  {
    const glm::dvec3 low(-4, -3, -5);
    const glm::dvec3 high(5, 2.5, 4);
    const float sine = std::sin(0.5F * esm_filter_angle(size));
    std::mt19937 random(4);
    for (int i = 0; i < 8000; i++) {
      const glm::dvec3 direction = test::random_direction(random);
      const glm::dvec3 point = direction * test::room_distance(direction, low, high);
      glm::vec3 normal(0.0F);
      for (int axis = 0; axis < 3; axis++) {
        normal[axis] =
            std::min(std::abs(point[axis] - low[axis]), std::abs(point[axis] - high[axis])) < 1e-9 ? 1.0F : 0.0F;
      }
      receivers.push_back({glm::vec3(point), glm::normalize(normal)});
      int lit = 0;
      for (int tap = 0; tap < 64; tap++) {
        const glm::dvec3 towards(
            shared::esm_cone_direction(glm::vec3(direction), shared::esm_disk_point(tap, 64), 2.0F * sine * sine));
        lit += test::furnished_distance(towards) >= test::room_distance(towards, low, high) ? 1 : 0;
      }
      truths.push_back(lit / 64.0);
    }
  }
  /** RMSE of visibilities with \a settings. */
  [[nodiscard]] double error(gpu::Device &device, const EsmSettings &settings, const CubeDepths &cube) const
  {
    EsmStage stage(device, {{EsmLamp{"lamp", 10.0F, settings}}});
    stage.upload(cube);
    stage.record(0, cube);
    const std::vector<float> visibilities = stage.visibilities(receivers);
    double squares = 0.0;
    for (std::size_t i = 0; i < receivers.size(); i++) {
      squares += std::pow(visibilities[i] - truths[i], 2.0);
    }
    return std::sqrt(squares / double(receivers.size()));
  }

  std::vector<Receiver> receivers;
  std::vector<double> truths;
};

// hazards.md: cube face and octahedral layer coupled at 9 times the texels that are stored.
TEST_F(OctahedralGpu, DefaultCubeIsTheSmallestThatKeepsTheError)
{
  constexpr int size = 64;
  const FurnishedRoom room(size);
  const std::array<double, 7> ratios = {0.25, 0.375, 0.5, 0.75, 1.0, 2.0, 4.0};
  std::array<std::array<double, 7>, 3> errors{};
  const auto given = std::size_t(std::ranges::find(ratios, double(esm_cube_size_px(size)) / size) - ratios.begin());
  ASSERT_LT(given, ratios.size());
  for (std::size_t i = 0; i < ratios.size(); i++) {
    const CubeDepths cube = test::cube_depths(int(ratios[i] * size), 0.5F, test::furnished_distance);
    fmt::print("cube / layer {}: visibility RMSE", ratios[i]);
    for (const EsmKernel kernel : kernels) {
      double &error = errors[std::size_t(kernel)][i];
      error = room.error(*device, {.size_px = size, .format = EsmFormat::Float, .kernel = kernel}, cube);
      fmt::print(" {:.4f}", error);
    }
    fmt::print(" (disk of 4, disk of 32, separable)\n");
  }
  for (const auto &of_kernel : errors) {
    EXPECT_LE(of_kernel[given], 1.2 * *std::ranges::min_element(of_kernel)) << "a larger cube is worth it";
  }
}

TEST_F(OctahedralGpu, DerivedExponentIsNearTheBest)
{
  constexpr int size = 64;
  const FurnishedRoom room(size);
  const CubeDepths cube = test::cube_depths(esm_cube_size_px(size), 0.5F, test::furnished_distance);
  const float derived = esm_exponent(EsmMethod::Esm, esm_filter_angle(size), size, 10.0F);
  std::array<std::vector<double>, 3> errors;
  for (const float factor : {1.0F, 0.25F, 0.5F, 2.0F, 4.0F, 16.0F}) {
    fmt::print("exponent / derived {}: visibility RMSE", factor);
    for (const EsmKernel kernel : kernels) {
      errors[std::size_t(kernel)].push_back(room.error(
          *device, {.exponent = factor * derived, .size_px = size, .format = EsmFormat::Float, .kernel = kernel},
          cube));
      fmt::print(" {:.4f}", errors[std::size_t(kernel)].back());
    }
    fmt::print(" (disk of 4, disk of 32, separable)\n");
  }
  for (const std::vector<double> &of_kernel : errors) {
    EXPECT_LE(of_kernel.front(), 1.2 * *std::ranges::min_element(of_kernel));
  }
}

}  // namespace
}  // namespace gnomon::eevee
