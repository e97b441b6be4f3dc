// SPDX-License-Identifier: MIT
#include "internal/eevee_world_occlusion.hh"

#include "scene_parallel.hh"

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

namespace gnomon::eevee {

namespace {

/** The first rays of a probe of the scene, which find surfaces that face it. */
constexpr int body_rays = 32;
/** Offset of the probes of write() from the multiples of their distance, in distances. Surfaces are often at multiples.
 */
constexpr double place_offset = 0.4142;
/** Levels of write() from a distance of probes to twice that distance. */
constexpr double levels_per_octave = 8.0;

constexpr std::size_t probe_rays = 256;

/**
 * Directions of the rays of a probe. They are even over the sphere, and mirrored in all axes: a plane that is
 * perpendicular to one blocks exactly a half of the light along the others. Probes have different variants, so that a
 * mean over some probes has more directions.
 */
std::array<glm::vec3, probe_rays> ray_directions(std::size_t variant)
{
  constexpr std::size_t octants = 8;
  std::array<glm::vec3, probe_rays> directions;
  for (std::size_t first = 0; first < probe_rays; first += octants) {
    // The first rays are even over the sphere, too: 9 and 32 have no common factor.
    const auto i = double(9 * (first / octants) % (probe_rays / octants));
    const double y = (i + 0.5) * octants / probe_rays;
    const double across = std::sqrt(1.0 - y * y);
    const double turn = i / std::numbers::phi + double(variant) / (std::numbers::phi * std::numbers::phi);
    const double azimuth = 0.5 * std::numbers::pi * (turn - std::floor(turn));
    const glm::vec3 direction(across * std::cos(azimuth), y, across * std::sin(azimuth));
    for (int octant = 0; octant < int(octants); octant++) {
      const glm::ivec3 is_negative(octant & 1, octant >> 1 & 1, octant >> 2 & 1);
      directions[first + std::size_t(octant)] = direction * glm::vec3(1 - 2 * is_negative);
    }
  }
  return directions;
}

double luminance(const glm::dvec3 &radiance)
{
  return glm::dot(radiance, glm::dvec3(0.2126, 0.7152, 0.0722));
}

/** Directions in columns of azimuth and rows of height: cells of the same solid angle. */
constexpr glm::ivec2 grid(32, 16);

bool meets(const scene::Bounds &box, const glm::vec3 &origin, const glm::vec3 &direction)
{
  const glm::vec3 a = (box.min - origin) / direction;
  const glm::vec3 b = (box.max - origin) / direction;
  const glm::vec3 low = glm::min(a, b);
  const glm::vec3 high = glm::max(a, b);
  const float enter = std::max({low.x, low.y, low.z, 0.0F});
  // A ray within a face gives NaN, for which the result is true.
  return !(enter > 1.001F * std::min({high.x, high.y, high.z}));
}

glm::vec3 quotient_or_one(const glm::vec3 &part, const glm::vec3 &whole)
{
  return glm::mix(glm::vec3(1.0F), part / glm::max(whole, glm::vec3(1e-30F)), glm::greaterThan(whole, glm::vec3(0.0F)));
}

/** The variant of the rays of the probe at \a place. Most probes that are near to each other have different ones. */
std::size_t variant_of(const std::array<int, 4> &place)
{
  const int sum = place[1] + 7 * place[2] + 49 * place[3];
  return std::size_t((sum % WORLD_PROBE_MAX + WORLD_PROBE_MAX) % WORLD_PROBE_MAX);
}

}  // namespace

/** Distance of the probes of a level, metres. */
static double edge_of(int level)
{
  return std::exp2(level / levels_per_octave);
}

struct WorldOcclusion::Box {
  /** The distance between probes is edge_of() it. */
  int level = 0;
  double edge = 1.0;
  /** Place of the first probe. */
  glm::ivec3 first{0};
  glm::ivec3 count{0};
  std::vector<Probe *> probes;
  /** Sum of the weights of points that look at a probe, and of those that see it. */
  struct Sight {
    double looked = 0.0;
    double seen = 0.0;
  };
  std::vector<Sight> sights;

  [[nodiscard]] glm::dvec3 position_ws(const glm::ivec3 &place) const
  {
    return (glm::dvec3(first + place) + place_offset) * edge;
  }
  [[nodiscard]] std::size_t index(const glm::ivec3 &place) const
  {
    return std::size_t((place.z * count.y + place.y) * count.x + place.x);
  }
};

glm::ivec3 WorldOcclusion::place_of(std::size_t probe) const
{
  const int index = int(probe);
  return {index % count_.x, index / count_.x % count_.y, index / (count_.x * count_.y)};
}

void WorldOcclusion::place(const scene::Bounds &bounds_ws)
{
  bounds_ws_ = bounds_ws;
  const glm::vec3 size = glm::max(bounds_ws.max - bounds_ws.min, glm::vec3(1e-6F));
  glm::vec3 extent;
  // Cells that are as cubic as can be. A flat scene has probes at both of its sides.
  float edge = std::max({size.x, size.y, size.z}) / float(WORLD_PROBE_MAX);
  do {
    edge *= 1.02F;
    extent = glm::max(size, glm::vec3(edge));
    count_ = glm::max(glm::ivec3(glm::ceil(extent / edge)), 2);
  } while (probe_count() > WORLD_PROBE_MAX);
  step_ = extent / glm::vec3(count_);
  first_ws_ = 0.5F * (bounds_ws.min + bounds_ws.max - extent + step_);
}

std::uint64_t WorldOcclusion::trace(std::size_t variant, const glm::vec3 &position_ws,
                                    std::span<const scene::Bounds> changed, std::size_t nearest_rays,
                                    std::span<RayHit> hits) const
{
  std::uint64_t count = 0;
  const auto directions = ray_directions(variant);
  for (std::size_t ray = 0; ray < hits.size(); ray++) {
    const glm::vec3 direction = directions[ray];
    if (std::ranges::any_of(changed, [&](const scene::Bounds &box) { return meets(box, position_ws, direction); })) {
      hits[ray] = casters_.trace(position_ws, direction, ray < nearest_rays);
      count++;
    }
  }
  return count;
}

void WorldOcclusion::trace(std::span<const scene::Bounds> changed)
{
  // A ray is tested against each of a few bounds, or against those of all.
  constexpr std::size_t bounds_max = 16;
  scene::Bounds all;
  if (changed.size() > bounds_max) {
    for (const scene::Bounds &box : changed) {
      all.extend(box);
    }
    changed = std::span(&all, 1);
  }
  std::atomic<std::uint64_t> traced = 0;
  scene::parallel_for(hits_.size() / probe_rays, 0, [&](std::size_t probe) {
    traced += trace(probe, first_ws_ + glm::vec3(place_of(probe)) * step_, changed, body_rays,
                    std::span(hits_).subspan(probe * probe_rays, probe_rays));
  });
  std::vector<std::pair<const Place, Probe> *> probes;
  for (auto &probe : probes_) {
    probes.push_back(&probe);
  }
  scene::parallel_for(probes.size(), 0, [&](std::size_t i) {
    auto &[place, probe] = *probes[i];
    const glm::dvec3 steps = glm::dvec3(place[1], place[2], place[3]) + place_offset;
    const std::uint64_t count = trace(variant_of(place), glm::vec3(steps * edge_of(place[0])), changed, 0, probe.hits);
    probe.is_lit &= count == 0;
    traced += count;
  });
  rays_traced_ += traced;
}

void WorldOcclusion::light_rays()
{
  constexpr glm::ivec2 size = render_scene::WorldLight::size;
  rays_.resize(std::size_t(WORLD_PROBE_MAX) * probe_rays);
  std::vector<Light> wholes(WORLD_PROBE_MAX);
  scene::parallel_for(WORLD_PROBE_MAX, 0, [&](std::size_t variant) {
    const auto directions = ray_directions(variant);
    for (std::size_t ray = 0; ray < probe_rays; ray++) {
      const glm::vec3 direction = directions[ray];
      const glm::vec2 place = shared::equirectangular(direction);
      const glm::ivec2 texel = glm::clamp(glm::ivec2(place * glm::vec2(size)), glm::ivec2(0), size - 1);
      const glm::vec2 even(place.x, 0.5F + 0.5F * direction.y);
      const glm::ivec2 cell = glm::min(glm::ivec2(even * glm::vec2(grid)), grid - 1);
      const auto light = float(luminance(world_->rest[std::size_t(texel.y * size.x + texel.x)]));
      rays_[variant * probe_rays + ray] = {std::uint16_t(cell.y * grid.x + cell.x), light};
      wholes[variant].add(light, direction);
    }
  });
  whole_ = {};
  for (const Light &whole : wholes) {
    whole_.positive += whole.positive;
    whole_.negative += whole.negative;
  }
}

void WorldOcclusion::add_up(std::size_t variant, Probe &probe) const
{
  const auto directions = ray_directions(variant);
  Light arriving;
  Light whole;
  for (std::size_t ray = 0; ray < probe_rays; ray++) {
    const float light = rays_[variant * probe_rays + ray].luminance;
    whole.add(light, directions[ray]);
    arriving.add(probe.hits[ray] == RayHit::None ? light : 0.0F, directions[ray]);
  }
  // Quotients of sums over the same rays: where nothing blocks any, they are exactly 1.
  probe.parts = {quotient_or_one(arriving.positive, whole.positive),
                 quotient_or_one(arriving.negative, whole.negative)};
  probe.is_lit = true;
}

/** Sums over the rays of all probes. */
struct WorldOcclusion::GridLight {
  struct Cell {
    double arriving = 0.0;
    double whole = 0.0;
  };
  /** Rays, by their direction. */
  std::array<Cell, std::size_t(grid.x *grid.y)> cells;
  /** Light of all rays. */
  Cell all;

  /**
   * Bilinear, between the centres of cells. A place gets all light of a direction or none. The least variance has the
   * root of the mean of its square.
   */
  [[nodiscard]] double importance(double column, double row) const
  {
    const glm::dvec2 low = glm::floor(glm::dvec2(column, row));
    double value = 0.0;
    for (int corner = 0; corner < 4; corner++) {
      const glm::dvec2 near = low + glm::dvec2(corner & 1, corner >> 1);
      const glm::dvec2 share = 1.0 - glm::abs(glm::dvec2(column, row) - near);
      const int x = (int(near.x) + grid.x) % grid.x;
      const int y = std::clamp(int(near.y), 0, grid.y - 1);
      const Cell &cell = cells[std::size_t(y * grid.x + x)];
      value += share.x * share.y * cell.arriving / std::max(cell.whole, 1.0);
    }
    return std::sqrt(value);
  }
};

WorldOcclusion::GridLight WorldOcclusion::grid_light() const
{
  GridLight light;
  for (std::size_t probe = 0; probe < std::size_t(probe_count()); probe++) {
    const auto hits = std::span(hits_).subspan(probe * probe_rays, probe_rays);
    // A probe counts by the surfaces that face it: none do inside of a body, below a ground or high above it.
    const auto seen = double(std::ranges::count(hits.first(body_rays), RayHit::Front));
    for (std::size_t ray = 0; ray < probe_rays; ray++) {
      const Ray &lit = rays_[probe * probe_rays + ray];
      GridLight::Cell &sum = light.cells[lit.cell];
      sum.whole += seen;
      sum.arriving += hits[ray] == RayHit::None ? seen : 0.0;
      const double brought = seen * double(lit.luminance);
      light.all.whole += brought;
      light.all.arriving += hits[ray] == RayHit::None ? brought : 0.0;
    }
  }
  return light;
}

WorldDirections WorldOcclusion::directions() const
{
  const GridLight grid_light = this->grid_light();
  WorldDirections result{{world_, &world_->rest_directions}, WorldDirections::few};
  if (!(grid_light.all.arriving > 0.0)) {
    return result;
  }
  constexpr glm::ivec2 size = render_scene::WorldLight::size;
  std::vector<float> importance;
  importance.reserve(world_->rest.size());
  double sum = 0.0;
  double whole = 0.0;
  for (int y = 0; y < size.y; y++) {
    const double height = 0.5 + 0.5 * render_scene::direction_of(0.0, (y + 0.5) / size.y).y;
    const double solid_angle = render_scene::texel_solid_angle(y, size.x, size.y);
    for (int x = 0; x < size.x; x++) {
      const double value = grid_light.importance(grid.x * (x + 0.5) / size.x - 0.5, grid.y * height - 0.5);
      const double light = solid_angle * luminance(world_->rest[importance.size()]);
      importance.push_back(float(value));
      sum += light * value;
      whole += light;
    }
  }
  // Light may arrive from a direction only where no probe is.
  constexpr double least = 0.15;
  for (float &value : importance) {
    value = float(least + (1.0 - least) * double(value) * whole / sum);
  }
  result.distribution = std::make_shared<const render_scene::WorldDistribution>(
      render_scene::rest_distribution(world_->rest, importance));
  // In an open place half of the directions are below the ground. In a room, most meet a wall.
  if (grid_light.all.arriving < 0.125 * grid_light.all.whole) {
    result.count = WorldDirections::many;
  }
  return result;
}

bool WorldOcclusion::update(const render_scene::RenderScene &scene, bool is_sampled)
{
  const std::vector<scene::Bounds> changed = casters_.update(scene);
  update_count_++;
  if (!changed.empty()) {
    // Viewports that draw the scene in turn update it for each.
    constexpr std::uint64_t recent = 8;
    std::erase_if(probes_, [&](const auto &entry) { return entry.second.used + recent < update_count_; });
  }
  const scene::Bounds bounds_ws = scene.bounds();
  if (casters_.empty()) {
    const bool has_blocked = probe_count() > 0;
    count_ = glm::ivec3(0);
    hits_.clear();
    probes_.clear();
    rays_.clear();
    world_ = scene.world();
    return has_blocked;
  }
  bool is_changed = !changed.empty();
  if (is_sampled) {
    probes_.clear();
    if (hits_.empty() || bounds_ws.min != bounds_ws_.min || bounds_ws.max != bounds_ws_.max) {
      place(bounds_ws);
      hits_.assign(std::size_t(probe_count()) * probe_rays, RayHit::None);
      trace(std::span(&bounds_ws, 1));
      is_changed = true;
    }
    else if (is_changed) {
      trace(changed);
    }
  }
  else {
    hits_.clear();
    if (is_changed) {
      trace(changed);
    }
    is_changed |= bounds_ws.min != bounds_ws_.min || bounds_ws.max != bounds_ws_.max;
    bounds_ws_ = bounds_ws;
  }
  if (world_ != scene.world() || rays_.empty()) {
    world_ = scene.world();
    light_rays();
    for (auto &[place, probe] : probes_) {
      probe.is_lit = false;
    }
    is_changed = true;
  }
  return is_changed;
}

std::vector<SurfacePoint> WorldOcclusion::seen_points(const draw::View &view) const
{
  constexpr int rows = 32;
  constexpr int count = 512;
  const glm::dmat4 world_from_view = glm::inverse(glm::dmat4(view.view_from_world()));
  const glm::dmat4 view_from_clip = glm::inverse(glm::dmat4(view.clip_from_view()));
  std::vector<std::optional<SurfacePoint>> found(count);
  scene::parallel_for(rows, 0, [&](std::size_t row) {
    for (std::size_t i = row; i < found.size(); i += rows) {
      const double turn = double(i) / std::numbers::phi;
      const glm::dvec2 place(2.0 * (double(i) + 0.5) / count - 1.0, 2.0 * (turn - std::floor(turn)) - 1.0);
      const glm::dvec4 near = view_from_clip * glm::dvec4(place, 1.0, 1.0);
      const glm::dvec4 far = view_from_clip * glm::dvec4(place, 0.5, 1.0);
      const glm::dvec3 start = glm::dvec3(near) / near.w;
      const glm::dvec3 along = glm::dmat3(world_from_view) * (glm::dvec3(far) / far.w - start);
      const glm::vec3 origin_ws(world_from_view * glm::dvec4(start, 1.0));
      const glm::vec3 direction_ws(glm::normalize(along));
      found[i] = casters_.seen(view, origin_ws, direction_ws);
    }
  });
  std::vector<SurfacePoint> points;
  for (const std::optional<SurfacePoint> &point : found) {
    if (point && glm::all(glm::lessThan(glm::abs(point->position_ws), glm::vec3(1e18F))) &&
        glm::dot(point->normal_ws, point->normal_ws) > 0.5F) {
      points.push_back(*point);
    }
  }
  return points;
}

/**
 * The ends of probes at distances of \a edge that light \a points, which are not empty. The outermost probes are up to
 * one edge within them.
 */
static std::pair<glm::dvec3, glm::dvec3> ends_around(std::span<const SurfacePoint> points, double edge)
{
  glm::dvec3 low;
  glm::dvec3 high;
  for (int axis = 0; axis < 3; axis++) {
    std::vector<double> lows;
    std::vector<double> highs;
    for (const SurfacePoint &point : points) {
      const auto place = double(point.position_ws[axis]);
      // A surface may be 0.75 edge outside of the probes. One that faces out of the box needs a probe outside.
      const double outward = std::clamp(3.0 * double(point.normal_ws[axis]), -0.75, 0.75);
      constexpr double margin = 0.25;
      lows.push_back(place - edge * (margin + std::max(-outward, 0.0)));
      highs.push_back(place + edge * (margin + std::max(outward, 0.0)));
    }
    // A few points, such as those seen through a window, do not make the probes of all others sparse.
    const auto left_out = std::ptrdiff_t(points.size() / 32);
    std::ranges::nth_element(lows, lows.begin() + left_out);
    std::ranges::nth_element(highs, highs.end() - 1 - left_out);
    low[axis] = *(lows.begin() + left_out);
    high[axis] = *(highs.end() - 1 - left_out);
  }
  return {low, high};
}

WorldOcclusion::Box WorldOcclusion::box_around(std::span<const SurfacePoint> points) const
{
  // Bounds of far scenes may be infinite.
  constexpr double far = 1e18;
  glm::dvec3 low = glm::clamp(glm::dvec3(bounds_ws_.min), -far, far);
  glm::dvec3 high = glm::clamp(glm::dvec3(bounds_ws_.max), -far, far);
  const auto set_ends = [&](double edge) {
    if (!points.empty()) {
      std::tie(low, high) = ends_around(points, edge);
    }
  };
  set_ends(0.0);
  const auto largest = [](const glm::dvec3 &v) { return std::max({v.x, v.y, v.z}); };
  const double magnitude = largest(glm::max(glm::abs(low), glm::abs(high)));
  const glm::dvec3 size = high - low;
  // An axis has at least two probes, and size / (1.25 edge). Smaller edges need more probes than there are.
  const double edge_min = std::max({std::cbrt(size.x * size.y * size.z / WORLD_PROBE_MAX) / 1.25,
                                    4.0 * largest(size) / WORLD_PROBE_MAX / 1.25, 1e-6 * magnitude, 1e-18});
  Box box;
  for (box.level = int(std::ceil(levels_per_octave * std::log2(edge_min)));; box.level++) {
    box.edge = edge_of(box.level);
    set_ends(box.edge);
    box.first = glm::ivec3(glm::ceil(low / box.edge - place_offset));
    glm::ivec3 last(glm::floor(high / box.edge - place_offset));
    for (int axis = 0; axis < 3; axis++) {
      // A plane has two layers of probes.
      if (last[axis] <= box.first[axis]) {
        box.first[axis] = int(std::floor(0.5 * (low[axis] + high[axis]) / box.edge - place_offset));
        last[axis] = box.first[axis] + 1;
      }
    }
    box.count = last - box.first + 1;
    if (box.count.x * box.count.y * box.count.z <= WORLD_PROBE_MAX) {
      return box;
    }
  }
}

void WorldOcclusion::fill(Box &box)
{
  std::map<Place, Probe> probes;
  std::vector<Place> places;
  for (int z = 0; z < box.count.z; z++) {
    for (int y = 0; y < box.count.y; y++) {
      for (int x = 0; x < box.count.x; x++) {
        const glm::ivec3 place = box.first + glm::ivec3(x, y, z);
        places.push_back({box.level, place.x, place.y, place.z});
        auto found = probes_.extract(places.back());
        box.probes.push_back(found ? &probes.insert(std::move(found)).position->second : &probes[places.back()]);
      }
    }
  }
  for (Probe *probe : box.probes) {
    probe->used = update_count_;
  }
  // Probes of other views are kept: other viewports have them, or a camera may return to them.
  constexpr std::size_t kept_max = std::size_t(16) * WORLD_PROBE_MAX;
  if (probes_.size() <= kept_max) {
    probes.merge(probes_);
  }
  probes_ = std::move(probes);
  const scene::Bounds all{glm::vec3(-std::numeric_limits<float>::max()), glm::vec3(std::numeric_limits<float>::max())};
  std::atomic<std::uint64_t> traced = 0;
  scene::parallel_for(places.size(), 0, [&](std::size_t i) {
    Probe &probe = *box.probes[i];
    const glm::dvec3 steps = glm::dvec3(places[i][1], places[i][2], places[i][3]) + place_offset;
    if (!probe.is_traced) {
      traced += trace(variant_of(places[i]), glm::vec3(steps * box.edge), std::span(&all, 1), 0, probe.hits);
      probe.is_traced = true;
    }
    if (!probe.is_lit) {
      add_up(variant_of(places[i]), probe);
    }
  });
  rays_traced_ += traced;
  box.sights.assign(places.size(), {});
}

void WorldOcclusion::look(std::span<const SurfacePoint> points, Box &box) const
{
  struct Look {
    std::size_t probe = 0;
    float weight = 0.0F;
    bool is_seen = false;
  };
  constexpr std::size_t corners = 8;
  std::vector<Look> looks(points.size() * corners);
  constexpr std::size_t part = 32;
  scene::parallel_for((points.size() + part - 1) / part, 0, [&](std::size_t first) {
    for (std::size_t i = first * part; i < std::min((first + 1) * part, points.size()); i++) {
      const glm::vec3 normal = points[i].normal_ws;
      const glm::dvec3 position(points[i].position_ws);
      const glm::vec3 last(box.count - 1);
      // The shader has the same place in world_parts, and takes the outermost probes outside of the box.
      const glm::vec3 place(position / box.edge - place_offset - glm::dvec3(box.first));
      // Points that are left out of the box have no probes of their own.
      if (glm::any(glm::lessThan(place, glm::vec3(-1.0F))) || glm::any(glm::greaterThan(place, last + 1.0F))) {
        continue;
      }
      const glm::vec3 above = glm::clamp(place + 0.2F * normal, glm::vec3(0.0F), last);
      const glm::vec3 low = glm::clamp(glm::floor(above), glm::vec3(0.0F), last - 1.0F);
      const glm::vec3 share = above - low;
      // The rays begin beyond the rounding of the point.
      const float offset =
          float(0.01 * box.edge + 1e-6 * std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z)}));
      const glm::vec3 start = points[i].position_ws + offset * normal;
      for (std::size_t corner = 0; corner < corners; corner++) {
        const glm::ivec3 side(corner & 1, corner >> 1 & 1, corner >> 2);
        const glm::vec3 near = glm::mix(1.0F - share, share, glm::vec3(side));
        const float height = glm::dot(normal, low + glm::vec3(side) - place);
        const float weight = near.x * near.y * near.z * shared::world_probe_weight(height);
        if (weight > 0.0F && height > 0.0F) {
          const glm::ivec3 at = glm::ivec3(low) + side;
          const glm::vec3 along = glm::vec3(box.position_ws(at)) - start;
          looks[i * corners + corner] = {box.index(at), weight,
                                         casters_.trace(start, along, false, 1.0F) == RayHit::None};
        }
      }
    }
  });
  for (const Look &look : looks) {
    box.sights[look.probe].looked += double(look.weight);
    box.sights[look.probe].seen += look.is_seen ? double(look.weight) : 0.0;
  }
}

void WorldOcclusion::write(const draw::View &view, shared::WorldBlock &block)
{
  if (casters_.empty()) {
    return;
  }
  const std::vector<SurfacePoint> points = seen_points(view);
  Box box = box_around(points);
  fill(box);
  look(points, box);
  count_ = box.count;
  constexpr double seen_least = 0.05;
  std::vector<Weighted> probes(box.probes.size());
  for (std::size_t i = 0; i < probes.size(); i++) {
    const Box::Sight &sight = box.sights[i];
    const float seen = points.empty()                           ? 1.0F
                       : sight.seen > seen_least * sight.looked ? float(sight.seen / sight.looked)
                                                                : 0.0F;
    if (seen > 0.0F) {
      probes[i] = {box.probes[i]->parts, seen};
    }
  }
  spread(box, probes);
  block.probe_count = glm::vec4(count_, 0.0F);
  block.probe_scale = glm::vec4(glm::vec3(float(1.0 / box.edge)), 0.0F);
  block.probe_offset = glm::vec4(glm::vec3(-glm::dvec3(box.first) - place_offset), 0.0F);
  block.whole_positive = glm::vec4(whole_.positive, 0.0F);
  block.whole_negative = glm::vec4(whole_.negative, 0.0F);
  for (std::size_t i = 0; i < probes.size(); i++) {
    block.probes[2 * i] = glm::vec4(glm::sqrt(probes[i].parts.positive), probes[i].weight);
    block.probes[2 * i + 1] = glm::vec4(glm::sqrt(probes[i].parts.negative), 0.0F);
  }
}

void WorldOcclusion::spread(const Box &box, std::span<Weighted> probes) const
{
  constexpr float unseen_weight = 1e-2F;
  const bool has_seen = std::ranges::any_of(probes, [](const Weighted &probe) { return probe.weight > 0.0F; });
  // A probe that a seen neighbour sees has its own parts. The others, such as those behind a wall or within a body,
  // have the mean of their neighbours.
  bool are_neighbours_seen = true;
  for (bool is_changed = has_seen; is_changed; are_neighbours_seen = false) {
    is_changed = false;
    const std::vector<Weighted> before(probes.begin(), probes.end());
    for (std::size_t i = 0; i < probes.size(); i++) {
      Light sum;
      float count = 0.0F;
      bool is_open = false;
      for (int side = 0; side < 6 && before[i].weight == 0.0F && !is_open; side++) {
        glm::ivec3 at = place_of(i);
        at[side / 2] += side % 2 == 0 ? 1 : -1;
        const bool is_in = at[side / 2] >= 0 && at[side / 2] < count_[side / 2];
        if (is_in && before[box.index(at)].weight > 0.0F) {
          sum.positive += before[box.index(at)].parts.positive;
          sum.negative += before[box.index(at)].parts.negative;
          count += 1.0F;
          const glm::vec3 start(box.position_ws(at));
          const glm::vec3 along = glm::vec3(box.position_ws(place_of(i))) - start;
          is_open = are_neighbours_seen && casters_.trace(start, along, false, 1.0F) == RayHit::None;
        }
      }
      if (count > 0.0F) {
        const Light mean{sum.positive / count, sum.negative / count};
        probes[i] = {is_open ? box.probes[i]->parts : mean, unseen_weight};
        is_changed = true;
      }
    }
  }
}

}  // namespace gnomon::eevee
