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
  /** Camera rays for each pixel, at least 1. Each ray takes one sample of each lamp that has a size. */
  int sample_count = 16;
  /** Selects the samples. The same seed gives the same picture bit for bit, with any number of threads. */
  std::uint64_t seed = 0;
  /** 0: one thread for each processor. */
  unsigned thread_count = 0;
  /** \see eevee::Settings::has_multiscatter */
  bool has_multiscatter = false;
  /**
   * Called repeatedly, by one thread at a time, with the completed fraction in (0, 1]. May be empty. An exception from
   * it ends the work and is thrown to the caller.
   */
  std::function<void(double share_done)> progress{};
};

/** A picture in memory. */
struct Picture {
  glm::ivec2 size_px{0};
  /** rgb: scene-linear radiance, W/(sr m²). a: 1. Rows from the bottom. */
  std::vector<glm::vec4> pixels;
};

/**
 * Renders the view of \a camera with direct light from the lamps, the world and surfaces that emit light, as an image
 * of \a size_px. Pixels without a surface are black.
 *
 * `doc/conventions.md` defines frame, clip distances, pixel filter, units and materials. Each pixel is the weighted
 * mean of all samples within 1.5 pixels of its centre. Normals are interpolated. A lamp behind the plane of the
 * triangle gives no light, even if the interpolated normal faces it. The backs of one-sided materials are invisible
 * to the camera but cast shadows. A blended surface covers what is behind it, and shades light, by its alpha. Hemi
 * lamps, and lamps whose shadow setting is None, cast no shadow. Each camera ray takes one point of the surfaces that
 * emit light; nearer to it than about a hundredth of their size, their light on others is too small.
 *
 * \throws std::invalid_argument for a size or a number of samples below 1.
 */
[[nodiscard]] Picture direct_light(const Tracer &tracer, const scene::PlacedCamera &camera, glm::ivec2 size_px,
                                   const DirectLightSettings &settings);

/**
 * Renders only \a pixels, which are counted from the lower left corner. Each has sample_count samples of its own,
 * distributed by the pixel filter, and shares none with its neighbours. Estimates with different seeds are independent.
 */
[[nodiscard]] std::vector<glm::vec4> direct_light(const Tracer &tracer, const scene::PlacedCamera &camera,
                                                  glm::ivec2 size_px, std::span<const glm::ivec2> pixels,
                                                  const DirectLightSettings &settings);

}  // namespace gnomon::reference
