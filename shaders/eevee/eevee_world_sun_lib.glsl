// SPDX-License-Identifier: MIT
// Highlights of the suns of the world in a picture with several samples. Included by eevee_light_lib.glsl, after the functions that both
// call.
//
// A highlight that is narrower than the sun needs more directions than the one that has a shadow. The others, WorldBlock::sun_points,
// are shaded without a shadow, and the sum is multiplied by the visibility of the one.

/** Fraction of the highlight of the light \a index that the points of its sun draw. 0 for other lights. */
float sun_points_share(LightData light, int index, float alpha)
{
  bool has_points = uint(index - world.first_sun) < uint(world.sun_count);
  return has_points ? 1.0 - smoothstep(0.7, 1.0, alpha * inversesqrt(max(light.radius_sq, 1e-30))) : 0.0;
}

/** Specular radiance towards the viewer from the points of the sun that is the light \a index, times \a share, without a shadow. */
vec3 sun_highlight(LightData light, int index, MaterialData material, Surface surface, float share, const bool is_base)
{
  vec3 sum = vec3(0.0);
  int first = clamp(index - world.first_sun, 0, WORLD_SUN_MAX - 1) * WORLD_SUN_POINTS;
  // LightData::radius_sq is that of a lobe with WORLD_SUN_LOBE_DIRECTIONS directions.
  const float lobe_share = WORLD_SUN_LOBE_POINTS / (WORLD_SUN_LOBE_DIRECTIONS * float(WORLD_SUN_POINTS));
  float alpha_min = sqrt(light.radius_sq * lobe_share);
  int count = share > 0.0 ? WORLD_SUN_POINTS : 1;
  int i = 0;
  // The test is at the end as in lights_radiance.
  do {
    WorldSunPoint point = world.sun_points[first + i];
    float cos_l = dot(surface.normal_ws, point.to_world);
    vec3 half_vector = direction_or_zero(point.to_world + surface.view_ws);
    vec3 fresnel = fresnel_schlick(material.specular_f0, material.specular_f90, dot(surface.view_ws, half_vector));
    float lobe = specular_lobe(material.alpha, alpha_min, surface, point.to_world, max(cos_l, 1e-4), half_vector, is_base);
    sum += point.irradiance * fresnel * (lobe * max(cos_l, 0.0));
  } while (++i < count);
  return share > 0.0 ? share * sum : vec3(0.0);
}
