// SPDX-License-Identifier: MIT
#include "internal/gltf_write_lamp.hh"

#include "internal/gltf_extra.hh"
#include "internal/gltf_foreign_extras.hh"
#include "internal/gltf_report.hh"
#include "internal/gltf_units.hh"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace gnomon::gltf {

using scene::Camera;
using scene::CameraKind;
using scene::Lamp;
using scene::LampKind;

namespace {

std::string quoted_word(std::string_view word)
{
  return '"' + std::string(word) + '"';
}

/** Inner cone angle, from which the importer computes the same gnomon_spot_blend. */
double inner_angle(const Lamp &lamp)
{
  const double outer = lamp.spot_outer_angle;
  const double blend = std::clamp(double(lamp.spot_blend), 0.0, 1.0);
  // Uses half angles to avoid cancellation in narrow cones.
  const double half_sine = std::sin(0.5 * outer) * std::sqrt(1.0 - blend);
  return std::clamp(2.0 * std::asin(half_sine), 0.0, outer);
}

/** The value of a property in the extras; empty: absent. */
template <typename Value>
std::string extra_value(const scene::Description &row, const Value &value, const std::string &what)
{
  if constexpr (requires { value.has_value(); }) {
    return value ? extra_value(row, *value, what) : "";
  }
  else if constexpr (std::is_enum_v<Value>) {
    return quoted_word(scene::words<Value>.at(std::size_t(value)));
  }
  else if constexpr (std::is_same_v<Value, glm::vec3>) {
    return json_numbers(value, what);
  }
  else if constexpr (std::is_same_v<Value, float>) {
    return row.is_extra_in_degrees ? json_number(double(value) * extra_factor(row), what) : json_number(value, what);
  }
  else {
    return json_number(double(value), what);
  }
}

}  // namespace

std::string camera_json(const Camera &camera)
{
  const std::string what = what_of("camera", camera.name);
  const bool is_perspective = camera.kind == CameraKind::Perspective;
  JsonText lens;
  if (is_perspective) {
    lens.add("yfov", json_number(camera.vertical_angle, what));
    if (camera.aspect != 0.0F) {
      lens.add("aspectRatio", json_number(camera.aspect, what));
    }
  }
  else {
    lens.add("xmag", json_number(camera.half_width, what));
    lens.add("ymag", json_number(camera.half_height, what));
  }
  lens.add("znear", json_number(camera.near, what));
  if (!is_perspective || camera.far != 0.0F) {
    lens.add("zfar", json_number(camera.far, what));
  }
  const std::string_view type = is_perspective ? "perspective" : "orthographic";
  JsonText json;
  json.add("name", json_string(camera.name, what));
  json.add("type", quoted_word(type));
  json.add(type, lens.object());
  add_extras({}, {camera.extras}, what, json);
  return json.object();
}

std::string light_json(const Lamp &lamp)
{
  const std::string what = what_of("lamp", lamp.name);
  const bool is_spot = lamp.kind == LampKind::Spot;
  const bool is_point = lamp.kind == LampKind::Point;
  JsonText json;
  json.add("name", json_string(lamp.name, what));
  json.add("type", is_spot ? "\"spot\"" : is_point ? "\"point\"" : "\"directional\"");
  json.add("color", json_numbers(lamp.color, what));
  json.add("intensity", json_number(double(lamp.intensity) * lumen_per_watt, what));
  if ((is_spot || is_point) && lamp.range != 0.0F) {
    json.add("range", json_number(lamp.range, what));
  }
  if (is_spot) {
    JsonText spot;
    spot.add("innerConeAngle", json_number(inner_angle(lamp), what));
    spot.add("outerConeAngle", json_number(lamp.spot_outer_angle, what));
    json.add("spot", spot.object());
  }
  add_extras({}, {lamp.extras}, what, json);
  return json.object();
}

void add_camera_extras(const Camera &camera, JsonText &extras)
{
  const std::string what = what_of("camera", camera.name);
  Camera::for_each_property([&](const auto &row) {
    if constexpr (!std::is_same_v<typename std::decay_t<decltype(row)>::Value, std::string>) {
      if (row.has_extra(unsigned(camera.kind)) && camera.*row.member != Camera().*row.member) {
        extras.add(extra_key(row), extra_value(row, camera.*row.member, what));
      }
    }
  });
}

void add_lamp_extras(const Lamp &lamp, JsonText &extras)
{
  const std::string what = what_of("lamp", lamp.name);
  if (lamp.kind == LampKind::Hemi || lamp.kind == LampKind::Area) {
    extras.add("gnomon_lamp", quoted_word(scene::words<LampKind>.at(std::size_t(lamp.kind))));
  }
  const auto add_part = [&](const auto &part) {
    using Part = std::decay_t<decltype(part)>;
    Part::for_each_property([&](const auto &row) {
      if constexpr (!std::is_same_v<typename std::decay_t<decltype(row)>::Value, std::string>) {
        // Without it, the importer has the default; but a blend follows from the cone, and an area's size y from x.
        const bool is_implied =
            lamp.kind != LampKind::Area && row.name != "spot_blend" && part.*row.member == Part().*row.member;
        const std::string value = extra_value(row, part.*row.member, what);
        if (row.has_extra(unsigned(lamp.kind)) && !is_implied && !value.empty()) {
          extras.add(extra_key(row), value);
        }
      }
    });
  };
  add_part(lamp);
  add_part(lamp.shadow);
}

}  // namespace gnomon::gltf
