// SPDX-License-Identifier: MIT
#pragma once

#include "draw_view_transform_shared.h"
#include "gpu_device.hh"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include <optional>
#include <variant>

/**
 * Targets of Viewport::draw: a framebuffer of the device or of the host.
 *
 * A viewport accumulates samples in its own textures and writes their mean to the target at the end of each draw. The
 * viewport never reads the target, so each draw may have a different target, and a target may be multisampled.
 */
namespace gnomon::draw {

/** Conversion of scene-linear light to display colours. \see draw_view_transform_shared.h */
enum class ViewTransform {
  /** Clips linear light to [0, 1] and applies sRGB's transfer function. */
  Standard = VIEW_TRANSFORM_STANDARD,
  /** Clips linear light to [0, 1]. */
  Raw = VIEW_TRANSFORM_RAW,
  Agx = VIEW_TRANSFORM_AGX,
  PbrNeutral = VIEW_TRANSFORM_PBR_NEUTRAL,
};

/** Encoding of the colours that are written to a target. */
enum class Encoding {
  /** Scene-linear radiance without exposure and view transform. For floating-point formats. */
  SceneLinear = ENCODING_SCENE_LINEAR,
  /** Display colours after exposure and view transform. They are stored unchanged, also in sRGB formats. */
  Display = ENCODING_DISPLAY,
  /**
   * The same stored values as Display, but the sRGB format of the target applies the transfer function, so blending
   * uses linear colours. \pre the colour attachment has an sRGB format
   */
  SrgbFormat = ENCODING_SRGB_FORMAT,
};

/** How a picture is combined with the target's content within the picture's rectangle. */
enum class Composition {
  /** Replaces colour, alpha and, with Target::depth, depth. Pixels without a surface get the host's farthest depth. */
  Replace,
  /**
   * The same as Replace, but the colour is not multiplied by alpha, as PNG files store it. Exposure and view transform
   * apply to the colour of the surfaces that cover a part of the pixel.
   */
  ReplaceStraight,
  /**
   * Blends the picture over the content: colour + (1 - alpha) * content, and the same for alpha. With Target::depth, a
   * pixel changes only if the picture's surface is at least as near as the stored depth, and its depth is then written.
   * Pixels without a surface do not change.
   */
  Over,
};

/** Depth convention of the host. The host's view space must be that of the picture's view, which looks along -Z. */
struct HostDepth {
  /** The host's projection. Only the rows of z and w are used. They must not depend on x and y. */
  glm::dmat4 clip_from_view{1.0};
  /** Range of z / w. true: [0, 1], as in Vulkan, Direct3D and GL_ZERO_TO_ONE. false: [-1, 1], OpenGL's default. */
  bool is_zero_to_one = false;
  /** Stored depths of the lower and the upper end of z / w (glDepthRange), each in [0, 1]; they must differ. */
  glm::dvec2 range{0.0, 1.0};
};

/** Limit of exposures, stops. Within it, 2^exposure is finite and not denormal. */
inline constexpr float exposure_max = 120.0F;

/** The target of a draw. Plain data. With a default-constructed target, the viewport draws but writes no picture. */
struct Target {
  /** A framebuffer of the device or of the host. It must live until the draw is submitted. */
  std::variant<std::monostate, const gpu::Framebuffer *, gpu::HostFramebuffer> framebuffer{};
  /** Lower left corner of the picture in the framebuffer. Pixels outside of the picture do not change. */
  glm::ivec2 origin_px{0};
  /**
   * Size of the picture in the framebuffer, pixels; 0: that of the viewport. In another size, colour and alpha are
   * interpolated between the four nearest pixels. Depth is taken from the nearest pixel, because a mean of two
   * surfaces' depths lies on neither.
   */
  glm::ivec2 size_px{0};
  Encoding encoding = Encoding::Display;
  ViewTransform view_transform = ViewTransform::Standard;
  /** Stops, from -exposure_max to exposure_max. Radiance is multiplied by 2^exposure before the view transform. */
  float exposure = 0.0F;
  Composition composition = Composition::Replace;
  /** If set, the picture's depth is written to the framebuffer's depth attachment, too. */
  std::optional<HostDepth> depth{};

  explicit operator bool() const
  {
    return framebuffer.index() != 0;
  }
};

/** Size in \a target of a picture of \a size_px. \see Target::size_px */
[[nodiscard]] glm::ivec2 size_in(const Target &target, glm::ivec2 size_px);

/** \throws gpu::Error if a picture of \a size_px cannot be written to \a target */
void check(const Target &target, glm::ivec2 size_px);

/** Begin a pass that writes only the \a region of a picture of \a size_px to \a target. A scaled picture is whole. */
void begin_pass(gpu::CommandList &list, std::string_view name, const Target &target, glm::ivec2 size_px,
                const gpu::Rectangle &region, gpu::PassActions actions);

/** Maps the depth d of a picture to the host's depth: (scale.x d + scale.y) / (scale.z d + scale.w). */
struct DepthMap {
  glm::vec4 scale{1.0F, 0.0F, 0.0F, 1.0F};
  /** The host's depth of pixels without a surface. */
  float background = 0.0F;
  /** Whether the host stores smaller depths for nearer surfaces. */
  bool is_near_smaller = false;
};

/** The map from the reversed depth of the projection \a clip_from_view to \a host. \pre check() accepts \a host */
[[nodiscard]] DepthMap depth_map(const glm::mat4 &clip_from_view, const HostDepth &host);

/** A texture of the device with a framebuffer, to be used as a target. */
class TargetTexture {
 public:
  /** \throws gpu::Error if the device cannot create the texture */
  TargetTexture(gpu::Device &device, std::string name, gpu::Format format, glm::ivec2 size_px);

  [[nodiscard]] const gpu::Texture &texture() const
  {
    return texture_;
  }
  /** A target that covers the whole texture, with default settings. Valid as long as this object. */
  [[nodiscard]] Target target() const
  {
    return {.framebuffer = &framebuffer_};
  }

 private:
  gpu::Texture texture_;
  gpu::Framebuffer framebuffer_;
};

}  // namespace gnomon::draw
