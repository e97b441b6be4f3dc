// SPDX-License-Identifier: MIT
#pragma once

#include "gltf/gltf_builder.hh"

#include <glm/vec3.hpp>

#include <string>
#include <vector>

namespace gnomon::test {

/** A lit triangle that fills the picture at 0 s, and that the animation "leave" moves to \a end_ws at 1 s. */
[[nodiscard]] inline std::string moving_triangle_gltf(const glm::vec3 &end_ws)
{
  GltfBuilder builder = triangle_scene();
  builder.document["nodes"][0]["scale"] = {20, 20, 1};
  builder.document["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
  builder.node({{"camera", 0}, {"translation", {5, 5, 3}}});
  builder.light({{"type", "directional"}, {"intensity", 2000.0}});
  const int input = builder.accessor(std::vector<float>{0, 1}, Float32, "SCALAR");
  const int output = builder.accessor(std::vector<float>{0, 0, 0, end_ws.x, end_ws.y, end_ws.z}, Float32, "VEC3");
  builder.document["animations"] = {
      {{"name", "leave"},
       {"samplers", {{{"input", input}, {"output", output}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
  return builder.gltf();
}

}  // namespace gnomon::test
