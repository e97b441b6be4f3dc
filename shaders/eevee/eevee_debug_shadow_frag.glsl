#version 450 core
// SPDX-License-Identifier: MIT
// Layers of a lamp's shadow for people to look at: near dark, far bright, and what holds no distance in a colour.
#include "shared/eevee_depth_shared.h"
#include "shared/eevee_esm_shared.h"
#include "shared/slots_shared.h"

layout(binding = SHADOW_LAYERS_SLOT) uniform sampler2DArray shadow_layers;

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** Of a cascade, or, the first, of all faces: distances that depths 1 and 0 stand for, metres. */
  vec4 near;
  vec4 far;
  /** Distances that are black and white, metres. */
  vec2 shown;
  /** PROJECTION_…, of depths. */
  int projection;
  /** ESM_…, of filtered distances up to `far`; -1: depths. */
  int esm_format;
  int first_layer;
  /** Bit i: layer i of the shadow was drawn. */
  int drawn;
  /** Edge of a layer, texels, from `border` on; and of its picture, pixels. */
  int size_px;
  int border;
  int cell_px;
  /** Of the shadow, on the left. */
  int first_shown;
  /** Images of a cube's face have their first row above. */
  int is_cube;
  /** All six of them, four wide and three high. */
  int is_cross;
};

/** rgb: to look at, display-referred; a: metres, 0 where nothing is stored. */
layout(location = 0) out vec4 picture;

/** The box unfolded, seen from outside, rows from below. -1: nothing. */
const int CROSS[12] = int[12](-1, 3, -1, -1, 1, 4, 0, 5, -1, 2, -1, -1);

const vec3 OUTSIDE = vec3(0.0);
/** No caster is in it, or nothing that is seen looks there. */
const vec3 NOT_DRAWN = vec3(0.35, 0.06, 0.06);
const vec3 CLEARED = vec3(0.08, 0.16, 0.45);
/** So that near is not outside. */
const float DARKEST = 0.1;

void main()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 cell = pixel / cell_px;
  int layer = is_cross != 0 ? CROSS[min(4 * cell.y + cell.x, 11)] : first_shown + cell.x;
  if (layer < 0) {
    picture = vec4(OUTSIDE, 0.0);
    return;
  }
  if ((drawn >> layer & 1) == 0) {
    picture = vec4(NOT_DRAWN, 0.0);
    return;
  }
  ivec2 texel = ivec2((vec2(pixel - cell * cell_px) + 0.5) * (float(size_px) / float(cell_px)));
  texel = clamp(texel, ivec2(0), ivec2(size_px - 1));
  if (is_cube != 0) {
    texel.y = size_px - 1 - texel.y;
  }
  float stored = texelFetch(shadow_layers, ivec3(texel + border, first_layer + layer), 0).r;
  int range = is_cube != 0 ? 0 : min(layer, 3);
  float distance = esm_format >= 0 ? esm_decoded(stored, far[range], esm_format) :
                                     distance_of_depth(stored, near[range], far[range], projection);
  // What was filtered among nothing but cleared texels is rounded.
  bool is_cleared = esm_format >= 0 ? distance >= 0.9999 * far[range] : stored <= 0.0;
  float share = clamp((distance - shown.x) / max(shown.y - shown.x, 1e-30), 0.0, 1.0);
  if (projection != PROJECTION_ORTHOGRAPHIC) {
    // Around a lamp most of what is seen is near.
    share = sqrt(max(share, 0.0));
  }
  picture = is_cleared ? vec4(CLEARED, 0.0) : vec4(vec3(mix(DARKEST, 1.0, share)), distance);
}
