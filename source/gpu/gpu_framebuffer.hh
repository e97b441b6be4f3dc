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

/** Target of a render pass. */
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
  /** Size of the viewport, from the lower left corner. Clears apply to the whole framebuffer. 0: the whole framebuffer.
   */
  glm::ivec2 viewport_px{0};
};

}  // namespace gnomon::gpu
