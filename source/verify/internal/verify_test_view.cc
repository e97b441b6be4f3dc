// SPDX-License-Identifier: MIT
#include "internal/verify_test_view.hh"

#include "reference_light.hh"

#include <algorithm>
#include <functional>
#include <limits>

namespace gnomon::verify {

TestView placed(TestView test_view, const glm::dmat4 &moved, double scale)
{
  const glm::dmat4 scaled = moved * glm::scale(glm::dmat4(1.0), glm::dvec3(scale));
  const auto rounded = [](const glm::dmat4 &matrix) { return glm::dmat4(glm::mat4(matrix)); };
  scene::Scene &scene = test_view.scene;
  for (const auto &[handle, node] : scene.nodes()) {
    if (!scene.parent(handle)) {
      scene.set_transform(handle, rounded(scaled * node.parent_from_node));
    }
  }
  for (const auto &[handle, lamp] : scene.lamps()) {
    if (lamp.kind == scene::LampKind::Point || lamp.kind == scene::LampKind::Spot) {
      scene.edit(handle, [scale](scene::Lamp &changed) {
        changed.intensity = float(changed.intensity * scale * scale);
        changed.radius = float(changed.radius * scale);
        changed.range = float(changed.range * scale);
      });
    }
  }
  scene::PlacedCamera &camera = test_view.camera;
  camera.world_from_camera = rounded(scene::frame_of(scaled * camera.world_from_camera));
  for (float *length : {&camera.half_width, &camera.half_height, &camera.near, &camera.far}) {
    *length = float(*length * scale);
  }
  return test_view;
}

Picture TestViewRenderer::draw(const TestView &test_view, const DrawSettings &settings)
{
  Stage &stage = stages_[settings];
  stage.scene = test_view.scene;
  if (!stage.renderer) {
    eevee::Settings engine;
    engine.sample_count = settings.sample_count;
    engine.shadow.kind = settings.shadow;
    // Coarse, because the pictures are small.
    engine.shadow.cube_size_px = 256;
    engine.shadow.map_size_px = 512;
    engine.shadow.esm.size_px = 256;
    stage.renderer = std::make_unique<Renderer>(device_, stage.scene, settings.size_px, engine);
  }
  else {
    stage.renderer->sync();
  }
  return stage.renderer->picture(test_view.camera);
}

eevee::Report TestViewRenderer::report(const DrawSettings &settings)
{
  Renderer &renderer = *stages_.at(settings).renderer;
  return renderer.inspect().report();
}

Picture truth(const TestView &test_view, const DrawSettings &settings)
{
  scene::Scene scene = test_view.scene;
  if (settings.shadow == scene::ShadowKind::None) {
    for (const auto &[handle, lamp] : scene.lamps()) {
      scene.edit(handle, [](scene::Lamp &changed) { changed.shadow.kind = scene::ShadowKind::None; });
    }
  }
  const reference::Tracer tracer(scene);
  reference::Picture picture =
      reference::direct_light(tracer, test_view.camera, settings.size_px, {.sample_count = settings.sample_count});
  return {picture.size_px, std::move(picture.pixels)};
}

/** Error of \a picture; NaN if it is not finite or of another size. */
static double error_of(const Picture &picture, const Picture &truth, const std::function<double(double mean)> &error)
{
  double sum = 0.0;
  for (const glm::vec4 &pixel : truth.pixels) {
    sum += (double(pixel.r) + double(pixel.g) + double(pixel.b)) / 3.0;
  }
  const bool is_valid = picture.pixels.size() == truth.pixels.size() && picture.non_finite_count() == 0;
  // The difference from a black reference is absolute.
  const double mean = sum > 0.0 ? sum / double(truth.pixels.size()) : 1.0;
  return is_valid ? error(mean) : std::numeric_limits<double>::quiet_NaN();
}

/** Largest difference of a channel. */
static double difference(const glm::vec4 &a, const glm::vec4 &b)
{
  const glm::dvec3 d = glm::abs(glm::dvec3(a) - glm::dvec3(b));
  return std::max({d.x, d.y, d.z});
}

double relative_rmse(const Picture &picture, const Picture &truth)
{
  return error_of(picture, truth, [&](double mean) {
    double squares = 0.0;
    for (std::size_t i = 0; i < truth.pixels.size(); i++) {
      // Squares of huge or denormal radiances would overflow or underflow double.
      const glm::dvec3 d = (glm::dvec3(picture.pixels[i]) - glm::dvec3(truth.pixels[i])) / mean;
      squares += glm::dot(d, d) / 3.0;
    }
    return std::sqrt(squares / double(truth.pixels.size()));
  });
}

double wrong_share(const Picture &picture, const Picture &truth, double tolerance)
{
  return error_of(picture, truth, [&](double mean) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < truth.pixels.size(); i++) {
      count += difference(picture.pixels[i], truth.pixels[i]) > tolerance * mean ? 1 : 0;
    }
    return double(count) / double(truth.pixels.size());
  });
}

double median_error(const Picture &picture, const Picture &truth)
{
  return error_of(picture, truth, [&](double) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < truth.pixels.size(); i++) {
      const double true_value = std::max({truth.pixels[i].r, truth.pixels[i].g, truth.pixels[i].b});
      if (true_value > 0.0) {
        errors.push_back(difference(picture.pixels[i], truth.pixels[i]) / true_value);
      }
    }
    const auto middle = errors.begin() + std::ptrdiff_t(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    return errors.empty() ? 0.0 : *middle;
  });
}

double largest_error(const Picture &picture, const Picture &truth)
{
  return error_of(picture, truth, [&](double mean) {
    double largest = 0.0;
    for (std::size_t i = 0; i < truth.pixels.size(); i++) {
      largest = std::max(largest, difference(picture.pixels[i], truth.pixels[i]) / mean);
    }
    return largest;
  });
}

}  // namespace gnomon::verify
