// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_texture.hh"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <vector>

namespace gnomon::gpu {

/** Every layer of the texture; the shader says which by `gl_Layer`. */
inline constexpr int all_layers = -1;

struct Attachment {
  /** nullptr: none. Must outlive the framebuffer. */
  const Texture *texture = nullptr;
  /** One slice, or all_layers. */
  int layer = 0;
  int mip_level = 0;
  /** More than 1: this many from `layer` on, and `gl_Layer` 0 is `layer`; passes clear these and no others. */
  int layer_count = 1;
};

struct FramebufferDesc {
  std::string name;
  /** At most Limits::color_attachment_max; all attachments have one size. */
  std::vector<Attachment> colors;
  Attachment depth;
};

/** What a render pass draws into. */
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
  /** What was there is needed. */
  Load,
  Clear,
  /** Every pixel will be written, or none is read: what was there may be lost. */
  DontCare,
};

enum class StoreAction : std::uint8_t { Store, DontCare };

/** What becomes of the attachments at the beginning and at the end of a render pass; all colours alike. */
struct PassActions {
  LoadAction color_load = LoadAction::Clear;
  StoreAction color_store = StoreAction::Store;
  glm::vec4 clear_color{0.0F};
  LoadAction depth_load = LoadAction::Clear;
  StoreAction depth_store = StoreAction::Store;
  /** Reversed depth: 0 is far. */
  float clear_depth = 0.0F;
  /** Draw into the lower left corner of this size; clears and invalidations are of the whole. 0: all of it. */
  glm::ivec2 viewport_px{0};
};

}  // namespace gnomon::gpu
