# SPDX-License-Identifier: MIT
"""Run in Blender with a scene: -- OUT SAMPLES. Renders OUT.exr by the engine of the add-on with all of its passes, and exports OUT.glb."""

import sys

import bpy

out, sample_count = sys.argv[-2:]
bpy.ops.preferences.addon_enable(module='render_gnomon')
scene = bpy.context.scene
scene.render.engine = 'GNOMON'
scene.gnomon.sample_count = int(sample_count)
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 161, 91, 100
layer = bpy.context.view_layer
for name in ('z', 'position', 'normal', 'diffuse_color', 'emit', 'environment', 'cryptomatte_object', 'cryptomatte_material'):
    setattr(layer, f'use_pass_{name}', True)
scene.render.image_settings.file_format = 'OPEN_EXR_MULTILAYER'
scene.render.image_settings.color_depth = '32'
scene.render.filepath = f"{out}.exr"
bpy.ops.export_scene.gltf(filepath=f"{out}.glb", export_current_frame=True, export_animations=False)
bpy.ops.render.render(write_still=True)
