// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_frame.hh"

/**
 * Adaptive sampling: after the first samples of a picture, a pixel gets further samples only if it differs from its
 * neighbours by more than Settings::noise_threshold. Other pixels are converged: the depth test skips them in all
 * passes that draw objects or light, and their mean stays. Internal to the engine.
 */
namespace gnomon::eevee {

/** State of adaptive sampling in a viewport. Textures and framebuffers are created when a threshold is set. */
struct AdaptiveSampling {
  /** 1: the pixel of the film is converged; otherwise 0. */
  gpu::Texture film_converged;
  /** The same for pixels of the radiance: all film pixels that read them are converged. */
  gpu::Texture drawn_converged;
  gpu::Framebuffer test_fb;
  gpu::Framebuffer spread_fb;
  /** The film, with `film_converged` as its depth. */
  gpu::Framebuffer film_fb;
  /** No region of the picture is drawn alone. */
  bool is_whole_picture = false;
  /** The first samples of the current picture were tested. */
  bool is_tested = false;
  /** Converged pixels of the current picture are skipped. */
  bool is_active = false;
  /** Sum of the filter weights that the converged pixels of the film have, as StorageList::film_share. */
  double converged_share = 0.0;
  /** Passes read these by reference. */
  float sample_scale = 1.0F;
  glm::vec4 factor{1.0F};
};

/** Largest result of adaptive_first_samples(). */
inline constexpr int adaptive_first_max = 4;

/**
 * Samples of a picture that all pixels get: those from which convergence is tested. \a sample_count: samples of the
 * picture, at least 1.
 */
[[nodiscard]] int adaptive_first_samples(int sample_count);

/**
 * The step between the indices of samples that are drawn one after the other, modulo their number. With a threshold,
 * the first adaptive_first_samples() are spread over the pixel, although indices rise from its left to its right side.
 * Otherwise 1.
 */
[[nodiscard]] int sample_step(const Settings &settings);

/** Whether the settings and the scene allow that some pixels get fewer samples, so that the passes are recorded. */
[[nodiscard]] bool has_adaptive_passes(const FrameState &state);

/** Depth of converged pixels, nearer than everything, before objects are drawn. */
[[nodiscard]] Need need_adaptive_depth(const FrameState &state);
void record_adaptive_depth(const FrameStep &step, FrameSample &sample, gpu::CommandList &list);

/** Depth of converged pixels behind everything, so that deferred lighting skips them too. */
[[nodiscard]] Need need_adaptive_background(const FrameState &state);
void record_adaptive_background(const FrameStep &step, FrameSample &sample, gpu::CommandList &list);

/** Depth of converged pixels again, before forward objects are drawn after deferred lighting. */
[[nodiscard]] Need need_adaptive_forward_depth(const FrameState &state);
void record_adaptive_forward_depth(const FrameStep &step, FrameSample &sample, gpu::CommandList &list);

/** Adds the sample to the other pixels of the film, and keeps the mean of the converged ones. */
[[nodiscard]] Need need_adaptive_film(const FrameState &state);
void record_adaptive_film(const FrameStep &step, FrameSample &sample, gpu::CommandList &list);

/** Finds the converged pixels of the film after the first samples. */
[[nodiscard]] Need need_adaptive_test(const FrameState &state);
void record_adaptive_test(const FrameStep &step, FrameSample &sample, gpu::CommandList &list);

/** Finds the converged pixels of the radiance. */
[[nodiscard]] Need need_adaptive_spread(const FrameState &state);
void record_adaptive_spread(const FrameStep &step, FrameSample &sample, gpu::CommandList &list);

}  // namespace gnomon::eevee
