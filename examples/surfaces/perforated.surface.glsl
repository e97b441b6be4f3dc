// SPDX-License-Identifier: MIT
// A perforated sheet: round holes in the rows of a honeycomb. The material's alpha mode is MASK, so that light and
// shadow pass the holes.

void surface(SurfaceInputs inputs, inout StandardSurface result)
{
  // Two grids of rectangles hold all middles; the nearer one counts.
  const vec2 cell = vec2(1.0, 1.7320508);
  vec2 at = inputs.uv * 14.0;
  vec2 a = mod(at, cell) - 0.5 * cell;
  vec2 b = mod(at + 0.5 * cell, cell) - 0.5 * cell;
  float from_middle = min(length(a), length(b));
  result.alpha = from_middle < 0.33 ? 0.0 : 1.0;
  // The edges are bent inwards and are darker.
  float edge = 1.0 - smoothstep(0.33, 0.40, from_middle);
  result.base_color = mix(vec3(0.80, 0.81, 0.83), vec3(0.35), edge);
  result.metallic = 1.0;
  result.roughness = 0.3 + 0.2 * edge;
}
