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

/** Bilinearly interpolated radiance of \a world. \a u: from the left. \a v: from the bottom. */
glm::dvec3 radiance_at(const scene::World &world, double u, double v)
{
  const glm::dvec3 factor = double(world.strength) * glm::dvec3(world.color);
  if (!world.picture) {
    return factor;
  }
  const scene::WorldPicture &picture = *world.picture;
  const double turned = u + double(world.rotation) / (2.0 * pi);
  const double x = (turned - std::floor(turned)) * picture.width - 0.5;
  const double y = (1.0 - v) * picture.height - 0.5;
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

/** A region of the sphere, for prefiltering. */
struct Cell {
  glm::vec3 direction{0.0F};
  glm::vec3 flux{0.0F};
  float solid_angle = 0.0F;
};

/** Divides \a picture into cells of \a step by \a step texels. */
std::vector<Cell> cells_of(std::span<const glm::vec3> picture, int step)
{
  std::vector<Cell> cells;
  for (int y = 0; y < WorldLight::size.y; y += step) {
    for (int x = 0; x < WorldLight::size.x; x += step) {
      Cell &cell = cells.emplace_back();
      for (int b = y; b < y + step; b++) {
        const auto area = float(texel_solid_angle(b, WorldLight::size.x, WorldLight::size.y));
        for (int a = x; a < x + step; a++) {
          cell.flux += area * picture[std::size_t(b) * std::size_t(WorldLight::size.x) + std::size_t(a)];
          cell.solid_angle += area;
        }
      }
      cell.direction =
          glm::vec3(direction_of((x + 0.5 * step) / WorldLight::size.x, (y + 0.5 * step) / WorldLight::size.y));
    }
  }
  return cells;
}

/** Filters \a cells, a grid of \a size, with the GGX lobe of \a alpha around the direction of each cell. */
std::vector<glm::vec3> lobes(const std::vector<Cell> &cells, glm::ivec2 size, float alpha)
{
  const float a2 = alpha * alpha;
  // Cut the lobe where it has fallen to 1/200 of its peak, that is, where sin² of the half vector's angle is about
  // 13 a².
  const float cosine_least = 1.0F - std::min(2.0F * 13.0F * a2, 1.0F);
  const double reach = std::acos(double(cosine_least));
  const int rows = int(std::ceil(reach / pi * size.y));
  std::vector<glm::vec3> result(cells.size());
  for (int y = 0; y < size.y; y++) {
    const double latitude = std::abs((y + 0.5) / size.y - 0.5) * pi;
    // The largest difference in longitude between the centre of a spherical cap and a point of the cap.
    const double turn = latitude + reach < 0.5 * pi ? std::asin(std::sin(reach) / std::cos(latitude)) : pi;
    const int columns = std::min(int(std::ceil(turn / (2.0 * pi) * size.x)), size.x / 2);
    for (int x = 0; x < size.x; x++) {
      const glm::vec3 normal = cells[std::size_t(y * size.x + x)].direction;
      glm::vec3 sum(0.0F);
      float weight_sum = 0.0F;
      for (int b = std::max(y - rows, 0); b <= std::min(y + rows, size.y - 1); b++) {
        for (int a = x - columns; a < x - columns + std::min(2 * columns + 1, size.x); a++) {
          const Cell &cell = cells[std::size_t(b * size.x + (a + size.x) % size.x)];
          const float cosine = cell.direction.x * normal.x + cell.direction.y * normal.y + cell.direction.z * normal.z;
          if (cosine > cosine_least) {
            // For a view along the normal, cos² of the half vector's angle is (1 + cosine) / 2.
            const float h_sq = 0.5F + 0.5F * cosine;
            const float t = (1.0F - h_sq) + a2 * h_sq;
            const float weight = cosine / (t * t);
            sum += weight * cell.flux;
            weight_sum += weight * cell.solid_angle;
          }
        }
      }
      result[std::size_t(y * size.x + x)] = weight_sum > 0.0F ? sum / weight_sum : glm::vec3(0.0F);
    }
  }
  return result;
}

/** Enlarges \a coarse by the factor \a step to WorldLight::size, with bilinear interpolation. */
std::vector<glm::vec3> enlarged(const std::vector<glm::vec3> &coarse, int step)
{
  const glm::ivec2 size = WorldLight::size / step;
  std::vector<glm::vec3> result;
  result.reserve(std::size_t(WorldLight::size.x * WorldLight::size.y));
  for (int y = 0; y < WorldLight::size.y; y++) {
    const float v = (float(y) + 0.5F) / float(step) - 0.5F;
    const int low = std::clamp(int(std::floor(v)), 0, size.y - 2);
    const float t = std::clamp(v - float(low), 0.0F, 1.0F);
    for (int x = 0; x < WorldLight::size.x; x++) {
      const float u = (float(x) + 0.5F) / float(step) - 0.5F;
      const int left = int(std::floor(u));
      const float s = u - float(left);
      const auto row = [&](int r) {
        const std::size_t first = std::size_t(r * size.x);
        return (1.0F - s) * coarse[first + std::size_t((left + size.x) % size.x)] +
               s * coarse[first + std::size_t((left + 1) % size.x)];
      };
      result.push_back((1.0F - t) * row(low) + t * row(low + 1));
    }
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

WorldDistribution::WorldDistribution(glm::ivec2 size, std::vector<Texel> texels, double even_share)
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
    const double weight =
        solid_angle * ((1.0 - even_share) * luminance(texels_[i].radiance) / light + even_share / area);
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

WorldLight world_light(const scene::World &world)
{
  WorldLight light;
  const glm::ivec2 size = WorldLight::size;
  const int fine = 2 * texels_across(world);
  double mean = 0.0;
  for (int y = 0; y < size.y; y++) {
    for (int x = 0; x < size.x; x++) {
      const glm::dvec3 radiance = mean_radiance(world, x, y, size, fine);
      mean += texel_solid_angle(y, size.x, size.y) * luminance(radiance) / (4.0 * pi);
      light.rest.emplace_back(radiance);
    }
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
    // A sun must give at least 0.5 % of the light and be at most 40° wide (0.38 sr).
    if (share < 0.005 || patch.solid_angle() > 0.38 || int(light.suns.size()) == WorldLight::sun_max) {
      continue;
    }
    for (const std::size_t texel : patch.texels) {
      light.rest[texel] = glm::vec3(0.0F);
    }
    light.suns.push_back(sun_of(std::move(patch), light.suns.size()));
  }
  light.harmonics = harmonics_of(light.rest);
  std::vector<WorldDistribution::Texel> texels;
  for (std::size_t i = 0; i < light.rest.size(); i++) {
    texels.push_back({int(i % std::size_t(size.x)), int(i / std::size_t(size.x)), light.rest[i]});
  }
  light.rest_directions = WorldDistribution(size, std::move(texels), 0.25);
  return light;
}

std::vector<std::vector<glm::vec3>> prefiltered(std::span<const glm::vec3> picture, int level_count)
{
  std::vector<std::vector<glm::vec3>> levels = {{picture.begin(), picture.end()}};
  for (int level = 1; level < level_count; level++) {
    const float roughness = float(level) / float(level_count - 1);
    // Choose cells that are several times smaller than the lobe.
    const int step = roughness < 0.2F ? 1 : roughness < 0.4F ? 2 : roughness < 0.6F ? 4 : 8;
    levels.push_back(enlarged(lobes(cells_of(picture, step), WorldLight::size / step, roughness * roughness), step));
  }
  return levels;
}

}  // namespace gnomon::render_scene
