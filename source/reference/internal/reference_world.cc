// SPDX-License-Identifier: MIT
#include "internal/reference_world.hh"

#include "internal/reference_random.hh"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon::reference {

namespace {

using std::numbers::pi;

double luminance(const glm::dvec3 &color)
{
  return 0.2126 * color.r + 0.7152 * color.g + 0.0722 * color.b;
}

/** Solid angle of row \a row from the top, of a picture of \a height rows, over the whole circle. */
double row_solid_angle(int row, int height)
{
  return 2.0 * pi * (std::cos(pi * row / height) - std::cos(pi * (row + 1) / height));
}

}  // namespace

WorldSampler::WorldSampler(const scene::World &world) : world_(world)
{
  if (world.picture) {
    size_ = {world.picture->width, world.picture->height};
  }
  in_row_.reserve(std::size_t(size_.x) * std::size_t(size_.y));
  for (int row = 0; row < size_.y; row++) {
    double in_row = 0.0;
    for (int column = 0; column < size_.x; column++) {
      in_row += weight(column, row);
      in_row_.push_back(in_row);
    }
    sum_ += in_row;
    rows_.push_back(sum_);
  }
}

glm::dvec2 WorldSampler::place_of(const glm::dvec3 &to_world_ws) const
{
  const double u = 0.5 + std::atan2(to_world_ws.z, to_world_ws.x) / (2.0 * pi) + double(world_.rotation) / (2.0 * pi);
  const double v = 0.5 - std::asin(std::clamp(to_world_ws.y, -1.0, 1.0)) / pi;
  return {fraction(u) * size_.x, std::clamp(v, 0.0, 1.0) * size_.y};
}

glm::dvec3 WorldSampler::radiance(const glm::dvec3 &to_world_ws) const
{
  const glm::dvec3 factor = double(world_.strength) * glm::dvec3(world_.color);
  if (!world_.picture) {
    return factor;
  }
  // Bilinear between the middles of texels.
  const glm::dvec2 place = place_of(to_world_ws) - 0.5;
  const glm::dvec2 low(std::floor(place.x), std::floor(place.y));
  const auto texel = [&](double x, double y) {
    const int column = (int(x) + size_.x) % size_.x;
    return glm::dvec3(world_.picture->at(column, std::clamp(int(y), 0, size_.y - 1)));
  };
  const glm::dvec2 share = place - low;
  const glm::dvec3 upper = (1.0 - share.x) * texel(low.x, low.y) + share.x * texel(low.x + 1.0, low.y);
  const glm::dvec3 lower = (1.0 - share.x) * texel(low.x, low.y + 1.0) + share.x * texel(low.x + 1.0, low.y + 1.0);
  return factor * ((1.0 - share.y) * upper + share.y * lower);
}

double WorldSampler::weight(int column, int row) const
{
  double light = luminance(double(world_.strength) * glm::dvec3(world_.color));
  if (world_.picture) {
    // All texels that the radiance within this one is blended from.
    double brightest = 0.0;
    for (int y = std::max(row - 1, 0); y <= std::min(row + 1, size_.y - 1); y++) {
      for (int x = column - 1; x <= column + 1; x++) {
        brightest = std::max(brightest, luminance(glm::dvec3(world_.picture->at((x + size_.x) % size_.x, y))));
      }
    }
    light *= brightest;
  }
  return light * row_solid_angle(row, size_.y) / size_.x;
}

double WorldSampler::density(const glm::dvec3 &to_world_ws) const
{
  const glm::dvec2 place = place_of(to_world_ws);
  const int column = std::min(int(place.x), size_.x - 1);
  const int row = std::min(int(place.y), size_.y - 1);
  return weight(column, row) / sum_ * size_.x / row_solid_angle(row, size_.y);
}

WorldSample WorldSampler::sample(const glm::dvec2 &u) const
{
  const auto row = std::min(std::ranges::upper_bound(rows_, u.y * sum_), rows_.end() - 1);
  const int y = int(row - rows_.begin());
  const double row_start = y > 0 ? rows_[std::size_t(y - 1)] : 0.0;
  const auto first = in_row_.begin() + std::ptrdiff_t(y) * size_.x;
  const double row_sum = *(first + size_.x - 1);
  const auto texel = std::upper_bound(first, first + size_.x - 1, u.x * row_sum);
  const double start = texel == first ? 0.0 : *(texel - 1);
  const double across = std::clamp((u.x * row_sum - start) / std::max(*texel - start, 1e-300), 0.0, 1.0);
  const double down = std::clamp((u.y * sum_ - row_start) / std::max(*row - row_start, 1e-300), 0.0, 1.0);
  // Evenly over the solid angle of the texel.
  const double high = std::cos(pi * y / size_.y);
  const double low = std::cos(pi * (y + 1) / size_.y);
  const double up = high + down * (low - high);
  const double azimuth = ((double(texel - first) + across) / size_.x - 0.5) * 2.0 * pi - double(world_.rotation);
  const double horizontal = std::sqrt(std::max(1.0 - up * up, 0.0));
  WorldSample sample;
  sample.to_world_ws = {horizontal * std::cos(azimuth), up, horizontal * std::sin(azimuth)};
  sample.radiance = radiance(sample.to_world_ws);
  sample.density = density(sample.to_world_ws);
  return sample;
}

}  // namespace gnomon::reference
