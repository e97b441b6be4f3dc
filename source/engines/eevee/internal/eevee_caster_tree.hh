// SPDX-License-Identifier: MIT
#pragma once

#include "shadows/shadow_casters.hh"

#include "draw_view.hh"
#include "render_scene.hh"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

/** Rays against the casters of a scene, on the CPU. Internal to the engine. */
namespace gnomon::eevee {

/** Boxes of items in a binary tree, split at the median of the longest axis. */
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(std::span<const scene::Bounds> boxes);
  /**
   * Call \a visit with the index of each item in a leaf that the ray meets before \a t_max, which \a visit may lower.
   * Ends when \a visit returns true.
   */
  template <typename Visit>
  void visit(const glm::vec3 &origin, const glm::vec3 &direction, const float &t_max, Visit &&visit) const;

  struct Node {
    scene::Bounds box;
    /** The first of a leaf's `count` items. Otherwise the second child; the first child is the next node. */
    std::uint32_t next = 0;
    std::uint32_t count = 0;
  };
  /** In depth-first order, from the root. */
  [[nodiscard]] std::span<const Node> nodes() const
  {
    return nodes_;
  }
  /** The indices of the items in the order of the leaves. */
  [[nodiscard]] std::span<const std::uint32_t> items() const
  {
    return items_;
  }

 private:
  void build(std::span<const scene::Bounds> boxes, std::size_t first, std::size_t end);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;
};

/** The side of a triangle that a ray meets. */
enum class RayHit : std::uint8_t { None, Front, Back };

/** A point of a surface. World space, metres. */
struct SurfacePoint {
  glm::vec3 position_ws;
  /** Unit vector of the plane of the triangle, on the side from which the point is seen. */
  glm::vec3 normal_ws;
};

/**
 * The triangles of a scene's casters. Those with an open shadow (render_scene::has_open_shadow) are left out, as are
 * those in buffers of a host, which the CPU does not have. A mask blocks a ray as often as a texel covers it with the
 * alpha of the vertices there: the texture has no particular places.
 */
class CasterTree {
 public:
  /** Take the casters of \a scene. \return the bounds of those that are new, gone or have changed */
  std::vector<scene::Bounds> update(const render_scene::RenderScene &scene);
  /**
   * Both sides of all triangles block a ray. \a direction_ws: of any length but 0. \a is_nearest: return the side of
   * the nearest triangle; otherwise of any, which takes less time. \a t_max: end of the ray, in lengths of \a
   * direction_ws. May be called by several threads.
   */
  [[nodiscard]] RayHit trace(const glm::vec3 &origin_ws, const glm::vec3 &direction_ws, bool is_nearest,
                             float t_max = std::numeric_limits<float>::max()) const;
  /**
   * The nearest point of a caster that pictures of \a view show: backs of one-sided materials, hidden objects and what
   * clip planes cut away do not count. Otherwise as trace.
   */
  [[nodiscard]] std::optional<SurfacePoint> seen(const draw::View &view, const glm::vec3 &origin_ws,
                                                 const glm::vec3 &direction_ws) const;
  [[nodiscard]] bool empty() const
  {
    return instances_.empty();
  }

 private:
  struct MeshTree;
  /** The alphas of an image. */
  struct Texels {
    /** For each byte, the part of the texels whose alpha is at least that. */
    std::array<float, 256> shares{};
    /** Fingerprint of `shares`. */
    std::uint64_t fingerprint = 0;

    Texels() = default;
    explicit Texels(const scene::Image &image);
  };
  struct Mask {
    /** nullptr: without a texture. */
    const Texels *texels = nullptr;
    /** Least product of the alphas of texture and vertices that is drawn; 0 for a mesh without a mask. */
    float cutoff = 0.0F;
    /** cover(1), for the many rays that meet meshes without alphas of vertices. */
    float opaque_cover = 1.0F;

    /** The part of a surface that it covers. \a alpha: of the vertices there */
    [[nodiscard]] float cover(float alpha) const;
  };
  struct Instance {
    const MeshTree *mesh;
    glm::mat4 object_from_world;
    Mask mask;
    bool is_double_sided;
  };
  /** A triangle, and where a ray meets it. */
  struct Meeting {
    std::uint32_t instance;
    std::uint32_t triangle;
    float t;
    bool is_front;
  };
  struct MeshKey {
    std::uint64_t mesh;
    scene::Revision shape;

    auto operator<=>(const MeshKey &) const = default;
  };
  struct ImageKey {
    std::uint64_t image;
    scene::Revision content;

    auto operator<=>(const ImageKey &) const = default;
  };
  using Images = std::map<ImageKey, Texels>;
  /** \a last: before the update. Images that are used again move from there. */
  Mask mask_of(const scene::Scene &scene, const scene::Mesh &mesh, Images &last);
  /** Whether the mask covers a triangle at barycentric coordinates. */
  [[nodiscard]] static bool is_covered(const Instance &instance, std::uint32_t triangle, float u, float v);
  /**
   * Call \a accept with each triangle that the ray meets before \a t_max; it returns whether the ray ends there. Unless
   * \a is_nearest, the first such triangle ends the search.
   */
  template <typename Accept>
  void visit(const glm::vec3 &origin_ws, const glm::vec3 &direction_ws, bool is_nearest, float t_max,
             Accept &&accept) const;

  std::map<MeshKey, std::shared_ptr<const MeshTree>> meshes_;
  Images images_;
  std::vector<Caster> casters_;
  std::vector<Instance> instances_;
  BoxTree tree_;
};

}  // namespace gnomon::eevee
