// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_framebuffer.hh"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

namespace gnomon::shared {
struct ViewData;
}

namespace gnomon::draw {

/** Bounding sphere of a draw call, for culling. World space, metres. */
struct CullingVolume {
  glm::vec3 center_ws{0.0F};
  /** Negative: the call is never culled. */
  float radius = -1.0F;
};

/**
 * The planes of a frustum, moved outwards by the error that rounding may add to the height of a point far from the
 * origin. A volume is outside if its centre is lower than -culling_reach() above one of them.
 */
using CullingPlanes = std::array<glm::vec4, 6>;

/** Whether a sphere may be inside of all \a planes. Spheres outside near an edge may return true. */
[[nodiscard]] bool touches(const CullingPlanes &planes, const CullingVolume &volume);

/** Radius plus the rounding error of the centre's height above a plane, metres. Infinite: never culled. */
[[nodiscard]] float culling_reach(const CullingVolume &volume);

/**
 * The aperture of a perspective camera, in the plane through the eye. Engines that draw several samples of a picture
 * see each from another point of it (depth of field); others see from its centre.
 */
struct Lens {
  /** Half the height of the aperture, metres. 0: a pinhole. */
  float radius = 0.0F;
  /** Distance of the plane in focus along the view direction, metres, above 0. May be infinite. */
  float focus_distance = std::numeric_limits<float>::infinity();
  /** Corners of a polygon, at least 3. 0: round. */
  int blades = 0;
  /** Angle from +X of view space to the middle of an edge of the polygon, counter-clockwise, radians. */
  float rotation = 0.0F;
  /** Height of the aperture over its width, above 0. */
  float ratio = 1.0F;

  bool operator==(const Lens &) const = default;
};

/** Index of an object in `object_block`. Calls pass it to the vertex shader. */
using ObjectIndex = std::uint32_t;

/** A set of objects of an ObjectBuffer. Copies share its memory. */
class ObjectSet {
 public:
  ObjectSet() = default;
  /** \a flags: indexed by ObjectIndex; not 0: the object is in the set. Objects beyond the end are not. */
  explicit ObjectSet(std::vector<std::uint8_t> flags);

  [[nodiscard]] bool contains(ObjectIndex object) const
  {
    return flags_ && object < flags_->size() && (*flags_)[object] != 0;
  }
  /** The largest index in the set plus 1. 0: the set is empty. */
  [[nodiscard]] ObjectIndex index_end() const
  {
    return flags_ ? ObjectIndex(flags_->size()) : 0;
  }
  /** Whether both have the same objects. */
  bool operator==(const ObjectSet &other) const;

 private:
  /** The last element is not 0. nullptr: the set is empty. */
  std::shared_ptr<const std::vector<std::uint8_t>> flags_;
};

/**
 * Position, direction, projection and lens from which a pass is drawn, and the objects and half-spaces that are left
 * out.
 */
class View {
 public:
  /** Index of the near plane in frustum_planes_ws() and culling_planes(). */
  static constexpr std::size_t near_plane = 4;
  /** The most planes of with_clip_planes(). */
  static constexpr std::size_t clip_plane_max = 6;

  View() : View(glm::mat4(1.0F), glm::mat4(1.0F)) {}
  /**
   * View space looks along -Z. \a clip_from_view maps the near plane to z = w and the far plane to z = 0 (reversed
   * depth). \pre both matrices are finite
   */
  View(const glm::mat4 &view_from_world, const glm::mat4 &clip_from_view, const Lens &lens = {});

  [[nodiscard]] const glm::mat4 &view_from_world() const
  {
    return view_from_world_;
  }
  [[nodiscard]] const glm::mat4 &clip_from_view() const
  {
    return clip_from_view_;
  }
  [[nodiscard]] const glm::mat4 &clip_from_world() const
  {
    return clip_from_world_;
  }
  /**
   * The objects that pictures of this view do not show, as if they were outside of the frustum. Light and shadows of a
   * picture are those of the whole scene.
   */
  [[nodiscard]] const ObjectSet &hidden() const
  {
    return hidden_;
  }
  /** The same view, which leaves out \a hidden instead of its own set. */
  [[nodiscard]] View with_hidden(ObjectSet hidden) const;
  /**
   * Pictures of this view show the parts of surfaces on one side of each of these planes: the points p with
   * dot(plane, (p, 1)) >= 0. A cut surface shows the backs of two-sided materials. Light and shadows of a picture
   * are those of the whole scene. World space, metres, as view_from_world().
   */
  [[nodiscard]] const std::vector<glm::vec4> &clip_planes() const
  {
    return clip_planes_;
  }
  /** The same view with other clip_planes(). \throws gpu::Error if they are too many, or one is not finite. */
  [[nodiscard]] View with_clip_planes(std::vector<glm::vec4> planes) const;
  /** A view from these matrices with the hidden objects and clip planes of this one. */
  [[nodiscard]] View with_matrices(const glm::mat4 &view_from_world, const glm::mat4 &clip_from_view,
                                   const Lens &lens = {}) const;
  [[nodiscard]] bool is_perspective() const
  {
    return clip_from_view_[3][3] == 0.0F;
  }
  [[nodiscard]] const Lens &lens() const
  {
    return lens_;
  }
  /** Whether the picture is a mirror image, in which the vertices of front sides are clockwise. */
  [[nodiscard]] bool is_mirrored() const
  {
    return clip_from_view_[0][0] * clip_from_view_[1][1] < 0.0F;
  }
  /**
   * Left, right, bottom, top, near and far plane. A point is inside if dot(plane, (point, 1)) >= 0. The normals are
   * unit vectors. An infinite far plane is (0, 0, 0, 1), so that all points are inside.
   */
  [[nodiscard]] const std::array<glm::vec4, 6> &frustum_planes_ws() const
  {
    return frustum_planes_ws_;
  }
  [[nodiscard]] CullingPlanes culling_planes() const;
  /** Whether the sphere may intersect the frustum. Spheres outside near an edge may return true. */
  [[nodiscard]] bool touches(const CullingVolume &volume) const;
  bool operator==(const View &) const = default;

 private:
  glm::mat4 view_from_world_;
  glm::mat4 clip_from_view_;
  glm::mat4 clip_from_world_;
  Lens lens_;
  std::array<glm::vec4, 6> frustum_planes_ws_;
  ObjectSet hidden_;
  std::vector<glm::vec4> clip_planes_;
};

/** Set the clip planes of \a data, in which they are 0, for a pass of \a view into \a picture. */
void set_clip_planes(shared::ViewData &data, const View &view, const gpu::Rectangle &picture);

/**
 * Perspective projection with reversed depth: z / w is 1 at the near plane and 0 at the far plane. \a half_width and
 * \a half_height: half the size of the frustum at distance 1. \pre all arguments > 0; far > near; far may be infinite
 */
[[nodiscard]] glm::mat4 perspective(float half_width, float half_height, float near, float far);

/**
 * Orthographic projection with reversed depth: 1 at the near plane, 0 at the far. A negative half size mirrors.
 * \pre half sizes are not 0, far > near
 */
[[nodiscard]] glm::mat4 orthographic(float half_width, float half_height, float near, float far);

}  // namespace gnomon::draw
