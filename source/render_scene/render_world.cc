// SPDX-License-Identifier: MIT
#include "render_world.hh"

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace gnomon::render_scene {

namespace {

constexpr double pi = std::numbers::pi;

double luminance(const glm::dvec3 &color)
{
  return glm::dot(color, glm::dvec3(0.2126, 0.7152, 0.0722));
}

/** Column of the picture of \a world for \a u, in pixels from the centre of the first one. */
double column_at(const scene::World &world, double u)
{
  const double turned = u + double(world.rotation) / (2.0 * pi);
  return (turned - std::floor(turned)) * world.picture->width - 0.5;
}

/** Row of \a picture for \a v, in pixels from the centre of the first one. */
double row_at(const scene::WorldPicture &picture, double v)
{
  return (1.0 - v) * picture.height - 0.5;
}

/** Bilinearly interpolated radiance of \a world. \a u: from the left. \a v: from the bottom. */
glm::dvec3 radiance_at(const scene::World &world, double u, double v)
{
  const glm::dvec3 factor = double(world.strength) * glm::dvec3(world.color);
  if (!world.picture) {
    return factor;
  }
  const scene::WorldPicture &picture = *world.picture;
  const double x = column_at(world, u);
  const double y = row_at(picture, v);
  const int column = int(std::floor(x));
  const int row = int(std::floor(y));
  const double s = x - column;
  const double t = y - row;
  const int left = (column + picture.width) % picture.width;
  const int right = (column + 1) % picture.width;
  const int top = std::clamp(row, 0, picture.height - 1);
  const int bottom = std::clamp(row + 1, 0, picture.height - 1);
  return factor *
         ((1.0 - t) * ((1.0 - s) * glm::dvec3(picture.at(left, top)) + s * glm::dvec3(picture.at(right, top))) +
          t * ((1.0 - s) * glm::dvec3(picture.at(left, bottom)) + s * glm::dvec3(picture.at(right, bottom))));
}

/** Mean radiance over a texel of a grid of \a size, from \a fine by \a fine samples. */
glm::dvec3 mean_radiance(const scene::World &world, int x, int y, glm::ivec2 size, int fine)
{
  glm::dvec3 sum(0.0);
  for (int b = 0; b < fine; b++) {
    for (int a = 0; a < fine; a++) {
      sum += radiance_at(world, (x + (a + 0.5) / fine) / size.x, (y + (b + 0.5) / fine) / size.y);
    }
  }
  return sum / double(fine * fine);
}

/** A pixel along one axis of a picture, and its weight in a mean. */
struct Tap {
  int pixel = 0;
  double weight = 0.0;
};

/**
 * The pixels whose weighted sum is the mean over the texel \a texel of \a texel_count along an axis: linear
 * interpolation at \a fine places. \a position: the position of a place in [0, 1], in pixels from the centre of the
 * first one. \a wrapped: the pixel for a number outside of the picture.
 */
template <typename Position, typename Wrapped>
std::vector<Tap> taps_of(int texel, int texel_count, int fine, Position &&position, Wrapped &&wrapped)
{
  std::vector<Tap> taps;
  const auto add = [&](int pixel, double weight) {
    const auto found = std::ranges::find(taps, wrapped(pixel), &Tap::pixel);
    (found == taps.end() ? taps.emplace_back(Tap{wrapped(pixel)}) : *found).weight += weight / fine;
  };
  for (int a = 0; a < fine; a++) {
    const double at = position((texel + (a + 0.5) / fine) / texel_count);
    const int pixel = int(std::floor(at));
    add(pixel, 1.0 - (at - pixel));
    add(pixel + 1, at - pixel);
  }
  return taps;
}

/** The means of mean_radiance() over all texels of a grid of \a size, which it finds in much less time. */
std::vector<glm::vec3> mean_radiances(const scene::World &world, glm::ivec2 size, int fine)
{
  const glm::dvec3 factor = double(world.strength) * glm::dvec3(world.color);
  if (!world.picture) {
    return std::vector<glm::vec3>(std::size_t(size.x * size.y), glm::vec3(factor));
  }
  const scene::WorldPicture &picture = *world.picture;
  std::vector<std::vector<Tap>> columns;
  for (int x = 0; x < size.x; x++) {
    columns.push_back(taps_of(
        x, size.x, fine, [&](double u) { return column_at(world, u); },
        [&](int pixel) { return (pixel + picture.width) % picture.width; }));
  }
  std::vector<glm::vec3> means;
  means.reserve(std::size_t(size.x * size.y));
  std::vector<glm::dvec3> row(std::size_t(picture.width));
  for (int y = 0; y < size.y; y++) {
    std::ranges::fill(row, glm::dvec3(0.0));
    for (const Tap &tap : taps_of(
             y, size.y, fine, [&](double v) { return row_at(picture, v); },
             [&](int pixel) { return std::clamp(pixel, 0, picture.height - 1); })) {
      for (int x = 0; x < picture.width; x++) {
        row[std::size_t(x)] += tap.weight * glm::dvec3(picture.at(x, tap.pixel));
      }
    }
    for (const std::vector<Tap> &taps : columns) {
      glm::dvec3 sum(0.0);
      for (const Tap &tap : taps) {
        sum += tap.weight * row[std::size_t(tap.pixel)];
      }
      means.emplace_back(factor * sum);
    }
  }
  return means;
}

/** Number of texels of the picture along one edge of a texel of WorldLight::size. */
int texels_across(const scene::World &world)
{
  const int width = world.picture ? world.picture->width : 1;
  return std::clamp((width + WorldLight::size.x - 1) / WorldLight::size.x, 1, 64);
}

glm::dvec3 direction_of_texel(std::size_t texel, glm::ivec2 size)
{
  const auto row = int(texel / std::size_t(size.x));
  const auto column = int(texel % std::size_t(size.x));
  return direction_of((column + 0.5) / size.x, (row + 0.5) / size.y);
}

/** A connected region of bright texels. */
struct Patch {
  /** Indices of the texels in a grid of WorldLight::size, ascending. */
  std::vector<std::size_t> texels;
  /** The same region in a grid with `fine` times the resolution. */
  int fine = 1;
  std::vector<WorldDistribution::Texel> fine_texels;
  /** Integrals over the solid angle of radiance, luminance, squared luminance, and direction times luminance. */
  glm::dvec3 flux{0.0};
  double light = 0.0;
  double contrast = 0.0;
  glm::dvec3 direction{0.0};

  /** Effective solid angle, sr. A faint rim increases it only a little. \see WorldDistribution::solid_angle */
  [[nodiscard]] double solid_angle() const
  {
    return light * light / contrast;
  }
};

/** Finds the texels that are brighter than \a threshold and connected with \a start. Marks them in \a is_seen. */
std::vector<std::size_t> connected(const std::vector<glm::vec3> &radiance, std::size_t start, double threshold,
                                   std::vector<bool> &is_seen)
{
  const glm::ivec2 size = WorldLight::size;
  std::vector<std::size_t> found = {start};
  is_seen[start] = true;
  for (std::size_t i = 0; i < found.size(); i++) {
    const auto row = int(found[i] / std::size_t(size.x));
    const auto column = int(found[i] % std::size_t(size.x));
    for (int dy = -1; dy <= 1; dy++) {
      for (int dx = -1; dx <= 1; dx++) {
        const int y = std::clamp(row + dy, 0, size.y - 1);
        const int x = (column + dx + size.x) % size.x;
        const std::size_t next = std::size_t(y) * std::size_t(size.x) + std::size_t(x);
        if (!is_seen[next] && luminance(radiance[next]) > threshold) {
          is_seen[next] = true;
          found.push_back(next);
        }
      }
    }
  }
  std::ranges::sort(found);
  return found;
}

/** Makes a patch of \a texels, with up to 8 times the resolution if the picture has it. */
Patch patch_of(const scene::World &world, std::vector<std::size_t> texels)
{
  Patch patch;
  patch.texels = std::move(texels);
  const int across = texels_across(world);
  patch.fine = std::min(across, 8);
  const glm::ivec2 fine_size = patch.fine * WorldLight::size;
  for (const std::size_t texel : patch.texels) {
    const glm::ivec2 corner =
        patch.fine * glm::ivec2(texel % std::size_t(WorldLight::size.x), texel / std::size_t(WorldLight::size.x));
    for (int y = corner.y; y < corner.y + patch.fine; y++) {
      const double solid_angle = texel_solid_angle(y, fine_size.x, fine_size.y);
      for (int x = corner.x; x < corner.x + patch.fine; x++) {
        const glm::dvec3 radiance = mean_radiance(world, x, y, fine_size, 2 * across / patch.fine);
        const double light = luminance(radiance);
        patch.fine_texels.push_back({x, y, glm::vec3(radiance)});
        patch.flux += solid_angle * radiance;
        patch.light += solid_angle * light;
        patch.contrast += solid_angle * light * light;
        patch.direction += solid_angle * light * direction_of((x + 0.5) / fine_size.x, (y + 0.5) / fine_size.y);
      }
    }
  }
  std::ranges::sort(patch.fine_texels, {}, [](const WorldDistribution::Texel &t) { return std::pair(t.y, t.x); });
  return patch;
}

WorldLight::Sun sun_of(Patch patch, std::size_t index)
{
  WorldLight::Sun sun;
  scene::PlacedLamp &lamp = sun.lamp;
  lamp.name = "world sun " + std::to_string(index + 1);
  lamp.kind = scene::LampKind::Sun;
  const double half_angle = 2.0 * std::asin(std::min(std::sqrt(patch.solid_angle() / (4.0 * pi)), 0.5));
  lamp.angle = float(2.0 * half_angle);
  // Irradiance of a disk of uniform radiance: π sin²(half angle) times the radiance.
  const double sine = std::sin(half_angle);
  lamp.intensity = 1.0F;
  lamp.color = glm::vec3(patch.flux / patch.solid_angle() * pi * sine * sine);
  const glm::dvec3 back = glm::normalize(patch.direction);
  lamp.world_from_lamp = scene::frame_of(
      glm::dmat4(glm::dvec4(0.0), glm::dvec4(0, 1, 0, 0), glm::dvec4(back, 0.0), glm::dvec4(0, 0, 0, 1)));
  sun.directions = WorldDistribution(patch.fine * WorldLight::size, std::move(patch.fine_texels), 0.0);
  return sun;
}

std::array<glm::vec3, 9> harmonics_of(const std::vector<glm::vec3> &radiance)
{
  std::array<glm::dvec3, 9> sum{};
  for (std::size_t i = 0; i < radiance.size(); i++) {
    const double solid_angle =
        texel_solid_angle(int(i / std::size_t(WorldLight::size.x)), WorldLight::size.x, WorldLight::size.y);
    const glm::dvec3 d = direction_of_texel(i, WorldLight::size);
    const std::array<double, 9> basis = {
        1.0, d.y, d.z, d.x, d.x * d.y, d.y * d.z, 3.0 * d.z * d.z - 1.0, d.x * d.z, d.x * d.x - d.y * d.y};
    for (std::size_t k = 0; k < 9; k++) {
      sum[k] += solid_angle * basis[k] * glm::dvec3(radiance[i]);
    }
  }
  // Squares of the normalisation constants of the basis. The loop multiplies them by the factors of the cosine lobe
  // divided by π: 1, 2/3 and 1/4.
  constexpr std::array<double, 9> squares = {1.0 / (4.0 * pi),  3.0 / (4.0 * pi),  3.0 / (4.0 * pi),
                                             3.0 / (4.0 * pi),  15.0 / (4.0 * pi), 15.0 / (4.0 * pi),
                                             5.0 / (16.0 * pi), 15.0 / (4.0 * pi), 15.0 / (16.0 * pi)};
  std::array<glm::vec3, 9> result;
  for (std::size_t k = 0; k < 9; k++) {
    const double lobe = k == 0 ? 1.0 : k < 4 ? 2.0 / 3.0 : 0.25;
    result[k] = glm::vec3(lobe * squares[k] * sum[k]);
  }
  return result;
}

}  // namespace

glm::dvec3 direction_of(double u, double v)
{
  const double azimuth = (u - 0.5) * 2.0 * pi;
  const double elevation = (v - 0.5) * pi;
  return {std::cos(elevation) * std::cos(azimuth), std::sin(elevation), std::cos(elevation) * std::sin(azimuth)};
}

double texel_solid_angle(int y, int width, int height)
{
  return 2.0 * pi / width * (std::sin(((y + 1.0) / height - 0.5) * pi) - std::sin((double(y) / height - 0.5) * pi));
}

WorldDistribution::WorldDistribution(glm::ivec2 size, std::vector<Texel> texels, double even_share,
                                     std::span<const float> importance)
    : size_(size), texels_(std::move(texels))
{
  double light = 0.0;
  double contrast = 0.0;
  double area = 0.0;
  for (const Texel &texel : texels_) {
    const double solid_angle = texel_solid_angle(texel.y, size.x, size.y);
    const double bright = luminance(texel.radiance);
    light += solid_angle * bright;
    contrast += solid_angle * bright * bright;
    area += solid_angle;
  }
  if (!(light > 0.0)) {
    texels_.clear();
    return;
  }
  solid_angle_ = light * light / contrast;
  double sum = 0.0;
  double row_sum = 0.0;
  for (std::size_t i = 0; i < texels_.size(); i++) {
    if (i == 0 || texels_[i].y != texels_[i - 1].y) {
      rows_.push_back({.first = i});
      row_sum = 0.0;
    }
    const double solid_angle = texel_solid_angle(texels_[i].y, size.x, size.y);
    const double weight = solid_angle *
                          ((1.0 - even_share) * luminance(texels_[i].radiance) / light + even_share / area) *
                          (importance.empty() ? 1.0 : double(importance[i]));
    row_sum += weight;
    sum += weight;
    cumulative_.push_back(row_sum);
    rows_.back().end = i + 1;
    rows_.back().cumulative = sum;
  }
}

WorldDirection WorldDistribution::at(const glm::dvec2 &place) const
{
  const double sum = rows_.back().cumulative;
  const auto row = std::min(std::ranges::upper_bound(rows_, place.y * sum, {}, &Row::cumulative), rows_.end() - 1);
  const double row_start = row == rows_.begin() ? 0.0 : (row - 1)->cumulative;
  const double row_sum = cumulative_[row->end - 1];
  const auto first = cumulative_.begin() + std::ptrdiff_t(row->first);
  const auto last = cumulative_.begin() + std::ptrdiff_t(row->end) - 1;
  const auto found = std::upper_bound(first, last, place.x * row_sum);
  const std::size_t index = std::size_t(found - cumulative_.begin());
  const double start = found == first ? 0.0 : *(found - 1);
  const double weight = *found - start;
  const Texel &texel = texels_[index];
  // Distribute the directions uniformly over the texel's solid angle.
  const double across = std::clamp((place.x * row_sum - start) / weight, 0.0, 1.0);
  const double up = std::clamp((place.y * sum - row_start) / row_sum, 0.0, 1.0);
  const double low = std::sin((double(texel.y) / size_.y - 0.5) * pi);
  const double high = std::sin(((texel.y + 1.0) / size_.y - 0.5) * pi);
  const double y = low + up * (high - low);
  const double azimuth = ((texel.x + across) / size_.x - 0.5) * 2.0 * pi;
  const double horizontal = std::sqrt(std::max(1.0 - y * y, 0.0));
  WorldDirection direction;
  direction.to_world = {horizontal * std::cos(azimuth), y, horizontal * std::sin(azimuth)};
  direction.solid_angle = texel_solid_angle(texel.y, size_.x, size_.y) * sum / weight;
  direction.irradiance = direction.solid_angle * glm::dvec3(texel.radiance);
  return direction;
}

WorldDistribution rest_distribution(std::span<const glm::vec3> rest, std::span<const float> importance)
{
  const auto width = std::size_t(WorldLight::size.x);
  std::vector<WorldDistribution::Texel> texels;
  texels.reserve(rest.size());
  for (std::size_t i = 0; i < rest.size(); i++) {
    texels.push_back({int(i % width), int(i / width), rest[i]});
  }
  return {WorldLight::size, std::move(texels), 0.25, importance};
}

WorldLight world_light(const scene::World &world)
{
  WorldLight light;
  const glm::ivec2 size = WorldLight::size;
  light.rest = mean_radiances(world, size, 2 * texels_across(world));
  double mean = 0.0;
  for (std::size_t i = 0; i < light.rest.size(); i++) {
    const double solid_angle = texel_solid_angle(int(i / std::size_t(size.x)), size.x, size.y);
    mean += solid_angle * luminance(light.rest[i]) / (4.0 * pi);
  }
  // Regions that are much brighter than the mean cast visible shadows.
  constexpr double bright = 4.0;
  std::vector<Patch> patches;
  std::vector<bool> is_seen(light.rest.size(), false);
  for (std::size_t start = 0; start < light.rest.size(); start++) {
    if (!is_seen[start] && luminance(light.rest[start]) > bright * mean) {
      patches.push_back(patch_of(world, connected(light.rest, start, bright * mean, is_seen)));
    }
  }
  std::ranges::sort(patches, std::ranges::greater(), &Patch::light);
  for (Patch &patch : patches) {
    const double share = patch.light / (4.0 * pi * mean);
    // A sun must give at least 5 % of the light and be at most 40° wide (0.38 sr). Dimmer patches stay in the rest,
    // because each sun costs the same.
    if (share < 0.05 || patch.solid_angle() > 0.38 || int(light.suns.size()) == WorldLight::sun_max) {
      continue;
    }
    for (const std::size_t texel : patch.texels) {
      light.rest[texel] = glm::vec3(0.0F);
    }
    light.suns.push_back(sun_of(std::move(patch), light.suns.size()));
  }
  light.harmonics = harmonics_of(light.rest);
  light.rest_directions = rest_distribution(light.rest);
  return light;
}

}  // namespace gnomon::render_scene
