# SPDX-License-Identifier: MIT
"""Run by scripts/viewport_times in Blender's window: -- ROUNDS. Prints CPU seconds of viewports: of an engine that draws nothing, which
are Blender's own share, of EEVEE's and of Gnomon's.

A picture is that of the window's framebuffer. The first picture is the first one that is like the engine's own with LIMIT samples.
"""

import os
import statistics
import sys
import time

import bpy
import gpu
import numpy
from mathutils import Euler

sys.path.insert(0, os.path.dirname(__file__))
from window import mirror, run, viewport

ROUNDS = int(sys.argv[-1])
FRAMES = 5
LIMIT = 4
ENGINES = ('NOTHING', 'BLENDER_EEVEE', 'GNOMON')
# RMSE of a first picture to that of LIMIT samples.
FIRST_RMSE = 0.1
MEASURES = ('first picture', 'frame, lamp moves', 'frame, view turns', 'redraw of a complete picture')
pictures = []
is_read = False
reading_seconds = 0.0


class Nothing(bpy.types.RenderEngine):
    bl_idname = 'NOTHING'
    bl_label = "Nothing"

    def view_update(self, context, depsgraph):
        pass

    def view_draw(self, context, depsgraph):
        pass


def clock():
    """CPU seconds of all threads, without those of reading pictures."""
    return time.process_time() - reading_seconds


def read():
    global reading_seconds
    if not is_read:
        return
    begun = time.thread_time()
    width, height = bpy.context.region.width, bpy.context.region.height
    pixels = gpu.state.active_framebuffer_get().read_color(0, 0, width, height, 4, 0, 'UBYTE')
    pixels.dimensions = width * height * 4
    pictures.append(numpy.array(pixels, numpy.uint8).reshape(height, width, 4)[:, :, :3] / 255)
    reading_seconds += time.thread_time() - begun


def area():
    return next(each for each in bpy.context.window_manager.windows[0].screen.areas if each.type == 'VIEW_3D')


def space():
    return area().spaces.active


def draw():
    """Draws the window."""
    area().tag_redraw()
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window, area=area(), region=next(each for each in area().regions if each.type == 'WINDOW')):
        bpy.ops.wm.redraw_timer(type='DRAW_WIN_SWAP', iterations=1)


def shown():
    """Draws until the picture shows all edits."""
    draw()
    if bpy.context.scene.render.engine == 'GNOMON':
        drawn = viewport.Viewport.all[0]
        while drawn.painter.shown_count != drawn.painter.wanted_count:
            time.sleep(0.001)
        if drawn.shown is not drawn.painter.picture:
            draw()


def rmse(a, b):
    return ((a - b)**2).mean()**0.5


def set_samples(count):
    bpy.context.scene.gnomon.sample_count = bpy.context.scene.eevee.taa_samples = count


def switch(engine, count):
    space().shading.type = 'SOLID'
    draw()
    bpy.context.scene.render.engine = engine
    set_samples(count)
    space().shading.type = 'RENDERED'


def refined():
    """(CPU seconds, picture) after each of the engine's draws, until LIMIT samples are drawn."""
    global is_read
    begun, found, last, is_read = clock(), [], None, True
    is_complete = False
    while not is_complete:
        pictures.clear()
        draw()
        found.append((clock() - begun, pictures[-1]))
        if bpy.context.scene.render.engine == 'GNOMON':
            painter = viewport.Viewport.all[0].painter
            is_complete = last is not None and last[1]
            while not is_complete and painter.picture is last:
                time.sleep(0.001)
            last = painter.picture
        else:
            is_complete = bpy.context.scene.render.engine == 'NOTHING' or len(found) >= LIMIT
    is_read = False
    return found


class Timed:
    """CPU seconds of each call of a method on its thread."""

    def __init__(self, owner, name):
        self.seconds = []
        method = getattr(owner, name)

        def timed(*arguments):
            begun = time.thread_time()
            method(*arguments)
            self.seconds.append(time.thread_time() - begun)

        setattr(owner, name, timed)


def frames(edit, show):
    """CPU seconds of a frame."""
    edit(0)
    show()
    begun = clock()
    for i in range(FRAMES):
        edit(i)
        show()
    return (clock() - begun) / FRAMES


def steps():
    bpy.utils.register_class(Nothing)
    scene = bpy.context.scene
    if not bpy.data.filepath:
        bpy.ops.mesh.primitive_plane_add(size=20, location=(0, 0, -1))
        bpy.data.objects['Light'].data.shadow_soft_size = 0.5
    scene.eevee.use_soft_shadows = True
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window, area=area()):
        bpy.ops.screen.screen_full_area(use_hide_panels=True)
    yield
    space().overlay.show_overlays = space().show_gizmo = False
    bpy.types.SpaceView3D.draw_handler_add(read, (), 'WINDOW', 'POST_PIXEL')
    lamp = next(each for each in scene.objects if each.type == 'LIGHT')
    view, place = space().region_3d, lamp.location.copy()
    rotation = view.view_rotation.copy()
    times = {engine: {name: [] for name in MEASURES} for engine in ENGINES}

    def move(i):
        lamp.location.x = place.x + 0.1 * i

    def turn(i):
        turned = rotation.copy()
        turned.rotate(Euler((0, 0, 0.02 * i)))
        view.view_rotation = turned

    reading, editing = Timed(viewport.Viewport, 'update'), Timed(mirror.Mirror, 'show')
    syncs = {name: [] for name in ('all', 'a lamp that moves')}
    for i in range(ROUNDS + 1):
        for engine in ENGINES:
            own = times[engine]
            reading.seconds.clear()
            editing.seconds.clear()
            switch(engine, LIMIT)
            curve = refined()
            first_reading = len(reading.seconds)
            limit = curve[-1][1]
            first = next(seconds for seconds, picture in curve if rmse(picture, limit) < FIRST_RMSE)
            redrawing = frames(lambda i: None, draw)
            moving, turning = frames(move, shown), frames(turn, shown)
            lamp.location, view.view_rotation = place, rotation
            # The first round compiles shaders.
            if i > 0 and engine == 'GNOMON':
                syncs['all'].append(reading.seconds[0] + editing.seconds[0])
                syncs['a lamp that moves'].append(statistics.median(reading.seconds[first_reading:]) + statistics.median(editing.seconds[1:]))
            if i > 0:
                for name, seconds in zip(MEASURES, (first, moving, turning, redrawing)):
                    own[name].append(seconds)
            yield
    print(f"  {'CPU seconds, medians':30} {'nothing':>8} {'EEVEE':>8} {'Gnomon':>8} {'ratio':>8} {'without nothing':>16}")
    for name in MEASURES:
        rounds = list(zip(*(times[engine][name] for engine in ENGINES)))
        nothing, eevee, own = map(statistics.median, zip(*rounds))
        ratio = statistics.median(gnomon / other for _, other, gnomon in rounds)
        print(f"  {name:30} {nothing:8.3f} {eevee:8.3f} {own:8.3f} {ratio:8.3f} {(own - nothing) / (eevee - nothing):16.3f}", flush=True)


    for name, seconds in syncs.items():
        print(f"  reading of the scene and edits, {name}: {1e3 * statistics.median(seconds):.2f} ms", flush=True)


run(steps, 'viewport_times', 3000)
