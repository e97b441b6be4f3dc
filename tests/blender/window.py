# SPDX-License-Identifier: MIT
"""Functions of the tests of the viewport. These run in Blender's window, as steps between which Blender draws."""

import importlib
import sys
import threading
import time
import traceback

import bpy

bpy.context.preferences.view.show_splash = False
bpy.ops.preferences.addon_enable(module='render_gnomon')
collect, mirror, settings, viewport = (importlib.import_module(f'render_gnomon.{name}') for name in ('collect', 'mirror', 'settings', 'viewport'))


def area():
    return next(each for each in bpy.context.window_manager.windows[0].screen.areas if each.type == 'VIEW_3D')


def region():
    return next(each for each in area().regions if each.type == 'WINDOW')


def space():
    return area().spaces.active


def complete(old=None):
    """Waits for a complete picture that is another than `old`. Yields until there is one."""
    while True:
        shown = viewport.Viewport.all[0] if viewport.Viewport.all else None
        if shown is not None and shown.painter.error is not None:
            raise RuntimeError(shown.painter.error)
        picture = shown and shown.painter.picture
        if picture and picture[1] and picture is not old and picture is shown.shown and \
                shown.painter.shown_count == shown.painter.wanted_count:
            return picture
        yield


def expected():
    """The picture of a renderer and a scene that are made anew."""
    shown = viewport.Viewport.all[0]
    collected = collect.Collector().content(bpy.context.evaluated_depsgraph_get(), space())
    collected.world = shown.content.world
    fresh = mirror.Mirror(settings.gnomon)
    fresh.show(collected)
    view = viewport.View(region(), space().region_3d, bpy.context.scene.camera)
    painter = Fresh(fresh, view, shown.settings)
    return painter.picture


class Fresh:
    """Draws on a thread of its own: Blender has a context on this one."""

    def __init__(self, shown, view, values):
        self.picture = None
        thread = threading.Thread(target=self.draw, args=(shown, view, values))
        thread.start()
        thread.join()

    def draw(self, shown, view, values):
        gnomon = settings.gnomon
        kind = gnomon.CameraKind.PERSPECTIVE if view.is_perspective else gnomon.CameraKind.ORTHOGRAPHIC
        shown.camera.edit(kind=kind, **view.camera)
        shown.eye.parent_from_node = view.matrix
        device = gnomon.Device()
        renderer = gnomon.Renderer(device, shown.scene, view.size, **values)
        self.picture = renderer.render(shown.eye)
        del renderer, device


def check(old=None):
    picture = yield from complete(old)
    own = expected()
    assert picture[0].shape == own.shape, (picture[0].shape, own.shape)
    error = abs(picture[0] - own).max()
    assert error == 0, f"the picture differs by {error}"
    return picture


def run(steps, name, seconds_max):
    """Runs a generator, prints "NAME: OK" if it ends, and quits Blender."""
    running = steps()
    start = time.monotonic()

    def step():
        try:
            next(running)
            assert time.monotonic() - start < seconds_max, "the time is over"
            return 0.05
        except StopIteration:
            print(f"{name}: OK", flush=True)
        except Exception:
            traceback.print_exc()
        viewport.end_all()
        sys.stdout.flush()
        sys.stderr.flush()
        bpy.ops.wm.quit_blender()
        return None

    bpy.app.timers.register(step, first_interval=1.0, persistent=True)
