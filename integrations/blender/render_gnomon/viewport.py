# SPDX-License-Identifier: MIT
"""The viewport: pictures that a thread draws, shown as a texture.

Blender's main thread reads the depsgraph. A thread of each viewport has a device of its own, edits its scene and refines its picture, because
a device makes its context current on its thread, and Blender has its own on the main thread.
"""

import dataclasses
import math
import os
import subprocess
import tempfile
import threading

import bpy
import gpu
import numpy
from gpu_extras.presets import draw_texture_2d

from . import cameras, collect, mirror, settings, world

BAKE = os.path.join(os.path.dirname(__file__), 'bake_world.py')
# Width of the picture of a world, texels.
WORLD_WIDTH = 512
# Time of a part of the work. An edit waits for the part that is being done, and is shown after another one.
SECONDS = 1 / 30
# For so long, Blender's thread waits for the picture of an edit: its window is then drawn once for the edit, and overlays and picture agree.
WAIT_SECONDS = 0.1
# Between the first picture of an edit and its refinement, which would be in vain if another edit follows.
PAUSE_SECONDS = 0.1
# Between two looks for new pictures.
POLL_SECONDS = 0.02


class View:
    """The camera of a region.

    size: pixels; matrix: world from camera; camera: properties of a gnomon.Camera, without enumerators
    """

    def __init__(self, region, region_3d, thing=None):
        """thing: the camera that the region may look through."""
        self.size = region.width, region.height
        projection = region_3d.window_matrix
        self.matrix = collect.matrix_of(region_3d.view_matrix.inverted())
        scale_x, scale_y = projection[0][0], projection[1][1]
        z, w = projection[2][2], projection[2][3]
        self.is_perspective = projection[3][3] == 0.0
        # The middle of the region in widths and heights from the axis.
        middle = [projection[axis][2 if self.is_perspective else 3] / 2 for axis in (0, 1)]
        if self.is_perspective:
            aperture = cameras.aperture_of(thing) if thing is not None and region_3d.view_perspective == 'CAMERA' else {}
            self.camera = {'vertical_angle': 2 * math.atan(1 / scale_y), 'near': w / (z - 1), 'far': w / (z + 1),
                           'shift_x': middle[0], 'shift_y': middle[1], 'aperture_radius': 0.0, **aperture}
        else:
            self.camera = {'half_width': 1 / scale_x, 'half_height': 1 / scale_y, 'near': (w + 1) / z, 'far': (w - 1) / z,
                           'shift_x': -middle[0], 'shift_y': -middle[1]}

    def key(self):
        return self.size, self.is_perspective, tuple(self.camera.items()), self.matrix.tobytes()


class Painter:
    """A thread that draws one viewport. What Blender's thread wants is put into `wanted`, and what it may show is in `picture`."""

    def __init__(self):
        self.condition = threading.Condition()
        self.wanted = {}
        self.wanted_count = 0
        self.is_ended = False
        # (array, whether it is complete)
        self.picture = None
        # wanted_count of the picture.
        self.shown_count = 0
        self.error = None
        self.remarks = []
        self.is_new = False
        self.samples = 0
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def want(self, **wanted):
        with self.condition:
            self.wanted.update(wanted)
            self.wanted_count += 1
            self.condition.notify_all()

    def end(self):
        with self.condition:
            self.is_ended = True
            self.condition.notify_all()

    def take_wanted(self, seconds):
        """What is wanted, and how often it was; waits for it for so long. None: without an end."""
        with self.condition:
            self.condition.wait_for(lambda: self.wanted or self.is_ended, seconds)
            wanted, self.wanted = self.wanted, {}
            return wanted, self.wanted_count

    def publish(self, **values):
        with self.condition:
            for name, value in values.items():
                setattr(self, name, value)
            self.is_new = True
            self.condition.notify_all()

    def take_shown(self, seconds):
        """The picture, after all that is wanted is in it or the time is over. It does not wait for the first one."""
        with self.condition:
            if self.picture is not None:
                self.condition.wait_for(lambda: self.shown_count == self.wanted_count or self.error is not None, seconds)
            self.is_new = False
            return self.picture, self.error, self.samples

    def run(self):
        try:
            self.paint(settings.gnomon)
        except Exception as error:
            self.publish(error=f"{type(error).__name__}: {error}")

    def paint(self, gnomon):
        shown = mirror.Mirror(gnomon)
        device = renderer = view = None
        seconds, values, drawn = None, None, (None, False, 0)
        while True:
            wanted, count = self.take_wanted(seconds)
            if self.is_ended:
                return
            if 'content' in wanted:
                shown.show(wanted['content'])
            if 'view' in wanted:
                view = wanted['view']
                kind = gnomon.CameraKind.PERSPECTIVE if view.is_perspective else gnomon.CameraKind.ORTHOGRAPHIC
                shown.camera.edit(kind=kind, **view.camera)
                shown.eye.parent_from_node = view.matrix
            values = wanted.get('settings', values)
            if view is None or values is None:
                continue
            # A setting that is no longer set has its default again.
            if renderer is None or set(values) != names:
                del renderer
                device = device or gnomon.Device()
                renderer, names = gnomon.Renderer(device, shown.scene, view.size, **values), set(values)
            elif 'settings' in wanted:
                for name, value in values.items():
                    setattr(renderer, name, value)
            if renderer.size != view.size:
                renderer.size = view.size
            before, drawn = drawn, (*renderer.refine(SECONDS, shown.eye), count)
            is_complete = drawn[1]
            seconds = None if is_complete else PAUSE_SECONDS if count != before[2] else 0
            # The array is another one if the picture is.
            if drawn[0] is not before[0] or drawn[1:] != before[1:]:
                report = renderer.report()
                self.publish(picture=drawn[:2], shown_count=count, samples=report.sample_count, remarks=report.warnings + report.limits)


def baked(world_of_scene, done):
    """Bakes the picture of a world by a second Blender, and calls done(array or None, error) on a thread."""
    folder = tempfile.TemporaryDirectory()
    bpy.data.libraries.write(f"{folder.name}/world.blend", {world_of_scene}, path_remap='ABSOLUTE')
    command = [bpy.app.binary_path, '-b', '--factory-startup', '--python-exit-code', '1', '-P', BAKE, '--', folder.name, str(WORLD_WIDTH)]

    def wait():
        with folder:
            finished = subprocess.run(command, capture_output=True, text=True, check=False)
            if finished.returncode != 0:
                done(None, (finished.stdout + finished.stderr).strip()[-1000:])
            else:
                done(numpy.load(f"{folder.name}/world.npy"), None)

    threading.Thread(target=wait, daemon=True).start()


class Viewport:
    """One viewport of Blender. Its functions are called on Blender's thread."""

    all = []

    def __init__(self):
        self.painter = Painter()
        self.collector = collect.Collector()
        self.content = None
        self.view_key = None
        self.settings = None
        self.texture = None
        self.shown = None
        # Arguments of gnomon's Scene.set_world.
        self.world = None
        # The number of the last bake. Results of earlier ones are dropped.
        self.bake_count = 0
        self.remarks = []
        Viewport.all.append(self)
        if not bpy.app.timers.is_registered(poll):
            bpy.app.timers.register(poll, persistent=True)

    def end(self):
        self.painter.end()
        if self in Viewport.all:
            Viewport.all.remove(self)

    def update(self, context, depsgraph):
        scene = depsgraph.scene
        is_first = self.content is None
        content = self.collector.content(depsgraph, context.space_data)
        if is_first or any(update.id.bl_rna.identifier in ('World', 'ShaderNodeTree', 'Scene') or
                           update.id == scene.world for update in depsgraph.updates):
            self.update_world(scene.world)
        # A bake may end on its thread at any time.
        with self.painter.condition:
            self.content = content
            self.content.world = self.world
            self.painter.want(content=self.content)

    def update_world(self, blender_world):
        self.bake_count += 1
        radiance = world.constant_radiance(blender_world)
        if radiance is not None:
            self.set_world({'color': tuple(max(c, 0.0) for c in radiance)})
            return
        number = self.bake_count

        def done(picture, error):
            with self.painter.condition:
                if number != self.bake_count:
                    return
                if error is not None:
                    self.painter.publish(error=f"the world: {error}")
                    return
                self.set_world({'picture': picture})
                # The first update takes the world itself, once it has its content.
                if self.content is not None:
                    self.content = dataclasses.replace(self.content, world=self.world)
                    self.painter.want(content=self.content)

        baked(blender_world.original, done)

    def set_world(self, values):
        if self.world is None or 'picture' in values or values != self.world:
            self.world = values

    def draw(self, engine, context, depsgraph):
        space = context.space_data
        view = View(context.region, context.region_data, space.camera if space.use_local_camera else context.scene.camera)
        if view.key() != self.view_key:
            self.view_key = view.key()
            self.painter.want(view=view)
        # The depsgraph has older ones.
        scene = context.scene
        chosen = {'sample_count': scene.gnomon.sample_count, 'background': None if scene.render.film_transparent else 'world',
                  **settings.chosen(scene.gnomon)}
        if chosen != self.settings:
            self.settings = chosen
            self.painter.want(settings=chosen)
        picture, error, samples = self.painter.take_shown(WAIT_SECONDS)
        if error is not None:
            engine.update_stats("Gnomon", error)
        elif picture is not None:
            remarks = len(self.collector.remarks) + len(self.painter.remarks)
            engine.update_stats("Gnomon", f"{samples} of {self.settings['sample_count']} samples" +
                                (f", {remarks} remarks" if remarks else ""))
        if picture is None:
            return
        if self.shown is None or picture[0] is not self.shown[0]:
            self.texture = texture_of(picture[0])
        self.shown = picture
        gpu.state.blend_set('ALPHA_PREMULT')
        engine.bind_display_space_shader(depsgraph.scene)
        draw_texture_2d(self.texture, (0, 0), context.region.width, context.region.height)
        engine.unbind_display_space_shader()
        gpu.state.blend_set('NONE')


def texture_of(pixels):
    """A picture, linear, with its rows from the bottom."""
    rows = numpy.ascontiguousarray(pixels[::-1])
    data = gpu.types.Buffer('FLOAT', rows.size, rows.reshape(-1))
    return gpu.types.GPUTexture((rows.shape[1], rows.shape[0]), format='RGBA16F', data=data)


def poll():
    """Asks for a new drawing of the viewports that have new pictures."""
    is_new = False
    for viewport in Viewport.all:
        with viewport.painter.condition:
            is_new = is_new or viewport.painter.is_new
            viewport.painter.is_new = False
    if is_new:
        settings.redraw_viewports()
    return POLL_SECONDS if Viewport.all else None


def remarks():
    """What the viewports do not draw as in Blender."""
    return list(dict.fromkeys(text for each in Viewport.all for text in each.collector.remarks + each.painter.remarks))


def end_all():
    """Ends all threads. A device must not outlive its thread."""
    ended = list(Viewport.all)
    for viewport in ended:
        viewport.end()
    for viewport in ended:
        viewport.painter.thread.join()
