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

from . import settings, viewport

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


class Cancelled(Exception):
    pass


class Pass:
    """A pass of Blender, and the layer of Gnomon that it shows. array: the name of the layer's array, if it is another."""

    def __init__(self, name, channels, kind, option, layer, array=None):
        self.name = name
        self.channels = channels
        self.kind = kind
        self.option = option
        self.layer = layer
        self.array = array or layer

    def is_of(self, view_layer):
        return self.option is None or getattr(view_layer, self.option)


class Matte(Pass):
    """One of the passes of a Cryptomatte, each of which holds two levels."""

    def __init__(self, stem, option, layer, index):
        super().__init__(f"{stem}{index:02}", 'RGBA', 'COLOR', option, layer, f"{layer}.{index}")
        self.stem = stem
        self.index = index

    def is_of(self, view_layer):
        return super().is_of(view_layer) and 2 * self.index < view_layer.pass_cryptomatte_depth


PASSES = (
    Pass('Combined', 'RGBA', 'COLOR', None, 'combined'),
    Pass('Depth', 'Z', 'VALUE', 'use_pass_z', 'depth'),
    Pass('Position', 'XYZ', 'VECTOR', 'use_pass_position', 'position'),
    Pass('Normal', 'XYZ', 'VECTOR', 'use_pass_normal', 'normal'),
    Pass('DiffCol', 'RGB', 'COLOR', 'use_pass_diffuse_color', 'albedo'),
    Pass('Emit', 'RGB', 'COLOR', 'use_pass_emit', 'emission'),
    Pass('Env', 'RGB', 'COLOR', 'use_pass_environment', 'world'),
    *(Matte('CryptoObject', 'use_pass_cryptomatte_object', 'crypto_object', i) for i in range(3)),
    *(Matte('CryptoMaterial', 'use_pass_cryptomatte_material', 'crypto_material', i) for i in range(3)),
)


def matte_metadata(gnomon, name, things):
    """What compositing nodes read beside a Cryptomatte: entries of the picture's metadata, by their names."""
    ids = {thing: f"{int(numpy.float32(gnomon.cryptomatte_id(thing)).view(numpy.uint32)):08x}" for thing in things}
    key = f"cryptomatte/{gnomon.cryptomatte_hash(name):08x}"[:len("cryptomatte/") + 7]
    return {f"{key}/name": name, f"{key}/hash": 'MurmurHash3_32', f"{key}/conversion": 'uint32_to_float32',
            f"{key}/manifest": json.dumps(ids)}


def values_of(render_pass, layer):
    """A layer as Blender has it: rows from the bottom, +Z up instead of +Y."""
    if render_pass.kind == 'VECTOR':
        x, y, z = numpy.moveaxis(layer, -1, 0)
        layer = numpy.stack([x, -z, y], axis=-1)
    return layer[::-1].reshape(-1, len(render_pass.channels))


def picture_size(render):
    return render.resolution_x * render.resolution_percentage // 100, render.resolution_y * render.resolution_percentage // 100


def region_of(render, width, height):
    """(left, bottom, right, top) of the part of the picture that is rendered, pixels."""
    if not render.use_border:
        return 0, 0, width, height
    # Blender multiplies floats.
    corners = numpy.array([render.border_min_x, render.border_min_y, render.border_max_x, render.border_max_y], numpy.float32)
    return tuple(int(edge) for edge in corners * numpy.array([width, height, width, height], numpy.float32))


class GnomonEngine(bpy.types.RenderEngine):
    bl_idname = 'GNOMON'
    bl_label = "Gnomon"
    bl_use_preview = False
    # Material Preview is EEVEE's.
    bl_use_eevee_viewport = True

    def render(self, depsgraph):
        if settings.gnomon is None:
            self.fail(f"its Python module is not installed for Blender's Python (doc/from-blender.md): {settings.MISSING}")
            return
        try:
            self.render_picture(settings.gnomon, depsgraph)
        except Cancelled:
            pass
        except (ExportFailed, settings.gnomon.Error) as error:
            self.fail(str(error))

    def fail(self, reason):
        # Unlike error_set, it keeps Blender from writing a file.
        self.report({'ERROR'}, f"Gnomon: {reason}")

    def render_picture(self, gnomon, depsgraph):
        scene = depsgraph.scene
        render = scene.render
        width, height = picture_size(render)
        self.update_stats("Gnomon", "Exporting the scene")
        with tempfile.TemporaryDirectory() as folder:
            facts = exported(depsgraph, folder)
            drawn = loaded(gnomon, folder, facts)
        remarks = facts['report'] + drawn.warnings
        sample_count = scene.gnomon.sample_count
        passes = [each for each in PASSES if each.is_of(depsgraph.view_layer)]

        def tell(samples_drawn):
            if self.test_break():
                raise Cancelled
            self.update_progress(samples_drawn / sample_count)
            self.update_stats("Gnomon", f"Sample {samples_drawn} of {sample_count}")

        tell(0)
        renderer = gnomon.Renderer.offline(
            gnomon.Device(), drawn, (width, height), sample_count, **settings.chosen(scene.gnomon),
            background=None if render.film_transparent else 'world')
        if len(passes) == 1:
            layers = {'combined': renderer.render(progress=tell)}
        else:
            layers = renderer.layers([each.layer for each in passes], progress=tell)
        # Blender's own engines use these names.
        things = {'CryptoObject': drawn.nodes, 'CryptoMaterial': drawn.materials}
        metadata = {}
        for stem in {each.stem for each in passes if isinstance(each, Matte)}:
            metadata |= matte_metadata(gnomon, f"{depsgraph.view_layer.name}.{stem}", [thing.name for thing in things[stem]])
        report = renderer.report()
        remarks += report.warnings + report.limits
        self.write(passes, layers, metadata, region_of(render, width, height))
        for remark in remarks:
            self.report({'WARNING'}, f"Gnomon: {remark}")
        memory_mib = report.memory_bytes / settings.MIB
        self.update_memory_stats(memory_used=memory_mib, memory_peak=memory_mib)
        self.update_stats("Gnomon", f"{len(remarks)} remarks" if remarks else "")
        bpy.context.window_manager.gnomon_report = "\n".join(remarks)

    def write(self, passes, layers, metadata, region):
        left, bottom, right, top = region
        result = self.begin_result(0, 0, right - left, top - bottom)
        written = result.layers[0].passes
        for each in passes:
            layer = layers[each.array]
            height = layer.shape[0]
            written[each.name].rect = values_of(each, layer[height - top:height - bottom, left:right])
        self.end_result(result)
        whole = self.get_result()
        for name, value in metadata.items():
            whole.stamp_data_add_field(name, value)

    def view_update(self, context, depsgraph):
        if settings.gnomon is None:
            self.update_stats("Gnomon", f"its Python module is not installed for Blender's Python: {settings.MISSING}")
            return
        if getattr(self, 'viewport', None) is None:
            self.viewport = viewport.Viewport()
        self.viewport.update(context, depsgraph)

    def view_draw(self, context, depsgraph):
        if getattr(self, 'viewport', None) is not None:
            self.viewport.draw(self, context, depsgraph)

    def __del__(self):
        if getattr(self, 'viewport', None) is not None:
            self.viewport.end()

    def update_render_passes(self, scene, layer):
        for each in PASSES:
            if each.is_of(layer):
                self.register_pass(scene, layer, each.name, len(each.channels), each.channels, each.kind)


class GNOMON_PT_passes(settings.EnginePanel, bpy.types.Panel):
    bl_context = 'view_layer'
    bl_label = "Passes"

    def draw(self, context):
        self.layout.use_property_split = True
        for option in dict.fromkeys(each.option for each in PASSES if each.option is not None):
            self.layout.prop(context.view_layer, option)
        self.layout.prop(context.view_layer, 'pass_cryptomatte_depth', text="Levels")


CLASSES = (GnomonEngine, GNOMON_PT_passes)


def shared_panels():
    """Panels of Blender for things that Gnomon has, too: those for all engines, and EEVEE's of materials, lamps and worlds."""
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, 'COMPAT_ENGINES', ())
        if 'BLENDER_RENDER' in engines or ('BLENDER_EEVEE' in engines and getattr(panel, 'bl_context', '') in ('material', 'data', 'world')):
            yield panel


def register():
    settings.register()
    for each in CLASSES:
        bpy.utils.register_class(each)
    for panel in shared_panels():
        panel.COMPAT_ENGINES.add('GNOMON')


def unregister():
    viewport.end_all()
    for panel in shared_panels():
        panel.COMPAT_ENGINES.discard('GNOMON')
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
    settings.unregister()
