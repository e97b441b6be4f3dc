// SPDX-License-Identifier: MIT
#pragma once

#include "view_settings.hh"

#include "scene.hh"

#include <algorithm>
#include <functional>
#include <span>
#include <string>
#include <vector>

/** What can be edited of a thing, as tables: panels show them, and scripts set them by name. */
namespace gnomon::view {

struct Limits {
  double min = 0.0;
  double max = 0.0;
};

/** One or three numbers, in the units in which they are shown. */
template <typename T>
struct NumberProperty {
  /** In scripts. */
  const char *name;
  const char *label;
  std::function<const char *(const T &)> unit;
  int width;
  double min;
  double max;
  std::function<double(const T &, int)> get;
  std::function<void(T &, int, double)> set;
  bool is_color = false;
  /** Empty: always. */
  std::function<bool(const T &)> applies{};
  /** Narrower limits that other values of a thing leave; empty: min and max. */
  std::function<Limits(const T &)> narrowed{};
  /**
   * What a thing without the number has instead, in panels and in scripts; nullptr: things always have it. `get` is the
   * number to begin with where a thing has none.
   */
  const char *absent = nullptr;
  std::function<bool(const T &)> is_absent{};
  /** Absence is stored as 0, and scripts may write 0 for it. */
  bool is_zero_absent = false;
  std::function<void(T &)> remove{};
  /** It is a slider with a logarithmic scale, and this stands for 0 at its lower end; nullptr: it is none. */
  const char *slider_zero = nullptr;
  /** A header that the panel shows it under. Empty: none. */
  const char *group = "";

  [[nodiscard]] Limits limits(const T &thing) const
  {
    Limits limits = narrowed ? narrowed(thing) : Limits{min, max};
    // Other values may leave nothing between them.
    limits.max = std::max(limits.min, limits.max);
    return limits;
  }
};

/** One of several. With two options, "off" and "on", a check box. */
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
  /** A mirrored node's is negative along x. */
  glm::dvec3 scale{1.0};

  bool operator==(const Placement &) const = default;
};
/** A shear of the matrix is not part of it. */
[[nodiscard]] Placement placement_of(const glm::dmat4 &parent_from_node);
/** \a parent_from_node with another placement. Only another rotation or scale removes its shear. */
[[nodiscard]] glm::dmat4 placed(const glm::dmat4 &parent_from_node, const Placement &placement);

/** The shadow of a lamp, and what decides which of its settings have an effect. */
struct ShadowOfLamp {
  scene::LampKind lamp = scene::LampKind::Point;
  /** Of lamps without a kind of their own. */
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

/** For Placement, scene::Node, scene::Lamp, ShadowOfLamp, scene::Camera, scene::Material, scene::World and Settings. */
template <typename T>
[[nodiscard]] const Properties<T> &properties();

/**
 * Set the property \a name of \a thing to what \a words say, as scripts do.
 * \return false: \a T has no such property, or it does not apply
 * \throws std::runtime_error where the words are neither as many numbers within the limits nor the text for
 * their absence, or none of the options
 */
template <typename T>
bool set_property(T &thing, const std::string &name, std::span<const std::string> words);

}  // namespace gnomon::view
