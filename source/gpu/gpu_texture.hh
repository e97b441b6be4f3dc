// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_resource.hh"

#include <array>
#include <optional>
#include <string>

namespace gnomon::gpu {

/** Texel formats. Depth32F is used for every depth, RGBA32F for scene-linear radiance. */
enum class Format : std::uint8_t {
  /** Display-referred colour, [0, 1]. */
  RGBA8,
  /** sRGB-encoded colour, which a lookup decodes before it filters, and linear alpha. */
  SRGB8A8,
  /** Scene-linear radiance where half floats suffice; the largest value is 65504. */
  RGBA16F,
  RGBA32F,
  /** A distance in metres. */
  R16F,
  R32F,
  /** A mean and a spread. */
  RG32F,
  /** Reversed clip-space depth: 1 at the near plane, 0 at the far one. */
  Depth32F,
};

[[nodiscard]] bool is_depth(Format format);
[[nodiscard]] int texel_size_bytes(Format format);
[[nodiscard]] std::string_view to_string(Format format);

enum class TextureKind : std::uint8_t { Flat, Array };

struct TextureDesc {
  /** Shown in messages and debuggers. */
  std::string name;
  TextureKind kind = TextureKind::Flat;
  Format format = Format::RGBA8;
  /** Pixels, at least 1. */
  int width = 1;
  int height = 1;
  /** Array: number of slices. Flat: 1. */
  int layers = 1;
  /** Levels of the mip chain; 1: no smaller levels. */
  int mip_levels = 1;

  /** Of all levels and layers. */
  [[nodiscard]] std::size_t size_bytes() const;
};

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
/** Filter between the levels of a mip chain. None: level 0 only. */
enum class MipFilter : std::uint8_t { None, Nearest, Linear };

struct SamplerDesc {
  std::string name;
  Filter filter = Filter::Nearest;
  /** Filter where texels are smaller than pixels; absent: the same as `filter`. */
  std::optional<Filter> minified{};
  MipFilter mip = MipFilter::None;
  Wrap wrap_u = Wrap::ClampToEdge;
  Wrap wrap_v = Wrap::ClampToEdge;
  /**
   * For `sampler2DShadow` and `sampler2DArrayShadow`: a lookup returns 1 where the reference is greater than or equal
   * to the stored depth (depth is reversed: nearer or as near), otherwise 0. Filter::Linear interpolates four results.
   */
  bool is_depth_comparison = false;
};

class Sampler : public Resource {
 public:
  Sampler() = default;

 private:
  friend class Device;
  explicit Sampler(Resource resource) : Resource(std::move(resource)) {}
};

}  // namespace gnomon::gpu
