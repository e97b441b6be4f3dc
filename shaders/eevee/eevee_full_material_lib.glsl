// SPDX-License-Identifier: MIT
// For fragment shaders: the shading parameters of a surface from all textures of its material and from vertex colours.
#include "draw/draw_view_lib.glsl"
#include "eevee/eevee_full_alpha_lib.glsl"

layout(location = 6) in vec4 surface_roughness_normal_uvs;
layout(location = 7) in vec4 surface_occlusion_emissive_uvs;
layout(location = 8) in vec4 surface_specular_uvs;

layout(binding = METALLIC_ROUGHNESS_SLOT) uniform sampler2D metallic_roughness_texture;
layout(binding = OCCLUSION_SLOT) uniform sampler2D occlusion_texture;
layout(binding = EMISSIVE_SLOT) uniform sampler2D emissive_texture;
layout(binding = SPECULAR_SLOT) uniform sampler2D specular_texture;
layout(binding = SPECULAR_COLOR_SLOT) uniform sampler2D specular_color_texture;

/** Part of the light from behind that the surface covers; 1 unless the material is blended. */
float surface_opacity()
{
  if (!has_input(INPUT_BLENDED)) {
    return 1.0;
  }
  float texel = has_input(INPUT_BASE_COLOR) ? texture(base_color_texture, surface_uv, view.texture_lod_bias).a : 1.0;
  return blended_opacity(texel);
}

MaterialData full_material()
{
  FullMaterialData full = full_materials[surface_material];
  vec3 base_color = full.base_color * surface_color.rgb;
  if (has_input(INPUT_BASE_COLOR)) {
    base_color *= texture(base_color_texture, surface_uv, view.texture_lod_bias).rgb;
  }
  if (has_input(INPUT_UNLIT)) {
    return unlit_material(base_color);
  }
  vec2 roughness_metallic = vec2(full.roughness, full.metallic);
  if (has_input(INPUT_METALLIC_ROUGHNESS)) {
    roughness_metallic *= texture(metallic_roughness_texture, surface_roughness_normal_uvs.xy, view.texture_lod_bias).gb;
  }
  float specular = full.specular;
  if (has_input(INPUT_SPECULAR)) {
    specular *= texture(specular_texture, surface_specular_uvs.xy, view.texture_lod_bias).a;
  }
  vec3 specular_color = full.specular_color;
  if (has_input(INPUT_SPECULAR_COLOR)) {
    specular_color *= texture(specular_color_texture, surface_specular_uvs.zw, view.texture_lod_bias).rgb;
  }
  MaterialData material =
      metallic_roughness_material(base_color, roughness_metallic.y, roughness_metallic.x, specular_color, specular);
  material.emissive = full.emissive;
  if (has_input(INPUT_EMISSIVE)) {
    material.emissive *= texture(emissive_texture, surface_occlusion_emissive_uvs.zw, view.texture_lod_bias).rgb;
  }
  if (has_input(INPUT_OCCLUSION)) {
    float open = texture(occlusion_texture, surface_occlusion_emissive_uvs.xy, view.texture_lod_bias).r;
    material.occlusion += full.occlusion_strength * (open - 1.0);
  }
  return material;
}
