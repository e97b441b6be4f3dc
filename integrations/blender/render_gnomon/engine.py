# SPDX-License-Identifier: MIT
"""The render engine: F12 and `blender -b -E GNOMON -a`.

A render may run on a thread of its own, on which Blender's operators cannot. A second Blender therefore exports the scene, so that a
picture is that of `gnomon render` with the exported file.
"""

import json
import os
import subprocess
import tempfile

import bpy
import numpy

EXPORT = os.path.join(os.path.dirname(__file__), 'export_scene.py')


class ExportFailed(Exception):
    pass


def exported(depsgraph, folder):
    """Writes the scene of a depsgraph at its frame into a folder. Returns what export_scene.py says about it."""
    scene = depsgraph.scene.original
    bpy.data.libraries.write(f"{folder}/scene.blend", {scene}, path_remap='ABSOLUTE')
    done = subprocess.run(
        [bpy.app.binary_path, '-b', '--factory-startup', '--python-exit-code', '1', '-P', EXPORT, '--', folder, scene.name,
         depsgraph.view_layer.name, str(scene.frame_current_final)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise ExportFailed((done.stdout + done.stderr).strip()[-2000:])
    with open(f"{folder}/scene.json", encoding='utf-8') as file:
        return json.load(file)


def loaded(gnomon, folder, facts):
    scene = gnomon.load(f"{folder}/scene.glb")
    if facts['has_world_picture']:
        scene.set_world(picture=numpy.load(f"{folder}/world.npy"))
    return scene


class GnomonEngine(bpy.types.RenderEngine):
    bl_idname = 'GNOMON'
    bl_label = "Gnomon"
    bl_use_preview = False
    # The viewport is EEVEE's.
    bl_use_eevee_viewport = True

    def render(self, depsgraph):
        try:
            import gnomon
        except ImportError as error:
            self.fail(f"its Python module is not installed for Blender's Python (doc/from-blender.md): {error}")
            return
        try:
            self.render_picture(gnomon, depsgraph)
        except (ExportFailed, gnomon.Error) as error:
            self.fail(str(error))

    def fail(self, reason):
        # Unlike error_set, it keeps Blender from writing a file.
        self.report({'ERROR'}, f"Gnomon: {reason}")

    def render_picture(self, gnomon, depsgraph):
        scene = depsgraph.scene
        render = scene.render
        scale = render.resolution_percentage / 100
        width, height = int(render.resolution_x * scale), int(render.resolution_y * scale)
        self.update_stats("Gnomon", "Exporting the scene")
        with tempfile.TemporaryDirectory() as folder:
            facts = exported(depsgraph, folder)
            drawn = loaded(gnomon, folder, facts)
        if self.test_break():
            return
        remarks = facts['report'] + drawn.warnings
        if render.use_border:
            remarks.append("render region: the whole picture is drawn")
        self.update_progress(0.2)
        self.update_stats("Gnomon", "Drawing")
        renderer = gnomon.Renderer.offline(
            gnomon.Device(), drawn, (width, height), scene.gnomon.sample_count, background=None if render.film_transparent else 'world')
        layers = renderer.layers(['combined', 'depth', 'normal', 'albedo'])
        report = renderer.report()
        remarks += report.warnings + report.limits
        self.write(layers, width, height)
        for remark in remarks:
            self.report({'WARNING'}, f"Gnomon: {remark}")
        memory_mib = report.memory_bytes / 2**20
        self.update_memory_stats(memory_used=memory_mib, memory_peak=memory_mib)
        self.update_stats("Gnomon", f"{len(remarks)} things are not drawn as in Blender" if remarks else "")
        bpy.context.window_manager.gnomon_report = "\n".join(remarks)

    def write(self, layers, width, height):
        # World space of files has +Y up.
        x, y, z = numpy.moveaxis(layers['normal'], -1, 0)
        values = {'Combined': layers['combined'], 'Depth': layers['depth'], 'Normal': numpy.stack([x, -z, y], axis=-1),
                  'DiffCol': layers['albedo']}
        result = self.begin_result(0, 0, width, height)
        for each in result.layers[0].passes:
            if each.name in values:
                # Rows from the bottom.
                each.rect = values[each.name][::-1].reshape(-1, each.channels)
        self.end_result(result)

    def update_render_passes(self, scene, layer):
        self.register_pass(scene, layer, 'Combined', 4, 'RGBA', 'COLOR')
        if layer.use_pass_z:
            self.register_pass(scene, layer, 'Depth', 1, 'Z', 'VALUE')
        if layer.use_pass_normal:
            self.register_pass(scene, layer, 'Normal', 3, 'XYZ', 'VECTOR')
        if layer.use_pass_diffuse_color:
            self.register_pass(scene, layer, 'DiffCol', 3, 'RGB', 'COLOR')


class GnomonSettings(bpy.types.PropertyGroup):
    sample_count: bpy.props.IntProperty(name="Samples", default=64, min=1, max=65536, description="Samples of each pixel")


class EnginePanel:
    bl_space_type = 'PROPERTIES'
    bl_region_type = 'WINDOW'
    COMPAT_ENGINES = {'GNOMON'}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES


class GNOMON_PT_sampling(EnginePanel, bpy.types.Panel):
    bl_context = 'render'
    bl_label = "Sampling"

    def draw(self, context):
        self.layout.use_property_split = True
        self.layout.prop(context.scene.gnomon, 'sample_count')


class GNOMON_PT_passes(EnginePanel, bpy.types.Panel):
    bl_context = 'view_layer'
    bl_label = "Passes"

    def draw(self, context):
        self.layout.use_property_split = True
        for name in ('use_pass_z', 'use_pass_normal', 'use_pass_diffuse_color'):
            self.layout.prop(context.view_layer, name)


CLASSES = (GnomonSettings, GnomonEngine, GNOMON_PT_sampling, GNOMON_PT_passes)


def shared_panels():
    """Panels of Blender for things that Gnomon has, too: those for all engines, and EEVEE's of materials, lamps and worlds."""
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, 'COMPAT_ENGINES', ())
        if 'BLENDER_RENDER' in engines or ('BLENDER_EEVEE' in engines and getattr(panel, 'bl_context', '') in ('material', 'data', 'world')):
            yield panel


def register():
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.gnomon = bpy.props.PointerProperty(type=GnomonSettings)
    for panel in shared_panels():
        panel.COMPAT_ENGINES.add('GNOMON')


def unregister():
    for panel in shared_panels():
        panel.COMPAT_ENGINES.discard('GNOMON')
    del bpy.types.Scene.gnomon
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
