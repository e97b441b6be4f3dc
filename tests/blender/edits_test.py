# SPDX-License-Identifier: MIT
"""Edits by Blender's operators, in a window: blender --factory-startup -P edits_test.py -- LIBRARY FOLDER COUNT

LIBRARY is gl_state.cc. Each call of the add-on leaves OpenGL's state as Blender's own drawing leaves it. After each hundred edits,
the picture is that of a scene that is collected anew, bit for bit. The memory of the process does not grow with the number of edits.
"""

import collections
import ctypes
import os
import random
import sys
import time
import traceback

import bpy
import gpu

sys.path.insert(0, os.path.dirname(__file__))
from window import check, complete, run, viewport

LIBRARY, FOLDER, COUNT = sys.argv[-3:]
COUNT = int(COUNT)
CHECK_EVERY = 100
FILE = f"{FOLDER}/edits.blend"
library = ctypes.CDLL(LIBRARY)
library.gl_state_changes.restype = ctypes.c_char_p
# State that Blender's own functions change when they draw a texture. They set it anew before each use, and blending from gpu.state.
DRAWING = ('GL_CURRENT_PROGRAM', 'GL_VERTEX_ARRAY_BINDING', 'GL_ARRAY_BUFFER_BINDING', 'GL_VERTEX_BINDING_BUFFER', 'GL_TEXTURE_BINDING_2D, unit 0',
           'GL_SAMPLER_BINDING, unit 0', 'GL_BLEND')
calls = collections.Counter()
changed = collections.Counter()


def own_state():
    """The state that Blender sets before each of its draws."""
    state = gpu.state
    return (state.blend_get(), state.depth_test_get(), state.depth_mask_get(), state.line_width_get(), state.viewport_get(),
            gpu.matrix.get_model_view_matrix().freeze(), gpu.matrix.get_projection_matrix().freeze())


def checked(function):
    """A function of the add-on, around which Blender's state and OpenGL's are compared. Calls within a call belong to it."""
    def call(*arguments):
        own = own_state()
        library.gl_state_remember()
        try:
            result = function(*arguments)
        except Exception:
            # Blender would print it and go on.
            traceback.print_exc()
            sys.stderr.flush()
            os._exit(1)
        calls[function.__name__] += 1
        for line in filter(None, library.gl_state_changes().decode().split('\n')):
            changed[function.__name__, line.split(':')[0]] += 1
        if own != own_state():
            changed[function.__name__, f"gpu.state: {own} is {own_state()}"] += 1
        return result

    return call


for name in ('update', 'draw', 'end'):
    setattr(viewport.Viewport, name, checked(getattr(viewport.Viewport, name)))


def window():
    return bpy.context.window_manager.windows[0]


def viewports():
    return [each for each in window().screen.areas if each.type == 'VIEW_3D']


def do(operator, *, undo=True, **properties):
    """Calls an operator in the first viewport as a user would, if it can run."""
    area = viewports()[0]
    region = next(each for each in area.regions if each.type == 'WINDOW')
    with bpy.context.temp_override(window=window(), area=area, region=region):
        if operator.poll():
            operator('EXEC_DEFAULT', undo, **properties)


def object_mode():
    if bpy.context.view_layer.objects.active is not None:
        do(bpy.ops.object.mode_set, mode='OBJECT')


class Edits:
    def __init__(self):
        self.random = random.Random(1)
        kinds = {self.add: 8, self.delete: 5, self.move: 8, self.undo: 6, self.redo: 3, self.edit_mesh: 4, self.leave_mode: 4, self.modify: 4,
                 self.unmodify: 2, self.paint: 4, self.change_lamp: 4, self.key: 2, self.change_frame: 4, self.orbit: 4, self.hide: 2, self.open: 1,
                 self.split: 1, self.change_engine: 1, self.change_shading: 1}
        self.kinds = [kind for kind, weight in kinds.items() for _ in range(weight)]

    def next(self):
        kind = self.random.choice(self.kinds)
        kind()
        return kind.__name__

    def place(self):
        return [self.random.uniform(-3, 3) for _ in range(3)]

    def choose(self, *kinds):
        """Selects one object and returns it."""
        object_mode()
        there = [each for each in bpy.context.view_layer.objects
                 if (not kinds or each.type in kinds) and each.type != 'CAMERA' and each.visible_get()]
        if not there:
            return None
        do(bpy.ops.object.select_all, action='DESELECT')
        thing = self.random.choice(there)
        thing.select_set(True)
        bpy.context.view_layer.objects.active = thing
        return thing

    def add(self):
        object_mode()
        if len(bpy.context.view_layer.objects) < 20:
            add, properties = self.random.choice([
                (bpy.ops.mesh.primitive_cube_add, {}), (bpy.ops.mesh.primitive_monkey_add, {}), (bpy.ops.mesh.primitive_plane_add, {'size': 4}),
                (bpy.ops.object.text_add, {}), (bpy.ops.object.metaball_add, {}), (bpy.ops.curve.primitive_bezier_circle_add, {}),
                (bpy.ops.object.light_add, {'type': 'POINT'}), (bpy.ops.object.light_add, {'type': 'AREA'}), (bpy.ops.object.empty_add, {})])
            do(add, location=self.place(), **properties)

    def delete(self):
        if self.choose() is not None:
            do(bpy.ops.object.delete)

    def move(self):
        if self.choose() is not None:
            do(bpy.ops.transform.translate, value=self.place())
            do(bpy.ops.transform.rotate, value=self.random.uniform(-1, 1))

    def undo(self):
        do(bpy.ops.ed.undo, undo=False)

    def redo(self):
        do(bpy.ops.ed.redo, undo=False)

    def edit_mesh(self):
        if self.choose('MESH') is not None:
            do(bpy.ops.object.mode_set, mode='EDIT')
            do(bpy.ops.mesh.select_all, action='SELECT')
            do(self.random.choice([bpy.ops.mesh.flip_normals, bpy.ops.mesh.faces_shade_smooth, bpy.ops.mesh.quads_convert_to_tris]))
            do(bpy.ops.transform.resize, value=(1.1, 0.9, 1.0))

    def leave_mode(self):
        object_mode()

    def modify(self):
        thing = self.choose('MESH')
        if thing is not None and len(thing.modifiers) < 2:
            do(bpy.ops.object.modifier_add, type=self.random.choice(['BEVEL', 'MIRROR', 'SOLIDIFY', 'ARRAY', 'WIREFRAME']))

    def unmodify(self):
        thing = self.choose('MESH')
        if thing is not None and thing.modifiers:
            do(bpy.ops.object.modifier_remove, modifier=thing.modifiers[0].name)

    def paint(self):
        thing = self.choose('MESH')
        if thing is not None:
            if not thing.material_slots:
                do(bpy.ops.object.material_slot_add)
            material = bpy.data.materials.new('paint')
            material.use_nodes = True
            material.node_tree.nodes['Principled BSDF'].inputs['Base Color'].default_value = (*(self.random.random() for _ in range(3)), 1)
            thing.material_slots[0].material = material

    def change_lamp(self):
        thing = self.choose('LIGHT')
        if thing is not None:
            thing.data.energy *= self.random.uniform(0.5, 1.5)
            thing.data.type = self.random.choice(['POINT', 'SUN', 'SPOT', 'AREA'])

    def key(self):
        if self.choose() is not None:
            do(bpy.ops.anim.keyframe_insert_menu, type='Location')

    def change_frame(self):
        do(bpy.ops.screen.frame_offset, delta=self.random.choice([1, 7, -3]))

    def orbit(self):
        do(bpy.ops.view3d.view_orbit, angle=0.3, type='ORBITLEFT')

    def hide(self):
        if self.choose() is not None:
            do(bpy.ops.object.hide_view_set)
            do(bpy.ops.object.hide_view_clear)

    def open(self):
        object_mode()
        bpy.ops.wm.open_mainfile(filepath=FILE)

    def split(self):
        if len(viewports()) < 2:
            with bpy.context.temp_override(window=window(), area=viewports()[0]):
                bpy.ops.screen.area_split(direction='VERTICAL', factor=0.5)
        else:
            join()

    def change_engine(self):
        bpy.context.scene.render.engine = 'BLENDER_WORKBENCH' if bpy.context.scene.render.engine == 'GNOMON' else 'GNOMON'

    def change_shading(self):
        space = viewports()[-1].spaces.active
        space.shading.type = 'SOLID' if space.shading.type == 'RENDERED' else 'RENDERED'


def join():
    """Leaves one viewport."""
    while len(viewports()) > 1:
        with bpy.context.temp_override(window=window(), area=viewports()[-1]):
            bpy.ops.screen.area_close()


def memory_mib():
    with open('/proc/self/status', encoding='ascii') as file:
        return next(int(line.split()[1]) / 1024 for line in file if line.startswith('VmRSS'))


def show():
    """One viewport by Gnomon."""
    object_mode()
    join()
    bpy.context.scene.render.engine = 'GNOMON'
    viewports()[0].spaces.active.shading.type = 'RENDERED'


def steps():
    bpy.context.preferences.edit.undo_steps = 16
    scene = bpy.context.scene
    scene.render.engine = 'GNOMON'
    scene.gnomon.sample_count = 1
    scene.gnomon.map_size_px = scene.gnomon.cube_size_px = 256
    scene.frame_end = 240
    bpy.ops.wm.save_as_mainfile(filepath=FILE)
    edits, done, memory = Edits(), collections.Counter(), []
    show()
    yield from check()
    for i in range(COUNT):
        done[edits.next()] += 1
        yield
        if (i + 1) % CHECK_EVERY == 0:
            show()
            yield
            yield from check()
            edits.open()
            show()
            yield
            yield from complete()
            memory.append(memory_mib())
            print(f"after {i + 1} edits: {memory[-1]:.0f} MiB, {time.process_time():.0f} s of CPU time", flush=True)
    # Playback of all frames.
    thing = bpy.data.objects['Cube']
    for frame in (1, 240):
        thing.location.x = frame / 100
        thing.keyframe_insert('location', frame=frame)
    scene = bpy.context.scene
    scene.frame_set(1)
    scene.sync_mode = 'NONE'
    do(bpy.ops.screen.animation_play, undo=False)
    while scene.frame_current < 240:
        yield
    do(bpy.ops.screen.animation_cancel, undo=False, restore_frame=False)
    yield
    yield from check()
    print(dict(done), dict(calls), flush=True)
    assert all(name == 'draw' and item.startswith(DRAWING) for name, item in changed), f"changed: {dict(changed)}"
    assert calls['draw'] > COUNT / 2 and calls['update'] > COUNT / 4, calls
    half = len(memory) // 2
    assert half < 2 or min(memory[half:]) < 1.1 * min(memory[1:half]), memory


run(steps, 'edits', 3000)
