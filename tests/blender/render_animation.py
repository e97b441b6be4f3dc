# SPDX-License-Identifier: MIT
"""Run in Blender: -- FILE. Renders two frames by the engine of the add-on, with all of its passes."""

import sys

import bpy

bpy.ops.preferences.addon_enable(module='render_gnomon')
scene = bpy.context.scene
scene.render.engine = 'GNOMON'
scene.gnomon.sample_count = 8
scene.render.resolution_x, scene.render.resolution_y = 160, 90
layer = bpy.context.view_layer
for name in ('z', 'position', 'normal', 'diffuse_color', 'emit', 'environment', 'cryptomatte_object', 'cryptomatte_material'):
    setattr(layer, f'use_pass_{name}', True)
scene.render.image_settings.file_format = 'OPEN_EXR_MULTILAYER'
scene.render.image_settings.color_depth = '32'
scene.render.filepath = sys.argv[-1]
scene.frame_start, scene.frame_end = 1, 2
bpy.ops.render.render(animation=True)
