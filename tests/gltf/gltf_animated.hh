// SPDX-License-Identifier: MIT
#pragma once

#include "gltf/gltf_check.hh"

#include <cstdint>
#include <string>
#include <vector>

/** Files with animations, for tests. */
namespace gnomon::test {

/** Adds a channel with a sampler of its own to the first animation. */
inline void add_channel(GltfBuilder &builder, const json &target, const std::vector<float> &times,
                        const std::vector<float> &values, const std::string &type,
                        const std::string &interpolation = "LINEAR")
{
  json &animation = builder.document["animations"][0];
  const int input = builder.accessor(times, Float32, "SCALAR");
  const int output = builder.accessor(values, Float32, type);
  animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
  animation["channels"].push_back({{"sampler", animation["samplers"].size() - 1}, {"target", target}});
}

/** The triangle with its first corner bound to the first joint, and the others to the second. */
inline GltfBuilder skinned_triangle()
{
  GltfBuilder builder = triangle_scene();
  json &attributes = builder.document["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] =
      builder.accessor(std::vector<std::uint8_t>{0, 0, 0, 0, 1, 9, 0, 0, 1, 0, 0, 0}, Uint8, "VEC4");
  attributes["WEIGHTS_0"] = builder.accessor(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, Float32, "VEC4");
  builder.node({{"name", "hip"}, {"translation", {0, 0, 0}}});
  builder.node({{"name", "knee"}, {"translation", {1, 0, 0}}});
  // Bound with the knee at x = 1.
  const int matrices = builder.accessor(std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,
                                                           1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1},
                                        Float32, "MAT4");
  builder.document["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", matrices}}};
  builder.document["nodes"][0]["skin"] = 0;
  return builder;
}

}  // namespace gnomon::test
