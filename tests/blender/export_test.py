# SPDX-License-Identifier: MIT
"""What the add-on writes into files. Run in Blender by check_blender: blender -b --factory-startup -P export_test.py -- FOLDER"""

import importlib
import json
import math
import os
import sys
import unittest
import unittest.mock

import bpy
import numpy
from mathutils import Matrix, Quaternion, Vector

FOLDER = sys.argv[sys.argv.index('--') + 1]
LUMEN_PER_WATT = 683
LAMBERTIAN = {'KHR_materials_specular': {'specularFactor': 0.0}}
# The material of faces without one, as Cycles draws them.
DEFAULT_SURFACE = {'name': 'default_surface', 'doubleSided': True, 'extensions': LAMBERTIAN, 'pbrMetallicRoughness': {
    'baseColorFactor': [0.8, 0.8, 0.8, 1.0], 'metallicFactor': 0.0, 'roughnessFactor': 0.5}}


def add(name, data, location=(0, 0, 0), collection=None):
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    (collection or bpy.context.scene.collection).objects.link(thing)
    return thing


def add_lamp(kind, energy=10.0, name='lamp', **properties):
    lamp = bpy.data.lights.new(name, kind)
    lamp.energy = energy
    for key, value in properties.items():
        setattr(lamp, key, value)
    return add(name, lamp)


def material(name='stuff', **inputs):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    for key, value in inputs.items():
        made.node_tree.nodes['Principled BSDF'].inputs[key.replace('_', ' ')].default_value = value
    return made


def add_box(name='box', size=1.0, stuff=None, **properties):
    mesh = bpy.data.meshes.new(name)
    h = size / 2
    mesh.from_pydata([(x, y, z) for z in (-h, h) for y in (-h, h) for x in (-h, h)], [],
                     [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
    if stuff is not None:
        mesh.materials.append(stuff)
    return add(name, mesh, **properties)


def data_blocks():
    # The result of a render stays.
    return {kind: sorted(each.name for each in getattr(bpy.data, kind))
            for kind in ('scenes', 'objects', 'cameras', 'worlds', 'meshes', 'materials', 'lights')}


class File:
    """The scene as the exporter writes it."""

    count = 0

    def __init__(self, **options):
        File.count += 1
        self.path = f"{FOLDER}/file{File.count}.gltf"
        before = data_blocks()
        bpy.ops.export_scene.gltf(filepath=self.path, export_format='GLTF_SEPARATE', **options)
        assert data_blocks() == before
        with open(self.path, encoding='utf-8') as file:
            self.json = json.load(file)
        self.report = bpy.context.window_manager.gnomon_report

    def node(self, name):
        return next(node for node in self.json['nodes'] if node['name'] == name)

    def names(self):
        return {node['name'] for node in self.json['nodes']}

    def extras(self, name):
        return self.node(name).get('extras', {})

    def values(self, index):
        """The elements of an accessor of floats."""
        accessor = self.json['accessors'][index]
        view = self.json['bufferViews'][accessor['bufferView']]
        count = accessor['count'] * int(accessor['type'][-1])
        path = os.path.join(FOLDER, self.json['buffers'][0]['uri'])
        return numpy.fromfile(path, numpy.float32, count, offset=view.get('byteOffset', 0)).reshape(accessor['count'], -1)

    def materials(self, name):
        """Those of the primitives of a node."""
        return [self.json['materials'][each['material']] for each in self.json['meshes'][self.node(name)['mesh']]['primitives']]

    def light(self, name):
        index = self.node(name)['extensions']['KHR_lights_punctual']['light']
        return self.json['extensions']['KHR_lights_punctual']['lights'][index]

    @property
    def scene_extras(self):
        return self.json['scenes'][0]['extras']


class ExportTest(unittest.TestCase):
    def setUp(self):
        bpy.ops.wm.read_homefile(use_empty=True)
        bpy.ops.preferences.addon_enable(module='render_gnomon')
        self.scene = bpy.context.scene

    def assertNear(self, a, b, places=5):
        self.assertEqual(len(a), len(b))
        for x, y in zip(a, b):
            self.assertAlmostEqual(x, y, places)


class Lamps(ExportTest):
    def test_light_is_physical_in_each_mode_of_the_exporter(self):
        add_lamp('SUN', 3.0, 'sun', angle=0.02)
        add_lamp('POINT', 100.0, 'point', shadow_soft_size=0.25, color=(1, 0.5, 0.25))
        add_lamp('SPOT', 50.0, 'spot', shadow_soft_size=0.0, spot_size=1.0, spot_blend=0.3)
        for mode in ('SPEC', 'COMPAT', 'RAW'):
            for export_lights in (False, True):
                file = File(convert_lighting_mode=mode, export_lights=export_lights)
                self.assertAlmostEqual(file.light('sun')['intensity'], 3 * LUMEN_PER_WATT, 3)
                self.assertAlmostEqual(file.light('point')['intensity'], 100 / (4 * math.pi) * LUMEN_PER_WATT, 3)
                self.assertNear(file.light('point')['color'], (1, 0.5, 0.25))
                self.assertAlmostEqual(file.light('spot')['intensity'], 50 / (4 * math.pi) * LUMEN_PER_WATT, 3)
                self.assertAlmostEqual(file.light('spot')['spot']['outerConeAngle'], 0.5, 5)
        self.assertAlmostEqual(file.extras('sun')['gnomon_angle'], 0.02, 6)
        self.assertAlmostEqual(file.extras('point')['gnomon_radius'], 0.25)
        self.assertNotIn('gnomon_radius', file.extras('spot'))
        self.assertAlmostEqual(file.extras('spot')['gnomon_spot_blend'], 0.3, 5)

    def test_area_lamps(self):
        for shape, height in (('SQUARE', 0.5), ('RECTANGLE', 2.0), ('DISK', 0.5), ('ELLIPSE', 2.0)):
            add_lamp('AREA', 20.0, shape, shape=shape, size=0.5, size_y=2.0, color=(0.5, 1, 1))
            self.assertEqual(File().extras(shape),
                             {'gnomon_lamp': 'area', 'gnomon_shape': shape.lower(), 'gnomon_size_x': 0.5, 'gnomon_size_y': height,
                              'gnomon_power': 20.0, 'gnomon_color': [0.5, 1.0, 1.0]})

    def test_nodes_of_lamps_multiply_their_light(self):
        for kind, per_watt in (('SUN', 1), ('POINT', 4 * math.pi)):
            thing = add_lamp(kind, 10.0, kind, use_nodes=True, color=(1, 0.5, 1))
            emission = thing.data.node_tree.nodes['Emission']
            emission.inputs['Strength'].default_value = 3.0
            emission.inputs['Color'].default_value = (0.5, 0.5, 1, 1)
            light = File().light(kind)
            self.assertAlmostEqual(light['intensity'], 30 / per_watt * LUMEN_PER_WATT, 2)
            self.assertNear(light['color'], (0.5, 0.25, 1))

    def test_what_is_not_drawn_is_named(self):
        add_lamp('AREA', name='narrow', spread=math.radians(30))
        add_lamp('AREA', name='none', size=0.0)
        add_lamp('POINT', -5.0, name='dark')
        textured = add_lamp('POINT', name='textured', use_nodes=True).data.node_tree
        textured.links.new(textured.nodes.new('ShaderNodeTexNoise').outputs[0], textured.nodes['Emission'].inputs['Color'])
        portal = add_lamp('AREA', name='portal')
        portal.data.cycles.is_portal = True
        add_lamp('POINT', name='dull', specular_factor=0.5)
        file = File()
        for text in ("lamp 'narrow': its spread of 30°", "lamp 'none': it has no area", "lamp 'dark': it takes light away",
                     "lamp 'textured': the colour of its light comes from the node 'Noise Texture'", "lamp 'portal': it is a portal",
                     "lamp 'dull': its specular factor of 0.5"):
            self.assertIn(text, file.report)
        self.assertEqual(file.light('dark').get('intensity', 1), 0)
        self.assertEqual(file.extras('portal'), {})

    def test_lamps_without_shadow(self):
        for engine in ('BLENDER_EEVEE', 'CYCLES'):
            self.scene.render.engine = engine
            thing = add_lamp('POINT', name=engine)
            self.assertNotIn('gnomon_shadow', File().extras(engine))
            if engine == 'CYCLES':
                thing.data.cycles.cast_shadow = False
            else:
                thing.data.use_shadow = False
            self.assertEqual(File().extras(engine)['gnomon_shadow'], 'none')
        add_box('ghost').visible_shadow = False
        self.assertIs(File().extras('ghost')['gnomon_casts_shadow'], False)

    def test_custom_properties_come_before_those_of_blender(self):
        thing = add_lamp('POINT', shadow_soft_size=0.5)
        thing['gnomon_radius'] = 0.125
        thing['gnomon_shadow_size'] = 256
        thing['other'] = 1
        for export_extras in (False, True):
            extras = File(export_extras=export_extras).extras('lamp')
            self.assertEqual((extras['gnomon_radius'], extras['gnomon_shadow_size']), (0.125, 256))
            self.assertEqual('other' in extras, export_extras)


class Worlds(ExportTest):
    def test_colours(self):
        self.assertEqual(File().scene_extras['gnomon_world'], [0, 0, 0])
        world = self.scene.world = bpy.data.worlds.new('world')
        world.color = (0.5, 0.25, 0)
        self.assertNear(File().scene_extras['gnomon_world'], (0.5, 0.25, 0))
        world.use_nodes = True
        background = world.node_tree.nodes['Background']
        background.inputs['Color'].default_value = (0.5, 0.25, 1, 1)
        background.inputs['Strength'].default_value = 3
        self.assertNear(File().scene_extras['gnomon_world'], (1.5, 0.75, 3))
        world.node_tree.links.clear()
        self.assertEqual(File().scene_extras['gnomon_world'], [0, 0, 0])
        self.scene['gnomon_world'] = 'my.hdr'
        self.assertEqual(File().scene_extras['gnomon_world'], 'my.hdr')

    def test_node_trees_are_baked_in_the_directions_of_the_file(self):
        world = self.scene.world = bpy.data.worlds.new('world')
        world.use_nodes = True
        # (direction + 1) / 2 times the strength.
        tree = world.node_tree
        half = tree.nodes.new('ShaderNodeVectorMath')
        half.operation = 'MULTIPLY_ADD'
        half.inputs[1].default_value = half.inputs[2].default_value = (0.5, 0.5, 0.5)
        tree.links.new(tree.nodes.new('ShaderNodeTexCoord').outputs['Generated'], half.inputs[0])
        tree.links.new(half.outputs[0], tree.nodes['Background'].inputs['Color'])
        tree.nodes['Background'].inputs['Strength'].default_value = 8
        world.cycles_visibility.camera = False
        self.scene.gnomon_export.world_width = 64
        for is_y_up in (True, False):
            file = File(export_yup=is_y_up)
            self.assertEqual(file.scene_extras['gnomon_world'], f"file{File.count}_world.hdr")
            self.assertIn("world: it is hidden from rays of the kinds camera", file.report)
            image = bpy.data.images.load(f"{FOLDER}/{file.scene_extras['gnomon_world']}")
            self.assertEqual(tuple(image.size), (64, 32))
            pixels = list(image.pixels)
            for row in (3, 11, 16, 28):
                for column in (0, 9, 20, 31, 45, 63):
                    v, u = math.pi * ((row + 0.5) / 32 - 0.5), 2 * math.pi * ((column + 0.5) / 64 - 0.5)
                    # doc/conventions.md
                    x, y, z = math.cos(u) * math.cos(v), math.sin(v), math.sin(u) * math.cos(v)
                    blender = (x, -z, y) if is_y_up else (x, y, z)
                    found = pixels[4 * (64 * row + column):][:3]
                    # A texel is the mean over the pixel filter, and RGBE has steps of 1/128 of the largest channel.
                    self.assertLess(max(abs(a - 4 * (b + 1)) for a, b in zip(found, blender)), 0.15)
            bpy.data.images.remove(image)

    def test_other_scenes_and_their_worlds_are_left_out(self):
        add_box('box')
        other = bpy.data.scenes.new('other')
        other.world = bpy.data.worlds.new('other')
        add('stranger', None, collection=other.collection)
        file = File()
        self.assertEqual((len(file.json['scenes']), file.names()), (1, {'box'}))

    def test_without_cycles_a_world_is_named(self):
        world = self.scene.world = bpy.data.worlds.new('world')
        world.use_nodes = True
        tree = world.node_tree
        tree.links.new(tree.nodes.new('ShaderNodeTexSky').outputs[0], tree.nodes['Background'].inputs['Color'])
        lamp = add_lamp('AREA')
        bpy.ops.preferences.addon_disable(module='cycles')
        try:
            file = File()
        finally:
            bpy.ops.preferences.addon_enable(module='cycles')
        self.assertEqual(file.scene_extras['gnomon_world'], [0, 0, 0])
        self.assertIn("world: it is written black", file.report)
        self.assertEqual(file.extras(lamp.name)['gnomon_lamp'], 'area')

    def test_rays_are_named(self):
        world = self.scene.world = bpy.data.worlds.new('world')
        world.use_nodes = True
        tree = world.node_tree
        tree.links.new(tree.nodes.new('ShaderNodeLightPath').outputs[0], tree.nodes['Background'].inputs['Strength'])
        self.scene.gnomon_export.world_width = 64
        self.assertIn("world: it depends on the kind of ray", File().report)


class Objects(ExportTest):
    def test_what_a_render_hides_is_left_out(self):
        shown, hidden, excluded, instanced = (bpy.data.collections.new(name) for name in ('shown', 'hidden', 'excluded', 'instanced'))
        for collection in (shown, hidden, excluded):
            self.scene.collection.children.link(collection)
        hidden.hide_render = True
        bpy.context.view_layer.layer_collection.children['excluded'].exclude = True
        add_box('a', collection=shown)
        parent = add_box('b', collection=shown)
        parent.hide_render = True
        add_box('child', collection=shown).parent = parent
        add_box('c', collection=hidden)
        add_box('d', collection=excluded)
        add_box('e', collection=instanced)
        add_box('f', collection=instanced).hide_render = True
        for name, is_hidden in (('instance', False), ('hidden_instance', True)):
            instance = add(name, None)
            instance.instance_type, instance.instance_collection = 'COLLECTION', instanced
            instance.hide_render = is_hidden
        file = File()
        self.assertEqual(file.names(), {'a', 'child', 'instance', 'e'})
        self.assertEqual(sum('mesh' in node for node in file.json['nodes']), 3)

    def test_modifiers_are_written_as_rendered_except_with_shape_keys(self):
        subdivision = add_box().modifiers.new('subdivision', 'SUBSURF')
        subdivision.levels, subdivision.render_levels, subdivision.show_viewport = 1, 2, False

        def count(file, name):
            primitive = file.json['meshes'][file.node(name)['mesh']]['primitives'][0]
            return file.json['accessors'][primitive['indices']]['count']

        self.assertEqual(count(File(), 'box'), 6 * 16 * 6)
        keyed = add_box('keyed')
        keyed.shape_key_add(name='base')
        keyed.shape_key_add(name='other')
        file = File()
        self.assertEqual(count(file, 'box'), 6 * 16 * 6)
        self.assertEqual({mesh['name'] for mesh in file.json['meshes']}, {'box', 'keyed'})
        self.assertEqual(len(file.json['meshes'][file.node('keyed')['mesh']]['primitives'][0]['targets']), 1)
        self.assertNotIn('modifiers', file.report)
        self.assertEqual((subdivision.levels, subdivision.show_viewport, bpy.data.objects['box'].data.name), (1, False, 'box'))
        keyed.modifiers.new('subdivision', 'SUBSURF')
        file = File()
        self.assertEqual(count(file, 'keyed'), 6 * 6)
        self.assertIn("object 'keyed': its modifiers are not written", file.report)

    def test_the_pose_of_bones_without_an_action_is_written(self):
        armature = bpy.data.armatures.new('rig')
        rig = bpy.context.view_layer.objects.active = add('rig', armature)
        bpy.ops.object.mode_set(mode='EDIT')
        armature.edit_bones.new('bone').tail = (0, 0, 1)
        bpy.ops.object.mode_set(mode='OBJECT')
        box = add_box('skin')
        box.vertex_groups.new(name='bone').add(range(8), 1.0, 'REPLACE')
        box.modifiers.new('rig', 'ARMATURE').object = rig
        box.parent = rig
        rig.pose.bones['bone'].rotation_mode = 'XYZ'
        rig.pose.bones['bone'].rotation_euler.y = 0.8
        self.scene.frame_set(7)
        turn = File().node('bone')['rotation']
        self.assertAlmostEqual(2 * math.acos(abs(turn[3])), 0.8, 5)
        self.assertEqual(self.scene.frame_current, 7)

    def test_an_empty_slot_beside_a_node_of_a_uv_map(self):
        stuff = material(Base_Color=(1, 0, 0, 1))
        tree = stuff.node_tree
        image = tree.nodes.new('ShaderNodeTexImage')
        image.image = bpy.data.images.new('image', 4, 4)
        uv_map = tree.nodes.new('ShaderNodeUVMap')
        uv_map.uv_map = 'UVMap'
        tree.links.new(uv_map.outputs[0], image.inputs['Vector'])
        tree.links.new(image.outputs['Color'], tree.nodes['Principled BSDF'].inputs['Base Color'])
        add_box('textured', stuff=stuff).data.uv_layers.new(name='UVMap')
        mesh = add_box('plain').data
        mesh.materials.append(None)
        file = File()
        self.assertEqual(file.materials('plain'), [DEFAULT_SURFACE])
        self.assertEqual(({each['name'] for each in file.json['materials']}, list(mesh.materials)), ({'stuff', 'default_surface'}, [None]))

    def test_an_export_that_fails_leaves_the_scene_as_it_was(self):
        subdivision = add_box().modifiers.new('subdivision', 'SUBSURF')
        bpy.data.objects['box'].data.materials.append(None)
        add('meta', bpy.data.metaballs.new('meta')).data.elements.new()
        keyed = add_box('keyed')
        keyed.shape_key_add(name='base')
        before = data_blocks()
        gather = importlib.import_module('io_scene_gltf2.blender.exp.gltf2_blender_gather')
        with unittest.mock.patch.object(gather, 'gather_gltf2', side_effect=ValueError('planned by a test')):
            with self.assertRaises(RuntimeError):
                File()
        bpy.ops.wm.save_as_mainfile(filepath=f"{FOLDER}/failed.blend", copy=True)
        self.assertEqual(data_blocks(), before)
        self.assertEqual((subdivision.levels, bpy.data.objects['box'].data.name), (1, 'box'))

    def test_colours_of_vertices_are_written_for_materials_that_read_them(self):
        plain, colored = material('plain'), material('colored')
        tree = colored.node_tree
        tree.links.new(tree.nodes.new('ShaderNodeVertexColor').outputs[0], tree.nodes['Principled BSDF'].inputs['Base Color'])
        for stuff in (plain, colored):
            add_box(stuff.name, stuff=stuff).data.color_attributes.new('Col', 'FLOAT_COLOR', 'POINT')
        file = File()
        for name, has in (('plain', False), ('colored', True)):
            self.assertEqual('COLOR_0' in file.json['meshes'][file.node(name)['mesh']]['primitives'][0]['attributes'], has)

    def test_colours_of_corners(self):
        stuff = material()
        tree = stuff.node_tree
        node = tree.nodes.new('ShaderNodeVertexColor')
        node.layer_name = 'Col'
        tree.links.new(node.outputs[0], tree.nodes['Principled BSDF'].inputs['Base Color'])
        box = add_box('box', stuff=stuff)
        # The material does not read the colours for renders.
        box.data.color_attributes.new('Other', 'FLOAT_COLOR', 'CORNER')
        box.data.color_attributes.new('Col', 'FLOAT_COLOR', 'CORNER')
        box.data.color_attributes.render_color_index = 0
        colors = box.data.color_attributes['Col'].data
        for polygon in box.data.polygons:
            for corner in polygon.loop_indices:
                colors[corner].color = (*(0.5 + 0.5 * x for x in polygon.normal), 1)
        file = File()
        attributes = file.json['meshes'][0]['primitives'][0]['attributes']
        normals, found = file.values(attributes['NORMAL']), file.values(attributes['COLOR_0'])[:, :3]
        expected = 0.5 + 0.5 * normals[:, [0, 2, 1]] * (1, -1, 1)
        self.assertLess(abs(found - expected).max(), 1e-6)
        self.assertEqual(box.data.color_attributes.render_color_index, 0)

    def test_instances_of_particles_are_written(self):
        box = add_box()
        box.rotation_euler = (0.1, 0.2, 0.3)
        emitter = add_box('emitter', location=(1, 2, 3))
        system = emitter.modifiers.new('particles', 'PARTICLE_SYSTEM').particle_system.settings
        system.type, system.count, system.render_type, system.instance_object = 'HAIR', 12, 'OBJECT', box
        system.use_rotation_instance = True
        places = sorted(tuple(each.matrix_world.translation) for each in bpy.context.evaluated_depsgraph_get().object_instances if each.is_instance)
        self.assertEqual(len(places), 12)
        for is_y_up in (True, False):
            file = File(export_yup=is_y_up)
            nodes = [node for node in file.json['nodes'] if node['name'] == 'emitter box']
            self.assertEqual({node['mesh'] for node in nodes}, {file.node('box')['mesh']})
            found = sorted((x, -z, y) if is_y_up else (x, y, z) for x, y, z in (node['matrix'][12:15] for node in nodes))
            for a, b in zip(found, places):
                self.assertNear(a, b, 4)
            self.assertNotIn("instances", file.report)
        # The emitter is not drawn, and a viewport shows a tenth of its particles.
        box.hide_render = True
        system.display_percentage = 10
        file = File()
        self.assertEqual(file.names(), {'emitter', 'emitter box'})
        self.assertEqual(len([node for node in file.json['nodes'] if node['name'] == 'emitter box']), 12)
        self.assertEqual([mesh['name'] for mesh in file.json['meshes']], ['emitter', 'box'])
        self.assertEqual(system.display_percentage, 10)

    def test_instances_of_geometry_nodes(self):
        box = add_box()
        for name, kind in (('of_objects', 'GeometryNodeObjectInfo'), ('of_meshes', 'GeometryNodeMeshIcoSphere')):
            tree = bpy.data.node_groups.new(name, 'GeometryNodeTree')
            tree.outputs.new('NodeSocketGeometry', 'Geometry')
            grid, instances, source, output = (tree.nodes.new(each) for each in (
                'GeometryNodeMeshGrid', 'GeometryNodeInstanceOnPoints', kind, 'NodeGroupOutput'))
            if name == 'of_objects':
                source.inputs['Object'].default_value = box
                source.inputs['As Instance'].default_value = True
            tree.links.new(grid.outputs['Mesh'], instances.inputs['Points'])
            geometry = source.outputs['Geometry' if name == 'of_objects' else 'Mesh']
            if name == 'of_meshes':
                painted = tree.nodes.new('GeometryNodeSetMaterial')
                painted.inputs['Material'].default_value = material('paint')
                tree.links.new(geometry, painted.inputs[0])
                geometry = painted.outputs[0]
            tree.links.new(geometry, instances.inputs['Instance'])
            tree.links.new(instances.outputs['Instances'], output.inputs[0])
            add_box(name).modifiers.new('nodes', 'NODES').node_group = tree
        file = File()
        nodes = [node for node in file.json['nodes'] if 'matrix' in node]
        self.assertEqual([node['name'] for node in nodes], ['of_objects box'] * 9 + ['of_meshes'] * 9)
        self.assertEqual({node['mesh'] for node in nodes[:9]}, {file.node('box')['mesh']})
        found = {node['mesh'] for node in nodes[9:]}
        self.assertEqual(len(found), 1)
        stuff = file.json['meshes'][found.pop()]['primitives'][0]['material']
        self.assertEqual(file.json['materials'][stuff]['name'], 'paint')
        self.assertNotIn("object", file.report)
        collection = bpy.data.collections.new('many')
        collection.objects.link(bpy.data.objects['of_meshes'])
        instance = add('instance', None, (0, 0, 7))
        instance.instance_type, instance.instance_collection = 'COLLECTION', collection
        self.assertEqual([node['matrix'][13] for node in File().json['nodes'] if node['name'] == 'instance of_meshes'], [7] * 9)

    def test_instances_within_instances_of_collections(self):
        inner, outer = (bpy.data.collections.new(name) for name in ('inner', 'outer'))
        grain = add_box('grain', 0.1, collection=inner, location=(0.1, 0.2, 0.3))
        for name, kind in (('emitter', None), ('corners', 'VERTS'), ('sides', 'FACES')):
            thing = add_box(name, collection=inner, location=(1, 2, 3))
            if kind is None:
                system = thing.modifiers.new('particles', 'PARTICLE_SYSTEM').particle_system.settings
                system.type, system.count, system.render_type, system.instance_object = 'HAIR', 5, 'OBJECT', grain
            else:
                thing.instance_type = kind
                add_box(f'on_{name}', 0.1, collection=inner).parent = thing
        # The exporter writes the surface of a text.
        add('text', bpy.data.curves.new('text', 'FONT'), collection=inner).data.body = 'a'
        for name, collection, within, location in (('a', inner, outer, (0, 0, 5)), ('b', outer, None, (7, 0, 0)), ('c', inner, None, (0, 9, 0))):
            instance = add(name, None, location, within)
            instance.instance_type, instance.instance_collection = 'COLLECTION', collection
            instance.scale = (2, 1, -1)
        bpy.context.view_layer.update()
        wanted = sorted((instance.object.name, *(round(value, 3) + 0 for value in instance.matrix_world.translation))
                        for instance in bpy.context.evaluated_depsgraph_get().object_instances if instance.object.type == 'MESH' and instance.show_self)
        self.assertEqual(len(wanted), 2 * (1 + 3 + 5 + 8 + 6 + 1))
        file = File(export_yup=False)
        found = []

        def walk(index, above):
            node = file.json['nodes'][index]
            place = above @ (Matrix(numpy.reshape(node['matrix'], (4, 4)).T.tolist()) if 'matrix' in node else Matrix.LocRotScale(
                node.get('translation', (0, 0, 0)), Quaternion(numpy.roll(node.get('rotation', (0, 0, 0, 1)), 1)), node.get('scale', (1, 1, 1))))
            if 'mesh' in node:
                found.append((file.json['meshes'][node['mesh']]['name'], *(round(value, 3) + 0 for value in place.translation)))
            for child in node.get('children', ()):
                walk(child, place)

        for root in file.json['scenes'][0]['nodes']:
            walk(root, Matrix())
        self.assertEqual(sorted(found), wanted)
        self.assertNotIn("object", file.report)

    def test_metaballs_curves_and_texts_are_written_once(self):
        meta = add('meta', bpy.data.metaballs.new('meta'), (1, 2, 3))
        meta.data.elements.new()
        meta.data.materials.append(material('jelly'))
        curve = bpy.data.curves.new('curve', 'CURVE')
        curve.bevel_depth = 0.1
        curve.splines.new('POLY').points.add(1)
        curve.splines[0].points[1].co = (1, 1, 1, 1)
        add('curve', curve)
        text = bpy.data.curves.new('text', 'FONT')
        text.body = 'a'
        add('text', text)
        file = File()
        self.assertEqual(sorted(node['name'] for node in file.json['nodes']), ['curve', 'meta', 'text'])
        self.assertTrue(all('mesh' in node for node in file.json['nodes']))
        self.assertEqual(file.node('meta')['matrix'][12:15], [1, 3, -2])
        stuff = file.json['meshes'][file.node('meta')['mesh']]['primitives'][0]['material']
        self.assertEqual(file.json['materials'][stuff]['name'], 'jelly')
        self.assertNotIn("object", file.report)

    def test_cameras(self):
        for name in ('first', 'second', 'third'):
            add(name, bpy.data.cameras.new(name))
        parent = add('parent', None)
        bpy.data.objects['third'].parent = parent
        for name in ('second', 'third'):
            self.scene.camera = bpy.data.objects[name]
            file = File()
            nodes, order = file.json['nodes'], []

            def walk(indices):
                for index in indices:
                    order.extend([nodes[index]['name']] if 'camera' in nodes[index] else [])
                    walk(nodes[index].get('children', []))

            walk(file.json['scenes'][0]['nodes'])
            self.assertEqual((order[0], len(order)), (name, 3))
        camera = self.scene.camera.data
        camera.dof.use_dof, camera.type = True, 'ORTHO'
        self.assertIn("camera 'third': its depth of field is not drawn", File().report)
        camera.type = 'PANO'
        self.assertIn("camera 'third': a panoramic camera", File().report)

    def test_orthographic_cameras_have_the_scale_on_the_side_that_the_sensor_fits(self):
        thing = self.scene.camera = add('eye', bpy.data.cameras.new('eye'))
        thing.data.type, thing.data.ortho_scale = 'ORTHO', 6.0
        for width, height, fit, expected in (
                (200, 100, 'AUTO', (3, 1.5)), (200, 100, 'HORIZONTAL', (3, 1.5)), (200, 100, 'VERTICAL', (6, 3)),
                (100, 200, 'AUTO', (1.5, 3)), (100, 200, 'HORIZONTAL', (3, 6)), (100, 200, 'VERTICAL', (1.5, 3))):
            self.scene.render.resolution_x, self.scene.render.resolution_y, thing.data.sensor_fit = width, height, fit
            written = File().json['cameras'][0]['orthographic']
            self.assertNear((written['xmag'], written['ymag']), expected)

    def test_pixels_are_square(self):
        thing = self.scene.camera = add('eye', bpy.data.cameras.new('eye'))
        render = self.scene.render
        render.resolution_x, render.resolution_y = 160, 90
        for kind, name in (('PERSP', 'perspective'), ('ORTHO', 'orthographic')):
            thing.data.type, render.pixel_aspect_x, thing.data.shift_y = kind, 1.0, 0.3
            square = File()
            self.assertNotIn("pixels", square.report)
            render.pixel_aspect_x = 2.0
            file = File()
            self.assertIn("scene: its pixels of 2 to 1 are drawn square", file.report)
            self.assertEqual(file.json['cameras'][0][name], square.json['cameras'][0][name])
            self.assertEqual(file.extras('eye'), square.extras('eye'))
            self.assertEqual(render.pixel_aspect_x, 2.0)

    def test_shift_and_depth_of_field(self):
        thing = self.scene.camera = add('eye', bpy.data.cameras.new('eye'), (0, -5, 0))
        thing.rotation_euler.x = math.pi / 2
        camera = thing.data
        self.scene.render.resolution_x, self.scene.render.resolution_y = 400, 100

        def extras():
            return next(node for node in File().json['nodes'] if node['name'] == 'eye').get('extras', {})

        self.assertEqual(extras(), {})
        # The sensor fits the longer side, of four heights.
        camera.shift_x, camera.shift_y = 0.1, 0.2
        self.assertAlmostEqual(extras()['gnomon_shift_x'], 0.1, places=5)
        self.assertAlmostEqual(extras()['gnomon_shift_y'], 0.8, places=5)
        camera.shift_x = camera.shift_y = 0
        dof = camera.dof
        dof.use_dof, dof.aperture_fstop, dof.focus_distance, camera.lens = True, 2.0, 7.0, 80
        self.assertAlmostEqual(extras()['gnomon_aperture_radius'], 0.02, places=6)
        self.assertAlmostEqual(extras()['gnomon_focus_distance'], 7.0, places=5)
        dof.focus_object = add('target', None, (3, 4, 1))
        bpy.context.view_layer.update()
        self.assertAlmostEqual(extras()['gnomon_focus_distance'], 9.0, places=5)
        dof.aperture_blades, dof.aperture_ratio = 6, 1.5
        self.assertEqual((extras()['gnomon_aperture_blades'], extras()['gnomon_aperture_ratio']), (6, 1.5))

    def test_there_is_one_animation(self):
        for i in range(3):
            box = add_box(f'box{i}')
            for frame in (1, 25):
                box.location.x = frame
                box.keyframe_insert('location', frame=frame)
        lamp = add_lamp('POINT')
        lamp.data.keyframe_insert('energy', frame=1)
        file = File()
        self.assertEqual([len(each['channels']) for each in file.json['animations']], [3])
        self.assertIn("light 'lamp': its animation is not written", file.report)
        # The same actions, as strips.
        for i in range(3):
            data = bpy.data.objects[f'box{i}'].animation_data
            action = data.action
            data.action = None
            data.nla_tracks.new().strips.new('strip', 1, action)
        file = File()
        self.assertEqual([len(each['channels']) for each in file.json['animations']], [3])


class Materials(ExportTest):
    def test_faces_without_a_material_have_the_surface_of_cycles(self):
        add_box('bare')
        add_box('empty').data.materials.append(None)
        box = add_box('mixed', stuff=material('red'))
        box.data.materials.append(None)
        for polygon in box.data.polygons:
            polygon.material_index = polygon.index % 2
        # Slots of objects.
        own = add_box('own', stuff=material('hidden'))
        own.material_slots[0].link = 'OBJECT'
        add('meta', bpy.data.metaballs.new('meta')).data.elements.new()
        text = add('text', bpy.data.curves.new('text', 'FONT'))
        text.data.body = 'a'
        file = File()
        for name in ('bare', 'empty', 'own', 'meta', 'text'):
            self.assertEqual(file.materials(name), [DEFAULT_SURFACE], name)
        self.assertEqual([each['name'] for each in file.materials('mixed')], ['red', 'default_surface'])
        self.assertEqual([each['name'] for each in file.json['materials']].count('default_surface'), 1)
        self.assertNotIn('materials', File(export_materials='PLACEHOLDER').json)

    def test_a_material_without_a_surface_is_black_or_a_volume_alone(self):
        without, volume, unlinked = material('without'), material('volume'), material('unlinked')
        without.node_tree.nodes.clear()
        for stuff in (volume, unlinked):
            stuff.node_tree.links.clear()
        tree = volume.node_tree
        tree.links.new(tree.nodes.new('ShaderNodeVolumePrincipled').outputs[0], tree.nodes['Material Output'].inputs['Volume'])
        for stuff in (without, volume, unlinked):
            add_box(stuff.name, stuff=stuff)
        file = File()
        for name in ('without', 'unlinked'):
            written, = file.materials(name)
            self.assertEqual(written['pbrMetallicRoughness'], {**DEFAULT_SURFACE['pbrMetallicRoughness'], 'baseColorFactor': [0, 0, 0, 1]})
            self.assertEqual(written['extensions'], LAMBERTIAN)
            self.assertIn(f"material '{name}': its output has no surface, so that Blender draws it black" if name == 'unlinked' else
                          f"material '{name}': it has no output, so that Blender draws it black", file.report)
        written, = file.materials('volume')
        self.assertEqual((written['alphaMode'], written['pbrMetallicRoughness']['baseColorFactor'][3]), ('MASK', 0))
        self.assertIn("material 'volume': it has a volume and no surface, and is not drawn", file.report)

    def test_diffuse_surfaces_are_lambertian(self):
        images = {}
        for name in ('plain', 'textured'):
            stuff = material(name)
            tree = stuff.node_tree
            tree.nodes.remove(tree.nodes['Principled BSDF'])
            diffuse = tree.nodes.new('ShaderNodeBsdfDiffuse')
            diffuse.inputs['Color'].default_value = (0.25, 0.5, 1, 1)
            tree.links.new(diffuse.outputs[0], tree.nodes['Material Output'].inputs['Surface'])
            if name == 'textured':
                diffuse.inputs['Roughness'].default_value = 0.5
                image = tree.nodes.new('ShaderNodeTexImage')
                image.image = bpy.data.images.new('image', 4, 4)
                tree.links.new(image.outputs['Color'], diffuse.inputs['Color'])
            add_box(name, stuff=stuff).data.uv_layers.new()
            images[name] = {(link.from_node.name, link.to_node.name) for link in tree.links}, sorted(node.name for node in tree.nodes)
        file = File()
        for name in images:
            written, = file.materials(name)
            self.assertEqual(written['extensions'], LAMBERTIAN)
            self.assertEqual(written['pbrMetallicRoughness']['metallicFactor'], 0)
            self.assertEqual('baseColorTexture' in written['pbrMetallicRoughness'], name == 'textured')
            tree = bpy.data.materials[name].node_tree
            self.assertEqual(({(link.from_node.name, link.to_node.name) for link in tree.links}, sorted(node.name for node in tree.nodes)),
                             images[name])
        self.assertNear(file.materials('plain')[0]['pbrMetallicRoughness']['baseColorFactor'], (0.25, 0.5, 1, 1))
        self.assertNotIn("material 'plain'", file.report)
        self.assertIn("material 'textured': 'Roughness' is not drawn", file.report)

    def test_linked_objects_are_as_own_ones(self):
        stuff = material('linked')
        tree = stuff.node_tree
        tree.links.new(tree.nodes.new('ShaderNodeBsdfDiffuse').outputs[0], tree.nodes['Material Output'].inputs['Surface'])
        tree.nodes['Diffuse BSDF'].inputs['Color'].default_value = (0.25, 0.5, 1, 1)
        for name, slots in (('diffuse', [stuff]), ('bare', []), ('empty', [None])):
            thing = add_box(name)
            for each in slots:
                thing.data.materials.append(each)
            thing.hide_viewport = True
            subdivision = thing.modifiers.new('subdivision', 'SUBSURF')
            subdivision.render_levels = 1
        bpy.ops.wm.save_as_mainfile(filepath=f"{FOLDER}/library.blend")
        bpy.ops.wm.read_homefile(use_empty=True)
        with bpy.data.libraries.load(f"{FOLDER}/library.blend", link=True) as (there, here):
            here.objects = there.objects
        for thing in here.objects:
            bpy.context.scene.collection.objects.link(thing)
        file = File()
        self.assertEqual(file.materials('diffuse')[0]['extensions'], LAMBERTIAN)
        self.assertEqual(file.materials('diffuse')[0]['pbrMetallicRoughness']['baseColorFactor'], [0.25, 0.5, 1, 1])
        self.assertEqual(file.materials('bare') + file.materials('empty'), 2 * [DEFAULT_SURFACE])
        for name in ('diffuse', 'bare', 'empty'):
            primitive = file.json['meshes'][file.node(name)['mesh']]['primitives'][0]
            self.assertEqual(file.json['accessors'][primitive['indices']]['count'], 6 * 4 * 6, name)

    def test_emission_is_black_otherwise(self):
        for name in ('lamp', 'mixed'):
            stuff = material(name)
            tree = stuff.node_tree
            emission, mixed = tree.nodes.new('ShaderNodeEmission'), tree.nodes.new('ShaderNodeMixShader')
            emission.inputs['Color'].default_value, emission.inputs['Strength'].default_value = (0.5, 0.25, 0.125, 1), 4
            tree.links.new(emission.outputs[0], mixed.inputs[2])
            tree.links.new(tree.nodes['Principled BSDF'].outputs[0], mixed.inputs[1])
            tree.links.new((emission if name == 'lamp' else mixed).outputs[0], tree.nodes['Material Output'].inputs['Surface'])
            add_box(name, stuff=stuff)
        file = File()
        for name in ('lamp', 'mixed'):
            written, = file.materials(name)
            self.assertNear(written['emissiveFactor'], (1, 0.5, 0.25))
            self.assertEqual(written['extensions']['KHR_materials_emissive_strength'], {'emissiveStrength': 2})
            self.assertEqual('KHR_materials_specular' in written['extensions'], name == 'lamp')
            self.assertEqual(written['pbrMetallicRoughness']['metallicFactor'], 0)
        self.assertNotIn("'lamp'", file.report)
        self.assertIn("material 'mixed': its surface is the node 'Mix Shader', which is not drawn, but 'Principled BSDF' and 'Emission' before it",
                      file.report)

    def test_alpha_of_opaque_materials_is_named(self):
        for name, mode, alpha in (('solid', 'OPAQUE', 1.0), ('opaque', 'OPAQUE', 0.5), ('clipped', 'CLIP', 0.5)):
            stuff = material(name, Alpha=alpha)
            stuff.blend_method = mode
            add_box(name, stuff=stuff)
        report = File().report
        self.assertIn("material 'opaque': its alpha is not drawn, as in EEVEE: its blend mode is Opaque", report)
        self.assertNotIn("'solid'", report)
        self.assertNotIn("'clipped'", report)

    def test_other_surfaces_have_the_colour_for_viewports(self):
        stuff = material('glossy')
        stuff.diffuse_color = (0.25, 0.5, 1, 1)
        tree = stuff.node_tree
        tree.links.new(tree.nodes.new('ShaderNodeBsdfGlossy').outputs[0], tree.nodes['Material Output'].inputs['Surface'])
        add_box('box', stuff=stuff)
        file = File()
        values = file.materials('box')[0]['pbrMetallicRoughness']
        self.assertNear(values['baseColorFactor'], (0.25, 0.5, 1, 1))
        self.assertEqual(values['metallicFactor'], 0)
        self.assertIn("material 'glossy': its surface is the node 'Glossy BSDF', which is not drawn, but the material's colour for viewports", file.report)

    def test_images_that_no_uv_set_places_are_named(self):
        for kind, projection, name in (('UV', 'FLAT', None), ('Object', 'FLAT', 'Object'), ('UV', 'BOX', 'Box')):
            stuff = material(f'{kind} {projection}')
            tree = stuff.node_tree
            image = tree.nodes.new('ShaderNodeTexImage')
            image.image, image.projection = bpy.data.images.new(f'image {name}', 4, 4), projection
            tree.links.new(tree.nodes.new('ShaderNodeTexCoord').outputs[kind], image.inputs['Vector'])
            tree.links.new(image.outputs['Color'], tree.nodes['Principled BSDF'].inputs['Base Color'])
            add_box(stuff.name, stuff=stuff)
        report = File().report
        self.assertNotIn("material 'UV FLAT'", report)
        for name in ('Object', 'Box'):
            self.assertIn(f"the image 'image {name}' is drawn by the uv set, not by {name}", report)

    def test_closed_glass_has_the_mean_chord_as_its_thickness(self):
        glass = material('glass', Transmission=1.0)
        bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.5)
        bpy.context.object.data.materials.append(glass)
        bpy.context.object.name = 'ball'
        add_box('box', 2.0, glass)
        add_box('twin', 2.0, glass)
        mesh = bpy.data.meshes.new('sheet')
        mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
        mesh.materials.append(glass)
        add('sheet', mesh)
        wave = bpy.data.meshes.new('wave')
        wave.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0.1), (1, 1, 0.3)], [], [(0, 1, 2), (1, 3, 2)])
        wave.materials.append(glass)
        add('wave', wave)
        file = File()
        thickness = {}
        for name in ('ball', 'box', 'twin', 'sheet'):
            index = file.json['meshes'][file.node(name)['mesh']]['primitives'][0]['material']
            volume = file.json['materials'][index]['extensions'].get('KHR_materials_volume', {})
            thickness[name] = (index, volume.get('thicknessFactor'))
        self.assertAlmostEqual(thickness['ball'][1], 4 / 3 * 0.5, 2)
        self.assertAlmostEqual(thickness['box'][1], 4 * 8 / 24, 5)
        self.assertEqual(thickness['box'], thickness['twin'])
        self.assertIsNone(thickness['sheet'][1])
        self.assertIn("mesh 'sheet': its part of 'glass' is a plane", file.report)
        index = file.json['meshes'][file.node('wave')['mesh']]['primitives'][0]['material']
        wave = file.json['materials'][index]
        self.assertEqual(wave['extras']['gnomon_thickness'], 1e6)
        self.assertNotIn('KHR_materials_volume', wave['extensions'])

    def test_absorption_is_that_of_blender(self):
        glass = material('glass', Transmission=1.0)
        tree = glass.node_tree
        absorption = tree.nodes.new('ShaderNodeVolumeAbsorption')
        absorption.inputs['Color'].default_value = (0.5, 0.25, 1, 1)
        absorption.inputs['Density'].default_value = 2
        tree.links.new(absorption.outputs[0], tree.nodes['Material Output'].inputs['Volume'])
        add_box(stuff=glass)
        volume = File().json['materials'][0]['extensions']['KHR_materials_volume']
        for d in (0.1, 1.7):
            for color, written in zip((0.5, 0.25, 1), volume['attenuationColor']):
                self.assertAlmostEqual(written ** (d / volume['attenuationDistance']), math.exp(-2 * (1 - color) * d), 5)

    def test_attributes_of_objects_are_named(self):
        for kind, is_named in (('GEOMETRY', False), ('OBJECT', True)):
            stuff = material(kind)
            tree = stuff.node_tree
            node = tree.nodes.new('ShaderNodeAttribute')
            node.attribute_type, node.attribute_name = kind, 'color'
            tree.links.new(node.outputs['Color'], tree.nodes['Principled BSDF'].inputs['Base Color'])
            add_box(kind, stuff=stuff).data.color_attributes.new('color', 'FLOAT_COLOR', 'POINT')
            self.assertEqual(f"material '{kind}': 'Base Color' comes from the nodes Attribute" in File().report, is_named)

    def test_what_is_not_drawn_is_named(self):
        noisy, mixed, deep = material('noisy'), material('mixed'), material('deep', Subsurface=0.5)
        tree = noisy.node_tree
        tree.links.new(tree.nodes.new('ShaderNodeTexNoise').outputs[0], tree.nodes['Principled BSDF'].inputs['Roughness'])
        displacement = tree.nodes.new('ShaderNodeDisplacement')
        tree.links.new(displacement.outputs[0], tree.nodes['Material Output'].inputs['Displacement'])
        tree = mixed.node_tree
        tree.links.new(tree.nodes.new('ShaderNodeMixShader').outputs[0], tree.nodes['Material Output'].inputs['Surface'])
        for stuff in (noisy, mixed, deep, material('plain')):
            add_box(stuff.name, stuff=stuff)
        report = File().report
        for text in ("material 'noisy': 'Roughness' comes from the nodes Noise Texture", "material 'noisy': its displacement",
                     "material 'mixed': its surface is the node 'Mix Shader', which is not drawn, but the material's colour", "material 'deep': 'Subsurface' is not drawn"):
            self.assertIn(text, report)
        self.assertNotIn("plain", report)


class Options(ExportTest):
    def test_without_the_option_a_file_is_as_without_the_add_on(self):
        add_box(stuff=material('glass', Transmission=1.0)).modifiers.new('subdivision', 'SUBSURF')
        add_lamp('AREA')
        add_lamp('SUN', name='sun')
        self.scene.gnomon_export.is_on = False
        off = File(export_lights=True, convert_lighting_mode='COMPAT').json
        bpy.ops.preferences.addon_disable(module='render_gnomon')
        path = f"{FOLDER}/without.gltf"
        bpy.ops.export_scene.gltf(filepath=path, export_format='GLTF_SEPARATE', export_lights=True, convert_lighting_mode='COMPAT')
        with open(path, encoding='utf-8') as file:
            without = json.load(file)
        for each in (off, without):
            each['buffers'][0].pop('uri')
        self.assertEqual(off, without)

    def test_the_report_has_the_command(self):
        add_box()
        view = self.scene.view_settings
        view.exposure = 1.5
        for transform, words in (('Standard', '--view standard'), ('Raw', '--view raw'), ('Filmic', '--view agx')):
            view.view_transform = transform
            report = File().report
            self.assertIn(f"{words} --background world --exposure 1.5", report)
            self.assertEqual("is not drawn" in report, transform == 'Filmic')
        self.scene.render.film_transparent = True
        self.scene.render.resolution_x, self.scene.render.resolution_y, self.scene.render.resolution_percentage = 1920, 1080, 50
        self.assertIn("--size 960x540 --view agx --background none", File().report)

    def test_scene_wide_effects_are_named(self):
        add_box()
        self.scene.render.use_motion_blur = self.scene.use_nodes = True
        report = File().report
        self.assertIn("scene: motion blur is drawn in frames alone: --frames A-B --shutter 0.5", report)
        self.assertIn("scene: compositing nodes are not run", report)

    def test_what_hides_objects_and_changes_pictures_is_named(self):
        render, layer = self.scene.render, bpy.context.view_layer
        for name, option in (('held', 'holdout'), ('indirect', 'indirect_only')):
            collection = bpy.data.collections.new(name)
            self.scene.collection.children.link(collection)
            add_box(name, collection=collection)
            setattr(layer.layer_collection.children[name], option, True)
        add_box('matte').visible_glossy = False
        add_box('shadowless').data.materials.append(material('shadowless'))
        bpy.data.materials['shadowless'].shadow_method = 'NONE'
        render.engine, self.scene.eevee.use_bloom = 'BLENDER_EEVEE', True
        render.use_border = render.use_multiview = render.use_freestyle = True
        self.scene.background_set = bpy.data.scenes.new('set')
        layer.material_override = material('clay')
        report = File().report
        for text in ("object 'held': holdouts and shadow catchers are drawn", "object 'indirect': it is hidden from the camera in Blender and is drawn",
                     "object 'matte': it is hidden from rays of the kinds glossy", "scene: the whole picture is drawn, not its render region alone",
                     "scene: one view is drawn", "scene: lines of Freestyle", "scene: EEVEE's bloom", "material 'shadowless': its shadow mode None is not drawn",
                     "scene: its background set 'set' is not written", "its material override 'clay' is not drawn"):
            self.assertIn(text, report)

    def test_simplified_scenes_are_written_as_rendered(self):
        subdivision = add_box().modifiers.new('subdivision', 'SUBSURF')
        subdivision.render_levels = 2
        self.scene.render.use_simplify = True
        self.scene.render.simplify_subdivision, self.scene.render.simplify_subdivision_render = 0, 1
        file = File()
        self.assertEqual(file.json['accessors'][file.json['meshes'][0]['primitives'][0]['indices']]['count'], 6 * 4 * 6)
        self.assertEqual(self.scene.render.simplify_subdivision, 0)

    def test_what_viewports_hide_is_written_as_rendered(self):
        collections = {name: bpy.data.collections.new(name) for name in ('layer', 'collection', 'instanced')}
        for name in ('layer', 'collection'):
            self.scene.collection.children.link(collections[name])
        names = ['seen', 'disabled', 'hidden', *collections]
        for name in names:
            thing = add_box(name, collection=collections.get(name))
            subdivision = thing.modifiers.new('subdivision', 'SUBSURF')
            subdivision.levels, subdivision.render_levels = 0, 1
        instance = add('instance', None)
        instance.instance_type, instance.instance_collection = 'COLLECTION', collections['instanced']
        # Hidden particles of a hidden object.
        system = bpy.data.objects['hidden'].modifiers.new('particles', 'PARTICLE_SYSTEM').particle_system.settings
        system.type, system.count, system.render_type, system.instance_object = 'HAIR', 12, 'OBJECT', bpy.data.objects['seen']
        bpy.data.objects['disabled'].hide_viewport = True
        bpy.data.objects['hidden'].hide_set(True)
        layers = bpy.context.view_layer.layer_collection.children
        layers['layer'].hide_viewport = collections['collection'].hide_viewport = True
        file = File()
        self.assertEqual(file.names(), {*names, 'instance', 'hidden seen'})
        self.assertEqual(sum(node['name'] == 'hidden seen' for node in file.json['nodes']), 12)
        self.assertTrue(bpy.data.objects['disabled'].hide_viewport and bpy.data.objects['hidden'].hide_get())
        self.assertTrue(layers['layer'].hide_viewport and collections['collection'].hide_viewport)
        for name in names:
            primitive = file.json['meshes'][file.node(name)['mesh']]['primitives'][0]
            self.assertEqual(file.json['accessors'][primitive['indices']]['count'], 6 * 4 * 6, name)


def write_picture_scene():
    """A scene with each kind of lamp and a baked world, and Cycles' picture of its direct light."""
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.preferences.addon_enable(module='render_gnomon')
    scene = bpy.context.scene
    grey = material('grey', Base_Color=(0.6, 0.5, 0.4, 1), Specular=0.0)
    add_box('floor', 8.0, grey, location=(0, 0, -4))
    add_box('box', 1.0, grey, location=(-1, 0.3, 0.5)).rotation_euler.z = 0.5
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.6, location=(0.9, 0, 0.6))
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(grey)
    for kind, energy, location, properties in (
            ('SUN', 0.5, (4, -2, 4), {'angle': 0.1}), ('POINT', 40, (-2.5, -1, 2), {'shadow_soft_size': 0.2}),
            ('SPOT', 200, (2, -2, 3), {'shadow_soft_size': 0.1, 'spot_size': 0.9, 'spot_blend': 0.4, 'color': (1, 0.6, 0.4)}),
            ('AREA', 60, (-1, 3, 2.5), {'shape': 'RECTANGLE', 'size': 0.7, 'size_y': 1.6, 'color': (0.4, 0.6, 1)}),
            ('AREA', 30, (0, -1, 3), {'shape': 'DISK', 'size': 0.8})):
        lamp = add_lamp(kind, energy, **properties)
        lamp.location = location
        lamp.rotation_euler = (-Vector(location)).to_track_quat('-Z', 'Y').to_euler()
    camera = scene.camera = add('camera', bpy.data.cameras.new('camera'), (0.5, -6, 3))
    camera.rotation_euler = (Vector((0, 0, 0.4)) - camera.location).to_track_quat('-Z', 'Y').to_euler()
    world = scene.world = bpy.data.worlds.new('world')
    world.use_nodes = True
    tree = world.node_tree
    gradient = tree.nodes.new('ShaderNodeTexGradient')
    tree.links.new(tree.nodes.new('ShaderNodeTexCoord').outputs['Generated'], gradient.inputs[0])
    tree.links.new(gradient.outputs['Color'], tree.nodes['Background'].inputs['Color'])
    scene.gnomon_export.world_width = 256
    bpy.ops.export_scene.gltf(filepath=f"{FOLDER}/picture.glb", convert_lighting_mode='COMPAT')

    bpy.ops.wm.save_as_mainfile(filepath=f"{FOLDER}/picture.blend")

    # Blender's Principled BSDF without specular reflection is not Lambertian.
    tree = grey.node_tree
    diffuse = tree.nodes.new('ShaderNodeBsdfDiffuse')
    diffuse.inputs['Color'].default_value = tree.nodes['Principled BSDF'].inputs['Base Color'].default_value
    tree.links.new(diffuse.outputs[0], tree.nodes['Material Output'].inputs['Surface'])
    scene.render.engine = 'CYCLES'
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.max_bounces = 'CPU', 256, 0
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    scene.render.filter_size = cycles.filter_width = 1.5
    scene.render.resolution_x, scene.render.resolution_y = 160, 90
    scene.render.image_settings.file_format = 'OPEN_EXR'
    scene.render.filepath = f"{FOLDER}/cycles.exr"
    bpy.ops.render.render(write_still=True)


if unittest.main(argv=['export_test'], exit=False).result.wasSuccessful():
    write_picture_scene()
else:
    sys.exit(1)
