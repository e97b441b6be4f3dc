// SPDX-License-Identifier: MIT
#include "eevee_camera.hh"

#include "eevee_sequence_shared.h"
#include "eevee_sobol.hh"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon::eevee {

using std::numbers::pi_v;

draw::View with_sample_offset(const draw::View &view, glm::vec2 offset_px, glm::ivec2 size_px)
{
  // To move the samples, the image moves by the opposite offset. The offset in clip space is proportional to w.
  const glm::vec2 offset_clip = -2.0F * offset_px / glm::vec2(size_px);
  glm::mat4 clip_from_view = view.clip_from_view();
  for (int column = 0; column < 4; column++) {
    clip_from_view[column][0] += offset_clip.x * clip_from_view[column][3];
    clip_from_view[column][1] += offset_clip.y * clip_from_view[column][3];
  }
  return view.with_matrices(view.view_from_world(), clip_from_view, view.lens());
}

/** \a place of the unit square in the regular polygon around the origin, whose corners are on the unit circle. */
static glm::vec2 on_polygon(glm::vec2 place, int corner_count, float rotation)
{
  const float scaled = place.x * float(corner_count);
  const int triangle = std::min(int(scaled), corner_count - 1);
  // The distance to the centre grows as the square root, so that the triangle is covered evenly.
  const float outer = std::sqrt(scaled - float(triangle));
  const float half_angle = pi_v<float> / float(corner_count);
  const glm::vec2 at(outer * std::cos(half_angle), outer * (2.0F * place.y - 1.0F) * std::sin(half_angle));
  const float angle = rotation + 2.0F * half_angle * float(triangle);
  return {std::cos(angle) * at.x - std::sin(angle) * at.y, std::sin(angle) * at.x + std::cos(angle) * at.y};
}

glm::vec2 lens_point(const draw::Lens &lens, glm::vec2 place)
{
  const glm::vec2 point = lens.blades == 0 ? glm::vec2(on_disk(place)) : on_polygon(place, lens.blades, lens.rotation);
  return lens.radius * glm::vec2(point.x / lens.ratio, point.y);
}

draw::View view_through_lens(const draw::View &view, int index, int count, std::uint32_t seed)
{
  const draw::Lens &lens = view.lens();
  glm::mat4 view_from_world = view.view_from_world();
  glm::mat4 clip_from_view = view.clip_from_view();
  if (lens.radius > 0.0F && count != 1) {
    constexpr std::uint32_t stream = 0x6C656E73;
    const glm::vec2 point =
        lens_point(lens, glm::vec2(sobol_point(std::uint32_t(index), shared::mixed_bits(seed + stream))));
    for (int axis = 0; axis < 2; axis++) {
      view_from_world[3][axis] -= point[axis];
      clip_from_view[2][axis] -= clip_from_view[axis][axis] * point[axis] / lens.focus_distance;
    }
  }
  return view.with_matrices(view_from_world, clip_from_view);
}

draw::View view_around_lens(const draw::View &view)
{
  const draw::Lens &lens = view.lens();
  if (lens.radius == 0.0F) {
    return view.with_matrices(view.view_from_world(), view.clip_from_view());
  }
  // At the distance d, half the view is s d wide, with the slope s. Through a point x of the lens, it is moved by
  // x (1 - d / focus). A view whose eye is max(x) / min(s) behind contains all, with a slope of s + max(x) / focus.
  const glm::mat4 &clip_from_view = view.clip_from_view();
  const float reach = lens.radius / std::min(lens.ratio, 1.0F);
  const glm::vec2 slope(1.0F / clip_from_view[0][0], 1.0F / clip_from_view[1][1]);
  const glm::vec2 wide = slope + reach / lens.focus_distance;
  const float back = reach / std::min(slope.x, slope.y);
  // Reversed depth: z / w is a + b / distance.
  const float a = -clip_from_view[2][2];
  const float b = clip_from_view[3][2];
  const float near = b / (1.0F - a);
  const float far = a < 0.0F ? -b / a : std::numeric_limits<float>::infinity();
  glm::mat4 clip_around = draw::perspective(wide.x, wide.y, near + back, far + back);
  glm::mat4 view_from_world = view.view_from_world();
  view_from_world[3][2] -= back;
  for (int axis = 0; axis < 2; axis++) {
    const float middle = clip_from_view[2][axis] * slope[axis];
    clip_around[2][axis] = middle / wide[axis];
    view_from_world[3][axis] += middle * back;
  }
  return view.with_matrices(view_from_world, clip_around);
}

}  // namespace gnomon::eevee
