// SPDX-License-Identifier: MIT
// Visibility of a light, 1 lit and 0 in shadow, from the depths of its casters.
#include "eevee/eevee_shadow_place_lib.glsl"
#include "shared/eevee_light_shared.h"

#ifdef USE_SHADOW_CUBE
layout(binding = SHADOW_CUBES_SLOT) uniform sampler2DArray shadow_cubes;
#endif
#ifdef USE_SHADOW_MAP
layout(binding = SHADOW_MAPS_SLOT) uniform sampler2DArray shadow_maps;
#endif

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
  /** Change of depth along the light over the width of a texel. */
  float texel_depth;
};

/** Weighted sum of the lit ones of the four texels at \a corner. \a size_px: edge of the shadow within its layer. */
float four_texels(sampler2DArray depths, int layer, int size_px, ReceiverPlane plane, vec2 corner, vec2 columns, vec2 rows)
{
  corner = clamp(corner, vec2(0.0), vec2(max(size_px - 2, 0)));
  // Gather at the corner that the four texels share, so that rounding cannot select other texels.
  vec4 stored = textureGather(depths, vec3((corner + 1.0) / vec2(textureSize(depths, 0).xy), float(layer)));
  vec4 depths_of_plane = plane_depths(plane.depth, plane.slope, corner - plane.texel);
  return weighted_texels(texels_lit(stored, max(depths_of_plane, vec4(plane.least_depth))), columns, rows);
}

/** Error of a continued caster at the receiver, in texels. */
const float CONTACT_ERROR_TEXELS = 0.1;
/** A texel that is farther than the receiver's plane by more than this number of texels does not show the receiver's surface. */
const float FAR_TEXELS = 2.0;

/** Change of a caster's height from a texel inwards: the smaller one of that from \a beside and that to \a inner. 0: unknown. */
vec4 caster_slope(vec4 height, vec4 beside, vec4 inner)
{
  vec4 from_beside = mix(vec4(0.0), height - beside, greaterThan(beside, vec4(0.0)));
  vec4 to_inner = inner - height;
  bvec4 is_inner = bvec4(uvec4(greaterThan(inner, vec4(0.0))) & uvec4(lessThan(abs(to_inner), abs(from_beside))));
  return mix(from_beside, to_inner, is_inner);
}

/**
 * 1 for each of four texels, in the order of textureGather, that does not shadow the receiver, else 0. \a height: depth of the texel
 * minus that of the receiver's plane. \a lit: 1 where it is not above 0. \a beside_x, \a beside_y: heights at the texels beside the
 * four, outwards. \a weights: of the columns and of the rows.
 *
 * A caster that touches the receiver ends between two texels, of which only one holds it. The other one holds what is beyond the
 * contact, such as the outer part of a wall which passes through a floor, or nothing. It is not beside the receiver. Each caster is
 * therefore continued from its texel to the receiver, along its own slope. Where it covers the receiver and ends at the receiver's
 * plane, texels beyond its end are in shadow. Edges of casters in front of the plane are blended.
 */
vec4 lit_beside_contacts(vec4 height, vec4 lit, vec4 beside_x, vec4 beside_y, vec4 weights)
{
  vec4 slope_x = caster_slope(height, beside_x, height.yxwz);
  vec4 slope_y = caster_slope(height, beside_y, height.wzyx);
  // From the texels inwards to the receiver.
  vec4 at_receiver = height + slope_x * weights.yxxy + slope_y * weights.zzww;
  vec4 is_caster = 1.0 - lit;
  vec4 covers = is_caster * step(vec4(1e-30), at_receiver);
  vec4 to_x = covers * step(height + slope_x, vec4(0.0));
  vec4 to_y = covers * step(height + slope_y, vec4(0.0));
  vec4 to_both = covers * step(height + slope_x + slope_y, vec4(0.0));
  vec4 closed = max(max(to_x.yxwz, to_y.wzyx), to_both.zwxy);
  // Without such a caster, all of them are behind the receiver, which is on the lit side of a contact.
  vec4 may_cover = is_caster * step(vec4(0.0), at_receiver + CONTACT_ERROR_TEXELS * (abs(slope_x) + abs(slope_y)));
  return dot(may_cover, vec4(1.0)) > 0.0 ? lit * (1.0 - closed) : vec4(1.0);
}

/**
 * Number of lookups of the texels beside an edge that the receiver's visibility still needs. Above 0: the last call of bilinear_texels
 * for a receiver has no result yet, and the caller calls it again with the same arguments. The caller's own loop does so, because a
 * loop in bilinear_texels takes llvmpipe half as long again, also where there is no edge.
 */
int edge_pass = 0;
/** Of the calls since edge_pass was 0: the four texels, and those beside them in x and in y. */
vec4 edge_texels = vec4(0.0);
vec4 edge_beside_x = vec4(0.0);
vec4 edge_beside_y = vec4(0.0);

/**
 * x: weighted sum of the lit ones of the four texels around \a texel. y: that of the texels that show the receiver's surface or a caster
 * in front of it. The others are beyond the end of that surface, and do not tell whether it is lit. \a is_receiver: the lookup is at the
 * receiver. Contacts are found there only, \see lit_beside_contacts.
 */
vec2 bilinear_texels(sampler2DArray depths, int layer, int size_px, ReceiverPlane plane, vec2 texel, const bool is_receiver)
{
  vec2 last = vec2(max(size_px - 2, 0));
  vec2 corner = clamp(floor(texel), vec2(0.0), last);
  vec2 fraction = clamp(texel - corner, vec2(0.0), vec2(1.0));
  vec4 weights = vec4(1.0 - fraction.x, fraction.x, 1.0 - fraction.y, fraction.y);
  vec2 slope = plane.slope;
  vec4 receiver = max(plane_depths(plane.depth, slope, corner - plane.texel), vec4(max(plane.least_depth, 0.0)));
  // The squares above the four texels to the left and to the right, and below them to the right and to the left. Each has the texels
  // beside one of the four.
  vec2 aside = vec2(edge_pass == 1 || edge_pass == 4 ? -1.0 : 1.0, edge_pass < 3 ? 1.0 : -1.0);
  vec2 place = is_receiver && edge_pass > 0 ? clamp(corner + aside, vec2(0.0), last) : corner;
  // Gather at the corner that the four texels share, so that rounding cannot select other texels.
  vec4 stored = textureGather(depths, vec3((place + 1.0) / vec2(textureSize(depths, 0).xy), float(layer)));
  vec4 texels = is_receiver && edge_pass > 0 ? edge_texels : stored;
  vec4 height = texels - receiver;
  vec4 lit = texels_lit(texels, receiver);
  float far = FAR_TEXELS * (plane.texel_depth + abs(slope.x) + abs(slope.y));
  vec4 is_known = step(vec4(-far), height);
  if (is_receiver) {
    bvec4 is_this = equal(ivec4(1, 2, 3, 4), ivec4(edge_pass));
    edge_texels = texels;
    edge_beside_x = mix(edge_beside_x, stored.wzyx, is_this);
    edge_beside_y = mix(edge_beside_y, stored.yxwz, is_this);
    vec4 beside_x = edge_beside_x - receiver - vec4(-slope.x, slope.x, slope.x, -slope.x);
    vec4 beside_y = edge_beside_y - receiver - vec4(slope.y, slope.y, -slope.y, -slope.y);
    float lit_count = dot(lit, vec4(1.0));
    bool is_edge = lit_count > 0.0 && lit_count < 4.0;
    lit = is_edge ? lit_beside_contacts(height, lit, beside_x, beside_y, weights) : lit;
    edge_pass = is_edge && edge_pass < 4 ? edge_pass + 1 : 0;
  }
  lit *= is_known;
  return vec2(weighted_texels(lit, weights.xy, weights.zw), weighted_texels(is_known, weights.xy, weights.zw));
}

/** The visibility from sums of bilinear_texels. Where nothing is known, the receiver is lit. */
float known_visibility(vec2 lit_known)
{
  return lit_known.y > 1e-6 ? min(lit_known.x / lit_known.y, 1.0) : 1.0;
}

/** \see bilinear_texels */
vec2 filtered_visibility(sampler2DArray depths, int layer, int size_px, int filter_kind, ReceiverPlane plane, const bool is_receiver)
{
#ifdef USE_SHADOW_PCF
  if (filter_kind == SHADOW_FILTER_PCF) {
    vec2 sum = vec2(0.0);
    if (PCF_WIDTH > 0) {
      // A square of PCF_WIDTH texels around the lookup touches one more texel in each direction. The outer texels are weighted by
      // their covered fraction.
      vec2 first = floor(plane.texel) - float((PCF_WIDTH - 1) / 2);
      vec2 fraction = fract(plane.texel);
      for (int y = 0; y < PCF_WIDTH; y += 2) {
        vec2 rows = vec2(y == 0 ? 1.0 - fraction.y : 1.0, y == PCF_WIDTH - 1 ? fraction.y : 1.0);
        for (int x = 0; x < PCF_WIDTH; x += 2) {
          vec2 columns = vec2(x == 0 ? 1.0 - fraction.x : 1.0, x == PCF_WIDTH - 1 ? fraction.x : 1.0);
          sum.x += four_texels(depths, layer, size_px, plane, first + vec2(x, y), columns, rows);
        }
      }
      return vec2(sum.x / float(PCF_WIDTH * PCF_WIDTH), 1.0);
    }
    for (int i = 0; i < PCF_TAPS; i++) {
      sum += bilinear_texels(depths, layer, size_px, plane, plane.texel + PCF_DISK_RADIUS * vogel_disk(i, PCF_TAPS), false);
    }
    return sum / float(PCF_TAPS);
  }
#endif
  return bilinear_texels(depths, layer, size_px, plane, plane.texel, is_receiver);
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

#ifdef USE_SHADOW_CUBE
/** SHADOW_FILTER_… */
int filter_of(ShadowCubeData cube)
{
  return cube.faces_and_filter >> SHADOW_CUBE_FACE_BITS;
}

/** \a offset: \see ShadowPlace. */
ShadowPlace cube_place(ShadowCubeData cube, Surface surface, LightData light, vec3 to_light, vec3 offset)
{
  // No early returns: llvmpipe evaluates what follows them all the same, and then selects each member.
  // Distance along the axis of the face that contains the receiver.
  vec3 from_light = surface.position_ws - light.position_ws;
  float w = largest(from_light);
  float magnitude = largest(surface.position_ws) + largest(light.position_ws);
  float rounding = DEPTH_ROUNDING / cube.near * w * w;
  float normal_offset = cube.bias * shadow_normal_offset(cube.texel_size * w, kernel_reach(filter_of(cube)), rounding, magnitude);
  // Do not offset past the lamp. From behind, the plane would be reversed.
  normal_offset = min(normal_offset, 0.5 * abs(dot(surface.geometric_normal_ws, from_light)));
  from_light = offset_position(surface, to_light, normal_offset) - light.position_ws;
  int face = cube_face(from_light + offset);
  vec3 p = cube_face_project(face, from_light + offset);
  float size = float(cube.size_px);
  vec4 crop = unpackUnorm4x8(cube.crop);
  float uv_scale = 0.5 * cube_uv_scale(size);
  vec2 extent = crop.zw - crop.xy;
  float per_z = 1.0 / max(p.z, 1e-30);
  vec2 uv = (p.xy * (per_z * uv_scale) + 0.5 - crop.xy) / max(extent, vec2(1.0 / 255.0));
  // A plane n · p = c has 1 / z = (n.x · x/z + n.y · y/z + n.z) / c.
  vec3 n = cube_face_project(face, surface.geometric_normal_ws);
  float per_metre = slope_quotient(cube.near, dot(surface.geometric_normal_ws, from_light));
  ShadowPlace place;
  place.receiver_depth = cube.near * per_z;
  place.plane.texel = uv * size - 0.5;
  place.plane.depth = place.receiver_depth + dot(surface.geometric_normal_ws, offset) * per_metre * per_z;
  place.plane.slope = n.xy * (per_metre / (uv_scale * size)) * extent;
  place.plane.least_depth = least_depth(place, offset, filter_of(cube));
  place.plane.texel_depth = cube.texel_size * place.receiver_depth;
  place.layer = cube.layer + face;
  // Beyond the part of the face that its layer holds, there is no surface of the picture.
  bool is_in_crop = all(lessThanEqual(abs(uv - 0.5), vec2(0.5)));
  place.is_covered = w <= cube.far && (cube.faces_and_filter >> face & 1) != 0 && p.z > 0.0 && is_in_crop;
  return place;
}

vec2 shadow_cube_visibility(int index, Surface surface, LightData light, vec3 to_light, vec3 offset, const bool is_receiver)
{
  ShadowCubeData cube = shadow.cubes[index];
  ShadowPlace place = cube_place(cube, surface, light, to_light, offset);
  return place.is_covered ? filtered_visibility(shadow_cubes, place.layer, cube.size_px, filter_of(cube), place.plane, is_receiver)
                          : vec2(0.0);
}

/** \see shadow_gap */
float shadow_cube_gap(int index, Surface surface, LightData light, vec3 to_light, vec3 offset)
{
  ShadowCubeData cube = shadow.cubes[index];
  ShadowPlace place = cube_place(cube, surface, light, to_light, offset);
  // A depth is the quotient of the near plane's distance and the caster's.
  return place.is_covered ? max(caster_depth(shadow_cubes, place, cube.size_px) / place.receiver_depth - 1.0, 0.0) : 0.0;
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
/** Change of depth for each metre towards a sun. */
float depth_per_metre(ShadowMapData map, vec3 to_light)
{
  vec3 row = vec3(map.texco_from_world[0].z, map.texco_from_world[1].z, map.texco_from_world[2].z);
  return max(dot(row, to_light), 1e-20);
}

/** \a offset: \see ShadowPlace. \a coverage: \see map_coverage. */
ShadowPlace map_place(ShadowMapData map, Surface surface, vec3 to_light, vec3 offset, out float coverage)
{
  ShadowPlace place;
  vec4 receiver = map_receiver(map, surface, to_light);
  vec4 lookup = receiver + map.texco_from_world * vec4(offset, 0.0);
  coverage = receiver.w > 0.0 ? map_coverage(lookup) : 0.0;
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
  // w is the same everywhere in a map of a sun.
  bool is_distant = map.texco_from_world[0].w == 0.0 && map.texco_from_world[1].w == 0.0 && map.texco_from_world[2].w == 0.0;
  place.plane.texel_depth = map.texel_size * (is_distant ? depth_per_metre(map, to_light) : place.receiver_depth);
  place.layer = map.layer;
  return place;
}

/** Visibility from one map. \a coverage: \see map_coverage. */
vec2 one_map_visibility(ShadowMapData map, Surface surface, vec3 to_light, vec3 offset, out float coverage, const bool is_receiver)
{
  ShadowPlace place = map_place(map, surface, to_light, offset, coverage);
  return place.is_covered ? filtered_visibility(shadow_maps, place.layer, map.size_px, map.filter_kind, place.plane, is_receiver) : vec2(0.0);
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

/** Visibility from all maps of a light. \a first: the finest. \a offset: \see ShadowPlace. */
vec2 shadow_map_visibility(int first, Surface surface, vec3 to_light, vec3 offset, const bool is_receiver)
{
  int count = shadow.maps[first].cascade_count;
  vec2 visibility = vec2(0.0);
  // Weight not used by finer cascades. Points outside all cascades are lit.
  float open = 1.0;
  int i = 0;
  if (count > 0) {
    // The test is at the end as in lights_radiance.
    do {
      float coverage;
      vec2 lit = one_map_visibility(shadow.maps[first + i], surface, to_light, offset, coverage, is_receiver);
      // \see edge_pass
      bool again = is_receiver && edge_pass > 0;
      float share = cascade_share(i == count - 1, coverage);
      share = again ? 0.0 : share;
      visibility += open * share * lit;
      open *= 1.0 - share;
      i += again ? 0 : 1;
    } while (i < count && open > 0.0);
  }
  return visibility;
}
#endif
