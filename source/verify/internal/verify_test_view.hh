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

/** A scene and the camera that views it. */
struct TestView {
  scene::Scene scene;
  scene::PlacedCamera camera;
};

/**
 * \a test_view scaled by \a scale and then transformed by the rotation, reflection or translation \a moved. Lamps are
 * scaled so that the irradiance remains the same everywhere. Matrices are rounded to float, so that the engine and the
 * ray tracer use the same scene.
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

/** Draws test views in turn, and reuses programs and textures of earlier ones. */
class TestViewRenderer {
 public:
  /** \a device must outlive it. */
  explicit TestViewRenderer(gpu::Device &device) : device_(device) {}

  Picture draw(const TestView &test_view, const DrawSettings &settings = {});
  /** Report of the last draw with \a settings. */
  [[nodiscard]] eevee::Report report(const DrawSettings &settings);
  [[nodiscard]] const gpu::Limits &limits() const
  {
    return device_.limits();
  }

 private:
  struct Stage {
    scene::Scene scene;
    std::unique_ptr<Renderer> renderer;
  };
  gpu::Device &device_;
  std::map<DrawSettings, Stage> stages_;
};

/** The ray-traced picture with the same number of samples. */
[[nodiscard]] Picture truth(const TestView &test_view, const DrawSettings &settings = {});

/** RMSE divided by the mean of \a truth; NaN if the picture is not finite. */
[[nodiscard]] double relative_rmse(const Picture &picture, const Picture &truth);

/**
 * Fraction of pixels whose difference exceeds \a tolerance times the mean of \a truth; NaN if the picture is not
 * finite.
 */
[[nodiscard]] double wrong_share(const Picture &picture, const Picture &truth, double tolerance);

/** Median of |difference| / truth over the pixels where \a truth is above 0; NaN if the picture is not finite. */
[[nodiscard]] double median_error(const Picture &picture, const Picture &truth);

/** Largest difference, divided by the mean of \a truth; NaN if the picture is not finite. */
[[nodiscard]] double largest_error(const Picture &picture, const Picture &truth);

}  // namespace gnomon::verify
