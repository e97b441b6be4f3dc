// SPDX-License-Identifier: MIT
#pragma once

#include "gltf/gltf_check.hh"
#include "image_file.hh"

#include <cstdint>
#include <string>
#include <vector>

namespace gnomon::test {

using Bytes = std::vector<std::uint8_t>;

inline std::string data_uri(const Bytes &bytes)
{
  return "data:image/png;base64," + base64(bytes);
}

/** Two by two texels with different colours and alphas. */
inline const Bytes four_texels{255, 0, 0, 255, 0, 200, 10, 128, 20, 30, 240, 64, 90, 80, 70, 0};

inline Bytes four_texel_png()
{
  return image_file("png", 2, 2, 4, four_texels);
}

inline const std::vector<float> triangle_uvs{0, 0, 1, 0, 0.25F, 0.75F};

/** A triangle whose material uses texture 0 (image 0) at TEXCOORD_0. */
inline GltfBuilder textured_triangle(const json &image)
{
  GltfBuilder builder;
  const int mesh = builder.mesh({{"attributes",
                                  {{"POSITION", builder.positions(triangle_positions)},
                                   {"TEXCOORD_0", builder.accessor(triangle_uvs, Float32, "VEC2")}}},
                                 {"material", 0}});
  builder.node({{"mesh", mesh}});
  builder.append("materials", {{"name", "paint"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  builder.append("textures", {{"source", 0}});
  builder.append("images", image);
  return builder;
}

inline GltfBuilder textured_triangle()
{
  return textured_triangle({{"name", "leaf"}, {"uri", data_uri(four_texel_png())}});
}

}  // namespace gnomon::test
