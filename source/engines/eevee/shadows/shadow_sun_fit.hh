// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_crop.hh"

#include "eevee_shadow_settings.hh"

#include "draw_view.hh"
#include "scene.hh"

#include <glm/common.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gnomon::eevee {

struct Caster;

/**
 * Edge of the texels, in pixels, for which cascades around visible surfaces suffice. Larger texels need one more
 * cascade. \see SunSlices::error
 */
inline constexpr double texel_in_pixels_max = 0.2;
/** Sizes of maps change by powers of this factor. */
inline constexpr double resize_step = 1.189207115;
/**
 * Fitted maps of a sun that has the array for itself have texels that are smaller by this factor than the picture
 * needs. Without it, the steps of 16-bit depths, and the larger offset of receivers, would add to the error of
 * pictures.
 */
inline constexpr double short_depth_gain = 1.08;
/** The largest size of a map, over the size asked for, if a sun has the most maps. */
inline constexpr double size_growth_max = resize_step * short_depth_gain;

/** The view of one cascade, and the box that it covers. */
struct SunFit {
  draw::View view;
  /** Whether the box has slack for movements of the camera. */
  bool is_stable = true;
  /** Edge of the map, texels. The same for all cascades of a sun. */
  int size_px = 0;
  /** Angle from the lamp's axes to those of the box, around the light, radians. \see turned */
  double turn = 0.0;
  /**
   * The covered box in its axes, metres: xy is perpendicular to the light, z is along the light. z is measured from the
   * plane z = slope.x · x + slope.y · y, so that the depths of receivers near to it have a small range. Casters with
   * greater z are clamped to it.
   */
  glm::dvec3 min{0.0};
  glm::dvec3 max{0.0};
  glm::dvec2 slope{0.0};
  /** From the first caster to the last receiver along the light, metres. At least the length of the box. */
  double caster_length = 0.0;
  /** The part of the box that is needed. The rest is slack for movements of the camera. */
  glm::dvec3 needed_min{0.0};
  glm::dvec3 needed_max{0.0};

  /** Longer edge of a texel, metres. */
  [[nodiscard]] double texel() const
  {
    return glm::max(max.x - min.x, max.y - min.y) / size_px;
  }
};

/** A plane, and the range of the distances of some points from it along z: z - slope.x · x - slope.y · y. */
struct DepthRange {
  glm::dvec2 slope{0.0};
  double min = 0.0;
  double max = 0.0;
};
/**
 * A plane from which \a points have a small range: the one with the least squares of the distances, or one across z if
 * that has a smaller range. \pre \a points is not empty
 */
[[nodiscard]] DepthRange depth_range(std::span<const glm::dvec3> points);

/** The visible part of the casters' bounds, to which cascades are fitted. */
struct VisibleRange {
  /** Corners of the visible part, world space. \see visible_corners */
  std::vector<glm::dvec3> corners;
  /** Range of distances along the view direction, metres. Above 0 in perspective. */
  double near = 0.0;
  double far = 0.0;
  /** The surfaces that the picture shows, if shadows are fitted to depths. */
  std::vector<VisibleCluster> clusters{};
  /** Boxes around `clusters`, if these are of the current view. */
  std::vector<VisibleBox> boxes{};
  /** Another number for each change of `boxes`, over all viewports. Above 0. */
  std::uint64_t revision = 0;
};

/** The visible range with \a corners, seen by \a view. */
[[nodiscard]] VisibleRange visible_range(const draw::View &view, std::vector<glm::dvec3> corners);

/**
 * The count + 1 limits of \a count slices of [near, far], by the practical split scheme (Zhang et al. 2006):
 * λ · near · (far / near)^(i / count) + (1 - λ) · (near + (far - near) · i / count). Uniform if near is not above 0.
 */
[[nodiscard]] std::vector<double> cascade_splits(double near, double far, int count, double lambda);

/** A sphere. World space, metres. */
struct Sphere {
  glm::dvec3 center_ws{0.0};
  double radius = 0.0;
};
/** The smallest sphere around the part of the frustum of \a view from the distance \a near to \a far, metres. */
[[nodiscard]] Sphere slice_sphere(const draw::View &view, double near, double far);

/**
 * Fit the cascades of a sun. The result is ordered from fine to coarse. The last cascade covers all visible receivers
 * that a caster can shadow; each other cascade covers one slice of the view distance. Along the light, each cascade
 * extends from the first caster to the last receiver. The result is empty if no caster can shadow a visible receiver.
 * It has fewer cascades than requested if the cascade of a slice would be no finer than the last cascade.
 *
 * With \a clusters, those of \a visible, each other cascade is a rectangle around the clusters of some distances, as
 * small as possible, \see sun_slices; CascadeSettings::lambda has no effect. It fits one picture: it has no slack, and
 * its texels are on no grid. Along the light, it contains the clusters that are inside of the rectangle, and the last
 * cascade all visible receivers: from a plane along these, \see SunFit::slope. Casters in front of that are clamped.
 *
 * Otherwise the extent of a cascade changes in steps, its texels are aligned to a grid that is fixed in the world, and
 * it is a little larger than necessary. A cascade therefore need not be drawn again after small movements of the
 * camera, and texels of objects that do not move are stable when it is drawn again.
 *
 * \a size_px: edge of a map, texels; size_growth_max times the size asked for if maps can have other sizes. \a
 * edge_max_px: the largest edge of maps that have no more texels together than the most maps of that size; 0: that
 * size. \a pixel_size: edge of a pixel of the picture, metres: at a distance of 1 m (perspective) or at any distance
 * (orthographic). \a memory: its capacity is reused for the result; its content is discarded. \a tangent: of half the
 * angle of a sun that is shaded as a whole. The last cascade then also covers the casters whose penumbrae reach a
 * visible receiver. 0 for other suns.
 */
[[nodiscard]] std::vector<SunFit> fit_sun(const glm::mat4 &world_from_lamp, const draw::View &view,
                                          const VisibleRange &visible, const std::vector<Caster> &casters, int size_px,
                                          const CascadeSettings &settings, float pixel_size,
                                          std::vector<SunFit> memory = {}, double tangent = 0.0,
                                          std::span<const VisibleCluster> clusters = {}, int edge_max_px = 0);

/** Whether \a old can replace \a needed: it has the same axes and covers the needed box, and its texels are not much
 * larger. */
[[nodiscard]] bool still_fits(const SunFit &old, const SunFit &needed);

}  // namespace gnomon::eevee
