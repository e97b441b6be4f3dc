// SPDX-License-Identifier: MIT
#pragma once

#include "reference_light.hh"

#include <functional>

namespace gnomon::measure {

struct ReferencePicture {
  reference::Picture picture;
  /** RMSE of the picture by its own noise, as two independent halves of it tell. */
  double noise = 0.0;
};

/**
 * What pictures are judged by: reference::direct_light with \a sample_count samples a pixel, and where its noise is
 * largest, in a tenth of the pixels, with eight times as many: a picture is noisy at edges, and smooth elsewhere.
 * \pre sample_count is even and at least 2
 */
[[nodiscard]] ReferencePicture reference_picture(const reference::Tracer &tracer, const scene::PlacedCamera &camera,
                                                 glm::ivec2 size_px, int sample_count);

}  // namespace gnomon::measure
