# SPDX-License-Identifier: MIT
"""blender -b --factory-startup -P still_life.py -- FILE.blend: a scene with things that glTF has no word for.

An area lamp, a sun with an angle, a sky, closed glass, and a bevel.
"""

import math
import os
import sys

import bpy
from mathutils import Vector

bpy.ops.wm.read_homefile(use_empty=True)
scene = bpy.context.scene


def material(name, color, **inputs):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    principled = made.node_tree.nodes['Principled BSDF']
    principled.inputs['Base Color'].default_value = (*color, 1)
    for key, value in inputs.items():
        principled.inputs[key].default_value = value
    return made


def ball(name, radius, location, stuff):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=radius, location=(*location, radius))
    bpy.ops.object.shade_smooth()
    bpy.context.object.name = name
    bpy.context.object.data.materials.append(stuff)


def place(thing, location, target):
    thing.location = location
    thing.rotation_euler = (Vector(target) - Vector(location)).to_track_quat('-Z', 'Y').to_euler()
    scene.collection.objects.link(thing)


def lamp(name, kind, energy, location, **properties):
    data = bpy.data.lights.new(name, kind)
    data.energy = energy
    for key, value in properties.items():
        setattr(data, key, value)
    place(bpy.data.objects.new(name, data), location, (0, 0, 0.3))


bpy.ops.mesh.primitive_plane_add(size=12)
bpy.context.object.data.materials.append(material('table', (0.45, 0.4, 0.35), Roughness=0.6))
bpy.ops.mesh.primitive_cube_add(size=0.8, location=(-0.9, 0.5, 0.4), rotation=(0, 0, 0.5))
bpy.context.object.data.materials.append(material('box', (0.7, 0.15, 0.08), Roughness=0.4))
bevel = bpy.context.object.modifiers.new('bevel', 'BEVEL')
bevel.width, bevel.segments = 0.06, 4
ball('clay', 0.45, (0.1, 0.9), material('clay', (0.2, 0.4, 0.6), Roughness=0.8))
ball('gold', 0.3, (0.9, 0.1), material('gold', (1, 0.75, 0.35), Metallic=1.0, Roughness=0.3))
ball('glass', 0.35, (0, -0.4), material('glass', (0.95, 1, 0.97), Transmission=1.0, Roughness=0.0, IOR=1.45))
lamp('window', 'AREA', 60, (-2, -1, 2), shape='RECTANGLE', size=0.6, size_y=1.4, color=(0.7, 0.85, 1))
lamp('sun', 'SUN', 2, (3, -1, 2.5), angle=math.radians(3), color=(1, 0.85, 0.7))

camera = bpy.data.cameras.new('camera')
camera.lens = 45
scene.camera = bpy.data.objects.new('camera', camera)
place(scene.camera, (0.4, -4.2, 1.8), (0, 0.2, 0.3))
world = scene.world = bpy.data.worlds.new('sky')
world.use_nodes = True
tree = world.node_tree
sky = tree.nodes.new('ShaderNodeTexSky')
sky.sky_type, sky.sun_disc, sky.sun_elevation = 'NISHITA', False, math.radians(25)
tree.links.new(sky.outputs[0], tree.nodes['Background'].inputs['Color'])
tree.nodes['Background'].inputs['Strength'].default_value = 0.1
scene.render.resolution_x, scene.render.resolution_y = 264, 198
bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(sys.argv[-1]))
