// SPDX-License-Identifier: MIT
#include "internal/gltf_lamp.hh"

#include "internal/gltf_extra.hh"
#include "internal/gltf_node.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <string>
#include <string_view>

namespace gnomon::gltf {

using scene::AreaShape;
using scene::EsmFormat;
using scene::Lamp;
using scene::LampKind;
using scene::LampShadow;
using scene::ShadowKind;

namespace {

using std::numbers::pi;
/** Angles may have been rounded to float. */
constexpr double angle_tolerance = 1e-6;
/** Smallest half angle of a cone, rad. For smaller angles 1 - cos would underflow in float. */
constexpr double cone_min = 1e-9;

/** All supported extras, with the lamps to which they apply. */
struct Extra {
  std::string_view key;
  std::initializer_list<LampKind> kinds;
};

/** Reads the lamp on one node; every message names it. */
class LampReader : private ExtraReader {
 public:
  LampReader(const Model::Node &node, std::string name, Warnings &warnings)
      : ExtraReader(node.extras, "lamp '" + printable(name) + "'"), warnings_(warnings)
  {
    lamp_.name = std::move(name);
  }

  Lamp read_punctual(const Model::Light &light)
  {
    lamp_.kind = punctual_kind(light.type);
    for (std::size_t i = 0; i < 3; i++) {
      lamp_.color[int(i)] = checked("color", light.color[i], not_negative);
    }
    static_cast<void>(checked("intensity", light.intensity, not_negative));
    lamp_.intensity = static_cast<float>(light.intensity / lumen_per_watt);
    if (lamp_.kind == LampKind::Point || lamp_.kind == LampKind::Spot) {
      lamp_.range = light.range == 0.0 ? 0.0F : checked("range", light.range, length_range);
      lamp_.radius = number("gnomon_radius", 0.0, not_negative);
    }
    if (lamp_.kind == LampKind::Sun) {
      lamp_.angle = number("gnomon_angle", 0.0, {0.0, pi});
    }
    if (lamp_.kind == LampKind::Spot) {
      read_cone(light);
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
    lamp_.color = color("gnomon_color", lamp_.color, not_negative);
    read_shadow(lamp_.shadow);
    warn_idle_extras();
    return lamp_;
  }

 private:
  Warnings &warnings_;
  Lamp lamp_;

  /** The enumerator of \a Word at the index of the extra's value in \a words; empty if the key is absent. */
  template <typename Word>
  std::optional<Word> word(const char *key, std::initializer_list<std::string_view> words) const
  {
    if (find(key) == nullptr) {
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

  std::optional<float> float_if_any(const char *key, const Range &range) const
  {
    const std::optional<double> value = number_if_any(key, range);
    return value ? std::optional(static_cast<float>(*value)) : std::nullopt;
  }

  std::optional<int> texels(const char *key) const
  {
    return whole_if_any(key, {1.0, 16384.0});
  }

  void read_shadow(LampShadow &shadow) const
  {
    shadow.kind = word<ShadowKind>("gnomon_shadow", {"none", "hard", "pcf", "esm", "evsm"});
    shadow.size = texels("gnomon_shadow_size");
    shadow.exponent = float_if_any("gnomon_exponent", {0.01, 1e4});
    shadow.bias = float_if_any("gnomon_bias", {0.0, 100.0});
    shadow.clip_start = float_if_any("gnomon_clip_start", length_range);
    shadow.clip_end = float_if_any("gnomon_clip_end", length_range);
    if (shadow.clip_start && shadow.clip_end && *shadow.clip_end <= *shadow.clip_start) {
      fail("gnomon_clip_end", text(*shadow.clip_end), "above gnomon_clip_start, " + text(*shadow.clip_start));
    }
    if (const std::optional<double> degrees = number_if_any("gnomon_filter_radius", {0.0, 45.0})) {
      shadow.filter_angle = static_cast<float>(*degrees * pi / 180.0);
    }
    shadow.esm_size = texels("gnomon_esm_size");
    shadow.esm_format = word<EsmFormat>("gnomon_esm_format", {"16f", "32f"});
  }

  [[nodiscard]] LampKind punctual_kind(const std::string &type) const
  {
    if (type != "directional" && type != "point" && type != "spot") {
      fail("type", '\'' + printable(type) + '\'', "'directional', 'point' or 'spot'");
    }
    if (find("gnomon_lamp") != nullptr) {
      const std::string kind = string("gnomon_lamp", "");
      if (kind == "hemi" && type == "directional") {
        return LampKind::Hemi;
      }
      fail("gnomon_lamp", '\'' + printable(kind) + '\'',
           type == "directional" ? "'hemi' on a directional light" : "absent on a " + type + " light");
    }
    return type == "directional" ? LampKind::Sun : type == "point" ? LampKind::Point : LampKind::Spot;
  }

  void read_cone(const Model::Light &light)
  {
    const double outer = checked("outerConeAngle", light.outer_cone_angle, {cone_min, pi / 2 + angle_tolerance});
    // glTF requires a smaller inner angle. Equal angles are accepted: Blender writes them for a hard edge.
    const double inner = checked("innerConeAngle", light.inner_cone_angle, {0.0, outer + angle_tolerance});
    lamp_.spot_outer_angle = static_cast<float>(std::min(outer, pi / 2));
    lamp_.spot_blend = number("gnomon_spot_blend", derived_blend(std::min(inner, outer), outer), {0.0, 1.0});
  }

  /** (cos inner - cos outer) / (1 - cos outer), computed from half angles without cancellation in narrow cones. */
  static double derived_blend(double inner, double outer)
  {
    const double scale = std::sin(0.5 * outer);
    const double blend = std::sin(0.5 * (outer + inner)) / scale * (std::sin(0.5 * (outer - inner)) / scale);
    return std::clamp(blend, 0.0, 1.0);
  }

  /** Warns about misspelt and inapplicable extras, which would have no effect. */
  void warn_idle_extras() const
  {
    static const std::initializer_list<LampKind> casts_shadow{LampKind::Point, LampKind::Sun, LampKind::Spot,
                                                              LampKind::Area};
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
    for (const auto &[key, value] : extras()) {
      if (is_node_extra(key)) {
        continue;
      }
      const std::string_view name = key;
      const auto extra = std::find_if(known.begin(), known.end(), [&](const Extra &e) { return e.key == name; });
      if (extra == known.end()) {
        warnings_.add(what(), "extra '" + printable(key) + "' is unknown");
      }
      else if (std::find(extra->kinds.begin(), extra->kinds.end(), lamp_.kind) == extra->kinds.end()) {
        warnings_.add(what(), "extra '" + key + "' does not apply to this kind of lamp");
      }
    }
  }
};

}  // namespace

std::optional<Lamp> lamp_on(const File &file, int node_index, Warnings &warnings)
{
  const Model::Node &node = file.model.nodes[node_index];
  const bool is_area = node.light < 0 && node.extras.count("gnomon_lamp") > 0;
  if (node.light < 0 && !is_area) {
    const auto extra = std::find_if(node.extras.begin(), node.extras.end(),
                                    [](const auto &each) { return !is_node_extra(each.first); });
    if (extra != node.extras.end()) {
      warnings.add(label("node", node.name, static_cast<std::size_t>(node_index)),
                   "extra '" + printable(extra->first) + "' has no effect: the node is not a lamp");
    }
    return std::nullopt;
  }
  const std::string fallback = is_area ? std::string() : file.model.lights[node.light].name;
  LampReader reader(node, thing_name(node, "gnomon_lamp_name", fallback, "lamp", node_index), warnings);
  return is_area ? reader.read_area() : reader.read_punctual(file.model.lights[node.light]);
}

}  // namespace gnomon::gltf
