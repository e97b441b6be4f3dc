// SPDX-License-Identifier: MIT
// For fragment shaders: the surface function of a material. doc/surfaces.md describes its inputs and outputs.
#include "eevee/eevee_full_material_lib.glsl"
#include "eevee/eevee_surface_lib.glsl"
#include "shared/eevee_surface_function_shared.h"

layout(std140, binding = SURFACE_FUNCTION_BLOCK_SLOT) uniform surface_function_block
{
  SurfaceFunctionData surface_function;
};

/** Both sets of the mesh, without the transforms of textures. */
INTERPOLATED(10, vec4, surface_mesh_uvs, grid_mesh_uvs)
layout(location = 11) in vec3 surface_position_os;
#ifndef USE_LIGHT
layout(location = 0) in vec3 surface_position_ws;
INTERPOLATED(1, vec3, surface_normal_ws, grid_normal_ws)
#endif

/** Inputs of a surface function beside the textures of the material. */
struct SurfaceInputs {
  /** World space of the scene, metres. */
  vec3 position_ws;
  /** Object space. */
  vec3 position_os;
  /** Normal of the mesh, without the normal texture. World space, unit length, on the visible side. */
  vec3 normal_ws;
  /** Towards the viewer, unit length. In shadow passes, which have none, it is normal_ws. */
  vec3 view_ws;
  vec2 uv;
  vec2 second_uv;
  /** Vertex colour; white if the mesh has none. */
  vec4 color;
};

#include "user/surface.glsl"

/** \a value in [0, most]. Comparisons with NaN are false. */
float within(float value, float most)
{
  return value > 0.0 ? min(value, most) : 0.0;
}

vec3 within(vec3 value, float most)
{
  return vec3(within(value.x, most), within(value.y, most), within(value.z, most));
}

/** Alpha before the function: 1 of an opaque material. */
float textured_alpha()
{
  if (!has_input(INPUT_BLENDED) && !has_input(INPUT_MASKED)) {
    return 1.0;
  }
  float texel = 1.0;
  if (has_input(INPUT_BASE_COLOR)) {
    // Masks and shadows read level 0. \see is_cut_out
#ifdef WITHOUT_VIEW
    texel = textureLod(base_color_texture, surface_uv, 0.0).a;
#else
    texel = has_input(INPUT_MASKED) ? textureLod(base_color_texture, surface_uv, 0.0).a
                                    : texture(base_color_texture, surface_uv, texture_bias()).a;
#endif
  }
  return blended_opacity(texel);
}

/** The surface after the function, with all values in their ranges. \a normal_ws: with the normal texture. */
StandardSurface edited_surface(vec3 position_ws, vec3 smooth_normal_ws, vec3 normal_ws, vec3 view_ws)
{
  SurfaceInputs inputs;
  inputs.position_ws = surface_function.origin_ws + position_ws;
  inputs.position_os = surface_position_os;
  inputs.normal_ws = smooth_normal_ws;
  inputs.view_ws = view_ws;
  inputs.uv = surface_mesh_uvs.xy;
  inputs.second_uv = surface_mesh_uvs.zw;
  inputs.color = surface_color;
  StandardSurface result = textured_surface();
  result.normal_ws = normal_ws;
  result.alpha = textured_alpha();
  surface(inputs, result);
  const float most = 1e9;
  result.base_color = within(result.base_color, 1.0);
  result.metallic = within(result.metallic, 1.0);
  result.roughness = within(result.roughness, 1.0);
  result.specular = within(result.specular, 1.0);
  result.specular_color = within(result.specular_color, most);
  result.emission = surface_function.emission * within(result.emission, most);
  result.occlusion = within(result.occlusion, 1.0);
  result.alpha = within(result.alpha, 1.0);
  float length_sq = dot(result.normal_ws, result.normal_ws);
  result.normal_ws = length_sq > 1e-30 && length_sq < 1e30 ? result.normal_ws * inversesqrt(length_sq) : normal_ws;
  return result;
}

/** The parameters of \a edited for shading. */
MaterialData edited_material(StandardSurface edited)
{
  if (has_input(INPUT_UNLIT)) {
    return unlit_material(surface_function.emission * edited.base_color);
  }
  return standard_material(edited);
}

#ifndef USE_LIGHT
/** Alpha after the function, for passes that draw depths. */
float edited_alpha()
{
  vec3 normal_ws = normalized(gl_FrontFacing ? surface_normal_ws : -surface_normal_ws, vec3(0.0, 0.0, 1.0));
#  ifdef WITHOUT_VIEW
  vec3 view_ws = normal_ws;
#  else
  vec3 view_ws = normalized(to_viewer(surface_position_ws), view.back_ws);
#  endif
  return edited_surface(surface_position_ws, normal_ws, normal_ws, view_ws).alpha;
}
#endif
