// SPDX-License-Identifier: MIT
// Highlights of lamps with an extent in a picture with several samples. Included by eevee_light_lib.glsl, after what both read.
//
// Each sample shades one point of the lamp. A narrow lobe, which contains few of all points, would show each of them as a spot.
// Narrow lobes reflect the whole lamp instead, in closed form, times the visibility of the point (Heitz, Hill and McGuire 2018).
// Fewer lobes count as narrow if there are more samples, so that pictures converge.

/**
 * Anisotropic lobes have no closed form. They are widened to at least this part of HighlightLamp::alpha_points: to a lobe that
 * contains 12 points.
 */
const float ANISOTROPIC_ALPHA_PART = 0.433;

/** A whole lamp as the lobes of a surface see it. */
struct HighlightLamp {
  /** The light, at the centre of the lamp. */
  LightData light;
  LightShape shape;
  CenterLight center;
  /** Least alpha of a lobe that contains HIGHLIGHT_LOBE_POINTS points. 0: the lamp has no extent. */
  float alpha_points;
};

HighlightLamp highlight_lamp(LightData light, int index, const int lights, Surface surface)
{
  HighlightLamp lamp;
  lamp.shape = shape_at(index);
  lamp.light = light;
  lamp.light.position_ws = lamp.shape.center_ws;
  lamp.shape.extent = lamp.shape.highlight_extent;
  bool is_area = light.kind == LIGHT_RECTANGLE || light.kind == LIGHT_ELLIPSE;
  float solid_angle;
  if (lights != LIGHTS_WITH_CUBES && light.kind == LIGHT_SUN) {
    lamp.light.forward_ws = -lamp.shape.center_ws;
  }
  lamp.center = center_light(lamp.light, index, lights, surface);
  if (lights != LIGHTS_WITH_MAPS && is_area) {
    float area = flat_lamp_area(lamp.shape.axis_x_ws, lamp.shape.axis_y_ws, light.kind == LIGHT_RECTANGLE);
    solid_angle = flat_lamp_solid_angle(area * max(-dot(lamp.center.to_light, light.forward_ws), 0.0), lamp.center.distance_sq);
  }
  else {
    solid_angle = round_lamp_solid_angle(round_lamp_tangent(lamp.shape.extent, lamp.center.distance_sq));
  }
  lamp.alpha_points = lamp.shape.extent > 0.0 ? highlight_alpha(lamp.shape.highlight_points_share, solid_angle) : 0.0;
  return lamp;
}

/** Part of a lobe of \a alpha that reflects the whole lamp; the rest reflects the point. */
float whole_lamp_share(HighlightLamp lamp, float alpha)
{
  return lamp.alpha_points > 0.0 ? 1.0 - smoothstep(0.7, 1.0, alpha / lamp.alpha_points) : 0.0;
}

/** Part of a lamp's points that are above the horizon z = 0, in [0, 1]. */
float part_above(FlatLamp lamp)
{
  float x = abs(lamp.axis_x.z);
  float y = abs(lamp.axis_y.z);
  float height = lamp.center.z;
  if (lamp.corner_count == RECTANGLE_CORNERS) {
    // The part of the rectangle above the horizon, from squares of its corners' heights. They cancel if an axis is parallel to the
    // horizon, therefore both axes have a least length.
    float least = max(1e-3 * (x + y), 1e-20);
    x = max(x, least);
    y = max(y, least);
    vec4 sums = max(vec4(height) + vec4(x + y, x - y, y - x, -x - y), vec4(0.0)) / (x + y);
    sums *= sums;
    return clamp((sums.x - sums.y - sums.z + sums.w) * (x + y) * (x + y) / (8.0 * x * y), 0.0, 1.0);
  }
  float t = clamp(height * inversesqrt(max(x * x + y * y, 1e-30)), -1.0, 1.0);
  float chord = sqrt((1.0 - t) * (1.0 + t));
  return 0.5 + INV_PI * (atan(t, chord) + t * chord);
}

/**
 * Specular radiance towards the viewer from the whole lamp, times \a share, without a shadow, W/(sr m²). \a cos_l: cosine of the light
 * from the sampled point. Points below the horizon have no visibility; the other points represent them.
 */
vec3 lamp_highlight(HighlightLamp lamp, MaterialData material, Surface surface, ShapeShading shading, float share, float cos_l)
{
  FlatLamp flat_lamp;
  float scale = share;
  if (lamp.light.kind >= LIGHT_RECTANGLE) {
    flat_lamp = area_lamp(lamp.light, lamp.shape, shading.frame, surface);
    float ratio = lamp.center.distance_sq * lamp.light.range_inv_sq;
    scale *= lamp.center.irradiance > 0.0 ? max(1.0 - ratio * ratio, 0.0) : 0.0;
  }
  else {
    float tangent = round_lamp_tangent(lamp.shape.extent, lamp.center.distance_sq);
    flat_lamp = round_lamp(lamp.center.to_light, tangent, lamp.center.irradiance, shading.frame);
    // A point of a sun has a colour for the irradiance of the cone on a surface that faces its middle.
    scale *= lamp.light.kind == LIGHT_SUN ? 0.5 + 0.5 * inversesqrt(1.0 + tangent * tangent) : 1.0;
  }
  float above = part_above(flat_lamp);
  // llvmpipe evaluates the code below for all pixels, and skips the loop over the corners where no pixel needs it.
  flat_lamp.corner_count = share > 0.0 ? flat_lamp.corner_count : 0;
  vec3 specular = specular_of(flat_lamp, material, surface, shading);
  scale *= cos_l > 0.0 ? 1.0 / max(above, 1e-3) : 0.0;
  return share > 0.0 ? lamp.light.color * specular * scale : vec3(0.0);
}
