// SPDX-License-Identifier: MIT
#include "shadow_sun_slices.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace gnomon::eevee {

namespace {

/** Number of directions that are tried for the axes of a slice. */
constexpr std::size_t turn_count = 6;
constexpr std::size_t range_count = distance_range_count;
constexpr double unbounded = std::numeric_limits<double>::infinity();

struct SliceRectangle {
  glm::dvec2 min{unbounded};
  glm::dvec2 max{-unbounded};

  void extend(const SliceRectangle &other)
  {
    min = glm::min(min, other.min);
    max = glm::max(max, other.max);
  }
};

/** The visible surfaces in one range of the distance that can be in shadow. */
struct SurfaceRange {
  /** Around the surfaces, for each turn. */
  std::array<SliceRectangle, turn_count> rectangles;
  double pixel_count = 0.0;
  /** Mean edge of the pixels at the surfaces, metres. */
  double pixel = 0.0;

  [[nodiscard]] double weight() const
  {
    return pixel_count * pixel;
  }
};

using VisibleRanges = std::array<SurfaceRange, range_count>;

double slice_turn(std::size_t i)
{
  return 0.5 * std::numbers::pi * double(i) / double(turn_count);
}

VisibleRanges visible_ranges(std::span<const VisibleCluster> clusters, const SliceConditions &conditions)
{
  VisibleRanges ranges;
  std::array<glm::dvec2, turn_count> axes;
  for (std::size_t i = 0; i < turn_count; i++) {
    axes[i] = {std::cos(slice_turn(i)), std::sin(slice_turn(i))};
  }
  for (const VisibleCluster &cluster : clusters) {
    std::array<SliceRectangle, turn_count> rectangles;
    for (const glm::dvec3 &corner : cluster.corners_ws) {
      const glm::dvec2 p(conditions.lamp_from_world * corner);
      for (std::size_t i = 0; i < turn_count; i++) {
        const glm::dvec2 q(axes[i].x * p.x + axes[i].y * p.y, axes[i].x * p.y - axes[i].y * p.x);
        rectangles[i].extend({q, q});
      }
    }
    // The first turn is 0.
    const SliceRectangle &straight = rectangles[0];
    if (glm::any(glm::lessThan(straight.max, conditions.whole_min)) ||
        glm::any(glm::greaterThan(straight.min, conditions.whole_max))) {
      continue;
    }
    SurfaceRange &range = ranges[std::size_t(cluster.range)];
    for (std::size_t i = 0; i < turn_count; i++) {
      range.rectangles[i].extend(rectangles[i]);
    }
    range.pixel_count += cluster.pixel_count;
    range.pixel += cluster.pixel_count * conditions.pixel_size * (conditions.is_perspective ? cluster.distance : 1.0);
  }
  for (SurfaceRange &range : ranges) {
    range.pixel = range.pixel_count > 0.0 ? range.pixel / range.pixel_count : 1.0;
  }
  return ranges;
}

/** Around the map behind all slices, for each turn. */
std::array<SliceRectangle, turn_count> whole_rectangles(const SliceConditions &conditions)
{
  std::array<SliceRectangle, turn_count> rectangles;
  for (std::size_t i = 0; i < turn_count; i++) {
    const glm::dmat3 turn = turned(glm::dmat3(1.0), slice_turn(i));
    for (const double x : {conditions.whole_min.x, conditions.whole_max.x}) {
      for (const double y : {conditions.whole_min.y, conditions.whole_max.y}) {
        const glm::dvec2 corner(turn * glm::dvec3(x, y, 0.0));
        rectangles[i].extend({corner, corner});
      }
    }
  }
  return rectangles;
}

/** Error of the pixels of a range if texels have the edges \a texel. \see SunSlices::error */
double range_error(const SurfaceRange &range, const glm::dvec2 &texel)
{
  return range.weight() * 0.5 * glm::dot(texel, texel) / (range.pixel * range.pixel);
}

/** Error of the ranges from an index on without a slice. */
using ErrorsBehind = std::array<double, range_count + 1>;

/** The best slice of a run of ranges. */
struct SliceRun {
  double error = 0.0;
  /** Empty: its limits are reversed. */
  SunSlice slice{.min = glm::dvec2(unbounded), .max = glm::dvec2(-unbounded)};
};
/** Runs of the ranges first to end - 1, at [first][end]. */
using SliceRuns = std::vector<std::array<SliceRun, range_count + 1>>;

SliceRuns slice_runs(const VisibleRanges &ranges, const SliceConditions &conditions, const ErrorsBehind &errors_behind)
{
  SliceRuns runs(range_count);
  const std::array<SliceRectangle, turn_count> whole = whole_rectangles(conditions);
  for (std::size_t first = 0; first < range_count; first++) {
    std::array<SliceRectangle, turn_count> rectangles;
    for (std::size_t end = first + 1; end <= range_count; end++) {
      SliceRun &run = runs[first][end];
      // Without a finer slice, the map behind all slices serves the ranges.
      run.error = errors_behind[first] - errors_behind[end];
      for (std::size_t i = 0; i < turn_count; i++) {
        rectangles[i].extend(ranges[end - 1].rectangles[i]);
        const glm::dvec2 min = glm::max(rectangles[i].min, whole[i].min);
        const glm::dvec2 max = glm::min(rectangles[i].max, whole[i].max);
        const glm::dvec2 texel = glm::max(max - min, glm::dvec2(0.0)) / conditions.slice_px;
        double error = 0.0;
        for (std::size_t range = first; range < end; range++) {
          error += range_error(ranges[range], texel);
        }
        const bool is_finer = std::max(texel.x, texel.y) < std::max(conditions.whole_texel.x, conditions.whole_texel.y);
        if (is_finer && error < run.error) {
          run = {error, {slice_turn(i), min, max}};
        }
      }
    }
  }
  return runs;
}

/** A choice of slices for the ranges up to some range. */
struct SliceChoice {
  double error = unbounded;
  /** First range of the last slice. */
  std::size_t first = 0;
};

}  // namespace

glm::dmat3 turned(const glm::dmat3 &lamp_from_world, double turn)
{
  const double x = std::cos(turn);
  const double y = std::sin(turn);
  return glm::dmat3(x, -y, 0.0, y, x, 0.0, 0.0, 0.0, 1.0) * lamp_from_world;
}

std::vector<SunSlices> sun_slices(std::span<const VisibleCluster> clusters, const SliceConditions &conditions,
                                  int count_max)
{
  const VisibleRanges ranges = visible_ranges(clusters, conditions);
  double weight = 0.0;
  ErrorsBehind errors_behind{};
  for (std::size_t i = range_count; i > 0; i--) {
    weight += ranges[i - 1].weight();
    errors_behind[i - 1] = errors_behind[i] + range_error(ranges[i - 1], conditions.whole_texel);
  }
  const SliceRuns runs = slice_runs(ranges, conditions, errors_behind);
  // choices[count][end]: the ranges before `end` have `count` slices.
  std::vector<std::array<SliceChoice, range_count + 1>> choices(std::size_t(count_max) + 1);
  choices[0][0].error = 0.0;
  std::vector<SunSlices> result(std::size_t(count_max) + 1);
  for (std::size_t count = 0; count <= std::size_t(count_max); count++) {
    for (std::size_t end = 1; count > 0 && end <= range_count; end++) {
      SliceChoice &choice = choices[count][end];
      for (std::size_t first = 0; first < end; first++) {
        const double error = choices[count - 1][first].error + runs[first][end].error;
        if (error < choice.error) {
          choice = {error, first};
        }
      }
    }
    double least = unbounded;
    std::size_t end = 0;
    for (std::size_t i = 0; i <= range_count; i++) {
      const double error = choices[count][i].error + errors_behind[i];
      if (error < least) {
        least = error;
        end = i;
      }
    }
    SunSlices &slices = result[count];
    slices.error = weight > 0.0 ? least / weight : 0.0;
    for (std::size_t i = count; i > 0; i--) {
      const std::size_t first = choices[i][end].first;
      const SunSlice &slice = runs[first][end].slice;
      if (glm::all(glm::lessThanEqual(slice.min, slice.max))) {
        slices.slices.insert(slices.slices.begin(), slice);
      }
      end = first;
    }
    if (count > 0 && result[count - 1].error <= slices.error) {
      slices = result[count - 1];
    }
  }
  return result;
}

}  // namespace gnomon::eevee
