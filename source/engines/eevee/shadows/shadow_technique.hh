// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_casters.hh"
#include "shadow_crop.hh"
#include "shadow_layer_array.hh"
#include "shadow_plan.hh"
#include "shadow_sun_fit.hh"

#include "eevee_frame_tree.hh"
#include "eevee_shadow_layers.hh"

#include "eevee_depth_shared.h"
#include "eevee_shadow_shared.h"

#include <bit>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace gnomon::eevee {

class OctahedralStore;

/** Properties of a lamp that its texels depend on. Texels also depend on casters, sizes and the view. */
struct ShadowTexelKey {
  glm::mat4 world_from_lamp{1.0F};
  float spot_outer_angle = 0.0F;
  float range = 0.0F;
  std::optional<float> clip_start{};

  bool operator==(const ShadowTexelKey &) const = default;
};

/** A layer of which the rows below `next_row` were drawn and are still valid. */
struct PartialLayer {
  int layer = 0;
  int next_row = 0;
};

/** The shadow of a lamp: its planned resources and the state of its layers. */
struct ShadowSlot {
  /** The lamp at its current point, \see Shadows::place_lamps. */
  ShadowLamp lamp{};
  /** Its centre. */
  glm::vec3 center_ws{};
  ShadowPlace place{};
  /** Edge of the layers in use, texels. At most that of `place`. \see CascadeSettings::can_resize */
  int size_px = 0;
  /** LayerOwner::viewport. */
  std::uint64_t viewport = 0;
  /** Distance of the near plane at the current position of the lamp, metres. */
  float near = 0.0F;
  /** Distance of the near plane at the lamp's centre, metres. It differs from `near` for lamps at a LampPoint. */
  float center_near = 0.0F;
  /** The view of each layer. */
  std::vector<draw::View> views{};
  /** Cubes and spots: the view of each layer if it held its whole map. */
  std::vector<draw::View> whole_views{};
  /** Cubes and spots: the part of its map that each view shows, the same for all faces. */
  MapCrop crop = whole_map;
  /** VisibleRange::revision for which `crop` was computed; 0 after a change of the whole maps. */
  std::uint64_t crop_revision = 0;
  /** Layers that the surfaces for which `crop` was computed look up. */
  LayerMask looked_up = ~0U;
  /** Suns: the fit of each view. Empty if no caster can shadow a visible surface. */
  std::vector<SunFit> fits{};
  /** Temporary memory for the next fit. */
  std::vector<SunFit> new_fits{};
  /** Offset of the slot's ShadowRenderBlock in the buffer. */
  std::uint32_t render_offset_bytes = 0;
  /** Maps of suns and spots: half a step of their depths. 0 for depths of 32 bits. */
  float depth_half_step = 0.0F;
  /** Layers that have a place in the array. They follow each other there. */
  LayerMask placed = ~0U;
  /** Layers that were drawn and are still valid. */
  LayerMask drawn = 0;
  /** Layers that need not be drawn: those of `drawn`, and layers without a caster. */
  LayerMask up_to_date = 0;
  /** Empty: no layer was drawn in part. */
  std::optional<PartialLayer> partial{};
  /** Layers that the submission of the last command list adds to `drawn` and `up_to_date`, and its `partial`. */
  LayerMask recorded_drawn = 0;
  LayerMask recorded_up_to_date = 0;
  std::optional<PartialLayer> recorded_partial{};

  [[nodiscard]] LayerMask all_layers() const
  {
    return (1U << views.size()) - 1U;
  }
  /** Number of layers in the array before \a layer, from the first of this slot on. */
  [[nodiscard]] int index_of(int layer) const
  {
    return std::popcount(placed & ((1U << layer) - 1U));
  }
  /** Index in the array. */
  [[nodiscard]] int array_layer(int layer) const
  {
    return place.first_layer + index_of(layer);
  }
  /** Number of layers in the array. */
  [[nodiscard]] int placed_count() const
  {
    return index_of(int(views.size()));
  }
  /** Mark \a layers as out of date. */
  void invalidate(LayerMask layers)
  {
    drawn &= ~layers;
    up_to_date &= ~layers;
    if (partial && (layers >> partial->layer & 1U) != 0) {
      partial.reset();
    }
  }
  /** Discard recordings that were not submitted. */
  void discard_recorded()
  {
    recorded_drawn = recorded_up_to_date = 0;
    recorded_partial = partial;
  }
};

/** Rows of texels of a layer. */
struct LayerRows {
  int first = 0;
  int count = 0;
};

/** The layers that are recorded at once. */
struct LayerPart {
  LayerMask layers = 0;
  /** Only these rows of the one layer. Empty: all rows. */
  std::optional<LayerRows> rows{};
};

/** Arguments of ShadowTechnique::record. */
struct ShadowRecording {
  gpu::Device &device;
  /** The pass that draws the instances of the casters. */
  const draw::Pass &pass;
  gpu::CommandList &list;
  const ShadowCasters &casters;
  LayerArray &array;
  OctahedralStore &octahedral;
  const gpu::Buffer &render_buffer;
  /** The range that `pass` reads by reference as `shadow_render_block`. */
  gpu::BufferRange &render_block;
  LayerPass layer_pass;
  /** Counters of the recorded work. */
  ShadowCounters &counters;
  /** Temporary memory of record_depths, by caster: the layers that it touches, and whether it touches one layer. */
  std::vector<std::uint8_t> &caster_layers;
  std::vector<std::uint8_t> &is_touching;
};

/** The view to which the maps of suns are fitted. */
struct ShadowView {
  const draw::View &view;
  const VisibleRange &visible;
  /** \see fit_sun */
  float pixel_size;
};

/** Arguments of the inspection functions in addition to the slot. */
struct ShadowInspection {
  const shared::ShadowBlock &block;
  const OctahedralStore &octahedral;
  const LayerArray &array;
  const scene::Bounds &caster_bounds_ws;
};

/**
 * A method of storing and drawing the shadow of a lamp. A user selects a kind (scene::ShadowKind); the kind and the
 * lamp select the technique (serves). Several kinds may share a technique: Hard and Pcf read the same maps. Techniques
 * have no state. shadow_techniques() lists all of them, and the rest of the engine uses them only through this
 * interface.
 */
class ShadowTechnique {
 public:
  ShadowTechnique() = default;
  ShadowTechnique(const ShadowTechnique &) = delete;
  ShadowTechnique &operator=(const ShadowTechnique &) = delete;
  virtual ~ShadowTechnique() = default;

  /** Whether this technique draws shadows of \a kind for \a lamp. Exactly one technique returns true. */
  [[nodiscard]] virtual bool serves(const ShadowLamp &lamp, scene::ShadowKind kind) const = 0;
  /** The value for LightData::shadow_kind, SHADOW_… */
  [[nodiscard]] virtual int light_shadow_kind() const = 0;
  /** Features that the shaders need. */
  [[nodiscard]] virtual Feature features(scene::ShadowKind kind) const = 0;
  [[nodiscard]] virtual ShadowRequest request(const ShadowLamp &lamp, scene::ShadowKind kind,
                                              const ShadowSettings &settings) const = 0;
  [[nodiscard]] virtual ShadowTexelKey texel_key(const ShadowLamp &lamp) const = 0;

  // Views.

  /** Whether the layers are fitted to the view, so that each viewport has its own layers. */
  [[nodiscard]] virtual bool follows_view() const
  {
    return false;
  }
  /**
   * For techniques without follows_view: set the views of \a slot from its lamp and its `near`. \post all layers are
   * out of date
   */
  void set_lamp_views(ShadowSlot &slot) const;
  /** For techniques without follows_view: set ShadowSlot::whole_views from its lamp and its `near`. */
  virtual void set_whole_views(ShadowSlot & /*slot*/) const {}
  /** Fraction of the width of a whole map that lookups reach; 0 if the views are always whole. \see map_crop */
  [[nodiscard]] virtual double inner_share(const ShadowSlot & /*slot*/) const
  {
    return 0.0;
  }
  /** For techniques with follows_view: fit the views of \a slot to \a view; invalidate layers whose view changes. */
  virtual void fit_views(ShadowSlot & /*slot*/, const ShadowView & /*view*/, const ShadowCasters & /*casters*/,
                         const ShadowSettings & /*settings*/) const
  {
  }
  /** The layers that become out of date if a caster that touches the layers \a touched changes. */
  [[nodiscard]] virtual LayerMask changed_layers(LayerMask touched) const
  {
    return touched;
  }

  // Layers needed.

  /** The layers that visible surfaces may look up. Conservative. */
  [[nodiscard]] virtual LayerMask layers_needed(const ShadowSlot &slot, const VisibleRange &visible) const = 0;

  // Block data.

  /** Write the entries of \a slot in \a block. */
  virtual void write_block(const ShadowSlot &slot, shared::ShadowBlock &block) const = 0;

  // Recording.

  /** Whether the rows of a layer can be recorded one after the other. */
  [[nodiscard]] virtual bool has_divisible_layers() const
  {
    return true;
  }
  /** Record the drawing of \a part. Updates recorded_drawn, recorded_up_to_date and recorded_partial of \a slot. */
  virtual void record(ShadowSlot &slot, const LayerPart &part, const ShadowRecording &recording) const = 0;

  // Inspection.

  /** Edge of a texel at a position, perpendicular to the light, metres; 0 if no layer contains the position. */
  [[nodiscard]] virtual double texel_size(const ShadowSlot &slot, const ShadowInspection &inspection,
                                          const glm::dvec3 &position_ws) const = 0;
  [[nodiscard]] virtual ShadowLayers layers(const ShadowSlot &slot, const ShadowInspection &inspection) const = 0;
};

/** All techniques. */
[[nodiscard]] std::span<const ShadowTechnique *const> shadow_techniques();
/** The technique for \a kind and \a lamp. \pre \a kind is not None */
[[nodiscard]] const ShadowTechnique &technique_of(const ShadowLamp &lamp, scene::ShadowKind kind);

/** The value of ShadowCubeData::far and ShadowMapData::far for shadows without clip_end. */
inline constexpr float shadow_far_none = std::numeric_limits<float>::max();

/** The layers of \a slot that a caster touches. \a volume: the bounding sphere of \a bounds_ws. */
[[nodiscard]] LayerMask touched_layers(const ShadowSlot &slot, const scene::Bounds &bounds_ws,
                                       const draw::CullingVolume &volume);

/**
 * Restrict the views of \a slot to the lookups of the surfaces in the picture, and invalidate the layers if the views
 * change. Whole views without VisibleRange::boxes.
 */
void crop_views(ShadowSlot &slot, const VisibleRange &visible);

/** The layers of \a slot that the surfaces in the picture may look up. Conservative. */
[[nodiscard]] LayerMask needed_layers(const ShadowSlot &slot, const VisibleRange &visible);

/** Invalidate the layers of \a slot that changed casters touch, and update the near plane. */
void update_for_casters(ShadowSlot &slot, ShadowCasters &casters);

/**
 * Record the passes that draw casters into \a part of the slot's layers.
 *
 * \a is_empty_drawn: whether layers without a caster are cleared. Otherwise they are not drawn.
 * \return the layers that are drawn.
 */
LayerMask record_depths(ShadowSlot &slot, const LayerPart &part, bool is_empty_drawn, const ShadowRecording &recording);

/** The members of ShadowLayers that are the same for all techniques with layers of depths. */
[[nodiscard]] ShadowLayers depth_layers(const ShadowSlot &slot, const ShadowInspection &inspection);
/** Distance from the lamp to the farthest corner of \a bounds_ws along each axis, metres. */
[[nodiscard]] glm::vec3 reach_from(const glm::vec3 &position_ws, const scene::Bounds &bounds_ws);

}  // namespace gnomon::eevee
