// SPDX-License-Identifier: MIT
// Penumbrae from one map of a lamp's centre (percentage-closer soft shadows, Fernando 2005), by lookups on the receiver's plane.
//
// A caster's gap is the width of its penumbra, as a fraction of the lamp's: the quotient of its distances to the receiver and to the
// lamp. For a sun it is its distance to the receiver, metres. The map shows a caster that covers the point p of the lamp at the offset
// gap · p from the receiver, so that it darkens the receiver if p is on the lamp.

/** Largest number of lookups for casters in the series of radii, and number of lookups for visibility. */
const int PENUMBRA_SEARCH_TAPS = 17;
const int PENUMBRA_TAPS = 16;
/** Casters at up to this multiple of their penumbra's half width are evaluated: those next to the lookup may be nearer. */
const float PENUMBRA_REACH = 3.0;
/** Rotation by the golden angle, as cosine and sine. */
const vec2 GOLDEN_TURN = vec2(cos(GOLDEN_ANGLE), sin(GOLDEN_ANGLE));
/** From a lookup for casters to the next one: a turn by the golden angle, and a radius that is smaller by this factor. */
const float PENUMBRA_SEARCH_RATIO = 1.6;
const vec2 PENUMBRA_SEARCH_STEP = GOLDEN_TURN / PENUMBRA_SEARCH_RATIO;
/** Number of further lookups for casters, on the disk of the smallest gap. */
const int PENUMBRA_DISK_TAPS = 12;

/** A receiver and a lamp with an extent. */
struct PenumbraReceiver {
  LightData light;
  Surface surface;
  vec3 to_light;
#ifdef USE_SHADOW_CUBE
  /** It is set if the light's shadow is a cube. */
  CubeReceiver cube;
#endif
};

/** Gap of the caster at \a offset from the receiver, \see ShadowPlace; 0 if there is none. */
float shadow_gap(PenumbraReceiver receiver, const int lights, vec3 offset)
{
#ifdef USE_SHADOW_CUBE
  if (lights != LIGHTS_WITH_MAPS && receiver.light.shadow_kind == SHADOW_CUBE) {
    return shadow_cube_gap(receiver.cube, receiver.surface, offset);
  }
#endif
#ifdef USE_SHADOW_MAP
  if (lights != LIGHTS_WITH_CUBES && receiver.light.shadow_kind == SHADOW_MAP) {
    return shadow_map_gap(receiver.light.shadow_index, receiver.surface, receiver.light, receiver.to_light, offset);
  }
#endif
  return 0.0;
}

/** Visibility of the light at \a offset from the receiver, \see ShadowPlace. \a least_gap, \a is_receiver: \see shadow_cube_visibility. */
float shadow_at(PenumbraReceiver receiver, const int lights, vec3 offset, float least_gap, const bool is_receiver)
{
#ifdef USE_SHADOW_CUBE
  if (lights != LIGHTS_WITH_MAPS && receiver.light.shadow_kind == SHADOW_CUBE) {
    return shadow_cube_visibility(receiver.cube, receiver.surface, offset, least_gap, is_receiver);
  }
#endif
#ifdef USE_SHADOW_MAP
  if (lights != LIGHTS_WITH_CUBES && receiver.light.shadow_kind == SHADOW_MAP) {
    return shadow_map_visibility(receiver.light.shadow_index, receiver.surface, receiver.to_light, offset, least_gap, is_receiver);
  }
#endif
  return 1.0;
}

/** x: edge of a texel at the receiver, metres. y: 1.5 times the largest gap, or more. */
vec2 shadow_search(PenumbraReceiver receiver, const int lights)
{
#ifdef USE_SHADOW_CUBE
  if (lights != LIGHTS_WITH_MAPS && receiver.light.shadow_kind == SHADOW_CUBE) {
    return shadow_cube_search(receiver.light.shadow_index, receiver.surface, receiver.light);
  }
#endif
#ifdef USE_SHADOW_MAP
  if (lights != LIGHTS_WITH_CUBES && receiver.light.shadow_kind == SHADOW_MAP) {
    return shadow_map_search(receiver.light.shadow_index, receiver.surface, receiver.light, receiver.to_light);
  }
#endif
  return vec2(0.0);
}

vec2 complex_product(vec2 a, vec2 b)
{
  return vec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}

/** Rotation of the lookups at this pixel, as cosine and sine (Jimenez 2014, interleaved gradient noise). */
vec2 pixel_turn()
{
  float angle = 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  return vec2(cos(angle), sin(angle));
}

/**
 * Visibility of a lamp with an extent. \a axis_x, \a axis_y: its half axes, world space; metres, or for a sun at a distance of 1 m.
 * \a sun_drop: 1 - cos of half the angle of a sun; 0 for other lamps.
 */
float penumbra_visibility(LightData light, const int lights, Surface surface, vec3 to_light, vec3 axis_x, vec3 axis_y, float sun_drop)
{
  PenumbraReceiver receiver;
  receiver.light = light;
  receiver.surface = surface;
  receiver.to_light = to_light;
#ifdef USE_SHADOW_CUBE
  if (lights != LIGHTS_WITH_MAPS) {
    receiver.cube = cube_receiver(light.shadow_index, surface, light, to_light);
  }
#endif
  vec2 turn = pixel_turn();
  // The radii of the lookups for casters are a geometric series, from the outermost caster inwards to a texel, because the nearest and
  // the farthest caster may have penumbrae of very different widths.
  vec2 search = shadow_search(receiver, lights);
  float innermost = search.x * inversesqrt(max(dot(axis_x, axis_x), dot(axis_y, axis_y)));
  vec2 tap = turn * (light.kind == LIGHT_SUN ? search.y : min(search.y, 15.0));
  // The smallest gap. The map shows the sides of casters that face the lamp. The edge of such a side casts the penumbra, and has smaller
  // gaps than its middle. Near casters also have the most visible edges.
  float gap = 0.0;
  // A caster's smallest gap is seldom at a lookup of the series. More lookups follow on the disk that darkens the receiver if the smallest
  // gap so far is right. One loop makes both: llvmpipe would evaluate a second loop once for receivers without casters.
  bool is_search = true;
  int disk_taps = 0;
  int i = 0;
  do {
    vec2 place = is_search ? tap : gap * vogel_radius(disk_taps, PENUMBRA_DISK_TAPS) * turn;
    float place_gap = shadow_gap(receiver, lights, place.x * axis_x + place.y * axis_y);
    bool is_caster = place_gap > 0.0 && length(place) <= PENUMBRA_REACH * place_gap;
    gap = is_caster ? (gap > 0.0 ? min(gap, place_gap) : place_gap) : gap;
    disk_taps += is_search ? 0 : 1;
    turn = is_search ? turn : complex_product(turn, GOLDEN_TURN);
    tap = complex_product(tap, PENUMBRA_SEARCH_STEP);
    is_search = is_search && ++i < PENUMBRA_SEARCH_TAPS && length(tap) > innermost;
  } while (is_search || (gap > 0.0 && disk_taps < PENUMBRA_DISK_TAPS));
  float sun_scale = gap * (1.0 - sun_drop) * inversesqrt(max(2.0 - sun_drop, 1.0));
  // The part of the lamp below the receiver's horizon gives no light, and its lookups are beyond the receiver's wall, outside of a room.
  // Within a half width above the horizon, the part counts less: its lookups are in texels that show both sides of the wall.
  vec3 to_center = light.kind == LIGHT_SUN ? to_light : light.position_ws - surface.position_ws;
  float cos_center = dot(surface.geometric_normal_ws, to_center);
  vec2 cos_change = vec2(dot(surface.geometric_normal_ws, axis_x), dot(surface.geometric_normal_ws, axis_y));
  float per_cos = 1.0 / max(gap * length(cos_change), 1e-30);
  bool is_sharp = gap <= innermost;
  float sum = 0.0;
  float weights = 0.0;
  if (!is_sharp) {
    i = 0;
    do {
      // The points of vogel_disk, turned. A rotation from point to point needs no cosine and sine.
      vec2 point = vogel_radius(i, PENUMBRA_TAPS) * turn;
      turn = complex_product(turn, GOLDEN_TURN);
      // For a sun, points of equal solid angles: 1 - cos is proportional to the square of the radius.
      float drop = sun_drop * dot(point, point);
      point *= sun_scale * sqrt(max(2.0 - drop, 1.0)) / max(1.0 - drop, 1e-6);
      // A caster with a smaller gap covers a point beyond the lamp there. It may be behind the receiver. Not for suns: with those of a
      // world, the picture of one sample has more error (scene world, RMSE 0.0849 to 0.0855). The same for the horizon.
      float least_gap = light.kind == LIGHT_SUN ? 0.0 : length(point) / PENUMBRA_REACH;
      float weight = light.kind == LIGHT_SUN ? 1.0 : clamp((cos_center * gap + dot(cos_change, point)) * per_cos, 0.0, 1.0);
      sum += weight * shadow_at(receiver, lights, point.x * axis_x + point.y * axis_y, least_gap, false);
      weights += weight;
    } while (++i < PENUMBRA_TAPS);
  }
  // Without a caster, or where penumbrae are narrower than a texel, the lamp has the visibility of its centre, with the rule for contacts. A
  // blend of the texels around the receiver would show those of its own surface, or of what it touches, as dark lines. A receiver beside a
  // caster whose back the centre sees is in the shadow of itself.
  float of_center = cos_center > 0.0 || gap <= 0.0 ? shadow_at(receiver, lights, vec3(0.0), 0.0, true) : 0.0;
  return is_sharp ? of_center : sum / max(weights, 1e-30);
}
