// SPDX-License-Identifier: MIT
#pragma once

#include "scene_properties.hh"

#include <charconv>
#include <optional>
#include <string_view>

/** Pointers "/COLLECTION/INDEX/PATH" of KHR_animation_pointer. Internal to source/gltf. */
namespace gnomon::gltf {

/** Lights are in an extension, with this prefix before "/lights". */
inline constexpr std::string_view light_pointer_prefix = "/extensions/KHR_lights_punctual";

/** A number that multiplies the emissive factor. */
inline constexpr std::string_view strength_path = "extensions/KHR_materials_emissive_strength/emissiveStrength";

/** Path of a node's visibility: whether the node and its descendants are drawn. */
inline constexpr std::string_view visibility_path = "extensions/KHR_node_visibility/visible";

/** Between the path of a texture slot and a member of its transform. */
inline constexpr std::string_view transform_path = "/extensions/KHR_texture_transform/";

/** Angle of a spot at which its light begins to fade, radians. The scene has Lamp::spot_blend for it. */
inline constexpr std::string_view inner_cone_path = "spot/innerConeAngle";

/** The parts of a pointer: "/materials/3/alphaCutoff" has the parts "materials", 3 and "alphaCutoff". */
struct PointerParts {
  std::string_view collection;
  int index = -1;
  std::string_view path;
};

/** Absent: \a pointer has another form. */
[[nodiscard]] inline std::optional<PointerParts> parts_of(std::string_view pointer)
{
  if (pointer.starts_with(light_pointer_prefix)) {
    pointer.remove_prefix(light_pointer_prefix.size());
  }
  if (!pointer.starts_with('/')) {
    return std::nullopt;
  }
  pointer.remove_prefix(1);
  const std::size_t first = pointer.find('/');
  const std::size_t second = first == pointer.npos ? first : pointer.find('/', first + 1);
  if (second == pointer.npos) {
    return std::nullopt;
  }
  PointerParts parts{pointer.substr(0, first), -1, pointer.substr(second + 1)};
  const std::string_view index = pointer.substr(first + 1, second - first - 1);
  const auto [end, error] = std::from_chars(index.data(), index.data() + index.size(), parts.index);
  return error == std::errc() && end == index.data() + index.size() ? std::optional(parts) : std::nullopt;
}

/** Calls \a visit with the collection and the row of each property that pointers may animate. */
template <typename Visit>
void for_each_animated(Visit &&visit)
{
  const auto visit_thing = [&]<typename Thing>(std::string_view collection, const Thing * /*type*/) {
    Thing::for_each_property([&](const scene::Description &row) {
      if (row.is_animated) {
        visit(collection, row);
      }
    });
  };
  visit_thing("materials", static_cast<const scene::Material *>(nullptr));
  visit_thing("cameras", static_cast<const scene::Camera *>(nullptr));
  visit_thing("lights", static_cast<const scene::Lamp *>(nullptr));
}

}  // namespace gnomon::gltf
