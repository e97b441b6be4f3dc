// SPDX-License-Identifier: MIT
// For fragment shaders: the shading normal from a normal texture.
#include "eevee/eevee_full_material_lib.glsl"
#include "eevee/eevee_surface_frag_lib.glsl"

/**
 * w: 1 + the factor of the normal texture, which is 0 without one, with the sign of MikkTSpace's w. The factor comes from the
 * vertex shader, because the derivatives of the normal depend on it: llvmpipe's invocations outside of a triangle read zeros
 * from storage blocks.
 */
INTERPOLATED(5, vec4, surface_tangent_ws, grid_tangent_ws)

layout(binding = NORMAL_SLOT) uniform sampler2D normal_texture;

/** World space, on the visible side. \a texel: of a normal texture with the factor \a scale. Without tangents, \a otherwise. */
vec3 mapped_normal(vec3 texel, float scale, vec3 otherwise)
{
  if (surface_tangent_ws.xyz == vec3(0.0)) {
    return otherwise;
  }
  vec3 mapped = texel * 2.0 - 1.0;
  mapped.xy *= scale;
  // MikkTSpace defines the frame by the interpolated vectors without normalisation.
  vec3 up_ws = sign(surface_tangent_ws.w) * cross(surface_normal_ws, surface_tangent_ws.xyz);
  vec3 normal_ws = mapped.x * surface_tangent_ws.xyz + mapped.y * up_ws + mapped.z * surface_normal_ws;
  return normalized(gl_FrontFacing ? normal_ws : -normal_ws, otherwise);
}

/** \a surface with the normal of the material's normal texture. */
Surface normal_mapped(Surface surface)
{
  float scale = max(abs(surface_tangent_ws.w) - 1.0, 0.0);
  if (scale != 0.0) {
    vec3 texel = texture(normal_texture, surface_roughness_normal_uvs.zw, view.texture_lod_bias).xyz;
    surface.normal_ws = mapped_normal(texel, scale, surface.normal_ws);
  }
  return surface;
}
