// SPDX-License-Identifier: MIT
// For fragment shaders: ways of light through surfaces that transmit it, and on to the picture behind them.
#include "draw/draw_view_lib.glsl"
#include "eevee/eevee_surface_lib.glsl"
#include "shared/eevee_bodies_shared.h"
#include "shared/eevee_sequence_shared.h"
#include "shared/eevee_world_shared.h"
#include "shared/slots_shared.h"

/** \see eevee_bodies_shared.h */
layout(binding = BODIES_SLOT) uniform samplerBuffer bodies;
/** Depth of `behind`. 0: the background. */
layout(binding = BEHIND_DEPTH_SLOT) uniform sampler2D behind_depth;
/** Equirectangular, rows from the bottom. Not read without a picture in the background. */
layout(binding = WORLD_PICTURE_SLOT) uniform sampler2D world_picture;

const float NO_HIT = 1e30;

/** Radiance and alpha of the background in the direction of a unit vector. */
vec4 background_radiance(vec3 direction_ws)
{
  vec4 color = texelFetch(bodies, 0);
  vec4 head = texelFetch(bodies, 1);
  if (head.z != 0.0) {
    vec2 texco = equirectangular(direction_ws);
    color.rgb *= textureLod(world_picture, vec2(texco.x + head.y, texco.y), 0.0).rgb;
  }
  return color;
}

/** A ray of unit direction, world space. */
struct Ray {
  vec3 origin;
  vec3 direction;
  /** Whether the last surface on its way was met at its front. The same side of a surface is not met again at the origin. */
  bool left_front;
};

/** The nearest surface on a ray. */
struct BodyHit {
  /** Distance, m. NO_HIT: there is none. */
  float distance_m;
  /** Towards the ray's origin, unit length. */
  vec3 normal_ws;
  uint material;
  bool is_front;
};

/** Whether the clip planes of the view leave a point. */
bool is_kept(vec3 position_ws)
{
  vec4 place = view.clip_from_world * vec4(position_ws, 1.0);
  place.xy = 0.5 * (place.xy + place.w) * vec2(textureSize(behind_depth, 0));
  bool result = true;
  for (int i = 0; i < 6; i++) {
    result = result && dot(view.clip_planes[i], place) >= 0.0;
  }
  return result;
}

BodyHit trace_bodies(Ray ray)
{
  // The rounding of the origin.
  float start_m = 1e-5 * (length(ray.origin - view.position_ws) + length(ray.origin));
  int node_count = int(texelFetch(bodies, 1).x);
  int triangles = BODY_HEAD_TEXELS + BODY_NODE_TEXELS * node_count;
  float nearest = NO_HIT;
  int hit = -1;
  vec2 at = vec2(0.0);
  bool is_front = false;
  // An axis with 0 would give NaN for origins on a face of a box.
  vec3 safe = mix(ray.direction, vec3(1e-20), lessThan(abs(ray.direction), vec3(1e-20)));
  vec3 inverse = 1.0 / safe;
  int node = 0;
  while (node < node_count) {
    vec4 low = texelFetch(bodies, BODY_HEAD_TEXELS + BODY_NODE_TEXELS * node);
    vec4 high = texelFetch(bodies, BODY_HEAD_TEXELS + BODY_NODE_TEXELS * node + 1);
    vec3 a = (low.xyz - ray.origin) * inverse;
    vec3 b = (high.xyz - ray.origin) * inverse;
    vec3 near = min(a, b);
    vec3 far = max(a, b);
    float enter = max(max(near.x, near.y), max(near.z, 0.0));
    float leave = min(min(far.x, far.y), min(far.z, nearest)) * 1.000001;
    if (enter > leave) {
      node = max(int(low.w), node + 1);
      continue;
    }
    int leaf = int(high.w);
    for (int i = 0; i < leaf % BODY_LEAF; i++) {
      // Möller and Trumbore 1997.
      int triangle = leaf / BODY_LEAF + i;
      int texel = triangles + BODY_TRIANGLE_TEXELS * triangle;
      vec3 edge_x = texelFetch(bodies, texel + 1).xyz;
      vec3 edge_y = texelFetch(bodies, texel + 2).xyz;
      vec3 p = cross(ray.direction, edge_y);
      float determinant = dot(edge_x, p);
      vec3 from_corner = ray.origin - texelFetch(bodies, texel).xyz;
      vec3 q = cross(from_corner, edge_x);
      float u = dot(from_corner, p) / determinant;
      float v = dot(ray.direction, q) / determinant;
      float t = dot(edge_y, q) / determinant;
      // The margin keeps rays from passing between triangles that share an edge.
      bool is_met = determinant != 0.0 && min(u, v) >= -1e-5 && u + v <= 1.00001 && t < nearest;
      bool is_from_front = determinant > 0.0;
      if (is_met && t > (is_from_front == ray.left_front ? start_m : 0.0) && is_kept(ray.origin + t * ray.direction)) {
        nearest = t;
        hit = texel;
        at = vec2(u, v);
        is_front = is_from_front;
      }
    }
    node++;
  }
  BodyHit result = BodyHit(nearest, -ray.direction, 0u, is_front);
  if (hit >= 0) {
    vec4 corner = texelFetch(bodies, hit);
    vec3 geometric = normalize(cross(texelFetch(bodies, hit + 1).xyz, texelFetch(bodies, hit + 2).xyz));
    vec3 smooth_ws = (1.0 - at.x - at.y) * texelFetch(bodies, hit + 3).xyz + at.x * texelFetch(bodies, hit + 4).xyz +
                     at.y * texelFetch(bodies, hit + 5).xyz;
    float length_sq = dot(smooth_ws, smooth_ws);
    vec3 normal_ws = (is_front ? 1.0 : -1.0) * (length_sq > 0.0 ? smooth_ws * inversesqrt(length_sq) : geometric);
    // At the rim of a smooth body, the smooth normal may be turned away from the ray.
    result.normal_ws = dot(normal_ws, ray.direction) < 0.0 ? normal_ws : (is_front ? geometric : -geometric);
    result.material = uint(corner.w);
  }
  return result;
}

/** Where a ray meets a surface of the picture. */
struct PictureHit {
  bool is_met;
  /** In [0, 1]. Without a hit, the last place on the ray that the picture shows, or a negative value if it shows the end. */
  vec2 texco;
  float distance_m;
};

/** The way of a ray over the picture: the place \a start + part * \a way, in normalized device coordinates. */
struct PictureRay {
  vec3 start;
  vec3 way;
  /** Distance = part * from_w / (reach - part * along_w). */
  float from_w;
  float along_w;
  float reach;
};

float distance_at(PictureRay ray, float part)
{
  return part * ray.from_w / max(ray.reach - part * ray.along_w, 1e-20);
}

vec2 texco_at(PictureRay ray, float part)
{
  return 0.5 * (ray.start.xy + part * ray.way.xy) + 0.5;
}

/** Depth of the picture at a part of the way. */
float seen_at(PictureRay ray, float part)
{
  ivec2 size = textureSize(behind_depth, 0);
  return texelFetch(behind_depth, clamp(ivec2(texco_at(ray, part) * vec2(size)), ivec2(0), size - 1), 0).r;
}

/**
 * Follow a ray over the picture up to \a length_m, and find where it goes from before an opaque surface to behind it. \a offset: the
 * part of the first step that is left out, in [0, 1).
 */
PictureHit march_behind(Ray ray, float length_m, float offset)
{
  const int step_max = 64;
  const float step_px = 3.0;
  vec4 from = view.clip_from_world * vec4(ray.origin, 1.0);
  vec4 along = view.clip_from_world * vec4(ray.direction, 0.0);
  vec4 ahead = view.clip_from_world * vec4(-view.back_ws, 0.0);
  PictureHit miss = PictureHit(false, vec2(-1.0), 0.0);
  bool is_perspective = view.is_perspective != 0;
  if (from.w <= 0.0) {
    return miss;
  }
  // A perspective ray ends before the plane of the eye, or in its vanishing point; another outside of the picture.
  float end_m = length_m;
  if (is_perspective && along.w < 0.0) {
    end_m = min(end_m, 0.98 * from.w / -along.w);
  }
  if (!is_perspective) {
    end_m = min(end_m, 4.0 / max(max(abs(along.x), abs(along.y)), max(abs(along.z), 1e-20)));
  }
  bool is_endless = end_m >= 0.5 * NO_HIT;
  vec4 to = is_endless ? along : from + end_m * along;
  PictureRay path;
  path.start = from.xyz / from.w;
  path.way = to.xyz / max(to.w, 1e-20) - path.start;
  path.from_w = from.w;
  path.along_w = along.w;
  path.reach = is_endless ? along.w : to.w / end_m;
  // The part within the picture and before the far end.
  vec3 room = mix(1.0 + path.start, 1.0 - path.start, greaterThan(path.way, vec3(0.0)));
  room.z = path.way.z > 0.0 ? 1.0 - path.start.z : path.start.z;
  vec3 parts = room / max(abs(path.way), vec3(1e-20));
  float whole = clamp(min(min(parts.x, parts.y), min(parts.z, 1.0)), 0.0, 1.0);
  float length_px = length(path.way.xy * whole * 0.5 * vec2(textureSize(behind_depth, 0)));
  float pixel = whole / max(length_px, 1.0);
  int steps = clamp(int(ceil(length_px / step_px)), 1, step_max);
  // Metres along the view axis: perspective scale / (z - z of infinity), orthographic z / change of z in a metre.
  float scale = from.z - ahead.z * from.w;
  // A distance at which a perspective picture is as high as an orthographic one.
  float parallel_m = 2.5 / length(vec3(view.clip_from_world[0].y, view.clip_from_world[1].y, view.clip_from_world[2].y));
  float last = 0.0;
  // The gap is the depth of the ray less that of the surface in the picture; a negative gap puts the ray behind the surface. Both depths are
  // linear over the picture if the surface is a plane.
  float gap = path.start.z - seen_at(path, 0.0);
  float closing = 0.0;
  float hidden_m = NO_HIT;
  bool is_guess = false;
  for (int i = 1; i <= steps; i++) {
    float part = whole * (i == steps ? 1.0 : (float(i) - offset) / float(steps));
    float seen = seen_at(path, part);
    float next_gap = path.start.z + part * path.way.z - seen;
    // Rounding at the far end is no surface.
    if (next_gap >= 0.0 || seen <= 0.0) {
      closing = (gap - next_gap) / max(part - last, 1e-20);
      // The plane of the last surface would meet the ray at a place where the picture shows another surface.
      is_guess = seen > 0.0 && closing > 0.0 && part + next_gap / closing < 1.0;
      gap = next_gap;
      last = part;
      miss.texco = vec2(-1.0);
      hidden_m = NO_HIT;
      continue;
    }
    float low = last;
    float high = part;
    for (int k = 0; k < 6 && hidden_m == NO_HIT; k++) {
      float middle = 0.5 * (low + high);
      if (path.start.z + middle * path.way.z >= seen_at(path, middle)) {
        low = middle;
      }
      else {
        high = middle;
      }
    }
    vec4 depths = vec4(path.start.z + vec2(high, low) * path.way.z, seen_at(path, high), seen_at(path, high + pixel));
    vec4 depths_m = is_perspective ? scale / max(depths - ahead.z, vec4(1e-20)) : depths / ahead.z;
    // A ray that is farther behind passes behind the body that is seen there. A surface changes its depth within a pixel.
    float size_m = is_perspective ? depths_m.z : parallel_m;
    float margin_m = 0.002 * size_m + 2.0 * abs(depths_m.x - depths_m.y);
    float slope_m = depths.w > 0.0 ? 1.5 * min(abs(depths_m.w - depths_m.z), 0.015 * size_m) : 0.0;
    bool is_met = hidden_m == NO_HIT && abs(depths_m.x - depths_m.z) <= margin_m + slope_m;
    // This surface is farther than the place where the ray was hidden. The ray met the surface before that place.
    if (is_met || depths_m.z > hidden_m) {
      return PictureHit(true, texco_at(path, high), distance_at(path, high));
    }
    if (hidden_m == NO_HIT) {
      hidden_m = depths_m.x;
      miss.texco = texco_at(path, last);
    }
  }
  // Behind a body, and beyond the edge of the picture, the plane of the last surface goes on.
  if (is_guess && (hidden_m < NO_HIT || whole < 1.0)) {
    return PictureHit(true, texco_at(path, last), distance_at(path, min(last + gap / closing, 1.0)));
  }
  return miss;
}

/** Two numbers in [0, 1) for the pixel, the sample and \a number. */
vec2 random_pair(uint number)
{
  uint pixel = mixed_bits(uint(gl_FragCoord.x) + 65536u * uint(gl_FragCoord.y) + 7919u * number);
  uint other = mixed_bits(pixel ^ floatBitsToUint(view.mask_shift));
  // The samples spread the first number evenly for one surface alone. Two surfaces with the same shift would have dependent numbers.
  bool is_spread = number % 64u == 0u;
  return vec2(is_spread ? fract(to_unit(pixel) + view.mask_shift) : to_unit(mixed_bits(other + 0x9E3779B9u)), to_unit(other));
}

/** A microfacet that is visible from the unit vector \a view_ws (Heitz 2018). \a uv: in [0, 1). */
vec3 visible_microfacet(vec3 normal_ws, vec3 view_ws, float alpha, vec2 uv)
{
  vec3 tangent = any_across(normal_ws);
  mat3 axes = mat3(tangent, cross(normal_ws, tangent), normal_ws);
  vec3 v = view_ws * axes;
  vec3 stretched = normalize(vec3(alpha * v.xy, max(v.z, 1e-4)));
  float across_sq = dot(stretched.xy, stretched.xy);
  vec3 x = across_sq > 0.0 ? vec3(-stretched.y, stretched.x, 0.0) * inversesqrt(across_sq) : vec3(1.0, 0.0, 0.0);
  vec3 y = cross(stretched, x);
  float radius = sqrt(uv.x);
  float angle = 2.0 * PI * uv.y;
  float p = radius * cos(angle);
  float s = 0.5 + 0.5 * stretched.z;
  float q = mix(sqrt(max(1.0 - p * p, 0.0)), radius * sin(angle), s);
  vec3 facet = p * x + q * y + sqrt(max(1.0 - p * p - q * q, 0.0)) * stretched;
  return axes * normalize(vec3(alpha * facet.xy, max(facet.z, 1e-6)));
}

/** Fresnel reflectance of a dielectric. \a ratio: index before the surface / index behind it. 1: total reflection. */
float dielectric_reflectance(float cos_i, float ratio)
{
  float cos_t_sq = 1.0 - ratio * ratio * (1.0 - cos_i * cos_i);
  if (cos_t_sq <= 0.0) {
    return 1.0;
  }
  float cos_t = sqrt(cos_t_sq);
  float across = (ratio * cos_i - cos_t) / (ratio * cos_i + cos_t);
  float within = (ratio * cos_t - cos_i) / (ratio * cos_t + cos_i);
  return 0.5 * (across * across + within * within);
}
