// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <glm/vec3.hpp>

#include <array>
#include <span>
#include <vector>

namespace gnomon::scene {

/** A point of a surface that emits light. */
struct EmissivePoint {
  glm::dvec3 position{0.0};
  /** Unit vector across the surface. The surface emits to both of its sides. */
  glm::dvec3 normal{0.0, 0.0, 1.0};
  /** Linear radiance, W/(sr m²); the same in all directions. Finite. */
  glm::dvec3 radiance{0.0};
  /**
   * Area that the point represents, m²: the mean of area · radiance · f over the unit cube is the integral of
   * radiance · f over all surfaces that emit light.
   */
  double area = 0.0;
};

/**
 * The surfaces of a scene that emit light, for the choice of points by importance: a point is chosen with a probability
 * in proportion to the power that its surface emits.
 *
 * The triangles of emissive materials are divided into patches of a constant radiance, which is the mean of the texture
 * over the patch. What is transparent or cut out emits as much less. Left out are unlit materials, surface functions,
 * lines and points, and what emission textures of a mesh without texture coordinates would add.
 */
class EmissiveSurfaces {
 public:
  /** Most patches, unless there are more triangles. */
  static constexpr std::size_t patch_count_max = 32768;
  /** Largest edge of a patch, fraction of the texture, unless there would be too many patches. */
  static constexpr double patch_edge_max = 1.0 / 48.0;
  /** Radiance of brighter surfaces, W/(sr m²) for each channel, counts as this. */
  static constexpr float radiance_max = 1e30F;

  EmissiveSurfaces() = default;
  /** \a objects: Scene::objects() of \a scene, or some of them; their space is that of the points. */
  EmissiveSurfaces(const Scene &scene, std::span<const Object> objects);

  /** No surface emits light. */
  [[nodiscard]] bool empty() const
  {
    return patches_.empty();
  }
  [[nodiscard]] std::size_t patch_count() const
  {
    return patches_.size();
  }
  /**
   * The point for \a place in [0, 1)³. Neighbouring values of the first component are mostly near to each other in
   * space, so that even positions are spread evenly over the surfaces. \pre not empty
   */
  [[nodiscard]] EmissivePoint at(const glm::dvec3 &place) const;

 private:
  struct Patch {
    std::array<glm::dvec3, 3> corners;
    glm::vec3 radiance;
  };
  std::vector<Patch> patches_;
  /** Sum of the weights of the patches up to each. */
  std::vector<double> cumulative_;
};

/** Whether a material of \a scene emits light that EmissiveSurfaces may hold. */
[[nodiscard]] bool has_emission(const Scene &scene);

/** Input of EmissiveSurfaces. If it is equal before and after edits of a scene, so are the surfaces of its objects. */
struct EmissionState {
  /** Visible objects with an emissive material. */
  std::size_t object_count = 0;
  /** Last edit of their nodes, meshes and materials, or of any texture or image. */
  Revision latest = 0;

  bool operator==(const EmissionState &) const = default;
};

/** Linear in the number of nodes if has_emission, but far cheaper than EmissiveSurfaces. */
[[nodiscard]] EmissionState emission_state(const Scene &scene);

}  // namespace gnomon::scene
