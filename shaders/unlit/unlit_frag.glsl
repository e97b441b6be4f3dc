#version 450 core
// SPDX-License-Identifier: MIT
// A surface without lighting: its base colour and emission, black if it is occluded from the depth camera.
#include "eevee/eevee_material_lib.glsl"
#if defined(USE_FULL_MATERIAL)
#  include "eevee/eevee_full_material_lib.glsl"
#elif defined(USE_BASE_COLOR_TEXTURE)
#  include "eevee/eevee_base_color_lib.glsl"
#endif
#if defined(USE_FULL_MATERIAL) || defined(USE_BASE_COLOR_TEXTURE)
#  include "eevee/eevee_mask_lib.glsl"
#endif
#ifdef USE_DEPTH_CAMERA
#  include "unlit/unlit_depth_camera_lib.glsl"

layout(binding = DEPTH_SLOT) uniform sampler2D depth_texture;

layout(location = 0) in vec4 depth_camera_position;

/**
 * 1 if the surface is occluded from the depth camera, otherwise 0; 0 also outside the sides of the camera's frustum. With every
 * projection, the receiver is a plane in (u, v, depth), so that its depth at the centre of the texel follows from the derivatives
 * (Isidoro 2006, receiver plane depth bias).
 */
float shadow()
{
  vec3 place = depth_camera_position.xyz / depth_camera_position.w;
  vec2 texels = vec2(textureSize(depth_texture, 0));
  vec2 texel = (0.5 * place.xy + 0.5) * texels;
  // Derivatives need the neighbouring pixels, so they are computed before any branch.
  vec3 across = dFdx(vec3(texel, place.z));
  vec3 up = dFdy(vec3(texel, place.z));
  if (depth_camera_position.w <= 0.0 || place.z > 1.0 || any(lessThan(texel, vec2(0.0))) ||
      any(greaterThanEqual(texel, texels))) {
    return 0.0;
  }
  float area = across.x * up.y - across.y * up.x;
  vec2 slope = vec2(across.z * up.y - up.z * across.y, up.z * across.x - across.z * up.x);
  vec2 to_middle = floor(texel) + 0.5 - texel;
  // If the plane is seen edge-on, its depth at the centre of the texel is undefined.
  vec2 depth_of_texel = area != 0.0 ? slope / area : vec2(0.0);
  // Rasterisers move the corners of triangles to a grid, and the plane of the stored depths with them.
  float moved = (abs(depth_of_texel.x) + abs(depth_of_texel.y)) * depth_tolerance.z;
  float depth = place.z + dot(depth_of_texel, to_middle) + moved;
  float stored = texelFetch(depth_texture, ivec2(texel), 0).r;
  // Depths are reversed: a nearer surface has a greater depth.
  return stored > depth + depth_tolerance.x * place.z + depth_tolerance.y ? 1.0 : 0.0;
}
#endif

#ifdef USE_FULL_MATERIAL
/** Part of the picture behind that the surface covers. */
float opacity()
{
  bool passes_light = !has_input(INPUT_BLENDED | INPUT_MASKED | INPUT_TRANSMISSION);
  return passes_light ? full_materials[surface_material].opacity : surface_opacity();
}
#endif
#include "draw/draw_clip_lib.glsl"

layout(location = 0) out vec4 radiance;

void main()
{
#ifdef USE_FULL_MATERIAL
  MaterialData material = full_material();
#else
  MaterialData material = materials[surface_material];
#endif
  vec3 color = material.diffuse + material.metal_f0;
#ifdef USE_BASE_COLOR_TEXTURE
  color *= texture(base_color_texture, surface_uv, view.texture_lod_bias).rgb;
#endif
  color += material.emissive;
#ifdef USE_DEPTH_CAMERA
  color *= 1.0 - shadow();
#endif
  radiance = vec4(color, 1.0);
#ifdef USE_FULL_MATERIAL
  radiance *= opacity();
#endif
#ifdef USE_XRAY
  radiance *= 0.5;
#endif
#if defined(USE_FULL_MATERIAL) || defined(USE_BASE_COLOR_TEXTURE)
  if (is_pixel_cut_out(materials[surface_material].mask_cutoff)) {
    discard;
  }
#endif
  discard_clipped();
}
