// SPDX-License-Identifier: MIT
#pragma once

#include "scene_animation.hh"

#include <array>
#include <string_view>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** A supported pointer "/COLLECTION/INDEX/PATH" of KHR_animation_pointer, without the index. */
struct Pointer {
  std::string_view collection;
  std::string_view path;
  scene::AnimatedProperty property;
};

inline constexpr std::array<Pointer, 14> pointers = {{
    {"materials", "pbrMetallicRoughness/baseColorFactor", scene::AnimatedProperty::BaseColor},
    {"materials", "pbrMetallicRoughness/metallicFactor", scene::AnimatedProperty::Metallic},
    {"materials", "pbrMetallicRoughness/roughnessFactor", scene::AnimatedProperty::Roughness},
    {"materials", "emissiveFactor", scene::AnimatedProperty::Emissive},
    {"materials", "extensions/KHR_materials_emissive_strength/emissiveStrength", scene::AnimatedProperty::Emissive},
    {"materials", "alphaCutoff", scene::AnimatedProperty::AlphaCutoff},
    {"materials", "normalTexture/scale", scene::AnimatedProperty::NormalScale},
    {"materials", "occlusionTexture/strength", scene::AnimatedProperty::OcclusionStrength},
    {"cameras", "perspective/yfov", scene::AnimatedProperty::VerticalAngle},
    {"cameras", "orthographic/xmag", scene::AnimatedProperty::HalfWidth},
    {"cameras", "orthographic/ymag", scene::AnimatedProperty::HalfHeight},
    {"lights", "color", scene::AnimatedProperty::LampColor},
    {"lights", "intensity", scene::AnimatedProperty::LampIntensity},
    {"lights", "range", scene::AnimatedProperty::LampRange},
}};

/** Lights are in an extension, with this prefix before "/lights". */
inline constexpr std::string_view light_pointer_prefix = "/extensions/KHR_lights_punctual";

}  // namespace gnomon::gltf
