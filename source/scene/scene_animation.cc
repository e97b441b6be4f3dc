// SPDX-License-Identifier: MIT
#include "scene_animation.hh"

#include "internal/scene_rest_shape.hh"
#include "scene.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

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

/** A colour whose fourth number is the alpha, as in glTF. */
static constexpr std::string_view with_alpha = "base_color";

std::size_t width_of(std::string_view property)
{
  std::size_t width = 0;
  const auto find = [&](const auto &row) {
    if (row.is_animated && row.name == property) {
      width = std::is_same_v<typename std::decay_t<decltype(row)>::Value, glm::vec3> ? 3 : 1;
    }
  };
  Material::for_each_property(find);
  Lamp::for_each_property(find);
  Camera::for_each_property(find);
  return property == with_alpha ? 4 : width;
}

static constexpr std::array node_tracks = {&AnimatedNode::translation_track, &AnimatedNode::rotation_track,
                                           &AnimatedNode::scale_track, &AnimatedNode::weights_track};

double Animation::duration() const
{
  double seconds = 0.0;
  const auto extend = [&seconds](const SharedTrack &track) {
    seconds = track ? std::max(seconds, double(track->times.back())) : seconds;
  };
  for (const AnimatedNode &node : nodes) {
    for (SharedTrack AnimatedNode::*track : node_tracks) {
      extend(node.*track);
    }
  }
  for (const AnimatedValue &value : values) {
    extend(value.track);
    extend(value.second_track);
  }
  return seconds;
}

namespace {

bool has_same_place(const AnimatedValue &a, const AnimatedValue &b)
{
  return a.target == b.target && a.property == b.property && a.slot == b.slot;
}

/** Whether one of them is a factor of three numbers, and the other the strength that it is multiplied by. */
bool is_product(const AnimatedValue &a, const AnimatedValue &b)
{
  return a.property == "emissive" && has_same_place(a, b) && !a.second_track && !b.second_track &&
         a.track->width != b.track->width;
}

}  // namespace

void add_value(Animation &animation, AnimatedValue value)
{
  for (AnimatedValue &other : animation.values) {
    if (is_product(other, value)) {
      const bool is_strength = value.track->width == 1;
      other.second_track = is_strength ? value.track : other.track;
      other.track = is_strength ? other.track : value.track;
      other.factor = glm::dvec3(1.0);
      return;
    }
  }
  animation.values.push_back(std::move(value));
}

bool join(Animation &animation, const Animation &other)
{
  std::map<Handle<Node>, std::size_t> places;
  for (std::size_t i = 0; i < animation.nodes.size(); i++) {
    places.emplace(animation.nodes[i].node, i);
  }
  for (const AnimatedNode &node : other.nodes) {
    const auto place = places.find(node.node);
    const auto is_in_both = [&](SharedTrack AnimatedNode::*track) {
      return node.*track && animation.nodes[place->second].*track;
    };
    if (place != places.end() && std::ranges::any_of(node_tracks, is_in_both)) {
      return false;
    }
  }
  for (const AnimatedValue &value : other.values) {
    if (std::ranges::any_of(animation.values, [&](const AnimatedValue &one) {
          return has_same_place(one, value) && !is_product(one, value);
        })) {
      return false;
    }
  }
  for (const AnimatedNode &node : other.nodes) {
    const auto [place, is_new] = places.try_emplace(node.node, animation.nodes.size());
    if (is_new) {
      animation.nodes.push_back(node);
      continue;
    }
    for (SharedTrack AnimatedNode::*track : node_tracks) {
      if (node.*track) {
        animation.nodes[place->second].*track = node.*track;
      }
    }
  }
  for (const AnimatedValue &value : other.values) {
    add_value(animation, value);
  }
  return true;
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
    // A pose goes on where a file's node at rest is left out: interpolated values may be large for a moment.
    glm::dmat4 parent_from_node =
        glm::translate(glm::dmat4(1.0), translation) * glm::mat4_cast(rotation) * glm::scale(glm::dmat4(1.0), scale);
    for (int column = 0; column < 4; column++) {
      parent_from_node[column] = glm::clamp(parent_from_node[column], -number_max, number_max);
    }
    scene.set_transform(animated.node, parent_from_node);
  }
  if (animated.weights_track) {
    std::vector<double> weights(animated.weights_track->width);
    animated.weights_track->evaluate(seconds, weights);
    set_morph_weights(scene, animated.node, weights);
  }
}

/** A spline may exceed the range of its keys. */
template <typename Thing>
void set_property(Thing &thing, std::string_view property, const glm::dvec4 &value)
{
  Thing::for_each_property([&](const auto &row) {
    using Value = typename std::decay_t<decltype(row)>::Value;
    if (row.name != property) {
      return;
    }
    if constexpr (std::is_same_v<Value, float>) {
      thing.*row.member = row.nearest(value.x);
    }
    else if constexpr (std::is_same_v<Value, glm::vec3>) {
      thing.*row.member = {row.nearest(value.x), row.nearest(value.y), row.nearest(value.z)};
    }
    else if constexpr (std::is_same_v<Value, glm::vec2>) {
      thing.*row.member = {row.nearest(value.x), row.nearest(value.y)};
    }
    else if constexpr (std::is_same_v<Value, bool>) {
      thing.*row.member = value.x >= 0.5;
    }
  });
  if constexpr (std::is_same_v<Thing, Material>) {
    if (property == with_alpha) {
      set_property(thing, "alpha", glm::dvec4(value.w));
    }
  }
}

}  // namespace

void pose(Scene &scene, const Animation &animation, double seconds)
{
  check_deformed_meshes(scene);
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
    double second = 1.0;
    if (animated.second_track) {
      animated.second_track->evaluate(seconds, {&second, 1});
    }
    const bool is_cone = animated.property == cone_property;
    value *= is_cone ? 1.0 : second;
    std::visit(
        [&]<typename T>(Handle<T> handle) {
          if (scene.pool<T>().is_live(handle)) {
            scene.edit(handle, [&](T &thing) {
              if constexpr (std::is_same_v<T, Material>) {
                for (const TextureInput &input : texture_inputs) {
                  if (input.name == animated.slot) {
                    set_property(thing.*input.slot, animated.property, value);
                    return;
                  }
                }
              }
              set_property(thing, animated.property, value);
              if constexpr (std::is_same_v<T, Lamp>) {
                const double outer = thing.spot_outer_angle;
                thing.spot_blend =
                    is_cone ? float(spot_blend(std::clamp(second, 0.0, outer), outer)) : thing.spot_blend;
              }
            });
          }
        },
        animated.target);
  }
  deform_meshes(scene);
}

}  // namespace gnomon::scene
