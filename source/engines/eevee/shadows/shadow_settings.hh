// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_octahedral_store.hh"
#include "shadow_sun_fit.hh"

#include "scene.hh"

namespace gnomon::eevee {

/** The method for drawing the layers of a lamp. All methods give the same texels. */
enum class LayerPass {
  /** The best method that the device supports. */
  Best,
  /** One pass for each layer. */
  Single,
  /** One pass; the geometry shader chooses the layer of each triangle. */
  Geometry,
  /** One pass; the vertex shader chooses the layer. */
  Layered,
};

/** The faces of one-sided casters that are drawn. Both faces of two-sided materials are always drawn. */
enum class CasterFaces { All, Front, Back };

/** Settings of shadows; names, units and limits are in eevee_settings.hh. Those of a lamp (scene::LampShadow) override
 * them, except that `None` disables all shadows. */
struct ShadowSettings {
  /** Hard: bilinear blend of the four texels around a lookup. Pcf: percentage-closer filtering with `pcf`. */
  scene::ShadowKind kind = scene::ShadowKind::Hard;
  /** Edge of a cube face, texels. */
  int cube_size_px = 1024;
  /** Edge of a planar map, texels. */
  int map_size_px = 2048;
  PcfKernel pcf{};
  /** Settings of Esm and Evsm for all lamps except suns. EsmSettings::method is not used: `kind` selects the method. */
  EsmSettings esm{};
  CascadeSettings cascades{};
  /**
   * Fit the maps of suns to the surfaces in the picture instead of slices of the view: the splits, positions,
   * directions and extents with the least error, \see sun_slices. Crop the cube faces and maps of other lamps to these
   * surfaces, \see map_crop. The depths of the picture are read back after the depth pre-pass whenever the view
   * changes. draw::Viewport::draw waits for them. Recorded packets use the depths of an earlier packet, so that shadows
   * follow the camera some frames later. For pictures of one camera: the edges of the shadows move when the camera
   * moves.
   */
  bool is_fitted_to_depth = false;
  /**
   * Whether maps of suns and spots may have 16-bit depths, which take half of the memory. They have them while the
   * error of these depths is at most a tenth of a texel for all maps, \see short_depth_error_max. Receivers are offset
   * by it.
   */
  bool can_have_short_maps = false;
  LayerPass layer_pass = LayerPass::Best;
  CasterFaces caster_faces = CasterFaces::All;
  /** Maximum device memory of all shadow layers, bytes. \see plan_shadows */
  std::size_t memory_bytes_max = std::size_t(1) << 30U;

  /** Also those of `esm` and `cascades`. \see eevee_settings.hh */
  template <typename Visit>
  static constexpr void for_each_property(Visit &&visit);
};

}  // namespace gnomon::eevee
