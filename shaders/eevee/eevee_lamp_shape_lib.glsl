// SPDX-License-Identifier: MIT
// Light of lamps with an extent, each shaded as a whole: form factors for diffuse reflection, linearly transformed cosines for
// the specular lobe.
#include "eevee/eevee_surface_lib.glsl"
#include "shared/eevee_area_shared.h"
#include "shared/eevee_light_shared.h"
#include "shared/eevee_shape_shared.h"
#include "shared/slots_shared.h"
#ifdef USE_SPECULAR
#  include "eevee/eevee_ltc_lib.glsl"
#endif

#ifndef USE_LIGHT_CLUSTERS
layout(std140, binding = LIGHT_SHAPE_BLOCK_SLOT) uniform light_shape_block
{
  LightShapeBlock light_shapes;
};
#endif

/** Orthonormal axes at the shaded point: z is the normal, and the view direction is in the plane of x and z. */
struct ShadingFrame {
  vec3 x_ws;
  vec3 y_ws;
  vec3 z_ws;
};

ShadingFrame shading_frame(Surface surface)
{
  vec3 across = surface.view_ws - surface.normal_ws * dot(surface.normal_ws, surface.view_ws);
  float length_sq = dot(across, across);
  vec3 x_ws = length_sq > 1e-10 ? across * inversesqrt(length_sq) : any_across(surface.normal_ws);
  return ShadingFrame(x_ws, cross(surface.normal_ws, x_ws), surface.normal_ws);
}

vec3 in_frame(ShadingFrame frame, vec3 v)
{
  return vec3(dot(frame.x_ws, v), dot(frame.y_ws, v), dot(frame.z_ws, v));
}

/** A flat lamp in the axes of a shading frame, relative to the shaded point. */
struct FlatLamp {
  vec3 center;
  vec3 axis_x;
  vec3 axis_y;
  int corner_count;
  /** Radiance for a light colour of 1. */
  float radiance;
};

/** The flat lamp of a rectangle or an ellipse. */
FlatLamp area_lamp(LightData light, LightShape shape, ShadingFrame frame, Surface surface)
{
  bool is_rectangle = light.kind == LIGHT_RECTANGLE;
  float area = flat_lamp_area(shape.axis_x_ws, shape.axis_y_ws, is_rectangle);
  return FlatLamp(in_frame(frame, light.position_ws - surface.position_ws), in_frame(frame, shape.axis_x_ws),
                  in_frame(frame, shape.axis_y_ws), is_rectangle ? RECTANGLE_CORNERS : ELLIPSE_CORNERS,
                  1.0 / max(area, 1e-30));
}

/**
 * The disk that represents a point, spot or sun. It faces the shaded point. \a to_light: unit vector to its centre.
 * \a tangent: radius / distance. \a irradiance: irradiance for a light colour of 1 on a surface that faces the disk.
 */
FlatLamp round_lamp(vec3 to_light, float tangent, float irradiance, ShadingFrame frame)
{
  vec3 center = in_frame(frame, to_light);
  vec3 axis_x = any_across(center) * tangent;
  // The irradiance of a disk is its radiance times π sin².
  float sine_sq = tangent * tangent / (1.0 + tangent * tangent);
  return FlatLamp(center, axis_x, cross(center, axis_x), ELLIPSE_CORNERS, irradiance * INV_PI / max(sine_sq, 1e-30));
}

/** Values at the shaded point that are the same for all lamps. */
struct ShapeShading {
  ShadingFrame frame;
#ifdef USE_SPECULAR
  vec4 ltc_matrix;
  /** Albedo of the specular lobe, with Fresnel terms. */
  vec3 albedo;
#endif
};

#ifdef USE_SPECULAR
/**
 * Specular radiance towards the viewer for a light colour of 1. It is the integral of the transformed cosine of
 * ltc_matrix over the lamp, times the ratio of the lobe to the transformed cosine in the mean direction of the light. If
 * the lamp is small relative to the lobe, the result is the value of the lobe, also where the transformed cosine is 0. If the lobe is
 * small relative to the lamp, the result is the albedo of the lobe.
 */
vec3 specular_of(FlatLamp lamp, MaterialData material, Surface surface, ShapeShading shading)
{
  ShadingFrame frame = shading.frame;
  vec4 ltc_matrix = shading.ltc_matrix;
  vec3 view = in_frame(frame, surface.view_ws);
  bool is_rectangle = lamp.corner_count == RECTANGLE_CORNERS;
  bool is_small = is_small_lamp(lamp.center, lamp.axis_x, lamp.axis_y, material.alpha);
  // llvmpipe evaluates the code below for all pixels, and skips the loop over the corners where no pixel needs it.
  vec3 flux = flat_flux(ltc_transformed(ltc_matrix, lamp.center), ltc_transformed(ltc_matrix, lamp.axis_x),
                        ltc_transformed(ltc_matrix, lamp.axis_y), is_small ? 0 : lamp.corner_count, ltc_up(ltc_matrix));
  vec3 to_light = is_small ? direction_or_zero(lamp.center) : direction_or_zero(ltc_restored(ltc_matrix, flux));
  vec3 half_vector = direction_or_zero(to_light + view);
  if ((flux.z <= 0.0 && !is_small) || to_light.z <= 0.0) {
    return vec3(0.0);
  }
  float cos_h = clamp(half_vector.z, 0.0, 1.0);
  float lobe = ggx_lobe(to_light.z, max(view.z, 1e-4), cos_h, material.alpha) * to_light.z;
  float ratio = min(lobe / max(ltc_density(ltc_matrix, to_light), 1e-30), LTC_RATIO_MAX);
  float solid_angle = flat_lamp_solid_angle(flat_lamp_area_along(lamp.axis_x, lamp.axis_y, is_rectangle, to_light),
                                            dot(lamp.center, lamp.center));
  float reflected = is_small ? lobe * solid_angle : flux.z * ratio;
  vec3 fresnel = fresnel_schlick(material.specular_f0, material.specular_f90, dot(view, half_vector));
  // The ratio in one direction is wrong for a lamp that covers most of the lobe. All of the lobe is its albedo.
  float covered = is_small ? 0.0 : ltc_covered(ltc_matrix, flux.z);
  return lamp.radiance * mix(fresnel * reflected, shading.albedo * covered, covered);
}
#endif
