// SPDX-License-Identifier: MIT
// For vertex shaders: the object of this instance.
#include "shared/draw_object_shared.h"
#include "shared/slots_shared.h"

layout(location = ATTRIBUTE_POSITION) in vec3 position;
/** x: index in object_block. y: value of the instance. */
layout(location = ATTRIBUTE_DRAW_INSTANCE) in uvec2 draw_instance;

layout(std140, binding = OBJECT_BLOCK_SLOT) readonly buffer object_block
{
  ObjectData objects[];
};

vec4 vertex_position_ws()
{
  return objects[draw_instance.x].world_from_object * vec4(position, 1.0);
}
