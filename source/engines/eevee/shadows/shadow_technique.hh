// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_casters.hh"
#include "shadow_plan.hh"
#include "shadow_storage.hh"
#include "shadow_sun_fit.hh"

#include "eevee_depth_shared.h"
#include "eevee_shadow_shared.h"

#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace gnomon::eevee {

/** Bit i: layer i of a lamp's shadow. */
using LayerMask = std::uint32_t;

/** Counts since the shadows were created; of submitted work. */
struct ShadowCounters {
  /** Lamps of which any layer was drawn. */
  std::uint64_t lamps_updated = 0;
  /** Layers drawn: faces of cubes, maps, cascades. */
  std::uint64_t faces_drawn = 0;
  /** Layers of updated lamps that were not drawn: they hold no caster, or nothing visible looks them up. */
  std::uint64_t faces_skipped = 0;
  /** Instances of casters drawn; a caster counts once for each layer that it touches. */
  std::uint64_t caster_draws = 0;
};

/** The layers of one light, for inspection. */
struct ShadowLayers {
  /** Number of layers; 0 where nothing is seen that the light's casters could darken. */
  int count = 0;
  /** The array that holds them, from `first_layer` on. nullptr while count is 0. */
  const gpu::Texture *texture = nullptr;
  int first_layer = 0;
  /** Edge of each, texels, in the lower left corner of its layer after `border` texels. */
  int size_px = 0;
  int border = 0;
  /** Six faces, in OpenGL's order. */
  bool is_cube = false;
  /** Layers that were drawn. */
  LayerMask drawn = 0;
  /** PROJECTION_… that the depths were made by. */
  int projection = PROJECTION_PERSPECTIVE_INFINITE;
  /** ESM_…: the layer holds distances instead; -1: depths. */
  int esm_format = -1;
  /**
   * Distances that depths 1 and 0 stand for, metres: one for each cascade, from the first caster; one for all layers of
   * other lamps, from the lamp.
   */
  std::vector<glm::vec2> near_far;
  /** Distances that hold all casters, metres, as far as the lamp reaches. */
  glm::vec2 shown{0.0F};
};

/** Everything about a lamp that its texels depend on, beside the casters, the sizes and the view. */
struct ShadowTexelKey {
  glm::mat4 world_from_lamp{1.0F};
  float spot_outer_angle = 0.0F;
  float range = 0.0F;
  std::optional<float> clip_start{};

  bool operator==(const ShadowTexelKey &) const = default;
};

/** A lamp's shadow: its place and the state of its layers. */
struct ShadowSlot {
  ShadowLamp lamp{};
  ShadowPlace place{};
  /** LayerOwner::viewport. */
  std::uint64_t viewport = 0;
  /** Distance of the near plane, metres; that for the lamp's centre, where the lamp is at one of its points. */
  float near = 0.0F;
  float center_near = 0.0F;
  /** One for each layer. */
  std::vector<draw::View> views{};
  /** Suns: what the views are fitted to; empty while no caster matters. */
  std::vector<SunFit> fits{};
  /** Memory for the next fit. */
  std::vector<SunFit> new_fits{};
  /** Offset of its ShadowRenderBlock in the buffer. */
  std::uint32_t render_offset_bytes = 0;
  /** Drawn and still correct. */
  LayerMask drawn = 0;
  /** The same, and the layers that have nothing in them to draw. */
  LayerMask up_to_date = 0;
  /** What a command list that was not submitted yet makes of `drawn` and `up_to_date`. */
  LayerMask recorded_drawn = 0;
  LayerMask recorded_up_to_date = 0;

  [[nodiscard]] LayerMask all_layers() const
  {
    return (1U << views.size()) - 1U;
  }
  /** \a layers must be drawn again. */
  void invalidate(LayerMask layers)
  {
    drawn &= ~layers;
    up_to_date &= ~layers;
  }
};

/** What a technique records with. */
struct ShadowRecording {
  gpu::Device &device;
  /** Draws the casters' instances. */
  const draw::Pass &pass;
  gpu::CommandList &list;
  const ShadowCasters &casters;
  LayerArray &array;
  OctahedralStore &octahedral;
  const gpu::Buffer &render_buffer;
  /** What `pass` reads as `shadow_render_block`. */
  gpu::BufferRange &render_block;
  LayerPass layer_pass;
  /** Of the recorded work. */
  ShadowCounters &counters;
  /** Memory for record_depths. */
  std::vector<std::uint8_t> &caster_layers;
};

/** What sun maps are fitted to. */
struct ShadowView {
  const draw::View &view;
  const VisibleRange &visible;
  /** \see fit_sun */
  float pixel_size;
};

/** What inspection reads beside the slot. */
struct ShadowInspection {
  const shared::ShadowBlock &block;
  const OctahedralStore &octahedral;
  const LayerArray &array;
  const scene::Bounds &caster_bounds_ws;
};

/**
 * One method of storing a lamp's shadow. Objects have no state; shadow_techniques() lists them all, and nothing else
 * names them.
 */
class ShadowTechnique {
 public:
  ShadowTechnique() = default;
  ShadowTechnique(const ShadowTechnique &) = delete;
  ShadowTechnique &operator=(const ShadowTechnique &) = delete;
  virtual ~ShadowTechnique() = default;

  /** Whether it is the technique of \a lamp's shadow of \a kind. Exactly one technique is. */
  [[nodiscard]] virtual bool serves(const ShadowLamp &lamp, scene::ShadowKind kind) const = 0;
  /** SHADOW_… of LightData::shadow_kind. */
  [[nodiscard]] virtual int light_shadow_kind() const = 0;
  /** What the shaders need. */
  [[nodiscard]] virtual Feature features(scene::ShadowKind kind) const = 0;
  [[nodiscard]] virtual ShadowRequest request(const ShadowLamp &lamp, scene::ShadowKind kind,
                                              const ShadowSettings &settings) const = 0;
  [[nodiscard]] virtual ShadowTexelKey texel_key(const ShadowLamp &lamp) const = 0;

  // Views.

  /** Whether the layers follow what a viewport sees, so that each viewport has layers of its own. */
  [[nodiscard]] virtual bool follows_view() const
  {
    return false;
  }
  /** Set the views of a slot whose `near` is set, where they depend on the lamp alone; \see follows_view. */
  virtual void set_lamp_views(ShadowSlot & /*slot*/) const {}
  /** Where follows_view: fit the views to what is seen; layers whose view changes are invalidated. */
  virtual void fit_views(ShadowSlot & /*slot*/, const ShadowView & /*view*/, const ShadowCasters & /*casters*/,
                         const ShadowSettings & /*settings*/) const
  {
  }
  /** Layers that a caster changes if it changes \a touched. */
  [[nodiscard]] virtual LayerMask changed_layers(LayerMask touched) const
  {
    return touched;
  }

  // Layers needed.

  /** Layers that something visible may look up. */
  [[nodiscard]] virtual LayerMask layers_needed(const ShadowSlot &slot, const VisibleRange &visible) const = 0;

  // Block data.

  /** Write the slot's entries. */
  virtual void write_block(const ShadowSlot &slot, shared::ShadowBlock &block) const = 0;

  // Recording.

  /** Record \a missing layers. Sets recorded_drawn and recorded_up_to_date of \a slot. */
  virtual void record(ShadowSlot &slot, LayerMask missing, const ShadowRecording &recording) const = 0;

  // Inspection.

  /** Edge of a texel at a place, across the light, metres; 0: the shadow does not reach it. */
  [[nodiscard]] virtual double texel_size(const ShadowSlot &slot, const ShadowInspection &inspection,
                                          const glm::dvec3 &position_ws) const = 0;
  [[nodiscard]] virtual ShadowLayers layers(const ShadowSlot &slot, const ShadowInspection &inspection) const = 0;
};

/** All techniques. */
[[nodiscard]] std::span<const ShadowTechnique *const> shadow_techniques();
/** \pre \a kind is not None */
[[nodiscard]] const ShadowTechnique &technique_of(const ShadowLamp &lamp, scene::ShadowKind kind);

/** ShadowCubeData::far and ShadowMapData::far of a shadow without an end. */
inline constexpr float shadow_far_none = std::numeric_limits<float>::max();

/** Layers of \a slot that a caster touches. \a volume: the sphere around \a bounds_ws. */
[[nodiscard]] LayerMask touched_layers(const ShadowSlot &slot, const scene::Bounds &bounds_ws,
                                       const draw::CullingVolume &volume);

/** Take note of \a casters: invalidate the layers that their changes touch, and move the near plane where it has to. */
void update_for_casters(ShadowSlot &slot, ShadowCasters &casters);

/**
 * Draw the casters into \a missing layers of the slot's array, by one pass or several.
 *
 * \a is_empty_drawn: layers without a caster are cleared, too; else they are left as they are.
 * \return the layers that were drawn.
 */
LayerMask record_depths(ShadowSlot &slot, LayerMask missing, bool is_empty_drawn, const ShadowRecording &recording);

/** ShadowLayers of layers of depths around or from a lamp, as far as they do not depend on the technique. */
[[nodiscard]] ShadowLayers depth_layers(const ShadowSlot &slot, const ShadowInspection &inspection);
/** Distance from the lamp to the farthest corner of \a bounds_ws along each axis, metres. */
[[nodiscard]] glm::vec3 reach_from(const glm::vec3 &position_ws, const scene::Bounds &bounds_ws);

}  // namespace gnomon::eevee
