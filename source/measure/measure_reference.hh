// SPDX-License-Identifier: MIT
#pragma once

#include "reference_light.hh"

#include <functional>

namespace gnomon::measure {

struct ReferencePicture {
  reference::Picture picture;
  /** RMSE due to the picture's own noise, estimated from two independent halves of its samples. */
  double noise = 0.0;
};

/**
 * The reference for picture errors: reference::direct_light with \a sample_count samples for each pixel, and eight
 * times as many in the tenth of the pixels where the noise is largest. \a has_multiscatter: see
 * reference::DirectLightSettings.
 * \pre sample_count is even and at least 2
 */
[[nodiscard]] ReferencePicture reference_picture(const reference::Tracer &tracer, const scene::PlacedCamera &camera,
                                                 glm::ivec2 size_px, int sample_count, bool has_multiscatter = false);

}  // namespace gnomon::measure
