# SPDX-License-Identifier: MIT
"""Changes of Blender's data for the time of one export, which the user never sees."""

import bpy

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
