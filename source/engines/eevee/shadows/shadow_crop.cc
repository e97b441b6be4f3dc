// SPDX-License-Identifier: MIT
#include "shadow_crop.hh"

#include "eevee_shadow_shared.h"

#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace gnomon::eevee {

std::vector<VisibleBox> visible_boxes(std::span<const VisibleCluster> clusters)
{
  struct Group {
    glm::dvec3 min{std::numeric_limits<double>::infinity()};
    glm::dvec3 max{-std::numeric_limits<double>::infinity()};
    glm::dvec3 margin{0.0};
  };
  std::map<std::array<int, 3>, Group> groups;
  for (const VisibleCluster &cluster : clusters) {
    glm::dvec3 min = cluster.corners_ws[0];
    glm::dvec3 max = min;
    for (const glm::dvec3 &corner : cluster.corners_ws) {
      min = glm::min(min, corner);
      max = glm::max(max, corner);
    }
    Group &group = groups[{cluster.square.x / 4, cluster.square.y / 4, cluster.range}];
    group.min = glm::min(group.min, min);
    group.max = glm::max(group.max, max);
    group.margin = glm::max(group.margin, 0.25 * (max - min));
  }
  std::vector<VisibleBox> boxes;
  boxes.reserve(groups.size());
  for (const auto &[key, group] : groups) {
    boxes.push_back({0.5 * (group.min + group.max), 0.5 * (group.max - group.min) + group.margin});
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

/** The steps of 1 / 255 of the map that contain a range of lookups, -1 to 1, and the filter's border. */
glm::ivec2 steps_with_border(const Range &ndc, int size_px)
{
  const double low = (ndc.min + 1.0) * 127.5;
  const double high = (ndc.max + 1.0) * 127.5;
  glm::ivec2 steps(std::clamp(int(std::floor(low)), 0, 254), std::clamp(int(std::ceil(high)), 1, 255));
  // The border is in texels of the cropped map. A tenth of a texel more contains rounding.
  const double border = std::min((CUBE_BORDER_TEXELS + 0.1) / size_px, 0.25);
  const auto border_steps = [&] { return border * (steps.y - steps.x); };
  while ((steps.x > 0 && low - steps.x < border_steps()) || (steps.y < 255 && steps.y - high < border_steps())) {
    steps.x -= steps.x > 0 && low - steps.x < border_steps() ? 1 : 0;
    steps.y += steps.y < 255 && steps.y - high < border_steps() ? 1 : 0;
  }
  return steps;
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
    // The view is along -Z.
    if (center.z >= half.z) {
      continue;
    }
    // A lookup at x and y is at least this far from the lamp's plane.
    const Range z{std::max({-center.z - half.z, x.least() / slope_max.x, y.least() / slope_max.y}), -center.z + half.z};
    if (z.min > z.max) {
      continue;
    }
    const bool surrounds_lamp = z.min <= 1e-6 * z.max;
    const Range whole_x{-slope_max.x, slope_max.x};
    const Range whole_y{-slope_max.y, slope_max.y};
    across.extend(surrounds_lamp ? whole_x : x.over(z));
    up.extend(surrounds_lamp ? whole_y : y.over(z));
  }
  const auto lookups = [&](const Range &slopes, int axis) {
    return Range{std::max(slopes.min * ndc_from_slope[axis], -inner),
                 std::min(slopes.max * ndc_from_slope[axis], inner)};
  };
  const Range u = lookups(across, 0);
  const Range v = lookups(up, 1);
  if (!(u.min <= u.max && v.min <= v.max)) {
    return std::nullopt;
  }
  const glm::ivec2 columns = steps_with_border(u, size_px);
  const glm::ivec2 rows = steps_with_border(v, size_px);
  return MapCrop(columns.x, rows.x, columns.y, rows.y);
}

MapCrop united(const MapCrop &a, const MapCrop &b)
{
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.z, b.z), std::max(a.w, b.w)};
}

draw::View cropped_view(const draw::View &view, const glm::vec2 &center_ndc, const glm::vec2 &scale)
{
  glm::mat4 clip_from_view = view.clip_from_view();
  for (int axis = 0; axis < 2; axis++) {
    for (int column = 0; column < 4; column++) {
      clip_from_view[column][axis] =
          scale[axis] * (clip_from_view[column][axis] - center_ndc[axis] * clip_from_view[column][3]);
    }
  }
  return {view.view_from_world(), clip_from_view};
}

draw::View cropped_view(const draw::View &view, const MapCrop &crop)
{
  const glm::vec2 center(float(crop.x + crop.z) / 255.0F - 1.0F, float(crop.y + crop.w) / 255.0F - 1.0F);
  return cropped_view(view, center, 1.0F / extent_of(crop));
}

}  // namespace gnomon::eevee
