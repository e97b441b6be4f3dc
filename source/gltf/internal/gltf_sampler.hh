// SPDX-License-Identifier: MIT
#pragma once

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** OpenGL's enumerants, which glTF's samplers use. */
constexpr int gl_nearest = 9728;
constexpr int gl_linear = 9729;
constexpr int gl_nearest_mipmap_nearest = 9984;
constexpr int gl_linear_mipmap_nearest = 9985;
constexpr int gl_nearest_mipmap_linear = 9986;
constexpr int gl_linear_mipmap_linear = 9987;
constexpr int gl_repeat = 10497;
constexpr int gl_clamp_to_edge = 33071;
constexpr int gl_mirrored_repeat = 33648;

}  // namespace gnomon::gltf
