# SPDX-License-Identifier: MIT
"""Run in Blender with a scene, by check_blender. The scene that the viewport reads from the depsgraph is that of the exported file.

In seven scenes, RMSEs were at most 2.1e-4, because a few pixels at edges have other normals: the exporter joins vertices whose normals are almost the
same. Skinned meshes differ more: Blender makes their normals anew, and those of a file are turned by the bones.
"""

import importlib
import sys
import tempfile

import bpy
import numpy

bpy.ops.preferences.addon_enable(module='render_gnomon')
collect, engine, mirror, settings = (importlib.import_module(f'render_gnomon.{name}') for name in ('collect', 'engine', 'mirror', 'settings'))
gnomon = settings.gnomon
SIZE = 161, 91
RMSE_MAX = 5e-4
LAYERS = ['combined', 'depth', 'normal', 'albedo', 'roughness']


def place_image():
    """An image that is not square on the factory cube, by another uv set and a mapping."""
    mesh = bpy.data.objects['Cube'].data
    for corner in mesh.uv_layers.new(name='other').data:
        corner.uv = 1.5 * corner.uv.yx
    image = bpy.data.images.new('squares', 64, 32)
    texels = numpy.kron(numpy.random.default_rng(1).random((4, 4, 4)), numpy.ones((8, 16, 1)))
    image.pixels = texels.reshape(-1)
    image.pack()
    tree = mesh.materials[0].node_tree
    node, mapping, uv_map = (tree.nodes.new(f'ShaderNode{kind}') for kind in ('TexImage', 'Mapping', 'UVMap'))
    node.image, uv_map.uv_map = image, 'other'
    mapping.inputs['Location'].default_value, mapping.inputs['Scale'].default_value = (0.1, 0.3, 0), (2, 0.7, 1)
    mapping.inputs['Rotation'].default_value[2] = 0.4
    tree.links.new(uv_map.outputs[0], mapping.inputs['Vector'])
    tree.links.new(mapping.outputs[0], node.inputs['Vector'])
    tree.links.new(node.outputs['Color'], tree.nodes['Principled BSDF'].inputs['Base Color'])


def paint_vertices():
    """Boxes with colours of corners and of vertices, of which a material reads those that are not for renders."""
    for index, (domain, kind) in enumerate((('CORNER', 'BYTE_COLOR'), ('POINT', 'FLOAT_COLOR'))):
        bpy.ops.mesh.primitive_cube_add(size=1, location=(2 * index - 2, -2, 1))
        mesh = bpy.context.object.data
        for name in ('first', 'second'):
            attribute = mesh.color_attributes.new(name, kind, domain)
            colors = numpy.random.default_rng(len(name)).random((len(attribute.data), 4))
            attribute.data.foreach_set('color', colors.astype(numpy.float32).reshape(-1))
        material = bpy.data.materials.new('painted')
        material.use_nodes = True
        node = material.node_tree.nodes.new('ShaderNodeVertexColor')
        node.layer_name = 'first'
        material.node_tree.links.new(node.outputs['Color'], material.node_tree.nodes['Principled BSDF'].inputs['Base Color'])
        mesh.materials.append(material)


def surface(name, kind=None):
    """A material with a node at its surface, or without a surface."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    output = tree.nodes['Material Output']
    tree.links.clear()
    if kind is not None:
        tree.links.new(tree.nodes.new(f'ShaderNode{kind}').outputs[0], output.inputs['Surface'])
    return material


def add_odd_surfaces():
    """Boxes without a material, and with materials that are no Principled BSDF."""
    black, volume, diffuse, glossy, mixed, added, lamp = (surface(*each) for each in (
        ('black',), ('volume',), ('diffuse', 'BsdfDiffuse'), ('glossy', 'BsdfGlossy'), ('mixed', 'MixShader'), ('added', 'AddShader'),
        ('lamp', 'Emission')))
    tree = volume.node_tree
    tree.links.new(tree.nodes.new('ShaderNodeVolumeScatter').outputs[0], tree.nodes['Material Output'].inputs['Volume'])
    tree = diffuse.node_tree
    node = tree.nodes.new('ShaderNodeTexImage')
    node.image = bpy.data.images['squares']
    tree.links.new(node.outputs['Color'], tree.nodes['Diffuse BSDF'].inputs['Color'])
    glossy.diffuse_color = (0.9, 0.5, 0.2, 1)
    tree = mixed.node_tree
    tree.nodes['Principled BSDF'].inputs['Base Color'].default_value = (0.2, 0.3, 0.9, 1)
    tree.links.new(tree.nodes['Principled BSDF'].outputs[0], tree.nodes['Mix Shader'].inputs[2])
    tree = added.node_tree
    emission = tree.nodes.new('ShaderNodeEmission')
    emission.inputs['Strength'].default_value = 0.2
    tree.links.new(emission.outputs[0], tree.nodes['Add Shader'].inputs[0])
    tree.links.new(tree.nodes['Principled BSDF'].outputs[0], tree.nodes['Add Shader'].inputs[1])
    tree = lamp.node_tree
    node = tree.nodes.new('ShaderNodeTexImage')
    node.image = bpy.data.images['squares']
    tree.links.new(node.outputs['Color'], tree.nodes['Emission'].inputs['Color'])
    for i, slots in enumerate(((), (None,), (glossy, None), (black,), (volume,), (diffuse,), (mixed,), (added,), (lamp,))):
        bpy.ops.mesh.primitive_cube_add(size=0.7, location=(2.6 - 0.4 * i, 1.1 * i - 4, 0.5))
        mesh = bpy.context.object.data
        for each in slots:
            mesh.materials.append(each)
        for polygon in mesh.polygons:
            polygon.material_index = polygon.index % max(len(slots), 1)
    bpy.context.object.is_holdout = True


def check_remarks():
    """A colour that no image gives is a remark of the viewport, whichever surface has it."""
    for kind in ('BsdfPrincipled', 'BsdfDiffuse', 'Emission'):
        material = surface(f'linked {kind}', kind)
        tree = material.node_tree
        socket = tree.nodes['Material Output'].inputs['Surface'].links[0].from_node.inputs[0]
        tree.links.new(tree.nodes.new('ShaderNodeRGB').outputs[0], socket)
        collector = collect.Collector()
        collector.material_of(material, mirror.Content())
        assert collector.remarks == [f"material '{material.name}': what '{socket.name}' is linked to is not drawn in the viewport"], collector.remarks
        bpy.data.materials.remove(material)


def encoded(picture):
    linear = numpy.clip(picture[:, :, :3], 0, 1)
    return numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * numpy.maximum(linear, 0.0031308)**(1 / 2.4) - 0.055)


def layers_of(device, scene, camera):
    return gnomon.Renderer.offline(device, scene, SIZE, 16, background='world').layers(LAYERS, camera)


if not bpy.data.filepath:
    place_image()
    paint_vertices()
    add_odd_surfaces()
    check_remarks()
device = gnomon.Device()
depsgraph = bpy.context.evaluated_depsgraph_get()
with tempfile.TemporaryDirectory() as folder:
    facts = engine.exported(depsgraph, folder)
    exported = engine.loaded(gnomon, folder, facts)
    collector = collect.Collector()
    content = collector.content(depsgraph)
    # Both say the same of each thing, apart from what the viewport alone does not draw.
    named = {line for line in collector.remarks if 'the viewport' not in line}
    assert named == {line for line in facts['report'] if line.startswith(('object', 'material'))}, (collector.remarks, facts['report'])
    assert bpy.data.filepath or any('holdouts' in line for line in named), named
    world = bpy.context.scene.world
    if facts['has_world_picture']:
        content.world = {'picture': numpy.load(f"{folder}/world.npy")}
    else:
        content.world = {'color': importlib.import_module('render_gnomon.world').constant_radiance(world)}
shown = mirror.Mirror(gnomon)
shown.show(content)
eye = next(node for node in exported.nodes if node.camera)
shown.eye.parent_from_node = eye.world_from_node
shown.camera.edit(**{name: getattr(eye.camera, name) for name in ('kind', 'vertical_angle', 'aspect', 'near', 'far')})
own, expected = layers_of(device, shown.scene, shown.eye), layers_of(device, exported, eye)
own['combined'], expected['combined'] = encoded(own['combined']), encoded(expected['combined'])
for name in LAYERS:
    error = numpy.minimum(abs(own[name] - expected[name]), 1)
    rmse = (error**2).mean()**0.5
    print(f"layer {name}: RMSE {rmse:.2g}, 99 % below {numpy.quantile(error, 0.99):.2g}, largest {error.max():.2g}")
    assert rmse < RMSE_MAX, name
