# SPDX-License-Identifier: MIT
"""Keeps a scene of Gnomon equal to what a host describes. It needs no Blender."""

from dataclasses import dataclass, field
from typing import Any


@dataclass
class Part:
    """Triangles of one material: arrays as of gnomon.Scene.add_mesh, and a key of Content.materials or None."""

    arrays: dict[str, Any]
    material: Any


@dataclass
class Node:
    """matrix: 4x4, m. mesh, lamp: keys of Content.meshes and Content.lamps, or None."""

    matrix: Any
    mesh: Any = None
    lamp: Any = None
    casts_shadow: bool = True


@dataclass
class Content:
    """A scene. Things have keys, by which they are found again.

    textures: arrays. materials, lamps: properties, of which those that are missing have the defaults of the module; those that end in
    "_texture" are keys of textures, and enumerators are names. meshes: lists of Part. world: arguments of gnomon.Scene.set_world, or None.
    An array or a list of parts that changed is another object.
    """

    textures: dict[Any, Any] = field(default_factory=dict)
    materials: dict[Any, dict[str, Any]] = field(default_factory=dict)
    meshes: dict[Any, list[Part]] = field(default_factory=dict)
    lamps: dict[Any, dict[str, Any]] = field(default_factory=dict)
    nodes: dict[Any, Node] = field(default_factory=dict)
    world: dict[str, Any] | None = None


class Mirror:
    """A scene of the Python module `gnomon`. The first camera is self.camera at the node self.eye."""

    def __init__(self, gnomon):
        self.enumerations = {'kind': gnomon.LampKind, 'area_shape': gnomon.AreaShape, 'shadow_kind': gnomon.ShadowKind,
                             'alpha_mode': gnomon.AlphaMode}
        new = gnomon.Scene()
        self.defaults = {type(thing): thing for thing in (new.add_material(), new.add_lamp())}
        self.scene = gnomon.Scene()
        self.shown = Content()
        self.textures, self.materials, self.meshes, self.lamps, self.nodes = {}, {}, {}, {}, {}
        self.camera = self.scene.add_camera()
        self.eye = self.scene.add_node(camera=self.camera)

    def show(self, content):
        """Edits what differs from the content that was shown last. What refers to a thing comes after it, and goes before it."""
        shown = self.shown
        self.show_things(content, 'textures', self.add_texture, self.edit_texture)
        self.show_things(content, 'materials', self.add_material, self.edit_thing)
        self.show_things(content, 'meshes', self.add_mesh, self.edit_mesh)
        self.show_things(content, 'lamps', lambda values: self.scene.add_lamp(**self.values_of(values)), self.edit_thing)
        self.show_things(content, 'nodes', self.add_node, self.edit_node)
        for kind in ('nodes', 'lamps', 'meshes', 'materials', 'textures'):
            self.remove_things(content, kind)
        if content.world is not shown.world:
            if content.world is None:
                self.scene.remove_world()
            else:
                self.scene.set_world(**content.world)
        self.shown = content

    def show_things(self, content, kind, add, edit):
        things, old = getattr(self, kind), getattr(self.shown, kind)
        if old is getattr(content, kind):
            return
        for key, value in getattr(content, kind).items():
            before = old.get(key)
            if value is before:
                continue
            if key not in things:
                things[key] = add(value)
            elif not is_same(value, before):
                edited = edit(things[key], value, before)
                if edited is not None:
                    things[key] = edited

    def remove_things(self, content, kind):
        things, wanted = getattr(self, kind), getattr(content, kind)
        # All that are wanted are there.
        if len(things) == len(wanted):
            return
        for key in set(things) - set(wanted):
            thing = things.pop(key)
            for each in thing if isinstance(thing, list) else [thing]:
                self.scene.remove(each)

    def add_texture(self, texels):
        return self.scene.add_texture(texels)

    @staticmethod
    def edit_texture(texture, texels, _):
        texture.texels = texels

    def values_of(self, values):
        """Properties with the module's things: textures for their keys, and enumerators for their names."""
        def value_of(name, value):
            if value is None:
                return None
            if name.endswith('_texture'):
                return self.textures[value]
            return self.enumerations[name].__members__[value] if name in self.enumerations else value

        return {name: value_of(name, value) for name, value in values.items()}

    def edit_thing(self, thing, values, old):
        defaults = self.defaults[type(thing)]
        thing.edit(**{name: getattr(defaults, name) for name in old.keys() - values.keys()}, **self.values_of(values))

    def add_material(self, values):
        return self.scene.add_material(**self.values_of(values))

    def add_mesh(self, parts):
        return [self.scene.add_mesh(**part.arrays, material=self.materials.get(part.material)) for part in parts]

    def edit_mesh(self, meshes, parts, old):
        """The meshes of the parts: the same as far as they are as many."""
        for mesh, part, before in zip(meshes, parts, old):
            if part.arrays is not before.arrays:
                mesh.edit(**part.arrays, material=self.materials.get(part.material))
            elif part.material != before.material:
                mesh.material = self.materials.get(part.material)
        for mesh in meshes[len(parts):]:
            self.scene.remove(mesh)
        edited = meshes[:len(parts)] + self.add_mesh(parts[len(meshes):])
        if len(edited) != len(meshes):
            keys = {key for key, each in self.meshes.items() if each is meshes}
            for key, node in self.shown.nodes.items():
                if node.mesh in keys and key in self.nodes:
                    self.nodes[key].meshes = edited
        return edited

    def properties_of(self, node):
        return {'parent_from_node': node.matrix, 'meshes': self.meshes.get(node.mesh, []), 'lamp': self.lamps.get(node.lamp),
                'casts_shadow': node.casts_shadow}

    def add_node(self, node):
        return self.scene.add_node(**self.properties_of(node))

    def edit_node(self, thing, node, old):
        if (node.mesh, node.lamp, node.casts_shadow) == (old.mesh, old.lamp, old.casts_shadow):
            thing.parent_from_node = node.matrix
        else:
            thing.edit(**self.properties_of(node))


def is_same(a, b):
    """Whether two values of the same kind are equal. Arrays and lists of parts are compared as objects by the caller."""
    if isinstance(a, dict):
        return a == b
    if isinstance(a, Node):
        return (a.mesh, a.lamp, a.casts_shadow) == (b.mesh, b.lamp, b.casts_shadow) and a.matrix.tobytes() == b.matrix.tobytes()
    return False
