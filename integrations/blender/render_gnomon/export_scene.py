# SPDX-License-Identifier: MIT
"""Run by engine.py in a second Blender: -- FOLDER SCENE VIEW_LAYER FRAME. Exports FOLDER/scene.blend to FOLDER/scene.glb.

FOLDER/scene.json has the report, and whether the world's picture is in FOLDER/world.npy: height x width x 3, with the top row first.
"""

import importlib
import json
import math
import os
import sys

import bpy
import numpy

folder, scene_name, layer_name, frame = sys.argv[sys.argv.index('--') + 1:]
addon = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(addon))
bpy.ops.wm.read_homefile(use_empty=True)
with bpy.data.libraries.load(f"{folder}/scene.blend") as (there, here):
    here.scenes = [scene_name]
scene = here.scenes[0]
bpy.context.window.scene = scene
bpy.context.window.view_layer = scene.view_layers[layer_name]
bpy.ops.preferences.addon_enable(module=os.path.basename(addon))
scene.frame_set(math.floor(float(frame)), subframe=float(frame) % 1)
scene.gnomon_export.is_on = True
world = importlib.import_module(os.path.basename(addon) + '.world')
remarks = []
has_picture = 'gnomon_world' not in scene and world.constant_radiance(scene.world) is None
if has_picture:
    # Gnomon's Python module reads no pictures of worlds.
    picture = f"{folder}/world.hdr"
    _, remarks = world.extras_of(scene.world, picture, scene.gnomon_export.world_width, True)
    numpy.save(f"{folder}/world.npy", world.radiance_of_picture(picture))
    scene['gnomon_world'] = [0.0, 0.0, 0.0]
# Blender composites the picture itself, and the engine keeps the render region.
scene.use_nodes = scene.render.use_border = False
bpy.ops.export_scene.gltf(filepath=f"{folder}/scene.glb", use_active_scene=True, export_current_frame=True, export_animations=False)
# The last line is a command, and the view is that of Blender.
lines = bpy.context.window_manager.gnomon_report.splitlines()[:-1]
remarks = [f"world: {remark}" for remark in remarks] + [line for line in lines if not line.startswith('colour management')]
with open(f"{folder}/scene.json", 'w', encoding='utf-8') as file:
    json.dump({'report': remarks, 'has_world_picture': has_picture}, file)
