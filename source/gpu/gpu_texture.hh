// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_resource.hh"

#include <glm/vec2.hpp>

#include <array>
#include <optional>
#include <string>

namespace gnomon::gpu {

/** Texel formats. */
enum class Format : std::uint8_t {
  /** Display-referred colour, [0, 1]. */
  RGBA8,
  /** sRGB-encoded colour and linear alpha. A texture lookup decodes the colour before filtering. */
  SRGB8A8,
  /** Scene-linear radiance with half precision; the largest value is 65504. */
  RGBA16F,
  /** Scene-linear radiance with full precision. */
  RGBA32F,
  /** Distances in metres, with half and with full precision. */
  R16F,
  R32F,
  /** Mean and spread of exponential variance shadow maps. */
  RG32F,
  /** Reversed clip-space depth: 1 at the near plane, 0 at the far one. */
  Depth32F,
  /** The same with steps of 1 / 65535. Use it only where the error of half a step is accounted for. */
  Depth16,
  /** The format of a HostTexture, which shaders can only look up. A lookup returns normalised values or floats. */
  Host,
};

[[nodiscard]] bool is_depth(Format format);
[[nodiscard]] int texel_size_bytes(Format format);
[[nodiscard]] std::string_view to_string(Format format);

/**
 * Buffer: a row of texels in a buffer, which shaders read through a `samplerBuffer` by texelFetch. It has no mip
 * levels, cannot be attached to a framebuffer, and is not affected by samplers.
 */
enum class TextureKind : std::uint8_t { Flat, Array, Buffer };

/**
 * A texture that the host created. Requires ContextKind::Host, or a VulkanHost. This is plain data, and the host keeps
 * the ownership. The texture must live until the last submission of a list that looks it up, and with Vulkan until the
 * device has executed it. The host may write it between calls; with Vulkan, it makes the writes visible to shaders, and
 * waits for the draws before it writes.
 */
struct HostTexture {
  /**
   * Not 0. OpenGL: a texture of the target GL_TEXTURE_2D. Vulkan: an image of two dimensions with the usage SAMPLED.
   * Its channels are floats or normalised.
   */
  HostHandle name = 0;
  /** Texels of level 0, at least 1x1. */
  glm::ivec2 size_px{0};
  /**
   * The texture is complete for filters between mip levels: all levels have texels, down to 1x1, GL_TEXTURE_MAX_LEVEL
   * or the last one of immutable storage. false: only level 0 is looked up.
   */
  bool has_mip_levels = false;
  /** Vulkan only: VkFormat, of colours, and the VkImageLayout during draws, READ_ONLY or GENERAL. */
  int format = 0;
  int layout = 0;

  bool operator==(const HostTexture &) const = default;
};

struct TextureDesc {
  /** Shown in messages and debuggers. */
  std::string name;
  TextureKind kind = TextureKind::Flat;
  Format format = Format::RGBA8;
  /** Texels of level 0, at least 1. Buffer: the height is 1. */
  int width = 1;
  int height = 1;
  /** Array: number of layers. Flat, Buffer: 1. */
  int layers = 1;
  /** Number of mip levels, level 0 included; at least 1. */
  int mip_levels = 1;
  /** Format::Host: the texture of the host, which is used instead of a new one. Otherwise its name is 0. */
  HostTexture host{};

  /** Bytes of all levels and layers; 0 for a texture of the host. */
  [[nodiscard]] std::size_t size_bytes() const;
};

/** Description of a texture of the host. Its mip levels are those that a lookup may read. */
[[nodiscard]] TextureDesc texture_desc(std::string name, const HostTexture &texture);

/** Texels on the device. */
class Texture : public Resource {
 public:
  Texture() = default;
  [[nodiscard]] const TextureDesc &desc() const
  {
    return desc_;
  }

 private:
  friend class Device;
  Texture(Resource resource, TextureDesc desc) : Resource(std::move(resource)), desc_(std::move(desc)) {}
  TextureDesc desc_;
};

enum class Filter : std::uint8_t { Nearest, Linear };
enum class Wrap : std::uint8_t { ClampToEdge, Repeat, MirroredRepeat };
/** Filter between mip levels. None: samples level 0 only. */
enum class MipFilter : std::uint8_t { None, Nearest, Linear };

struct SamplerDesc {
  std::string name;
  Filter filter = Filter::Nearest;
  /** Filter for minification, where texels are smaller than pixels; absent: same as `filter`. */
  std::optional<Filter> minified{};
  MipFilter mip = MipFilter::None;
  Wrap wrap_u = Wrap::ClampToEdge;
  Wrap wrap_v = Wrap::ClampToEdge;
  /**
   * In [1, Limits::anisotropy_max]. A pixel covers a longish area of the texture where a surface is seen at a grazing
   * angle. Up to this ratio of its length to its width, a lookup filters along the length without blur across it. At 1,
   * every area is filtered as a circle. Above 1, both filters must be linear and `mip` must not be None, because OpenGL
   * does not define other combinations.
   */
  int anisotropy = 1;
  /**
   * For `sampler2DShadow` and `sampler2DArrayShadow`: a lookup returns 1 if the reference is greater than or equal to
   * the stored depth, otherwise 0. Because depth is reversed, 1 means at least as near. Filter::Linear interpolates the
   * results of four comparisons.
   */
  bool is_depth_comparison = false;
};

/** How a lookup filters a texture. */
class Sampler : public Resource {
 public:
  Sampler() = default;

 private:
  friend class Device;
  explicit Sampler(Resource resource) : Resource(std::move(resource)) {}
};

}  // namespace gnomon::gpu
