// SPDX-License-Identifier: MIT
#pragma once

#include "reference_tracer.hh"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <functional>
#include <span>
#include <vector>

namespace gnomon::reference {

struct DirectLightSettings {
  /** Camera rays a pixel; each lamp with a size is sampled once by each. At least 1. */
  int sample_count = 16;
  /** Another seed takes other samples. The same gives the same picture, to the bit, with any number of threads. */
  std::uint64_t seed = 0;
  /** 0: one a processor. */
  unsigned thread_count = 0;
  /** Called now and then, by one thread at a time, with a share in (0, 1]. May be empty. */
  std::function<void(double share_done)> progress{};
};

struct Picture {
  glm::ivec2 size_px{0};
  /** Scene-linear radiance, W/(sr m²), and 1; rows from the bottom. */
  std::vector<glm::vec4> pixels;
};

/**
 * What \a camera sees by the light that comes straight from the lamps, and by what surfaces emit themselves, in an
 * image of \a size_px; black where there is nothing.
 *
 * Frame, clip distances, pixel filter, units and materials are those of `doc/conventions.md`. Each pixel is the
 * filter's weighted mean of all samples within 1.5 pixels of its centre. Normals are interpolated; a lamp behind the
 * triangle gives no light, whatever the interpolated normal says. Backs of one-sided materials are looked through, yet
 * they cast shadows. Hemi lamps, and those that ask for none, cast none.
 *
 * \throws std::invalid_argument for a size or a number of samples below 1.
 */
[[nodiscard]] Picture direct_light(const Tracer &tracer, const scene::PlacedCamera &camera, glm::ivec2 size_px,
                                   const DirectLightSettings &settings);

/**
 * The same at some of its pixels only, from the lower left corner: each from as many samples as a pixel has there,
 * spread over its filter, so that neighbours share none. Estimates with two seeds are independent of each other.
 */
[[nodiscard]] std::vector<glm::vec4> direct_light(const Tracer &tracer, const scene::PlacedCamera &camera, glm::ivec2 size_px,
                                                  std::span<const glm::ivec2> pixels,
                                                  const DirectLightSettings &settings);

}  // namespace gnomon::reference
