// SPDX-License-Identifier: MIT
#include "eevee_blocks.hh"

#include "draw_object_shared.h"
#include "draw_view_shared.h"
#include "eevee_esm_shared.h"
#include "eevee_light_cluster_shared.h"
#include "eevee_light_shared.h"
#include "eevee_material_shared.h"
#include "eevee_shadow_shared.h"
#include "eevee_surface_function_shared.h"
#include "eevee_world_shared.h"

#include <array>

namespace gnomon::eevee {

namespace {

using namespace shared;
using Field = gpu::BlockLayout::Field;

/** A member of a block, which has the same name in GLSL after \a prefix. */
#define FIELD(prefix, Block, member) Field({prefix #member, offsetof(Block, member)})

constexpr auto view_fields = std::to_array<Field>({
    FIELD("view.", ViewData, clip_from_world),
    FIELD("view.", ViewData, position_ws),
    FIELD("view.", ViewData, is_perspective),
    FIELD("view.", ViewData, back_ws),
    FIELD("view.", ViewData, texture_lod_bias),
    FIELD("view.", ViewData, depth_origin_ws),
    FIELD("view.", ViewData, depth_origin),
    FIELD("view.", ViewData, place_middle),
    FIELD("view.", ViewData, mask_shift),
    FIELD("view.", ViewData, place_right),
    FIELD("view.", ViewData, place_up),
    FIELD("view.", ViewData, clip_planes),
});

constexpr auto object_fields = std::to_array<Field>({
    FIELD("objects[0].", ObjectData, world_from_object),
    FIELD("objects[0].", ObjectData, normal_x),
    FIELD("objects[0].", ObjectData, index),
    FIELD("objects[0].", ObjectData, normal_y),
    FIELD("objects[0].", ObjectData, normal_z),
    FIELD("objects[0].", ObjectData, value),
});

constexpr auto material_fields = std::to_array<Field>({
    FIELD("materials[0].", MaterialData, diffuse),
    FIELD("materials[0].", MaterialData, alpha),
    FIELD("materials[0].", MaterialData, specular_f0),
    FIELD("materials[0].", MaterialData, specular_f90),
    FIELD("materials[0].", MaterialData, emissive),
    FIELD("materials[0].", MaterialData, mask_cutoff),
    FIELD("materials[0].", MaterialData, metal_f0),
    FIELD("materials[0].", MaterialData, occlusion),
});

constexpr auto full_material_fields = std::to_array<Field>({
    FIELD("full_materials[0].", FullMaterialData, base_color),
    FIELD("full_materials[0].", FullMaterialData, metallic),
    FIELD("full_materials[0].", FullMaterialData, specular_color),
    FIELD("full_materials[0].", FullMaterialData, specular),
    FIELD("full_materials[0].", FullMaterialData, emissive),
    FIELD("full_materials[0].", FullMaterialData, roughness),
    FIELD("full_materials[0].", FullMaterialData, normal_scale),
    FIELD("full_materials[0].", FullMaterialData, occlusion_strength),
    FIELD("full_materials[0].", FullMaterialData, inputs),
    FIELD("full_materials[0].", FullMaterialData, opacity),
    FIELD("full_materials[0].", FullMaterialData, uv_rows),
});

constexpr auto layer_fields = std::to_array<Field>({
    FIELD("layer_materials[0].", LayerData, sheen_color),
    FIELD("layer_materials[0].", LayerData, sheen_roughness),
    FIELD("layer_materials[0].", LayerData, coat),
    FIELD("layer_materials[0].", LayerData, coat_roughness),
    FIELD("layer_materials[0].", LayerData, transmission),
    FIELD("layer_materials[0].", LayerData, thickness),
    FIELD("layer_materials[0].", LayerData, absorption),
    FIELD("layer_materials[0].", LayerData, ior),
    FIELD("layer_materials[0].", LayerData, anisotropy),
    FIELD("layer_materials[0].", LayerData, coat_normal_scale),
    FIELD("layer_materials[0].", LayerData, uv_rows),
});

constexpr auto light_fields = std::to_array<Field>({
    FIELD("light_data.", LightBlock, light_count),
    FIELD("light_data.", LightBlock, cube_light_count),
    FIELD("light_data.", LightBlock, surface_point_count),
    FIELD("light_data.", LightBlock, _pad0),
    FIELD("light_data.", LightBlock, lights[0].position_ws),
    FIELD("light_data.", LightBlock, lights[0].kind),
    FIELD("light_data.", LightBlock, lights[0].color),
    FIELD("light_data.", LightBlock, lights[0].radius_sq),
    FIELD("light_data.", LightBlock, lights[0].forward_ws),
    FIELD("light_data.", LightBlock, lights[0].range_inv_sq),
    FIELD("light_data.", LightBlock, lights[0].spot_drop_outer),
    FIELD("light_data.", LightBlock, lights[0].spot_inv_width),
    FIELD("light_data.", LightBlock, lights[0].shadow_kind),
    FIELD("light_data.", LightBlock, lights[0].shadow_index),
});

constexpr auto light_shape_fields = std::to_array<Field>({
    FIELD("light_shapes.", LightShapeBlock, shapes[0].axis_x_ws),
    FIELD("light_shapes.", LightShapeBlock, shapes[0].extent),
    FIELD("light_shapes.", LightShapeBlock, shapes[0].axis_y_ws),
    FIELD("light_shapes.", LightShapeBlock, shapes[0].highlight_points_share),
    FIELD("light_shapes.", LightShapeBlock, shapes[0].center_ws),
    FIELD("light_shapes.", LightShapeBlock, shapes[0].highlight_extent),
});

constexpr auto light_cluster_fields = std::to_array<Field>({
    FIELD("clusters.", LightClusterBlock, grid_from_world),
    FIELD("clusters.", LightClusterBlock, slice_scale),
    FIELD("clusters.", LightClusterBlock, slice_bias),
    FIELD("clusters.", LightClusterBlock, is_perspective),
    FIELD("clusters.", LightClusterBlock, column_count),
    FIELD("clusters.", LightClusterBlock, row_count),
    FIELD("clusters.", LightClusterBlock, slice_count),
    FIELD("clusters.", LightClusterBlock, cube_light_count),
    FIELD("clusters.", LightClusterBlock, cube_everywhere_count),
    FIELD("clusters.", LightClusterBlock, other_everywhere_count),
    FIELD("clusters.", LightClusterBlock, surface_point_count),
    FIELD("clusters.", LightClusterBlock, first_surface_point),
    FIELD("clusters.", LightClusterBlock, _pad0),
});

constexpr auto world_fields = std::to_array<Field>({
    FIELD("world.", WorldBlock, harmonics),
    FIELD("world.", WorldBlock, sample_count),
    FIELD("world.", WorldBlock, alpha_sampled),
    FIELD("world.", WorldBlock, first_sun),
    FIELD("world.", WorldBlock, sun_count),
    FIELD("world.", WorldBlock, sun_points[0].to_world),
    FIELD("world.", WorldBlock, sun_points[0]._pad0),
    FIELD("world.", WorldBlock, sun_points[0].irradiance),
    FIELD("world.", WorldBlock, sun_points[0]._pad1),
    FIELD("world.", WorldBlock, probe_count),
    FIELD("world.", WorldBlock, probe_scale),
    FIELD("world.", WorldBlock, probe_offset),
    FIELD("world.", WorldBlock, whole_positive),
    FIELD("world.", WorldBlock, whole_negative),
    FIELD("world.", WorldBlock, probes),
});

constexpr auto shadow_fields = std::to_array<Field>({
    FIELD("shadow.", ShadowBlock, cubes[0].near),
    FIELD("shadow.", ShadowBlock, cubes[0].far),
    FIELD("shadow.", ShadowBlock, cubes[0].texel_size),
    FIELD("shadow.", ShadowBlock, cubes[0].bias),
    FIELD("shadow.", ShadowBlock, cubes[0].layers),
    FIELD("shadow.", ShadowBlock, cubes[0].faces_and_filter),
    FIELD("shadow.", ShadowBlock, cubes[0].crop),
    FIELD("shadow.", ShadowBlock, cubes[0].size_px),
    FIELD("shadow.", ShadowBlock, maps[0].texco_from_world),
    FIELD("shadow.", ShadowBlock, maps[0].texel_size),
    FIELD("shadow.", ShadowBlock, maps[0].rounding),
    FIELD("shadow.", ShadowBlock, maps[0].far),
    FIELD("shadow.", ShadowBlock, maps[0].bias),
    FIELD("shadow.", ShadowBlock, maps[0].layer),
    FIELD("shadow.", ShadowBlock, maps[0].cascade_count),
    FIELD("shadow.", ShadowBlock, maps[0].filter_kind),
    FIELD("shadow.", ShadowBlock, maps[0].size_px),
});

constexpr auto shadow_render_fields = std::to_array<Field>({
    FIELD("shadow_render.", ShadowRenderBlock, clip_from_world),
    FIELD("shadow_render.", ShadowRenderBlock, size_px),
    FIELD("shadow_render.", ShadowRenderBlock, _pad0),
    FIELD("shadow_render.", ShadowRenderBlock, _pad1),
    FIELD("shadow_render.", ShadowRenderBlock, _pad2),
});

constexpr auto esm_fields = std::to_array<Field>({
    FIELD("esm.", EsmBlock, lamps[0].exponent),
    FIELD("esm.", EsmBlock, lamps[0].bias),
    FIELD("esm.", EsmBlock, lamps[0].range),
    FIELD("esm.", EsmBlock, lamps[0].filter_angle),
    FIELD("esm.", EsmBlock, lamps[0].size),
    FIELD("esm.", EsmBlock, lamps[0].layer),
    FIELD("esm.", EsmBlock, lamps[0].format),
    FIELD("esm.", EsmBlock, lamps[0]._pad0),
});

constexpr auto surface_function_fields = std::to_array<Field>({
    FIELD("surface_function.", SurfaceFunctionData, origin_ws),
    FIELD("surface_function.", SurfaceFunctionData, emission),
});

constexpr std::array<gpu::BlockLayout, 13> layouts = {{
    {"view_block", sizeof(ViewData), view_fields},
    {"object_block", sizeof(ObjectData), object_fields},
    {"material_block", sizeof(MaterialData), material_fields},
    {"full_material_block", sizeof(FullMaterialData), full_material_fields},
    {"layer_block", sizeof(LayerData), layer_fields},
    {"light_block", sizeof(LightBlock), light_fields},
    {"light_shape_block", sizeof(LightShapeBlock), light_shape_fields},
    {"light_cluster_block", sizeof(LightClusterBlock), light_cluster_fields},
    {"world_block", sizeof(WorldBlock), world_fields},
    {"shadow_block", sizeof(ShadowBlock), shadow_fields},
    {"shadow_render_block", sizeof(ShadowRenderBlock), shadow_render_fields},
    {"esm_block", sizeof(EsmBlock), esm_fields},
    {"surface_function_block", sizeof(SurfaceFunctionData), surface_function_fields},
}};

#undef FIELD

}  // namespace

std::span<const gpu::BlockLayout> block_layouts()
{
  return layouts;
}

}  // namespace gnomon::eevee
