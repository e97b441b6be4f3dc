# SPDX-License-Identifier: MIT
"""Gnomon: light glTF scenes with an EEVEE-style engine. doc/python.md has examples.

Units are metres, radians and watts; colours are linear, with Rec. 709 primaries.
"""

import copyreg as _copyreg
import os as _os
import tempfile as _tempfile
import warnings as _warnings

import numpy as _numpy

from gnomon._gnomon import *


def rotation(axis, angle):
    """The matrix (4x4 float64, [row, column]) of a turn by `angle` (rad) around `axis`, counter-clockwise as seen from its tip."""
    x, y, z = axis = _numpy.asarray(axis, float)
    length = _numpy.linalg.norm(axis)
    if axis.shape != (3,) or not 0 < length < _numpy.inf:
        raise ValueError(f"rotation: {axis} is no axis")
    cross = _numpy.array([(0, -z, y), (z, 0, -x), (-y, x, 0)]) / length
    matrix = _numpy.eye(4)
    matrix[:3, :3] += _numpy.sin(angle) * cross + (1 - _numpy.cos(angle)) * cross @ cross
    return matrix


def look_at(position, target, up=(0.0, 1.0, 0.0)):
    """The matrix (4x4 float64, [row, column]) of a node at `position` whose -Z axis points to `target`, for a camera or a lamp.

    Its Y axis is as close to `up` as possible. All in the space of the node's parent, m.
    """
    position, target, up = (_numpy.asarray(each, float) for each in (position, target, up))
    z = position - target
    x = _numpy.cross(up, z)
    if not _numpy.linalg.norm(x) > 1e-9 * _numpy.linalg.norm(up) * _numpy.linalg.norm(z):
        raise ValueError(f"look_at: from {position} to {target}, up {up} has no direction across")
    matrix = _numpy.eye(4)
    matrix[:3, 0] = x / _numpy.linalg.norm(x)
    matrix[:3, 2] = z / _numpy.linalg.norm(z)
    matrix[:3, 1] = _numpy.cross(matrix[:3, 2], matrix[:3, 0])
    matrix[:3, 3] = position
    return matrix


def _scene_of(data, has_cameras, has_lamps):
    with _tempfile.TemporaryDirectory() as folder:
        path = _os.path.join(folder, "scene.glb")
        with open(path, "wb") as file:
            file.write(data)
        scene = load(path)
    # A file without cameras, or without light, gets one where it is read.
    added = ([] if has_cameras else scene.cameras) + ([] if has_lamps else scene.lamps)
    for node in scene.nodes:
        if node.camera in added or node.lamp in added:
            scene.remove(node)
    for thing in added:
        scene.remove(thing)
    return scene


def _warn_of_unused(scene):
    meshes = {mesh for node in scene.nodes for mesh in node.meshes}
    used_materials = {mesh.material for mesh in meshes}
    used = {"meshes": meshes, "materials": used_materials, "lamps": {node.lamp for node in scene.nodes},
            "cameras": {node.camera for node in scene.nodes},
            "surface functions": {material.surface_function for material in used_materials if material is not None}}
    unused = [f"{len(left)} {kind}" for kind, things in used.items() if (left := set(getattr(scene, kind.replace(" ", "_"))) - things)]
    if unused:
        _warnings.warn(f"what no node uses is not pickled: {', '.join(unused)}", stacklevel=3)


def _reduced(scene):
    if not any(node.meshes for node in scene.nodes):
        if scene.nodes or scene.meshes or scene.materials or scene.lamps or scene.cameras:
            raise ValueError("a scene without a mesh at a node cannot be pickled")
        return Scene, ()
    _warn_of_unused(scene)
    with _tempfile.TemporaryDirectory() as folder:
        path = _os.path.join(folder, "scene.glb")
        scene._save(path)
        with open(path, "rb") as file:
            data = file.read()
    return _scene_of, (data, any(node.camera for node in scene.nodes), any(node.lamp for node in scene.nodes))


_copyreg.pickle(Scene, _reduced)
