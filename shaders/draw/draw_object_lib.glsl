// SPDX-License-Identifier: MIT
// For vertex shaders: the object of this instance. A program that draws instance calls (draw::InstanceCall) defines
// DRAW_INSTANCES before it includes this file.
#include "shared/draw_object_shared.h"
#include "shared/slots_shared.h"

layout(location = ATTRIBUTE_POSITION) in vec3 position;
/** x: index of the object. y: value of the instance of an instance call; 0 in calls. */
layout(location = ATTRIBUTE_DRAW_INSTANCE) in uvec2 draw_instance;

#ifdef DRAW_INSTANCES
layout(std140, binding = OBJECT_BLOCK_SLOT) readonly buffer object_block
{
  ObjectData objects[];
};

uint object_value()
{
  return objects[draw_instance.x].value;
}

mat4 world_from_object()
{
  return objects[draw_instance.x].world_from_object;
}

/** Not of unit length. */
vec3 to_normal_ws(vec3 normal_os)
{
  ObjectData object = objects[draw_instance.x];
  return object.normal_x * normal_os.x + object.normal_y.xyz * normal_os.y + object.normal_z * normal_os.z;
}
#else
// Inputs of an instance: llvmpipe reads them once for several vertices, and a storage block for each vertex.
layout(location = ATTRIBUTE_WORLD_FROM_OBJECT) in mat4 draw_world_from_object;
layout(location = ATTRIBUTE_OBJECT_NORMAL_X) in vec3 draw_normal_x;
layout(location = ATTRIBUTE_OBJECT_NORMAL_Y) in vec3 draw_normal_y;
layout(location = ATTRIBUTE_OBJECT_NORMAL_Z) in vec3 draw_normal_z;
layout(location = ATTRIBUTE_OBJECT_VALUE) in uint draw_object_value;

uint object_value()
{
  return draw_object_value;
}

mat4 world_from_object()
{
  return draw_world_from_object;
}

/** Not of unit length. */
vec3 to_normal_ws(vec3 normal_os)
{
  return draw_normal_x * normal_os.x + draw_normal_y * normal_os.y + draw_normal_z * normal_os.z;
}
#endif

vec4 vertex_position_ws()
{
#ifdef VULKAN
  // OpenGL's default, which Vulkan lacks.
  gl_PointSize = 1.0;
#endif
  return world_from_object() * vec4(position, 1.0);
}
