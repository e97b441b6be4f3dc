// SPDX-License-Identifier: MIT
#include "view_properties.hh"

#include "view_property_makers.hh"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/gtx/euler_angles.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

namespace gnomon::view {

double shown_number(double value, std::string_view unit)
{
  constexpr double steps = 1e4;
  const double shown = unit == "°" ? std::round(value * steps) / steps : value;
  // Adding 0 turns -0 into 0.
  return shown + 0.0;
}

Placement placement_of(const glm::dmat4 &parent_from_node)
{
  glm::dmat3 axes(parent_from_node);
  Placement placement{.position = glm::dvec3(parent_from_node[3]), .scale = scene::scale_of(parent_from_node)};
  if (glm::determinant(axes) < 0.0) {
    placement.scale.x = -placement.scale.x;
    axes[0] = -axes[0];
  }
  glm::dmat4 frame(1.0);
  if (glm::determinant(axes) > 0.0) {
    // The x and y axes are kept as far as the matrix has no shear.
    frame[0] = glm::dvec4(glm::normalize(axes[0]), 0.0);
    const glm::dvec3 z = glm::normalize(glm::cross(axes[0], axes[1]));
    frame[2] = glm::dvec4(z, 0.0);
    frame[1] = glm::dvec4(glm::cross(z, glm::dvec3(frame[0])), 0.0);
  }
  glm::extractEulerAngleZYX(frame, placement.rotation.z, placement.rotation.y, placement.rotation.x);
  placement.rotation *= degrees_per_radian;
  return placement;
}

glm::dmat4 placed(const glm::dmat4 &parent_from_node, const Placement &placement)
{
  const Placement before = placement_of(parent_from_node);
  glm::dmat4 moved = parent_from_node;
  if (placement.rotation != before.rotation || placement.scale != before.scale) {
    const glm::dvec3 angles = placement.rotation / degrees_per_radian;
    moved = glm::eulerAngleZYX(angles.z, angles.y, angles.x);
    for (int axis = 0; axis < 3; axis++) {
      moved[axis] *= placement.scale[axis];
    }
  }
  moved[3] = glm::dvec4(placement.position, 1.0);
  return moved;
}

std::vector<TextureLine> texture_lines(const scene::Scene &scene, const scene::Material &material)
{
  std::vector<TextureLine> lines;
  for (const scene::TextureInput &input : scene::texture_inputs) {
    const scene::Texture *texture = scene.textures().find((material.*input.slot).texture);
    const scene::Image *image = texture ? scene.images().find(texture->image) : nullptr;
    if (!image) {
      continue;
    }
    // "coat_normal_texture" becomes "Coat normal".
    std::string slot(input.name.substr(0, input.name.rfind('_')));
    std::ranges::replace(slot, '_', ' ');
    slot[0] = char(std::toupper(slot[0]));
    lines.push_back(
        {slot, fmt::format("{}{}{}x{}", image->name, image->name.empty() ? "" : ", ", image->width, image->height)});
  }
  return lines;
}

namespace {

double parse_number(const std::string &name, const std::string &word, const Limits &limits)
{
  double value = 0.0;
  const char *end = word.data() + word.size();
  const auto [after, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc() || after != end || !(value >= limits.min && value <= limits.max)) {
    throw std::runtime_error(
        fmt::format("{}: '{}' is not a number from {:.6g} to {:.6g}", name, word, limits.min, limits.max));
  }
  return value;
}

}  // namespace

template <typename T>
bool set_property(T &thing, const std::string &name, std::span<const std::string> words)
{
  const auto is_it = [&](const auto &property) {
    return name == property.name && (!property.applies || property.applies(thing));
  };
  const Properties<T> &all = properties<T>();
  if (const auto number = std::ranges::find_if(all.numbers, is_it); number != all.numbers.end()) {
    // Scripts may also write 0 for absence that is stored as 0.
    const bool is_zero = number->is_zero_absent && words.size() == 1 && words[0] == "0";
    if (number->absent && words.size() == 1 && (words[0] == number->absent || is_zero)) {
      number->remove(thing);
      return true;
    }
    if (words.size() != std::size_t(number->width)) {
      throw std::runtime_error(fmt::format("{}: takes {} numbers, not {}", name, number->width, words.size()));
    }
    const Limits limits = number->limits(thing);
    T changed = thing;
    for (int i = 0; i < number->width; i++) {
      number->set(changed, i, parse_number(name, words[std::size_t(i)], limits));
    }
    thing = std::move(changed);
    return true;
  }
  const auto choice = std::ranges::find_if(all.choices, is_it);
  if (choice == all.choices.end()) {
    return false;
  }
  const auto option = std::ranges::find(choice->options, words.size() == 1 ? words[0] : std::string(),
                                        [](const char *text) { return std::string(text); });
  if (option == choice->options.end()) {
    throw std::runtime_error(fmt::format("{}: is one of {}", name, fmt::join(choice->options, ", ")));
  }
  choice->set(thing, int(option - choice->options.begin()));
  return true;
}

template bool set_property(Placement &, const std::string &, std::span<const std::string>);
template bool set_property(scene::Node &, const std::string &, std::span<const std::string>);
template bool set_property(scene::Lamp &, const std::string &, std::span<const std::string>);
template bool set_property(scene::Camera &, const std::string &, std::span<const std::string>);
template bool set_property(ShadowOfLamp &, const std::string &, std::span<const std::string>);
template bool set_property(scene::Material &, const std::string &, std::span<const std::string>);
template bool set_property(scene::World &, const std::string &, std::span<const std::string>);
template bool set_property(WindowSettings &, const std::string &, std::span<const std::string>);

}  // namespace gnomon::view
