// SPDX-License-Identifier: MIT
// Visibility of a light, 1 lit and 0 in shadow, from the depths of its casters.
#include "eevee/eevee_shadow_place_lib.glsl"
#include "shared/eevee_disk_shared.h"
#include "shared/eevee_light_shared.h"

#ifdef USE_SHADOW_CUBE
layout(binding = SHADOW_CUBES_SLOT) uniform sampler2DArray shadow_cubes;
#endif
#ifdef USE_SHADOW_MAP
layout(binding = SHADOW_MAPS_SLOT) uniform sampler2DArray shadow_maps;
#endif

/** Layers show the whole receiver in each sample. false: they may not; they show a blended surface in some samples, for example. */
#ifdef HAS_SURFACE_IN_LAYERS
const bool SURFACE_IN_LAYERS = true;
#else
const bool SURFACE_IN_LAYERS = false;
#endif
/** Distance behind the receiver's plane, in texels, within which a surface in a texel may be the receiver's own. */
const float SURFACE_TEXELS = 4.0;

/** The receiver's plane in the space of a shadow layer, around a lookup. */
struct ReceiverPlane {
  /** Position of the lookup. Texel centres are at integers. */
  vec2 texel;
  /** Depth of the plane at the lookup. */
  float depth;
  /** Change of depth for each texel, across and up. */
  vec2 slope;
  /** Casters with smaller depths do not shadow the receiver, even if they are in front of the plane. */
  float least_depth;
  /** A texel that is behind the plane by at most this depth may show the receiver's own surface. */
  float surface_depth;
};

/** Depths of the four texels at \a corner, in the order of textureGather. */
vec4 stored_depths(sampler2DArray depths, int layer, vec2 corner)
{
  // Gather at the corner that the four texels share, so that rounding cannot select other texels.
  return textureGather(depths, vec3((corner + 1.0) / vec2(textureSize(depths, 0).xy), float(layer)));
}

/** Weighted sum of the lit ones of the four texels at \a corner. \a size_px: edge of the shadow within its layer. */
float four_texels(sampler2DArray depths, int layer, int size_px, ReceiverPlane plane, vec2 corner, vec2 columns, vec2 rows)
{
  corner = clamp(corner, vec2(0.0), vec2(max(size_px - 2, 0)));
  vec4 stored = stored_depths(depths, layer, corner);
  vec4 depths_of_plane = plane_depths(plane.depth, plane.slope, corner - plane.texel);
  return weighted_texels(texels_lit(stored, max(depths_of_plane, vec4(plane.least_depth))), columns, rows);
}

/** Bilinear blend of the four texels around \a texel. */
float bilinear_texels(sampler2DArray depths, int layer, int size_px, ReceiverPlane plane, vec2 texel)
{
  vec2 corner = floor(texel);
  vec2 fraction = texel - corner;
  return four_texels(depths, layer, size_px, plane, corner, vec2(1.0 - fraction.x, fraction.x),
                     vec2(1.0 - fraction.y, fraction.y));
}

/**
 * Whether a lookup is beyond the end of the receiver's surface, such as outside of a closed room: casters are beside it, because not all
 * four texels are \a lit, and no texel of \a openings shows the surface. \a openings: lit texels that show no caster.
 * \a height: of what the texels show, above the receiver's plane. Always false without SURFACE_IN_LAYERS.
 */
bool is_beyond_surface(vec4 lit, vec4 openings, vec4 height, float surface_depth)
{
  return SURFACE_IN_LAYERS && dot(lit, vec4(1.0)) < 4.0 && dot(openings * step(abs(height), vec4(surface_depth)), vec4(1.0)) == 0.0;
}

/** Visibility at an offset from the receiver: bilinear blend of the four texels; 0 beyond the end of the receiver's surface. */
float offset_visibility(sampler2DArray depths, int layer, int size_px, ReceiverPlane plane)
{
  vec2 corner = clamp(floor(plane.texel), vec2(0.0), vec2(max(size_px - 2, 0)));
  vec2 fraction = plane.texel - floor(plane.texel);
  vec4 stored = stored_depths(depths, layer, corner);
  vec4 on_plane = plane_depths(plane.depth, plane.slope, corner - plane.texel);
  vec4 lit = texels_lit(stored, max(on_plane, vec4(plane.least_depth)));
  float blend = weighted_texels(lit, vec2(1.0 - fraction.x, fraction.x), vec2(1.0 - fraction.y, fraction.y));
  return is_beyond_surface(lit, lit, stored - on_plane, plane.surface_depth) ? 0.0 : blend;
}

/** Error of a caster that is continued to the receiver, in texels. */
const float CONTACT_ERROR_TEXELS = 0.1;
/**
 * Part of that error within which light rises from 0 to 1 beyond the end of a caster, and within which a texel shows the caster where it
 * is continued. Of 1, 0.5 and 0.25, the last one has the least error: RMSE of the scene plaza with one sample 0.011349, 0.011322 and
 * 0.011306.
 */
const float CONTACT_RISE = 0.25;

/**
 * Change of a caster's height above the receiver's plane by a texel, towards those that do not shadow the receiver: the smaller one of
 * that from the texel \a outer to \a height and that to \a inner. Heights that are not above 0 are of no caster. 0: unknown.
 */
float caster_slope(float outer, float height, float inner)
{
  float from_outer = height - outer;
  float to_inner = inner - height;
  float slope = outer > 0.0 ? from_outer : 0.0;
  return inner > 0.0 && (outer <= 0.0 || abs(to_inner) < abs(from_outer)) ? to_inner : slope;
}

/**
 * Visibility of the receiver itself: bilinear blend of the four texels around it, except at contacts.
 *
 * A caster that touches the receiver ends between two texels, of which one holds it. The other one holds what is beyond the contact,
 * such as the outer part of a wall which passes through a floor, or nothing. It is not beside the receiver. The caster is therefore
 * continued from its texel towards the others, along its own slope. Where it ends at the receiver's plane before a texel, a receiver on
 * its side of the end is in shadow, and a receiver beyond the end is lit. Edges of casters in front of the plane are blended.
 *
 * Where casters are beside the receiver and no lit texel shows its surface, the lit ones are beyond the end of the surface, such as those
 * outside of a closed room. The receiver is in shadow, if layers show it.
 */
float receiver_visibility(sampler2DArray depths, int layer, int size_px, ReceiverPlane plane)
{
  vec2 last = vec2(max(size_px - 2, 0));
  vec2 corner = clamp(floor(plane.texel), vec2(0.0), last);
  vec2 fraction = plane.texel - floor(plane.texel);
  vec4 stored = stored_depths(depths, layer, corner);
  vec4 receiver = max(plane_depths(plane.depth, plane.slope, corner - plane.texel), vec4(plane.least_depth));
  vec4 lit = texels_lit(stored, receiver);
  float blend = weighted_texels(lit, vec2(1.0 - fraction.x, fraction.x), vec2(1.0 - fraction.y, fraction.y));
  // The direction towards the casters, and the four texels one further there.
  vec2 side = sign(vec2(lit.x + lit.w - lit.y - lit.z, lit.z + lit.w - lit.x - lit.y));
  vec2 moved = clamp(corner + side, vec2(0.0), last) - corner;
  vec4 further = stored_depths(depths, layer, corner + moved);
  receiver = max(receiver, vec4(0.0));
  vec4 height = stored - receiver;
  further -= receiver + dot(moved, plane.slope);
  // Mirrored so that the casters are at the upper right, y. Two casters are at the right, y and z.
  bool is_straight = side.x * side.y == 0.0;
  if (side.x < 0.0) {
    height = height.yxwz;
    further = further.yxwz;
    fraction.x = 1.0 - fraction.x;
  }
  if (side.y < 0.0) {
    height = height.wzyx;
    further = further.wzyx;
    fraction.y = 1.0 - fraction.y;
  }
  if (side.x == 0.0) {
    height = height.zyxw;
    further = further.zyxw;
    fraction = fraction.yx;
  }
  vec2 inwards = 1.0 - fraction;
  // Slopes to the left in the upper and in the lower row, and from the upper to the lower one.
  float upper = caster_slope(is_straight ? further.y : further.z, height.y, height.x);
  float down = is_straight ? height.z - height.y : caster_slope(further.x, height.y, height.z);
  float lower = is_straight ? caster_slope(further.z, height.z, height.w) : upper;
  vec4 continued = height.y + vec4(upper, 0.0, down, down + lower);
  float at_receiver = height.y + mix(down + lower * inwards.x, upper * inwards.x, fraction.y);
  float error = CONTACT_ERROR_TEXELS * (max(abs(upper), abs(lower)) + (is_straight ? 0.0 : abs(down)));
  vec4 is_lit = step(height, vec4(0.0));
  // A lit texel that shows the continued caster itself, at the contact, is no opening beside it, and is not the receiver's surface.
  vec4 is_beside = is_lit * step(vec4(CONTACT_RISE * error), abs(continued - height));
  vec4 open = is_beside * step(vec4(1e-30), continued);
  bool is_edge = side != vec2(0.0);
  if (is_edge && at_receiver > 0.0 && dot(open, vec4(1.0)) < dot(is_lit, vec4(1.0))) {
    blend = weighted_texels(open, vec2(inwards.x, fraction.x), vec2(inwards.y, fraction.y));
  }
  // Beyond the end, light rises within a part of the error. A blend of texels shows dark dashes along the foot of a lit wall.
  blend = is_edge && at_receiver <= 0.0 ? min(-at_receiver / max(CONTACT_RISE * error, 1e-30), 1.0) : blend;
  // Before the rise is complete, a surface that ends within the texels of the contact is in shadow: a corner of three walls.
  bool is_contact = is_edge && at_receiver > -CONTACT_RISE * error;
  return is_beyond_surface(lit, is_contact ? is_beside : is_lit, height, plane.surface_depth) ? 0.0 : blend;
}

float filtered_visibility(sampler2DArray depths, int layer, int size_px, int filter_kind, ReceiverPlane plane,
                          const bool is_receiver)
{
#ifdef USE_SHADOW_PCF
  if (filter_kind == SHADOW_FILTER_PCF) {
    float sum = 0.0;
    if (PCF_WIDTH > 0) {
      // A square of PCF_WIDTH texels around the lookup touches one more texel in each direction. The outer texels are weighted by
      // their covered fraction.
      vec2 first = floor(plane.texel) - float((PCF_WIDTH - 1) / 2);
      vec2 fraction = fract(plane.texel);
      for (int y = 0; y < PCF_WIDTH; y += 2) {
        vec2 rows = vec2(y == 0 ? 1.0 - fraction.y : 1.0, y == PCF_WIDTH - 1 ? fraction.y : 1.0);
        for (int x = 0; x < PCF_WIDTH; x += 2) {
          vec2 columns = vec2(x == 0 ? 1.0 - fraction.x : 1.0, x == PCF_WIDTH - 1 ? fraction.x : 1.0);
          sum += four_texels(depths, layer, size_px, plane, first + vec2(x, y), columns, rows);
        }
      }
      return sum / float(PCF_WIDTH * PCF_WIDTH);
    }
    for (int i = 0; i < PCF_TAPS; i++) {
      sum += bilinear_texels(depths, layer, size_px, plane, plane.texel + PCF_DISK_RADIUS * vogel_disk(i, PCF_TAPS));
    }
    return sum / float(PCF_TAPS);
  }
#endif
  return is_receiver ? receiver_visibility(depths, layer, size_px, plane) :
                       offset_visibility(depths, layer, size_px, plane);
}

/**
 * A lookup in a shadow layer. Lookups for penumbrae are offset from the receiver: in a plane through the receiver that is parallel
 * to the lamp, or for a sun perpendicular to its light.
 */
struct ShadowPlace {
  ReceiverPlane plane;
  /** Depth of that plane at the lookup. Only casters with greater depths are between the receiver and the lamp. */
  float receiver_depth;
  int layer;
  /** false if there is no caster at the lookup; the other members are then undefined. */
  bool is_covered;
};

/** Depth of the nearest texel at a place; 0 if it is not nearer than the receiver and its plane. */
float caster_depth(sampler2DArray depths, ShadowPlace place, int size_px)
{
  vec2 texel = clamp(floor(place.plane.texel + 0.5), vec2(0.0), vec2(size_px - 1));
  float stored = texelFetch(depths, ivec3(ivec2(texel), place.layer), 0).r;
  float plane_depth = place.plane.depth + dot(place.plane.slope, texel - place.plane.texel);
  return stored > max(plane_depth, place.receiver_depth) ? stored : 0.0;
}

/**
 * ReceiverPlane::least_depth of a lookup with an offset. It excludes casters behind the receiver, which are in front of its plane if
 * the plane is tilted. The plane is deeper by at most the slope within the reach of the kernel, so that an offset of 0 excludes none.
 */
float least_depth(ShadowPlace place, vec3 offset, int filter_kind)
{
  float slope = abs(place.plane.slope.x) + abs(place.plane.slope.y);
  return offset == vec3(0.0) ? 0.0 : place.receiver_depth - kernel_reach(filter_kind) * slope;
}

/**
 * ReceiverPlane::surface_depth. \a texel_depth: change of depth along the edge of a texel towards the light. \a offset_texels: normal
 * offset of the plane. Rounding and the bias make it larger than NORMAL_OFFSET_TEXELS.
 */
float surface_depth(float texel_depth, vec2 slope, float offset_texels)
{
  float offset_scale = max(offset_texels / NORMAL_OFFSET_TEXELS, 1.0);
  return offset_scale * (SURFACE_TEXELS * abs(texel_depth) + 2.0 * (abs(slope.x) + abs(slope.y)));
}

#ifdef USE_SHADOW_CUBE
/** SHADOW_FILTER_… */
int filter_of(ShadowCubeData cube)
{
  return cube.faces_and_filter >> SHADOW_CUBE_FACE_BITS;
}

/** The values that all lookups of a receiver in its cube share. llvmpipe does not move them out of loops over lookups. */
struct CubeReceiver {
  ShadowCubeData cube;
  /** Position of the receiver with the normal offset, from the light, metres. */
  vec3 from_light;
  /** The near plane's distance divided by c, where the receiver's plane is n · p = c. */
  float per_metre;
  /** Normal offset, texels. */
  float offset_texels;
  /** Texels for each tangent of the angle from a face's axis, and the texel of the axis. */
  vec2 texel_scale;
  vec2 axis_texel;
  bool is_in_range;
};

/** \a index: of the cube. \a to_light: unit vector. */
CubeReceiver cube_receiver(int index, Surface surface, LightData light, vec3 to_light)
{
  CubeReceiver receiver;
  receiver.cube = shadow.cubes[index];
  // Distance along the axis of the face that contains the receiver.
  vec3 from_light = surface.position_ws - light.position_ws;
  float w = largest(from_light);
  float magnitude = largest(surface.position_ws) + largest(light.position_ws);
  float near = receiver.cube.near;
  float texel = receiver.cube.texel_size * w;
  float rounding = DEPTH_ROUNDING / near * w * w;
  float normal_offset = receiver.cube.bias * shadow_normal_offset(texel, kernel_reach(filter_of(receiver.cube)), rounding, magnitude);
  // Do not offset past the lamp. From behind, the plane would be reversed.
  normal_offset = min(normal_offset, 0.5 * abs(dot(surface.geometric_normal_ws, from_light)));
  receiver.from_light = offset_position(surface, to_light, normal_offset) - light.position_ws;
  receiver.per_metre = slope_quotient(near, dot(surface.geometric_normal_ws, receiver.from_light));
  receiver.offset_texels = normal_offset / max(texel, 1e-30);
  // The part of each face that its layer holds.
  vec4 crop = unpackUnorm4x8(receiver.cube.crop);
  vec2 face_px = float(receiver.cube.size_px) / max(crop.zw - crop.xy, vec2(1.0 / 255.0));
  receiver.texel_scale = 0.5 * cube_uv_scale(float(receiver.cube.size_px)) * face_px;
  receiver.axis_texel = (0.5 - crop.xy) * face_px - 0.5;
  receiver.is_in_range = w <= receiver.cube.far;
  return receiver;
}

/** \a offset: \see ShadowPlace. */
ShadowPlace cube_place(CubeReceiver receiver, Surface surface, vec3 offset)
{
  // No early returns: llvmpipe evaluates the code after them all the same, and then selects each member.
  ShadowCubeData cube = receiver.cube;
  int face = cube_face(receiver.from_light + offset);
  vec3 p = cube_face_project(face, receiver.from_light + offset);
  float per_z = 1.0 / max(p.z, 1e-30);
  // A plane n · p = c has 1 / z = (n.x · x/z + n.y · y/z + n.z) / c.
  vec3 n = cube_face_project(face, surface.geometric_normal_ws);
  ShadowPlace place;
  place.receiver_depth = cube.near * per_z;
  place.plane.texel = p.xy * per_z * receiver.texel_scale + receiver.axis_texel;
  place.plane.depth = place.receiver_depth + dot(surface.geometric_normal_ws, offset) * receiver.per_metre * per_z;
  place.plane.slope = n.xy * (receiver.per_metre / receiver.texel_scale);
  place.plane.least_depth = least_depth(place, offset, filter_of(cube));
  place.plane.surface_depth = surface_depth(cube.texel_size * place.receiver_depth, place.plane.slope, receiver.offset_texels);
  place.layer = cube_face_layer(cube.layers, face);
  // Beyond the part of the face that its layer holds, there is no surface of the picture.
  float half_px = 0.5 * float(cube.size_px);
  bool is_in_crop = all(lessThanEqual(abs(place.plane.texel + (0.5 - half_px)), vec2(half_px)));
  place.is_covered = receiver.is_in_range && (cube.faces_and_filter >> face & 1) != 0 && p.z > 0.0 && is_in_crop;
  return place;
}

/**
 * \a least_gap: of the casters that count; 0: all. Not for suns. \see eevee_penumbra_lib.glsl. \a is_receiver: the lookup is at the
 * receiver itself, \see receiver_visibility.
 */
float shadow_cube_visibility(CubeReceiver receiver, Surface surface, vec3 offset, float least_gap, const bool is_receiver)
{
  ShadowCubeData cube = receiver.cube;
  ShadowPlace place = cube_place(receiver, surface, offset);
  // A depth is the quotient of the near plane's distance and the caster's.
  place.plane.least_depth = max(place.plane.least_depth, least_gap > 0.0 ? place.receiver_depth * (1.0 + least_gap) : 0.0);
  return place.is_covered ? filtered_visibility(shadow_cubes, place.layer, cube.size_px, filter_of(cube), place.plane, is_receiver)
                          : 1.0;
}

/** \see shadow_gap */
float shadow_cube_gap(CubeReceiver receiver, Surface surface, vec3 offset)
{
  ShadowPlace place = cube_place(receiver, surface, offset);
  // A depth is the quotient of the near plane's distance and the caster's.
  return place.is_covered ? max(caster_depth(shadow_cubes, place, receiver.cube.size_px) / place.receiver_depth - 1.0, 0.0) : 0.0;
}

/** \see shadow_search */
vec2 shadow_cube_search(int index, Surface surface, LightData light)
{
  ShadowCubeData cube = shadow.cubes[index];
  vec3 from_light = surface.position_ws - light.position_ws;
  return vec2(cube.texel_size * largest(from_light), length(from_light) / cube.near);
}
#endif

#ifdef USE_SHADOW_MAP
/** \a offset: \see ShadowPlace. \a coverage: \see map_coverage. */
ShadowPlace map_place(ShadowMapData map, Surface surface, vec3 to_light, vec3 offset, out float coverage)
{
  ShadowPlace place;
  float normal_offset;
  vec4 receiver = map_receiver(map, surface, to_light, normal_offset);
  vec4 lookup = receiver + map.texco_from_world * vec4(offset, 0.0);
  coverage = receiver.w > 0.0 ? map_coverage(map, lookup) : 0.0;
  place.is_covered = coverage > 0.0;
  if (!place.is_covered) {
    return place;
  }
  vec3 texco = receiver.xyz / receiver.w;
  // Derivatives of the map's coordinates along two directions on the receiver's plane: d(q / w) = (dq - q / w · dw) / w.
  vec3 n = surface.geometric_normal_ws;
  vec3 tangent = normalize(abs(n.z) < 0.9 ? vec3(n.y, -n.x, 0.0) : vec3(0.0, n.z, -n.y));
  vec4 along = map.texco_from_world * vec4(tangent, 0.0);
  vec4 across = map.texco_from_world * vec4(cross(n, tangent), 0.0);
  vec3 normal = cross(along.xyz - texco * along.w, across.xyz - texco * across.w);
  vec2 slope = vec2(slope_quotient(-normal.x, normal.z), slope_quotient(-normal.y, normal.z));
  float size = float(map.size_px);
  vec2 moved = lookup.xy / lookup.w - texco.xy;
  place.receiver_depth = lookup.z / lookup.w;
  place.plane.texel = lookup.xy / lookup.w * size - 0.5;
  // The depth of a plane is affine over a map, in perspective too.
  place.plane.depth = texco.z + dot(slope, moved);
  place.plane.slope = slope / size;
  place.plane.least_depth = least_depth(place, offset, map.filter_kind);
  vec4 towards = map.texco_from_world * vec4(to_light, 0.0);
  float texel_depth = map.texel_size * (towards.z - texco.z * towards.w);
  place.plane.surface_depth = surface_depth(texel_depth, place.plane.slope, normal_offset / max(map.texel_size * receiver.w, 1e-30));
  place.layer = map.layer;
  return place;
}

/** Visibility from one map. \a coverage: \see map_coverage. \a least_gap: \see shadow_cube_visibility. */
float one_map_visibility(ShadowMapData map, Surface surface, vec3 to_light, vec3 offset, float least_gap, out float coverage,
                         const bool is_receiver)
{
  ShadowPlace place = map_place(map, surface, to_light, offset, coverage);
  if (place.is_covered && least_gap > 0.0) {
    place.plane.least_depth = max(place.plane.least_depth, place.receiver_depth * (1.0 + least_gap));
  }
  return place.is_covered ? filtered_visibility(shadow_maps, place.layer, map.size_px, map.filter_kind, place.plane, is_receiver) : 1.0;
}

/** Change of depth for each metre towards a sun. */
float depth_per_metre(ShadowMapData map, vec3 to_light)
{
  vec3 row = vec3(map.texco_from_world[0].z, map.texco_from_world[1].z, map.texco_from_world[2].z);
  return max(dot(row, to_light), 1e-20);
}

/** \see shadow_gap. Uses the finest map that contains the lookup. */
float shadow_map_gap(int first, Surface surface, LightData light, vec3 to_light, vec3 offset)
{
  int count = shadow.maps[first].cascade_count;
  float gap = 0.0;
  bool is_covered = false;
  int i = 0;
  if (count > 0) {
    // The test is at the end as in lights_radiance.
    do {
      ShadowMapData map = shadow.maps[first + i];
      float coverage;
      ShadowPlace place = map_place(map, surface, to_light, offset, coverage);
      is_covered = place.is_covered;
      if (is_covered) {
        float stored = caster_depth(shadow_maps, place, map.size_px);
        gap = light.kind == LIGHT_SUN ? (stored - place.receiver_depth) / depth_per_metre(map, to_light) :
                                        stored / place.receiver_depth - 1.0;
      }
    } while (++i < count && !is_covered);
  }
  return max(gap, 0.0);
}

/** \see shadow_search */
vec2 shadow_map_search(int first, Surface surface, LightData light, vec3 to_light)
{
  ShadowMapData map = shadow.maps[first];
  if (map.cascade_count == 0) {
    return vec2(0.0);
  }
  vec4 receiver = map.texco_from_world * vec4(surface.position_ws, 1.0);
  return light.kind == LIGHT_SUN ?
             vec2(map.texel_size, 1.5 * max((1.0 - receiver.z) / depth_per_metre(map, to_light), 0.0)) :
             max(vec2(map.texel_size * receiver.w, receiver.w / receiver.z), vec2(0.0));
}

/** Visibility from all maps of a light. \a first: the finest. \a offset: \see ShadowPlace. \a least_gap: \see shadow_cube_visibility. */
float shadow_map_visibility(int first, Surface surface, vec3 to_light, vec3 offset, float least_gap, const bool is_receiver)
{
  int count = shadow.maps[first].cascade_count;
  float visibility = 0.0;
  // Weight not used by finer cascades. Points outside all cascades are lit.
  float open = 1.0;
  int i = 0;
  if (count > 0) {
    // The test is at the end as in lights_radiance.
    do {
      float coverage;
      float lit = one_map_visibility(shadow.maps[first + i], surface, to_light, offset, least_gap, coverage, is_receiver);
      float share = cascade_share(i == count - 1, coverage);
      visibility += open * share * lit;
      open *= 1.0 - share;
    } while (++i < count && open > 0.0);
  }
  return visibility + open;
}
#endif
