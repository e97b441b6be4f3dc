# SPDX-License-Identifier: MIT
"""Gnomon in Blender: a render engine, and an extension of the glTF exporter. doc/from-blender.md describes both."""

import copy
import importlib
import math
import os
import shlex

import bpy
import numpy
from mathutils import Matrix

from . import cameras, closed, engine, lamps, materials, objects, temporary, viewport, world

bl_info = {
    "name": "Gnomon",
    "author": "The authors of Gnomon",
    "version": (1, 0, 0),
    "blender": (3, 4, 0),
    "location": "Render properties > Render Engine; File > Export > glTF 2.0",
    "description": "Draws by Gnomon, and writes lamps and worlds into glTF files as Gnomon reads them",
    "category": "Render",
}

VIEW_TRANSFORMS = {'Standard': 'standard', 'Raw': 'raw', 'AgX': 'agx', 'Khronos PBR Neutral': 'pbr-neutral'}
# Kinds of objects that have no meaning in glTF.
UNWRITTEN_OBJECTS = {'VOLUME', 'CURVES', 'POINTCLOUD', 'GPENCIL', 'GREASEPENCIL', 'LIGHT_PROBE'}
DRAWN_OBJECTS = {'MESH', 'CURVE', 'SURFACE', 'FONT', 'LIGHT'}
# Kinds of objects whose own surface the exporter writes. It leaves out metaballs and the instances of geometry nodes.
WRITTEN_SURFACES = {'MESH', 'CURVE', 'SURFACE', 'FONT'}
# Entries of persistent_id that are not used.
NO_ID = 2**31 - 1


class Report:
    """Sentences about what is not drawn or not as in Blender, each once, in the order of their things."""

    def __init__(self):
        self.lines = []

    def add(self, what, remark):
        line = f"{what}: {remark}"
        if line not in self.lines:
            self.lines.append(line)

    def add_all(self, what, remarks):
        for remark in remarks:
            self.add(what, remark)


def own_extras(thing):
    """The custom properties of a thing that are meant for Gnomon."""
    values = {key: value.to_list() if hasattr(value, 'to_list') else value for key, value in thing.items() if key.startswith('gnomon_')}
    return {key: value for key, value in values.items() if isinstance(value, (str, int, float, list))}


def add_extras(element, extras):
    """Adds to the extras of an element of the file; those of the user stay."""
    if extras:
        element.extras = {**extras, **(element.extras or {})}


def gltf_class(name, module='gltf2_io'):
    return getattr(importlib.import_module(f'io_scene_gltf2.io.com.{module}'), name)


def take_specular(element):
    """Makes a material of the file Lambertian, unless it is a metal."""
    name = 'KHR_materials_specular'
    extension = gltf_class('Extension', 'gltf2_io_extensions')(name, {'specularFactor': 0.0}, False)
    element.extensions = {**(element.extensions or {}), name: extension}


def write_plain(element, values):
    """Writes materials.plain_values into a material of the file."""
    element.pbr_metallic_roughness = gltf_class('MaterialPBRMetallicRoughness').from_dict({
        'baseColorFactor': [*values['base_color'], values.get('alpha', 1.0)], 'metallicFactor': 0.0,
        'roughnessFactor': materials.ROUGHNESS})
    if 'alpha' in values:
        element.alpha_mode, element.alpha_cutoff = 'MASK', 0.5
    if 'specular' in values:
        take_specular(element)


def rendered_objects(view_layer):
    """The names of objects that a render of the view layer shows, apart from instances of collections."""
    names = set()

    def walk(layer):
        if layer.exclude or layer.collection.hide_render:
            return
        names.update(thing.name_full for thing in layer.collection.objects if not thing.hide_render)
        for child in layer.children:
            walk(child)

    walk(view_layer.layer_collection)
    return names


def view_of(scene, report):
    """(view transform of Gnomon, exposure in stops)."""
    view = scene.view_settings
    transform = VIEW_TRANSFORMS.get(view.view_transform)
    if transform is None:
        transform = 'agx' if view.view_transform.startswith('Filmic') else 'standard'
        report.add('colour management', f"the view transform '{view.view_transform}' is not drawn; --view {transform} takes its place")
    if view.look not in ('', 'None'):
        report.add('colour management', f"the look '{view.look}' is not drawn")
    if view.gamma != 1.0:
        report.add('colour management', f"the gamma of {view.gamma:.3g} is not drawn")
    if view.use_curve_mapping:
        report.add('colour management', "curves are not drawn")
    exposure = view.exposure
    if scene.render.engine == 'CYCLES' and scene.cycles.film_exposure > 0:
        exposure += math.log2(scene.cycles.film_exposure)
    return transform, exposure


class Export:
    """One run of the exporter."""

    def __init__(self, scene, settings):
        self.scene = scene
        self.settings = settings
        self.report = Report()
        self.path = settings['gltf_filepath']
        self.rendered = rendered_objects(bpy.context.view_layer)
        self.volumes = {}
        self.temporary = temporary.Temporary()
        # Names of meshes that stand for others, with the names of those.
        self.names = {}
        # (name of the node, name of the object with the mesh, matrix)
        self.instances = []
        self.objects_of = {}
        # Names of the objects of which instances take the mesh, and which are not drawn themselves.
        self.sources = set()
        self.show_as_rendered()
        self.find_instances()
        self.fill_slots()
        # Remarks of the materials with a Diffuse BSDF, by name.
        self.diffuse = {}
        self.replace_diffuse()
        self.default_surface = None
        self.choose_colors()
        if bpy.app.version < (3, 5):
            self.read_colors_by_corner()
        self.choose_options()
        self.report_scene()
        self.world_extras = {}
        # The scene's own extra comes first.
        if 'gnomon_world' not in scene:
            self.world_extras, remarks = world.extras_of(
                scene.world, os.path.splitext(self.path)[0] + '_world.hdr', scene.gnomon_export.world_width, settings['gltf_yup'])
            self.report.add_all('world', remarks)

    def choose_options(self):
        """Sets those options of the exporter without which the file would lack what Blender draws."""
        settings = self.settings
        # Gnomon reads one scene.
        settings['gltf_active_scene'] = True
        settings['gltf_lights'] = settings['gltf_cameras'] = True
        settings['gltf_lighting_mode'] = 'SPEC'
        meshes = [thing for thing in self.scene.objects if thing.type == 'MESH' and thing.name_full in self.rendered]
        if any(thing.data.shape_keys for thing in meshes):
            # The exporter would apply the shape keys, too.
            settings['gltf_apply'] = False
            for thing in meshes:
                if any(m.type not in ('ARMATURE', 'PARTICLE_SYSTEM') and m.show_render for m in thing.modifiers):
                    self.apply_modifiers(thing)
        else:
            settings['gltf_apply'] = True
        if any(track.strips for thing in self.scene.objects if thing.animation_data for track in thing.animation_data.nla_tracks):
            self.report.add('animation', "strips are written at their actions' own times")
        else:
            settings['gltf_nla_strips'] = False
            settings['gltf_export_anim_single_armature'] = False
            # Blender 4.0 and later have this option.
            settings['gltf_animation_mode'] = 'ACTIVE_ACTIONS'

        # The exporter writes the pose of an armature that no action moves. It reads the setting only at the start and at the end.
        self.temporary.set_item(settings, 'gltf_current_frame', True)
        # Blender 3.6 and later.
        settings['gltf_rest_position_armature'] = False

    def show_as_rendered(self):
        """The exporter writes what a viewport shows."""
        change, render = self.temporary.set, self.scene.render
        change(render, 'simplify_subdivision', render.simplify_subdivision_render)
        change(render, 'simplify_child_particles', render.simplify_child_particles_render)
        self.show_hidden()
        # Also those of collections that have instances only.
        for thing in bpy.data.objects:
            for modifier in thing.modifiers:
                change(modifier, 'show_viewport', modifier.show_render)
                if modifier.type in ('SUBSURF', 'MULTIRES'):
                    change(modifier, 'levels', modifier.render_levels)
            for system in thing.particle_systems:
                change(system.settings, 'display_percentage', 100)
                change(system.settings, 'child_nbr', system.settings.rendered_child_count)
            data = thing.data
            if thing.type in ('CURVE', 'SURFACE', 'FONT'):
                for axis in 'uv':
                    change(data, f'resolution_{axis}', getattr(data, f'render_resolution_{axis}') or getattr(data, f'resolution_{axis}'))
            if thing.type == 'META':
                change(data, 'resolution', data.render_resolution)

    def show_hidden(self):
        """Shows what viewports hide and renders do not: Blender evaluates neither its modifiers nor its instances otherwise."""
        def walk(layer):
            if not layer.exclude:
                self.temporary.set(layer, 'hide_viewport', False)
                for child in layer.children:
                    walk(child)

        for kind in (bpy.data.collections, bpy.data.objects):
            for each in kind:
                if not each.hide_render:
                    self.temporary.set(each, 'hide_viewport', False)
        walk(bpy.context.view_layer.layer_collection)
        for thing in self.scene.objects:
            if thing.name_full in self.rendered and thing.hide_get():
                self.temporary.show(thing)

    def find_instances(self):
        """Instances of particles and geometry nodes, and metaballs, all of which the exporter leaves out."""
        depsgraph = bpy.context.evaluated_depsgraph_get()
        copies, unwritten = {}, {}
        for instance in depsgraph.object_instances:
            if not instance.is_instance or instance.parent is None:
                continue
            parent, thing = instance.parent.original, instance.object
            own = thing.original
            if parent.name_full not in self.rendered:
                continue
            # The exporter writes what collections, vertices and faces repeat, without the meshes that nodes make.
            is_made = own.type == 'MESH' and thing.data.as_pointer() != own.evaluated_get(depsgraph).data.as_pointer()
            is_written = parent.instance_type != 'COLLECTION' or self.is_of_collections(instance)
            if parent.instance_type != 'NONE' and not is_made and is_written:
                continue
            # The surface of a curve is an instance of one number.
            is_surface = own == parent and instance.persistent_id[1] == NO_ID
            if is_surface and own.type in WRITTEN_SURFACES:
                continue
            if own != parent and own.type == 'MESH' and not is_made and own.name_full in self.rendered and own.find_armature() is None:
                source = own.name
            elif thing.type in ('MESH', 'META', 'CURVE', 'SURFACE', 'FONT'):
                key = own.name_full, thing.data.as_pointer()
                if key not in copies:
                    copies[key] = self.copy_of(thing, depsgraph)
                source = copies[key]
            else:
                source = None
            if source is None:
                unwritten[parent.name] = unwritten.get(parent.name, 0) + 1
                continue
            name = parent.name if own == parent else f"{parent.name} {own.name}"
            self.instances.append((name, source, instance.matrix_world.copy()))
        for name, count in unwritten.items():
            self.report.add(f"object '{name}'", f"{count} of its instances are not written, because what they repeat has no surface")

    def is_of_collections(self, instance):
        """Whether the exporter writes an instance below an instance of a collection: not what an object in that collection repeats."""
        collection = instance.parent.original.instance_collection
        # Places in collections, the innermost first.
        for place in reversed([each for each in instance.persistent_id if each != NO_ID]):
            if collection not in self.objects_of:
                self.objects_of[collection] = list(collection.all_objects) if collection else []
            things = self.objects_of[collection]
            thing = things[place] if place < len(things) else None
            if thing is None or thing == instance.object.original:
                return thing is not None
            collection = thing.instance_collection if thing.instance_type == 'COLLECTION' else None
        return False

    def copy_of(self, thing, depsgraph):
        """The name of an object for the time of the export that has the mesh of an evaluated object; None if that has no triangles."""
        mesh = bpy.data.meshes.new_from_object(thing)
        if mesh is None:
            return None
        self.temporary.add_mesh(mesh)
        if not mesh.polygons:
            return None
        for i, slot in enumerate(thing.material_slots):
            material = slot.material and slot.material.original
            if i < len(mesh.materials):
                mesh.materials[i] = material
            else:
                mesh.materials.append(material)
        self.names[mesh.name] = thing.data.name
        added = self.temporary.add_object(thing.name, mesh, self.scene.collection)
        self.rendered.add(added.name_full)
        self.sources.add(added.name)
        return added.name

    def apply_modifiers(self, thing):
        """Gives an object its modified mesh for the time of the export. Bones go on to move it."""
        if thing.data.shape_keys:
            self.report.add(f"object '{thing.name}'", "its modifiers are not written, because its shape keys could not be written then")
            return
        is_shown = [(modifier, modifier.show_viewport) for modifier in thing.modifiers if modifier.type == 'ARMATURE']
        for modifier, _ in is_shown:
            modifier.show_viewport = False
        depsgraph = bpy.context.evaluated_depsgraph_get()
        mesh = bpy.data.meshes.new_from_object(thing.evaluated_get(depsgraph), preserve_all_data_layers=True, depsgraph=depsgraph)
        for modifier, was_shown in is_shown:
            modifier.show_viewport = was_shown
        self.temporary.add_mesh(mesh)
        self.names[mesh.name] = thing.data.name
        self.temporary.set(thing, 'data', mesh)

    def fill_slots(self):
        """The exporter of 3.4 fails where a mesh has an empty slot and a material has a node of the kind UV Map."""
        meshes = [mesh for mesh in bpy.data.meshes if mesh.library is None and None in list(mesh.materials)]
        self.nothing = self.temporary.add_material() if meshes else None
        for mesh in meshes:
            self.temporary.fill_slots(mesh, self.nothing)

    def replace_diffuse(self):
        """The exporter reads Principled BSDFs alone."""
        for material in bpy.data.materials:
            surface = materials.surface_of(material)
            if surface is not None and surface.type == 'BSDF_DIFFUSE':
                self.diffuse[material.name_full] = materials.remarks_of(material)
                self.temporary.replace_diffuse(material)

    def choose_colors(self):
        """The exporter writes the colours for renders, whichever a material reads."""
        for mesh in (each for each in bpy.data.meshes if each.library is None and each.color_attributes):
            names = [materials.base_color_name(each) for each in mesh.materials if each is not None]
            colors = [materials.colors_of(mesh, name) for name in names if name is not None]
            found = list(dict.fromkeys(each.name for each in colors if each is not None))
            if found:
                self.temporary.set(mesh.color_attributes, 'render_color_index', mesh.color_attributes.find(found[0]))
            if len(found) > 1:
                self.report.add(f"mesh '{mesh.name}'", f"of its colours '{found[0]}' are written, and not {', '.join(found[1:])}")

    def read_colors_by_corner(self):
        """The exporter of 3.4 takes the numbers of vertices for those of corners."""
        creator = importlib.import_module('io_scene_gltf2.blender.exp.gltf2_blender_gather_primitives_extract').PrimitiveCreator
        name = '_PrimitiveCreator__get_color_attribute'
        read = getattr(creator, name)

        def read_by_corner(own, attribute):
            vertices = own.dots['vertex_index'].copy()
            if attribute['blender_domain'] == 'CORNER':
                own.dots['vertex_index'] = numpy.arange(len(vertices))
            read(own, attribute)
            own.dots['vertex_index'] = vertices

        self.temporary.set(creator, name, read_by_corner)

    def report_scene(self):
        scene, report = self.scene, self.report
        if scene.render.use_motion_blur:
            report.add('scene', f"motion blur is drawn in frames alone: --frames A-B --shutter {scene.render.motion_blur_shutter:.6g}")
        if scene.use_nodes:
            report.add('scene', "compositing nodes are not run")
        self.report_picture()
        animated = [scene.world, *(thing.data for thing in scene.objects if thing.type in ('LIGHT', 'CAMERA'))]
        for thing in scene.objects:
            if thing.name_full not in self.rendered:
                continue
            what = f"object '{thing.name}'"
            if thing.type in UNWRITTEN_OBJECTS:
                report.add(what, f"objects of the kind {thing.type} are not written")
            if thing.type == 'MESH':
                for system in thing.particle_systems:
                    if system.settings.type == 'HAIR' and system.settings.render_type == 'PATH':
                        report.add(what, f"the hair '{system.name}' is not written; make a mesh of it")
            if thing.type in (*WRITTEN_SURFACES, 'META'):
                report.add_all(what, objects.remarks_of(thing, bpy.context.view_layer))
            animated += [slot.material for slot in thing.material_slots if slot.material]
        for data in animated:
            if data is not None and any(each is not None and each.animation_data and each.animation_data.action
                                        for each in (data, data.node_tree if hasattr(data, 'node_tree') else None)):
                report.add(f"{data.bl_rna.name.lower()} '{data.name}'", "its animation is not written, only that of objects, bones and shape keys")

    def report_picture(self):
        """Names the options of pictures that are not drawn, and takes square pixels."""
        scene, render, layer, report = self.scene, self.scene.render, bpy.context.view_layer, self.report
        if render.pixel_aspect_x != render.pixel_aspect_y:
            report.add('scene', f"its pixels of {render.pixel_aspect_x:.6g} to {render.pixel_aspect_y:.6g} are drawn square")
            self.temporary.set(render, 'pixel_aspect_x', 1.0)
            self.temporary.set(render, 'pixel_aspect_y', 1.0)
        if render.use_border:
            report.add('scene', "the whole picture is drawn, not its render region alone")
        if render.use_multiview:
            report.add('scene', "one view is drawn, not those of stereoscopy")
        if render.use_freestyle:
            report.add('scene', "lines of Freestyle are not drawn")
        if render.engine == 'BLENDER_EEVEE' and getattr(scene.eevee, 'use_bloom', False):
            report.add('scene', "EEVEE's bloom is not drawn")
        if scene.background_set is not None:
            report.add('scene', f"its background set '{scene.background_set.name}' is not written")
        if layer.material_override is not None:
            report.add(f"view layer '{layer.name}'", f"its material override '{layer.material_override.name}' is not drawn")

    def tag_tree(self, tree):
        """Leaves out what a render does not show. What only carries others stays."""
        def walk(uuid, is_in_instance, is_hidden):
            node = tree.nodes[uuid]
            thing = node.blender_object
            is_bone = node.blender_bone is not None
            if not is_bone:
                is_instancer = thing.instance_type == 'COLLECTION'
                is_own_hidden = thing.hide_render if is_in_instance else thing.name_full not in self.rendered
                is_empty = thing.type == 'META' and not node.children
                if is_hidden or is_empty or (is_own_hidden and (is_instancer or thing.type in DRAWN_OBJECTS)):
                    node.keep_tag = False
                is_hidden = is_hidden or (is_own_hidden and is_instancer)
                is_in_instance = is_in_instance or is_instancer
            for child in node.children:
                walk(child, is_in_instance, is_hidden)

        for root in list(tree.roots):
            walk(root, False, False)

    def write_node(self, node, thing):
        extras = own_extras(thing)
        if thing.type == 'LIGHT':
            extras = {**self.lamp_extras(node, thing), **extras}
        elif thing.type == 'CAMERA':
            found, remarks = cameras.extras_of(thing, self.scene)
            self.report.add_all(f"camera '{thing.name}'", remarks)
            extras = {**found, **extras}
            if node.camera is not None and node.camera.orthographic is not None:
                # The exporter takes the scale for that of the longer side, whichever way the sensor fits.
                node.camera.orthographic.xmag, node.camera.orthographic.ymag = cameras.half_size_of(thing.data, self.scene)
        elif not thing.visible_shadow:
            extras.setdefault('gnomon_casts_shadow', False)
        add_extras(node, extras)

    def lamp_extras(self, node, thing):
        lamp, what = thing.data, f"lamp '{thing.name}'"
        extras, remarks = lamps.extras_of(lamp)
        self.report.add_all(what, [*objects.light_remarks_of(thing), *remarks])
        extension = (node.extensions or {}).get('KHR_lights_punctual')
        if extension is not None:
            light = extension.extension['light'].extension
            light['color'], light['intensity'], remarks = lamps.punctual(lamp)
            self.report.add_all(what, remarks)
        # 4.2 and later have one option for both engines.
        cycles = getattr(lamp, 'cycles', None)
        is_of_cycles = self.scene.render.engine == 'CYCLES' and hasattr(cycles, 'cast_shadow')
        casts = cycles.cast_shadow if is_of_cycles else lamp.use_shadow
        # A lamp that is written without light has no extras.
        if not casts and (extension is not None or extras):
            extras['gnomon_shadow'] = 'none'
        return extras

    def write_material(self, element, material):
        diffuse_remarks = self.diffuse.get(material.name_full)
        remarks = materials.remarks_of(material) if diffuse_remarks is None else diffuse_remarks
        self.report.add_all(f"material '{material.name}'", remarks)
        add_extras(element, own_extras(material))
        if diffuse_remarks is not None:
            take_specular(element)
            return
        values, is_unlit = materials.plain_values(material), 'KHR_materials_unlit' in (element.extensions or {})
        if materials.emission_of(material) and not materials.principled_of(material) and not is_unlit:
            # The exporter writes a black metal, which reflects at its edges.
            write_plain(element, materials.BLACK)
        # It reads some groups of nodes.
        elif values is not None and not is_unlit and not any(vars(element.pbr_metallic_roughness).values()):
            write_plain(element, values)

    def write_mesh(self, element, mesh, slots):
        by_name = {material.name: material for material in slots if material is not None}
        element.name = self.names.get(element.name, element.name)
        for primitive in element.primitives:
            written = primitive.material
            if self.nothing is not None and written is not None and written.name == self.nothing.name:
                primitive.material = written = None
            material = by_name.get(getattr(written, 'name', None))
            if written is None and self.settings['gltf_materials'] == 'EXPORT':
                primitive.material = self.default_material()
            if not materials.uses_color_attribute(material):
                # glTF multiplies these by the base colour of any material.
                for key in [key for key in primitive.attributes if key.startswith('COLOR_')]:
                    del primitive.attributes[key]
            extensions = getattr(written, 'extensions', None) or {}
            if material is None or 'KHR_materials_transmission' not in extensions or 'KHR_materials_volume' in extensions:
                continue
            indices = [i for i, each in enumerate(slots) if each == material]
            thickness = self.thickness(mesh, indices)
            if thickness == 0:
                self.report.add(f"mesh '{mesh.name}'", f"its part of '{material.name}' is a plane; it is drawn as a thin wall")
                continue
            primitive.material = self.with_volume(written, material, thickness)

    def default_material(self):
        """The element of the file for faces without a material."""
        if self.default_surface is None:
            self.default_surface = gltf_class('Material').from_dict({'name': materials.DEFAULT_NAME, 'doubleSided': True})
            write_plain(self.default_surface, {'base_color': materials.DEFAULT_COLOR, 'specular': 0.0})
        return self.default_surface

    @staticmethod
    def thickness(mesh, slot_indices):
        """See closed.thickness, of the triangles in some material slots."""
        mesh.calc_loop_triangles()
        positions = numpy.empty(3 * len(mesh.vertices), numpy.float32)
        mesh.vertices.foreach_get('co', positions)
        triangles = numpy.empty(3 * len(mesh.loop_triangles), numpy.int32)
        mesh.loop_triangles.foreach_get('vertices', triangles)
        slots = numpy.empty(len(mesh.loop_triangles), numpy.int32)
        mesh.loop_triangles.foreach_get('material_index', slots)
        return closed.thickness(positions.reshape(-1, 3), triangles.reshape(-1, 3)[numpy.isin(slots, slot_indices)])

    def with_volume(self, written, material, thickness):
        """A copy of a written material for bodies of a thickness; the same for the same arguments."""
        key = (material.name_full, round(thickness, 6))
        if key not in self.volumes:
            # To other programs, an open surface is a thin wall, as its thickness is not known.
            volume = {'thicknessFactor': thickness} if thickness < closed.ENDLESS else {}
            color = materials.absorption(material)
            if color is not None:
                volume['attenuationColor'], volume['attenuationDistance'] = color
            twin = copy.copy(written)
            extension = type(written.extensions['KHR_materials_transmission'])
            twin.extensions = {**written.extensions, 'KHR_materials_volume': extension('KHR_materials_volume', volume, False)}
            if thickness == closed.ENDLESS:
                twin.extras = {'gnomon_thickness': thickness, **(written.extras or {})}
            self.volumes[key] = twin
        return self.volumes[key]

    def write_scene(self, element, scene):
        add_extras(element, {**own_extras(scene), **self.world_extras})
        self.put_camera_first(element.nodes, scene)
        self.write_instances(element)

    def write_instances(self, element):
        """Nodes for the instances of particles and geometry nodes, and for metaballs."""
        sources = {node.blender_object.name: node.node for node in self.settings['vtree'].nodes.values()
                   if node.blender_bone is None and node.node is not None and node.node.mesh is not None and node.node.skin is None}
        unneeded = [sources[name] for name in self.sources if name in sources]
        element.nodes = [node for node in element.nodes if not any(node is each for each in unneeded)]
        file_from_blender = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1))) if self.settings['gltf_yup'] else Matrix()
        for name, source, matrix in self.instances:
            node = sources[source]
            matrix = file_from_blender @ matrix @ file_from_blender.inverted()
            element.nodes.append(type(node)(
                camera=None, children=[], extensions=None, extras=node.extras, matrix=[x for column in matrix.col for x in column],
                mesh=node.mesh, name=name, rotation=None, scale=None, skin=None, translation=None, weights=None))

    @staticmethod
    def put_camera_first(nodes, scene):
        """Gnomon draws by the first camera, Blender by the scene's."""
        def move(nodes):
            for i, node in enumerate(nodes):
                if (node.camera is not None and scene.camera and node.name == scene.camera.name) or move(node.children or []):
                    nodes.insert(0, nodes.pop(i))
                    return True
            return False

        move(nodes)

    def join_animations(self, animations):
        """Makes one animation of those that do not move the same thing; the others follow and are named."""
        if len(animations) < 2:
            return
        first, others = animations[0], animations[1:]
        moved = {(id(channel.target.node), channel.target.path) for channel in first.channels}
        for animation in others:
            targets = {(id(channel.target.node), channel.target.path) for channel in animation.channels}
            if targets & moved:
                self.report.add(f"animation '{animation.name}'", f"it moves things that '{first.name}' moves, and stays apart")
                continue
            moved |= targets
            offset = len(first.samplers)
            first.samplers += animation.samplers
            for channel in animation.channels:
                channel.sampler += offset
                first.channels.append(channel)
            animations.remove(animation)

    def finish(self):
        self.temporary.end()
        render = self.scene.render
        transform, exposure = view_of(self.scene, self.report)
        width, height = engine.picture_size(render)
        command = ['gnomon', 'render', os.path.basename(self.path), '-o', 'picture.png', '--size',
                   f"{width}x{height}", '--view', transform,
                   '--background', 'none' if render.film_transparent else 'world']
        if exposure != 0:
            command += ['--exposure', f"{exposure:.6g}"]
        lines = self.report.lines + [f"draw with: {shlex.join(command)}"]
        for line in lines:
            print(f"Gnomon: {line}")
        bpy.context.window_manager.gnomon_report = "\n".join(lines)


def part_of_file(write):
    """A hook of the exporter, which would only print an exception of it: the report names it, too."""
    def hook(self, *arguments):
        if self.export is not None:
            try:
                write(self, *arguments)
            except Exception as error:
                self.export.report.add('add-on', f"{write.__name__} failed: {error}")
                raise

    return hook


class glTF2ExportUserExtension:
    """Found by the exporter, which makes one for each file."""

    def __init__(self):
        self.export = None

    @part_of_file
    def gather_tree_filter_tag_hook(self, tree, settings):
        self.export.tag_tree(tree)

    @part_of_file
    def gather_node_hook(self, node, thing, settings):
        self.export.write_node(node, thing)

    @part_of_file
    def gather_material_hook(self, element, material, settings):
        self.export.write_material(element, material)

    @part_of_file
    def gather_mesh_hook(self, element, mesh, *arguments):
        self.export.write_mesh(element, mesh, arguments[-2])

    @part_of_file
    def gather_scene_hook(self, element, scene, settings):
        self.export.write_scene(element, scene)

    @part_of_file
    def gather_gltf_hook(self, scene_index, scenes, animations, settings):
        self.export.join_animations(animations)


def extension_of(settings):
    return next(each for each in settings['gltf_user_extensions'] if isinstance(each, glTF2ExportUserExtension))


def glTF2_pre_export_callback(settings):
    if bpy.context.scene.gnomon_export.is_on:
        extension_of(settings).export = Export(bpy.context.scene, settings)


def glTF2_post_export_callback(settings):
    export = extension_of(settings).export
    if export is not None:
        export.finish()


class GnomonExport(bpy.types.PropertyGroup):
    is_on: bpy.props.BoolProperty(
        name="For Gnomon", default=True,
        description="Write lamps in physical units with their sizes, the world, cameras, modifiers, the thickness of closed glass and one "
                    "animation; leave out what a render does not show")
    world_width: bpy.props.IntProperty(
        name="World Width", default=1024, min=64, max=world.PICTURE_WIDTH_MAX, subtype='PIXEL',
        description="Width of the picture of a world that is not of one colour; at least that of its own pictures")


def draw_export(context, layout):
    """Called by the exporter of 4.2 and later, and by the panel of earlier ones."""
    options = context.scene.gnomon_export
    layout.use_property_split = True
    layout.prop(options, 'is_on')
    column = layout.column()
    column.active = options.is_on
    column.prop(options, 'world_width')


class GNOMON_PT_export(bpy.types.Panel):
    bl_space_type = 'FILE_BROWSER'
    bl_region_type = 'TOOL_PROPS'
    bl_label = "Gnomon"
    bl_parent_id = 'GLTF_PT_export_user_extensions'

    @classmethod
    def poll(cls, context):
        return context.space_data.active_operator.bl_idname == 'EXPORT_SCENE_OT_gltf'

    def draw(self, context):
        draw_export(context, self.layout)


class GNOMON_PT_report(bpy.types.Panel):
    bl_space_type = 'PROPERTIES'
    bl_region_type = 'WINDOW'
    bl_context = 'output'
    bl_label = "Gnomon: Last Report"
    bl_options = {'DEFAULT_CLOSED'}

    @classmethod
    def poll(cls, context):
        return bool(context.window_manager.gnomon_report or viewport.remarks())

    def draw(self, context):
        for line in context.window_manager.gnomon_report.splitlines():
            self.layout.label(text=line)
        for line in viewport.remarks():
            self.layout.label(text=line, icon='VIEW3D')


def register_panel():
    """Called by the exporter before 4.2 when its dialog opens. Returns what ends it."""
    bpy.utils.register_class(GNOMON_PT_export)
    return lambda: bpy.utils.unregister_class(GNOMON_PT_export)


def register():
    temporary.register()
    engine.register()
    bpy.utils.register_class(GnomonExport)
    bpy.utils.register_class(GNOMON_PT_report)
    bpy.types.Scene.gnomon_export = bpy.props.PointerProperty(type=GnomonExport)
    bpy.types.WindowManager.gnomon_report = bpy.props.StringProperty(options={'HIDDEN', 'SKIP_SAVE'})


def unregister():
    del bpy.types.WindowManager.gnomon_report
    del bpy.types.Scene.gnomon_export
    bpy.utils.unregister_class(GNOMON_PT_report)
    bpy.utils.unregister_class(GnomonExport)
    engine.unregister()
    temporary.unregister()
