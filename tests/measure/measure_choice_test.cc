// SPDX-License-Identifier: MIT
#include "measure_choice.hh"

#include "measure_reference.hh"
#include "reference/reference_test_scene.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace gnomon::measure {
namespace {

Model model(const std::string &name, double shadow_seconds, double sample_seconds, std::vector<Model::Point> points)
{
  Model one;
  one.technique.name = name;
  one.shadow_seconds = shadow_seconds;
  one.sample_seconds = sample_seconds;
  one.points = std::move(points);
  return one;
}

/** Errors 0.16 / n and, at four times the time, 0.04 / n. */
std::vector<Model> two_models()
{
  return {model("cheap", 0.0, 1.0, {{1, {0.16, 0.0}}, {4, {0.04, 0.0}}, {16, {0.01, 0.0}}}),
          model("dear", 3.0, 1.0, {{1, {0.04, 0.0}}, {4, {0.01, 0.0}}, {16, {0.0025, 0.0}}})};
}

TEST(Choice, ErrorBetweenPointsIsAPower)
{
  const Model one = two_models()[0];
  EXPECT_NEAR(one.error(1).rmse, 0.16, 1e-12);
  EXPECT_NEAR(one.error(2).rmse, 0.08, 1e-12);
  EXPECT_NEAR(one.error(8).rmse, 0.02, 1e-12);
  EXPECT_EQ(one.error(16).rmse, 0.01);
  EXPECT_EQ(one.error(1000).rmse, 0.01);
}

TEST(Choice, FastestWithinTheError)
{
  const std::vector<Model> models = two_models();
  // Three samples of the first model give 0.16 / 3 in 3 s; one sample of the other takes 4 s.
  Choice choice = choose(models, {.error_max = 0.06, .seconds_max = {}});
  EXPECT_EQ(choice.technique.name, "cheap");
  EXPECT_EQ(choice.sample_count, 3);
  EXPECT_TRUE(choice.is_met);
  // 16 s, or 3 + 4.
  choice = choose(models, {.error_max = 0.0101, .seconds_max = {}});
  EXPECT_EQ(choice.technique.name, "dear");
  EXPECT_EQ(choice.sample_count, 4);
  EXPECT_DOUBLE_EQ(choice.predicted_seconds, 7.0);
}

TEST(Choice, TwoStandardErrorsAreAdded)
{
  const std::vector<Model> models = {model("one", 0.0, 1.0, {{1, {0.05, 0.03}}, {2, {0.05, 0.01}}})};
  EXPECT_EQ(choose(models, {.error_max = 0.08, .seconds_max = {}}).sample_count, 2);
}

TEST(Choice, MostExactWithinTheTime)
{
  const std::vector<Model> models = two_models();
  EXPECT_EQ(choose(models, {.error_max = {}, .seconds_max = 3.5}).sample_count, 3);
  const Choice choice = choose(models, {.error_max = {}, .seconds_max = 7.5});
  EXPECT_EQ(choice.technique.name, "dear");
  EXPECT_EQ(choice.sample_count, 4);
}

TEST(Choice, UnmetRequirementIsReportedWithTheNearestChoice)
{
  const std::vector<Model> models = two_models();
  Choice choice = choose(models, {.error_max = 1e-6, .seconds_max = {}});
  EXPECT_FALSE(choice.is_met);
  EXPECT_EQ(choice.predicted_error.rmse, 0.0025);
  choice = choose(models, {.error_max = {}, .seconds_max = 0.1});
  EXPECT_FALSE(choice.is_met);
  EXPECT_EQ(choice.predicted_seconds, 1.0);
}

TEST(Choice, ReportGivesTimesOfShadowsAndSamples)
{
  SceneReport report;
  // Techniques without command line options are not chosen.
  report.techniques.emplace_back().pictures.emplace_back().seconds = {1.0};
  TechniqueReport &technique = report.techniques.emplace_back();
  technique.technique.options = "--shadow hard";
  for (const int n : {1, 4, 16}) {
    PictureReport &picture = technique.pictures.emplace_back();
    picture.sample_count = n;
    picture.seconds = {2.0 + 0.5 * n};
    picture.error.rmse = 1.0 / n;
  }
  technique.pictures.back().error.rmse = std::nan("");
  const std::vector<Model> models = models_from(report);
  ASSERT_EQ(models.size(), 1U);
  EXPECT_NEAR(models[0].shadow_seconds, 2.0, 1e-12);
  EXPECT_NEAR(models[0].sample_seconds, 0.5, 1e-12);
  EXPECT_EQ(models[0].points.size(), 2U);
}

/** A ground with a caster above it, and its reference picture. */
class PixelSampleTest : public testing::Test {
 protected:
  PixelSampleTest()
  {
    test::add_rectangle(scene_, {-5.0F, -5.0F}, {5.0F, 5.0F});
    test::add_rectangle(scene_, {-0.7F, -0.4F}, {0.6F, 0.5F}, test::placed({0.0F, 0.0F, 1.0F}));
    scene::PlacedLamp lamp = test::lamp_at(scene::LampKind::Point, {1.0F, 1.0F, 4.0F});
    lamp.intensity = 20.0F;
    test::add_lamp(scene_, lamp);
    tracer_ = std::make_unique<reference::Tracer>(scene_);
    exact_ = reference_picture(*tracer_, camera_, size_px_, 16).picture.pixels;
  }

  glm::ivec2 size_px_{64, 48};
  scene::Scene scene_;
  const scene::PlacedCamera camera_ = test::camera_at({0.0F, -6.0F, 5.0F}, {0.0F, 0.0F, 0.0F});
  std::unique_ptr<reference::Tracer> tracer_;
  std::vector<glm::vec4> exact_;
};

TEST_F(PixelSampleTest, ReproducesAKnownError)
{
  // The difference is larger where x + y is odd, so that it does not depend on the position.
  std::vector<glm::vec4> picture = exact_;
  double square = 0.0;
  for (std::size_t i = 0; i < picture.size(); i++) {
    const float off = (i % 64 + i / 64) % 2 == 0 ? 0.01F : 0.03F;
    picture[i] += glm::vec4(off, -off, off, 0.0F);
    square += double(off) * double(off);
  }
  const double rmse = std::sqrt(square / double(picture.size()));
  for (std::uint64_t seed = 0; seed < 4; seed++) {
    const PixelSample sample(*tracer_, camera_, size_px_, exact_, 1000, 16, seed);
    const SampledError error = sample.error(picture);
    // Four standard deviations: a probability of 1 / 16 000, and the seeds are fixed.
    EXPECT_NEAR(error.rmse, rmse, 4.0 * error.standard_error) << seed;
    EXPECT_LT(error.standard_error, 0.05 * rmse) << seed;
  }
}

TEST_F(PixelSampleTest, NoiseOfTheReferenceCancels)
{
  // Two samples per pixel are noisy at edges. The product of two independent estimates is as often negative as
  // positive.
  double square = 0.0;
  constexpr int seeds = 8;
  for (std::uint64_t seed = 0; seed < seeds; seed++) {
    const PixelSample rough(*tracer_, camera_, size_px_, exact_, 1000, 2, seed);
    square += std::pow(rough.error(exact_).rmse, 2) / seeds;
  }
  const reference::Picture noisy =
      reference::direct_light(*tracer_, camera_, size_px_, {.sample_count = 2, .seed = 77});
  const double noise = image_error(size_px_, noisy.pixels, exact_).rmse;
  EXPECT_LT(std::sqrt(square), 0.4 * noise);
}

TEST_F(PixelSampleTest, NanPixelGivesANanError)
{
  const std::vector<glm::vec4> picture(exact_.size(), glm::vec4(std::numeric_limits<float>::quiet_NaN()));
  const PixelSample sample(*tracer_, camera_, size_px_, exact_, 10, 1, 0);
  EXPECT_TRUE(std::isnan(sample.error(picture).rmse));
}

TEST_F(PixelSampleTest, ReferenceRefinesNoisyPixels)
{
  const reference::Tracer &tracer = *tracer_;
  const ReferencePicture refined = reference_picture(tracer, camera_, size_px_, 4);
  const reference::Picture a = reference::direct_light(tracer, camera_, size_px_, {.sample_count = 2});
  const reference::Picture b = reference::direct_light(tracer, camera_, size_px_, {.sample_count = 2, .seed = 1});
  // The noise of the mean is half of the difference of the halves. Measured: 0.29 of it with the noisiest tenth
  // refined.
  EXPECT_LT(refined.noise, 0.5 * 0.5 * image_error(size_px_, a.pixels, b.pixels).rmse);
  const reference::Picture exact = reference::direct_light(tracer, camera_, size_px_, {.sample_count = 256, .seed = 9});
  const double error = image_error(size_px_, refined.picture.pixels, exact.pixels).rmse;
  EXPECT_LT(error, 2.0 * refined.noise);
  EXPECT_GT(error, 0.5 * refined.noise);
}

}  // namespace
}  // namespace gnomon::measure
