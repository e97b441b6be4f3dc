# SPDX-License-Identifier: MIT
"""The viewport, in a window: run by check_blender under Xvfb: blender --factory-startup -P viewport_test.py -- FOLDER

After edits of all kinds, the complete picture is that of a scene that is collected anew, bit for bit, and Blender's window shows it.
"""

import os
import sys
import time

import bpy
import numpy

sys.path.insert(0, os.path.dirname(__file__))
from window import check, region, run, space, viewport

FOLDER = sys.argv[-1]


def screenshot():
    path = f"{FOLDER}/window.png"
    bpy.ops.screen.screenshot(filepath=path)
    image = bpy.data.images.load(path)
    pixels = numpy.empty(4 * image.size[0] * image.size[1], numpy.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    there = region()
    return pixels.reshape(image_size(path)[1], -1, 4)[there.y:there.y + there.height, there.x:there.x + there.width, :3]


def image_size(path):
    with open(path, 'rb') as file:
        header = file.read(24)
    return int.from_bytes(header[16:20], 'big'), int.from_bytes(header[20:24], 'big')


def steps():
    scene = bpy.context.scene
    scene.render.engine = 'GNOMON'
    scene.gnomon.sample_count = 1
    scene.gnomon.map_size_px = scene.gnomon.cube_size_px = 256
    scene.view_settings.view_transform = 'Standard'
    cube, lamp = bpy.data.objects['Cube'], bpy.data.objects['Light']
    space().overlay.show_overlays = space().show_gizmo = False
    space().show_region_header = space().show_region_toolbar = False
    yield
    space().shading.type = 'RENDERED'
    picture = yield from check()

    # Blender's window shows it, as it encodes linear light.
    for _ in range(5):
        yield
    linear = picture[0][::-1, :, :3]
    encoded = numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * numpy.maximum(linear, 0.0031308)**(1 / 2.4) - 0.055)
    error = numpy.quantile(abs(screenshot() - numpy.clip(encoded, 0, 1)), 0.95)
    # The error is 0.003, less than a step of 8 bits. Blender draws a text over a hundredth of the picture.
    assert error < 0.004, error

    def moved():
        lamp.location.x += 1

    def colored():
        cube.data.materials[0].node_tree.nodes['Principled BSDF'].inputs['Base Color'].default_value = (0.9, 0.1, 0.1, 1)

    def added():
        bpy.ops.mesh.primitive_plane_add(size=12, location=(0, 0, -1))

    def modified():
        cube.modifiers.new('bevel', 'BEVEL')

    def instanced():
        collection = bpy.data.collections.new('many')
        collection.objects.link(cube)
        for x in (-3, 3):
            empty = bpy.data.objects.new('empty', None)
            empty.instance_type, empty.instance_collection = 'COLLECTION', collection
            empty.location.x = x
            scene.collection.objects.link(empty)

    def edited():
        # One with modifiers, and one without.
        for thing in (cube, bpy.data.objects['Plane']):
            thing.data.vertices[0].co.z += 1
            thing.data.update()

    def hidden():
        bpy.data.objects['Plane'].hide_set(True)

    def strengthened():
        scene.world.node_tree.nodes['Background'].inputs['Strength'].default_value = 3

    def kind_changed():
        lamp.data.type = 'SUN'

    def set_samples():
        scene.gnomon.sample_count = 2

    def orthographic():
        space().region_3d.view_perspective = 'ORTHO'

    def shifted():
        space().region_3d.view_perspective = 'CAMERA'
        space().region_3d.view_camera_offset = (0.2, 0.1)

    def blurred():
        camera = scene.camera.data
        camera.dof.use_dof, camera.dof.aperture_fstop, camera.dof.focus_distance = True, 0.1, 3

    def textured():
        image = bpy.data.images.new('noise', 16, 8)
        image.pixels = numpy.random.default_rng(1).random(4 * 16 * 8)
        tree = cube.data.materials[0].node_tree
        node = tree.nodes.new('ShaderNodeTexImage')
        node.image = image
        tree.links.new(node.outputs['Color'], tree.nodes['Principled BSDF'].inputs['Base Color'])
        tree.links.new(node.outputs['Color'], tree.nodes['Principled BSDF'].inputs['Roughness'])

    def mapped():
        tree = cube.data.materials[0].node_tree
        mapping = tree.nodes.new('ShaderNodeMapping')
        mapping.inputs['Scale'].default_value = 2, 3, 1
        tree.links.new(tree.nodes.new('ShaderNodeTexCoord').outputs['UV'], mapping.inputs['Vector'])
        node = next(node for node in tree.nodes if node.type == 'TEX_IMAGE')
        tree.links.new(mapping.outputs[0], node.inputs['Vector'])

    def painted():
        image = bpy.data.images['noise']
        image.pixels = 1 - numpy.array(image.pixels)
        cube.data.materials[0].node_tree.update_tag()

    def in_another_frame():
        cube.location.x = 1
        cube.keyframe_insert('location', frame=5)
        scene.frame_set(5)

    def undone():
        bpy.ops.ed.undo_push(message="one")
        bpy.data.objects['Camera'].data.lens = 90
        bpy.data.objects['Cube'].scale *= 2
        bpy.ops.ed.undo_push(message="two")
        bpy.ops.ed.undo()
        bpy.data.objects['Cube'].rotation_euler.z += 1

    def removed():
        bpy.data.objects.remove(bpy.data.objects['Cube'])

    for change in (moved, colored, added, modified, instanced, edited, textured, mapped, painted, in_another_frame, strengthened, kind_changed,
                   set_samples, orthographic, shifted, blurred, undone, hidden, removed):
        before, begun = picture, time.monotonic()
        change()
        picture = yield from check(before)
        assert picture[0].shape != before[0].shape or (picture[0] != before[0]).any(), f"{change.__name__} changes nothing"
        print("as collected anew after:", change.__name__, f"{time.monotonic() - begun:.1f} s", flush=True)

    # Things that are not drawn are named.
    assert not viewport.remarks(), viewport.remarks()
    bpy.ops.mesh.primitive_monkey_add()
    material = bpy.data.materials.new('odd')
    material.use_nodes = True
    bpy.context.object.data.materials.append(material)
    tree, principled = material.node_tree, material.node_tree.nodes['Principled BSDF']
    tree.links.new(tree.nodes.new('ShaderNodeTexNoise').outputs[0], principled.inputs['Roughness'])
    tree.links.new(tree.nodes.new('ShaderNodeValue').outputs[0], principled.inputs['Clearcoat'])
    image = tree.nodes.new('ShaderNodeTexImage')
    image.image = bpy.data.images['noise']
    mapping = tree.nodes.new('ShaderNodeMapping')
    mapping.inputs['Scale'].default_value = 2, 3, 1
    tree.links.new(tree.nodes.new('ShaderNodeTexCoord').outputs['UV'], mapping.inputs['Vector'])
    tree.links.new(mapping.outputs[0], image.inputs['Vector'])
    tree.links.new(image.outputs['Color'], principled.inputs['Base Color'])
    other = tree.nodes.new('ShaderNodeTexImage')
    other.image = image.image
    tree.links.new(other.outputs['Color'], principled.inputs['Emission'])
    picture = yield from check(picture)
    for text in ("'Roughness' comes from the nodes Noise Texture", "what 'Clearcoat' is linked to", "places its images all as 'noise'"):
        assert any(text in each for each in viewport.remarks()), (text, viewport.remarks())
    assert len(viewport.remarks()) == 3, viewport.remarks()

    # A world that is not of one colour is baked.
    tree = bpy.context.scene.world.node_tree
    tree.links.new(tree.nodes.new('ShaderNodeTexSky').outputs[0], tree.nodes['Background'].inputs['Color'])
    while not viewport.Viewport.all or 'picture' not in viewport.Viewport.all[0].content.world:
        yield
    yield from check(picture)

    # Without a viewport, there is no thread.
    thread = viewport.Viewport.all[0].painter.thread
    space().shading.type = 'SOLID'
    while thread.is_alive():
        yield
    assert not viewport.Viewport.all


run(steps, 'viewport', 600)
