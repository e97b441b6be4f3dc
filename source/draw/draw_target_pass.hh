// SPDX-License-Identifier: MIT
#pragma once

#include "draw_pass.hh"
#include "draw_target.hh"

namespace gnomon::draw {

/**
 * Writes pictures to targets by a pass that the engine owns. The pass is built again only if the textures, the shader
 * or the state differ from the previous target's. An engine owns one TargetPass for each viewport, and its shader
 * (draw_target_frag.glsl).
 */
class TargetPass {
 public:
  TargetPass() = default;
  TargetPass(const TargetPass &) = delete;
  TargetPass &operator=(const TargetPass &) = delete;

  /** A rendered picture. */
  struct Picture {
    /** Scene-linear radiance, premultiplied by alpha, and alpha. The shader multiplies all channels by `scale`. */
    const gpu::Texture &radiance;
    /** Pixel of `radiance` that is the lower left pixel of the picture. */
    glm::ivec2 radiance_origin_px{0};
    /** Size of the picture. */
    glm::ivec2 size_px{1};
    float scale = 1.0F;
    /** Reversed depth; 0 in pixels without a surface. Needed only if Target::depth is set. */
    const gpu::Texture *depth = nullptr;
    glm::ivec2 depth_origin_px{0};
    /** The projection that `depth` was drawn with. */
    glm::mat4 clip_from_view{1.0F};
    /** Whether pixels with radiance may have no depth: blended surfaces with nothing behind them. */
    bool has_blended = false;
  };

  /**
   * Build \a pass, which has State::WriteColor, to write \a picture to \a target. It must be the same pass in each
   * call. \a shader: eevee_tonemap, with USE_TARGET_DEPTH if Target::depth is set. \a nearest: a sampler with
   * Filter::Nearest. This object, the textures, the shader and the sampler must live until the last submission.
   * \pre check() accepts \a target
   */
  void set(Pass &pass, const Target &target, const Picture &picture, const gpu::Shader &shader,
           const gpu::Sampler &nearest);
  /** Make the next set() build the pass again. Call this after the pass was cleared or replaced. */
  void reset()
  {
    recorded_ = {};
  }

 private:
  /** Push constants of draw_target_frag.glsl, bound by reference. */
  struct Constants {
    DepthMap depth;
    glm::ivec2 origin_px{0};
    glm::ivec2 radiance_origin_px{0};
    glm::ivec2 depth_origin_px{0};
    glm::ivec2 picture_size_px{1};
    glm::ivec2 target_size_px{1};
    int view_transform = 0;
    int encoding = 0;
    float exposure_scale = 1.0F;
    float sample_scale = 1.0F;
    int is_over = 0;
    int is_straight = 0;
  };
  /** The inputs that the pass was built for. */
  struct Key {
    gpu::State state = gpu::State::None;
    gpu::ResourceId radiance = 0;
    /** 0: the target takes no depth. */
    gpu::ResourceId depth = 0;
    gpu::ResourceId shader = 0;
    bool has_blended = false;

    bool operator==(const Key &) const = default;
  };

  Constants constants_;
  Key recorded_;
};

}  // namespace gnomon::draw
