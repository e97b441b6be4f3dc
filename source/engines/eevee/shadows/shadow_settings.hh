// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_octahedral_store.hh"
#include "shadow_sun_fit.hh"

#include "scene.hh"

namespace gnomon::eevee {

/** How the layers of a lamp are drawn. The texels are the same. */
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

/** The sides of one-sided casters that are drawn. Two-sided materials are always drawn from both sides. */
enum class CasterFaces { All, Front, Back };

/** Per-lamp settings (scene::LampShadow) override these, except that `None` here disables all shadows. */
struct ShadowSettings {
  /** Hard: the bilinear blend of the four texels around a lookup. Pcf: the mean of several such blends. */
  scene::ShadowKind kind = scene::ShadowKind::Hard;
  /** Edge of a cube face and of a map, pixels, at least 1. */
  int cube_size_px = 1024;
  int map_size_px = 2048;
  PcfKernel pcf{};
  /** Of Esm and Evsm, for point lamps and spots. The method in it is not used: `kind` selects it. */
  EsmSettings esm{};
  CascadeSettings cascades{};
  LayerPass layer_pass = LayerPass::Best;
  CasterFaces caster_faces = CasterFaces::All;
  /** \see plan_shadows */
  std::size_t memory_bytes_max = std::size_t(1) << 30U;
};

}  // namespace gnomon::eevee
