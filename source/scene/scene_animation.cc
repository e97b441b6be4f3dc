// SPDX-License-Identifier: MIT
#include "scene_animation.hh"

#include "scene.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::scene {

namespace {

/** The two keys around a time, and the position between them. */
struct Segment {
  std::size_t first = 0;
  std::size_t second = 0;
  /** Position between the keys, in [0, 1]. */
  double t = 0.0;
  /** Time between the keys, seconds. */
  double length = 0.0;
};

Segment segment_at(const std::vector<float> &times, double seconds)
{
  const auto after = std::ranges::upper_bound(times, seconds);
  if (after == times.begin()) {
    return {};
  }
  const auto first = std::size_t(after - times.begin()) - 1;
  if (after == times.end()) {
    return {first, first, 0.0, 0.0};
  }
  const double length = double(times[first + 1]) - double(times[first]);
  return {first, first + 1, std::clamp((seconds - double(times[first])) / length, 0.0, 1.0), length};
}

}  // namespace

void Track::evaluate(double seconds, std::span<double> out) const
{
  const Segment s = segment_at(times, seconds);
  if (interpolation == Interpolation::CubicSpline) {
    // Hermite spline (glTF 2.0, appendix C). Each key has an in-tangent, a value and an out-tangent.
    const float *first = values.data() + 3 * width * s.first;
    const float *second = values.data() + 3 * width * s.second;
    const double t = s.t;
    const double t2 = t * t;
    const double t3 = t2 * t;
    for (std::size_t i = 0; i < width; i++) {
      out[i] = (2.0 * t3 - 3.0 * t2 + 1.0) * double(first[width + i]) +
               s.length * (t3 - 2.0 * t2 + t) * double(first[2 * width + i]) +
               (3.0 * t2 - 2.0 * t3) * double(second[width + i]) + s.length * (t3 - t2) * double(second[i]);
    }
    return;
  }
  const float *first = values.data() + width * s.first;
  const float *second = values.data() + width * s.second;
  const double t = interpolation == Interpolation::Step ? 0.0 : s.t;
  for (std::size_t i = 0; i < width; i++) {
    out[i] = (1.0 - t) * double(first[i]) + t * double(second[i]);
  }
}

glm::dquat Track::evaluate_rotation(double seconds) const
{
  glm::dquat rotation;
  const Segment s = segment_at(times, seconds);
  if (interpolation == Interpolation::Linear && s.first != s.second) {
    const auto key = [this](std::size_t index) {
      const float *v = values.data() + 4 * index;
      return glm::normalize(glm::dquat(double(v[3]), double(v[0]), double(v[1]), double(v[2])));
    };
    rotation = glm::slerp(key(s.first), key(s.second), s.t);
  }
  else {
    std::array<double, 4> v{};
    evaluate(seconds, v);
    rotation = glm::dquat(v[3], v[0], v[1], v[2]);
  }
  const double length = glm::length(rotation);
  return length > 0.0 ? rotation / length : glm::dquat(1.0, 0.0, 0.0, 0.0);
}

std::size_t width_of(AnimatedProperty property)
{
  switch (property) {
    case AnimatedProperty::BaseColor: return 4;
    case AnimatedProperty::Emissive:
    case AnimatedProperty::LampColor: return 3;
    default: return 1;
  }
}

double Animation::duration() const
{
  double seconds = 0.0;
  const auto extend = [&seconds](const SharedTrack &track) {
    seconds = track ? std::max(seconds, double(track->times.back())) : seconds;
  };
  for (const AnimatedNode &node : nodes) {
    for (const SharedTrack &track :
         {node.translation_track, node.rotation_track, node.scale_track, node.weights_track}) {
      extend(track);
    }
  }
  for (const AnimatedValue &value : values) {
    extend(value.track);
  }
  return seconds;
}

namespace {

void pose_node(Scene &scene, const AnimatedNode &animated, double seconds)
{
  if (!scene.nodes().is_live(animated.node)) {
    return;
  }
  glm::dvec3 translation = animated.translation;
  glm::dquat rotation = animated.rotation;
  glm::dvec3 scale = animated.scale;
  if (animated.translation_track) {
    animated.translation_track->evaluate(seconds, {&translation.x, 3});
  }
  if (animated.rotation_track) {
    rotation = animated.rotation_track->evaluate_rotation(seconds);
  }
  if (animated.scale_track) {
    animated.scale_track->evaluate(seconds, {&scale.x, 3});
  }
  if (animated.translation_track || animated.rotation_track || animated.scale_track) {
    scene.set_transform(animated.node, glm::translate(glm::dmat4(1.0), translation) * glm::mat4_cast(rotation) *
                                           glm::scale(glm::dmat4(1.0), scale));
  }
  if (animated.weights_track) {
    std::vector<double> weights(animated.weights_track->width);
    animated.weights_track->evaluate(seconds, weights);
    set_morph_weights(scene, animated.node, weights);
  }
}

// A spline may exceed the range of its keys, and even that of float.
constexpr double float_max = std::numeric_limits<float>::max();

float unit_range(double value)
{
  return float(std::clamp(value, 0.0, 1.0));
}

float at_least_zero(double value)
{
  return float(std::clamp(value, 0.0, float_max));
}

glm::vec3 at_least_zero(const glm::dvec4 &value)
{
  return {at_least_zero(value.x), at_least_zero(value.y), at_least_zero(value.z)};
}

void set_property(Material &material, AnimatedProperty property, const glm::dvec4 &value)
{
  switch (property) {
    case AnimatedProperty::BaseColor:
      material.base_color = {unit_range(value.x), unit_range(value.y), unit_range(value.z)};
      material.alpha = unit_range(value.w);
      break;
    case AnimatedProperty::Metallic: material.metallic = unit_range(value.x); break;
    case AnimatedProperty::Roughness: material.roughness = unit_range(value.x); break;
    case AnimatedProperty::Emissive: material.emissive = at_least_zero(value); break;
    case AnimatedProperty::AlphaCutoff: material.alpha_cutoff = unit_range(value.x); break;
    case AnimatedProperty::NormalScale:
      material.normal_scale = float(std::clamp(value.x, -float_max, float_max));
      break;
    case AnimatedProperty::OcclusionStrength: material.occlusion_strength = unit_range(value.x); break;
    default: break;
  }
}

void set_property(Lamp &lamp, AnimatedProperty property, const glm::dvec4 &value)
{
  switch (property) {
    case AnimatedProperty::LampColor: lamp.color = at_least_zero(value); break;
    case AnimatedProperty::LampIntensity: lamp.intensity = at_least_zero(value.x); break;
    case AnimatedProperty::LampRange: lamp.range = at_least_zero(value.x); break;
    default: break;
  }
}

void set_property(Camera &camera, AnimatedProperty property, const glm::dvec4 &value)
{
  constexpr double angle_min = 1e-5;
  constexpr double angle_max = 3.1415;
  constexpr double length_min = 1e-12;
  switch (property) {
    case AnimatedProperty::VerticalAngle:
      camera.vertical_angle = float(std::clamp(value.x, angle_min, angle_max));
      break;
    case AnimatedProperty::HalfWidth: camera.half_width = float(std::clamp(value.x, length_min, float_max)); break;
    case AnimatedProperty::HalfHeight: camera.half_height = float(std::clamp(value.x, length_min, float_max)); break;
    default: break;
  }
}

}  // namespace

void pose(Scene &scene, const Animation &animation, double seconds)
{
  for (const AnimatedNode &node : animation.nodes) {
    pose_node(scene, node, seconds);
  }
  for (const AnimatedValue &animated : animation.values) {
    glm::dvec4 value(0.0);
    const std::size_t width = animated.track->width;
    animated.track->evaluate(seconds, {&value.x, width});
    if (width == 1) {
      // A strength, which multiplies each component of the factor.
      value = glm::dvec4(value.x);
    }
    value = glm::dvec4(animated.factor * glm::dvec3(value), value.w);
    std::visit(
        [&]<typename T>(Handle<T> handle) {
          if (scene.pool<T>().is_live(handle)) {
            scene.edit(handle, [&](T &thing) { set_property(thing, animated.property, value); });
          }
        },
        animated.target);
  }
  deform_meshes(scene);
}

}  // namespace gnomon::scene
