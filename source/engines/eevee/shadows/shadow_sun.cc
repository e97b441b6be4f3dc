// SPDX-License-Identifier: MIT
#include "shadow_sun.hh"

#include "shadow_spot.hh"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gnomon::eevee {

namespace {

/** \see CascadeSettings::count */
int cascade_count(const ShadowLamp &lamp, const ShadowSettings &settings)
{
  return lamp.is_smooth ? 1 : settings.cascades.count;
}

/** Whether the maps of \a lamp are fitted to depths. The maps of a sampled lamp serve one sample only. */
bool is_fitted(const ShadowLamp &lamp, const ShadowSettings &settings)
{
  return settings.is_fitted_to_depth && !lamp.is_sampled;
}

/** \see CascadeSettings::can_resize */
bool is_resized(const ShadowLamp &lamp, const ShadowSettings &settings)
{
  return settings.cascades.can_resize && is_fitted(lamp, settings) && cascade_count(lamp, settings) != 1 &&
         !lamp.shadow.size;
}

class SunTechnique final : public MapTechnique {
 public:
  bool serves(const ShadowLamp &lamp, scene::ShadowKind /*kind*/) const override
  {
    return lamp.kind == scene::LampKind::Sun;
  }

  ShadowRequest request(const ShadowLamp &lamp, scene::ShadowKind /*kind*/,
                        const ShadowSettings &settings) const override
  {
    const int cascades = cascade_count(lamp, settings) > 0 ? cascade_count(lamp, settings) : cascade_count_max;
    const double growth = is_resized(lamp, settings) ? size_growth_max : 1.0;
    return {.array = ShadowArrayId::Maps,
            .layer_count_max = cascades,
            .entry_count = cascades,
            .size_px = int(std::lround(growth * lamp.shadow.size.value_or(settings.map_size_px))),
            .can_have_larger_layers = is_resized(lamp, settings) && settings.cascades.count == 0};
  }

  ShadowTexelKey texel_key(const ShadowLamp &lamp) const override
  {
    ShadowTexelKey key{.world_from_lamp = lamp.world_from_lamp, .range = lamp.shadow_range()};
    // The position of a sun has no effect.
    key.world_from_lamp[3] = glm::vec4(0, 0, 0, 1);
    return key;
  }

  bool follows_view() const override
  {
    return true;
  }

  void fit_views(ShadowSlot &slot, const ShadowView &view, const ShadowCasters &casters,
                 const ShadowSettings &settings) const override
  {
    CascadeSettings cascades = settings.cascades;
    cascades.count = cascade_count(slot.lamp, settings);
    cascades.can_resize = is_resized(slot.lamp, settings);
    slot.new_fits =
        fit_sun(slot.lamp.world_from_lamp, view.view, view.visible, casters.list(), slot.place.given.size_px, cascades,
                view.pixel_size, std::move(slot.new_fits), slot.lamp.extent,
                is_fitted(slot.lamp, settings) ? std::span(view.visible.clusters) : std::span<const VisibleCluster>(),
                slot.place.edge_max_px);
    const std::vector<SunFit> &fits = slot.new_fits;
    if (fits.size() != slot.fits.size()) {
      slot.invalidate(~0U);
    }
    if (!fits.empty()) {
      slot.size_px = fits.front().size_px;
    }
    slot.fits.resize(fits.size());
    slot.views.resize(fits.size());
    for (std::size_t i = 0; i < fits.size(); i++) {
      if ((slot.up_to_date >> i & 1U) == 0 || !still_fits(slot.fits[i], fits[i])) {
        slot.fits[i] = fits[i];
        slot.views[i] = fits[i].view;
        slot.invalidate(1U << i);
      }
    }
  }

  LayerMask layers_needed(const ShadowSlot &slot, const VisibleRange & /*visible*/) const override
  {
    // The maps are fitted to the visible range, so that all of them are needed.
    return slot.all_layers();
  }

  void record(ShadowSlot &slot, const LayerPart &part, const ShadowRecording &recording) const override
  {
    // Lookups read cascades without a caster, too, so that they must be cleared.
    record_depths(slot, part, true, recording);
  }

  ShadowLayers layers(const ShadowSlot &slot, const ShadowInspection &inspection) const override
  {
    ShadowLayers layers = depth_layers(slot, inspection);
    layers.projection = PROJECTION_ORTHOGRAPHIC;
    double top = -std::numeric_limits<double>::infinity();
    for (const SunFit &fit : slot.fits) {
      // The highest point of the near plane.
      const glm::dvec2 highest = glm::max(fit.slope * glm::dvec2(fit.min), fit.slope * glm::dvec2(fit.max));
      top = std::max(top, fit.max.z + highest.x + highest.y);
    }
    for (const SunFit &fit : slot.fits) {
      const double corner = top - glm::dot(fit.slope, glm::dvec2(fit.min));
      layers.near_far.emplace_back(corner - fit.max.z, corner - fit.min.z);
      layers.tilts.emplace_back(-fit.slope * glm::dvec2(fit.max - fit.min));
    }
    if (!layers.near_far.empty()) {
      // Depths of the last map, which contains all visible receivers, between its corners.
      const glm::vec2 tilt = layers.tilts.back();
      const glm::vec2 rise = glm::max(tilt, glm::vec2(0.0F));
      const glm::vec2 fall = glm::min(tilt, glm::vec2(0.0F));
      layers.shown = layers.near_far.back() + glm::vec2(fall.x + fall.y, rise.x + rise.y);
    }
    return layers;
  }
};

}  // namespace

const ShadowTechnique &shadow_sun_technique()
{
  static const SunTechnique technique;
  return technique;
}

}  // namespace gnomon::eevee
