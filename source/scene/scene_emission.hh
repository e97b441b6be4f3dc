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
  /** Unit normal of the surface, which emits to both of its sides. */
  glm::dvec3 normal{0.0, 0.0, 1.0};
  /** Linear radiance, W/(sr m²); the same in all directions. Finite. */
  glm::dvec3 radiance{0.0};
  /**
   * Area that the point represents, m²: the inverse of the probability density with which EmissiveSurfaces::at chooses
   * the point. The mean of area · radiance · f over the points of all places is therefore the integral of radiance · f
   * over all surfaces that emit light, for every function f of the position.
   */
  double area = 0.0;
};

/**
 * The surfaces of a scene that emit light. Chooses points of them, with a probability in proportion to the power that
 * the surface emits.
 *
 * The triangles of emissive materials are divided into patches. The radiance of a patch is constant: the mean of the
 * emission texture over the patch, multiplied by the opacity where the material is blended, and 0 where it is cut out.
 *
 * These emit nothing here: unlit materials, materials with a surface function, lines, points, and meshes that lack the
 * image or the texture coordinates of their material's emission texture.
 */
class EmissiveSurfaces {
 public:
  /** Maximum number of patches. A scene with more triangles than this has one patch for each triangle. */
  static constexpr std::size_t patch_count_max = 32768;
  /**
   * Maximum edge of a patch, as a fraction of the emission texture's edge. Patches are larger where there would be more
   * than patch_count_max of them, or more than 64² in a triangle.
   */
  static constexpr double patch_edge_max = 1.0 / 48.0;
  /** Maximum of each channel of the radiance, W/(sr m²). Brighter surfaces have this radiance. */
  static constexpr float radiance_max = 1e30F;

  EmissiveSurfaces() = default;
  /**
   * \a objects: Scene::objects() of \a scene, or some of them. The points are in the target space of
   * Object::world_from_object.
   */
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
   * The point for \a place in [0, 1)³. The first component chooses the patch. Patches for neighbouring values are
   * mostly neighbours in space, so that evenly spaced values are spread evenly over the surfaces. \pre not empty
   */
  [[nodiscard]] EmissivePoint at(const glm::dvec3 &place) const;

 private:
  struct Patch {
    std::array<glm::dvec3, 3> corners;
    glm::vec3 radiance;
  };
  std::vector<Patch> patches_;
  /** For each patch: the sum of its weight and the weights of the patches before it. */
  std::vector<double> cumulative_;
};

/** Whether a material of \a scene emits light that EmissiveSurfaces may hold. */
[[nodiscard]] bool has_emission(const Scene &scene);

/** Fingerprint of the input of EmissiveSurfaces. While it stays equal, the surfaces of the scene's objects do too. */
struct EmissionState {
  /** Visible objects with an emissive material. */
  std::size_t object_count = 0;
  /** Last edit of the nodes, meshes and materials of these objects, or of any texture or image. */
  Revision latest = 0;

  bool operator==(const EmissionState &) const = default;
};

/**
 * Takes time in proportion to the number of nodes if has_emission(), otherwise to the number of materials. Making
 * EmissiveSurfaces takes far longer.
 */
[[nodiscard]] EmissionState emission_state(const Scene &scene);

}  // namespace gnomon::scene
