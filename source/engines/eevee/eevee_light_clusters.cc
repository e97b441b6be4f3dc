// SPDX-License-Identifier: MIT
#include "eevee_light_clusters.hh"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gnomon::eevee {

namespace {

/** Columns of the grid, and rows if the picture is as high as wide. */
constexpr int column_count_max = 24;
constexpr int slice_count_max = 24;
/** A froxel is not narrower than this. */
constexpr int column_px_min = 8;
/** The first slice of a perspective view ends at least at this fraction of the depth of the last one. */
constexpr float first_depth_min = 1.0F / 64.0F;
/** Pixels around the picture that the grid covers, because samples are offset within their pixel. */
constexpr double margin_px = 1.0;
/** 32 units in the last place. The sums of light_froxel and of this file have fewer roundings. */
constexpr double rounding_epsilon = 2e-6;
/** Error of the logarithm of a depth that drivers may make: the relative error of the depth. */
constexpr float log_error = 1e-3F;
/** Fraction by which the reach of a light is enlarged, as its squares are rounded. */
constexpr float reach_margin = 1e-4F;

double length_of(const glm::dvec4 &plane)
{
  return glm::length(glm::dvec3(plane));
}

}  // namespace

/** Set the rows of the block's matrix, and the planes between columns and rows. */
void LightClusters::set_grid(const draw::View &view, glm::ivec2 size_px)
{
  const glm::dmat4 from_view = glm::transpose(glm::dmat4(view.clip_from_view()));
  const glm::dvec4 w = from_view[3];
  const glm::dvec2 widening = 1.0 + 2.0 * margin_px / glm::dvec2(size_px);
  rounding_ = rounding_m_ = 0.0F;
  /** \return the row of the matrix that gives indices along an axis */
  const auto split = [&](const glm::dvec4 &ndc, int count, std::vector<Plane> &planes) {
    const glm::dvec4 index = double(count) * 0.5 * (ndc + w);
    planes.clear();
    for (int i = 0; i <= count; i++) {
      const glm::dvec4 plane = index - double(i) * w;
      const double length = std::max(length_of(plane), 1e-300);
      planes.push_back({glm::vec3(plane / length), float(plane.w / length)});
      const double scale = rounding_epsilon / length;
      rounding_ = std::max(rounding_, float(scale * (length_of(index) + i * length_of(w))));
      rounding_m_ = std::max(rounding_m_, float(scale * (std::abs(index.w) + i * std::abs(w.w))));
    }
    return index;
  };
  glm::dmat4 rows(1.0);
  rows[0] = split(from_view[0] / widening.x, block_.column_count, columns_);
  rows[1] = split(from_view[1] / widening.y, block_.row_count, rows_);
  rows[2] = glm::dvec4(0.0, 0.0, -1.0, 0.0);
  rows[3] = w;
  block_.grid_from_world = glm::mat4(glm::transpose(rows) * glm::dmat4(view.view_from_world()));
}

/** Find the lights whose reach touches the view, in the order of the lights. */
void LightClusters::find_locals(const Lamps &lamps, const draw::View &view)
{
  locals_.clear();
  const glm::dmat4 view_from_world(view.view_from_world());
  const auto eye = float(glm::length(glm::dvec3(view_from_world[3])));
  const glm::vec4 &near = view.frustum_planes_ws()[4];
  const glm::vec4 &far = view.frustum_planes_ws()[5];
  for (std::size_t i = 0; i < lamps.reaches.size(); i++) {
    const LightReach &reach = lamps.reaches[i];
    if (reach.is_everywhere()) {
      continue;
    }
    const float magnitude = glm::length(reach.center_ws) + reach.radius + eye;
    const Sphere sphere{glm::vec3(view_from_world * glm::dvec4(reach.center_ws, 1.0)),
                        reach.radius * (1.0F + reach_margin) + rounding_ * magnitude + rounding_m_};
    const auto is_behind = [&](const glm::vec4 &plane_ws) {
      return glm::dot(plane_ws, glm::vec4(reach.center_ws, 1.0F)) < -sphere.radius;
    };
    if (is_behind(near) || is_behind(far) || columns_.front().distance(sphere.center) < -sphere.radius ||
        columns_.back().distance(sphere.center) > sphere.radius ||
        rows_.front().distance(sphere.center) < -sphere.radius ||
        rows_.back().distance(sphere.center) > sphere.radius) {
      continue;
    }
    locals_.push_back({sphere, std::uint32_t(i)});
  }
}

/** Depths between the near and the far plane of \a view at which there may be surfaces. \a bounds_ws: of these. */
LightClusters::Slab LightClusters::visible_depths(const draw::View &view, const scene::Bounds &bounds_ws)
{
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const glm::dmat4 view_from_clip = glm::inverse(glm::dmat4(view.clip_from_view()));
  const auto depth_of_plane = [&](double clip_z) {
    const glm::dvec4 point = view_from_clip * glm::dvec4(0.0, 0.0, clip_z, 1.0);
    return -point.z / point.w;
  };
  Slab visible{-infinity, infinity};
  if (!bounds_ws.is_empty()) {
    const scene::Bounds bounds_vs = scene::transformed(bounds_ws, view.view_from_world());
    visible = {-bounds_vs.max.z, -bounds_vs.min.z};
  }
  // fmax and fmin skip a NaN. An infinite far plane has a depth of infinity, or of NaN.
  return {std::fmax(visible.near, float(depth_of_plane(1.0))), std::fmin(visible.far, float(depth_of_plane(0.0)))};
}

/**
 * Divide the depths of the lights' reaches that are \a visible into slices. The first and the last one have no end
 * there.
 */
void LightClusters::set_slices(const Slab &visible)
{
  constexpr float infinity = std::numeric_limits<float>::infinity();
  float near = infinity;
  float far = -infinity;
  for (const Local &local : locals_) {
    near = std::min(near, -local.sphere.center.z - local.sphere.radius);
    far = std::max(far, -local.sphere.center.z + local.sphere.radius);
  }
  near = std::max(near, visible.near);
  far = std::min(far, visible.far);
  const bool is_perspective = block_.is_perspective != 0;
  if (is_perspective) {
    near = std::max(near, first_depth_min * far);
  }
  const double first = is_perspective ? std::log(double(near)) : double(near);
  const double step = ((is_perspective ? std::log(double(far)) : double(far)) - first) / block_.slice_count;
  // The step is NaN if all reaches end behind the eye.
  const bool is_one = !std::isfinite(first) || !(step > 1e-6 * std::max(std::abs(first), 1.0));
  block_.slice_count = is_one ? 1 : block_.slice_count;
  block_.slice_scale = is_one ? 0.0F : float(1.0 / step);
  block_.slice_bias = is_one ? 0.0F : float(-first / step);
  slices_.clear();
  for (int i = 0; i < block_.slice_count; i++) {
    Slab &slab = slices_.emplace_back(Slab{is_perspective ? 0.0F : -infinity, infinity});
    const auto depth = [&](int plane) {
      const double f = first + plane * step;
      return float(is_perspective ? std::exp(f) : f);
    };
    const auto margin = [&](float at) {
      return is_perspective ? log_error * at : float(rounding_epsilon) * (std::abs(near) + std::abs(far));
    };
    if (i > 0) {
      slab.near = depth(i) - margin(depth(i));
    }
    if (i + 1 < block_.slice_count) {
      slab.far = depth(i + 1) + margin(depth(i + 1));
    }
  }
}

void LightClusters::add_row(const Sphere &part, int slice, int row, std::uint32_t light)
{
  const int count = block_.column_count;
  // A light whose centre is behind the eye can reach columns that are not in order of these distances.
  const auto touches = [&](int column) {
    return columns_[std::size_t(column)].distance(part.center) >= -part.radius &&
           columns_[std::size_t(column) + 1].distance(part.center) <= part.radius;
  };
  int first = 0;
  while (first < count && !touches(first)) {
    first++;
  }
  int end = count;
  while (end > first && !touches(end - 1)) {
    end--;
  }
  if (end == first) {
    return;
  }
  const auto row_first = std::uint32_t((slice * block_.row_count + row) * count);
  runs_.push_back({row_first + std::uint32_t(first), std::uint32_t(end - first), light});
  run_entries_ += std::size_t(end - first);
}

void LightClusters::add_slice(const Sphere &part, int slice, std::uint32_t light)
{
  float high = rows_.front().distance(part.center);
  for (int row = 0; row < block_.row_count; row++) {
    const float low = high;
    const Plane &next = rows_[std::size_t(row) + 1];
    high = next.distance(part.center);
    if (low < -part.radius || high > part.radius) {
      continue;
    }
    // The part of a ball beyond a plane is within the ball around the circle that the plane cuts out of it.
    const Plane &cut = low < 0.0F ? rows_[std::size_t(row)] : next;
    const float gap = low < 0.0F ? low : std::max(high, 0.0F);
    const float radius_sq = part.radius * part.radius - gap * gap;
    add_row({part.center - gap * cut.normal, std::sqrt(std::max(radius_sq, 0.0F))}, slice, row, light);
  }
}

bool LightClusters::find_runs(std::size_t most)
{
  runs_.clear();
  run_entries_ = 0;
  const std::size_t header_count = 2 * froxel_count() + 1;
  for (const auto &[sphere, light] : locals_) {
    const float depth = -sphere.center.z;
    for (int slice = 0; slice < block_.slice_count; slice++) {
      const Slab &slab = slices_[std::size_t(slice)];
      // Positive: the slice is beyond the centre; negative: it is before the centre.
      const float gap = std::max(slab.near - depth, 0.0F) - std::max(depth - slab.far, 0.0F);
      if (std::abs(gap) > sphere.radius) {
        continue;
      }
      const float radius_sq = sphere.radius * sphere.radius - gap * gap;
      add_slice({sphere.center - glm::vec3(0.0F, 0.0F, gap), std::sqrt(std::max(radius_sq, 0.0F))}, slice, light);
      if (header_count + run_entries_ > most) {
        return false;
      }
    }
  }
  return true;
}

void LightClusters::write_values()
{
  const std::size_t count = froxel_count();
  ends_.assign(count, 0);
  values_.assign(2 * count + 1 + run_entries_, 0.0F);
  for (const Run &run : runs_) {
    const bool is_cube = int(run.light) < block_.cube_light_count;
    for (std::size_t froxel = run.first; froxel < run.first + run.count; froxel++) {
      ends_[froxel]++;
      values_[2 * froxel + 1] += is_cube ? 1.0F : 0.0F;
    }
  }
  auto next = std::uint32_t(2 * count + 1);
  for (std::size_t froxel = 0; froxel < count; froxel++) {
    values_[2 * froxel] = float(next);
    next += std::exchange(ends_[froxel], next);
  }
  values_[2 * count] = float(next);
  // The runs are in the order of the lights, and so are the entries of each froxel.
  for (const Run &run : runs_) {
    for (std::size_t froxel = run.first; froxel < run.first + run.count; froxel++) {
      values_[ends_[froxel]++] = float(run.light);
    }
  }
}

void LightClusters::build(const Lamps &lamps, const draw::View &view, glm::ivec2 size_px,
                          const scene::Bounds &bounds_ws, std::size_t device_values_max)
{
  const Slab visible = visible_depths(view, bounds_ws);
  block_ = {};
  block_.is_perspective = view.is_perspective() ? 1 : 0;
  block_.cube_light_count = lamps.cube_light_count;
  block_.cube_everywhere_count = lamps.cube_everywhere_count;
  block_.other_everywhere_count = lamps.other_everywhere_count;
  block_.surface_point_count = lamps.surface_point_count;
  block_.first_surface_point = lamps.light_count() - lamps.surface_point_count;
  const auto parts = [](int size, int most) { return std::clamp(size / column_px_min, 1, most); };
  const int rows_max = std::max(column_count_max * size_px.y / size_px.x, 1);
  block_.column_count = parts(size_px.x, column_count_max);
  block_.row_count = parts(size_px.y, std::min(rows_max, column_count_max));
  block_.slice_count = slice_count_max;
  set_grid(view, size_px);
  find_locals(lamps, view);
  const std::size_t most = std::min(std::max(values_max, locals_.size() + 3), device_values_max);
  for (;;) {
    if (locals_.empty()) {
      block_.column_count = block_.row_count = block_.slice_count = 1;
      set_grid(view, size_px);
    }
    set_slices(visible);
    if (find_runs(most)) {
      break;
    }
    block_.column_count = std::max(block_.column_count / 2, 1);
    block_.row_count = std::max(block_.row_count / 2, 1);
    block_.slice_count = std::max(block_.slice_count / 2, 1);
    set_grid(view, size_px);
  }
  write_values();
}

}  // namespace gnomon::eevee
