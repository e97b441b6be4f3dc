// SPDX-License-Identifier: MIT
// Penumbrae from one map of a lamp's centre (percentage-closer soft shadows, Fernando 2005), by lookups on the receiver's plane.

/** Number of lookups for casters, and for visibility. */
const int PENUMBRA_SEARCH_TAPS = 12;
const int PENUMBRA_TAPS = 20;

/**
 * Width of the penumbra of the caster at the lookup, in half axes of the lamp; 0 if there is no caster. For a lamp at a finite
 * distance this is the quotient of the distances from the caster to the receiver and to the lamp. For a sun it is the distance from
 * the caster to the receiver, metres.
 */
float shadow_gap(LightData light, const int lights, Surface surface, vec3 to_light)
{
#ifdef USE_SHADOW_CUBE
  if (lights != LIGHTS_WITH_MAPS && light.shadow_kind == SHADOW_CUBE) {
    return shadow_cube_gap(light.shadow_index, surface, light, to_light);
  }
#endif
#ifdef USE_SHADOW_MAP
  if (lights != LIGHTS_WITH_CUBES && light.shadow_kind == SHADOW_MAP) {
    return shadow_map_gap(light.shadow_index, surface, light, to_light);
  }
#endif
  return 0.0;
}

/** \a surface moved by \a offset and then along the light back onto its plane. */
Surface beside(Surface surface, vec3 to_light, vec3 offset)
{
  vec3 n = surface.geometric_normal_ws;
  float facing = dot(n, to_light);
  // Limits the distance at grazing angles.
  facing = facing < 0.0 ? min(facing, -0.05) : max(facing, 0.05);
  surface.position_ws += offset - to_light * (dot(n, offset) / facing);
  return surface;
}

/** Rotation of the lookups at this pixel, as cosine and sine (Jimenez 2014, interleaved gradient noise). */
vec2 pixel_turn()
{
  float angle = 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  return vec2(cos(angle), sin(angle));
}

/**
 * Visibility of a lamp with an extent. \a axis_x, \a axis_y: its half axes, world space; metres, or for a sun at a distance of 1 m.
 * \a search: largest shadow_gap that is searched. Casters whose penumbra does not reach the receiver are ignored.
 */
float penumbra_visibility(LightData light, const int lights, Surface surface, vec3 to_light, vec3 axis_x, vec3 axis_y, float search)
{
  vec2 turn = pixel_turn();
  float gaps = 0.0;
  float count = 0.0;
  int i = 0;
  do {
    vec2 tap = vogel_disk(i, PENUMBRA_SEARCH_TAPS);
    tap = vec2(tap.x * turn.x - tap.y * turn.y, tap.x * turn.y + tap.y * turn.x);
    float gap = shadow_gap(light, lights, beside(surface, to_light, (tap.x * axis_x + tap.y * axis_y) * search), to_light);
    if (gap > 0.0 && gap >= length(tap) * search) {
      gaps += gap;
      count += 1.0;
    }
  } while (++i < PENUMBRA_SEARCH_TAPS);
  // Without a caster, one lookup at the receiver.
  int tap_count = count > 0.0 ? PENUMBRA_TAPS : 1;
  float gap = gaps / max(count, 1.0);
  float sum = 0.0;
  i = 0;
  do {
    vec2 tap = vogel_disk(i, PENUMBRA_TAPS);
    tap = vec2(tap.x * turn.x - tap.y * turn.y, tap.x * turn.y + tap.y * turn.x);
    sum += light_visibility(light, lights, beside(surface, to_light, (tap.x * axis_x + tap.y * axis_y) * gap), to_light);
  } while (++i < tap_count);
  return sum / float(tap_count);
}
