// SPDX-License-Identifier: MIT
#pragma once

#include "scene_shadows.hh"

#include "eevee_frame_tree.hh"
#include "eevee_lamp_points.hh"
#include "eevee_picture_depths.hh"
#include "eevee_shadow_layers.hh"

#include "draw_pass.hh"
#include "eevee_shadow_shared.h"

#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace gnomon::eevee {

struct ShadowInspection;
struct ShadowSlot;
struct VisibleRange;

/** The state of the layers of a light, for reports. */
struct ShadowState {
  /** Index in Lamps::lights. */
  int light = 0;
  /**
   * Name of the array in which the layers are drawn: "shadow_cubes" or "shadow_maps"; "shadow_distance_cube", which all
   * lamps with exponential shadows use in turn, and from which OctahedralStore makes their octahedral layers.
   */
  std::string_view array;
  /** Edge of each layer, texels. */
  int size_px = 0;
  /** 0 if the layers were never needed, or for a sun if no caster can shadow a visible surface. */
  int layer_count = 0;
  /** Layers that were drawn and are still valid. */
  LayerMask drawn = 0;
  /** The layers of `drawn`, and needed layers without a caster. After an update, no other layer is needed. */
  LayerMask up_to_date = 0;
  /** Layers that were drawn for this viewport since begin_picture. */
  LayerMask drawn_now = 0;
};

/** Result of Shadows::update. */
struct UpdatedLayers {
  /** Parts of layers that were recorded, or have no caster. */
  int part_count = 0;
  /** Parts of layers that are needed and out of date after the submission. 0: none. */
  int left_count = 0;
};

/** Texels of a part of a layer: whole rows, at least one. */
inline constexpr int layer_part_texels = 1 << 20;

/**
 * The part of SceneShadows that belongs to one viewport: the visible range, the layers that are fitted to the view, and
 * the block for lookups.
 *
 * Order of calls, after those of SceneShadows: allocate and bind; then for each view: update, submission of the command
 * list, submitted.
 */
class Shadows {
 public:
  /** \a scene must outlive the object. */
  explicit Shadows(SceneShadows &scene);
  Shadows(const Shadows &) = delete;
  Shadows &operator=(const Shadows &) = delete;
  ~Shadows();

  /** Create the resources for the last SceneShadows::sync, and free those that are no longer needed. */
  void allocate(gpu::Device &device);
  /** Call at the start of a picture. Resets ShadowState::drawn_now. */
  void begin_picture()
  {
    drawn_now_.clear();
  }
  /**
   * Fit the layers to \a view, and record the layers that are needed and out of date into \a list.
   *
   * \a pixel_size: see fit_sun. \a pass: draws the instances of the casters. \a points: points of lamps with an extent;
   * the shadow of these lamps is cast from the point. After a sync, all updates must have points of the same lamps.
   * \a depths: of \a view or of a recent view; may be empty. They are used if reads_depths(). The caller must call
   * fit_again when they change. \a parts_max: most parts of layers to record, of layer_part_texels each. The layers of
   * an exponential shadow are recorded together, and each counts as one part.
   */
  UpdatedLayers update(gpu::Device &device, const draw::View &view, float pixel_size, const draw::Pass &pass,
                       gpu::CommandList &list, std::span<const LampPoint> points = {}, const PictureDepths &depths = {},
                       int parts_max = no_parts_max);
  static constexpr int no_parts_max = std::numeric_limits<int>::max();
  /** Draw the layers that blended casters touch again: they hold one sample of them. */
  void invalidate_blended();
  /** Whether maps of suns are fitted to depths, or maps of other lamps are cropped to them. */
  [[nodiscard]] bool reads_depths() const;
  /** Make the next update fit the suns again even if the view does not change, because new depths are available. */
  void fit_again()
  {
    seen_.reset();
    has_clusters_ = false;
  }
  /**
   * Call after the submission of the last update's list: marks its layers as up to date. Without this call, the
   * next update of any viewport records the same layers again. If the submission is lost later, call
   * SceneShadows::invalidate.
   */
  void submitted();

  /** Bind the resources for shadow lookups to a group whose shader has SceneShadows::features. */
  void bind(draw::ShadingGroup &group) const;
  /** The buffer of `shadow_block`. Empty without cubes and maps. */
  [[nodiscard]] const gpu::Buffer &block() const
  {
    return block_buffer_;
  }
  /** The content of `shadow_block` after the last update. */
  [[nodiscard]] const shared::ShadowBlock &block_data() const
  {
    return block_;
  }
  /**
   * The edge of a texel of \a light's shadow at each of \a positions_ws, perpendicular to the light, metres; 0 if there
   * is none. Nothing if the light has no shadow.
   */
  [[nodiscard]] std::optional<std::vector<double>> texel_sizes(const shared::LightData &light,
                                                               std::span<const glm::dvec3> positions_ws) const;
  /** The layers of \a light after the last update. Nothing if the light has no shadow. */
  [[nodiscard]] std::optional<ShadowLayers> layers(const shared::LightData &light) const;
  /** The state of each light with a shadow, in the order of the lights. */
  [[nodiscard]] std::vector<ShadowState> states() const;
  /** Counters of the work that this viewport submitted. */
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

  /** Calls \a action with the shared slots and the slots of this viewport. */
  template <typename Action>
  void for_each_slot(Action &&action);
  template <typename Action>
  void for_each_slot(Action &&action) const;
  /** The slot of \a light; nullptr if the light has no shadow. */
  [[nodiscard]] const ShadowSlot *slot_of(const shared::LightData &light) const;
  [[nodiscard]] ShadowInspection inspection(const ShadowSlot &slot) const;
  void fit(gpu::Device &device, const draw::View &view, float pixel_size, const PictureDepths &depths);
  void place_lamps(std::span<const LampPoint> points);
  void write_block(gpu::Device &device);

  SceneShadows &scene_;
  /** LayerOwner::viewport. */
  std::uint64_t id_ = 0;
  /** Slots of the lamps whose layers follow the view, in the order of the lamps. */
  std::vector<ShadowSlot> slots_;
  /** Inputs of visible_. */
  struct Seen {
    glm::mat4 clip_from_world{1.0F};
    draw::ObjectSet hidden{};
    std::vector<glm::vec4> clip_planes{};
    float pixel_size = 0.0F;
    bool has_depths = false;

    bool operator==(const Seen &) const = default;
  };
  std::optional<Seen> seen_;
  std::unique_ptr<VisibleRange> visible_;
  /** VisibleRange::clusters of visible_ are those of the last depths. */
  bool has_clusters_ = false;
  shared::ShadowBlock block_{};
  gpu::Buffer block_buffer_;
  /** block_buffer_ contains block_. */
  bool is_block_written_ = false;
  /** ShadowLamp::key and layers drawn since begin_picture. A lamp may have several entries. */
  std::vector<std::pair<std::uint64_t, LayerMask>> drawn_now_;
  ShadowCounters counters_;
  /** Counters of recorded work that is not submitted yet. */
  ShadowCounters recorded_counters_;
  /** \see ShadowRecording::caster_layers */
  std::vector<std::uint8_t> caster_layers_;
  std::vector<std::uint8_t> is_touching_;
};

}  // namespace gnomon::eevee
