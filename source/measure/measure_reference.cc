// SPDX-License-Identifier: MIT
#include "measure_reference.hh"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace gnomon::measure {

namespace {

using Halves = std::array<reference::Picture, 2>;

/**
 * The pixels in whose neighbourhood the halves differ most. A neighbourhood estimates the noise better than one pixel.
 */
std::vector<glm::ivec2> noisiest(const Halves &halves, std::size_t count)
{
  const glm::ivec2 size_px = halves[0].size_px;
  const auto at = [&size_px](int x, int y) { return std::size_t(y) * std::size_t(size_px.x) + std::size_t(x); };
  std::vector<float> square(halves[0].pixels.size());
  for (std::size_t i = 0; i < square.size(); i++) {
    const glm::vec3 off(halves[0].pixels[i] - halves[1].pixels[i]);
    square[i] = glm::dot(off, off);
  }
  std::vector<std::pair<float, glm::ivec2>> pixels;
  pixels.reserve(square.size());
  for (int y = 0; y < size_px.y; y++) {
    for (int x = 0; x < size_px.x; x++) {
      float around = 0.0F;
      for (int to_y = std::max(y - 1, 0); to_y <= std::min(y + 1, size_px.y - 1); to_y++) {
        for (int to_x = std::max(x - 1, 0); to_x <= std::min(x + 1, size_px.x - 1); to_x++) {
          around += square[at(to_x, to_y)];
        }
      }
      pixels.emplace_back(around, glm::ivec2(x, y));
    }
  }
  std::ranges::nth_element(pixels, pixels.begin() + std::ptrdiff_t(count), std::ranges::greater{},
                           &std::pair<float, glm::ivec2>::first);
  std::vector<glm::ivec2> found;
  for (std::size_t i = 0; i < count && pixels[i].first > 0.0F; i++) {
    found.push_back(pixels[i].second);
  }
  return found;
}

}  // namespace

ReferencePicture reference_picture(const reference::Tracer &tracer, const scene::PlacedCamera &camera,
                                   glm::ivec2 size_px, int sample_count, bool has_multiscatter)
{
  constexpr std::size_t noisy_share = 10;
  constexpr int noisy_samples = 8;
  // Different from the seeds of a PixelSample, so that a choice can be verified with independent rays.
  constexpr std::uint64_t first_seed = std::uint64_t(1) << 32U;
  Halves halves;
  for (std::size_t i = 0; i < 2; i++) {
    halves[i] = reference::direct_light(
        tracer, camera, size_px,
        {.sample_count = sample_count / 2, .seed = first_seed + i, .has_multiscatter = has_multiscatter});
  }
  const std::vector<glm::ivec2> noisy = noisiest(halves, halves[0].pixels.size() / noisy_share);
  for (std::size_t i = 0; i < 2; i++) {
    const std::vector<glm::vec4> light = reference::direct_light(tracer, camera, size_px, noisy,
                                                                 {.sample_count = noisy_samples * sample_count / 2,
                                                                  .seed = first_seed + 2 + i,
                                                                  .has_multiscatter = has_multiscatter});
    for (std::size_t j = 0; j < noisy.size(); j++) {
      halves[i].pixels[std::size_t(noisy[j].y) * std::size_t(size_px.x) + std::size_t(noisy[j].x)] = light[j];
    }
  }
  ReferencePicture result{std::move(halves[0]), 0.0};
  double square = 0.0;
  for (std::size_t i = 0; i < result.picture.pixels.size(); i++) {
    const glm::dvec3 half_off = 0.5 * glm::dvec3(result.picture.pixels[i] - halves[1].pixels[i]);
    square += glm::dot(half_off, half_off);
    result.picture.pixels[i] = 0.5F * (result.picture.pixels[i] + halves[1].pixels[i]);
  }
  result.noise = std::sqrt(square / double(3 * result.picture.pixels.size()));
  return result;
}

}  // namespace gnomon::measure
