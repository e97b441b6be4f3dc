// SPDX-License-Identifier: MIT
#pragma once

#include "measure_scene.hh"

#include <glm/mat4x4.hpp>

#include <map>
#include <memory>
#include <tuple>
#include <vector>

/** Pictures of small scenes, their ray-traced references, and their differences. Internal to source/verify. */
namespace gnomon::verify {

using measure::Picture;
using measure::Renderer;

/** A scene and the camera of its picture. */
struct TestView {
  scene::Scene scene;
  scene::PlacedCamera camera;
};

/**
 * \a test_view made \a scale times as large, and then moved by a rotation, reflection or translation, with the same
 * irradiance everywhere. Matrices are rounded to float, so that the engine and the rays have the same scene.
 */
[[nodiscard]] TestView placed(TestView test_view, const glm::dmat4 &moved, double scale = 1.0);

/** The settings of a picture. */
struct DrawSettings {
  scene::ShadowKind shadow = scene::ShadowKind::None;
  glm::ivec2 size_px{48, 36};
  int sample_count = 16;

  auto operator<=>(const DrawSettings &other) const
  {
    return std::tuple(shadow, size_px.x, size_px.y, sample_count) <=>
           std::tuple(other.shadow, other.size_px.x, other.size_px.y, other.sample_count);
  }
  bool operator==(const DrawSettings &other) const = default;
};

/** Draws one test view after another, with the programs and textures of those before. */
class TestViewRenderer {
 public:
  /** \a device must outlive it. */
  explicit TestViewRenderer(gpu::Device &device) : device_(device) {}

  Picture draw(const TestView &test_view, const DrawSettings &settings = {});
  /** Of the last draw with \a settings. */
  [[nodiscard]] eevee::Report report(const DrawSettings &settings);

 private:
  struct Stage {
    scene::Scene scene;
    std::unique_ptr<Renderer> renderer;
  };
  gpu::Device &device_;
  std::map<DrawSettings, Stage> stages_;
};

/** The picture by ray tracing with as many samples. */
[[nodiscard]] Picture truth(const TestView &test_view, const DrawSettings &settings = {});

/** Root of the mean square of a picture's difference, over the truth's mean; NaN where the picture is not finite. */
[[nodiscard]] double relative_rmse(const Picture &picture, const Picture &truth);

/** Share of pixels that differ by more than \a tolerance of the truth's mean; NaN where the picture is not finite. */
[[nodiscard]] double wrong_share(const Picture &picture, const Picture &truth, double tolerance);

/** Median of |difference| / truth over the pixels where the truth is above 0; NaN where the picture is not finite. */
[[nodiscard]] double median_error(const Picture &picture, const Picture &truth);

/** Largest difference, over the truth's mean; NaN where the picture is not finite. */
[[nodiscard]] double largest_error(const Picture &picture, const Picture &truth);

}  // namespace gnomon::verify
