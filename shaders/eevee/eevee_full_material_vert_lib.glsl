// SPDX-License-Identifier: MIT
// For vertex shaders: writes the inputs of eevee_full_material_lib.glsl.
#include "eevee/eevee_full_alpha_vert_lib.glsl"

#ifdef USE_LIGHT
layout(location = ATTRIBUTE_TANGENT) in vec4 tangent;

layout(location = 5) out vec4 surface_tangent_ws;
#endif
layout(location = 6) out vec4 surface_roughness_normal_uvs;
layout(location = 7) out vec4 surface_occlusion_emissive_uvs;
layout(location = 8) out vec4 surface_specular_uvs;
#ifdef USE_LAYERS
#  include "eevee/eevee_layer_block_lib.glsl"

layout(location = 9) out vec4 surface_coat_uvs;
layout(location = 17) out vec4 surface_sheen_uvs;
layout(location = 16) out vec4 surface_anisotropy_coat_normal_uvs;
layout(location = 19) flat out float surface_coat_normal_scale;
#  ifdef USE_TRANSMISSION
layout(location = 18) out vec4 surface_transmission_uvs;
/** For directions. */
layout(location = 12) flat out mat3 surface_object_from_world;
/** Factor of roughness; whether a texture is multiplied with it; index of refraction. */
layout(location = 15) flat out vec3 surface_lens;
#  endif

/** The same as input_uv, of the texture with number \a index in LayerData. */
vec2 layer_uv(uint material, int index)
{
  return transformed_uv(layer_materials[material].uv_rows[2 * index], layer_materials[material].uv_rows[2 * index + 1]);
}
#endif

void write_full_varyings()
{
  uint material = object_value();
  surface_roughness_normal_uvs = vec4(input_uv(material, 1), input_uv(material, 2));
  surface_occlusion_emissive_uvs = vec4(input_uv(material, 3), input_uv(material, 4));
  surface_specular_uvs = vec4(input_uv(material, 5), input_uv(material, 6));
#ifdef USE_LAYERS
  surface_coat_uvs = vec4(layer_uv(material, 0), layer_uv(material, 1));
  surface_sheen_uvs = vec4(layer_uv(material, 2), layer_uv(material, 3));
  surface_anisotropy_coat_normal_uvs = vec4(layer_uv(material, 4), layer_uv(material, 5));
  bool has_coat_normal = (full_materials[material].inputs & INPUT_COAT_NORMAL) != 0u;
  surface_coat_normal_scale = has_coat_normal ? layer_materials[material].coat_normal_scale : 0.0;
#  ifdef USE_TRANSMISSION
  surface_transmission_uvs = vec4(layer_uv(material, 6), layer_uv(material, 7));
  surface_object_from_world = inverse(mat3(world_from_object()));
  bool has_roughness_texture = (full_materials[material].inputs & INPUT_METALLIC_ROUGHNESS) != 0u;
  surface_lens = vec3(full_materials[material].roughness, has_roughness_texture ? 1.0 : 0.0, layer_materials[material].ior);
#  endif
#endif
#ifdef USE_LIGHT
  mat3 directions_ws = mat3(world_from_object());
  vec3 tangent_ws = directions_ws * tangent.xyz;
  float length_sq = dot(tangent_ws, tangent_ws);
  bool has_normal_texture = (full_materials[material].inputs & INPUT_NORMAL) != 0u;
  float scale = has_normal_texture ? full_materials[material].normal_scale : 0.0;
  // A negative factor turns both axes of the texture around.
  tangent_ws *= length_sq > 0.0 ? inversesqrt(length_sq) : 0.0;
  surface_tangent_ws.xyz = scale < 0.0 ? -tangent_ws : tangent_ws;
#  ifdef USE_LAYERS
  surface_coat_normal_scale = scale < 0.0 ? -surface_coat_normal_scale : surface_coat_normal_scale;
#  endif
  // A mirrored object reverses cross(normal, tangent).
  surface_tangent_ws.w = (determinant(directions_ws) < 0.0 ? -tangent.w : tangent.w) * (1.0 + abs(scale));
#endif
}
