// SPDX-License-Identifier: MIT
#pragma once

#include "internal/reference_texture.hh"
#include "internal/reference_triangle.hh"
#include "reference_tracer.hh"

#if GNOMON_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/** The tree of triangles that rays are traced through. Internal to source/reference. */
namespace gnomon::reference {

/** The largest magnitude of a coordinate. */
[[nodiscard]] double largest(const glm::dvec3 &v);

struct Triangle {
  /** World space, counter-clockwise from the front. */
  Corners corners;
  /** Largest error of the corners due to rounding, metres. */
  double error_m = 0.0;
  std::uint32_t object = 0;
  /** Indices in the mesh's positions. */
  std::array<std::uint32_t, 3> vertices{};
};

struct Tracer::Tree {
  const scene::Scene &scene;
  const std::vector<scene::Object> objects;
  const std::vector<scene::PlacedLamp> lamps;
  std::vector<Triangle> triangles;
  double largest_coordinate = 0.0;
  /** Coordinates in the tree are (world - center) · scale. Their bounding box is ±half_size. */
  glm::dvec3 center{0.0};
  double scale = 1.0;
  glm::dvec3 half_size{0.0};
  RTCDevice device = nullptr;
  RTCScene tree = nullptr;

  explicit Tree(const scene::Scene &scene_) : scene(scene_), objects(scene_.objects()), lamps(scene_.placed_lamps()) {}
  ~Tree()
  {
    if (tree != nullptr) {
      rtcReleaseScene(tree);
    }
    if (device != nullptr) {
      rtcReleaseDevice(device);
    }
  }
  Tree(const Tree &) = delete;
  Tree &operator=(const Tree &) = delete;

  void add_object(std::uint32_t index);
  void place();
  void build();
  /** Callbacks of Embree for one triangle: its box, whether it is a ray's closest hit, and its transmittance. */
  static void set_bounds(const RTCBoundsFunctionArguments *arguments);
  static void intersect(const RTCIntersectFunctionNArguments *arguments);
  static void occlude(const RTCOccludedFunctionNArguments *arguments);
  [[noreturn]] void fail(const std::string &reason) const;

  [[nodiscard]] const scene::Mesh &mesh_of(const Triangle &triangle) const
  {
    return scene.meshes()[objects[triangle.object].mesh];
  }
  [[nodiscard]] const scene::Material &material_of(const Triangle &triangle) const
  {
    return scene.material_of(mesh_of(triangle));
  }
  [[nodiscard]] MeshPoint point_on(const Triangle &triangle, const glm::dvec3 &weights) const
  {
    return {scene, mesh_of(triangle), triangle.vertices, weights};
  }
  /** In [0, 1]. 0 if the material is masked and cut out at this point; between 0 and 1 only if it is blended. */
  [[nodiscard]] double opacity_at(const Triangle &triangle, const glm::dvec3 &weights) const;

  /** The part of a ray inside the tree's box, as an Embree ray. */
  struct Clipped {
    RTCRay ray{};
    /** Embree's t is (t - t_enter) · length. */
    double t_enter = 0.0;
    double length = 1.0;
  };
  /** Empty if the ray misses the box, or is not finite. */
  [[nodiscard]] std::optional<Clipped> clipped(const Ray &ray) const;
};

/** Context that Embree passes to its callbacks. */
#if GNOMON_EMBREE >= 4
using QueryContext = RTCRayQueryContext;
#else
using QueryContext = RTCIntersectContext;
#endif

struct ClosestQuery : QueryContext {
  ShearedRay sheared;
  const Ray &ray;
  Faces faces;
  double t_enter;
  double length;
  std::optional<Hit> best;
};

struct BlockedQuery : QueryContext {
  ShearedRay sheared;
  const glm::dvec3 &point;
  double error_m;
  const LightPoint &light;
  double transmission = 1.0;
};

}  // namespace gnomon::reference
