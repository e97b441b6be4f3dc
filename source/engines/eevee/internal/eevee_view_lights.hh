// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_light_clusters.hh"
#include "internal/eevee_frame.hh"
#include "internal/eevee_lights.hh"

namespace gnomon::eevee {

/** The lights as a sample and a view of a viewport see them: points of lamps, and lists of lights. Internal. */
class ViewLights {
 public:
  explicit ViewLights(SceneLights &lights) : lights_(lights) {}
  /** Create the block of the lists, or free them. */
  void make(gpu::Device &device);
  void bind(draw::ShadingGroup &group) const;
  /** Make the lists again, because work was lost. */
  void forget()
  {
    made_.reset();
  }

  void report(ResourceReport &report) const;
  /** Moves lamps with an extent to their points of the sample. */
  [[nodiscard]] FrameStep points_step();
  /** Makes the lists, unless they are up to date. */
  [[nodiscard]] FrameStep lists_step();

 private:
  void update_lists(const FrameSample &sample, gpu::CommandList &list);

  struct Key {
    draw::View view;
    glm::ivec2 size_px{0};
    /** SceneLights::reaches_revision. */
    std::uint64_t reaches = 0;

    bool operator==(const Key &) const = default;
  };
  SceneLights &lights_;
  /** The points of the lamps in the current sample. */
  SampledLampPoints points_;
  /** Empty, as their block and texture, unless lights are clustered. */
  LightClusters lists_;
  /** The inputs that the lists on the device were made from. Empty if they are undefined. */
  std::optional<Key> made_;
  gpu::Buffer block_;
  gpu::Texture texture_;
  /** The binding of `texture_`. Programs read it by reference, because its size follows the view. */
  draw::TextureBinding binding_;
};

}  // namespace gnomon::eevee
