// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <glm/vec3.hpp>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

/**
 * Exact visibility and direct light by ray tracing: what the engines are judged by. All of it is computed in double,
 * from the scene's floats. It shares no code with an engine but the functions in `shaders/shared`.
 */
namespace gnomon::reference {

/** Points origin + t · direction with t in [t_min, t_max]. World space, metres. */
struct Ray {
  glm::dvec3 origin_ws{0.0};
  /** Of any length; t counts in it. A ray without a direction hits nothing. */
  glm::dvec3 direction_ws{0.0};
  double t_min = 0.0;
  double t_max = std::numeric_limits<double>::infinity();
};

/** Where a ray met a triangle. */
struct Hit {
  double t = 0.0;
  /** Of the tracer's triangles. */
  std::uint32_t triangle = 0;
  /** Of its corners; they sum to 1. */
  glm::dvec3 weights{0.0};
};

/** A hit in terms of the scene. */
struct Surface {
  glm::dvec3 position_ws{0.0};
  /** How far the position may be from where it should, metres. */
  double error_m = 0.0;
  /** Unit vector, on the front of the triangle. */
  glm::dvec3 geometric_normal_ws{0.0, 0.0, 1.0};
  /** Interpolated; unit vector, on the front. The geometric one where the mesh has none of any length. */
  glm::dvec3 shading_normal_ws{0.0, 0.0, 1.0};
  /** Index in Scene::objects(). */
  std::uint32_t object = 0;
  /** Of the scene; valid until it is edited. */
  const scene::Material *material = nullptr;
  /** Linear; the material's, and its texture's at its full size. */
  glm::dvec3 base_color{1.0};
};

/** A point of a lamp, where a shadow ray ends. */
struct LightPoint {
  /** A position, metres, or a direction of any length towards a lamp that is endlessly far. World space. */
  glm::dvec3 vector_ws{0.0};
  bool is_direction = false;
};

/** Which triangles a ray meets. */
enum class Faces {
  /** Both sides of all: what casts a shadow. */
  All,
  /** Not the backs of one-sided materials: what a camera sees. */
  Drawn,
};

/**
 * The triangles of a scene in world space, and a tree over them.
 *
 * The tree is Embree's and works in float, in coordinates in which the scene fills [-1, 1] and with boxes that are
 * larger than all of its roundings; which triangle is hit is decided in double. So results depend on neither the tree,
 * the number of threads, nor the scene's place and scale. Where a material is masked, what is cut out is not hit;
 * blended materials are solid. Triangles without an area are nowhere.
 *
 * All functions may be called by several threads at a time. The scene must outlive the tracer and stay as it is.
 */
class Tracer {
 public:
  /** \throws std::runtime_error naming the scene and the reason where Embree cannot make the tree. */
  explicit Tracer(const scene::Scene &scene);
  ~Tracer();
  Tracer(const Tracer &) = delete;
  Tracer &operator=(const Tracer &) = delete;

  /** The nearest hit. Of several at the same t, the one that comes first in the scene. */
  [[nodiscard]] std::optional<Hit> closest(const Ray &ray, Faces faces) const;

  /**
   * Whether a triangle stands between a point and a lamp's.
   *
   * One whose plane holds either of them, as far as roundings can tell, does not: the triangle that \a point_ws is on,
   * what lies in its plane, and what the lamp is mounted on. Nothing else is left out, so that a caster which touches
   * the receiver darkens it up to the line where they meet. \a error_m: how far the point may be from where it should,
   * at most.
   */
  [[nodiscard]] bool is_blocked(const glm::dvec3 &point_ws, double error_m, const LightPoint &light) const;

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

/** How far a position may be from where it should, metres, when it was computed from others of its size in double. */
[[nodiscard]] double position_error(const glm::dvec3 &position_ws);

}  // namespace gnomon::reference
