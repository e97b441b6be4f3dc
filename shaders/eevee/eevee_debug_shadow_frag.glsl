#version 450 core
// SPDX-License-Identifier: MIT
// Picture of a lamp's shadow layers: near is dark, far is bright, and texels without a distance have a colour.
#include "shared/eevee_depth_shared.h"
#include "shared/eevee_esm_shared.h"
#include "shared/slots_shared.h"

layout(binding = SHADOW_LAYERS_SLOT) uniform sampler2DArray shadow_layers;

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** Distances of depths 1 and 0, metres, for each cascade. The first is used for all faces. */
  vec4 near;
  vec4 far;
  /** Change of both distances from the left to the right edge, and from the lower to the upper one. */
  vec4 tilt_x;
  vec4 tilt_y;
  /** Distances that are shown as black and white, metres. */
  vec2 shown;
  /** PROJECTION_… of the depths. */
  int projection;
  /** ESM_… for filtered distances up to `far`; -1 for depths. */
  int esm_format;
  int first_layer;
  /** Bit i: layer i of the shadow is in shadow_layers, where these layers follow each other. */
  int placed;
  /** Bit i: layer i of the shadow was drawn. */
  int drawn;
  /** Edge of a layer without its border, texels. */
  int size_px;
  /** Width of the border, texels. */
  int border;
  /** Edge of a layer in the picture, pixels. */
  int cell_px;
  /** Index of the leftmost layer in the picture, within the shadow. */
  int first_shown;
  /** 1: cube faces, whose first row is at the top. */
  int is_cube;
  /** 1: all six faces as a cross, four wide and three high. */
  int is_cross;
};

/** rgb: display-referred colour. a: distance in metres; 0 for texels without one. */
layout(location = 0) out vec4 picture;

/** Faces of the unfolded cube, seen from outside, rows from the bottom. -1: none. */
const int CROSS[12] = int[12](-1, 3, -1, -1, 1, 4, 0, 5, -1, 2, -1, -1);

const vec3 OUTSIDE = vec3(0.0);
/** The layer was not drawn: it contains no caster, or no visible receiver looks it up. */
const vec3 NOT_DRAWN = vec3(0.35, 0.06, 0.06);
const vec3 CLEARED = vec3(0.08, 0.16, 0.45);
/** Brightness of the nearest distance, to distinguish it from OUTSIDE. */
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
  float stored = texelFetch(shadow_layers, ivec3(texel + border, first_layer + bitCount(placed & ((1 << layer) - 1))), 0).r;
  int range = is_cube != 0 ? 0 : min(layer, 3);
  float distance = esm_format >= 0 ? esm_decoded(stored, far[range], esm_format) :
                                     distance_of_depth(stored, near[range], far[range], projection);
  distance += dot(vec2(tilt_x[range], tilt_y[range]), (vec2(texel) + 0.5) / float(size_px));
  // A filtered value of cleared texels only is not exactly `far`, because it is rounded.
  bool is_cleared = esm_format >= 0 ? distance >= 0.9999 * far[range] : stored <= 0.0;
  float share = clamp((distance - shown.x) / max(shown.y - shown.x, 1e-30), 0.0, 1.0);
  if (projection != PROJECTION_ORTHOGRAPHIC) {
    // Around a lamp, most surfaces are near, so the scale is a square root.
    share = sqrt(max(share, 0.0));
  }
  picture = is_cleared ? vec4(CLEARED, 0.0) : vec4(vec3(mix(DARKEST, 1.0, share)), distance);
}
