// SPDX-License-Identifier: MIT
#pragma once

#include "internal/eevee_frame.hh"

namespace gnomon::eevee {

/** The picture of a viewport: the sum of its samples, weighted by the pixel filter. Internal to the engine. */
class Film {
 public:
  /** For pictures with \a settings from now on. */
  void sync(const Settings &settings);
  /** Create the texture, unless it exists. */
  void make(gpu::Device &device, glm::ivec2 size_px);
  /** Destroy the targets that depend on the size of the picture. */
  void resized();
  /** Record the film's own pass. \see add_to */
  void record(const gpu::Shader &shader, const gpu::Texture &radiance, glm::ivec2 origin_px,
              const gpu::Sampler &nearest);
  /** Record in \a pass that \a radiance is added to the film. \a origin_px: its pixel at pixel (0, 0) of the film */
  void add_to(draw::Pass &pass, const gpu::Shader &shader, const gpu::Texture &radiance, glm::ivec2 origin_px,
              const gpu::Sampler &nearest) const;

  void report(ResourceReport &report) const;
  void begin_picture();
  /** Set the filter weights of \a sample, which the passes of add_to read. */
  void set_weights(const FrameSample &sample);
  /** The sample with the index \a sample_index is whole, and is the last of \a count samples. */
  void count_sample(const Settings &settings, int sample_index, int count);
  /** \see Engine::finish */
  void finish(const Settings &settings, int samples_drawn);

  /** Empty before make. */
  [[nodiscard]] const gpu::Texture &texture() const
  {
    return texture_;
  }
  /** Whole samples in the texture. */
  [[nodiscard]] int sample_count() const
  {
    return sample_count_;
  }
  /** Sum of the filter weights of the samples so far, in units of those of all samples. \see Engine::sample_share */
  [[nodiscard]] double share() const
  {
    return share_;
  }
  /** share() with the sample with the index \a sample_index. */
  [[nodiscard]] double share_with(const Settings &settings, int sample_index) const;
  [[nodiscard]] bool has_all_samples(const Settings &settings, int samples_drawn) const;
  /** \see Engine::radiance_scale */
  [[nodiscard]] float scale(const Settings &settings, int samples_drawn) const;

  /** Adds the sample to all pixels. */
  [[nodiscard]] FrameStep step();

 private:
  [[nodiscard]] Need need(const FrameState &state) const;

  gpu::Texture texture_;
  gpu::Framebuffer framebuffer_;
  draw::Pass pass_ = draw::Pass("film_pass", gpu::State::WriteColor | gpu::State::BlendAdd);
  /** Filter weights of the current sample. Passes read them by reference. */
  glm::vec4 columns_{0.0F};
  glm::vec4 rows_{0.0F};
  /** \see film_weight_sum */
  double weight_sum_ = 0.0;
  double share_ = 0.0;
  int sample_count_ = 0;
  /** finish ended the picture. */
  bool is_finished_ = false;
};

}  // namespace gnomon::eevee
