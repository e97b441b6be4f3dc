# SPDX-License-Identifier: MIT
"""The render engine in Blender, with its factory cube. Run by check_blender: blender -b --factory-startup -P engine_test.py -- FOLDER"""

import importlib
import os
import signal
import sys
import threading
import unittest
import unittest.mock

import bpy
import numpy

FOLDER = sys.argv[-1]
bpy.ops.preferences.addon_enable(module='render_gnomon')
engine = importlib.import_module('render_gnomon.engine')
settings = importlib.import_module('render_gnomon.settings')


def rendered(name):
    """The picture of F12: rows from the bottom."""
    scene = bpy.context.scene
    scene.render.filepath = f"{FOLDER}/{name}.exr"
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = numpy.empty(4 * image.size[0] * image.size[1], numpy.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(image.size[1], image.size[0], 4)


class EngineTest(unittest.TestCase):
    def setUp(self):
        bpy.ops.wm.read_homefile(use_factory_startup=True)
        self.scene = bpy.context.scene
        render = self.scene.render
        render.engine = 'GNOMON'
        render.resolution_x, render.resolution_y, render.resolution_percentage = 200, 100, 50
        render.image_settings.file_format, render.image_settings.color_depth = 'OPEN_EXR', '32'
        self.scene.gnomon.sample_count = 4

    def test_the_size_is_that_of_blender(self):
        render = self.scene.render
        # 100 · 0.29 is 28.999… in floats.
        render.resolution_x, render.resolution_y, render.resolution_percentage = 100, 111, 29
        self.assertEqual(rendered('size').shape, (32, 29, 4))

    def test_a_region_is_a_part_of_the_picture(self):
        whole = rendered('whole')
        render = self.scene.render
        render.use_border = True
        render.border_min_x, render.border_min_y, render.border_max_x, render.border_max_y = 0.3, 0.1, 0.8, 0.7
        left, bottom, right, top = engine.region_of(render, 100, 50)
        part = rendered('part')
        self.assertTrue((part[bottom:top, left:right] == whole[bottom:top, left:right]).all())
        self.assertEqual(abs(part).sum(), abs(part[bottom:top, left:right]).sum())
        render.use_crop_to_border = True
        numpy.testing.assert_array_equal(rendered('crop'), whole[bottom:top, left:right])

    def test_a_render_can_be_cancelled(self):
        # Blender without a window takes the first of these signals for Esc.
        loaded = engine.loaded

        def loaded_and_left(*arguments):
            threading.Timer(2, os.kill, (os.getpid(), signal.SIGINT)).start()
            return loaded(*arguments)

        self.scene.gnomon.sample_count = 65536
        self.scene.render.filepath = f"{FOLDER}/cancelled.exr"
        with unittest.mock.patch.object(engine, 'loaded', loaded_and_left):
            bpy.ops.render.render(write_still=True)
        self.assertFalse(os.path.exists(self.scene.render.filepath))

    def test_compositing_takes_mattes_by_name(self):
        """The cube's matte is its coverage: the alpha of a picture in which it is alone."""
        layer = bpy.context.view_layer
        layer.use_pass_cryptomatte_object = layer.use_pass_cryptomatte_material = True
        layer.pass_cryptomatte_depth = 4
        bpy.ops.mesh.primitive_plane_add(size=6, location=(0, 0, -1))
        self.scene.use_nodes = True
        tree = self.scene.node_tree
        tree.nodes.clear()
        render_layers, matte, composite = (
            tree.nodes.new(f"CompositorNode{kind}") for kind in ('RLayers', 'CryptomatteV2', 'Composite'))
        self.assertEqual([each.name for each in render_layers.outputs if each.enabled and each.name.startswith('Crypto')],
                         ['CryptoObject00', 'CryptoObject01', 'CryptoMaterial00', 'CryptoMaterial01'])
        matte.matte_id = 'Cube'
        tree.links.new(render_layers.outputs['Image'], matte.inputs['Image'])
        tree.links.new(matte.outputs['Matte'], composite.inputs['Image'])
        mask = rendered('matte')[:, :, 0]
        self.assertEqual(bpy.context.window_manager.gnomon_report, "")
        self.scene.use_nodes = False
        bpy.data.objects['Plane'].hide_render = True
        self.scene.render.film_transparent = True
        # The plane covers edges of the cube's picture from behind alone.
        numpy.testing.assert_allclose(mask, rendered('alone')[:, :, 3], atol=1e-5)
        self.assertGreater(((mask > 0.1) & (mask < 0.9)).sum(), 20)

    def test_settings_are_those_of_the_descriptions(self):
        own = self.scene.gnomon
        described = settings.gnomon.Renderer.descriptions()
        self.assertEqual(set(own.bl_rna.properties.keys()) - {'rna_type', 'name'}, set(described) - {'background'})
        own.property_unset('sample_count')
        self.assertEqual(settings.chosen(own), {})
        for name in settings.DESCRIPTIONS:
            setattr(own, name, getattr(own, name))
        values = settings.chosen(own)
        for name, value in values.items():
            if described[name].default is not None:
                self.assertEqual(value, described[name].default, name)
        self.assertEqual(set(values), set(settings.DESCRIPTIONS) - {'sample_count'})
        bpy.ops.gnomon.unset(setting='seed')
        self.assertNotIn('seed', settings.chosen(own))
        for panel in (settings.GNOMON_PT_picture, settings.GNOMON_PT_shadows, settings.GNOMON_PT_others):
            self.assertTrue(any(panel.has(name, each) for name, each in settings.DESCRIPTIONS.items()))

    def test_settings_are_drawn(self):
        bpy.ops.mesh.primitive_plane_add(size=20, location=(0, 0, -1))
        whole = rendered('hard')
        self.scene.gnomon.shadow_kind = 'none'
        bright = rendered('none')
        self.assertGreater(bright.mean(), whole.mean())
        self.scene.gnomon.noise_threshold = 0.1
        bpy.context.view_layer.use_pass_z = True
        with self.assertRaisesRegex(RuntimeError, "layers need"):
            rendered('fails')
        self.assertFalse(os.path.exists(f"{FOLDER}/fails.exr"))


sys.exit(not unittest.main(argv=['engine_test'], exit=False).result.wasSuccessful())
