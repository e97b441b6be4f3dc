// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_resource.hh"

#include <array>
#include <optional>
#include <string>

namespace gnomon::gpu {

/** Named by content; the purpose decides: Depth32F for every depth, RGBA32F for scene-linear radiance. */
enum class Format : std::uint8_t {
  /** Display-referred colour, [0, 1]. */
  RGBA8,
  /** Colour encoded as sRGB, which a lookup decodes before it filters, and linear alpha. */
  SRGB8A8,
  /** Scene-linear radiance where half floats are enough: largest value 65504. */
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

enum class TextureKind : std::uint8_t { Flat, Array, Cube, CubeArray };

struct TextureDesc {
  /** Shown in messages and debuggers. */
  std::string name;
  TextureKind kind = TextureKind::Flat;
  Format format = Format::RGBA8;
  /** Pixels, at least 1. Cubes: equal. */
  int width = 1;
  int height = 1;
  /** Array: slices. CubeArray: cubes, of six layers each. Otherwise 1. */
  int layers = 1;
  /** Levels of the mip chain; 1: no mip-maps. */
  int mip_levels = 1;

  /** Slices that an attachment can name: six for each cube. */
  [[nodiscard]] int layer_count() const
  {
    return kind == TextureKind::Cube || kind == TextureKind::CubeArray ? 6 * layers : layers;
  }
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
/** Between the levels of a mip chain; None: level 0 only. */
enum class MipFilter : std::uint8_t { None, Nearest, Linear };

struct SamplerDesc {
  std::string name;
  Filter filter = Filter::Nearest;
  /** Where texels are smaller than pixels; absent: as `filter`. */
  std::optional<Filter> minified{};
  MipFilter mip = MipFilter::None;
  Wrap wrap_u = Wrap::ClampToEdge;
  Wrap wrap_v = Wrap::ClampToEdge;
  /**
   * For `sampler…Shadow`: the lookup gives 1 where the reference is nearer than or as near as the stored depth
   * (reversed: greater or equal), and with Filter::Linear the blend of four such answers.
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
