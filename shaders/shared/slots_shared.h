// SPDX-License-Identifier: MIT
// Every slot of every shader. Uniform, storage and texture slots are one space, as in Vulkan; storage comes first,
// because OpenGL promises only eight.
#ifndef SLOTS_SHARED_H
#define SLOTS_SHARED_H

#define ATTRIBUTE_POSITION 0
#define ATTRIBUTE_NORMAL 1
#define ATTRIBUTE_DRAW_INSTANCE 2
#define ATTRIBUTE_UV 3

#define OBJECT_BLOCK_SLOT 0
#define MATERIAL_BLOCK_SLOT 1

#define PUSH_CONSTANT_SLOT 8
#define VIEW_BLOCK_SLOT 9
#define LIGHT_BLOCK_SLOT 10
#define SHADOW_BLOCK_SLOT 11
#define SHADOW_RENDER_BLOCK_SLOT 12
#define ESM_BLOCK_SLOT 13

#define SHADOW_CUBES_SLOT 16
#define SHADOW_MAPS_SLOT 17
#define RADIANCE_SLOT 18
#define SHADOW_ESM_SLOT 19
#define SHADOW_ESM_HALF_SLOT 20
#define ESM_SOURCE_SLOT 21
#define SHADOW_LAYERS_SLOT 22
#define BASE_COLOR_SLOT 24
#define SHADOW_EVSM_SLOT 25

/** Declares the block of small per-group values: push constants where the API has them. */
#ifdef VULKAN
#  define PUSH_CONSTANT_LAYOUT layout(push_constant, std140)
#else
#  define PUSH_CONSTANT_LAYOUT layout(std140, binding = PUSH_CONSTANT_SLOT)
#endif

/** Before `const int NAME = VALUE;`: chosen when the pipeline is made where the API can, otherwise by the defines. */
#ifdef VULKAN
#  define SPECIALIZATION_CONSTANT(ID) layout(constant_id = ID)
#else
#  define SPECIALIZATION_CONSTANT(ID)
#endif

#endif
