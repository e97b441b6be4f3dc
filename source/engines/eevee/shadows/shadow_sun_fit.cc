// SPDX-License-Identifier: MIT
#include "shadow_sun_fit.hh"

#include "shadow_casters.hh"
#include "shadow_sun_slices.hh"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace gnomon::eevee {

namespace {

/** Fraction of a map's extent that is added on each side, so that the camera can move before the map is drawn again. */
constexpr double slack = 1.0 / 32.0;
/** Map extents are powers of this number, so that small changes of the fit keep the size of the texels. */
const double extent_step = std::exp2(1.0 / 8.0);
/** Margin around the needed box for the filter kernel, texels. */
constexpr double margin_texels = 4.0;

/** A box in the axes of a lamp, in double precision. */
struct LampBox {
  glm::dvec3 min{std::numeric_limits<double>::infinity()};
  glm::dvec3 max{-std::numeric_limits<double>::infinity()};

  void extend(const glm::dvec3 &point)
  {
    min = glm::min(min, point);
    max = glm::max(max, point);
  }
};

/** The least and the greatest of the products of \a factor with \a a and \a b. */
std::pair<double, double> product_range(double factor, double a, double b)
{
  return std::minmax(factor * a, factor * b);
}

/**
 * The box of the eight corners. Each coordinate of a corner is a sum of three products, which is least where each of
 * them is. Sums are rounded monotonically, so that this is exactly the box of the rounded corners.
 */
LampBox box_in(const glm::dmat3 &lamp_from_world, const scene::Bounds &bounds)
{
  LampBox box;
  for (int axis = 0; axis < 3; axis++) {
    const auto [x_min, x_max] = product_range(lamp_from_world[0][axis], bounds.min.x, bounds.max.x);
    const auto [y_min, y_max] = product_range(lamp_from_world[1][axis], bounds.min.y, bounds.max.y);
    const auto [z_min, z_max] = product_range(lamp_from_world[2][axis], bounds.min.z, bounds.max.z);
    box.min[axis] = x_min + y_min + z_min;
    box.max[axis] = x_max + y_max + z_max;
  }
  return box;
}

/**
 * Whether a caster may shadow at least one receiver. A caster that is flat along an axis cannot if all receivers are on
 * its lit side. This excludes the ground of most scenes, which would extend the maps over the whole scene.
 */
bool can_darken(const scene::Bounds &caster, const scene::Bounds &receivers, const glm::vec3 &forward_ws)
{
  for (int axis = 0; axis < 3; axis++) {
    // The tolerance covers rounding only, so that thin casters in large scenes are not excluded.
    const float own_tolerance = 1e-6F * std::max(std::abs(caster.min[axis]), std::abs(caster.max[axis]));
    const float tolerance = own_tolerance + 1e-7F * receivers.radius();
    const bool is_flat = caster.max[axis] - caster.min[axis] <= own_tolerance;
    const bool is_below = forward_ws[axis] < 0.0F && receivers.min[axis] >= caster.min[axis] - tolerance;
    const bool is_above = forward_ws[axis] > 0.0F && receivers.max[axis] <= caster.max[axis] + tolerance;
    if (is_flat && (is_below || is_above)) {
      return false;
    }
  }
  return true;
}

/**
 * The box that all maps of a sun must cover: across the light, the intersection of receivers and casters; along the
 * light, from the first caster to the last receiver. Empty if no caster can shadow a receiver. Around the receivers,
 * it has a margin as wide as half of the penumbra of each caster. \a tangent: \see fit_sun.
 */
std::optional<LampBox> needed_box(const glm::mat4 &world_from_lamp, const std::vector<glm::dvec3> &receivers_ws,
                                  const std::vector<Caster> &casters, double tangent)
{
  // A sun has directions only; its position has no effect.
  const glm::dmat3 from_world = glm::transpose(glm::dmat3(world_from_lamp));
  const glm::vec3 forward_ws = -glm::vec3(world_from_lamp[2]);
  scene::Bounds receiver_bounds;
  LampBox receivers;
  for (const glm::dvec3 &point : receivers_ws) {
    receiver_bounds.extend(glm::vec3(point));
    receivers.extend(from_world * point);
  }
  LampBox above;
  for (const Caster &caster : casters) {
    const LampBox box = box_in(from_world, caster.bounds_ws);
    // The lamp shines along -Z, so that the casters of a receiver have larger z.
    const glm::dvec3 margin(glm::dvec2(tangent * std::max(box.max.z - receivers.min.z, 0.0)), 0.0);
    const glm::dvec3 min = glm::max(box.min, receivers.min - margin);
    const glm::dvec3 max = glm::min(box.max, receivers.max + margin);
    const bool overlaps = min.x <= max.x && min.y <= max.y && box.max.z >= receivers.min.z;
    if (overlaps && can_darken(caster.bounds_ws, receiver_bounds, forward_ws)) {
      above.extend({min.x, min.y, box.min.z});
      above.extend({max.x, max.y, box.max.z});
    }
  }
  LampBox needed = above;
  needed.min.z = receivers.min.z;
  if (receivers_ws.empty() || !(needed.min.x <= needed.max.x && needed.min.y <= needed.max.y)) {
    return std::nullopt;
  }
  return needed;
}

/** Fraction of the texels across a map that are inside of the margin. */
double inner_share(int size_px)
{
  return std::max(1.0 - 2.0 * margin_texels / size_px, 0.5);
}

/** Set the view of \a fit from its box. \a lamp_from_world: to the axes of the box. */
void set_view(SunFit &fit, const glm::dmat3 &lamp_from_world)
{
  const glm::dvec2 across(0.5 * (fit.min + fit.max));
  const glm::dvec3 center(across, 0.5 * (fit.min.z + fit.max.z) + glm::dot(fit.slope, across));
  const glm::dvec3 half = 0.5 * (fit.max - fit.min);
  glm::dmat4 view_from_world(lamp_from_world);
  view_from_world[3] = glm::dvec4(-center, 1.0);
  glm::mat4 clip_from_view = draw::orthographic(float(half.x), float(half.y), float(-half.z), float(half.z));
  for (int axis = 0; axis < 2; axis++) {
    clip_from_view[axis][2] = float(-fit.slope[axis] * double(clip_from_view[2][2]));
  }
  fit.view = draw::View(glm::mat4(view_from_world), clip_from_view);
}

/** \a lamp_from_world: to the axes of the box. \a is_stable: whether the extent has slack and steps, and the corner a
 * grid. */
SunFit fit_to(const LampBox &needed, const glm::dmat3 &lamp_from_world, int size_px, bool is_stable)
{
  SunFit fit;
  fit.is_stable = is_stable;
  fit.size_px = size_px;
  fit.needed_min = needed.min;
  fit.needed_max = needed.max;
  const glm::dvec3 extent = needed.max - needed.min;
  // The lower limits prevent an empty box: of casters without an extent, and where rounding leaves none.
  const glm::dvec3 reach = glm::max(glm::abs(needed.min), glm::abs(needed.max));
  const double size = std::max({extent.x, extent.y, extent.z, 1e-6, 1e-9 * std::max({reach.x, reach.y, reach.z})});
  for (int axis = 0; axis < 2; axis++) {
    const double slack_factor = is_stable ? 1.0 + 2.0 * slack : 1.0;
    const double wanted = std::max(extent[axis] * slack_factor, 1e-4 * size) / inner_share(size_px);
    const double center = 0.5 * (needed.min[axis] + needed.max[axis]);
    if (is_stable) {
      const double stepped = std::pow(extent_step, std::ceil(std::log(wanted) / std::log(extent_step) - 1e-9));
      const double texel = stepped / size_px;
      fit.min[axis] = std::floor((center - 0.5 * stepped) / texel) * texel;
      fit.max[axis] = fit.min[axis] + stepped;
    }
    else {
      fit.min[axis] = center - 0.5 * wanted;
      fit.max[axis] = center + 0.5 * wanted;
    }
  }
  fit.min.z = needed.min.z - slack * size;
  fit.max.z = needed.max.z + slack * size;
  fit.caster_length = fit.max.z - fit.min.z;
  set_view(fit, lamp_from_world);
  return fit;
}

/** Limit the depths of \a fit to those of \a receivers, which are in its axes. */
void fit_depths(SunFit &fit, const glm::dmat3 &lamp_from_world, std::span<const glm::dvec3> receivers)
{
  const DepthRange range = depth_range(receivers);
  fit.slope = range.slope;
  // Lookups are offset from receivers, and read the texels around them.
  const double margin = slack * (range.max - range.min) + margin_texels * fit.texel();
  fit.min.z = range.min - margin;
  fit.max.z = range.max + margin;
  fit.caster_length = std::max(fit.caster_length, fit.max.z - fit.min.z);
  set_view(fit, lamp_from_world);
}

}  // namespace

DepthRange depth_range(std::span<const glm::dvec3> points)
{
  glm::dvec3 mean(0.0);
  for (const glm::dvec3 &point : points) {
    mean += point / double(points.size());
  }
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  glm::dvec2 z(0.0);
  for (const glm::dvec3 &point : points) {
    const glm::dvec3 p = point - mean;
    xx += p.x * p.x;
    xy += p.x * p.y;
    yy += p.y * p.y;
    z += p.z * glm::dvec2(p);
  }
  const auto range_along = [&](const glm::dvec2 &slope) {
    DepthRange range{slope, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const glm::dvec3 &point : points) {
      const double distance = point.z - glm::dot(slope, glm::dvec2(point));
      range.min = std::min(range.min, distance);
      range.max = std::max(range.max, distance);
    }
    return range;
  };
  const DepthRange across = range_along(glm::dvec2(0.0));
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > 1e-12 * xx * yy)) {
    return across;
  }
  const DepthRange along = range_along(glm::dvec2(z.x * yy - z.y * xy, z.y * xx - z.x * xy) / determinant);
  return along.max - along.min < across.max - across.min ? along : across;
}

VisibleRange visible_range(const draw::View &view, std::vector<glm::dvec3> corners)
{
  VisibleRange visible;
  visible.near = std::numeric_limits<double>::infinity();
  visible.far = -visible.near;
  const glm::dmat4 view_from_world(view.view_from_world());
  for (const glm::dvec3 &corner : corners) {
    const double distance = -(view_from_world * glm::dvec4(corner, 1.0)).z;
    visible.near = std::min(visible.near, distance);
    visible.far = std::max(visible.far, distance);
  }
  if (view.is_perspective()) {
    // Rounding may place corners of the near plane in front of it.
    visible.near = std::max(visible.near, 1e-6 * std::max(visible.far, 1e-6));
  }
  visible.corners = std::move(corners);
  return visible;
}

/** The \a i-th number of cascade_splits. */
static double cascade_split(double near, double far, int i, int count, double lambda)
{
  if (i == 0 || i == count) {
    return i == 0 ? near : far;
  }
  const double share = double(i) / count;
  const double even = near + (far - near) * share;
  const double logarithmic = near > 0.0 ? near * std::pow(far / near, share) : even;
  return lambda * logarithmic + (1.0 - lambda) * even;
}

std::vector<double> cascade_splits(double near, double far, int count, double lambda)
{
  std::vector<double> splits;
  for (int i = 0; i <= count; i++) {
    splits.push_back(cascade_split(near, far, i, count, lambda));
  }
  return splits;
}

Sphere slice_sphere(const draw::View &view, double near, double far)
{
  const glm::dmat4 projection(view.clip_from_view());
  // The four corners and the centre (index 4) of the frustum's cross section at a distance, in view space.
  const auto frame_at = [&](double distance) {
    std::array<glm::dvec3, 5> points;
    for (std::size_t i = 0; i < 5; i++) {
      const glm::dvec2 ndc =
          i == 4 ? glm::dvec2(0.0) : glm::dvec2((i & 1U) != 0 ? 1.0 : -1.0, (i & 2U) != 0 ? 1.0 : -1.0);
      const double w = view.is_perspective() ? distance : 1.0;
      const glm::dvec2 offset(-distance * projection[2][0] + projection[3][0],
                              -distance * projection[2][1] + projection[3][1]);
      points[i] = {(ndc.x * w - offset.x) / projection[0][0], (ndc.y * w - offset.y) / projection[1][1], -distance};
    }
    return points;
  };
  const auto front = frame_at(near);
  const auto back = frame_at(far);
  // The centre is the point on the axis with the same distance to the near corners and the far corners.
  const double length = std::max(glm::distance(front[4], back[4]), 1e-12);
  const double front_sq = glm::dot(front[0] - front[4], front[0] - front[4]);
  const double back_sq = glm::dot(back[0] - back[4], back[0] - back[4]);
  const double along = std::clamp((length * length + back_sq - front_sq) / (2.0 * length), 0.0, length);
  const glm::dvec3 center = glm::mix(front[4], back[4], along / length);
  Sphere sphere;
  for (std::size_t i = 0; i < 4; i++) {
    sphere.radius = std::max({sphere.radius, glm::distance(center, front[i]), glm::distance(center, back[i])});
  }
  sphere.center_ws = glm::dvec3(glm::inverse(glm::dmat4(view.view_from_world())) * glm::dvec4(center, 1.0));
  return sphere;
}

namespace {

/** Fitted maps are not made smaller than this, texels. */
constexpr double size_min_px = 128.0;

/** Index of a choice of slices for a sun's maps, and the edge of the maps, texels. */
struct SlicePlan {
  std::size_t index;
  int size_px;
};

/**
 * The texels that a picture needs: those of the smallest number of slices that suffices. \a size_px: edge of the maps
 * that `choices` were made for, texels. \a enlarged_px: the largest edge, for the largest number of slices.
 */
SlicePlan sufficient_slices(const std::vector<SunSlices> &choices, int size_px, int enlarged_px,
                            const CascadeSettings &settings)
{
  const auto sufficient = std::ranges::find_if(
      choices, [](const SunSlices &slices) { return slices.error <= texel_in_pixels_max * texel_in_pixels_max; });
  const bool is_last = settings.count > 0 || sufficient == choices.end();
  const std::size_t index = is_last ? choices.size() - 1 : std::size_t(sufficient - choices.begin());
  const SunSlices &chosen = choices[index];
  // Without an error, nothing in shadow is seen yet. Other samples may see it.
  if (!settings.can_resize || chosen.error == 0.0) {
    return {index, size_px};
  }
  // Below 1, the error is proportional to the area of a texel.
  const double texel = std::sqrt(chosen.error);
  const double factor = texel_in_pixels / texel;
  const double size = size_px / std::pow(resize_step, std::floor(std::log(factor) / std::log(resize_step)));
  const bool can_enlarge = index + 1 == choices.size() && texel > settings.texel_in_pixels_enlarged;
  return {index, int(std::clamp(std::ceil(size), std::min(size_min_px, double(size_px)),
                                double(can_enlarge ? enlarged_px : size_px)))};
}

/**
 * The number of slices with the fewest texels that have the error of sufficient_slices, with texels that are smaller by
 * short_depth_gain if the sun has the array of maps for itself. \a enlarged_px: the largest edge for sufficient_slices.
 * \a size_max_px, \a edge_max_px: \see fit_sun.
 */
SlicePlan plan_slices(const std::vector<SunSlices> &choices, int size_px, int enlarged_px, int size_max_px,
                      int edge_max_px, const CascadeSettings &settings)
{
  SlicePlan plan = sufficient_slices(choices, size_px, enlarged_px, settings);
  // Beside the maps of other lamps, depths have 32 bits.
  const double gain = edge_max_px > size_max_px ? short_depth_gain : 1.0;
  const double error = choices[plan.index].error * std::pow(double(size_px) / (gain * plan.size_px), 2.0);
  if (!settings.can_resize || settings.count > 0 || error == 0.0) {
    return plan;
  }
  plan.size_px = std::min(int(std::ceil(gain * plan.size_px)), size_max_px);
  const auto map_count = [&](std::size_t i) { return double(choices[i].slices.size() + 1); };
  const auto texels = [&](const SlicePlan &one) { return map_count(one.index) * one.size_px * one.size_px; };
  for (std::size_t i = 0; i < choices.size(); i++) {
    const double size = std::max(std::ceil(size_px * std::sqrt(choices[i].error / error)), size_min_px);
    const double most = std::min(size_max_px * std::sqrt(cascade_count_max / map_count(i)), double(edge_max_px));
    if (size <= most && texels({i, int(size)}) < texels(plan)) {
      plan = {i, int(size)};
    }
  }
  return plan;
}

/** The corners of the clusters that are partly inside of \a fit, in its axes. */
void find_receivers(const SunFit &fit, const glm::dmat3 &lamp_from_world, std::span<const VisibleCluster> clusters,
                    std::vector<glm::dvec3> &receivers)
{
  receivers.clear();
  for (const VisibleCluster &cluster : clusters) {
    LampBox box;
    for (const glm::dvec3 &corner : cluster.corners_ws) {
      receivers.push_back(lamp_from_world * corner);
      box.extend(receivers.back());
    }
    if (box.max.x < fit.min.x || box.min.x > fit.max.x || box.max.y < fit.min.y || box.min.y > fit.max.y) {
      receivers.resize(receivers.size() - cluster.corners_ws.size());
    }
  }
}

/** Fill \a fits with cascades around \a clusters, and one around \a needed behind them. */
void fit_to_clusters(const LampBox &needed, const glm::dmat3 &lamp_from_world, const draw::View &view,
                     const VisibleRange &visible, std::span<const VisibleCluster> clusters, int size_max_px,
                     int edge_max_px, const CascadeSettings &settings, float pixel_size, std::vector<SunFit> &fits)
{
  const int size_px = settings.can_resize ? std::max(int(std::lround(size_max_px / size_growth_max)), 1) : size_max_px;
  const int enlarged_px = settings.can_resize ? int(std::lround(resize_step * size_px)) : size_px;
  // All maps have one size.
  const auto slices_at = [&](int px) {
    const SunFit whole = fit_to(needed, lamp_from_world, px, false);
    return sun_slices(clusters,
                      {.lamp_from_world = lamp_from_world,
                       .whole_min = glm::dvec2(whole.min),
                       .whole_max = glm::dvec2(whole.max),
                       .whole_texel = glm::dvec2(whole.max - whole.min) / double(px),
                       .slice_px = inner_share(px) * px,
                       .is_perspective = view.is_perspective(),
                       .pixel_size = pixel_size},
                      (settings.count > 0 ? settings.count : cascade_count_max) - 1);
  };
  std::vector<SunSlices> choices = slices_at(size_px);
  const SlicePlan plan = plan_slices(choices, size_px, enlarged_px, size_max_px, edge_max_px, settings);
  if (plan.size_px != size_px) {
    // The margin of the coarsest map is wider if its texels are larger.
    choices = slices_at(plan.size_px);
  }
  std::vector<glm::dvec3> receivers;
  for (const SunSlice &slice : choices[plan.index].slices) {
    const LampBox box{{slice.min, needed.min.z}, {slice.max, needed.max.z}};
    const glm::dmat3 slice_from_world = turned(lamp_from_world, slice.turn);
    SunFit fit = fit_to(box, slice_from_world, plan.size_px, false);
    fit.turn = slice.turn;
    find_receivers(fit, slice_from_world, clusters, receivers);
    if (!receivers.empty()) {
      fit_depths(fit, slice_from_world, receivers);
    }
    fits.push_back(std::move(fit));
  }
  std::ranges::sort(fits, {}, [&](const SunFit &fit) { return fit.texel(); });
  fits.push_back(fit_to(needed, lamp_from_world, plan.size_px, false));
  receivers.clear();
  for (const glm::dvec3 &corner : visible.corners) {
    receivers.push_back(lamp_from_world * corner);
  }
  fit_depths(fits.back(), lamp_from_world, receivers);
}

}  // namespace

std::vector<SunFit> fit_sun(const glm::mat4 &world_from_lamp, const draw::View &view, const VisibleRange &visible,
                            const std::vector<Caster> &casters, int size_px, const CascadeSettings &settings,
                            float pixel_size, std::vector<SunFit> memory, double tangent,
                            std::span<const VisibleCluster> clusters, int edge_max_px)
{
  std::vector<SunFit> fits = std::move(memory);
  fits.clear();
  const std::optional<LampBox> needed = needed_box(world_from_lamp, visible.corners, casters, tangent);
  if (!needed) {
    return fits;
  }
  const glm::dmat3 lamp_from_world = glm::transpose(glm::dmat3(world_from_lamp));
  // One map must cover all receivers.
  if (settings.count != 1 && !clusters.empty()) {
    fit_to_clusters(*needed, lamp_from_world, view, visible, clusters, size_px, std::max(edge_max_px, size_px),
                    settings, pixel_size, fits);
    return fits;
  }
  const SunFit whole = fit_to(*needed, lamp_from_world, size_px, true);
  /** \return whether texels are no larger than pixels. */
  const auto make_fits = [&](int count) {
    bool is_fine = true;
    fits.clear();
    for (int i = 0; i < count; i++) {
      const double slice_near = cascade_split(visible.near, visible.far, i, count, settings.lambda);
      const double slice_far = cascade_split(visible.near, visible.far, i + 1, count, settings.lambda);
      const double pixel = view.is_perspective() ? pixel_size * slice_near : pixel_size;
      SunFit fit = whole;
      if (i < count - 1) {
        const Sphere sphere = slice_sphere(view, slice_near, slice_far);
        const glm::dvec3 center = lamp_from_world * sphere.center_ws;
        LampBox box{center - sphere.radius, center + sphere.radius};
        box.min.z = needed->min.z;
        box.max.z = needed->max.z;
        fit = fit_to(box, lamp_from_world, size_px, true);
      }
      is_fine = is_fine && std::min(fit.texel(), whole.texel()) <= pixel;
      // If the last cascade is no coarser than the cascade of this slice, it replaces this and all other slices.
      if (i == count - 1 || fit.texel() >= whole.texel()) {
        fits.push_back(whole);
        break;
      }
      fits.push_back(fit);
    }
    return is_fine;
  };
  if (settings.count > 0) {
    make_fits(settings.count);
    return fits;
  }
  int count = 1;
  while (!make_fits(count) && count < cascade_count_max) {
    count++;
  }
  return fits;
}

bool still_fits(const SunFit &old, const SunFit &needed)
{
  if (!needed.is_stable) {
    // A picture must not depend on the pictures before it.
    return old.turn == needed.turn && old.size_px == needed.size_px && old.min == needed.min && old.max == needed.max &&
           old.slope == needed.slope;
  }
  // Extents change in steps. A difference of two steps does not justify drawing the map again.
  const double size_ratio_max = std::pow(extent_step, 2.5);
  const glm::dvec3 old_size = old.max - old.min;
  const glm::dvec3 size = needed.max - needed.min;
  return old.turn == needed.turn && old.size_px == needed.size_px &&
         glm::all(glm::lessThanEqual(old.min, needed.needed_min)) &&
         glm::all(glm::greaterThanEqual(old.max, needed.needed_max)) && old_size.x <= size_ratio_max * size.x &&
         old_size.y <= size_ratio_max * size.y;
}

}  // namespace gnomon::eevee
