# SPDX-License-Identifier: MIT
"""Run by scripts/viewport_times in Blender's window: -- ROUNDS. Prints CPU seconds of EEVEE's viewport and of Gnomon's, and their ratios.

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
from window import run, viewport

ROUNDS = int(sys.argv[-1])
FRAMES = 5
LIMIT = 4
ENGINES = ('BLENDER_EEVEE', 'GNOMON')
# RMSE of a first picture to that of LIMIT samples.
FIRST_RMSE = 0.1
# The last one is Blender's own share: it draws its window once for each of EEVEE's frames, and twice for Gnomon's.
MEASURES = ('first picture', 'frame, lamp moves', 'frame, view turns', 'redraw of a complete picture')
pictures = []
is_read = False
reading_seconds = 0.0


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
        painter = viewport.Viewport.all[0].painter
        while painter.shown_count != painter.wanted_count:
            time.sleep(0.001)
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
            is_complete = len(found) >= LIMIT
    is_read = False
    return found


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

    for i in range(ROUNDS + 1):
        for engine in ENGINES:
            own = times[engine]
            switch(engine, LIMIT)
            curve = refined()
            limit = curve[-1][1]
            first = next(seconds for seconds, picture in curve if rmse(picture, limit) < FIRST_RMSE)
            redrawing = frames(lambda i: None, draw)
            moving, turning = frames(move, shown), frames(turn, shown)
            lamp.location, view.view_rotation = place, rotation
            # The first round compiles shaders.
            if i > 0:
                for name, seconds in zip(MEASURES, (first, moving, turning, redrawing)):
                    own[name].append(seconds)
            yield
    print(f"  {'CPU seconds, medians':40} {'EEVEE':>8} {'Gnomon':>8} {'ratio':>8}")
    for name in MEASURES:
        medians = [statistics.median(times[engine][name]) for engine in ENGINES]
        ratio = statistics.median(own / other for other, own in zip(*(times[engine][name] for engine in ENGINES)))
        print(f"  {name:40} {medians[0]:8.3f} {medians[1]:8.3f} {ratio:8.3f}", flush=True)


run(steps, 'viewport_times', 3000)
