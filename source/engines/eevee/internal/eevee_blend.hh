// SPDX-License-Identifier: MIT
#pragma once

#include "internal/eevee_frame.hh"
#include "internal/eevee_renderbuffers.hh"

namespace gnomon::eevee {

/** A drawable object whose material transmits light. */
struct TransmissiveObject {
  draw::ObjectIndex object = draw::object_identity;
  /** True: the object is in BlendPass. False: in Transmission. */
  bool is_blended = false;
};

/** Objects that are blended over the picture behind them, from back to front: decision 0015. Internal to the engine. */
class BlendPass {
 public:
  BlendPass(draw::ObjectBuffer &objects, const RenderBuffers &buffers);
  /** Remove all objects. */
  void clear();
  /** Append the calls of an object that is blended: its backs, if they are drawn, and its fronts. */
  void add(render_scene::RenderScene &scene, draw::ObjectIndex object, const gpu::BatchRange &batch,
           const gpu::Shader &shader, const BindLit &bind);
  /**
   * Let the objects be drawn from back to front, as \a view sees them. \a transmissive: all drawable objects that
   * transmit light. \a is_transmission_seen: one of them is in the view
   */
  void order(const render_scene::RenderScene &scene, const draw::View &view, draw::VisibleObjects &visible,
             std::span<const TransmissiveObject> transmissive, bool is_transmission_seen);

  [[nodiscard]] bool is_empty() const
  {
    return blended_.empty();
  }
  /** Number of objects in the view that was ordered last. */
  [[nodiscard]] std::size_t ordered_count() const
  {
    return ordered_ ? ordered_->visible.size() : 0;
  }

  /** Blended objects that are behind everything that transmits light, so that they are in the copy of the picture. */
  [[nodiscard]] FrameStep behind_step();
  [[nodiscard]] FrameStep step();

 private:
  /** The groups of an object. */
  struct Blended {
    draw::ObjectIndex object = draw::object_identity;
    std::uint32_t first_group = 0;
    std::uint32_t group_count = 0;
    /** It reads Transmission::behind. */
    bool is_transmissive = false;
  };
  /** Key of the order. */
  struct OrderKey {
    /** \see render_scene::eye_of */
    glm::vec4 eye_ws{0.0F};
    std::uint64_t objects = 0;
    /** Indices in blended_. */
    std::vector<std::uint32_t> visible{};
    /** The visible objects of Transmission. */
    std::vector<draw::ObjectIndex> transmissive{};

    bool operator==(const OrderKey &) const = default;
  };

  const RenderBuffers &buffers_;
  /** A group or two for each object. */
  draw::Pass pass_;
  std::vector<Blended> blended_;
  std::uint32_t group_count_ = 0;
  std::optional<OrderKey> ordered_;
  /** Groups behind all that transmits light, from back to front, and the rest of the groups. */
  std::vector<std::uint32_t> groups_behind_;
  std::vector<std::uint32_t> groups_in_front_;
};

}  // namespace gnomon::eevee
