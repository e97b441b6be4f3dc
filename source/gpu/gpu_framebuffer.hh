// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_texture.hh"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <vector>

namespace gnomon::gpu {

/** Attaches every layer of the texture; the shader selects one by `gl_Layer`. */
inline constexpr int all_layers = -1;

struct Attachment {
  /** nullptr: no attachment. Must outlive the framebuffer. */
  const Texture *texture = nullptr;
  /** One layer, or all_layers. */
  int layer = 0;
  int mip_level = 0;
  /** More than 1: attaches this many layers from `layer` on. `gl_Layer` 0 is `layer`, and passes clear these layers
   * only. */
  int layer_count = 1;
};

struct FramebufferDesc {
  std::string name;
  /** At most Limits::color_attachment_max. All attachments must have the same size. */
  std::vector<Attachment> colors;
  Attachment depth;
};

/** An Attachment by id. */
struct AttachmentLayout {
  /** 0: no attachment. */
  ResourceId texture = 0;
  int layer = 0;
  int mip_level = 0;
  int layer_count = 1;
};

/** A FramebufferDesc by ids, as backends create it. */
struct FramebufferLayout {
  std::string name;
  std::vector<AttachmentLayout> colors;
  AttachmentLayout depth;
  glm::ivec2 size_px{0};
};

/** Render target of a pass, made of textures of the device. */
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
 * A framebuffer of the host's, in a device of ContextKind::Host: another render target of a pass. Plain data, which may
 * name another framebuffer in every frame. It may be multisampled: all samples of a pixel are written alike.
 */
struct HostFramebuffer {
  /** OpenGL's name; 0: the default framebuffer. Only the first of its draw buffers is written. */
  std::uint32_t name = 0;
  glm::ivec2 size_px{0};
};

/** From the lower left corner. */
struct Rectangle {
  glm::ivec2 origin_px{0};
  /** 0: the whole framebuffer. */
  glm::ivec2 size_px{0};

  [[nodiscard]] bool is_whole() const
  {
    return origin_px == glm::ivec2(0) && size_px == glm::ivec2(0);
  }
};

enum class LoadAction : std::uint8_t {
  /** Keep the content. */
  Load,
  Clear,
  /** The content may be lost: every pixel will be written, or none will be read. */
  DontCare,
};

enum class StoreAction : std::uint8_t { Store, DontCare };

/** Treatment of the attachments at the begin and at the end of a render pass; the same for all colour attachments. */
struct PassActions {
  LoadAction color_load = LoadAction::Clear;
  StoreAction color_store = StoreAction::Store;
  glm::vec4 clear_color{0.0F};
  LoadAction depth_load = LoadAction::Clear;
  StoreAction depth_store = StoreAction::Store;
  /** Reversed depth: 0 is far. */
  float clear_depth = 0.0F;
  Rectangle viewport{};
  /** Draws and clears change only this part. */
  Rectangle scissor{};
  /** Attachments of an sRGB format encode what is drawn, and blend linear colours. Otherwise they store it as it is. */
  bool is_srgb_encoded = false;
};

}  // namespace gnomon::gpu
