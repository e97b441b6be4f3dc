# SPDX-License-Identifier: MIT
"""Worlds of Blender as extras of Gnomon: a radiance, or an equirectangular picture that Cycles makes."""

import math
import os
import urllib.parse

import bpy
import numpy
from mathutils import Euler, Matrix

PICTURE_WIDTH_MAX = 8192


def constant_radiance(world):
    """The radiance of a world that is alike in all directions, W/(sr m²); None if it has to be baked."""
    if world is None:
        return (0.0, 0.0, 0.0)
    if not world.use_nodes or world.node_tree is None:
        return tuple(world.color)
    output = next((n for n in world.node_tree.nodes if n.type == 'OUTPUT_WORLD' and n.is_active_output), None)
    if output is None or not output.inputs['Surface'].is_linked:
        return (0.0, 0.0, 0.0)
    node = output.inputs['Surface'].links[0].from_node
    if node.type != 'BACKGROUND' or node.mute or node.inputs['Color'].is_linked or node.inputs['Strength'].is_linked:
        return None
    return tuple(c * node.inputs['Strength'].default_value for c in node.inputs['Color'].default_value[:3])


def nodes_of(tree):
    """All nodes of a tree and of its groups."""
    for node in tree.nodes:
        yield node
        if node.type == 'GROUP' and node.node_tree:
            yield from nodes_of(node.node_tree)


def picture_width(world, width):
    """Texels across: at least as many as the world's largest equirectangular picture has, up to PICTURE_WIDTH_MAX."""
    pictures = [node.image.size[0] for node in nodes_of(world.node_tree) if node.type == 'TEX_ENVIRONMENT' and node.image]
    return min(max([width, *pictures]), PICTURE_WIDTH_MAX)


def bake(world, path, width, is_y_up):
    """Writes the world as a camera sees it into an HDR picture, in the directions of doc/conventions.md.

    is_y_up: whether the file turns Blender's +Z to +Y.
    """
    # The world may be hidden from cameras, so that a copy is drawn.
    scene, world = bpy.data.scenes.new('Gnomon bake'), world.copy()
    camera = bpy.data.cameras.new('Gnomon bake')
    eye = bpy.data.objects.new('Gnomon bake', camera)
    try:
        scene.world = world
        world.cycles_visibility.camera = True
        # A map for sampling, which only lights use, takes longer than the picture.
        world.cycles.sampling_method = 'NONE'
        scene.render.engine = 'CYCLES'
        camera.type = 'PANO'
        # 4.0 and later have these of the camera itself.
        panorama = camera if hasattr(camera, 'panorama_type') else camera.cycles
        panorama.panorama_type = 'EQUIRECTANGULAR'
        turn = Euler((math.pi / 2, 0, -math.pi / 2)).to_matrix()
        if not is_y_up:
            turn = Matrix(((1, 0, 0), (0, 0, 1), (0, -1, 0))) @ turn
        eye.matrix_world = turn.to_4x4()
        scene.collection.objects.link(eye)
        scene.camera = eye
        scene.cycles.device = 'CPU'
        scene.cycles.samples = 8
        scene.cycles.use_adaptive_sampling = False
        scene.cycles.use_denoising = False
        scene.cycles.sample_clamp_direct = 0
        render = scene.render
        render.resolution_x, render.resolution_y, render.resolution_percentage = width, width // 2, 100
        render.film_transparent = False
        render.image_settings.file_format = 'HDR'
        render.use_file_extension = False
        render.filepath = os.path.abspath(path)
        bpy.ops.render.render(scene=scene.name, write_still=True)
    finally:
        bpy.data.scenes.remove(scene)
        bpy.data.objects.remove(eye)
        bpy.data.cameras.remove(camera)
        bpy.data.worlds.remove(world)


def extras_of(world, path, width, is_y_up):
    """(extras, remarks) of a scene for its world. path: of the picture, which is written where the world needs one."""
    radiance = constant_radiance(world)
    remarks = []
    if world is not None and world.use_nodes and world.node_tree:
        nodes = list(nodes_of(world.node_tree))
        if any(node.type == 'LIGHT_PATH' for node in nodes):
            remarks.append("it depends on the kind of ray (Light Path); what the camera sees is written")
        output = next((n for n in nodes if n.type == 'OUTPUT_WORLD' and n.is_active_output), None)
        if output and output.inputs['Volume'].is_linked:
            remarks.append("its volume is not drawn")
        # Blender has it while the add-on of Cycles is on.
        visible = getattr(world, 'cycles_visibility', None)
        hidden = [kind for kind in ('camera', 'diffuse', 'glossy', 'transmission') if not getattr(visible, kind, True)]
        if hidden:
            remarks.append(f"it is hidden from rays of the kinds {', '.join(hidden)}, which is not drawn")
    if radiance is not None:
        if min(radiance) < 0:
            remarks.append("its negative light is written as 0")
        return {'gnomon_world': [max(c, 0.0) for c in radiance]}, remarks
    if not hasattr(world, 'cycles_visibility'):
        remarks.append("it is written black, because Cycles, whose add-on is off, would make its picture")
        return {'gnomon_world': [0.0, 0.0, 0.0]}, remarks
    bake(world, path, picture_width(world, width), is_y_up)
    # The extra is a URI.
    return {'gnomon_world': urllib.parse.quote(os.path.basename(path))}, remarks


def radiance_of_picture(path):
    """Height x width x 3, with the top row first: the picture as `gnomon render` reads it."""
    image = bpy.data.images.load(path)
    pixels = numpy.empty(4 * image.size[0] * image.size[1], numpy.float32)
    image.pixels.foreach_get(pixels)
    texels = pixels.reshape(image.size[1], image.size[0], 4)[::-1, :, :3]
    # Blender reads the middle of each step of RGBE, and `gnomon render` its lower end.
    _, exponent = numpy.frexp(texels.max(axis=-1, keepdims=True))
    return numpy.maximum(texels - numpy.ldexp(numpy.float32(0.5), exponent - 8), 0)
