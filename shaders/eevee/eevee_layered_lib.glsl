// SPDX-License-Identifier: MIT
// The surface of a material with layers as the lights see it, and how its layers are put together.
#include "eevee/eevee_surface_lib.glsl"
#ifdef USE_WORLD
#  include "eevee/eevee_world_lib.glsl"
#endif
#include "shared/eevee_area_shared.h"
#include "shared/eevee_bsdf_shared.h"
#include "shared/eevee_material_shared.h"

/** The GGX lobe of the base of a material, which may have two alphas. */
struct BaseLobe {
  /** Along x and y of lobe_from_world. */
  vec2 alphas;
  mat3 lobe_from_world;
  /** Normal at which the view is mirrored for a light that is not sampled. */
  vec3 bent_normal_ws;
};

/** The layers over the base of a material: sheen, and a coat over both. */
struct Layers {
  BaseLobe base_lobe;
  /** Part of the light that the coat reflects; the rest passes it. */
  float coat_share;
  MaterialData coat_material;
  /** With the normal of the coat, which ignores the normal texture. */
  Surface coat_surface;
  vec3 sheen_color;
  float sheen_alpha;
  /** Directional albedo of the sheen. */
  vec3 sheen_albedo;
  /** Part of the light that the sheen leaves to the base. */
  float base_share;
#ifdef USE_WORLD
  WorldShading coat_world;
#endif
};

/** \see set_layers */
Layers layers;

/** Sets the layers that direct_light lights. */
void set_layers(Layers value)
{
  layers = value;
}

/** Radiance of all layers. \a base, \a sheen, \a coat: that of each of them as if it lay on top. */
vec3 layered(vec3 base, vec3 sheen, vec3 coat)
{
  return mix(layers.base_share * base + sheen, coat, layers.coat_share);
}

/** BRDF of the sheen, 1/sr. \a cos_l: mean cosine of the incident light, in [0, 1]. */
vec3 sheen_brdf(Surface surface, vec3 to_light, float cos_l)
{
  // Where a part of a lamp is below the horizon, the mean direction of the rest is above its centre's.
  vec3 mean_direction = to_light + (cos_l - dot(surface.normal_ws, to_light)) * surface.normal_ws;
  vec3 half_vector = direction_or_zero(direction_or_zero(mean_direction) + surface.view_ws);
  float cos_v = max(dot(surface.normal_ws, surface.view_ws), 1e-4);
  float cos_h = clamp(dot(surface.normal_ws, half_vector), 0.0, 1.0);
  return layers.sheen_color * sheen_lobe(cos_l, cos_v, cos_h, layers.sheen_alpha);
}
