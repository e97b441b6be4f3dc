// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_texture.hh"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <vector>

namespace gnomon::gpu {

/** Value of Attachment::layer that attaches all layers of the texture. The shader selects one with `gl_Layer`. */
inline constexpr int all_layers = -1;

/** A part of a texture that a framebuffer draws into. */
struct Attachment {
  /** nullptr: no attachment; allowed for depth only. The texture must outlive the framebuffer. */
  const Texture *texture = nullptr;
  /** Index of one layer, or all_layers. */
  int layer = 0;
  int mip_level = 0;
  /**
   * Greater than 1: attaches this number of layers, beginning with `layer`. `gl_Layer` 0 selects `layer`, and passes
   * clear only the attached layers. Must be 1 with all_layers.
   */
  int layer_count = 1;
};

struct FramebufferDesc {
  std::string name;
  /**
   * At most Limits::color_attachment_max. All attachments must have the same size. Colours that a program writes and
   * the framebuffer lacks are discarded.
   */
  std::vector<Attachment> colors;
  Attachment depth;
};

/** An Attachment that names its texture by id. */
struct AttachmentLayout {
  /** 0: no attachment. */
  ResourceId texture = 0;
  int layer = 0;
  int mip_level = 0;
  int layer_count = 1;
};

/** A FramebufferDesc that names its textures by id. Input of the backends. */
struct FramebufferLayout {
  std::string name;
  std::vector<AttachmentLayout> colors;
  AttachmentLayout depth;
  glm::ivec2 size_px{0};
};

/** Render target of a pass. Its attachments are textures of the device. */
class Framebuffer : public Resource {
 public:
  Framebuffer() = default;
  [[nodiscard]] glm::ivec2 size_px() const
  {
    return size_px_;
  }

 private:
  friend class Device;
  Framebuffer(Resource resource, glm::ivec2 size_px) : Resource(std::move(resource)), size_px_(size_px) {}
  glm::ivec2 size_px_{0};
};

/**
 * A framebuffer that the host created, as the render target of a pass. Requires ContextKind::Host. This is plain data:
 * the host may pass a different framebuffer in each frame. It may be multisampled; a draw that covers a pixel
 * completely writes the same value to all of its samples.
 */
struct HostFramebuffer {
  /** OpenGL name; 0: the default framebuffer. Only its first draw buffer is written. */
  std::uint32_t name = 0;
  glm::ivec2 size_px{0};
};

/** A rectangle of a framebuffer, in pixels from its lower left corner. The default is the whole framebuffer. */
struct Rectangle {
  glm::ivec2 origin_px{0};
  glm::ivec2 size_px{0};

  [[nodiscard]] bool is_whole() const
  {
    return origin_px == glm::ivec2(0) && size_px == glm::ivec2(0);
  }
  bool operator==(const Rectangle &) const = default;
};

enum class LoadAction : std::uint8_t {
  /** Keep the content. */
  Load,
  Clear,
  /** The content becomes undefined. Use it if the pass writes all pixels, or if no pixel is read. */
  DontCare,
};

enum class StoreAction : std::uint8_t { Store, DontCare };

/**
 * Added to the depths of a triangle: slope * m + constant * r. m is the largest change of the triangle's depth
 * from one pixel to the next, in x or in y. r is the smallest difference of depths that the format has near the
 * triangle's largest depth: of Depth32F, that number's last digit (OpenGL 4.5, 14.6.5). Depth is reversed, therefore
 * negative values move away from the view.
 */
struct DepthBias {
  float constant = 0.0F;
  float slope = 0.0F;

  bool operator==(const DepthBias &) const = default;
};

/** Settings of a render pass. All colour attachments are loaded, cleared and stored in the same way. */
struct PassActions {
  LoadAction color_load = LoadAction::Clear;
  StoreAction color_store = StoreAction::Store;
  glm::vec4 clear_color{0.0F};
  LoadAction depth_load = LoadAction::Clear;
  StoreAction depth_store = StoreAction::Store;
  /** Depth is reversed: 0 is the far plane. */
  float clear_depth = 0.0F;
  DepthBias depth_bias{};
  Rectangle viewport{};
  /** Draws and clears write only inside this rectangle. */
  Rectangle scissor{};
  /**
   * true: attachments of an sRGB format encode colours when they are written, and blend linear colours. false: colours
   * are stored unchanged.
   */
  bool is_srgb_encoded = false;
  /**
   * true: draws may look up the colour attachments. A fragment may read its own texel once, before it writes it
   * (OpenGL 4.5, 9.3.1; a texture barrier precedes the pass).
   */
  bool reads_attachments = false;
};

}  // namespace gnomon::gpu
