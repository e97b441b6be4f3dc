# SPDX-License-Identifier: MIT
"""What a depsgraph of Blender shows, as mirror.Content: arrays and numbers that another thread may read."""

import dataclasses

import numpy
from mathutils import Matrix

from . import closed, lamps, materials, objects
from .mirror import Content, Node, Part

FILE_FROM_BLENDER = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))
WITHOUT_SURFACE = {'EMPTY', 'CAMERA', 'ARMATURE', 'LATTICE', 'SPEAKER'}
WITH_SURFACE = {'MESH', 'CURVE', 'SURFACE', 'FONT', 'META'}
# Reflectance of a dielectric at normal incidence, of which Gnomon's specular colour is a factor.
DIELECTRIC_F0 = 0.04
# Gnomon's defaults are those of glTF, a rough metal.
MATERIAL = {'metallic': 0.0, 'roughness': materials.ROUGHNESS}
# The textures of sockets, by the type of their node.
TEXTURES = {
    'BSDF_PRINCIPLED': {'Base Color': 'base_color_texture', 'Metallic': 'metallic_roughness_texture', 'Roughness': 'metallic_roughness_texture',
                        'Emission': 'emissive_texture', 'Emission Color': 'emissive_texture', 'Normal': 'normal_texture'},
    'BSDF_DIFFUSE': {'Color': 'base_color_texture', 'Normal': 'normal_texture'},
    'EMISSION': {'Color': 'emissive_texture'}, 'BACKGROUND': {'Color': 'emissive_texture'}}
# The key of Content.materials of faces without a material.
DEFAULT_SURFACE = materials.DEFAULT_NAME, None


@dataclasses.dataclass(frozen=True)
class Placing:
    """Where an image lies: the name of its uv set, or "" for the active one, and a 2x3 matrix of the coordinates."""

    uv_map: str = ""
    matrix: tuple[tuple[float, ...], ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


NO_MATERIAL = None, False, Placing(), None


def placing_of(image_node):
    """The placing of an image: by a Mapping, a UV Map, both or neither."""
    node, matrix = materials.source_of(image_node.inputs['Vector']), Matrix()
    if node is not None and node.type == 'MAPPING' and node.vector_type != 'NORMAL':
        place = node.inputs['Location'].default_value if 'Location' in node.inputs and node.vector_type != 'VECTOR' else (0, 0, 0)
        matrix = Matrix.LocRotScale(place, node.inputs['Rotation'].default_value, node.inputs['Scale'].default_value)
        if node.vector_type == 'TEXTURE':
            matrix = matrix.inverted_safe()
        node = materials.source_of(node.inputs['Vector'])
    uv_map = node.uv_map if node is not None and node.type == 'UVMAP' else ""
    return Placing(uv_map, tuple((*row[:2], row[3]) for row in matrix[:2]))


def matrix_of(matrix):
    """A matrix of Blender's world in Gnomon's, which has +Y up."""
    return numpy.array(FILE_FROM_BLENDER @ matrix)


def numbers(collection, attribute, width, kind=numpy.float32):
    """Values of a collection; 0 for those that are not finite, which a scene refuses."""
    values = numpy.empty(width * len(collection), kind)
    collection.foreach_get(attribute, values)
    numpy.nan_to_num(values, copy=False, posinf=0, neginf=0)
    return values.reshape(-1, width) if width > 1 else values


def parts_of(mesh, slots):
    """A Part for each material of a mesh; vertices are its face corners.

    slots: (name of the material or None, whether light passes it, placing of its images, name of the colours of vertices or None)

    Keys of materials are (name, thickness of the body, m).
    """
    if hasattr(mesh, 'calc_normals_split'):
        mesh.calc_normals_split()
        normals = numbers(mesh.loops, 'normal', 3)
    else:
        # 4.1 and later.
        normals = numbers(mesh.corner_normals, 'vector', 3)
    mesh.calc_loop_triangles()
    positions = numbers(mesh.vertices, 'co', 3)
    vertices = numbers(mesh.loops, 'vertex_index', 1, numpy.int32)
    triangles = numbers(mesh.loop_triangles, 'loops', 3, numpy.int32)
    indices = numbers(mesh.loop_triangles, 'material_index', 1, numpy.int32)
    parts = []
    for index in numpy.unique(indices):
        own = triangles[indices == index]
        corners, own = numpy.unique(own, return_inverse=True)
        arrays = {'positions': positions[vertices[corners]], 'normals': normals[corners],
                  'triangles': own.reshape(-1, 3).astype(numpy.uint32)}
        name, is_glass, placing, colors = slots[min(index, len(slots) - 1)] if slots else NO_MATERIAL
        layer = layer_of(mesh, placing)
        arrays['uvs'] = numpy.empty((0, 2), numpy.float32) if layer is None else placed(numbers(layer.data, 'uv', 2)[corners], placing)
        arrays['colors'] = colors_of(mesh, colors, corners, vertices)
        thickness = closed.thickness(arrays['positions'], arrays['triangles']) if is_glass else 0.0
        parts.append(Part(arrays, (name, round(thickness, 6)) if name else DEFAULT_SURFACE))
    return parts


def layer_of(mesh, placing):
    """The uv set of a placing, or the active one for renders. None if the mesh has none."""
    active = next((each for each in mesh.uv_layers if each.active_render), None)
    return mesh.uv_layers.get(placing.uv_map, active)


def colors_of(mesh, name, corners, vertices):
    """Linear colours of corners, or none. name: of materials.colors_of; None: none."""
    found = None if name is None else materials.colors_of(mesh, name)
    if found is None:
        return numpy.empty((0, 4), numpy.float32)
    values = numbers(found.data, 'color', 4)
    colors = numpy.clip(values[corners if found.domain == 'CORNER' else vertices[corners]], 0, 1)
    # The alpha of a Principled BSDF is not theirs.
    colors[:, 3] = 1
    return colors


def placed(uvs, placing):
    """Coordinates of Blender, as images have them: from the top."""
    matrix = numpy.array(placing.matrix)
    uvs = uvs @ matrix[:, :2].T + matrix[:, 2]
    uvs[:, 1] = 1 - uvs[:, 1]
    return uvs.astype(numpy.float32)


class Thing:
    """What an object adds at each of its instances: a mesh or a lamp, or neither."""

    def __init__(self, mesh=None, lamp=None, casts_shadow=True):
        self.mesh = mesh
        self.lamp = lamp
        self.casts_shadow = casts_shadow

    def node(self, matrix):
        return Node(matrix, self.mesh, self.lamp, self.casts_shadow)


class Collector:
    """Reads depsgraphs of one viewport. Meshes and images are read again only if they changed, and all if not only objects moved."""

    def __init__(self):
        self.meshes = {}
        # By key, with what tells that it changed.
        self.images = {}
        # Properties of the materials of one depsgraph, by name.
        self.materials = {}
        # By the name of a material: its custom property gnomon_thickness.
        self.thicknesses = {}
        # The placing of the images of each material, by its name.
        self.placings = {}
        # The name of the colours of vertices that each material reads, or None.
        self.color_names = {}
        self.remarks = []
        self.last = None
        # The number of instances of the last depsgraph.
        self.count = 0
        # Names of the objects that others repeat, or that repeat others.
        self.repeated = set()

    def forget(self, depsgraph):
        """Forgets the meshes that the updates of a depsgraph changed."""
        changed = {update.id.name for update in depsgraph.updates if update.is_updated_geometry}
        for key in [key for key in self.meshes if changed & set(key[0])]:
            del self.meshes[key]

    def content(self, depsgraph, space=None):
        """The Content of a depsgraph. space: a SpaceView3D, for its local view. The world is left out."""
        is_local = space is not None and space.local_view is not None
        self.last = (None if is_local else self.moved(depsgraph)) or self.collected(depsgraph, space if is_local else None)
        return self.last

    def moved(self, depsgraph):
        """The last content with objects at other places; None if anything else changed."""
        # The scene itself is always named. Objects that come and go may be told by their number only.
        moved = [update for update in depsgraph.updates if update.id.bl_rna.identifier != 'Scene']
        if self.last is None or not moved or len(depsgraph.object_instances) != self.count:
            return None
        nodes = dict(self.last.nodes)
        for update in moved:
            thing = update.id
            if not hasattr(thing, 'matrix_world') or update.is_updated_geometry or update.is_updated_shading or thing.name in self.repeated:
                return None
            old = nodes.get((thing.name,))
            if old is not None:
                nodes[thing.name,] = Node(matrix_of(thing.matrix_world), old.mesh, old.lamp, old.casts_shadow)
            elif thing.type not in WITHOUT_SURFACE:
                return None
        return dataclasses.replace(self.last, nodes=nodes)

    def collected(self, depsgraph, local):
        self.forget(depsgraph)
        self.view_layer = depsgraph.view_layer
        self.remarks = []
        self.materials = {}
        self.thicknesses = {}
        self.placings = {}
        self.repeated = set()
        content = Content()
        instances = depsgraph.object_instances
        count = self.count = len(instances)
        matrices, shown, keys = numpy.empty(16 * count, numpy.float32), numpy.empty(count, bool), numpy.empty(8 * count, numpy.int32)
        instances.foreach_get('matrix_world', matrices)
        instances.foreach_get('show_self', shown)
        instances.foreach_get('persistent_id', keys)
        matrices = numpy.array(FILE_FROM_BLENDER) @ matrices.reshape(-1, 4, 4).transpose(0, 2, 1).astype(numpy.float64)
        things = {}
        for instance, is_shown, key, matrix in zip(instances, shown, keys.reshape(-1, 8), matrices):
            thing, parent = instance.object, instance.parent
            name = thing.name
            if parent is not None:
                self.repeated.update((name, parent.name))
            if not is_shown or (local is not None and not (parent or thing).original.local_view_get(local)):
                continue
            data = thing.data
            # Nodes repeat meshes that are of no object.
            which = name, data and data.as_pointer()
            if which not in things:
                things[which] = self.thing_of(thing, content)
            added = things[which]
            if added.mesh is not None or added.lamp is not None:
                content.nodes[(name,) if parent is None else (name, parent.name, key.tobytes())] = added.node(matrix)
        self.images = {key: value for key, value in self.images.items() if key in content.textures}
        self.meshes = dict(content.meshes)
        return content

    def thing_of(self, thing, content):
        if thing.type == 'LIGHT':
            for remark in objects.light_remarks_of(thing.original):
                self.remark(f"lamp '{thing.name}': {remark}")
            return Thing(lamp=self.lamp_of(thing, content))
        if thing.type in WITH_SURFACE:
            mesh = self.mesh_of(thing, content)
            if mesh is not None:
                content.meshes[mesh] = self.meshes[mesh]
                self.add_materials(self.meshes[mesh], content)
                for remark in objects.remarks_of(thing.original, self.view_layer):
                    self.remark(f"object '{thing.name}': {remark}")
            return Thing(mesh=mesh, casts_shadow=thing.visible_shadow)
        if thing.type not in WITHOUT_SURFACE:
            self.remark(f"object '{thing.name}': objects of the kind {thing.type} are not drawn")
        return Thing()

    def remark(self, text):
        if text not in self.remarks:
            self.remarks.append(text)

    def mesh_of(self, thing, content):
        """The key of an object's mesh, which is in self.meshes; None if it has no triangles."""
        data = thing.data
        slots = [slot.material for slot in thing.material_slots]
        names = tuple(self.material_of(material.original, content) if material else NO_MATERIAL for material in slots)
        key = ((thing.original.name, data.original.name if data.original else ''), data.as_pointer(), names)
        if not thing.modifiers and thing.type == 'MESH':
            # Objects that share a mesh share its copy.
            key = ((data.original.name,), data.as_pointer(), names)
        if key not in self.meshes:
            mesh = thing.to_mesh()
            self.meshes[key] = [] if mesh is None or not mesh.polygons else parts_of(mesh, names)
            for name, _, _, colors in names if mesh else ():
                if colors is not None and materials.colors_of(mesh, colors) is None:
                    self.remark(f"mesh '{mesh.name}': it has no colours of vertices '{colors}', which the material '{name}' reads")
            thing.to_mesh_clear()
        return key if self.meshes[key] else None

    def lamp_of(self, thing, content):
        """The key of an object's lamp; None if it gives no light."""
        lamp = thing.data
        name = lamp.original.name_full
        if name not in content.lamps:
            values, remarks = lamps.properties_of(lamp)
            for remark in remarks:
                self.remark(f"lamp '{thing.name}': {remark}")
            values['shadow_kind'] = None if lamp.use_shadow else 'NONE'
            content.lamps[name] = values
        return name if content.lamps[name]['intensity'] > 0 else None

    def material_of(self, material, content):
        """(name, whether light passes it, placing of its images, name of the colours of vertices)"""
        name = material.name_full
        if name not in self.materials:
            for remark in materials.remarks_of(material):
                self.remark(f"material '{name}': {remark}")
            values = self.properties_of(material, content)
            if values.get('transmission', 0) > 0 and (absorption := materials.absorption(material)) is not None:
                values['attenuation_color'], values['attenuation_distance'] = absorption
            self.materials[name] = values
            if 'gnomon_thickness' in material:
                self.thicknesses[name] = max(float(material['gnomon_thickness']), 0.0)
            self.placings[name] = self.common_placing(material)
            self.color_names[name] = materials.base_color_name(material)
        return name, self.materials[name].get('transmission', 0) > 0, self.placings[name], self.color_names[name]

    def common_placing(self, material):
        """The placing of the first image of a material."""
        nodes = [node for node in materials.surface_nodes(material) if node.type == 'TEX_IMAGE' and node.image]
        placings = list(dict.fromkeys(map(placing_of, nodes)))
        if len(placings) > 1:
            self.remark(f"material '{material.name}': the viewport places its images all as '{nodes[0].image.name}'")
        if any(node.extension != 'REPEAT' for node in nodes):
            self.remark(f"material '{material.name}': the viewport repeats all images")
        return placings[0] if placings else Placing()

    def add_materials(self, parts, content):
        for part in parts:
            if part.material == DEFAULT_SURFACE:
                content.materials[part.material] = {
                    **MATERIAL, 'name': materials.DEFAULT_NAME, 'base_color': materials.DEFAULT_COLOR, 'specular': 0.0,
                    'is_double_sided': True}
            elif part.material not in content.materials:
                name, thickness = part.material
                content.materials[part.material] = {**self.materials[name], 'thickness': self.thicknesses.get(name, thickness)}

    def properties_of(self, material, content):
        values = {**MATERIAL, 'name': material.name, 'is_double_sided': not material.use_backface_culling}
        if not materials.has_nodes(material):
            return {**values, 'base_color': tuple(material.diffuse_color[:3]), 'metallic': material.metallic, 'roughness': material.roughness}
        plain = materials.plain_values(material)
        if plain is not None:
            return {**values, **plain, **({'alpha_mode': 'MASK'} if 'alpha' in plain else {})}
        node, principled, emission = materials.surface_of(material), materials.principled_of(material), materials.emission_of(material)
        if node.type == 'BSDF_DIFFUSE':
            values.update({'specular': 0.0, **self.color_of(node.inputs['Color'], content), **self.normal_of(node.inputs['Normal'], content)})
            self.remark_sockets(node, material, values)
            return values
        values.update(self.principled(principled, material, content) if principled else materials.BLACK)
        if emission:
            # An Emission replaces that of a Principled BSDF before the same Mix Shader, as in files.
            values.pop('emissive_texture', None)
            values.update(self.emission_of(emission.inputs['Color'], emission.inputs['Strength'].default_value, content))
            self.remark_sockets(emission, material, values)
        return values

    def emission_of(self, socket, strength, content):
        image = image_of(socket)
        if image is None:
            return {'emissive': tuple(max(c * strength, 0.0) for c in socket.default_value[:3])}
        emissive = {'emissive': 3 * (max(strength, 0.0),)}
        return {**emissive, 'emissive_texture': self.texture([(image, None)], content)} if strength > 0 else emissive

    def normal_of(self, socket, content):
        node = materials.source_of(socket)
        image = image_of(node.inputs['Color']) if node is not None and node.type == 'NORMAL_MAP' else None
        if image is None:
            return {}
        return {'normal_texture': self.texture([(image, None)], content), 'normal_scale': node.inputs['Strength'].default_value}

    def color_of(self, socket, content):
        image = image_of(socket)
        if image is None and materials.color_name(socket) is not None:
            return {'base_color': (1.0, 1.0, 1.0)}
        if image is None:
            return {'base_color': tuple(clamped(c) for c in socket.default_value[:3])}
        return {'base_color': (1.0, 1.0, 1.0), 'base_color_texture': self.texture([(image, None)], content)}

    def principled(self, node, material, content):
        def socket(*names):
            return next((node.inputs[name] for name in names if name in node.inputs), None)

        def number(default, *names):
            found = socket(*names)
            return default if found is None else found.default_value

        values = self.color_of(node.inputs['Base Color'], content)
        metallic, roughness = image_of(node.inputs['Metallic']), image_of(node.inputs['Roughness'])
        values['metallic'] = 1.0 if metallic else clamped(number(0.0, 'Metallic'))
        values['roughness'] = 1.0 if roughness else clamped(number(0.5, 'Roughness'))
        if metallic or roughness:
            channels = [(roughness, channel_of(node.inputs['Roughness'])), (metallic, channel_of(node.inputs['Metallic']))]
            values['metallic_roughness_texture'] = self.texture([(None, None), *channels], content)
        transmission = clamped(number(0.0, 'Transmission', 'Transmission Weight'))
        ior = max(number(1.45, 'IOR'), 1.0)
        f0 = ((ior - 1) / (ior + 1))**2
        level = 0.08 * number(0.5, 'Specular') if 'Specular' in node.inputs else 2 * f0 * number(0.5, 'Specular IOR Level')
        values['specular_color'] = 3 * (max((1 - transmission) * level + transmission * f0, 0.0) / DIELECTRIC_F0,)
        if transmission > 0:
            values.update(transmission=transmission, ior=ior)
        coat = clamped(number(0.0, 'Clearcoat', 'Coat Weight'))
        if coat > 0:
            values.update(coat=coat, coat_roughness=clamped(number(0.03, 'Clearcoat Roughness', 'Coat Roughness')))
        values.update(self.emission_of(socket('Emission', 'Emission Color'), number(1.0, 'Emission Strength'), content))
        values.update(self.normal_of(node.inputs['Normal'], content))
        self.remark_sockets(node, material, values)
        method = getattr(material, 'blend_method', 'OPAQUE')
        if method != 'OPAQUE':
            values['alpha_mode'] = 'MASK' if method == 'CLIP' else 'BLEND'
            values['alpha'] = 1.0 if node.inputs['Alpha'].is_linked else clamped(node.inputs['Alpha'].default_value)
            values['alpha_cutoff'] = material.alpha_threshold
        return values

    def remark_sockets(self, node, material, values):
        """Names the linked sockets of a surface that are not drawn, unless materials.remarks_of names them."""
        drawn = TEXTURES[node.type]
        for socket in (each for each in node.inputs if each.is_linked):
            nodes = materials.upstream(socket, [])
            if not all(materials.is_known(each) for each in nodes):
                continue
            if drawn.get(socket.name) == 'base_color_texture' and materials.color_name(socket) is not None:
                continue
            is_alpha = socket.name == 'Alpha' and image_of(socket) is not None and image_of(socket) == image_of(node.inputs['Base Color'])
            if not is_alpha and (values.get(drawn.get(socket.name)) is None or (socket.name != 'Normal' and image_of(socket) is None)):
                self.remark(f"material '{material.name}': what '{socket.name}' is linked to is not drawn in the viewport")

    def texture(self, sources, content):
        """The key of a texture of (image, channel) pairs: one whole image, or an image's channel for each of its channels."""
        key = tuple((image.name_full, channel) if image else None for image, channel in sources)
        # Updates of a depsgraph do not name images.
        images = [image for image, _ in sources if image]
        state = [(image.filepath, tuple(image.size), image.is_dirty) for image in images]
        old_state, texels = self.images.get(key, (None, None))
        if state != old_state or (key not in content.textures and any(image.is_dirty for image in images)):
            read = texels_of(sources)
            # The same array stands for the same texels.
            texels = texels if texels is not None and numpy.array_equal(texels, read) else read
            self.images[key] = state, texels
        content.textures[key] = texels
        return key


def clamped(value):
    return min(max(value, 0.0), 1.0)


def image_of(socket):
    """The image that a socket is linked to, also by a node that separates channels; None if there is none."""
    node = materials.source_of(socket) if socket is not None else None
    if node is not None and node.type in ('SEPARATE_COLOR', 'SEPRGB'):
        node = materials.source_of(node.inputs[0])
    image = node.image if node is not None and node.type == 'TEX_IMAGE' else None
    return image if image is not None and image.size[0] > 0 else None


def channel_of(socket):
    """The channel of its image that a socket reads."""
    node = materials.source_of(socket)
    if node is None or node.type == 'TEX_IMAGE':
        return 0
    link = socket.links[0]
    return [each.name for each in node.outputs].index(link.from_socket.name)


def texels_of(sources):
    """Height x width x 4 bytes, with the top row first. Without an image, a channel is full."""
    pictures = [(whole_texels(image) if image else None, channel) for image, channel in sources]
    if len(pictures) == 1:
        return pictures[0][0]
    first = next(picture for picture, _ in pictures if picture is not None)
    texels = numpy.full_like(first, 255)
    for i, (picture, channel) in enumerate(pictures):
        if picture is not None:
            rows = numpy.arange(first.shape[0]) * picture.shape[0] // first.shape[0]
            columns = numpy.arange(first.shape[1]) * picture.shape[1] // first.shape[1]
            texels[:, :, i] = picture[rows[:, None], columns, channel]
    return texels


def whole_texels(image):
    width, height = image.size
    pixels = numpy.empty(width * height * image.channels, numpy.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, image.channels)[::-1]
    if image.is_float and image.colorspace_settings.name != 'Non-Color':
        # Blender has them linear, and textures of colours are encoded.
        pixels = numpy.where(pixels <= 0.0031308, 12.92 * pixels, 1.055 * numpy.maximum(pixels, 0.0031308)**(1 / 2.4) - 0.055)
    texels = numpy.full((height, width, 4), 255, numpy.uint8)
    count = min(image.channels, 4)
    texels[:, :, :count] = numpy.round(255 * numpy.clip(pixels[:, :, :count], 0, 1))
    if image.channels < 3:
        texels[:, :, 1:3] = texels[:, :, :1]
    return texels
