// SPDX-License-Identifier: MIT
// Light of whole lamps, and lamps that are shaded as a whole. Included by eevee_light_lib.glsl, after what both read.

ShapeShading shape_shading(MaterialData material, Surface surface)
{
  ShapeShading shading;
  shading.frame = shading_frame(surface);
#ifdef USE_SPECULAR
  float cos_v = clamp(dot(surface.normal_ws, surface.view_ws), 1e-4, 1.0);
  vec2 texco = ltc_texco(material.alpha, cos_v);
  shading.ltc_matrix = textureLod(ltc_table, texco, 0.0);
#ifdef USE_MULTISCATTER
  shading.albedo = single_albedo(surface.multiscatter.view, material.specular_f0, material.specular_f90);
#else
  shading.albedo = specular_albedo(textureLod(ltc_table, texco + vec2(0.5, 0.0), 0.0), material.specular_f0, material.specular_f90);
#endif
#endif
  return shading;
}

/** Shading by the base of the material, and by its coat. \see shade_shapes */
ShapeShading base_shading;
#ifdef USE_LAYERS
ShapeShading coat_shading;
#endif

void shade_shapes(MaterialData material, Surface surface)
{
  base_shading = shape_shading(material, surface);
#ifdef USE_LAYERS
  coat_shading = shape_shading(layers.coat_material, layers.coat_surface);
#endif
}

#ifdef USE_SHADOW
/** Visibility of a lamp that is shaded as a whole. */
float shape_visibility(LightData light, const int lights, LightShape shape, Surface surface, CenterLight center)
{
  if (light.shadow_kind != SHADOW_CUBE && light.shadow_kind != SHADOW_MAP) {
    // It reads neither a cube nor a map. llvmpipe evaluates their lookups all the same, so the short one is given.
    return light_visibility(light, lights, surface, center.to_light, false);
  }
  vec3 axis_x = shape.axis_x_ws;
  vec3 axis_y = shape.axis_y_ws;
  float sun_drop = 0.0;
  if (lights == LIGHTS_WITH_MAPS || light.kind < LIGHT_RECTANGLE) {
    axis_x = any_across(center.to_light) * shape.extent;
    axis_y = cross(center.to_light, axis_x);
  }
  if (lights != LIGHTS_WITH_CUBES && light.kind == LIGHT_SUN) {
    sun_drop = 1.0 - inversesqrt(1.0 + shape.extent * shape.extent);
  }
  if (lights != LIGHTS_WITH_MAPS && light.kind == LIGHT_RECTANGLE) {
    // The taps are on an ellipse. The factor 2 / √3 gives it the second moments of the rectangle.
    axis_x *= 1.1547;
    axis_y *= 1.1547;
  }
  return penumbra_visibility(light, lights, surface, center.to_light, axis_x, axis_y, sun_drop);
}
#endif

/** A lamp in the axes of a shading frame, and its irradiance for a light colour of 1. */
struct ShapeLight {
  FlatLamp lamp;
  float irradiance;
  /** Mean cosine of the incident light. */
  float cosine;
  /** Irradiance divided by that of a sky with the radiance of the lamp. */
  float form_factor;
#ifdef USE_LAYERS
  /** Square of the tangent of half the lamp's angular size; for area lamps, about that of a disk that faces the surface. */
  float tangent_sq;
#endif
};

ShapeLight shape_light(LightData light, const int lights, LightShape shape, Surface surface, ShadingFrame frame, CenterLight center)
{
  ShapeLight result;
  if (lights != LIGHTS_WITH_MAPS && light.kind >= LIGHT_RECTANGLE) {
    FlatLamp lamp = area_lamp(light, shape, frame, surface);
    result.lamp = lamp;
    vec3 flux = flat_flux(lamp.center, lamp.axis_x, lamp.axis_y, lamp.corner_count, vec3(0.0, 0.0, 1.0));
    result.irradiance = lamp.radiance * PI * flux.z;
    result.cosine = clamp(flux.z * inversesqrt(max(dot(flux, flux), 1e-30)), 0.0, 1.0);
    result.form_factor = flux.z;
#ifdef USE_LAYERS
    result.tangent_sq = length(cross(shape.axis_x_ws, shape.axis_y_ws)) / max(center.distance_sq, 1e-9);
#endif
    return result;
  }
  float tangent = round_lamp_tangent(shape.extent, center.distance_sq);
  result.lamp = round_lamp(center.to_light, tangent, center.irradiance, frame);
  float sine_sq = tangent * tangent / (1.0 + tangent * tangent);
  result.cosine = disk_cosine(max(sine_sq, 1e-30), dot(frame.z_ws, center.to_light));
  result.irradiance = center.irradiance * result.cosine;
  result.form_factor = sine_sq * result.cosine;
#ifdef USE_LAYERS
  result.tangent_sq = tangent * tangent;
#endif
  return result;
}

#ifdef USE_MULTISCATTER
/** Radiance towards the viewer of diffuse reflection and of multiple scattering, for a light colour of 1. */
vec3 smooth_of(ShapeLight light, MaterialData material, Surface surface)
{
  LobeAlbedo albedo =
      albedo_over_lamp(albedo_towards(surface, light.cosine), surface.multiscatter.mean, light.form_factor);
  return light.irradiance * smooth_brdf(surface.multiscatter, albedo, material.diffuse, material.specular_f0,
                                        material.specular_f90);
}
#endif

#ifdef USE_LAYERS
/**
 * Specular radiance of the base for a light colour of 1: its lobe towards the centre of the lamp, widened by the lamp's size. The
 * half vectors of a disk of tangent t fill a disk of slopes up to t/2, and a lobe of alpha t/2 has their density at its centre.
 */
vec3 anisotropic_specular_of(ShapeLight light, MaterialData material, Surface surface, vec3 to_light)
{
  vec3 half_vector = direction_or_zero(to_light + surface.view_ws);
  vec3 fresnel = fresnel_schlick(material.specular_f0, material.specular_f90, dot(surface.view_ws, half_vector));
  vec2 alphas = layers.base_lobe.alphas;
  alphas = min(sqrt(alphas * alphas + 0.25 * light.tangent_sq), vec2(1.0));
  return fresnel * (light.irradiance * base_specular_lobe(alphas, surface, to_light, max(light.cosine, 1e-4), half_vector));
}
#endif

/** Radiance towards the viewer from the light \a index, shaded as a whole, W/(sr m²). */
vec3 shape_radiance(int index, const int lights, MaterialData material, Surface surface)
{
  LightData light = light_at(index);
  LightShape shape = shape_at(index);
  CenterLight center = center_light(light, index, lights, surface);
  if (center.irradiance <= 0.0 || center.distance_sq <= 0.0) {
    return vec3(0.0);
  }
  ShapeLight base_light = shape_light(light, lights, shape, surface, base_shading.frame, center);
  float irradiance = base_light.irradiance;
#ifdef USE_LAYERS
  // The lamp may be above the horizon of the coat only.
  ShapeLight coat_light = shape_light(light, lights, shape, layers.coat_surface, coat_shading.frame, center);
  irradiance = max(irradiance, coat_light.irradiance);
#endif
  if (irradiance <= 0.0) {
    return vec3(0.0);
  }
#ifdef USE_SHADOW
  float visibility = shape_visibility(light, lights, shape, surface, center);
#else
  float visibility = light_visibility(light, lights, surface, center.to_light, true);
#endif
  if (visibility <= 0.0) {
    return vec3(0.0);
  }
#ifdef USE_MULTISCATTER
  vec3 radiance = smooth_of(base_light, material, surface);
#else
  vec3 radiance = diffuse_share(material, surface, center.to_light) * base_light.irradiance;
#endif
#ifdef USE_SPECULAR
  vec3 specular = specular_of(base_light.lamp, material, surface, base_shading);
#ifdef USE_LAYERS
  if (layers.base_lobe.alphas.x > layers.base_lobe.alphas.y) {
    specular = anisotropic_specular_of(base_light, material, surface, center.to_light);
  }
#endif
  radiance += specular;
#endif
#ifdef USE_LAYERS
  vec3 coat = specular_of(coat_light.lamp, layers.coat_material, layers.coat_surface, coat_shading);
#ifdef USE_MULTISCATTER
  coat += smooth_of(coat_light, layers.coat_material, layers.coat_surface);
#endif
  // The lobe of sheen is wide, so its value in the mean direction of the lamp is taken for all of the lamp.
  radiance = layered(radiance, base_light.irradiance * sheen_brdf(surface, center.to_light, base_light.cosine), coat);
#endif
  return light.color * visibility * radiance;
}
