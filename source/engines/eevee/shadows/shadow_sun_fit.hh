// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_casters.hh"

#include "draw_view.hh"
#include "scene.hh"

#include <glm/common.hpp>

#include <array>
#include <span>
#include <vector>

namespace gnomon::eevee {

/** As many maps as a sun may have. */
inline constexpr int cascade_count_max = 4;

/** How a sun's shadow is spread over what is seen. */
struct CascadeSettings {
  /** Maps a sun, 1 to cascade_count_max; 0: as many as it takes for texels no larger than pixels, at most the largest.
   */
  int count = 0;
  /** Between even splits of the distance (0) and even splits of its logarithm (1). */
  float lambda = 0.8F;
  /** Split the distances that the picture's depths have, and not those that the scene's box could have. Takes the depth
   * prepass first, and waits for it whenever the view changes. */
  bool is_fitted_to_depth = false;
};

/** A sun's view, and what it holds. */
struct SunFit {
  draw::View view;
  /** In the lamp's axes, metres: the rectangle across and the range along the light. */
  glm::dvec3 min{0.0};
  glm::dvec3 max{0.0};
  /** The part of it that has to be there; the rest is slack. */
  glm::dvec3 needed_min{0.0};
  glm::dvec3 needed_max{0.0};

  /** Longer edge of a texel, metres. */
  [[nodiscard]] double texel(int size_px) const
  {
    return glm::max(max.x - min.x, max.y - min.y) / size_px;
  }
};

/** What is seen, for a sun to be fitted to. */
struct VisibleRange {
  /** Corners of what is visible, world space. \see visible_corners */
  std::vector<glm::dvec3> corners;
  /** Distances along the view's direction, metres, that hold all of it; above 0 in perspective. */
  double near = 0.0;
  double far = 0.0;
};

/** Of \a corners, in \a view. */
[[nodiscard]] VisibleRange visible_range(const draw::View &view, std::vector<glm::dvec3> corners);

/** Narrow \a visible's near and far to what \a depths hold: a picture's reversed depths, 0 where there is nothing. */
void narrow_to_depths(const draw::View &view, std::span<const float> depths, VisibleRange &visible);

/**
 * Ends of \a count slices of [near, far], count + 1 numbers: the practical split scheme (Zhang et al. 2006),
 * λ · near · (far / near)^(i / count) + (1 - λ) · (near + (far - near) · i / count). Even where near is not above 0.
 */
[[nodiscard]] std::vector<double> cascade_splits(double near, double far, int count, double lambda);

/** Smallest sphere around what \a view shows from distance \a near to \a far. World space, metres. */
struct Sphere {
  glm::dvec3 center_ws{0.0};
  double radius = 0.0;
};
[[nodiscard]] Sphere slice_sphere(const draw::View &view, double near, double far);

/**
 * Maps of a sun, from fine to coarse: all but the last around a slice of the distance, the last around everything that
 * a caster can darken and \a visible holds; each from the first caster along the light to the last receiver. None
 * where nothing can be darkened; fewer where a slice's map would be no finer than the last.
 *
 * A map's extent changes in steps, its texels stand on a grid that is fixed in the world, and it is a little larger
 * than it must be: while it covers what a moved camera sees it need not be drawn again, and where it is, what stands
 * still keeps its texels.
 *
 * \a pixel_size: of the picture, at distance 1 (perspective) or anywhere (orthographic), metres. \a memory: for the
 * result; its content is lost.
 */
[[nodiscard]] std::vector<SunFit> fit_sun(const glm::mat4 &world_from_lamp, const draw::View &view,
                                          const VisibleRange &visible, const std::vector<Caster> &casters, int size_px,
                                          const CascadeSettings &settings, float pixel_size,
                                          std::vector<SunFit> memory = {});

/** Whether \a old serves where \a needed is asked for: it covers it, and its texels are not much larger. */
[[nodiscard]] bool still_fits(const SunFit &old, const SunFit &needed);

}  // namespace gnomon::eevee
