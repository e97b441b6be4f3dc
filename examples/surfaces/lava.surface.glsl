// SPDX-License-Identifier: MIT
// Lava: a crust with cracks that glow. The pattern is fixed in the world, so objects that move pass through it.

float hash(ivec3 cell)
{
  uvec3 n = uvec3(cell) * uvec3(1597334673u, 3812015801u, 2798796415u);
  return float((n.x ^ n.y ^ n.z) * 1597334673u) / 4294967295.0;
}

/** Smooth noise in [0, 1]. */
float noise(vec3 at)
{
  vec3 low = floor(at);
  ivec3 cell = ivec3(low);
  vec3 t = at - low;
  t = t * t * (3.0 - 2.0 * t);
  float sum = 0.0;
  for (int i = 0; i < 8; i++) {
    ivec3 corner = ivec3(i & 1, (i >> 1) & 1, i >> 2);
    vec3 weight = mix(1.0 - t, t, vec3(corner));
    sum += weight.x * weight.y * weight.z * hash(cell + corner);
  }
  return sum;
}

float turbulence(vec3 at)
{
  return (4.0 * noise(at) + 2.0 * noise(2.1 * at) + noise(4.3 * at)) / 7.0;
}

void surface(SurfaceInputs inputs, inout StandardSurface result)
{
  vec3 at = 2.5 * inputs.position_ws;
  float height = turbulence(at);
  // Cracks are where the noise passes its middle.
  float crack = 1.0 - smoothstep(0.0, 0.06, abs(height - 0.5));
  const float step_m = 0.05;
  vec3 slope = vec3(turbulence(at + vec3(step_m, 0, 0)), turbulence(at + vec3(0, step_m, 0)),
                    turbulence(at + vec3(0, 0, step_m)));
  slope = (slope - height) / step_m;
  result.normal_ws -= 0.6 * (slope - dot(slope, inputs.normal_ws) * inputs.normal_ws);
  result.base_color = vec3(0.03, 0.025, 0.022);
  result.metallic = 0.0;
  result.roughness = 0.8;
  result.emission = crack * mix(vec3(1.2, 0.06, 0.0), vec3(6.0, 1.8, 0.3), crack * crack);
}
