// SPDX-License-Identifier: MIT
// The lights that can reach a point, from the list of its froxel.
#include "shared/eevee_light_cluster_shared.h"
#include "shared/slots_shared.h"

layout(std140, binding = LIGHT_CLUSTER_BLOCK_SLOT) uniform light_cluster_block
{
  LightClusterBlock clusters;
};
layout(binding = LIGHT_TEXTURE_SLOT) uniform samplerBuffer light_texture;
/**
 * For each froxel, the index of its first entry and the number of its entries whose shadows may be cubes; the index after the
 * last entry; then the entries: indices of lights, ascending in each froxel.
 */
layout(binding = LIGHT_LISTS_SLOT) uniform samplerBuffer light_lists;

int light_list_value(int index)
{
  return int(texelFetch(light_lists, index).r);
}

/** Texel \a texel of the light \a index. */
vec4 light_texel(int index, int texel)
{
  return texelFetch(light_texture, LIGHT_TEXELS * index + texel);
}

/** The lights that can reach a point: those that reach everywhere, and those in the list of its froxel. */
struct ReachingLights {
  int list_first;
  /** Lights whose shadows may be cubes. They are the first. */
  int cube_count;
  int count;
};

/** \see find_lights */
ReachingLights reaching;

/** Sets the lights that can reach a point, for reaching_light. */
void find_lights(vec3 position_ws)
{
  int header = 2 * light_froxel(clusters, position_ws);
  int first = light_list_value(header);
  int listed_cubes = light_list_value(header + 1);
  int listed = light_list_value(header + 2) - first;
  int everywhere = clusters.cube_everywhere_count + clusters.other_everywhere_count;
  reaching = ReachingLights(first, clusters.cube_everywhere_count + listed_cubes, everywhere + listed);
}

/** Index of the \a i-th of the lights that can reach the point. The indices ascend. \a is_cube: i is less than cube_count. */
int reaching_light(int i, bool is_cube)
{
  int in_group = is_cube ? i : i - reaching.cube_count;
  int everywhere = is_cube ? clusters.cube_everywhere_count : clusters.other_everywhere_count;
  if (in_group < everywhere) {
    return (is_cube ? 0 : clusters.cube_light_count) + in_group;
  }
  return light_list_value(reaching.list_first + i - clusters.cube_everywhere_count - (is_cube ? 0 : everywhere));
}
