// SPDX-License-Identifier: MIT
#include "internal/gltf_lamp.hh"

#include "internal/gltf_camera.hh"
#include "internal/gltf_extra.hh"
#include "internal/gltf_node.hh"
#include "internal/gltf_units.hh"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <type_traits>

namespace gnomon::gltf {

using scene::AreaShape;
using scene::Lamp;
using scene::LampKind;
using scene::LampShadow;

namespace {

using std::numbers::pi;
/** Angles may have been rounded to float. */
constexpr double angle_tolerance = 1e-6;

/** Whether the extra has a meaning on \a node without a lamp. */
bool is_extra_without_lamp(const Model::Node &node, std::string_view key)
{
  return is_node_extra(key) || (node.camera >= 0 && is_camera_extra(key));
}

/** Reads the lamp on one node; every message names it. */
class LampReader : private ExtraReader {
 public:
  LampReader(const Model::Node &node, std::string name, Warnings &warnings)
      : ExtraReader(node.extras, "lamp '" + printable(name) + "'"), node_(node), warnings_(warnings)
  {
    lamp_.name = std::move(name);
  }

  Lamp read_punctual(const Model::Light &light)
  {
    lamp_.kind = punctual_kind(light.type);
    for (std::size_t i = 0; i < 3; i++) {
      lamp_.color[int(i)] = checked("color", light.color[i], range_of<Lamp>("color"));
    }
    static_cast<void>(checked("intensity", light.intensity, range_of<Lamp>("intensity", lumen_per_watt)));
    lamp_.intensity = static_cast<float>(light.intensity / lumen_per_watt);
    if (lamp_.kind == LampKind::Point || lamp_.kind == LampKind::Spot) {
      lamp_.range = checked("range", light.range.value_or(0.0), range_of<Lamp>("range"));
      if (light.range == 0.0) {
        warnings_.add(what(), "range is 0, and must be above 0; the lamp has no limit of its range");
      }
    }
    if (lamp_.kind == LampKind::Spot) {
      read_cone(light);
    }
    read_extras();
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
    read_extras();
    if (shape == "square" || shape == "disk" || find("gnomon_size_y") == nullptr) {
      lamp_.area_size_y = lamp_.area_size_x;
    }
    warn_idle_extras();
    return lamp_;
  }

 private:
  const Model::Node &node_;
  Warnings &warnings_;
  Lamp lamp_;

  /** Reads the extras of the lamp's kind that the file has. */
  void read_extras()
  {
    read_properties(unsigned(lamp_.kind), lamp_);
    read_properties(unsigned(lamp_.kind), lamp_.shadow);
    const LampShadow &shadow = lamp_.shadow;
    if (shadow.clip_start && shadow.clip_end && *shadow.clip_end <= *shadow.clip_start) {
      fail("gnomon_clip_end", text(*shadow.clip_end), "above gnomon_clip_start, " + text(*shadow.clip_start));
    }
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
    Range range = range_of<Lamp>("spot_outer_angle");
    range.max += angle_tolerance;
    const double outer = checked("outerConeAngle", light.outer_cone_angle, range);
    // glTF requires a smaller inner angle. Equal angles are accepted: Blender writes them for a hard edge.
    const double inner = checked("innerConeAngle", light.inner_cone_angle, {0.0, outer + angle_tolerance});
    lamp_.spot_outer_angle = static_cast<float>(std::min(outer, pi / 2));
    lamp_.spot_blend = static_cast<float>(scene::spot_blend(std::min(inner, outer), outer));
  }

  /** Warns about misspelt and inapplicable extras, which would have no effect. */
  void warn_idle_extras() const
  {
    for (const auto &[key, value] : extras()) {
      if (is_extra_without_lamp(node_, key)) {
        continue;
      }
      const unsigned kinds = kinds_of_extra(key);
      if (kinds == 0) {
        warnings_.add(what(), "extra '" + printable(key) + "' is unknown");
      }
      else if ((kinds & scene::bits(lamp_.kind)) == 0) {
        warnings_.add(what(), "extra '" + key + "' does not apply to this kind of lamp");
      }
    }
  }

  /** The kinds of lamps that have the extra, as bits. 0: none. */
  static unsigned kinds_of_extra(std::string_view key)
  {
    unsigned kinds = key == "gnomon_lamp" ? scene::bits(LampKind::Area, LampKind::Hemi) : 0U;
    const auto find_in = [&](const scene::Description &row) { kinds |= extra_key(row) == key ? row.extra_kinds : 0U; };
    Lamp::for_each_property(find_in);
    LampShadow::for_each_property(find_in);
    return kinds;
  }
};

}  // namespace

std::optional<Lamp> lamp_on(const File &file, int node_index, Warnings &warnings)
{
  const Model::Node &node = file.model.nodes[node_index];
  const bool is_area = node.light < 0 && node.extras.count("gnomon_lamp") > 0;
  if (node.light < 0 && !is_area) {
    const auto extra = std::find_if(node.extras.begin(), node.extras.end(),
                                    [&](const auto &each) { return !is_extra_without_lamp(node, each.first); });
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
