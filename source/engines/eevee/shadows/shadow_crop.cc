// SPDX-License-Identifier: MIT
#include "shadow_crop.hh"

#include "eevee_shadow_shared.h"

#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::eevee {

std::vector<VisibleBox> visible_boxes(std::span<const VisibleCluster> clusters)
{
  std::vector<VisibleBox> boxes;
  boxes.reserve(clusters.size());
  for (const VisibleCluster &cluster : clusters) {
    glm::dvec3 min = cluster.corners_ws[0];
    glm::dvec3 max = min;
    for (const glm::dvec3 &corner : cluster.corners_ws) {
      min = glm::min(min, corner);
      max = glm::max(max, corner);
    }
    boxes.push_back({0.5 * (min + max), 0.75 * (max - min)});
  }
  return boxes;
}

namespace {

/** A range of numbers, empty if its maximum is below its minimum. */
struct Range {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();

  /** The least absolute number. */
  [[nodiscard]] double least() const
  {
    return std::max({min, -max, 0.0});
  }
  /** Quotients of this range and \a other, which is above 0. */
  [[nodiscard]] Range over(const Range &other) const
  {
    return {min / (min < 0.0 ? other.min : other.max), max / (max > 0.0 ? other.min : other.max)};
  }
  void extend(const Range &other)
  {
    min = std::min(min, other.min);
    max = std::max(max, other.max);
  }
};

/** Extends a range of lookups by the filter's border, and rounds it outwards to steps of 1 / 255. */
glm::ivec2 with_border(const Range &ndc, int size_px)
{
  // The border is in texels of the cropped map. Half a texel more contains rounding.
  const double border = std::min((CUBE_BORDER_TEXELS + 0.5) / size_px, 0.25);
  const double wider = (ndc.max - ndc.min) * border / (1.0 - 2.0 * border);
  const double low = (ndc.min - wider + 1.0) * 127.5;
  const double high = (ndc.max + wider + 1.0) * 127.5;
  const int first = std::clamp(int(std::floor(low)), 0, 254);
  return {first, std::clamp(int(std::ceil(high)), first + 1, 255)};
}

}  // namespace

std::optional<MapCrop> map_crop(const draw::View &view, double inner, int size_px, std::span<const VisibleBox> boxes)
{
  const glm::dmat4 map_from_world(view.view_from_world());
  const glm::dmat3 rotation(map_from_world);
  const glm::dmat3 sizes(glm::abs(rotation[0]), glm::abs(rotation[1]), glm::abs(rotation[2]));
  const glm::dvec2 ndc_from_slope(view.clip_from_view()[0][0], view.clip_from_view()[1][1]);
  const glm::dvec2 slope_max = inner / ndc_from_slope;
  Range across;
  Range up;
  for (const VisibleBox &box : boxes) {
    const glm::dvec3 center(map_from_world * glm::dvec4(box.center_ws, 1.0));
    const glm::dvec3 half = sizes * box.half_ws;
    const Range x{center.x - half.x, center.x + half.x};
    const Range y{center.y - half.y, center.y + half.y};
    // The view is along -Z. A lookup at x and y is at least this far from the lamp's plane.
    const Range z{std::max({-center.z - half.z, x.least() / slope_max.x, y.least() / slope_max.y}), -center.z + half.z};
    if (!(z.max > 0.0 && z.min <= z.max)) {
      continue;
    }
    const bool surrounds_lamp = z.min <= 1e-6 * z.max;
    const Range whole_x{-slope_max.x, slope_max.x};
    const Range whole_y{-slope_max.y, slope_max.y};
    across.extend(surrounds_lamp ? whole_x : x.over(z));
    up.extend(surrounds_lamp ? whole_y : y.over(z));
  }
  const auto lookups = [&](const Range &slopes, int axis) {
    return Range{std::max(slopes.min * ndc_from_slope[axis], -inner), std::min(slopes.max * ndc_from_slope[axis], inner)};
  };
  const Range u = lookups(across, 0);
  const Range v = lookups(up, 1);
  if (!(u.min <= u.max && v.min <= v.max)) {
    return std::nullopt;
  }
  const glm::ivec2 columns = with_border(u, size_px);
  const glm::ivec2 rows = with_border(v, size_px);
  return MapCrop(columns.x, rows.x, columns.y, rows.y);
}

draw::View cropped_view(const draw::View &view, const MapCrop &crop)
{
  glm::mat4 clip_from_view = view.clip_from_view();
  const glm::vec2 scale = 1.0F / extent_of(crop);
  const glm::vec2 center(float(crop.x + crop.z) / 255.0F - 1.0F, float(crop.y + crop.w) / 255.0F - 1.0F);
  for (int axis = 0; axis < 2; axis++) {
    for (int column = 0; column < 4; column++) {
      clip_from_view[column][axis] =
          scale[axis] * (clip_from_view[column][axis] - center[axis] * clip_from_view[column][3]);
    }
  }
  return {view.view_from_world(), clip_from_view};
}

}  // namespace gnomon::eevee
