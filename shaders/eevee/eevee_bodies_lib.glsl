// SPDX-License-Identifier: MIT
// For fragment shaders: ways of light through surfaces that transmit it, and on to what is behind them in the picture.
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

BodyHit trace_bodies(Ray ray, float start_m)
{
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
      node = int(low.w);
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
      if (is_met && t > (is_from_front == ray.left_front ? start_m : 0.0)) {
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

/** Where a ray meets what is in the picture. */
struct PictureHit {
  bool is_met;
  /** In [0, 1]. */
  vec2 texco;
  float distance_m;
};

/**
 * Follow a ray over the picture up to \a length_m, and find where it goes from before an opaque surface to behind it. \a start: the part of
 * the first step that is left out, in [0, 1).
 */
PictureHit march_behind(Ray ray, float length_m, float start)
{
  const int step_max = 64;
  const float step_px = 3.0;
  vec2 size = vec2(textureSize(behind_depth, 0));
  vec4 from = view.clip_from_world * vec4(ray.origin, 1.0);
  vec4 along = view.clip_from_world * vec4(ray.direction, 0.0);
  vec4 ahead = view.clip_from_world * vec4(-view.back_ws, 0.0);
  PictureHit result = PictureHit(false, vec2(0.0), 0.0);
  bool is_perspective = view.is_perspective != 0;
  if (from.w <= 0.0) {
    return result;
  }
  // A perspective ray ends before the plane of the eye, or in its vanishing point; another outside of the picture.
  float end_m = length_m;
  if (is_perspective && along.w < 0.0) {
    end_m = min(end_m, 0.98 * from.w / -along.w);
  }
  if (!is_perspective) {
    end_m = min(end_m, 4.0 / max(max(abs(along.x), abs(along.y)), max(abs(along.z), 1e-20)));
  }
  vec4 to = end_m < 0.5 * NO_HIT ? from + end_m * along : along;
  vec3 a = from.xyz / from.w;
  vec3 way = to.xyz / max(to.w, 1e-20) - a;
  // The part within the picture and before the far end.
  vec3 limit = vec3(way.x > 0.0 ? 1.0 - a.x : 1.0 + a.x, way.y > 0.0 ? 1.0 - a.y : 1.0 + a.y, way.z > 0.0 ? 1.0 - a.z : a.z);
  vec3 parts = limit / max(abs(way), vec3(1e-20));
  float whole = clamp(min(min(parts.x, parts.y), min(parts.z, 1.0)), 0.0, 1.0);
  float length_px = length(way.xy * whole * 0.5 * size);
  int steps = clamp(int(ceil(length_px / step_px)), 1, step_max);
  // Perspective: depth = slope / (z - z of infinity). Orthographic: z changes by ahead.z a metre.
  float slope = from.z - ahead.z * from.w;
  float last = 0.0;
  bool was_before = true;
  for (int i = 0; i < steps; i++) {
    float part = whole * min((float(i) + 1.0 - start + (i == steps - 1 ? start : 0.0)) / float(steps), 1.0);
    vec3 place = a + part * way;
    ivec2 pixel = clamp(ivec2((0.5 * place.xy + 0.5) * size), ivec2(0), ivec2(size) - 1);
    bool is_before = place.z >= texelFetch(behind_depth, pixel, 0).r;
    if (was_before && !is_before) {
      float low = last;
      float high = part;
      for (int k = 0; k < 6; k++) {
        float middle = 0.5 * (low + high);
        vec3 point = a + middle * way;
        ivec2 at = clamp(ivec2((0.5 * point.xy + 0.5) * size), ivec2(0), ivec2(size) - 1);
        if (point.z >= texelFetch(behind_depth, at, 0).r) {
          low = middle;
        }
        else {
          high = middle;
        }
      }
      vec3 point = a + high * way;
      vec2 texco = 0.5 * point.xy + 0.5;
      ivec2 at = clamp(ivec2(texco * size), ivec2(0), ivec2(size) - 1);
      float z = texelFetch(behind_depth, at, 0).r;
      float ray_m = is_perspective ? slope / max(point.z - ahead.z, 1e-20) : point.z / ahead.z;
      float seen_m = is_perspective ? slope / max(z - ahead.z, 1e-20) : z / ahead.z;
      float last_m = is_perspective ? slope / max(a.z + low * way.z - ahead.z, 1e-20) : (a.z + low * way.z) / ahead.z;
      // A ray that is farther behind passes behind the body that is seen there.
      float thickness_m = 0.02 * abs(is_perspective ? seen_m : 0.1 / ahead.z) + 2.0 * abs(ray_m - last_m);
      if (abs(ray_m - seen_m) <= thickness_m) {
        float reach = end_m < 0.5 * NO_HIT ? to.w / end_m : along.w;
        return PictureHit(true, texco, high * from.w / max(reach - high * along.w, 1e-20));
      }
    }
    was_before = is_before;
    last = part;
  }
  return result;
}

/** Two numbers in [0, 1) for the pixel, the sample and \a number. */
vec2 random_pair(uint number)
{
  uint pixel = mixed_bits(uint(gl_FragCoord.x) + 65536u * uint(gl_FragCoord.y) + 7919u * number);
  uint other = mixed_bits(pixel ^ floatBitsToUint(view.mask_shift));
  return vec2(fract(to_unit(pixel) + view.mask_shift), to_unit(other));
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
