# SPDX-License-Identifier: MIT
"""Run by viewport.py in a second Blender: -- FOLDER WIDTH. Bakes the world in FOLDER/world.blend to FOLDER/world.npy, see world.py."""

import importlib
import os
import sys

import bpy
import numpy

folder, width = sys.argv[sys.argv.index('--') + 1:]
addon = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(addon))
bpy.ops.wm.read_homefile(use_empty=True)
with bpy.data.libraries.load(f"{folder}/world.blend") as (there, here):
    here.worlds = there.worlds
bpy.ops.preferences.addon_enable(module=os.path.basename(addon))
world = importlib.import_module(os.path.basename(addon) + '.world')
world.bake(here.worlds[0], f"{folder}/world.hdr", int(width), True)
numpy.save(f"{folder}/world.npy", world.radiance_of_picture(f"{folder}/world.hdr"))
