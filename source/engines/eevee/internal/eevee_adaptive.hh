// SPDX-License-Identifier: MIT
#pragma once

#include "internal/eevee_depth.hh"
#include "internal/eevee_film.hh"

namespace gnomon::eevee {

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

/**
 * Adaptive sampling: after the first samples of a picture, a pixel gets further samples only if it differs from its
 * neighbours by more than Settings::noise_threshold. Other pixels are converged: the depth test skips them in all
 * passes that draw objects or light, and their mean stays: decision 0032. Internal to the engine.
 */
class AdaptiveSampling {
 public:
  AdaptiveSampling(Film &film, const RenderBuffers &buffers, const DepthPasses &depth)
      : film_(film), buffers_(buffers), depth_(depth)
  {
  }
  /** For pictures with \a settings from now on. */
  void sync(const Settings &settings);
  /** Index in the picture of the sample that is drawn at \a position. */
  [[nodiscard]] int sample_index(const Settings &settings, int position) const;
  /** Create the resources, or destroy them where all pixels get all samples. */
  void make(const FrameState &state, const draw::Viewport &viewport);
  void resized();
  /** Record the passes, if there are resources. */
  void record(gpu::Device &device, ShaderCache &shaders, const Settings &settings, glm::ivec2 guard_px);
  /** \a is_whole: no region of the picture is drawn alone. */
  void begin_sample(bool is_whole);
  void begin_picture();

  void report(ResourceReport &report) const;
  /** Converged pixels of the current picture are skipped. */
  [[nodiscard]] bool is_active() const
  {
    return is_active_;
  }

  /** Depth of converged pixels, nearer than everything, before objects are drawn. */
  [[nodiscard]] FrameStep depth_step();
  /** Depth of converged pixels behind everything, so that deferred lighting skips them too. */
  [[nodiscard]] FrameStep background_step();
  /** Depth of converged pixels again, before forward objects are drawn after deferred lighting. */
  [[nodiscard]] FrameStep forward_depth_step();
  /** Adds the sample to the other pixels of the film, and keeps the mean of the converged ones. */
  [[nodiscard]] FrameStep film_step();
  /** Finds the converged pixels of the film after the first samples. */
  [[nodiscard]] FrameStep test_step();
  /** Finds the converged pixels of the radiance. */
  [[nodiscard]] FrameStep spread_step();

 private:
  [[nodiscard]] std::string_view why_all_samples(const FrameState &state) const;
  /** Need of a step that skips converged pixels. */
  [[nodiscard]] Need need_of(const FrameState &state, std::string_view why) const;
  [[nodiscard]] Need need_test(const FrameState &state) const;

  Film &film_;
  const RenderBuffers &buffers_;
  const DepthPasses &depth_;
  /** 1: the pixel of the film is converged; otherwise 0. Empty where all pixels get all samples. */
  gpu::Texture film_converged_;
  /** The same for pixels of the radiance: all film pixels that read them are converged. */
  gpu::Texture drawn_converged_;
  gpu::Framebuffer test_fb_;
  gpu::Framebuffer spread_fb_;
  /** The film, with `film_converged_` as its depth. */
  gpu::Framebuffer film_fb_;
  draw::Pass test_pass_ = draw::Pass("adaptive_test_pass", gpu::State::WriteDepth);
  draw::Pass spread_pass_ = draw::Pass("adaptive_spread_pass", gpu::State::WriteDepth);
  draw::Pass depth_pass_ = draw::Pass("adaptive_depth_pass", gpu::State::WriteDepth | gpu::State::DepthNearerEqual);
  draw::Pass background_pass_ =
      draw::Pass("adaptive_background_pass", gpu::State::WriteDepth | gpu::State::DepthFurther);
  /** Instead of the film's own pass. */
  draw::Pass sampled_pass_ =
      draw::Pass("film_sampled_pass", gpu::State::WriteColor | gpu::State::BlendAdd | gpu::State::DepthNearerEqual);
  draw::Pass converged_pass_ =
      draw::Pass("film_converged_pass", gpu::State::WriteColor | gpu::State::BlendMultiply | gpu::State::DepthFurther);
  /** \see sample_step */
  int sample_step_ = 1;
  bool is_whole_picture_ = false;
  /** The first samples of the current picture were tested. */
  bool is_tested_ = false;
  bool is_active_ = false;
  /** Sum of the filter weights that the converged pixels of the film have, as Film::share. */
  double converged_share_ = 0.0;
  /** Passes read these by reference. */
  float sample_scale_ = 1.0F;
  glm::vec4 factor_{1.0F};
};

}  // namespace gnomon::eevee
