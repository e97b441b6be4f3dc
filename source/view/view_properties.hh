// SPDX-License-Identifier: MIT
#pragma once

#include "view_settings.hh"

#include "scene.hh"

#include <algorithm>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/** The editable properties of things, as tables: panels show them, and scripts set them by name. */
namespace gnomon::view {

struct Limits {
  double min = 0.0;
  double max = 0.0;
};

/**
 * The number that a field shows for a value. The nearest multiple of 0.0001 for angles, which are degrees: smaller
 * parts are the rounding of matrices, and would be shown as 1.84e-05. -0 is 0.
 */
[[nodiscard]] double shown_number(double value, std::string_view unit);

/** A property of one or three numbers, in the units of the user interface. */
template <typename T>
struct NumberProperty {
  /** Name in scripts. */
  const char *name;
  const char *label;
  std::function<const char *(const T &)> unit;
  int width;
  double min;
  double max;
  std::function<double(const T &, int)> get;
  std::function<void(T &, int, double)> set;
  bool is_color = false;
  /** Whether the property applies to a thing. Empty: always. */
  std::function<bool(const T &)> applies{};
  /** Narrower limits, which depend on other values of the thing. Empty: min and max. */
  std::function<Limits(const T &)> narrowed{};
  /**
   * The word for a thing without the number, in panels and in scripts; nullptr: things always have it. `get` is the
   * number to begin with where a thing has none.
   */
  const char *absent = nullptr;
  std::function<bool(const T &)> is_absent{};
  /** Absence is stored as 0; scripts may also write 0. */
  bool is_zero_absent = false;
  std::function<void(T &)> remove{};
  /** The word for 0 at the lower end of a slider with a logarithmic scale; nullptr: the row is no slider. */
  const char *slider_zero = nullptr;
  /** Header above the property in the panel. Empty: none. */
  const char *group = "";

  [[nodiscard]] Limits limits(const T &thing) const
  {
    Limits limits = narrowed ? narrowed(thing) : Limits{min, max};
    // Narrowed limits may exclude each other.
    limits.max = std::max(limits.min, limits.max);
    return limits;
  }
};

/** A choice of one option. The options "off" and "on" are shown as a check box. */
template <typename T>
struct ChoiceProperty {
  const char *name;
  const char *label;
  std::vector<const char *> options;
  std::function<int(const T &)> get;
  std::function<void(T &, int)> set;
  std::function<bool(const T &)> applies{};
  const char *group = "";
};

template <typename T>
struct Properties {
  std::vector<ChoiceProperty<T>> choices;
  std::vector<NumberProperty<T>> numbers;
};

/** Position, rotation and scale of a node in its parent. */
struct Placement {
  /** Metres. */
  glm::dvec3 position{0.0};
  /** Degrees: around x first, then y, then z. */
  glm::dvec3 rotation{0.0};
  /** Negative along x for a mirrored node. */
  glm::dvec3 scale{1.0};

  bool operator==(const Placement &) const = default;
};
/** Decompose a matrix. Its shear is ignored. */
[[nodiscard]] Placement placement_of(const glm::dmat4 &parent_from_node);
/**
 * \a parent_from_node with a new placement. A changed rotation or scale removes the shear; a changed position keeps it.
 */
[[nodiscard]] glm::dmat4 placed(const glm::dmat4 &parent_from_node, const Placement &placement);

/** The shadow of a lamp, with the values that decide which of its settings have an effect. */
struct ShadowOfLamp {
  scene::LampKind lamp = scene::LampKind::Point;
  /** The kind for lamps without one of their own. */
  scene::ShadowKind scene_kind = scene::ShadowKind::Hard;
  scene::LampShadow shadow{};
};

/** A texture of a material, as text. */
struct TextureLine {
  std::string slot;
  std::string image;

  bool operator==(const TextureLine &) const = default;
};
[[nodiscard]] std::vector<TextureLine> texture_lines(const scene::Scene &scene, const scene::Material &material);

/**
 * The properties of T: Placement, scene::Node, scene::Lamp, ShadowOfLamp, scene::Camera, scene::Material, scene::World
 * and WindowSettings.
 */
template <typename T>
[[nodiscard]] const Properties<T> &properties();

/**
 * Set the property \a name of \a thing from the words of a script. \return false if \a T has no such property or it
 * does not apply \throws std::runtime_error if \a words are neither the right count of numbers within the limits, nor
 * the text for absence, nor an option
 */
template <typename T>
bool set_property(T &thing, const std::string &name, std::span<const std::string> words);

}  // namespace gnomon::view
