// SPDX-License-Identifier: MIT
#pragma once

#include "draw_pass.hh"
#include "draw_target.hh"

namespace gnomon::draw {

/**
 * Writes pictures to targets: a pass that is recorded again only where a target differs in kind from the one before.
 * Engines own one for each viewport, and the program for it, eevee_tonemap_frag.glsl.
 */
class TargetPass {
 public:
  TargetPass() = default;
  TargetPass(const TargetPass &) = delete;
  TargetPass &operator=(const TargetPass &) = delete;

  /** A picture to be written. */
  struct Picture {
    /** Scene-linear radiance and alpha, multiplied by `scale`. */
    const gpu::Texture &radiance;
    float scale = 1.0F;
    /** For targets that take depth: reversed, 0 where nothing is seen. */
    const gpu::Texture *depth = nullptr;
    /** That the depth is of. */
    glm::mat4 clip_from_view{1.0F};
  };

  /**
   * The next record is of \a picture for \a target. \a shader: the program, with USE_TARGET_DEPTH where the target
   * takes depth. \a nearest: a sampler without filter. Both textures, the shader and the sampler must live until the
   * last submission. \throws gpu::Error as depth_map
   */
  void set(const Target &target, const Picture &picture, const gpu::Shader &shader, const gpu::Sampler &nearest);
  /** Draws the picture: to be called between begin_pass and end_pass. */
  void record(gpu::CommandList &list) const
  {
    pass_.record({}, list);
  }
  /** Where nothing is seen: the depth to clear a target to that takes depth. */
  [[nodiscard]] float background_depth() const
  {
    return constants_.depth.background;
  }

 private:
  /** Read by reference. \see eevee_tonemap_frag.glsl */
  struct Constants {
    DepthMap depth;
    glm::ivec2 origin_px{0};
    int view_transform = 0;
    int encoding = 0;
    float exposure_scale = 1.0F;
    float sample_scale = 1.0F;
    int is_over = 0;
  };
  /** What the pass was recorded for. */
  struct Key {
    gpu::State state = gpu::State::None;
    gpu::ResourceId radiance = 0;
    /** 0: the target takes no depth. */
    gpu::ResourceId depth = 0;
    gpu::ResourceId shader = 0;

    bool operator==(const Key &) const = default;
  };

  Pass pass_{"target", gpu::State::WriteColor};
  Constants constants_;
  Key recorded_;
};

}  // namespace gnomon::draw
