# SPDX-License-Identifier: MIT
"""The module `gnomon`. GNOMON_SOURCE: the repository's root; GNOMON_PROGRAM: the program."""

import ast
import copy
import ctypes
import gc
import importlib.util
import inspect
import json
import math
import multiprocessing
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import unittest
from pathlib import Path

import gnomon
import numpy
import OpenImageIO

PLAZA = "examples/scenes/plaza.glb"
SMALL = {"sample_count": 2, "cube_size_px": 64, "map_size_px": 64, "esm_size_px": 64}


def square_scene(intensity=math.pi):
    """A grey square that fills the picture, under a sun that it faces. Its radiance is base colour / π times irradiance."""
    scene = gnomon.Scene()
    material = scene.add_material(name="grey", base_color=(0.5, 0.25, 0.125), metallic=0.0, specular=0.0)
    mesh = scene.add_mesh(
        numpy.array([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], numpy.float32),
        numpy.array([(0, 0, 1)] * 4, numpy.float32),
        numpy.array([(0, 1, 2), (0, 2, 3)], numpy.uint32),
        material=material)
    scene.add_node(name="square", meshes=[mesh])
    scene.add_node(name="sun", lamp=scene.add_lamp(name="sun", kind=gnomon.LampKind.SUN, intensity=intensity))
    scene.add_node(name="eye", camera=scene.add_camera(name="eye", vertical_angle=0.4), position=(0, 0, 4))
    return scene


def read_exr(path):
    return OpenImageIO.ImageInput.open(path).read_image("float")


class Scenes(unittest.TestCase):
    def test_values_that_are_set_are_read(self):
        scene = square_scene()
        lamp = scene.lamps[0]
        lamp.edit(color=(1, 0.5, 0.25), intensity=3, shadow_kind=gnomon.ShadowKind.ESM)
        self.assertEqual((lamp.color, lamp.intensity), ((1.0, 0.5, 0.25), 3.0))
        self.assertEqual(lamp.shadow_kind, gnomon.ShadowKind.ESM)
        lamp.shadow_kind = None
        self.assertIsNone(lamp.shadow_kind)
        node = scene.nodes[1]
        self.assertEqual(node.lamp, lamp)
        self.assertNotEqual(node.lamp, node)
        node.position = (1, 2, 3)
        child = scene.add_node(node, name="child", position=(1, 0, 0))
        self.assertEqual(child.parent, node)
        self.assertEqual(child.world_from_node[:3, 3].tolist(), [2, 2, 3])
        child.parent = None
        self.assertEqual(child.world_from_node[:3, 3].tolist(), [1, 0, 0])
        turn = numpy.array([(0, -1, 0, 5), (1, 0, 0, 6), (0, 0, 1, 7), (0, 0, 0, 1)])
        child.parent_from_node = turn
        self.assertTrue((child.world_from_node == turn).all())
        self.assertEqual(child.position, (5, 6, 7))
        low, high = scene.bounds
        self.assertEqual((low, high), ((-9, -9, 0), (9, 9, 0)))

    def test_matrices_of_directions(self):
        random = numpy.random.default_rng(3)
        for _ in range(20):
            position, target, up = random.normal(size=(3, 3))
            matrix = gnomon.look_at(position, target, up)
            turn = matrix[:3, :3]
            self.assertTrue(numpy.allclose(turn.T @ turn, numpy.eye(3)))
            self.assertAlmostEqual(numpy.linalg.det(turn), 1)
            self.assertTrue(numpy.allclose(-turn[:, 2], (target - position) / numpy.linalg.norm(target - position)))
            self.assertAlmostEqual(turn[:, 0] @ up, 0)
            self.assertGreater(turn[:, 1] @ up, 0)
            self.assertEqual((matrix[:3, 3] == position).all() and matrix[3].tolist(), [0, 0, 0, 1])
            angle = random.uniform(-4, 4)
            turned = gnomon.rotation(up, angle)
            self.assertTrue(numpy.allclose(turned @ gnomon.rotation(-up, angle), numpy.eye(4)))
            self.assertTrue(numpy.allclose(turned[:3, :3] @ up, up))
            self.assertAlmostEqual(numpy.trace(turned), 2 + 2 * math.cos(angle))
        self.assertTrue(numpy.allclose(gnomon.rotation((0, 0, 5), math.pi / 2)[:3, 0], (0, 1, 0)))
        for use in (lambda: gnomon.look_at((0, 0, 0), (0, 1, 0)), lambda: gnomon.look_at((1, 1, 1), (1, 1, 1)),
                    lambda: gnomon.rotation((0, 0, 0), 1), lambda: gnomon.look_at((0, 0, 0), (math.nan, 0, 1))):
            with self.assertRaises(ValueError):
                use()

    def test_scenes_are_pickled(self):
        for scene in (square_scene(), gnomon.load(PLAZA), gnomon.Scene()):
            for again in (pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene)):
                self.assertIsNot(again, scene)
                self.assertEqual([node.name for node in again.nodes], [node.name for node in scene.nodes])
                for a, b in zip(scene.nodes, again.nodes):
                    self.assertTrue((a.world_from_node == b.world_from_node).all())
                for a, b in zip(scene.meshes, again.meshes):
                    self.assertTrue((a.positions == b.positions).all() and (a.triangles == b.triangles).all())
                self.assertEqual([(lamp.name, lamp.kind, lamp.intensity) for lamp in again.lamps],
                                 [(lamp.name, lamp.kind, lamp.intensity) for lamp in scene.lamps])
                # A file names what has no name.
                named = pickle.loads(pickle.dumps(again))
                self.assertEqual(pickle.dumps(pickle.loads(pickle.dumps(named))), pickle.dumps(named))
        scene = square_scene()
        scene.remove(scene.lamps[0])
        scene.remove(scene.cameras[0])
        again = pickle.loads(pickle.dumps(scene))
        self.assertEqual((again.lamps, again.cameras, len(again.nodes)), ([], [], 3))
        mesh = scene.meshes[0]
        scene.add_mesh(mesh.positions, mesh.normals, mesh.triangles, name="spare")
        scene.add_material(name="spare")
        scene.add_lamp(name="spare")
        scene.add_surface_function(name="spare", text="void surface(SurfaceInputs inputs, inout StandardSurface result) {}")
        again = copy.deepcopy(scene)
        for names in ("meshes", "materials", "lamps", "cameras", "surface_functions"):
            self.assertEqual([each.name for each in getattr(again, names)], [each.name for each in getattr(scene, names)])
        again.meshes[0].positions = 2 * mesh.positions
        again.lamps[-1].name = "other"
        self.assertEqual((mesh.positions.max(), scene.lamps[-1].name), (9, "spare"))
        with self.assertWarnsRegex(UserWarning, "no node uses is not pickled: 1 meshes, 1 materials, 1 lamps, 1 surface functions$"):
            pickle.dumps(scene)
        scene.remove(scene.nodes[0])
        with self.assertRaisesRegex(ValueError, "without a mesh"):
            pickle.dumps(scene)
        with self.assertRaises(TypeError):
            pickle.dumps(square_scene().nodes[0])

    def test_every_property_takes_its_own_value(self):
        scene = square_scene()
        for things in (scene.nodes, scene.meshes, scene.materials, scene.lamps, scene.cameras):
            thing = things[0]
            names = [name for name, member in inspect.getmembers(type(thing)) if isinstance(member, property)]
            for name in names:
                if name != "world_from_node":
                    before = getattr(thing, name)
                    setattr(thing, name, before)
                    self.assertTrue(numpy.all(getattr(thing, name) == before), name)

    def test_arrays_and_tuples_cannot_be_changed_in_place(self):
        node = square_scene().nodes[0]
        with self.assertRaises(ValueError):
            node.parent_from_node[0, 3] = 1
        with self.assertRaises(TypeError):
            node.position[0] = 1

    def test_removed_things_are_stale(self):
        scene = square_scene()
        lamp, node, other = scene.lamps[0], scene.nodes[1], square_scene()
        scene.remove(lamp)
        self.assertIsNone(node.lamp)
        for use in (lambda: lamp.intensity, lambda: setattr(lamp, "intensity", 1), lambda: lamp.edit(),
                    lambda: scene.remove(lamp), lambda: setattr(node, "lamp", lamp)):
            with self.assertRaisesRegex(gnomon.StaleHandle, "lamp of handle .* was removed"):
                use()
        self.assertEqual(repr(lamp), "<gnomon.Lamp, removed>")
        self.assertEqual(repr(node), "<gnomon.Node 'sun'>")
        with self.assertRaisesRegex(gnomon.InvalidEdit, "lamp 'sun' is of another scene"):
            node.lamp = other.lamps[0]
        scene.remove(node)
        with self.assertRaises(gnomon.StaleHandle):
            node.world_from_node

    def test_wrong_values_are_named_and_change_nothing(self):
        scene = square_scene()
        lamp, camera, node = scene.lamps[0], scene.cameras[0], scene.nodes[0]
        for error, text, use in (
                (gnomon.InvalidEdit, "lamp 'sun': intensity -1 is not", lambda: lamp.edit(angle=0.1, intensity=-1)),
                (gnomon.InvalidEdit, "lamp 'sun': color nan is not", lambda: lamp.edit(angle=0.1, color=(1, math.nan, 1))),
                (TypeError, "lamp 'sun': intensity cannot be 'much'", lambda: lamp.edit(angle=0.1, intensity="much")),
                (TypeError, r"lamp 'sun': color cannot be \(1, 2\)", lambda: lamp.edit(angle=0.1, color=(1, 2))),
                (TypeError, "lamp 'sun': intensity cannot be None: it is not a number$", lambda: lamp.edit(intensity=None)),
                (TypeError, "color cannot be 'red': it is not 3 numbers$", lambda: lamp.edit(color="red")),
                (TypeError, "kind cannot be 1: it is not a gnomon.LampKind$", lambda: lamp.edit(kind=1)),
                (TypeError, "shadow_kind cannot be 1: it is not a gnomon.ShadowKind or None$", lambda: lamp.edit(shadow_kind=1)),
                (TypeError, "shadow_bias cannot be '': it is not a number or None$", lambda: lamp.edit(shadow_bias="")),
                (TypeError, "name cannot be 3: it is not a text$", lambda: lamp.edit(name=3)),
                (TypeError, "lamp cannot be .*: it is not a gnomon.Lamp or None$", lambda: node.edit(lamp=node)),
                (TypeError, "meshes cannot be .*: it is not a list, of which each is a gnomon.Mesh$", lambda: node.edit(meshes=node)),
                (TypeError, "is_visible cannot be 'yes': it is not True or False$", lambda: node.edit(is_visible="yes")),
                (TypeError, "lamp 'sun' has no property 'power'; it has: name, extras, kind", lambda: lamp.edit(angle=0.1, power=1)),
                (gnomon.InvalidEdit, "camera 'eye': near -1 is not above 0", lambda: setattr(camera, "near", -1)),
                (gnomon.InvalidEdit, "camera 'eye': vertical_angle 4 ", lambda: setattr(camera, "vertical_angle", 4)),
                (gnomon.InvalidEdit, r"node 'square': its matrix has 1e\+300 in row 1 and column 3, which is not from -1e\+12 to 1e\+12$",
                 lambda: setattr(node, "position", (0, 1e300, 0))),
                (gnomon.InvalidEdit, "node", lambda: setattr(node, "parent", node)),
                (TypeError, "node 'square': parent_from_node", lambda: setattr(node, "parent_from_node", [1, 2])),
                (gnomon.InvalidEdit, "world", lambda: scene.set_world(strength=-1)),
                (gnomon.InvalidEdit, r"world: its color times its strength is 1e\+31, 10, 10, which is above 1e\+30",
                 lambda: scene.set_world(color=(1e30, 1, 1), strength=10))):
            with self.assertRaisesRegex(error, text):
                use()
        self.assertEqual((lamp.angle, camera.near), (0, numpy.float32(0.1)))
        with self.assertRaises(AttributeError):
            lamp.power = 1

    def test_arrays_of_meshes_are_not_converted(self):
        scene = gnomon.Scene()
        corners, normals = numpy.zeros((3, 3), numpy.float32), numpy.ones((3, 3), numpy.float32)
        triangle = numpy.array([(0, 1, 2)], numpy.uint32)
        for error, text, arrays in ((TypeError, "positions.*float64", (corners.astype(float), normals, triangle)),
                                    (ValueError, "normals", (corners, normals[:, :2], triangle)),
                                    (TypeError, "triangles.*int64", (corners, normals, triangle.astype(int))),
                                    (gnomon.InvalidEdit, "2 normals for 3", (corners, normals[:2], triangle)),
                                    (gnomon.InvalidEdit, "index 3", (corners, normals, triangle + numpy.uint32(1)))):
            with self.assertRaisesRegex(error, text):
                scene.add_mesh(*arrays)
        for text, colors in (("mesh: colors is not", corners), ("mesh '': 2 colours for 3", numpy.ones((2, 4), numpy.float32)),
                             ("mesh '': colour 0 is not from 0 to 1", numpy.full((3, 4), 1.1, numpy.float32))):
            with self.assertRaisesRegex(gnomon.InvalidEdit, text):
                scene.add_mesh(corners, normals, triangle, colors=colors)
        with self.assertRaisesRegex(gnomon.InvalidEdit, "normal 2 is not finite"):
            scene.add_mesh(corners, numpy.float32([(0, 0, 1), (0, 0, 1), (math.nan, 0, 1)]), triangle)
        self.assertEqual(scene.meshes, [])

    def test_arrays_of_meshes_are_read_and_replaced(self):
        scene = square_scene()
        mesh = scene.meshes[0]
        self.assertEqual((mesh.positions.shape, mesh.normals.shape, mesh.uvs.shape), ((4, 3), (4, 3), (0, 2)))
        self.assertEqual(mesh.triangles.tolist(), [[0, 1, 2], [0, 2, 3]])
        self.assertEqual((mesh.positions.dtype, mesh.triangles.dtype), (numpy.float32, numpy.uint32))
        with self.assertRaisesRegex(ValueError, "read-only"):
            mesh.positions[0, 0] = 1
        mesh.positions = 2 * mesh.positions
        self.assertEqual(scene.bounds, ((-18, -18, 0), (18, 18, 0)))
        # Both triangles mirror the image in other ways, so that their tangents split vertices. The arrays stay those that were set.
        uvs = numpy.array([(0, 0), (1, 0), (1, 1), (2, 0)], numpy.float32)
        mesh.edit(uvs=uvs, triangles=mesh.triangles[::-1], positions=mesh.positions, normals=mesh.normals)
        corners = mesh.positions[mesh.triangles]
        self.assertEqual(corners.tolist(), numpy.array(
            [[(-18, -18, 0), (18, 18, 0), (-18, 18, 0)], [(-18, -18, 0), (18, -18, 0), (18, 18, 0)]]).tolist())
        self.assertEqual(mesh.uvs[mesh.triangles].tolist(), uvs[[(0, 2, 3), (0, 1, 2)]].tolist())
        for error, text, arrays in ((TypeError, "mesh '': positions is an array of float64, not of float32",
                                     {"positions": mesh.positions.astype(float)}),
                                    (TypeError, "triangles is an array of int64, not of uint32", {"triangles": 3}),
                                    (gnomon.InvalidEdit, "uvs is not an array of rows of 2 numbers", {"uvs": mesh.normals}),
                                    (gnomon.InvalidEdit, "normals", {"normals": mesh.normals[:3]})):
            with self.assertRaisesRegex(error, text):
                mesh.edit(**arrays)
        plaza = gnomon.load(PLAZA)
        torus = max(plaza.meshes, key=lambda each: len(each.positions))
        self.assertGreater(len(torus.triangles), 100)
        lengths = numpy.linalg.norm(torus.normals, axis=1)
        self.assertLess(abs(lengths - 1).max(), 1e-5)

    def test_files_elsewhere_can_be_refused(self):
        triangle = numpy.float32([[-1, 0, -1], [1, 0, -1], [0, 0, 1]]).tobytes()
        document = {"asset": {"version": "2.0"}, "buffers": [{"uri": "../a.bin", "byteLength": 36}],
                    "bufferViews": [{"buffer": 0, "byteLength": 36}],
                    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                                   "min": [-1, 0, -1], "max": [1, 0, 1]}],
                    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}],
                    "scenes": [{"nodes": [0]}], "scene": 0}
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "a.bin").write_bytes(triangle)
            (Path(folder) / "inner").mkdir()
            path = Path(folder) / "inner" / "a.gltf"
            path.write_text(json.dumps(document))
            gnomon.load(path)
            gnomon.load(path, only_below=folder)
            with self.assertRaisesRegex(gnomon.FileError, "a.bin': is not below"):
                gnomon.load(path, only_below=path.parent)
            # As pathlib has it, and not "anywhere": a service's variable may be empty by mistake.
            with self.assertRaisesRegex(gnomon.FileError, "a.bin': is not below"):
                gnomon.load(path, only_below="")

    def test_settings_of_shadows_of_lamps(self):
        scene = square_scene()
        lamp = scene.lamps[0]
        for name, value in (("size_px", 64), ("bias", 2), ("clip_start", 0.5), ("clip_end", 9), ("exponent", 40),
                            ("filter_angle", 0.25), ("esm_size_px", 32)):
            name = f"shadow_{name}"
            self.assertIsNone(getattr(lamp, name))
            setattr(lamp, name, value)
            self.assertEqual(getattr(lamp, name), value)
            with self.assertRaisesRegex(gnomon.InvalidEdit, f"lamp 'sun': {name} .* is not"):
                setattr(lamp, name, -1)
            self.assertEqual(getattr(lamp, name), value)
        with self.assertRaisesRegex(gnomon.InvalidEdit, "shadow_clip_end 0.25 is not above shadow_clip_start 0.5"):
            lamp.shadow_clip_end = 0.25
        lamp.edit(shadow_clip_end=None, shadow_bias=None)
        self.assertEqual((lamp.shadow_clip_end, lamp.shadow_bias, lamp.shadow_clip_start), (None, None, 0.5))

    def test_files(self):
        with tempfile.TemporaryDirectory() as folder:
            broken = os.path.join(folder, "broken.glb")
            with open(broken, "wb") as file:
                file.write(b"glTF or not")
            for path in (broken, os.path.join(folder, "none.glb")):
                with self.assertRaisesRegex(gnomon.FileError, re.escape(path)):
                    gnomon.load(path)
            scene = square_scene()
            saved = os.path.join(folder, "saved.glb")
            scene.save(saved)
            loaded = gnomon.load(saved)
            self.assertEqual([node.name for node in loaded.nodes], ["square", "sun", "eye"])
            parts = []
            gnomon.load(saved, progress=parts.append)
            self.assertEqual((parts[0], parts[-1]), (0.0, 1.0))
            self.assertEqual(parts, sorted(parts))

            def stop(part):
                if part > 0.3:
                    raise KeyboardInterrupt(str(part))

            with self.assertRaises(KeyboardInterrupt):
                gnomon.load(saved, progress=stop)
            self.assertEqual(loaded.materials[0].base_color, (0.5, 0.25, 0.125))
            named = os.path.join(folder, "named.gltf")
            scene.save(named)
            document = json.loads(Path(named).read_text())
            document["nodes"][0]["extras"] = {"price": 3}
            document["accessors"][0]["extras"] = {"by": "hand"}
            document["scenes"][0]["extras"] = {"season": "spring"}
            document["extras"] = {"licence": "free"}
            Path(named).write_text(json.dumps(document))
            marked = gnomon.load(named)
            self.assertEqual(marked.nodes[0].extras, '{"price":3}')
            self.assertEqual((marked.extras, marked.file_extras), ('{"season":"spring"}', '{"licence":"free"}'))
            marked.extras = '{"season": "autumn"}'
            marked.file_extras = ""
            marked.nodes[0].extras = '{"price": 4}'
            marked.meshes[0].extras = '{"parts": [1, 2]}'
            with self.assertWarnsRegex(UserWarning, "saved without its extra 'by' of accessor 0$"):
                marked.save(named)
            document = json.loads(Path(named).read_text())
            self.assertEqual(document["nodes"][0]["extras"], {"price": 4})
            self.assertEqual(document["scenes"][0]["extras"], {"season": "autumn"})
            self.assertNotIn("extras", document)
            self.assertEqual(document["meshes"][0]["extras"], {"parts": [1, 2]})
            marked.nodes[0].extras = "[1, 2]"
            with self.assertRaisesRegex(gnomon.FileError, "node 'square': its extras are not a JSON object"):
                marked.save(named)
            with self.assertRaisesRegex(gnomon.FileError, "nowhere"):
                scene.save(os.path.join(folder, "nowhere", "saved.glb"))
            for name in (b"/\xe9.glb", "/\udce9.glb"):
                with self.assertRaisesRegex(gnomon.FileError, "\udce9.glb: "):
                    gnomon.load(name)


class Pictures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.device = gnomon.Device()

    @classmethod
    def tearDownClass(cls):
        del cls.device
        gc.collect()

    def test_replaced_arrays_are_drawn(self):
        scene = square_scene()
        renderer = gnomon.Renderer(self.device, scene, (16, 16), **SMALL)
        whole = renderer.render()
        self.assertGreater(whole[:, :, 3].min(), 0.9999)
        mesh = scene.meshes[0]
        mesh.triangles = mesh.triangles[:1]
        half = renderer.render()
        self.assertAlmostEqual(half[:, :, 3].mean(), 0.5, delta=0.05)

    def test_colors_of_vertices_are_drawn(self):
        scene = square_scene()
        mesh = scene.meshes[0]
        self.assertEqual(mesh.colors.shape, (0, 4))
        renderer = gnomon.Renderer(self.device, scene, (16, 16), **SMALL)
        white = renderer.render()
        colors = numpy.float32([(0.5, 0.25, 1, 1)] * 4)
        mesh.colors = colors
        # Devices store 16 bits: the tolerance is half a step, relative to 0.25.
        numpy.testing.assert_allclose(renderer.render(), white * colors[0], rtol=4e-5)
        # Two triangles that mirror the image have tangents that split vertices.
        uvs = numpy.float32([(0, 0), (1, 0), (1, 1), (2, 0)])
        other = scene.add_mesh(mesh.positions, mesh.normals, mesh.triangles, uvs, colors=colors[:, ::-1], material=mesh.material)
        self.assertEqual(other.colors.tolist(), [colors[0, ::-1].tolist()] * len(other.positions))
        with self.assertRaisesRegex(gnomon.InvalidEdit, "2 colours for 4 positions"):
            scene.add_mesh(mesh.positions, mesh.normals, mesh.triangles, uvs, colors=colors[:2])

    def test_radiance_is_that_of_the_closed_form(self):
        renderer = gnomon.Renderer(self.device, square_scene(), (32, 18), **SMALL)
        picture = renderer.render()
        self.assertEqual((picture.shape, picture.dtype), ((18, 32, 4), numpy.float32))
        numpy.testing.assert_allclose(picture, numpy.broadcast_to((0.5, 0.25, 0.125, 1), picture.shape), rtol=1e-5)

    def test_vulkan_draws_the_same_picture(self):
        try:
            vulkan = gnomon.Device(backend="vulkan")
        except gnomon.DeviceError as error:
            self.skipTest(str(error))
        self.assertRegex(vulkan.description, r"^Vulkan 1\.")
        pictures = [
            gnomon.Renderer(device, square_scene(), (32, 18), **SMALL).render() for device in (self.device, vulkan)
        ]
        numpy.testing.assert_allclose(*pictures, rtol=1e-5)

    def test_multiple_scattering_makes_a_rough_metal_brighter(self):
        scene = square_scene()
        scene.materials[0].edit(metallic=1, roughness=1)
        renderer = gnomon.Renderer(self.device, scene, (32, 18), **SMALL)
        single = renderer.render()[:, :, :3]
        renderer.has_multiscatter = True
        self.assertTrue((renderer.render()[:, :, :3] > 1.05 * single).all())

    def test_a_surface_function_is_drawn_and_edited(self):
        scene = square_scene()
        function = scene.add_surface_function(
            name="red", text="void surface(SurfaceInputs inputs, inout StandardSurface result) { result.base_color = vec3(0.5, 0, 0); }")
        scene.materials[0].surface_function = function
        self.assertEqual(scene.materials[0].surface_function, scene.surface_functions[0])
        renderer = gnomon.Renderer(self.device, scene, (32, 18), **SMALL)
        numpy.testing.assert_allclose(renderer.render()[9, 16, :3], (0.5, 0, 0), atol=1e-5)
        function.text = "broken"
        numpy.testing.assert_allclose(renderer.render()[9, 16, :3], (2, 0, 2), atol=1e-5)
        self.assertIn("material 'grey'", renderer.report().warnings[0])
        scene.remove(function)
        self.assertIsNone(scene.materials[0].surface_function)
        numpy.testing.assert_allclose(renderer.render()[9, 16, :3], (0.5, 0.25, 0.125), atol=1e-5)

    def test_textures_are_drawn_edited_and_saved(self):
        scene = square_scene()
        corners = numpy.array([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], numpy.float32)
        # The picture shows less than one repetition.
        uvs = numpy.float32((0.5, 0.5)) + corners[:, :2] * numpy.float32((1 / 3.2, -1 / 3.2))
        material = scene.add_material(metallic=0.0, specular=0.0)
        square = scene.add_mesh(corners, numpy.array([(0, 0, 1)] * 4, numpy.float32),
                                numpy.array([(0, 1, 2), (0, 2, 3)], numpy.uint32), uvs, material=material)
        scene.nodes[0].meshes = [square]
        colors = numpy.array([[(255, 0, 0), (0, 255, 0)], [(0, 0, 255), (128, 128, 128)]], numpy.uint8)
        texture = scene.add_texture(colors.repeat(2, 0).repeat(2, 1), name="quarters")
        self.assertEqual((texture.name, repr(texture)), ("quarters", "<gnomon.Texture 'quarters'>"))
        self.assertEqual((texture.texels.shape, texture.texels[3, 3].tolist()), ((4, 4, 4), [128, 128, 128, 255]))
        with self.assertRaises(ValueError):
            texture.texels[0, 0, 0] = 1
        material.base_color_texture = texture
        self.assertEqual((material.base_color_texture, scene.textures), (texture, [texture]))
        renderer = gnomon.Renderer(self.device, scene, (32, 18), **SMALL)

        def quarters():
            return renderer.render()[[[3], [14]], [[4, 27]], :3]

        # sRGB's 128 is 0.21586.
        numpy.testing.assert_allclose(quarters(), [[(1, 0, 0), (0, 1, 0)], [(0, 0, 1), (0.21586,) * 3]], atol=2e-3)
        texture.texels = texture.texels[:, ::-1]
        numpy.testing.assert_allclose(quarters()[0], [(0, 1, 0), (1, 0, 0)], atol=2e-3)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "grey.png")
            output = OpenImageIO.ImageOutput.create(path)
            output.open(path, OpenImageIO.ImageSpec(5, 3, 3, "uint8"))
            output.write_image(numpy.full((3, 5, 3), 128, numpy.uint8))
            output.close()
            grey = scene.add_texture(path)
            self.assertEqual((grey.name, grey.texels.shape, grey.texels[1, 1, 3]), ("grey.png", (3, 5, 4), 255))
            material.base_color_texture = grey
            numpy.testing.assert_allclose(quarters(), numpy.full((2, 2, 3), 0.21586), atol=2e-3)
            saved = os.path.join(folder, "saved.glb")
            scene.save(saved)
            kept = [one.base_color_texture for one in gnomon.load(saved).materials if one.base_color_texture]
            self.assertEqual([one.texels[0, 0].tolist() for one in kept], [[128, 128, 128, 255]])
            for wrong in (saved, folder, os.path.join(folder, "none.png")):
                with self.assertRaisesRegex(gnomon.FileError, re.escape(wrong)):
                    scene.add_texture(wrong)
        # A normal that leans towards the right, on a square that has tangents.
        material.normal_texture = scene.add_texture(numpy.full((1, 1, 3), (218, 128, 218), numpy.uint8))
        numpy.testing.assert_allclose(quarters(), numpy.full((2, 2, 3), 0.21586 * 0.5**0.5), atol=3e-3)
        scene.remove(grey)
        self.assertIsNone(material.base_color_texture)
        with self.assertRaisesRegex(gnomon.StaleHandle, "texture"):
            grey.texels
        with self.assertRaisesRegex(gnomon.InvalidEdit, "texture is of another scene"):
            square_scene().materials[0].normal_texture = texture
        before = texture.texels
        for error, texels in ((TypeError, before / 2), (ValueError, before[0]), (ValueError, before[:0]), (ValueError, before[:, :, :2])):
            with self.assertRaises(error):
                texture.texels = texels
            with self.assertRaises(error):
                scene.add_texture(texels)
        self.assertTrue((texture.texels == before).all())

    def test_light_that_passes_is_not_scattered(self):
        scene = square_scene()
        scene.materials[0].transmission = 0.75
        picture = gnomon.Renderer(self.device, scene, (32, 18), **SMALL).render()[:, :, :3]
        numpy.testing.assert_allclose(picture, numpy.broadcast_to((0.125, 0.0625, 0.03125), picture.shape), rtol=1e-5)

    def test_first_row_is_the_top(self):
        scene = square_scene()
        scene.nodes[0].position = (0, -9, 0)
        picture = gnomon.Renderer(self.device, scene, (32, 18), **SMALL).render()
        self.assertEqual(picture[0, :, 3].max(), 0)
        self.assertAlmostEqual(float(picture[-1, :, 3].min()), 1, 6)

    def test_array_owns_its_memory(self):
        renderer = gnomon.Renderer(self.device, square_scene(), (32, 18), **SMALL)
        picture = renderer.render()
        self.assertEqual(type(picture.base).__name__, "PyCapsule")
        kept = picture.copy()
        renderer.render()
        renderer.size = (16, 16)
        self.assertEqual(renderer.render().shape, (16, 16, 4))
        del renderer
        gc.collect()
        self.assertTrue((picture == kept).all())

    def test_equal_the_files_of_the_program(self):
        scene = gnomon.load(PLAZA)
        renderer = gnomon.Renderer(self.device, scene, (96, 54), **SMALL | {"sample_count": 3, "seed": 7})
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "picture.exr")
            command = [os.environ["GNOMON_PROGRAM"], "render", PLAZA, "-o", path, "--size", "96x54", "--samples", "3",
                       "--shadow-size", "64", "--seed", "7"]
            subprocess.run(command, check=True, capture_output=True)
            expected = read_exr(path)
            self.assertTrue((renderer.render() == expected).all())
            renderer.background = (0.5, 0.25, 1)
            subprocess.run(command + ["--background", "0.5,0.25,1"], check=True, capture_output=True)
            self.assertTrue((renderer.render()[:, :, :3] == read_exr(path)).all())
            renderer.background = None
            renderer.has_multiscatter = True
            subprocess.run(command + ["--specular", "multi"], check=True, capture_output=True)
            self.assertTrue((renderer.render() == read_exr(path)).all())
            renderer.has_multiscatter = False
        renderer.seed = 8
        renderer.background = None
        self.assertTrue((renderer.render() != expected).any())

    def test_layers_equal_the_files_of_the_program(self):
        scene = gnomon.load(PLAZA)
        # Far from the origin, where floats on the device are relative to another.
        for node in scene.nodes:
            if node.parent is None:
                node.position = tuple(x + 3000 for x in node.position)
        names = ["combined", "depth", "position", "normal", "albedo", "roughness", "emission", "world", "light"]
        with tempfile.TemporaryDirectory() as folder:
            scene.save(f"{folder}/scene.glb")
            subprocess.run([os.environ["GNOMON_PROGRAM"], "render", f"{folder}/scene.glb", "-o", f"{folder}/layers.exr", "--size", "48x27",
                            "--samples", "2", "--aov", ",".join(names), "--background", "none"], check=True, stdout=subprocess.DEVNULL)
            file = OpenImageIO.ImageInput.open(f"{folder}/layers.exr")
            values = dict(zip(file.spec().channelnames, numpy.moveaxis(file.read_image("float"), -1, 0)))
        renderer = gnomon.Renderer.offline(self.device, scene, (48, 27), 2)
        layers = renderer.layers(names)
        compared = 0
        for name, array in layers.items():
            channels = numpy.moveaxis(array, -1, 0) if array.ndim == 3 else [array]
            letters = "RGBA" if name == "combined" else {"depth": "Z", "roughness": "V"}.get(name, "XYZ" if name in ("position", "normal") else "RGB")
            for letter, channel in zip(letters, channels):
                own = [letter, f"combined.{letter}"] if name == "combined" else [f"{name}.{letter}"]
                expected = next(values[each] for each in own if each in values)
                self.assertTrue((channel == expected).all(), f"{name}.{letter}")
                compared += 1
        self.assertGreaterEqual(compared, 4 + 1 + 3 + 3 + 3 + 1 + 3 + 3 + 3)
        self.assertTrue((renderer.render() == layers["combined"]).all())
        for error, text, use in ((ValueError, "no layer 'color'; there are: combined, depth", lambda: renderer.layers(["color"])),
                                 (gnomon.DeviceError, "noise_threshold", lambda: (setattr(renderer, "noise_threshold", 0.1), renderer.layers(["depth"])))):
            with self.assertRaisesRegex(error, text):
                use()

    def test_ids_are_indices_in_the_lists_of_the_scene(self):
        scene = square_scene()
        first = scene.add_node(name="gone")
        bare = scene.add_mesh(scene.meshes[0].positions * numpy.float32(0.1), scene.meshes[0].normals, scene.meshes[0].triangles)
        scene.add_node(name="small", meshes=[bare], position=(0, 0, 1))
        scene.remove(first)
        scene.remove(scene.nodes[0])
        renderer = gnomon.Renderer(self.device, scene, (32, 32), **SMALL)
        layers = renderer.layers(["ids"])
        self.assertEqual(set(layers), {"node_ids", "material_ids"})
        names = {scene.nodes[i].name for i in set(layers["node_ids"].flat) - {-1}}
        self.assertEqual(names, {"small"})
        self.assertEqual(set(layers["material_ids"].flat), {-1})

    def test_offline_equals_the_files_of_the_program(self):
        """With the sizes of shadows that the program chooses: smaller with one sample, larger and fitted with 16."""
        scene = gnomon.load(PLAZA)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "picture.exr")
            for sample_count in (1, 2, 16):
                subprocess.run([os.environ["GNOMON_PROGRAM"], "render", PLAZA, "-o", path, "--size", "96x54", "--samples",
                                str(sample_count)], check=True, capture_output=True)
                expected = read_exr(path)
                offline = gnomon.Renderer.offline(self.device, scene, (96, 54), sample_count=sample_count)
                self.assertTrue((offline.render() == expected).all(), sample_count)
                plain = gnomon.Renderer(self.device, scene, (96, 54), sample_count=sample_count)
                self.assertEqual(bool((plain.render() == expected).all()), sample_count == 2)
            self.assertEqual((offline.sample_count, offline.cube_size_px, offline.map_size_px), (16, 2048, 4096))
        with_values = gnomon.Renderer.offline(self.device, scene, (96, 54), 2, map_size_px=64, seed=3)
        self.assertEqual((with_values.sample_count, with_values.map_size_px, with_values.seed), (2, 64, 3))
        with self.assertRaisesRegex(TypeError, "no property 'power'"):
            gnomon.Renderer.offline(self.device, scene, (96, 54), power=1)
        with self.assertRaisesRegex(gnomon.DeviceError, "sample_count -1"):
            gnomon.Renderer.offline(self.device, scene, (96, 54), -1).render()

    def test_settings_are_those_of_the_program(self):
        """Each setting on which pictures depend, by its name, with the value that the program reports."""
        # Not of a renderer: display, import, and what changes no picture.
        others = {"view_transform", "exposure", "variant", "texture_size_max", "image_bytes_max",
                  "element_count_max", "lamp_units", "is_timed",
                  "layer_pass", "clustered_lamps_min"}
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "report.json")
            for sample_count in (1, 2, 16):
                subprocess.run([os.environ["GNOMON_PROGRAM"], "render", PLAZA, "--backend", "null", "--size", "16x8",
                                "--samples", str(sample_count), "--json", path], check=True, capture_output=True)
                with open(path, encoding="utf-8") as file:
                    settings = json.load(file)["settings"]
                offline = gnomon.Renderer.offline(self.device, square_scene(), (16, 8), sample_count=sample_count)
                self.assertEqual(set(gnomon.Renderer.__annotations__), set(settings) - others)
                for name in set(settings) - others:
                    value = getattr(offline, name)
                    words = value.name.lower() if isinstance(value, gnomon.ShadowKind) else value
                    self.assertEqual(words, settings[name], name)
                    setattr(offline, name, value)
                    self.assertEqual(getattr(offline, name), value, name)
        offline.pcf = "disk:9"
        offline.caster_faces = "back"
        offline.shadow_esm_format = gnomon.EsmFormat.HALF
        for name, wrong in (("pcf", "7x7"), ("caster_faces", "side"), ("shadow_filter_angle", 1.0),
                            ("cascade_count", 5), ("cube_size_px", 16385), ("shadow_bytes_max", 0),
                            ("light_threshold", -1.0), ("exposure", 1)):
            with self.assertRaises((gnomon.InvalidEdit, TypeError, AttributeError)):
                gnomon.Renderer(self.device, square_scene(), (16, 8), **{name: wrong})
        scene = gnomon.load(PLAZA, texture_size_max=1)
        self.assertTrue(all(max(texture.texels.shape[:2]) == 1 for texture in scene.textures))
        power = {units: sum(lamp.intensity for lamp in gnomon.load(PLAZA, lamp_units=units).lamps) for units in ("lumen", "raw")}
        self.assertAlmostEqual(power["raw"] / power["lumen"], 683, delta=1e-3)
        for wrong in ({"texture_size_max": -1}, {"texture_size_max": 2 ** 21}, {"texture_size": 4}, {"lamp_units": "W"}):
            with self.assertRaises((gnomon.InvalidEdit, TypeError)):
                gnomon.load(PLAZA, **wrong)

    def test_settings_that_cannot_be_drawn(self):
        scene = square_scene()
        renderer = gnomon.Renderer(self.device, scene, (32, 18), **SMALL)
        renderer.sample_count = 0
        with self.assertRaisesRegex(gnomon.DeviceError, "sample_count nor seconds_max"):
            renderer.render()
        for name, good, bad in (("light_threshold", 0.25, (-1, float("nan"))), ("emissive_point_count", 16, (-1, 17)),
                                ("sample_count", 2, (-1, 65537)), ("map_size_px", 64, (0, 16385))):
            setattr(renderer, name, good)
            for value in bad:
                with self.assertRaisesRegex(gnomon.InvalidEdit, f"renderer: {name} .* is not"):
                    setattr(renderer, name, value)
            self.assertEqual(getattr(renderer, name), good)
        renderer.emissive_point_count = None
        self.assertIsNone(renderer.emissive_point_count)
        with self.assertRaisesRegex(gnomon.InvalidEdit, "renderer: background"):
            renderer.background = "sky"
        with self.assertRaisesRegex(gnomon.DeviceError, "0x5"):
            renderer.size = (0, 5)
        with self.assertRaisesRegex(gnomon.InvalidEdit, "node 'square': has no camera"):
            renderer.render(scene.nodes[0])
        with self.assertRaisesRegex(gnomon.InvalidEdit, "node 'eye' is of another scene"):
            renderer.render(square_scene().nodes[2])
        with self.assertRaises(ValueError):
            renderer.render(seconds_max=math.nan)
        self.assertEqual(renderer.render().shape, (18, 32, 4))

    def test_other_threads(self):
        scene = square_scene()
        renderer = gnomon.Renderer(self.device, scene, (32, 18), **SMALL)
        outcomes = []

        def use():
            try:
                renderer.render()
            except gnomon.DeviceError as error:
                outcomes.append(str(error))

        thread = threading.Thread(target=use)
        thread.start()
        thread.join()
        self.assertEqual(len(outcomes), 1)
        self.assertIn("another thread", outcomes[0])

        # The last reference may be dropped anywhere.
        renderer.render()
        holder = [renderer]
        del renderer
        before = self.device.memory_bytes
        thread = threading.Thread(target=holder.clear)
        thread.start()
        thread.join()
        self.assertLess(self.device.memory_bytes, before)

    def test_forked_children_get_an_error(self):
        renderer = gnomon.Renderer(self.device, square_scene(), (32, 18), **SMALL)
        picture = renderer.render()
        held = [renderer, gnomon.Renderer(self.device, square_scene(), (32, 18), **SMALL)]
        del renderer

        def child(results):
            texts = []
            for use in (gnomon.Device, held[0].render, held[0].report, lambda: self.device.description,
                        lambda: gnomon.Renderer(self.device, square_scene(), (8, 8)),
                        lambda: setattr(held[0], "sample_count", 3), lambda: setattr(held[0], "size", (9, 9))):
                try:
                    use()
                    texts.append("no error")
                except gnomon.DeviceError as error:
                    texts.append(str(error))
            held.clear()
            # Calls that need no device work.
            scene = gnomon.load("examples/scenes/full.gltf")
            results.put((texts, len(scene.nodes)))

        context = multiprocessing.get_context("fork")
        results = context.Queue()
        process = context.Process(target=child, args=(results,))
        process.start()
        try:
            texts, node_count = results.get(timeout=60)
            process.join(60)
            self.assertEqual(process.exitcode, 0)
        finally:
            process.kill()
        self.assertEqual(len(texts), 7)
        for text in texts:
            self.assertIn("forked", text)
            self.assertIn("spawn", text)
        self.assertGreater(node_count, 5)
        # The parent draws on.
        numpy.testing.assert_array_equal(held[0].render(), picture)
        spawned = multiprocessing.get_context("spawn").Process(target=gnomon.Device)
        spawned.start()
        spawned.join(60)
        self.assertEqual(spawned.exitcode, 0)

    def test_others_run_while_one_draws(self):
        scene = square_scene()
        renderer = gnomon.Renderer(self.device, scene, (32, 18), **SMALL | {"sample_count": 0})
        errors = []
        is_done = threading.Event()

        def edit():
            while not is_done.is_set() and not errors:
                try:
                    scene.lamps[0].intensity = 1
                except gnomon.InvalidEdit as error:
                    errors.append(str(error))

        thread = threading.Thread(target=edit)
        thread.start()
        picture = renderer.render(seconds_max=0.3)
        is_done.set()
        thread.join()
        self.assertEqual(errors, ["the scene cannot be edited while it is drawn or read"])
        self.assertTrue(numpy.isfinite(picture).all())
        self.assertGreaterEqual(renderer.report().sample_count, 1)

    def test_signals_end_a_picture(self):
        renderer = gnomon.Renderer(self.device, square_scene(), (32, 18), **SMALL | {"sample_count": 0})
        seen = []

        def interrupt(*_):
            try:
                renderer.render()
            except gnomon.DeviceError as error:
                seen.append(str(error))
            raise KeyboardInterrupt

        before = signal.signal(signal.SIGALRM, interrupt)
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        try:
            with self.assertRaises(KeyboardInterrupt):
                renderer.render(seconds_max=100)
        finally:
            signal.signal(signal.SIGALRM, before)
        self.assertEqual(seen, ["the device is drawing"])
        renderer.sample_count = 2
        self.assertEqual(renderer.render().shape, (18, 32, 4))

    def test_progress_is_told_and_may_end_a_picture(self):
        renderer = gnomon.Renderer(self.device, square_scene(), (32, 18), **SMALL | {"sample_count": 5})
        seen = []
        renderer.render(progress=seen.append)
        renderer.layers(["depth"], progress=seen.append)
        self.assertEqual(seen, 2 * [1, 2, 3, 4, 5])

        def end(sample_count):
            if sample_count == 2:
                raise StopIteration("enough")

        for draw in (renderer.render, lambda progress: renderer.layers(["depth"], progress=progress)):
            with self.assertRaisesRegex(StopIteration, "enough"):
                draw(progress=end)
            self.assertEqual(renderer.report().sample_count, 2)

    def test_mattes_are_coverages_by_name(self):
        scene = square_scene()
        scene.nodes[0].parent_from_node = numpy.diag([0.05, 0.05, 1.0, 1.0])
        other = scene.add_material(name="other")
        scene.add_node(name="far", meshes=[scene.add_mesh(
            scene.meshes[0].positions, scene.meshes[0].normals, scene.meshes[0].triangles, material=other)], position=(0, 0, -1))
        renderer = gnomon.Renderer(self.device, scene, (32, 18), sample_count=64)
        layers = renderer.layers(["crypto_object", "crypto_material", "combined", "normal"])
        names = {"crypto_object": ("square", "far"), "crypto_material": ("grey", "other")}
        covered = {}
        for layer, (near, far) in names.items():
            ranks = numpy.concatenate([layers[f"{layer}.{i}"].reshape(18, 32, 2, 2) for i in range(3)], axis=2)
            self.assertTrue((ranks[:, :, :-1, 1] >= ranks[:, :, 1:, 1]).all())
            for name in near, far:
                covered[name] = numpy.where(ranks[..., 0] == numpy.float32(gnomon.cryptomatte_id(name)), ranks[..., 1], 0).sum(axis=2)
            numpy.testing.assert_allclose(covered[near] + covered[far], layers["combined"][..., 3], atol=1e-6)
        numpy.testing.assert_array_equal(covered["square"], covered["grey"])
        # 0.9 m wide, 4 m before the eye.
        height = 0.9 / (8 * math.tan(0.2)) * 18
        self.assertAlmostEqual(covered["square"].sum(), height**2, delta=0.02 * height**2)
        self.assertEqual(gnomon.cryptomatte_hash("hello"), 0x248BFA47)

    def test_refined_pictures_are_complete_ones_at_last(self):
        scene = gnomon.load(PLAZA)
        renderer = gnomon.Renderer(self.device, scene, (48, 27), sample_count=3, map_size_px=256, cube_size_px=256)
        lamp = next(lamp for lamp in scene.lamps if lamp.kind == gnomon.LampKind.SUN)
        for intensity in (1.0, 2.0):
            lamp.intensity = intensity
            # Also the first picture after a change shows it.
            first, is_complete = renderer.refine(1e-4)
            self.assertFalse(is_complete)
            for _ in range(1000):
                picture, is_complete = renderer.refine(0.05)
                if is_complete:
                    break
            # Without a change, it is the same array.
            self.assertIs(renderer.refine(0.05)[0], picture)
            complete = renderer.render()
            self.assertTrue((picture == complete).all())
            self.assertLess(abs(first.mean() / complete.mean() - 1), 0.05)
            self.assertIsNot(renderer.refine(0.05)[0], picture)
        with self.assertRaisesRegex(gnomon.DeviceError, "budget"):
            renderer.refine(0.0)

    def test_settings_are_described(self):
        descriptions = gnomon.Renderer.descriptions()
        self.assertEqual({name: each.type for name, each in descriptions.items()}, gnomon.Renderer.__annotations__)
        offline = gnomon.Renderer.offline(self.device, square_scene(), (16, 9), sample_count=64)
        for name, each in descriptions.items():
            self.assertEqual(getattr(offline, name), each.default, name)
            self.assertTrue(each.label and each.sentence, name)
            if each.type in ("int", "float"):
                with self.assertRaises((gnomon.InvalidEdit, TypeError)):
                    setattr(offline, name, type(each.default)(2 * each.max + 1))
            elif each.type == "bool":
                self.assertEqual(len(each.words), 2)
            elif each.words and "Literal" in each.type:
                for word in each.words:
                    setattr(offline, name, word)
        self.assertEqual(descriptions["shadow_kind"].words, [kind.lower() for kind in gnomon.ShadowKind.__members__])
        self.assertEqual(list(descriptions)[0], "sample_count")

    def test_error_against_rays(self):
        scene = square_scene()
        picture = gnomon.Renderer(self.device, scene, (32, 18), **SMALL).render()
        exact, noise = gnomon.trace(scene, (32, 18), sample_count=2)
        self.assertLess(noise, 1e-6)
        self.assertLess(gnomon.image_error(picture, exact).rmse, 1e-5)
        self.assertAlmostEqual(gnomon.image_error(picture + numpy.float32(0.5), exact).rmse, 0.5, 5)
        # Rows are compared with rows, whatever the strides.
        self.assertEqual(gnomon.image_error(picture, picture.copy()).rmse, 0)
        broken = picture.copy()
        broken[3, 5, 1] = math.nan
        self.assertEqual(gnomon.image_error(broken, exact).non_finite_count, 1)
        with self.assertRaisesRegex(ValueError, "31x18"):
            gnomon.image_error(picture, exact[:, 1:])
        with self.assertRaisesRegex(ValueError, "sample_count 3"):
            gnomon.trace(scene, (32, 18), sample_count=3)


class Mirrors(unittest.TestCase):
    """The part of the add-on for Blender that needs no Blender."""

    def test_properties_that_a_host_leaves_out_have_their_defaults(self):
        spec = importlib.util.spec_from_file_location(
            "mirror", Path(os.environ["GNOMON_SOURCE"], "integrations/blender/render_gnomon/mirror.py"))
        module = sys.modules["mirror"] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        mirror = module.Mirror(gnomon)
        image = numpy.zeros((2, 2, 4), numpy.uint8)
        glass = {"name": "m", "metallic": 0.0, "transmission": 1.0, "ior": 1.3, "alpha_mode": "MASK", "base_color_texture": "image"}
        sun = {"name": "l", "kind": "SUN", "angle": 0.1, "intensity": 3.0}
        spot = {"name": "l", "kind": "SPOT", "spot_blend": 0.5, "intensity": 2.0, "shadow_kind": "NONE"}
        for materials, lamps in (({"m": glass}, {"l": sun}), ({"m": {"name": "m"}}, {"l": spot}), ({"m": glass}, {"l": sun})):
            mirror.show(module.Content({"image": image}, materials, {}, lamps))
            new = module.Mirror(gnomon)
            new.show(module.Content({"image": image}, materials, {}, lamps))
            for thing, expected in ((mirror.materials["m"], new.materials["m"]), (mirror.lamps["l"], new.lamps["l"])):
                for name in (name for name in dir(thing) if isinstance(getattr(type(thing), name), property)):
                    if not name.endswith("_texture"):
                        self.assertEqual(getattr(thing, name), getattr(expected, name), name)
            self.assertEqual(mirror.materials["m"].base_color_texture is None, "base_color_texture" not in materials["m"])


class HostContext:
    """A context of OpenGL as a host has it, current on the thread, and its functions by name."""

    def __init__(self):
        self.egl = ctypes.CDLL("libEGL.so.1")
        for name in ("eglGetPlatformDisplay", "eglCreateContext", "eglGetProcAddress"):
            getattr(self.egl, name).restype = ctypes.c_void_p
        surfaceless = 0x31DD
        self.display = ctypes.c_void_p(self.egl.eglGetPlatformDisplay(surfaceless, None, None))
        opengl = 0x30A2
        version = (ctypes.c_int * 7)(0x3098, 4, 0x30FB, 5, 0x30FD, 1, 0x3038)
        if not self.egl.eglInitialize(self.display, None, None) or not self.egl.eglBindAPI(opengl):
            raise unittest.SkipTest("EGL has no display without surfaces")
        self.context = ctypes.c_void_p(self.egl.eglCreateContext(self.display, None, None, version))
        if not self.make_current():
            raise unittest.SkipTest("there is no OpenGL 4.5")

    def make_current(self, is_current=True):
        return self.egl.eglMakeCurrent(self.display, None, None, self.context if is_current else None)

    def __getattr__(self, name):
        return ctypes.CFUNCTYPE(None, *{"glClearColor": [ctypes.c_float] * 4, "glClearDepth": [ctypes.c_double]}.get(name, ()))(
            self.egl.eglGetProcAddress(name.encode()))

    def integer(self, name):
        value = ctypes.c_int(-1)
        self.glGetIntegerv(name, ctypes.byref(value))
        return value.value

    def framebuffer(self, width, height):
        """The name of a framebuffer with colours and depths of floats, cleared to 0.25 and 1."""
        names = (ctypes.c_uint * 3)()
        self.glGenFramebuffers(1, names)
        self.glGenRenderbuffers(2, ctypes.byref(names, 4))
        self.glBindFramebuffer(0x8D40, names[0])
        for buffer, internal_format, attachment in ((names[1], 0x8814, 0x8CE0), (names[2], 0x8CAC, 0x8D00)):
            self.glBindRenderbuffer(0x8D41, buffer)
            self.glRenderbufferStorage(0x8D41, internal_format, width, height)
            self.glFramebufferRenderbuffer(0x8D40, attachment, 0x8D41, buffer)
        self.glClearColor(0.25, 0.25, 0.25, 0.25)
        self.glClearDepth(1.0)
        self.glClear(0x4100)
        return names[0]

    def pixels(self, width, height, is_depth=False):
        """Of the bound framebuffer; the top row is the first."""
        result = numpy.zeros((height, width) if is_depth else (height, width, 4), numpy.float32)
        self.glReadPixels(0, 0, width, height, 0x1902 if is_depth else 0x1908, 0x1406, ctypes.c_void_p(result.ctypes.data))
        return result[::-1]


class Hosts(unittest.TestCase):
    FRAMEBUFFER_BINDING = 0x8CA6

    def setUp(self):
        self.context = HostContext()
        self.addCleanup(self.context.make_current, False)

    def device(self):
        device = gnomon.Device(host=True)
        self.addCleanup(device.free)
        return device

    def test_a_picture_is_drawn_into_a_framebuffer(self):
        framebuffer = self.context.framebuffer(40, 30)
        renderer = gnomon.Renderer(self.device(), square_scene(), (32, 18), **SMALL)
        whole = renderer.render()
        near, far = 1.0, 16.0
        projection = numpy.array([(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, (near + far) / (near - far), 2 * near * far / (near - far)), (0, 0, -1, 0)])
        for _ in range(1000):
            is_complete = renderer.draw(
                0.05, framebuffer, (40, 30), (5, 2, 32, 18), encoding="linear", clip_from_view=projection)
            if is_complete:
                break
        self.assertTrue(is_complete)
        self.assertEqual(self.context.integer(self.FRAMEBUFFER_BINDING), framebuffer)
        pixels = self.context.pixels(40, 30)
        inside = numpy.zeros((30, 40), bool)
        inside[10:28, 5:37] = True
        numpy.testing.assert_array_equal(pixels[inside].reshape(18, 32, 4), whole)
        self.assertTrue((pixels[~inside] == 0.25).all())
        # The square is 4 m before the eye.
        ndc = (projection[2, 2] * -4 + projection[2, 3]) / 4
        depths = self.context.pixels(40, 30, is_depth=True)
        numpy.testing.assert_allclose(depths[inside], (ndc + 1) / 2, atol=1e-6)
        self.assertTrue((depths[~inside] == 1).all())
        del renderer

    def test_display_colours_are_those_of_the_view_transform(self):
        framebuffer = self.context.framebuffer(32, 18)
        renderer = gnomon.Renderer(self.device(), square_scene(), (32, 18), **SMALL)
        while not renderer.draw(0.05, framebuffer, (32, 18), view_transform="standard", exposure=-1):
            pass
        linear = numpy.array((0.25, 0.125, 0.0625))
        numpy.testing.assert_allclose(self.context.pixels(32, 18)[9, 16, :3], 1.055 * linear**(1 / 2.4) - 0.055, atol=1e-4)
        del renderer

    def test_mistakes_are_errors(self):
        device = self.device()
        framebuffer = self.context.framebuffer(32, 18)
        renderer = gnomon.Renderer(device, square_scene(), (32, 18), **SMALL)
        for arguments, error, message in (
                ({"encoding": "gamma"}, ValueError, "'linear'"),
                ({"exposure": 1e3}, gnomon.InvalidEdit, "exposure 1000 is not"),
                ({"view_transform": "none"}, gnomon.InvalidEdit, "'agx'"),
                ({"clip_from_view": numpy.zeros((4, 4))}, gnomon.DeviceError, "depth"),
                ({"rectangle": (0, 0, 0, 9)}, ValueError, "0x9 pixels is empty")):
            with self.assertRaisesRegex(error, message):
                renderer.draw(0.05, framebuffer, (32, 18), **arguments)
        with self.assertRaisesRegex(gnomon.DeviceError, "1 renderers"):
            device.free()
        self.context.make_current(False)
        with self.assertRaisesRegex(gnomon.DeviceError, "current"):
            renderer.draw(0.05, framebuffer, (32, 18))
        # Memory that was on the device is freed by the next call with the context.
        del renderer
        with self.assertRaisesRegex(gnomon.DeviceError, "current"):
            device.memory_bytes
        with self.assertRaisesRegex(gnomon.DeviceError, "current"):
            gnomon.Device(host=True)
        self.context.make_current()
        self.assertLess(device.memory_bytes, 1000)
        with self.assertRaisesRegex(gnomon.DeviceError, "host"):
            gnomon.Device(backend="vulkan", host=True)

    def test_a_freed_device_says_so(self):
        device = gnomon.Device(host=True)
        device.free()
        with self.assertRaisesRegex(gnomon.DeviceError, "was freed"):
            device.memory_bytes

    def test_a_device_of_its_own_draws_into_no_framebuffer_of_a_host(self):
        self.context.make_current(False)
        renderer = gnomon.Renderer(gnomon.Device(backend="gl"), square_scene(), (32, 18), **SMALL)
        with self.assertRaisesRegex(gnomon.DeviceError, "host"):
            renderer.draw(0.05, 0, (32, 18))


class Page(unittest.TestCase):
    """The examples of doc/python.md, in order."""

    def test_examples(self):
        with open("doc/python.md", encoding="utf-8") as file:
            examples = re.findall(r"```python\n(.*?)```", file.read(), re.DOTALL)
        names = {}
        for example in examples:
            exec(example, names)
        self.assertLessEqual(len(examples[0].strip().splitlines()), 15)
        pictures = names["pictures"]
        self.assertEqual(len(pictures), 24)
        for before, after in zip(pictures, pictures[1:]):
            self.assertTrue(numpy.isfinite(after).all())
            self.assertGreater(abs(before - after).max(), 1e-3)
        self.assertLess(names["error"].rmse, 0.02)
        self.check_data_set(names, [len(each.strip().splitlines()) for each in examples if "samples = []" in each])
        built = gnomon.Renderer(names["device"], names["built"], (16, 16), **SMALL).render()
        self.assertAlmostEqual(float(built[8, 8, 0]), 0.5, 5)
        # Only one device can exist at a time.
        with self.assertRaisesRegex(gnomon.DeviceError, "already current"):
            gnomon.Device()
        with self.assertRaisesRegex(ValueError, "'metal' is none of auto, gl, vulkan"):
            gnomon.Device("metal")
        names.clear()

    def check_data_set(self, names, line_counts):
        """Depth, normals and ids against the rays of a unit sphere at the origin and a floor at y = -1."""
        self.assertEqual((len(line_counts), line_counts[0] <= 25), (1, True))
        nodes = names["still"].nodes
        for matrix, layers in names["samples"]:
            height, width = layers["depth"].shape
            slope = math.tan(0.35)
            across = (2 * (numpy.arange(width) + 0.5) / width - 1) * slope * width / height
            up = (1 - 2 * (numpy.arange(height) + 0.5) / height) * slope
            x, y = numpy.meshgrid(across, up)
            # With a depth of 1.
            rays = numpy.stack([x, y, -numpy.ones_like(x)], axis=-1) @ matrix[:3, :3].T
            eye = matrix[:3, 3]
            a, b, c = (rays * rays).sum(-1), rays @ eye, eye @ eye - 1
            with numpy.errstate(invalid="ignore"):
                ball = (-b - numpy.sqrt(b * b - a * c)) / a
                floor = (-1 - eye[1]) / rays[..., 1]
            on_floor = eye + floor[..., None] * rays
            floor = numpy.where((floor > 0) & (abs(on_floor[..., [0, 2]]).max(-1) < 10), floor, numpy.inf)
            is_ball = numpy.nan_to_num(ball, nan=numpy.inf) < floor
            # The sphere has flat triangles, and rims are not compared.
            discriminant = (b * b - a * c) / a
            sure = (abs(discriminant) > 0.05) & ((floor == numpy.inf) | (abs(on_floor[..., [0, 2]]).max(-1) < 9.5))
            expected = numpy.where(is_ball, nodes.index(names["ball"]), numpy.where(floor < numpy.inf, nodes.index(names["floor"]), -1))
            self.assertGreater((sure & is_ball).sum(), 100)
            self.assertGreater((sure & ~is_ball & (floor < numpy.inf)).sum(), 100)
            self.assertTrue((layers["node_ids"] == expected)[sure].all())
            grey = names["still"].materials.index(names["grey"])
            self.assertTrue((layers["material_ids"] == numpy.where(expected < 0, -1, grey))[sure].all())
            depth = numpy.where(is_ball, ball, numpy.where(floor < numpy.inf, floor, 1e10))
            self.assertLess(abs(layers["depth"] / depth - 1)[sure].max(), 1e-3)
            normal = numpy.where(is_ball[..., None], eye + depth[..., None] * rays, numpy.array([0, 1, 0]))
            self.assertLess(abs(layers["normal"] - normal)[sure & (expected >= 0)].max(), 0.02)


class Stub(unittest.TestCase):
    """The stub has what the module has, and all of it has a documentation."""

    def test_names(self):
        with open(os.path.join(os.path.dirname(gnomon.__file__), "__init__.pyi"), encoding="utf-8") as file:
            body = ast.parse(file.read()).body
        stub = {}
        properties = {}
        for node in body:
            if isinstance(node, ast.ClassDef) and node.name.endswith("Properties"):
                properties[node.name] = {member.target.id for member in node.body}
            if isinstance(node, ast.FunctionDef):
                stub[node.name] = None
            elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                members = {getattr(member, "name", None) or getattr(getattr(member, "target", None), "id", None)
                           for member in node.body}
                stub[node.name] = {name for name in members if name and not name.startswith("_")}
        module = {}
        for name, value in vars(gnomon).items():
            if name.startswith("_"):
                continue
            module[name] = None
            self.assertTrue(value.__doc__ or issubclass(value, gnomon.Error), name)
            self.assertEqual(value.__module__, "gnomon", name)
            if inspect.isclass(value):
                own = {each: member for each, member in vars(value).items() if not each.startswith("_")}
                if hasattr(value, "__members__"):
                    own = value.__members__
                else:
                    for each, member in own.items():
                        self.assertTrue(inspect.getdoc(member), f"{name}.{each}")
                module[name] = set(own)
        self.assertEqual(stub, module)
        # The message for an argument that does not exist names those that do.
        scene = square_scene()
        scene.add_surface_function(name="plain", text="void surface(SurfaceInputs inputs, inout StandardSurface result) {}")
        things = (scene.nodes, scene.meshes, scene.materials, scene.surface_functions, scene.lamps, scene.cameras)
        for thing in [each[0] for each in things]:
            with self.assertRaises(TypeError) as raised:
                thing.edit(nonsense=1)
            taken = set(str(raised.exception).split("it has: ")[1].split(", "))
            self.assertEqual(properties.pop(f"_{type(thing).__name__}Properties"), taken)
        with self.assertRaisesRegex(TypeError, "it has: (.*)") as raised:
            gnomon.load(PLAZA, nonsense=1)
        self.assertEqual(properties.pop("_LoadProperties"), set(str(raised.exception).split("it has: ")[1].split(", ")))
        self.assertEqual(properties.pop("_DrawProperties"), {"view_transform", "exposure"})
        own = {each for each, member in vars(gnomon.Renderer).items() if isinstance(member, property)}
        self.assertEqual(properties, {"_RendererProperties": {"sample_count"},
                                      "_OfflineProperties": own - {"size", "sample_count"}})

    @unittest.skipUnless(shutil.which("mypy"), "mypy is not installed")
    def test_types(self):
        """The examples of the documentation have the types of the stub, which find mistakes."""
        with open("doc/python.md", encoding="utf-8") as file:
            examples = "".join(re.findall(r"^```python\n(.*?)^```$", file.read(), re.M | re.S))
        mistakes = ["gnomon.Scene().add_lamp(intensty=1)", "gnomon.Scene().add_lamp(kind=3)", "gnomon.load(3)", 'gnomon.load("a.glb", lamp_units="watt")',
                    "gnomon.Scene().meshes[0].edit(positions=[(0, 0, 0)])", "gnomon.Scene().lamps[0].power = 3"]
        with tempfile.TemporaryDirectory() as folder:
            def checked(text):
                path = os.path.join(folder, "example.py")
                with open(path, "w", encoding="utf-8") as file:
                    file.write(text)
                # Packages on the path that have a stub are checked, numpy and others are not.
                finished = subprocess.run(
                    ["mypy", "--enable-incomplete-feature=Unpack", "--follow-imports=silent", "--cache-dir", folder, path],
                    env={**os.environ, "MYPYPATH": os.path.dirname(os.path.dirname(gnomon.__file__))}, capture_output=True, text=True)
                return finished.stdout + finished.stderr
            self.assertIn("Success", checked(examples))
            for mistake in mistakes:
                self.assertIn("Found 1 error", checked(f"import gnomon\n{mistake}\n"), mistake)


if __name__ == "__main__":
    os.chdir(os.environ["GNOMON_SOURCE"])
    unittest.main()
