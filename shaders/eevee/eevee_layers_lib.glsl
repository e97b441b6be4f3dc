// SPDX-License-Identifier: MIT
// For fragment shaders: the layers over the base of a material, from their factors and textures.
#include "eevee/eevee_full_material_lib.glsl"
#include "eevee/eevee_layer_block_lib.glsl"
#include "eevee/eevee_light_lib.glsl"
#include "eevee/eevee_ltc_lib.glsl"
#include "eevee/eevee_normal_map_lib.glsl"
#include "eevee/eevee_surface_frag_lib.glsl"

INTERPOLATED(9, vec4, surface_coat_uvs, grid_coat_uvs)
INTERPOLATED(17, vec4, surface_sheen_uvs, grid_sheen_uvs)
INTERPOLATED(16, vec4, surface_anisotropy_coat_normal_uvs, grid_anisotropy_coat_normal_uvs)
/** Factor of the coat's normal texture, which is 0 without one; from the vertex shader, as that of surface_tangent_ws. */
layout(location = 19) flat in float surface_coat_normal_scale;

layout(binding = COAT_SLOT) uniform sampler2D coat_texture;
layout(binding = COAT_ROUGHNESS_SLOT) uniform sampler2D coat_roughness_texture;
layout(binding = SHEEN_COLOR_SLOT) uniform sampler2D sheen_color_texture;
layout(binding = SHEEN_ROUGHNESS_SLOT) uniform sampler2D sheen_roughness_texture;
layout(binding = ANISOTROPY_SLOT) uniform sampler2D anisotropy_texture;
layout(binding = COAT_NORMAL_SLOT) uniform sampler2D coat_normal_texture;

/** The lobe of the base, whose alpha without anisotropy is \a alpha. */
BaseLobe make_base_lobe(float alpha, Surface surface)
{
  vec3 anisotropy = layer_materials[surface_material].anisotropy;
  vec2 direction = anisotropy.xy;
  if (has_input(INPUT_ANISOTROPY)) {
    vec3 texel = texture(anisotropy_texture, surface_anisotropy_coat_normal_uvs.xy, view.texture_lod_bias).xyz;
    vec2 turned = texel.xy * 2.0 - 1.0;
    direction = vec2(direction.x * turned.x - direction.y * turned.y, direction.y * turned.x + direction.x * turned.y);
    anisotropy.z *= texel.z;
  }
  vec3 normal = surface.normal_ws;
  vec3 up_ws = sign(surface_tangent_ws.w) * cross(surface_normal_ws, surface_tangent_ws.xyz);
  vec3 along = direction.x * surface_tangent_ws.xyz + direction.y * up_ws;
  along -= dot(along, normal) * normal;
  // The square of one step of 8 bits. The mesh may have no tangents, and the texture no direction.
  const float least_sq = 1e-5;
  float length_sq = dot(along, along);
  BaseLobe lobe;
  float strength = length_sq > least_sq ? anisotropy.z : 0.0;
  along = length_sq > least_sq ? along * inversesqrt(length_sq) : any_across(normal);
  lobe.alphas = anisotropic_alphas(alpha, strength);
  vec3 across = cross(normal, along);
  lobe.lobe_from_world = transpose(mat3(along, across, normal));
  // A smooth surface uses the normal of a cylinder along the smoother direction, as in Khronos's sample viewer.
  vec3 round_normal = surface.view_ws - dot(surface.view_ws, across) * across;
  float bend = 1.0 - strength * (1.0 - sqrt(alpha));
  bend *= bend;
  lobe.bent_normal_ws = normalized(mix(normalized(round_normal, normal), normal, bend * bend), normal);
  return lobe;
}

/** \a surface: with the normal of the base. \a alpha: of the base, without anisotropy. */
Layers make_layers(float alpha, Surface surface)
{
  LayerData data = layer_materials[surface_material];
  Layers result;
  result.base_lobe = make_base_lobe(alpha, surface);
  float coat_roughness = data.coat_roughness;
  if (has_input(INPUT_COAT_ROUGHNESS)) {
    coat_roughness *= texture(coat_roughness_texture, surface_coat_uvs.zw, view.texture_lod_bias).g;
  }
  result.coat_material = coat_material(coat_roughness);
  result.coat_surface = surface;
  result.coat_surface.normal_ws = surface.smooth_normal_ws;
  if (surface_coat_normal_scale != 0.0) {
    vec3 texel = texture(coat_normal_texture, surface_anisotropy_coat_normal_uvs.zw, view.texture_lod_bias).xyz;
    result.coat_surface.normal_ws = mapped_normal(texel, surface_coat_normal_scale, surface.smooth_normal_ws);
  }
  result.coat_material.alpha = sampled_alpha(result.coat_material.alpha, result.coat_surface, normal_change_sq(result.coat_surface));
#ifdef USE_MULTISCATTER
  result.coat_surface.multiscatter = multiscatter_of(result.coat_material, result.coat_surface);
#endif
  float coat = data.coat;
  if (has_input(INPUT_COAT)) {
    coat *= texture(coat_texture, surface_coat_uvs.xy, view.texture_lod_bias).r;
  }
  result.coat_share = coat_reflectance(coat, max(dot(result.coat_surface.normal_ws, surface.view_ws), 0.0));
  vec3 sheen_color = data.sheen_color;
  if (has_input(INPUT_SHEEN_COLOR)) {
    sheen_color *= texture(sheen_color_texture, surface_sheen_uvs.xy, view.texture_lod_bias).rgb;
  }
  float sheen_roughness = data.sheen_roughness;
  if (has_input(INPUT_SHEEN_ROUGHNESS)) {
    sheen_roughness *= texture(sheen_roughness_texture, surface_sheen_uvs.zw, view.texture_lod_bias).a;
  }
  result.sheen_alpha = max(sheen_roughness * sheen_roughness, SHEEN_ALPHA_MIN);
  float cos_v = clamp(dot(surface.normal_ws, surface.view_ws), 1e-4, 1.0);
  float albedo = textureLod(ltc_table, ltc_texco(result.sheen_alpha, cos_v) + vec2(0.5, 0.0), 0.0).w;
  result.sheen_color = sheen_color * sheen_bounded(albedo);
  result.sheen_albedo = result.sheen_color * albedo;
  result.base_share = 1.0 - max(max(result.sheen_albedo.r, result.sheen_albedo.g), result.sheen_albedo.b);
  return result;
}
