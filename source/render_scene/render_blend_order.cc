// SPDX-License-Identifier: MIT
#include "render_blend_order.hh"

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <numeric>

namespace gnomon::render_scene {

namespace {

/** Whether every ray from the eye that meets both boxes meets \a b first. false where nothing tells. */
bool is_behind(const scene::Bounds &a, const scene::Bounds &b, const glm::vec4 &eye_ws)
{
  bool is_behind = false;
  bool is_before = false;
  for (int axis = 0; axis < 3; axis++) {
    const bool is_parallel = eye_ws.w == 0.0F;
    const auto is_eye_below = [&](float place) { return is_parallel ? eye_ws[axis] < 0.0F : eye_ws[axis] <= place; };
    const auto is_eye_above = [&](float place) { return is_parallel ? eye_ws[axis] > 0.0F : eye_ws[axis] >= place; };
    if (b.max[axis] <= a.min[axis]) {
      is_behind |= is_eye_below(a.min[axis]);
      is_before |= is_eye_above(b.max[axis]);
    }
    if (a.max[axis] <= b.min[axis]) {
      is_behind |= is_eye_above(a.max[axis]);
      is_before |= is_eye_below(b.min[axis]);
    }
  }
  // Where two planes disagree, no ray meets both boxes.
  return is_behind && !is_before;
}

}  // namespace

glm::vec4 eye_of(const draw::View &view)
{
  const glm::mat4 world_from_view(glm::inverse(glm::dmat4(view.view_from_world())));
  return view.is_perspective() ? glm::vec4(glm::vec3(world_from_view[3]), 1.0F)
                               : glm::vec4(glm::vec3(world_from_view[2]), 0.0F);
}

std::vector<std::uint32_t> back_to_front(std::span<const scene::Bounds> boxes, const glm::vec4 &eye_ws)
{
  std::vector<std::uint32_t> order(boxes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, std::ranges::greater(), [&](std::uint32_t index) {
    const glm::vec3 middle = boxes[index].center();
    return eye_ws.w == 0.0F ? -glm::dot(middle, glm::vec3(eye_ws)) : glm::distance(middle, glm::vec3(eye_ws));
  });
  if (boxes.size() > blend_order_exact_max) {
    return order;
  }
  // Kahn's topological sort (1962); of those that nothing left is behind, the farthest is next.
  std::vector<std::uint32_t> behind_count(boxes.size(), 0);
  for (const std::uint32_t a : order) {
    for (const std::uint32_t b : order) {
      behind_count[b] += is_behind(boxes[a], boxes[b], eye_ws) ? 1 : 0;
    }
  }
  std::vector<std::uint32_t> sorted;
  sorted.reserve(order.size());
  while (!order.empty()) {
    auto next = std::ranges::find(order, 0U, [&](std::uint32_t index) { return behind_count[index]; });
    if (next == order.end()) {
      next = order.begin();
    }
    const std::uint32_t drawn = *next;
    order.erase(next);
    for (const std::uint32_t index : order) {
      behind_count[index] -= is_behind(boxes[drawn], boxes[index], eye_ws) ? 1 : 0;
    }
    sorted.push_back(drawn);
  }
  return sorted;
}

}  // namespace gnomon::render_scene
