// SPDX-License-Identifier: MIT
// Wood: rings around the object's y axis, as in a piece that was cut from a trunk. It needs no uvs.

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

void surface(SurfaceInputs inputs, inout StandardSurface result)
{
  vec3 at = inputs.position_os;
  vec2 bent = at.xz + 0.15 * vec2(noise(2.0 * at), noise(2.0 * at + 7.0));
  float ring = fract(9.0 * length(bent));
  // Late wood is dark and ends with the year.
  float late = smoothstep(0.2, 0.85, ring) * (1.0 - smoothstep(0.9, 1.0, ring));
  float fibre = noise(vec3(60.0 * at.x, 3.0 * at.y, 60.0 * at.z));
  result.base_color = mix(vec3(0.55, 0.30, 0.12), vec3(0.24, 0.10, 0.035), late) * (0.8 + 0.4 * fibre);
  result.metallic = 0.0;
  result.roughness = mix(0.35, 0.55, late);
}
