// SPDX-License-Identifier: MIT
#include "internal/measure_shot.hh"

#include "reference_light.hh"

#include <algorithm>
#include <functional>
#include <limits>

namespace gnomon::measure {

Shot placed(Shot shot, const glm::dmat4 &moved, double scale)
{
  const glm::dmat4 scaled = moved * glm::scale(glm::dmat4(1.0), glm::dvec3(scale));
  for (scene::Object &object : shot.scene.objects) {
    object.world_from_object = glm::mat4(scaled * glm::dmat4(object.world_from_object));
  }
  // A frame stays one: a reflection turns its x axis back.
  const bool is_mirrored = glm::determinant(glm::dmat3(moved)) < 0.0;
  const auto frame = [&](const glm::mat4 &world_from_local) {
    glm::dmat4 result = moved * glm::dmat4(world_from_local);
    result[0] *= is_mirrored ? -1.0 : 1.0;
    result[3] = scaled * glm::dmat4(world_from_local)[3];
    return glm::mat4(result);
  };
  for (scene::Lamp &lamp : shot.scene.lamps) {
    lamp.world_from_lamp = frame(lamp.world_from_lamp);
    if (lamp.kind == scene::LampKind::Point || lamp.kind == scene::LampKind::Spot) {
      lamp.intensity = float(lamp.intensity * scale * scale);
      lamp.radius = float(lamp.radius * scale);
      lamp.range = float(lamp.range * scale);
    }
  }
  scene::Camera &camera = shot.camera;
  camera.world_from_camera = frame(camera.world_from_camera);
  for (float *length : {&camera.half_width, &camera.half_height, &camera.near, &camera.far}) {
    *length = float(*length * scale);
  }
  return shot;
}

Picture Studio::draw(const Shot &shot, const DrawSettings &settings)
{
  Stage &stage = stages_[settings];
  stage.scene = shot.scene;
  for (scene::Mesh &mesh : stage.scene.meshes) {
    mesh.revision = ++revision_;
  }
  if (!stage.renderer) {
    eevee::Settings engine;
    engine.sample_count = settings.sample_count;
    engine.shadow.kind = settings.shadow;
    // Coarse: the pictures are small.
    engine.shadow.cube_size_px = 256;
    engine.shadow.map_size_px = 512;
    engine.shadow.esm.size_px = 256;
    stage.renderer = std::make_unique<Renderer>(device_, stage.scene, settings.size_px, engine);
  }
  else {
    stage.renderer->sync();
  }
  return stage.renderer->picture(shot.camera);
}

eevee::Report Studio::report(const DrawSettings &settings)
{
  Renderer &renderer = *stages_.at(settings).renderer;
  return renderer.engine.report(renderer.viewport);
}

Picture truth(const Shot &shot, const DrawSettings &settings)
{
  scene::Scene scene = shot.scene;
  if (settings.shadow == scene::ShadowKind::None) {
    for (scene::Lamp &lamp : scene.lamps) {
      lamp.shadow.kind = scene::ShadowKind::None;
    }
  }
  const reference::Tracer tracer(scene);
  reference::Picture picture =
      reference::direct_light(tracer, shot.camera, settings.size_px, {.sample_count = settings.sample_count});
  return {picture.size_px, std::move(picture.pixels)};
}

/** NaN for a picture that is not finite, or of another size. */
static double error_of(const Picture &picture, const Picture &truth, const std::function<double(double mean)> &error)
{
  double sum = 0.0;
  for (const glm::vec4 &pixel : truth.pixels) {
    sum += (double(pixel.r) + double(pixel.g) + double(pixel.b)) / 3.0;
  }
  const bool is_valid = picture.pixels.size() == truth.pixels.size() && picture.non_finite_count() == 0;
  // A black truth is in units of 1.
  const double mean = sum > 0.0 ? sum / double(truth.pixels.size()) : 1.0;
  return is_valid ? error(mean) : std::numeric_limits<double>::quiet_NaN();
}

/** Of the channel where it is largest. */
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
      // Squares of huge or denormal radiances would leave double's range.
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

}  // namespace gnomon::measure
