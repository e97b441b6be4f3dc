// SPDX-License-Identifier: MIT
#include "scene.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

namespace gnomon::scene {

float Bounds::radius() const
{
  return is_empty() ? 0.0F : glm::length(0.5F * max - 0.5F * min);
}

void Bounds::extend(const glm::vec3 &point)
{
  min = glm::min(min, point);
  max = glm::max(max, point);
}

void Bounds::extend(const Bounds &other)
{
  min = glm::min(min, other.min);
  max = glm::max(max, other.max);
}

Bounds transformed(const Bounds &bounds, const glm::mat4 &target_from_source)
{
  if (bounds.is_empty()) {
    return bounds;
  }
  // The extremes of a sum are the sums of the extremes, so each axis is taken alone: no corners to visit.
  Bounds result{glm::vec3(target_from_source[3]), glm::vec3(target_from_source[3])};
  for (int axis = 0; axis < 3; axis++) {
    const glm::vec3 at_min = glm::vec3(target_from_source[axis]) * bounds.min[axis];
    const glm::vec3 at_max = glm::vec3(target_from_source[axis]) * bounds.max[axis];
    result.min += glm::min(at_min, at_max);
    result.max += glm::max(at_min, at_max);
  }
  return result;
}

Bounds Scene::bounds() const
{
  Bounds result;
  for (const Object &object : objects) {
    result.extend(transformed(meshes[object.mesh].bounds, object.world_from_object));
  }
  return result;
}

}  // namespace gnomon::scene
