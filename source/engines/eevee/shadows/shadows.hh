// SPDX-License-Identifier: MIT
#pragma once

#include "scene_shadows.hh"

#include "eevee_lamp_points.hh"

#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace gnomon::eevee {

/** Which layers of a light are drawn, and which are not, for reports. */
struct ShadowState {
  /** In light_block. */
  int light = 0;
  /** The array of the layers: "shadow_cubes", "shadow_maps" or "shadow_distance_cube". */
  std::string_view array;
  /** Edge of each, texels. */
  int size_px = 0;
  /** 0: a sun, of which nothing is seen that its casters could darken; or nothing was ever seen. */
  int layer_count = 0;
  /** Drawn and still correct. */
  LayerMask drawn = 0;
  /** The same, and the layers that hold no caster. Nothing visible looks up the other layers. */
  LayerMask up_to_date = 0;
  /** Drawn for this viewport since begin_picture. */
  LayerMask drawn_now = 0;
};

/**
 * Shadows of a scene's lamps in one viewport: what it sees, the layers that follow that, and the block that lookups
 * read.
 *
 * Order of calls, after those of SceneShadows: allocate, bind; then, for each view, update and, once the list that it
 * recorded into is submitted, submitted.
 */
class Shadows {
 public:
  /** \a scene must outlive it. */
  explicit Shadows(SceneShadows &scene);
  Shadows(const Shadows &) = delete;
  Shadows &operator=(const Shadows &) = delete;
  ~Shadows();

  /** Create what the last SceneShadows::sync asks for, and free what is not needed any more. */
  void allocate(gpu::Device &device);
  /** Start of a picture, for ShadowState::drawn_now. */
  void begin_picture()
  {
    drawn_now_.clear();
  }
  /**
   * Fit to what \a view sees and record into \a list the layers that are needed and not up to date. \a pass draws the
   * casters' instances; \a pixel_size: see fit_sun. \a points: lamps of which the shadow is that of one point; each
   * lamp the same in all updates after a sync. \a depths: of the view, or of an earlier one near it, see
   * narrow_to_depths; read where reads_depths() and the view changed. May be empty.
   */
  void update(gpu::Device &device, const draw::View &view, float pixel_size, const draw::Pass &pass,
              gpu::CommandList &list, std::span<const LampPoint> points = {}, std::span<const float> depths = {});
  /** Whether suns are fitted to depths. */
  [[nodiscard]] bool reads_depths() const;
  /** Let the next update fit suns again, although the view is the same, because it has other depths. */
  void fit_again()
  {
    seen_.reset();
  }
  /**
   * The list of the last update was submitted: what it draws is up to date from now on. Without this call the next
   * update of any viewport records the same layers again. Where the submission is lost later, call
   * SceneShadows::invalidate.
   */
  void submitted();

  /** Everything that lookups read, for a group whose shader has SceneShadows::features. */
  void bind(draw::ShadingGroup &group) const;
  /** `shadow_block`, empty without cubes and maps. */
  [[nodiscard]] const gpu::Buffer &block() const
  {
    return block_buffer_;
  }
  /** Content of `shadow_block`, as of the last update. */
  [[nodiscard]] const shared::ShadowBlock &block_data() const
  {
    return block_;
  }
  /** Edge of a texel of a light's shadow at a place, across the light, metres; 0: it has none there. */
  [[nodiscard]] double texel_size(const shared::LightData &light, const glm::dvec3 &position_ws) const;
  /** Of a light that casts a shadow, as of the last update. */
  [[nodiscard]] std::optional<ShadowLayers> layers(const shared::LightData &light) const;
  /** Of each light that casts a shadow, in the order of the lights. */
  [[nodiscard]] std::vector<ShadowState> states() const;
  /** Of the work that this viewport submitted. */
  [[nodiscard]] const ShadowCounters &counters() const
  {
    return counters_;
  }
  [[nodiscard]] const SceneShadows &scene() const
  {
    return scene_;
  }

 private:
  friend class SceneShadows;

  /** Calls \a action with each slot that this viewport reads. */
  template <typename Action>
  void for_each_slot(Action &&action);
  template <typename Action>
  void for_each_slot(Action &&action) const;
  /** nullptr: the light has no shadow. */
  [[nodiscard]] const ShadowSlot *slot_of(const shared::LightData &light) const;
  [[nodiscard]] ShadowInspection inspection(const ShadowSlot &slot) const;
  void fit(gpu::Device &device, const draw::View &view, float pixel_size, std::span<const float> depths);
  void place_lamps(std::span<const LampPoint> points);
  void write_block(gpu::Device &device);

  SceneShadows &scene_;
  /** LayerOwner::viewport. */
  std::uint64_t id_ = 0;
  /** Of the lamps whose layers follow the view, in the order of the lamps. */
  std::vector<ShadowSlot> slots_;
  /** What visible_ was computed for. */
  struct Seen {
    glm::mat4 clip_from_world{1.0F};
    float pixel_size = 0.0F;

    bool operator==(const Seen &) const = default;
  };
  std::optional<Seen> seen_;
  VisibleRange visible_;
  shared::ShadowBlock block_{};
  gpu::Buffer block_buffer_;
  /** block_buffer_ holds block_. */
  bool is_block_written_ = false;
  /** Layers drawn since begin_picture, with ShadowLamp::key; a lamp may be there several times. */
  std::vector<std::pair<std::uint64_t, LayerMask>> drawn_now_;
  ShadowCounters counters_;
  /** Of the recorded work. */
  ShadowCounters recorded_counters_;
  /** \see ShadowRecording */
  std::vector<std::uint8_t> caster_layers_;
};

}  // namespace gnomon::eevee
