# SPDX-License-Identifier: MIT
"""Changes of Blender's data for the time of one export, which the user never sees."""

import bpy

from . import materials

# Changes that have not ended.
unended = []


class Temporary:
    """Changes that end() takes back, the last one first.

    The exporter calls nothing when it fails. Blender's main loop, the next export, or the writing of a file then takes the changes back.
    """

    def __init__(self):
        end_all()
        self.undo = []
        unended.append(self)
        bpy.app.timers.register(end_all)

    def set(self, owner, name, value):
        old = getattr(owner, name)
        if old != value:
            setattr(owner, name, value)
            self.undo.append(lambda: setattr(owner, name, old))

    def set_item(self, owner, key, value):
        old = owner[key]
        owner[key] = value
        self.undo.append(lambda: owner.__setitem__(key, old))

    def show(self, thing):
        """Shows an object that is hidden in the view layer."""
        layer = bpy.context.view_layer
        thing.hide_set(False, view_layer=layer)
        self.undo.append(lambda: thing.hide_set(True, view_layer=layer))

    def add_material(self):
        material = bpy.data.materials.new('None')
        self.undo.append(lambda: bpy.data.materials.remove(material))
        return material

    def add_mesh(self, mesh):
        self.undo.append(lambda: bpy.data.meshes.remove(mesh))

    def add_object(self, name, mesh, collection):
        thing = bpy.data.objects.new(name, mesh)
        collection.objects.link(thing)
        self.undo.append(lambda: bpy.data.objects.remove(thing))
        return thing

    def fill_slots(self, mesh, material):
        """Puts a material into the empty slots of a mesh."""
        def put(index, value):
            mesh.materials[index] = value

        for i, each in enumerate(mesh.materials):
            if each is None:
                put(i, material)
                self.undo.append(lambda i=i: put(i, None))

    def replace_diffuse(self, material):
        """Puts a Principled BSDF at the surface of a material in the place of its Diffuse BSDF."""
        tree = material.node_tree
        surface = materials.output_of(material).inputs['Surface']
        diffuse = materials.source_of(surface)
        node = tree.nodes.new('ShaderNodeBsdfPrincipled')
        for socket, name in ((diffuse.inputs['Color'], 'Base Color'), (diffuse.inputs['Normal'], 'Normal')):
            link = materials.link_of(socket)
            if link is not None:
                tree.links.new(link.from_socket, node.inputs[name])
            elif name == 'Base Color':
                node.inputs[name].default_value = socket.default_value
        before = surface.links[0].from_socket
        tree.links.new(node.outputs[0], surface)

        def put_back():
            tree.nodes.remove(node)
            tree.links.new(before, surface)

        self.undo.append(put_back)

    def end(self):
        while self.undo:
            self.undo.pop()()
        if self in unended:
            unended.remove(self)


@bpy.app.handlers.persistent
def end_all(*_):
    for each in list(unended):
        each.end()


def register():
    bpy.app.handlers.save_pre.append(end_all)


def unregister():
    end_all()
    bpy.app.handlers.save_pre.remove(end_all)
