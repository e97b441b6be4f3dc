// SPDX-License-Identifier: MIT
#include "gpu_state.hh"

#include <array>
#include <string_view>

namespace gnomon::gpu {

std::string to_string(State mask)
{
  static constexpr std::array<std::string_view, 16> names = {
      "write_color",     "write_depth", "depth_nearer_equal", "depth_equal",    "cull_back",  "cull_front",
      "front_clockwise", "blend_add",   "depth_clamp",        "blend_multiply", "blend_over", "depth_less_equal",
      "draw_lines",      "draw_points", "depth_further",      "wireframe"};
  std::string text;
  for (std::size_t bit = 0; bit < names.size(); bit++) {
    if (has(mask, State(1U << bit))) {
      text += (text.empty() ? "" : " ");
      text += names[bit];
    }
  }
  return text.empty() ? "none" : text;
}

}  // namespace gnomon::gpu
