// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_tonemap_shared.h"
#include "gpu_device.hh"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include <optional>
#include <variant>

/**
 * Where a picture is written to: a framebuffer of the device's or of the host's, given with each draw.
 *
 * A viewport accumulates its samples in textures of its own and writes their mean to the target at the end of each
 * draw. The target is therefore never read, may be another one in every frame, and may be multisampled.
 */
namespace gnomon::draw {

/** What a display shows for scene-linear light. \see eevee_tonemap_shared.h */
enum class ViewTransform {
  /** Clips linear light to [0, 1] and applies sRGB's transfer function. */
  Standard = VIEW_TRANSFORM_STANDARD,
  /** Clips linear light to [0, 1]. */
  Raw = VIEW_TRANSFORM_RAW,
  Agx = VIEW_TRANSFORM_AGX,
  PbrNeutral = VIEW_TRANSFORM_PBR_NEUTRAL,
};

/** How a target stores colours. */
enum class Encoding {
  /** Radiance as it is, without exposure and view transform. For floating-point formats. */
  SceneLinear = ENCODING_SCENE_LINEAR,
  /** Exposed and view-transformed, and stored as it is, also by sRGB formats. */
  Display = ENCODING_DISPLAY,
  /**
   * Stored as with Display, but the target's sRGB format applies the transfer function, so that blending is done on
   * linear light. \pre the colour attachment has an sRGB format
   */
  SrgbFormat = ENCODING_SRGB_FORMAT,
};

/** What becomes of the target's content within the rectangle. */
enum class Composition {
  /** Colour, alpha and, with Target::depth, depth are replaced; depth by the host's farthest where nothing is seen. */
  Replace,
  /**
   * The picture lies over the content: colour + (1 - alpha) * content, alpha alike. With Target::depth, only where the
   * picture's surface is at least as near as the stored depth, which it then replaces; pixels without a surface change
   * nothing.
   */
  Over,
};

/** The host's convention of depth. Its view space is that of the picture's view, which looks along -Z. */
struct HostDepth {
  /** The host's projection. Only z and w as functions of the view's z are used; they must not depend on x and y. */
  glm::dmat4 clip_from_view{1.0};
  /** Of z / w: [0, 1] as in Vulkan, Direct3D and GL_ZERO_TO_ONE; otherwise [-1, 1], OpenGL's default. */
  bool is_zero_to_one = false;
  /** glDepthRange: stored for the lower and the upper end of z / w, each in [0, 1]. */
  glm::dvec2 range{0.0, 1.0};
};

/** Where and how a picture is written. Plain data; a default-constructed target is none: the picture stays inside. */
struct Target {
  /** A framebuffer of the device that outlives the draw, or one of the host's. */
  std::variant<std::monostate, const gpu::Framebuffer *, gpu::HostFramebuffer> framebuffer{};
  /** Lower left corner of the picture within the framebuffer. Nothing outside of the picture's rectangle changes. */
  glm::ivec2 origin_px{0};
  Encoding encoding = Encoding::Display;
  ViewTransform view_transform = ViewTransform::Standard;
  /** Stops, -120 to 120: radiance is multiplied by 2^exposure before the view transform. */
  float exposure = 0.0F;
  Composition composition = Composition::Replace;
  /** Write the picture's depth, too, into the framebuffer's depth attachment. */
  std::optional<HostDepth> depth{};

  explicit operator bool() const
  {
    return framebuffer.index() != 0;
  }
};

/** \throws gpu::Error where a picture of \a size_px cannot be written to \a target. */
void check(const Target &target, glm::ivec2 size_px);

/** Begin a pass that draws into the rectangle of a picture of \a size_px in \a target. */
void begin_pass(gpu::CommandList &list, std::string_view name, const Target &target, glm::ivec2 size_px,
                gpu::PassActions actions);

/** Maps a picture's depth d to a host's: (scale.x d + scale.y) / (scale.z d + scale.w). */
struct DepthMap {
  glm::vec4 scale{1.0F, 0.0F, 0.0F, 1.0F};
  /** What the host stores where nothing is seen. */
  float background = 0.0F;
  /** The host stores smaller numbers for what is nearer. */
  bool is_near_smaller = false;
};

/** From depths of \a clip_from_view (reversed, see View) to \a host. \throws gpu::Error where the host's has no depth.
 */
[[nodiscard]] DepthMap depth_map(const glm::mat4 &clip_from_view, const HostDepth &host);

/** A texture of the device to draw a picture into. */
class TargetTexture {
 public:
  /** \throws gpu::Error where the device cannot hold it. */
  TargetTexture(gpu::Device &device, std::string name, gpu::Format format, glm::ivec2 size_px);

  [[nodiscard]] const gpu::Texture &texture() const
  {
    return texture_;
  }
  /** The whole texture. To be completed by the caller. */
  [[nodiscard]] Target target() const
  {
    return {.framebuffer = &framebuffer_};
  }

 private:
  gpu::Texture texture_;
  gpu::Framebuffer framebuffer_;
};

}  // namespace gnomon::draw
