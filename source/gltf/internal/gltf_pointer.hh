// SPDX-License-Identifier: MIT
#pragma once

#include "scene_properties.hh"

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
