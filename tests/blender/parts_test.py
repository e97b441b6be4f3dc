#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The parts of the add-on for Blender that need no Blender, against mathematics. Argument: the folder of the add-on."""

import importlib
import math
import sys
import types
import unittest

import numpy

sys.dont_write_bytecode = True
# The package itself imports Blender's modules.
package = types.ModuleType("render_gnomon")
package.__path__ = [sys.argv[1]]
sys.modules["render_gnomon"] = package
closed = importlib.import_module("render_gnomon.closed")
lamps = importlib.import_module("render_gnomon.lamps")
objects = importlib.import_module("render_gnomon.objects")
# The other modules need only names of Blender, and the arguments of its properties.
kinds = ('Bool', 'Enum', 'Float', 'Int', 'String', 'Pointer')
sys.modules["bpy"] = types.SimpleNamespace(
    types=types.SimpleNamespace(PropertyGroup=object, Operator=object, Panel=object),
    props=types.SimpleNamespace(**{f"{kind}Property": lambda **arguments: arguments for kind in kinds}))
sys.modules["gpu"] = types.ModuleType("gpu")
sys.modules["gpu_extras"] = types.ModuleType("gpu_extras")
sys.modules["gpu_extras.presets"] = types.SimpleNamespace(draw_texture_2d=None)
# They read Blender's things.
for name in ("cameras", "collect", "world"):
    sys.modules[f"render_gnomon.{name}"] = types.ModuleType(name)
settings = importlib.import_module("render_gnomon.settings")
viewport = importlib.import_module("render_gnomon.viewport")

BOX_TRIANGLES = numpy.array([(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2),
                             (1, 3, 7), (1, 7, 5)])


def box(a, b, c, place=(0, 0, 0)):
    return numpy.array([(x, y, z) for z in (0, c) for y in (0, b) for x in (0, a)]) + place


class LightLinking(unittest.TestCase):
    """Blender has it from 4.0 on."""

    def remarks(self, **collections):
        linking = types.SimpleNamespace(**{'receiver_collection': None, 'blocker_collection': None, **collections})
        return objects.light_remarks_of(types.SimpleNamespace(light_linking=linking))

    def test_is_named(self):
        self.assertEqual(objects.light_remarks_of(types.SimpleNamespace()), [])
        self.assertEqual(self.remarks(), [])
        for name in ('receiver_collection', 'blocker_collection'):
            self.assertIn("light linking is not drawn", self.remarks(**{name: object()})[0])


class MeanChord(unittest.TestCase):
    def test_of_boxes(self):
        for a, b, c in ((1, 1, 1), (2, 1, 0.01), (1e-3, 1e-3, 2e-3), (300, 100, 200)):
            for place in ((0, 0, 0), (1000, -500, 20)):
                expected = 4 * a * b * c / (2 * (a * b + b * c + c * a))
                for triangles in (BOX_TRIANGLES, BOX_TRIANGLES[:, ::-1]):
                    self.assertAlmostEqual(closed.mean_chord(box(a, b, c, place), triangles) / expected, 1, 6)

    def test_of_separate_corners(self):
        """Each triangle with vertices of its own, as where normals are sharp."""
        positions = box(1, 2, 3)[BOX_TRIANGLES].reshape(-1, 3).astype(numpy.float32)
        positions += numpy.random.default_rng(1).uniform(-1e-7, 1e-7, positions.shape)
        self.assertAlmostEqual(closed.mean_chord(positions, numpy.arange(36).reshape(-1, 3)), 4 * 6 / 22, 5)

    def test_of_shells(self):
        """A box within a box, turned inside out: the wall."""
        positions = numpy.concatenate([box(1, 1, 1), box(0.5, 0.5, 0.5, (0.25, 0.25, 0.25))])
        triangles = numpy.concatenate([BOX_TRIANGLES, BOX_TRIANGLES[:, ::-1] + 8])
        self.assertAlmostEqual(closed.mean_chord(positions, triangles), 4 * (1 - 0.125) / (6 + 1.5), 6)

    def test_is_none_where_nothing_is_closed(self):
        for triangles in (BOX_TRIANGLES[:-1], BOX_TRIANGLES[:0], numpy.concatenate([BOX_TRIANGLES, BOX_TRIANGLES[:1]])):
            self.assertIsNone(closed.mean_chord(box(1, 1, 1), triangles))
        self.assertIsNone(closed.mean_chord(box(1, 1, 0), BOX_TRIANGLES))
        self.assertIsNone(closed.mean_chord(numpy.zeros((3, 3)), numpy.array([(0, 1, 2)])))


    def test_is_endless_behind_an_open_surface_and_zero_in_a_plane(self):
        self.assertEqual(closed.thickness(box(1, 1, 1), BOX_TRIANGLES[:-1]), closed.ENDLESS)
        self.assertEqual(closed.thickness(box(2, 2, 2), BOX_TRIANGLES), closed.mean_chord(box(2, 2, 2), BOX_TRIANGLES))
        self.assertEqual(closed.thickness(box(1, 1, 1, (3, 4, 5)), BOX_TRIANGLES[:2]), 0)
        self.assertEqual(closed.thickness(box(1, 1, 1), BOX_TRIANGLES[:0]), 0)


class Lamps(unittest.TestCase):
    def test_temperature_and_exposure_of_later_versions(self):
        lamp = types.SimpleNamespace(type='POINT', color=(1, 1, 0.5), energy=10.0, use_nodes=False, use_temperature=True,
                                     temperature_color=(1, 0.5, 0.5), exposure=2.0)
        color, intensity, remarks = lamps.punctual(lamp)
        self.assertEqual((color, remarks), ([1, 0.5, 0.25], []))
        self.assertAlmostEqual(intensity, 40 / (4 * math.pi) * 683)


class Settings(unittest.TestCase):
    def test_without_a_default_have_their_least_value(self):
        description = types.SimpleNamespace(name="count", label="count", sentence="A number.", type="int | None", words=[], unit="", default=None,
                                            min=1.0, max=16.0, zero=True)
        self.assertEqual({key: (type(value), value) for key, value in settings.property_of("count", description).items() if key in ('default', 'min', 'max')},
                         {'default': (int, 1), 'min': (int, 0), 'max': (int, 16)})


class Renderer:
    """Refines a picture by two samples, each in two calls."""

    size = 1, 1
    calls = 0

    def __init__(self, device, scene, size):
        self.pictures = [numpy.zeros(1), numpy.ones(1)]

    def refine(self, seconds, camera):
        Renderer.calls += 1
        return self.pictures[Renderer.calls // 3 % 2], Renderer.calls >= 5

    def report(self):
        return types.SimpleNamespace(sample_count=0, warnings=[], limits=[])


class Painter(unittest.TestCase):
    def test_shows_pictures_that_are_new_and_waits_for_those_of_edits(self):
        shown = types.SimpleNamespace(camera=types.SimpleNamespace(edit=lambda **_: None), eye=types.SimpleNamespace(), scene=None)
        viewport.mirror = types.SimpleNamespace(Mirror=lambda gnomon: shown)
        viewport.settings = types.SimpleNamespace(gnomon=types.SimpleNamespace(
            Device=object, Renderer=Renderer, CameraKind=types.SimpleNamespace(PERSPECTIVE=0)))
        published = []

        class Watched(viewport.Painter):
            def publish(self, **values):
                published.append((values['picture'][0][0], values['picture'][1], values['shown_count']))
                super().publish(**values)

        painter = Watched()
        self.assertEqual(painter.take_shown(60), (None, None, 0))
        view = types.SimpleNamespace(size=(1, 1), is_perspective=True, camera={}, matrix=None)
        painter.want(view=view, settings={})
        with painter.condition:
            self.assertTrue(painter.condition.wait_for(lambda: len(published) == 3, 60))
        self.assertEqual((published, Renderer.calls), ([(0, False, 1), (1, False, 1), (1, True, 1)], 5))
        painter.want(view=view)
        self.assertEqual(painter.take_shown(60)[0][0][0], 0)
        self.assertEqual((published[3], painter.is_new), ((0, True, 2), False))
        painter.end()
        painter.thread.join()


unittest.main(argv=["parts_test"])
