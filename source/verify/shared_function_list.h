// SPDX-License-Identifier: MIT
// Calls of every pure function of shaders/shared with the vectors a, b and c. Each line is compiled as C++ in float, as
// C++ in double, and as GLSL. Included once by shared_functions_float.cc and once by shared_functions_double.cc.
#include "eevee_area_shared.h"
#include "eevee_bsdf_shared.h"
#include "eevee_depth_shared.h"
#include "eevee_disk_shared.h"
#include "eevee_esm_shared.h"
#include "eevee_light_shared.h"
#include "eevee_multiscatter_shared.h"
#include "eevee_octahedral_shared.h"
#include "eevee_shadow_shared.h"
#include "draw_view_transform_shared.h"

namespace SHARED_NAMESPACE {

// clang-format off
#define FUNCTION(NAME, ...) \
  {#NAME, #__VA_ARGS__, [](const gnomon::verify::Arguments<float> &arguments) -> vec4 { \
     const auto &[a, b, c] = arguments; \
     (void)b, (void)c; \
     return __VA_ARGS__; \
   }},

inline constexpr gnomon::verify::CompiledFunction<float> compiled_functions[] = {
  FUNCTION(line_plane_distance, vec4(line_plane_distance(vec3(a), vec3(b), vec3(a.w, b.w, c.w), vec3(c)), 0, 0, 0))
  FUNCTION(rectangle_solid_angle, vec4(rectangle_solid_angle(vec3(a), vec3(b), vec3(c)), 0, 0, 0))

  FUNCTION(ggx_distribution, vec4(ggx_distribution(a.x, a.y), 0, 0, 0))
  FUNCTION(ggx_masking_over_2cos, vec4(ggx_masking_over_2cos(a.x, a.y), 0, 0, 0))
  FUNCTION(ggx_lobe, vec4(ggx_lobe(a.x, a.y, a.z, a.w), 0, 0, 0))
  FUNCTION(fresnel_schlick, vec4(fresnel_schlick(vec3(a), a.w, b.x), 0))
  FUNCTION(multiscatter_place, vec4(multiscatter_place(a.x, a.y), 0, 0))
  FUNCTION(missing_scale, vec4(missing_scale(a.x, a.y), 0, 0, 0))
  FUNCTION(lobe_albedo, vec4(lobe_albedo(a, b.x, b.y).missing, lobe_albedo(a, b.x, b.y).schlick, 0, 0))
  FUNCTION(multiscatter_color, vec4(multiscatter_color(vec3(a), a.w, b.x), 0))

  FUNCTION(depth_of_distance, vec4(depth_of_distance(a.x, a.y, a.z, int(a.w)), 0, 0, 0))
  FUNCTION(distance_of_depth, vec4(distance_of_depth(a.x, a.y, a.z, int(a.w)), 0, 0, 0))

  FUNCTION(log_sum, vec4(log_sum_value(log_sum_add(log_sum_add(log_sum_add(log_sum_begin(
      a.x, c.x), b.x, a.y, c.y), b.x, a.z, c.z), b.x, a.w, c.w), b.x), 0, 0, 0))
  FUNCTION(esm_visibility, vec4(esm_visibility(a.x, a.y, a.z), 0, 0, 0))
  FUNCTION(esm_variance_visibility, vec4(esm_variance_visibility(b.x, a.x, a.y, a.z, a.w), 0, 0, 0))
  FUNCTION(esm_encoded, vec4(esm_encoded(a.x, a.y, int(a.z)), 0, 0, 0))
  FUNCTION(esm_decoded, vec4(esm_decoded(a.x, a.y, int(a.z)), 0, 0, 0))
  FUNCTION(esm_format_error, vec4(esm_format_error(a.x, int(a.y)), 0, 0, 0))
  FUNCTION(esm_visibility_error, vec4(esm_visibility_error(a.x, a.y), 0, 0, 0))
  FUNCTION(esm_disk_point, vec4(esm_disk_point(int(a.x), int(a.y)), 0, 0))
  FUNCTION(esm_cone_direction, vec4(esm_cone_direction(vec3(a), vec2(b), b.z), 0))
  FUNCTION(esm_bias, vec4(esm_bias(a.x, a.y, a.z, a.w), 0, 0, 0))
  FUNCTION(esm_gathered_visibility, vec4(esm_gathered_visibility(c.x, a, b.x, vec2(b.y, b.z)), 0, 0, 0))

  FUNCTION(spot_inv_width, vec4(spot_inv_width(a.x, a.y), 0, 0, 0))
  FUNCTION(spot_mask, vec4(spot_mask(a.x, a.y, spot_inv_width(a.y, a.z)), 0, 0, 0))
  FUNCTION(distance_falloff, vec4(distance_falloff(a.x, a.y, a.z), 0, 0, 0))
  FUNCTION(hemi_irradiance, vec4(hemi_irradiance(a.x), 0, 0, 0))

  FUNCTION(octahedral_from_direction, vec4(octahedral_from_direction(vec3(a)), 0, 0))
  FUNCTION(octahedral_to_direction, vec4(octahedral_to_direction(vec2(a)), 0))
  FUNCTION(octahedral_texel_weight, vec4(octahedral_texel_weight(vec3(a)), 0, 0, 0))
  FUNCTION(octahedral_texel_angle, vec4(octahedral_texel_angle(vec3(a), int(a.w)), 0, 0, 0))
  FUNCTION(octahedral_texel, vec4(vec2(octahedral_texel(ivec2(vec2(a)), int(a.z))), 0, 0))

  FUNCTION(cube_face, vec4(cube_face(vec3(a)), 0, 0, 0))
  FUNCTION(cube_face_project, vec4(cube_face_project(int(a.w), vec3(a)), 0))
  FUNCTION(cube_uv_scale, vec4(cube_uv_scale(a.x), 0, 0, 0))
  FUNCTION(shadow_normal_offset, vec4(shadow_normal_offset(a.x, a.y, a.z, a.w), 0, 0, 0))
  FUNCTION(plane_depths, plane_depths(a.x, vec2(a.y, a.z), vec2(b)))
  FUNCTION(texels_lit, texels_lit(a, b))
  FUNCTION(weighted_texels, vec4(weighted_texels(a, vec2(b), vec2(b.z, b.w)), 0, 0, 0))
  FUNCTION(vogel_radius, vec4(vogel_radius(int(a.x), int(a.y)), 0, 0, 0))
  FUNCTION(vogel_disk, vec4(vogel_disk(int(a.x), int(a.y)), 0, 0))
  FUNCTION(slope_quotient, vec4(slope_quotient(a.x, a.y), 0, 0, 0))

  FUNCTION(srgb_encoded, vec4(srgb_encoded(a.x), 0, 0, 0))
  FUNCTION(agx_curve, vec4(agx_curve(a.x), 0, 0, 0))
  FUNCTION(agx, vec4(agx(vec3(a)), 0))
  FUNCTION(pbr_neutral, vec4(pbr_neutral(vec3(a)), 0))
  FUNCTION(view_transformed, vec4(view_transformed(vec3(a), int(a.w)), 0))
};
// clang-format on
#undef FUNCTION

}  // namespace SHARED_NAMESPACE
