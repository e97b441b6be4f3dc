// SPDX-License-Identifier: MIT
#include "internal/gltf_write_lamp.hh"

#include "internal/gltf_report.hh"
#include "internal/gltf_units.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gnomon::gltf {

using scene::Camera;
using scene::CameraKind;
using scene::Lamp;
using scene::LampKind;
using scene::LampShadow;

namespace {

using std::numbers::pi;

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

void add_shadow_extras(const LampShadow &shadow, const std::string &what, JsonText &extras)
{
  constexpr std::array<std::string_view, 5> kinds{"none", "hard", "pcf", "esm", "evsm"};
  constexpr std::array<std::string_view, 2> formats{"16f", "32f"};
  const auto add = [&](std::string_view key, const auto &value) {
    if (value) {
      extras.add(key, json_number(*value, what));
    }
  };
  const auto as_double = [](const auto &value) { return value ? std::optional<double>(*value) : std::nullopt; };
  if (shadow.kind) {
    extras.add("gnomon_shadow", quoted_word(kinds.at(std::size_t(*shadow.kind))));
  }
  add("gnomon_shadow_size", as_double(shadow.size));
  add("gnomon_exponent", shadow.exponent);
  add("gnomon_bias", shadow.bias);
  add("gnomon_clip_start", shadow.clip_start);
  add("gnomon_clip_end", shadow.clip_end);
  if (shadow.filter_angle) {
    // π/4 in float is above 45 degrees.
    const double degrees = double(*shadow.filter_angle) * 180.0 / pi;
    extras.add("gnomon_filter_radius", json_number(degrees > 45.0 && degrees < 45.00001 ? 45.0 : degrees, what));
  }
  add("gnomon_esm_size", as_double(shadow.esm_size));
  if (shadow.esm_format) {
    extras.add("gnomon_esm_format", quoted_word(formats.at(std::size_t(*shadow.esm_format))));
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
  return json.object();
}

void add_lamp_extras(const Lamp &lamp, JsonText &extras)
{
  const std::string what = what_of("lamp", lamp.name);
  switch (lamp.kind) {
    case LampKind::Spot: extras.add("gnomon_spot_blend", json_number(lamp.spot_blend, what)); [[fallthrough]];
    case LampKind::Point:
      if (lamp.radius != 0.0F) {
        extras.add("gnomon_radius", json_number(lamp.radius, what));
      }
      break;
    case LampKind::Sun:
      if (lamp.angle != 0.0F) {
        // π in float is above π.
        extras.add("gnomon_angle", lamp.angle == float(pi) ? json_number(pi, what) : json_number(lamp.angle, what));
      }
      break;
    case LampKind::Hemi: extras.add("gnomon_lamp", "\"hemi\""); break;
    case LampKind::Area:
      extras.add("gnomon_lamp", "\"area\"");
      extras.add("gnomon_shape", lamp.area_shape == scene::AreaShape::Rectangle ? "\"rectangle\"" : "\"ellipse\"");
      extras.add("gnomon_size_x", json_number(lamp.area_size_x, what));
      extras.add("gnomon_size_y", json_number(lamp.area_size_y, what));
      extras.add("gnomon_power", json_number(lamp.intensity, what));
      extras.add("gnomon_color", json_numbers(lamp.color, what));
      break;
  }
  if (lamp.kind != LampKind::Hemi) {
    add_shadow_extras(lamp.shadow, what, extras);
  }
}

}  // namespace gnomon::gltf
