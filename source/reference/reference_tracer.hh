// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <glm/vec3.hpp>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/**
 * Exact visibility and direct light by ray tracing: the ground truth for engines. All values are computed in double
 * from the scene. The only code shared with an engine are the functions in `shaders/shared`.
 */
namespace gnomon::reference {

/** Points origin + t · direction with t in [t_min, t_max]. World space, metres. */
struct Ray {
  glm::dvec3 origin_ws{0.0};
  /** The direction may have any length; t is in units of this length. A ray with a zero direction hits nothing. */
  glm::dvec3 direction_ws{0.0};
  double t_min = 0.0;
  double t_max = std::numeric_limits<double>::infinity();
};

/** Intersection of a ray with a triangle. */
struct Hit {
  double t = 0.0;
  /** Index of the triangle in the tracer. */
  std::uint32_t triangle = 0;
  /** Barycentric weights of its corners. The sum is 1. */
  glm::dvec3 weights{0.0};
};

/** The surface of the scene at a hit. */
struct Surface {
  glm::dvec3 position_ws{0.0};
  /** Largest possible error of the position, metres. */
  double error_m = 0.0;
  /** Normal of the triangle, unit vector, on its front side. */
  glm::dvec3 geometric_normal_ws{0.0, 0.0, 1.0};
  /**
   * Interpolated normal with the normal texture, unit vector, on the front side. The geometric normal if the mesh's
   * normals add up to zero.
   */
  glm::dvec3 shading_normal_ws{0.0, 0.0, 1.0};
  /** The same without the normal texture. */
  glm::dvec3 smooth_normal_ws{0.0, 0.0, 1.0};
  /** Index in Scene::objects(). */
  std::uint32_t object = 0;
  /** A material of the scene, valid until the scene is edited. */
  const scene::Material *material = nullptr;
  /** The material's factors times its textures, at their full size, and vertex colours. Linear. */
  glm::dvec3 base_color{1.0};
  double metallic = 1.0;
  double roughness = 1.0;
  double specular = 1.0;
  glm::dvec3 specular_color{1.0};
  glm::dvec3 emissive{0.0};
  /** Fraction of ambient light that arrives. */
  double occlusion = 1.0;
  /** Part of the light from behind that the surface covers, in [0, 1]. 1 unless the material is blended. */
  double opacity = 1.0;
};

/** A point of a lamp: the end of a shadow ray. */
struct LightPoint {
  /** A position, metres, or a direction of any length towards a lamp at infinity. World space. */
  glm::dvec3 vector_ws{0.0};
  bool is_direction = false;
};

/** Selects the triangles that a ray can hit. */
enum class Faces {
  /** Both sides of all triangles: the casters of shadows. */
  All,
  /** Without the backs of one-sided materials: the surfaces that a camera sees. */
  Drawn,
};

/**
 * The triangles of a scene in world space, and a tree of bounding boxes over them.
 *
 * The tree is Embree's. It works in float, in coordinates in which the scene fills [-1, 1], with boxes larger than all
 * of its rounding errors. The intersection with a triangle is decided in double. The results therefore do not depend on
 * the tree, on the number of threads, or on the scene's position and scale. Masked materials are not hit where they are
 * cut out, and blended ones not where they are wholly transparent. Triangles without area are ignored.
 *
 * All functions may be called by several threads concurrently. The scene must outlive the tracer and must not change.
 */
class Tracer {
 public:
  /** \throws std::runtime_error naming the scene and the reason if Embree cannot create the tree. */
  explicit Tracer(const scene::Scene &scene);
  ~Tracer();
  Tracer(const Tracer &) = delete;
  Tracer &operator=(const Tracer &) = delete;

  /** The nearest hit. If several triangles are hit at the same t, the first of them in the scene. */
  [[nodiscard]] std::optional<Hit> closest(const Ray &ray, Faces faces) const;

  /**
   * The part of the light of a point of a lamp that reaches a point, in [0, 1]: 0 if an opaque triangle lies between
   * them, otherwise the product of 1 - opacity over the blended triangles there. Their colour does not tint the light.
   * A ray through an edge that two blended triangles share meets both.
   *
   * A triangle whose plane contains either point, within rounding, does not block. This excludes the triangle that
   * \a point_ws is on, triangles in its plane, and the surface that the lamp is mounted on. No other triangle is
   * excluded, so that a caster that touches the receiver darkens it up to the line of contact. \a error_m: largest
   * possible error of \a point_ws, metres.
   */
  [[nodiscard]] double transmission(const glm::dvec3 &point_ws, double error_m, const LightPoint &light) const;
  /** Whether no light arrives. \see transmission */
  [[nodiscard]] bool is_blocked(const glm::dvec3 &point_ws, double error_m, const LightPoint &light) const
  {
    return transmission(point_ws, error_m, light) == 0.0;
  }

  [[nodiscard]] Surface surface_at(const Hit &hit) const;

  /** Largest absolute coordinate of a triangle, metres. */
  [[nodiscard]] double largest_coordinate() const;

  [[nodiscard]] const scene::Scene &scene() const;
  /** Scene::placed_lamps(), as of the tracer's construction. */
  [[nodiscard]] const std::vector<scene::PlacedLamp> &lamps() const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/**
 * The parts of visible meshes that the tracer leaves out: one line for each material of triangles that has layers,
 * transmits light or has a surface function, and one for each mesh of lines or points.
 */
[[nodiscard]] std::vector<std::string> untraced_parts(const scene::Scene &scene);

/** Largest error of a position, metres, that was computed in double from positions of similar magnitude. */
[[nodiscard]] double position_error(const glm::dvec3 &position_ws);

}  // namespace gnomon::reference
