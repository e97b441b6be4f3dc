// SPDX-License-Identifier: MIT
#include "internal/gltf_lamp.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>

namespace gnomon::gltf {

using scene::AreaShape;
using scene::Bounds;
using scene::Camera;
using scene::CameraKind;
using scene::EsmFormat;
using scene::Lamp;
using scene::LampKind;
using scene::LampShadow;
using scene::PlacedCamera;
using scene::PlacedLamp;
using scene::ShadowKind;

namespace {

constexpr double pi = std::numbers::pi;
/** glTF's photometric units over radiometric ones, lm/W. */
constexpr double lumen_per_watt = 683.0;
/** For what has no upper limit: products of a few such numbers stay finite in float. */
constexpr double large = 1e12;
/** A positive length below it would vanish in float once squared. */
constexpr double length_min = 1e-12;
/** Angles come as rounded floats. */
constexpr double angle_tolerance = 1e-6;
/** Half the opening of a cone below it would vanish in float once squared, as 1 - cos does. */
constexpr double cone_min = 1e-9;

std::string node_name(const tinygltf::Node &node, const std::string &fallback, const char *kind, int index)
{
  if (!node.name.empty()) {
    return node.name;
  }
  return fallback.empty() ? std::string(kind) + " on node " + std::to_string(index) : fallback;
}

struct Range {
  double min;
  double max;

  [[nodiscard]] bool contains(double value) const
  {
    return value >= min && value <= max;
  }
  [[nodiscard]] std::string text() const
  {
    return "from " + gltf::text(min) + " to " + gltf::text(max);
  }
};

constexpr Range not_negative{0.0, large};
constexpr Range length_range{length_min, large};

constexpr std::string_view extra_prefix = "gnomon_";
/** Every extra that is ours, with the lamps that it is for. */
struct Extra {
  std::string_view key;
  std::initializer_list<LampKind> kinds;
};

/** Reads the lamp on one node; every message names it. */
class LampReader {
 public:
  LampReader(const tinygltf::Node &node, std::string name, Warnings &warnings)
      : extras_(node.extras), what_("lamp '" + printable(name) + "'"), warnings_(warnings)
  {
    lamp_.name = std::move(name);
  }

  Lamp read_punctual(const tinygltf::Light &light)
  {
    lamp_.kind = punctual_kind(light.type);
    if (!light.color.empty()) {
      for (int i = 0; i < 3; i++) {
        lamp_.color[i] = checked("color", light.color[i], not_negative);
      }
    }
    lamp_.intensity = static_cast<float>(checked("intensity", light.intensity, not_negative) / lumen_per_watt);
    if (lamp_.kind == LampKind::Point || lamp_.kind == LampKind::Spot) {
      lamp_.range = light.range == 0.0 ? 0.0F : checked("range", light.range, length_range);
      lamp_.radius = number("gnomon_radius", 0.0, not_negative);
    }
    if (lamp_.kind == LampKind::Sun) {
      lamp_.angle = number("gnomon_angle", 0.0, {0.0, pi});
    }
    if (lamp_.kind == LampKind::Spot) {
      read_cone(light.spot);
    }
    if (lamp_.kind != LampKind::Hemi) {
      read_shadow(lamp_.shadow);
    }
    warn_idle_extras();
    return lamp_;
  }

  Lamp read_area()
  {
    lamp_.kind = LampKind::Area;
    if (const std::string kind = string("gnomon_lamp", ""); kind != "area") {
      fail("gnomon_lamp", '\'' + printable(kind) + '\'',
           kind == "hemi" ? "on the node of a directional light" : "'area' on a node without a light");
    }
    const std::string shape = string("gnomon_shape", "rectangle");
    if (shape == "disk" || shape == "ellipse") {
      lamp_.area_shape = AreaShape::Ellipse;
    }
    else if (shape != "square" && shape != "rectangle") {
      fail("gnomon_shape", '\'' + printable(shape) + '\'', "'square', 'rectangle', 'disk' or 'ellipse'");
    }
    lamp_.area_size_x = number("gnomon_size_x", 1.0, length_range);
    lamp_.area_size_y = number("gnomon_size_y", lamp_.area_size_x, length_range);
    if (shape == "square" || shape == "disk") {
      lamp_.area_size_y = lamp_.area_size_x;
    }
    lamp_.intensity = number("gnomon_power", 1.0, not_negative);
    read_area_color();
    warn_idle_extras();
    return lamp_;
  }

 private:
  const tinygltf::Value &extras_;
  std::string what_;
  Warnings &warnings_;
  Lamp lamp_;

  [[noreturn]] void fail(std::string_view key, const std::string &value, const std::string &wanted) const
  {
    throw Fault(what_, std::string(key) + " is " + value + ", and must be " + wanted);
  }

  float checked(const char *key, double value, const Range &range) const
  {
    if (!range.contains(value)) {
      fail(key, text(value), range.text());
    }
    return static_cast<float>(value);
  }

  /** A value of the extras as a person would write it. */
  static std::string written(const tinygltf::Value &value)
  {
    if (value.IsNumber()) {
      return text(value.GetNumberAsDouble());
    }
    if (value.IsString()) {
      return '\'' + printable(value.Get<std::string>()) + '\'';
    }
    return value.IsBool() ? (value.Get<bool>() ? "true" : "false") : "an array";
  }

  [[nodiscard]] bool has(const char *key) const
  {
    return extras_.Has(key);
  }

  float number(const char *key, double fallback, const Range &range) const
  {
    if (!has(key)) {
      return static_cast<float>(fallback);
    }
    const tinygltf::Value &value = extras_.Get(key);
    if (!value.IsNumber()) {
      fail(key, written(value), "a number " + range.text());
    }
    return checked(key, value.GetNumberAsDouble(), range);
  }

  std::string string(const char *key, const char *fallback) const
  {
    if (!has(key)) {
      return fallback;
    }
    const tinygltf::Value &value = extras_.Get(key);
    if (!value.IsString()) {
      fail(key, written(value), "a string");
    }
    return value.Get<std::string>();
  }

  /** One of \a words, as its place among them is in \a Word; nothing where the key is absent. */
  template <typename Word>
  std::optional<Word> word(const char *key, std::initializer_list<std::string_view> words) const
  {
    if (!has(key)) {
      return std::nullopt;
    }
    const std::string value = string(key, "");
    const auto *const found = std::find(words.begin(), words.end(), value);
    if (found == words.end()) {
      std::string wanted;
      for (const std::string_view &each : words) {
        wanted += &each == words.begin() ? "" : &each == words.end() - 1 ? " or " : ", ";
        wanted += '\'' + std::string(each) + '\'';
      }
      fail(key, '\'' + printable(value) + '\'', wanted);
    }
    return static_cast<Word>(found - words.begin());
  }

  std::optional<float> number_if_any(const char *key, const Range &range) const
  {
    return has(key) ? std::optional(number(key, 0.0, range)) : std::nullopt;
  }

  /** Blender writes a property's whole numbers as floats too. */
  std::optional<int> texels(const char *key) const
  {
    const std::optional<float> value = number_if_any(key, {1.0, 16384.0});
    if (value && *value != std::floor(*value)) {
      fail(key, text(*value), "a whole number");
    }
    return value ? std::optional(static_cast<int>(*value)) : std::nullopt;
  }

  void read_shadow(LampShadow &shadow) const
  {
    shadow.kind = word<ShadowKind>("gnomon_shadow", {"none", "hard", "pcf", "esm", "evsm"});
    shadow.size = texels("gnomon_shadow_size");
    shadow.exponent = number_if_any("gnomon_exponent", {0.01, 1e4});
    shadow.bias = number_if_any("gnomon_bias", {0.0, 100.0});
    shadow.clip_start = number_if_any("gnomon_clip_start", length_range);
    shadow.clip_end = number_if_any("gnomon_clip_end", length_range);
    if (shadow.clip_start && shadow.clip_end && *shadow.clip_end <= *shadow.clip_start) {
      fail("gnomon_clip_end", text(*shadow.clip_end), "above gnomon_clip_start, " + text(*shadow.clip_start));
    }
    if (const std::optional<float> degrees = number_if_any("gnomon_filter_radius", {0.0, 45.0})) {
      shadow.filter_radius = static_cast<float>(*degrees * pi / 180.0);
    }
    shadow.esm_size = texels("gnomon_esm_size");
    shadow.esm_format = word<EsmFormat>("gnomon_esm_format", {"16f", "32f"});
  }

  [[nodiscard]] LampKind punctual_kind(const std::string &type) const
  {
    if (type != "directional" && type != "point" && type != "spot") {
      fail("type", '\'' + printable(type) + '\'', "'directional', 'point' or 'spot'");
    }
    if (has("gnomon_lamp")) {
      const std::string kind = string("gnomon_lamp", "");
      if (kind == "hemi" && type == "directional") {
        return LampKind::Hemi;
      }
      fail("gnomon_lamp", '\'' + printable(kind) + '\'',
           type == "directional" ? "'hemi' on a directional light" : "absent on a " + type + " light");
    }
    return type == "directional" ? LampKind::Sun : type == "point" ? LampKind::Point : LampKind::Spot;
  }

  void read_cone(const tinygltf::SpotLight &spot)
  {
    const double outer = checked("outerConeAngle", spot.outerConeAngle, {cone_min, pi / 2 + angle_tolerance});
    // glTF wants the inner angle smaller; Blender writes equal ones for a hard edge, and they make sense.
    const double inner = checked("innerConeAngle", spot.innerConeAngle, {0.0, outer + angle_tolerance});
    lamp_.spot_outer_angle = static_cast<float>(std::min(outer, pi / 2));
    lamp_.spot_blend = number("gnomon_spot_blend", derived_blend(std::min(inner, outer), outer), {0.0, 1.0});
  }

  /** (cos inner - cos outer) / (1 - cos outer), by half angles: nothing cancels however narrow the cone. */
  static double derived_blend(double inner, double outer)
  {
    const double scale = std::sin(0.5 * outer);
    const double blend = std::sin(0.5 * (outer + inner)) / scale * (std::sin(0.5 * (outer - inner)) / scale);
    return std::clamp(blend, 0.0, 1.0);
  }

  void read_area_color()
  {
    constexpr const char *key = "gnomon_color";
    if (!has(key)) {
      return;
    }
    const tinygltf::Value &value = extras_.Get(key);
    if (!value.IsArray() || value.ArrayLen() != 3) {
      fail(key, written(value), "three numbers");
    }
    for (int i = 0; i < 3; i++) {
      lamp_.color[i] = checked(key, value.Get(i).GetNumberAsDouble(), not_negative);
    }
  }

  /** A misspelt or misplaced extra would otherwise be looked for in the picture. */
  void warn_idle_extras() const
  {
    static const std::initializer_list<LampKind> casts_shadow{LampKind::Point, LampKind::Sun, LampKind::Spot};
    static const std::array<Extra, 18> known{{
        {"gnomon_radius", {LampKind::Point, LampKind::Spot}},
        {"gnomon_angle", {LampKind::Sun}},
        {"gnomon_spot_blend", {LampKind::Spot}},
        {"gnomon_lamp", {LampKind::Area, LampKind::Hemi}},
        {"gnomon_shape", {LampKind::Area}},
        {"gnomon_size_x", {LampKind::Area}},
        {"gnomon_size_y", {LampKind::Area}},
        {"gnomon_power", {LampKind::Area}},
        {"gnomon_color", {LampKind::Area}},
        {"gnomon_shadow", casts_shadow},
        {"gnomon_shadow_size", casts_shadow},
        {"gnomon_exponent", casts_shadow},
        {"gnomon_bias", casts_shadow},
        {"gnomon_clip_start", casts_shadow},
        {"gnomon_clip_end", casts_shadow},
        {"gnomon_filter_radius", casts_shadow},
        {"gnomon_esm_size", casts_shadow},
        {"gnomon_esm_format", casts_shadow},
    }};
    for (const std::string &key : extras_.Keys()) {
      const auto extra = std::find_if(known.begin(), known.end(), [&](const Extra &e) { return e.key == key; });
      if (extra == known.end()) {
        warnings_.add(what_, "extra '" + printable(key) + "' is unknown");
      }
      else if (std::find(extra->kinds.begin(), extra->kinds.end(), lamp_.kind) == extra->kinds.end()) {
        warnings_.add(what_, "extra '" + key + "' does not apply to this kind of lamp");
      }
    }
  }
};

/** Index of the light on a node, -1 without. */
int light_index(const tinygltf::Node &node)
{
  const auto found = node.extensions.find("KHR_lights_punctual");
  if (found == node.extensions.end() || !found->second.Has("light")) {
    return -1;
  }
  return found->second.Get("light").GetNumberAsInt();
}

/** What is wrong with a camera's numbers; empty: nothing. Called with the floats that will be used. */
std::string camera_fault(const Camera &camera)
{
  const bool is_perspective = camera.kind == CameraKind::Perspective;
  const auto is_length = [](float value) { return value >= length_min && value <= large; };
  if (is_perspective && !(camera.vertical_angle > 1e-6F && camera.vertical_angle < static_cast<float>(pi))) {
    return "yfov " + text(camera.vertical_angle) + " is not between 0 and pi";
  }
  if (is_perspective && camera.aspect != 0.0F && !(camera.aspect >= 1e-6F && camera.aspect <= 1e6F)) {
    return "aspectRatio " + text(camera.aspect) + " is out of range";
  }
  if (!is_perspective && !(is_length(camera.half_width) && is_length(camera.half_height))) {
    return "xmag " + text(camera.half_width) + " and ymag " + text(camera.half_height) + " must be above 0";
  }
  if (is_perspective ? !is_length(camera.near) : !(camera.near >= 0.0F && camera.near <= large)) {
    return "znear " + text(camera.near) + " is out of range";
  }
  const bool is_infinite = is_perspective && camera.far == 0.0F;
  if (!is_infinite && !(camera.far > camera.near && is_length(camera.far))) {
    return "zfar " + text(camera.far) + " is not above znear " + text(camera.near) + ", or out of range";
  }
  return {};
}

/**
 * Out of float's range becomes its limit, which the checks then refuse; a plain cast would be undefined. What is not 0
 * stays so: 0 has a meaning of its own.
 */
float narrowed(double value)
{
  constexpr double max = std::numeric_limits<float>::max();
  constexpr double least = std::numeric_limits<float>::denorm_min();
  return static_cast<float>(std::copysign(std::clamp(std::abs(value), value == 0.0 ? 0.0 : least, max), value));
}

/** A frame that looks along the unit vector \a forward. */
glm::dmat4 looking(const glm::dvec3 &position, const glm::dvec3 &forward, const glm::dvec3 &up)
{
  const glm::dmat4 skewed(glm::dvec4(0.0), glm::dvec4(up, 0.0), glm::dvec4(-forward, 0.0), glm::dvec4(position, 1.0));
  return scene::frame_of(skewed);
}

}  // namespace

std::optional<Lamp> lamp_on(const File &file, int node_index, Warnings &warnings)
{
  const tinygltf::Node &node = file.model.nodes[node_index];
  const int light = light_index(node);
  const std::vector<std::string> keys = node.extras.Keys();
  const bool has_extras =
      std::any_of(keys.begin(), keys.end(), [](const std::string &key) { return key.rfind(extra_prefix, 0) == 0; });
  if (light < 0 && !node.extras.Has("gnomon_lamp")) {
    if (has_extras) {
      warnings.add(label("node", node.name, static_cast<std::size_t>(node_index)),
                   "extra '" + printable(keys.front()) + "' has no effect: the node is not a lamp");
    }
    return std::nullopt;
  }
  const std::string fallback = light < 0 ? std::string() : file.model.lights[light].name;
  LampReader reader(node, node_name(node, fallback, "lamp", node_index), warnings);
  Lamp lamp = light < 0 ? reader.read_area() : reader.read_punctual(file.model.lights[light]);
  return lamp;
}

std::optional<Camera> camera_on(const File &file, int node_index, Warnings &warnings)
{
  const tinygltf::Node &node = file.model.nodes[node_index];
  if (node.camera < 0) {
    return std::nullopt;
  }
  const tinygltf::Camera &source = file.model.cameras[node.camera];
  Camera camera;
  camera.name = node_name(node, source.name, "camera", node_index);
  if (source.type == "perspective") {
    camera.vertical_angle = narrowed(source.perspective.yfov);
    camera.aspect = narrowed(source.perspective.aspectRatio);
    camera.near = narrowed(source.perspective.znear);
    camera.far = narrowed(source.perspective.zfar);
  }
  else {
    camera.kind = CameraKind::Orthographic;
    camera.half_width = narrowed(source.orthographic.xmag);
    camera.half_height = narrowed(source.orthographic.ymag);
    camera.near = narrowed(source.orthographic.znear);
    camera.far = narrowed(source.orthographic.zfar);
  }
  if (const std::string fault = camera_fault(camera); !fault.empty()) {
    warnings.add("camera '" + printable(camera.name) + '\'', "left out: " + fault);
    return std::nullopt;
  }
  return camera;
}

PlacedCamera default_camera(const Bounds &bounds)
{
  PlacedCamera camera;
  camera.name = "default";
  const glm::dvec3 center = bounds.is_empty() ? glm::dvec3(0.0) : glm::dvec3(bounds.center());
  // At least the spacing of floats at the scene's position, and the least length.
  const double reach = glm::length(center);
  const double radius = bounds.is_empty() ? 1.0 : std::max({double(bounds.radius()), 1e-6 * reach, 1e3 * length_min});
  const glm::dvec3 forward = glm::normalize(glm::dvec3(-0.6, -0.45, -1.0));
  // The sphere around the scene fits, with a margin, into a frame that is at least as wide as high.
  const double distance = 1.05 * radius / std::sin(0.5 * double(camera.vertical_angle));
  camera.world_from_camera = looking(center - distance * forward, forward, {0, 1, 0});
  camera.near = static_cast<float>(0.5 * (distance - radius));
  camera.far = static_cast<float>(distance + 2.0 * radius);
  return camera;
}

PlacedLamp default_sun(const PlacedCamera &camera)
{
  PlacedLamp sun;
  sun.name = "default";
  sun.kind = LampKind::Sun;
  // A white surface that faces it has radiance 1.
  sun.intensity = static_cast<float>(pi);
  const glm::dmat4 &view = camera.world_from_camera;
  const glm::dvec3 right(view[0]);
  const glm::dvec3 up(view[1]);
  const glm::dvec3 forward = -glm::dvec3(view[2]);
  // From above and from the left of the camera.
  sun.world_from_lamp = looking(glm::dvec3(view[3]), glm::normalize(forward + 0.5 * right - 0.8 * up), up);
  return sun;
}

}  // namespace gnomon::gltf
