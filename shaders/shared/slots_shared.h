// SPDX-License-Identifier: MIT
// The slots of all shaders. Uniform blocks, storage blocks and textures share one space of slots, as in Vulkan. Storage
// blocks come first, because OpenGL guarantees only eight of them.
#ifndef SLOTS_SHARED_H
#define SLOTS_SHARED_H

#define ATTRIBUTE_POSITION 0
#define ATTRIBUTE_NORMAL 1
/** The object's index, and in instance calls the value of the instance. */
#define ATTRIBUTE_DRAW_INSTANCE 2
#define ATTRIBUTE_UV 3
#define ATTRIBUTE_SECOND_UV 4
#define ATTRIBUTE_TANGENT 5
#define ATTRIBUTE_COLOR 6
/** Transform of the object of a call. A mat4 takes four locations. */
#define ATTRIBUTE_WORLD_FROM_OBJECT 7
#define ATTRIBUTE_OBJECT_NORMAL_X 11
#define ATTRIBUTE_OBJECT_NORMAL_Y 12
#define ATTRIBUTE_OBJECT_NORMAL_Z 13
#define ATTRIBUTE_OBJECT_VALUE 14

#define OBJECT_BLOCK_SLOT 0
#define MATERIAL_BLOCK_SLOT 1
#define FULL_MATERIAL_BLOCK_SLOT 2
#define LAYER_BLOCK_SLOT 3
#define LINE_BLOCK_SLOT 4

#define PUSH_CONSTANT_SLOT 8
// Blocks whose members bound loops come first: Mesa 22.3.6's lavapipe crashes if such a block is after the third of a stage.
#define LIGHT_BLOCK_SLOT 9
#define LIGHT_CLUSTER_BLOCK_SLOT 10
#define WORLD_BLOCK_SLOT 11
#define VIEW_BLOCK_SLOT 12
#define SHADOW_BLOCK_SLOT 13
#define SHADOW_RENDER_BLOCK_SLOT 14
#define ESM_BLOCK_SLOT 15
#define LIGHT_SHAPE_BLOCK_SLOT 24
#define SURFACE_FUNCTION_BLOCK_SLOT 26

#define SHADOW_CUBES_SLOT 16
#define SHADOW_MAPS_SLOT 17
#define RADIANCE_SLOT 18
#define SHADOW_ESM_SLOT 19
#define SHADOW_ESM_HALF_SLOT 20
#define ESM_SOURCE_SLOT 21
#define SHADOW_LAYERS_SLOT 22
#define DEPTH_SLOT 23
#define SHADOW_EVSM_SLOT 25
#define LTC_TABLE_SLOT 44
#define WORLD_LEVELS_SLOT 45
#define WORLD_PICTURE_SLOT 46
#define BEHIND_SLOT 48
#define MULTISCATTER_TABLE_SLOT 50
#define LIGHT_TEXTURE_SLOT 51
#define LIGHT_LISTS_SLOT 52
#define BODIES_SLOT 54
#define BEHIND_DEPTH_SLOT 55

#define BASE_COLOR_SLOT 32
#define METALLIC_ROUGHNESS_SLOT 33
#define NORMAL_SLOT 34
#define OCCLUSION_SLOT 35
#define EMISSIVE_SLOT 36
#define SPECULAR_SLOT 37
#define SPECULAR_COLOR_SLOT 38
#define COAT_SLOT 39
#define COAT_ROUGHNESS_SLOT 40
#define SHEEN_COLOR_SLOT 41
#define SHEEN_ROUGHNESS_SLOT 42
#define TRANSMISSION_SLOT 43
#define THICKNESS_SLOT 47
#define ANISOTROPY_SLOT 49
#define COAT_NORMAL_SLOT 53

/** Layout of the block of small values of a group: push constants if the API has them, else a uniform block. */
#ifdef VULKAN
#define PUSH_CONSTANT_LAYOUT layout(push_constant, std140)
#else
#define PUSH_CONSTANT_LAYOUT layout(std140, binding = PUSH_CONSTANT_SLOT)
#endif

/** Prefix of a line `const TYPE NAME = DEFAULT;`, TYPE `int` or `bool`. \see gpu::ShaderDesc::constants */
#ifdef VULKAN
#define SPECIALIZATION_CONSTANT(ID) layout(constant_id = ID)
#else
#define SPECIALIZATION_CONSTANT(ID)
#endif

#endif
