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

constexpr auto view_fields = std::to_array<Field>({
    {"view.clip_from_world", offsetof(ViewData, clip_from_world)},
    {"view.position_ws", offsetof(ViewData, position_ws)},
    {"view.is_perspective", offsetof(ViewData, is_perspective)},
    {"view.back_ws", offsetof(ViewData, back_ws)},
    {"view.texture_lod_bias", offsetof(ViewData, texture_lod_bias)},
    {"view.depth_origin_ws", offsetof(ViewData, depth_origin_ws)},
    {"view.depth_origin", offsetof(ViewData, depth_origin)},
    {"view.place_middle", offsetof(ViewData, place_middle)},
    {"view.mask_shift", offsetof(ViewData, mask_shift)},
    {"view.place_right", offsetof(ViewData, place_right)},
    {"view.place_up", offsetof(ViewData, place_up)},
    {"view.clip_planes", offsetof(ViewData, clip_planes)},
});

constexpr auto object_fields = std::to_array<Field>({
    {"objects[0].world_from_object", offsetof(ObjectData, world_from_object)},
    {"objects[0].normal_x", offsetof(ObjectData, normal_x)},
    {"objects[0].index", offsetof(ObjectData, index)},
    {"objects[0].normal_y", offsetof(ObjectData, normal_y)},
    {"objects[0].normal_z", offsetof(ObjectData, normal_z)},
    {"objects[0].value", offsetof(ObjectData, value)},
});

constexpr auto material_fields = std::to_array<Field>({
    {"materials[0].diffuse", offsetof(MaterialData, diffuse)},
    {"materials[0].alpha", offsetof(MaterialData, alpha)},
    {"materials[0].specular_f0", offsetof(MaterialData, specular_f0)},
    {"materials[0].specular_f90", offsetof(MaterialData, specular_f90)},
    {"materials[0].emissive", offsetof(MaterialData, emissive)},
    {"materials[0].mask_cutoff", offsetof(MaterialData, mask_cutoff)},
    {"materials[0].metal_f0", offsetof(MaterialData, metal_f0)},
    {"materials[0].occlusion", offsetof(MaterialData, occlusion)},
});

constexpr auto full_material_fields = std::to_array<Field>({
    {"full_materials[0].base_color", offsetof(FullMaterialData, base_color)},
    {"full_materials[0].metallic", offsetof(FullMaterialData, metallic)},
    {"full_materials[0].specular_color", offsetof(FullMaterialData, specular_color)},
    {"full_materials[0].specular", offsetof(FullMaterialData, specular)},
    {"full_materials[0].emissive", offsetof(FullMaterialData, emissive)},
    {"full_materials[0].roughness", offsetof(FullMaterialData, roughness)},
    {"full_materials[0].normal_scale", offsetof(FullMaterialData, normal_scale)},
    {"full_materials[0].occlusion_strength", offsetof(FullMaterialData, occlusion_strength)},
    {"full_materials[0].inputs", offsetof(FullMaterialData, inputs)},
    {"full_materials[0].opacity", offsetof(FullMaterialData, opacity)},
    {"full_materials[0].uv_rows", offsetof(FullMaterialData, uv_rows)},
});

constexpr auto layer_fields = std::to_array<Field>({
    {"layer_materials[0].sheen_color", offsetof(LayerData, sheen_color)},
    {"layer_materials[0].sheen_roughness", offsetof(LayerData, sheen_roughness)},
    {"layer_materials[0].coat", offsetof(LayerData, coat)},
    {"layer_materials[0].coat_roughness", offsetof(LayerData, coat_roughness)},
    {"layer_materials[0].transmission", offsetof(LayerData, transmission)},
    {"layer_materials[0].thickness", offsetof(LayerData, thickness)},
    {"layer_materials[0].absorption", offsetof(LayerData, absorption)},
    {"layer_materials[0].ior", offsetof(LayerData, ior)},
    {"layer_materials[0].anisotropy", offsetof(LayerData, anisotropy)},
    {"layer_materials[0].coat_normal_scale", offsetof(LayerData, coat_normal_scale)},
    {"layer_materials[0].uv_rows", offsetof(LayerData, uv_rows)},
});

constexpr std::size_t lights_offset = offsetof(LightBlock, lights);
constexpr auto light_fields = std::to_array<Field>({
    {"light_data.light_count", offsetof(LightBlock, light_count)},
    {"light_data.cube_light_count", offsetof(LightBlock, cube_light_count)},
    {"light_data._pad0", offsetof(LightBlock, _pad0)},
    {"light_data._pad1", offsetof(LightBlock, _pad1)},
    {"light_data.lights[0].position_ws", lights_offset + offsetof(LightData, position_ws)},
    {"light_data.lights[0].kind", lights_offset + offsetof(LightData, kind)},
    {"light_data.lights[0].color", lights_offset + offsetof(LightData, color)},
    {"light_data.lights[0].radius_sq", lights_offset + offsetof(LightData, radius_sq)},
    {"light_data.lights[0].forward_ws", lights_offset + offsetof(LightData, forward_ws)},
    {"light_data.lights[0].range_inv_sq", lights_offset + offsetof(LightData, range_inv_sq)},
    {"light_data.lights[0].spot_drop_outer", lights_offset + offsetof(LightData, spot_drop_outer)},
    {"light_data.lights[0].spot_inv_width", lights_offset + offsetof(LightData, spot_inv_width)},
    {"light_data.lights[0].shadow_kind", lights_offset + offsetof(LightData, shadow_kind)},
    {"light_data.lights[0].shadow_index", lights_offset + offsetof(LightData, shadow_index)},
});

constexpr auto light_shape_fields = std::to_array<Field>({
    {"light_shapes.shapes[0].axis_x_ws", offsetof(LightShape, axis_x_ws)},
    {"light_shapes.shapes[0].extent", offsetof(LightShape, extent)},
    {"light_shapes.shapes[0].axis_y_ws", offsetof(LightShape, axis_y_ws)},
    {"light_shapes.shapes[0].highlight_points_share", offsetof(LightShape, highlight_points_share)},
    {"light_shapes.shapes[0].center_ws", offsetof(LightShape, center_ws)},
    {"light_shapes.shapes[0].highlight_extent", offsetof(LightShape, highlight_extent)},
});

constexpr auto light_cluster_fields = std::to_array<Field>({
    {"clusters.grid_from_world", offsetof(LightClusterBlock, grid_from_world)},
    {"clusters.slice_scale", offsetof(LightClusterBlock, slice_scale)},
    {"clusters.slice_bias", offsetof(LightClusterBlock, slice_bias)},
    {"clusters.is_perspective", offsetof(LightClusterBlock, is_perspective)},
    {"clusters.column_count", offsetof(LightClusterBlock, column_count)},
    {"clusters.row_count", offsetof(LightClusterBlock, row_count)},
    {"clusters.slice_count", offsetof(LightClusterBlock, slice_count)},
    {"clusters.cube_light_count", offsetof(LightClusterBlock, cube_light_count)},
    {"clusters.cube_everywhere_count", offsetof(LightClusterBlock, cube_everywhere_count)},
    {"clusters.other_everywhere_count", offsetof(LightClusterBlock, other_everywhere_count)},
    {"clusters._pad0", offsetof(LightClusterBlock, _pad0)},
    {"clusters._pad1", offsetof(LightClusterBlock, _pad1)},
    {"clusters._pad2", offsetof(LightClusterBlock, _pad2)},
});

constexpr std::size_t sun_points_offset = offsetof(WorldBlock, sun_points);
constexpr auto world_fields = std::to_array<Field>({
    {"world.harmonics", offsetof(WorldBlock, harmonics)},
    {"world.sample_count", offsetof(WorldBlock, sample_count)},
    {"world.alpha_sampled", offsetof(WorldBlock, alpha_sampled)},
    {"world.first_sun", offsetof(WorldBlock, first_sun)},
    {"world.sun_count", offsetof(WorldBlock, sun_count)},
    {"world.sun_points[0].to_world", sun_points_offset + offsetof(WorldSunPoint, to_world)},
    {"world.sun_points[0]._pad0", sun_points_offset + offsetof(WorldSunPoint, _pad0)},
    {"world.sun_points[0].irradiance", sun_points_offset + offsetof(WorldSunPoint, irradiance)},
    {"world.sun_points[0]._pad1", sun_points_offset + offsetof(WorldSunPoint, _pad1)},
    {"world.probe_count", offsetof(WorldBlock, probe_count)},
    {"world.probe_scale", offsetof(WorldBlock, probe_scale)},
    {"world.probe_offset", offsetof(WorldBlock, probe_offset)},
    {"world.whole_positive", offsetof(WorldBlock, whole_positive)},
    {"world.whole_negative", offsetof(WorldBlock, whole_negative)},
    {"world.probes", offsetof(WorldBlock, probes)},
});

constexpr std::size_t maps_offset = offsetof(ShadowBlock, maps);
constexpr auto shadow_fields = std::to_array<Field>({
    {"shadow.cubes[0].near", offsetof(ShadowCubeData, near)},
    {"shadow.cubes[0].far", offsetof(ShadowCubeData, far)},
    {"shadow.cubes[0].texel_size", offsetof(ShadowCubeData, texel_size)},
    {"shadow.cubes[0].bias", offsetof(ShadowCubeData, bias)},
    {"shadow.cubes[0].layer", offsetof(ShadowCubeData, layer)},
    {"shadow.cubes[0].faces_and_filter", offsetof(ShadowCubeData, faces_and_filter)},
    {"shadow.cubes[0].crop", offsetof(ShadowCubeData, crop)},
    {"shadow.cubes[0].size_px", offsetof(ShadowCubeData, size_px)},
    {"shadow.maps[0].texco_from_world", maps_offset + offsetof(ShadowMapData, texco_from_world)},
    {"shadow.maps[0].texel_size", maps_offset + offsetof(ShadowMapData, texel_size)},
    {"shadow.maps[0].rounding", maps_offset + offsetof(ShadowMapData, rounding)},
    {"shadow.maps[0].far", maps_offset + offsetof(ShadowMapData, far)},
    {"shadow.maps[0].bias", maps_offset + offsetof(ShadowMapData, bias)},
    {"shadow.maps[0].layer", maps_offset + offsetof(ShadowMapData, layer)},
    {"shadow.maps[0].cascade_count", maps_offset + offsetof(ShadowMapData, cascade_count)},
    {"shadow.maps[0].filter_kind", maps_offset + offsetof(ShadowMapData, filter_kind)},
    {"shadow.maps[0].size_px", maps_offset + offsetof(ShadowMapData, size_px)},
});

constexpr auto shadow_render_fields = std::to_array<Field>({
    {"shadow_render.clip_from_world", offsetof(ShadowRenderBlock, clip_from_world)},
    {"shadow_render.size_px", offsetof(ShadowRenderBlock, size_px)},
    {"shadow_render._pad0", offsetof(ShadowRenderBlock, _pad0)},
    {"shadow_render._pad1", offsetof(ShadowRenderBlock, _pad1)},
    {"shadow_render._pad2", offsetof(ShadowRenderBlock, _pad2)},
});

constexpr auto esm_fields = std::to_array<Field>({
    {"esm.lamps[0].exponent", offsetof(EsmData, exponent)},
    {"esm.lamps[0].bias", offsetof(EsmData, bias)},
    {"esm.lamps[0].range", offsetof(EsmData, range)},
    {"esm.lamps[0].filter_angle", offsetof(EsmData, filter_angle)},
    {"esm.lamps[0].size", offsetof(EsmData, size)},
    {"esm.lamps[0].layer", offsetof(EsmData, layer)},
    {"esm.lamps[0].format", offsetof(EsmData, format)},
    {"esm.lamps[0]._pad0", offsetof(EsmData, _pad0)},
});

constexpr auto surface_function_fields = std::to_array<Field>({
    {"surface_function.origin_ws", offsetof(SurfaceFunctionData, origin_ws)},
    {"surface_function.emission", offsetof(SurfaceFunctionData, emission)},
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

}  // namespace

std::span<const gpu::BlockLayout> block_layouts()
{
  return layouts;
}

}  // namespace gnomon::eevee
