// SPDX-License-Identifier: MIT
// For fragment shaders: the shading normal from a normal texture.
#include "eevee/eevee_full_material_lib.glsl"
#include "eevee/eevee_surface_frag_lib.glsl"

/**
 * w: 1 + the factor of the normal texture, which is 0 without one, with the sign of MikkTSpace's w. The factor comes from the
 * vertex shader, because the derivatives of the normal depend on it: llvmpipe's invocations outside of a triangle read zeros
 * from storage blocks.
 */
layout(location = 5) in vec4 surface_tangent_ws;

layout(binding = NORMAL_SLOT) uniform sampler2D normal_texture;

/** \a surface with the normal of the material's normal texture. The normal is unchanged if the mesh has no tangents. */
Surface normal_mapped(Surface surface)
{
  float scale = max(abs(surface_tangent_ws.w) - 1.0, 0.0);
  if (scale == 0.0 || surface_tangent_ws.xyz == vec3(0.0)) {
    return surface;
  }
  vec3 mapped = texture(normal_texture, surface_roughness_normal_uvs.zw, view.texture_lod_bias).xyz * 2.0 - 1.0;
  mapped.xy *= scale;
  // MikkTSpace defines the frame by the interpolated vectors without normalisation.
  vec3 up_ws = sign(surface_tangent_ws.w) * cross(surface_normal_ws, surface_tangent_ws.xyz);
  vec3 normal_ws = mapped.x * surface_tangent_ws.xyz + mapped.y * up_ws + mapped.z * surface_normal_ws;
  surface.normal_ws = normalized(gl_FrontFacing ? normal_ws : -normal_ws, surface.normal_ws);
  return surface;
}
