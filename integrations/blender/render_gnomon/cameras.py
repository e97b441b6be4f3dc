# SPDX-License-Identifier: MIT
"""Cameras of Blender in the words of Gnomon (doc/properties.md)."""

from mathutils import Vector


def frame_of(camera, scene):
    """(low, high): the corners of the frame, as the sensor fits it into the scene's picture. Of orthographic cameras, m."""
    corners = camera.view_frame(scene=scene)
    return tuple([choose(corner[axis] for corner in corners) for axis in (0, 1)] for choose in (min, max))


def shift_of(camera, scene):
    """(x, y): the shift of the frame in its widths and heights. Blender's is in its longer side, or as the sensor fits."""
    low, high = frame_of(camera, scene)
    return tuple((high[axis] + low[axis]) / 2 / (high[axis] - low[axis]) for axis in (0, 1))


def half_size_of(camera, scene):
    """Half the width and height of what an orthographic camera sees, m."""
    low, high = frame_of(camera, scene)
    return tuple((high[axis] - low[axis]) / 2 for axis in (0, 1))


def focus_of(thing):
    """The distance of the plane in focus along the view direction, as Cycles has it."""
    dof = thing.data.dof
    if dof.focus_object is None:
        return dof.focus_distance
    target = dof.focus_object.matrix_world
    bone = dof.focus_object.pose.bones.get(dof.focus_subtarget) if dof.focus_object.pose and dof.focus_subtarget else None
    if bone is not None:
        target = target @ bone.matrix
    forward = thing.matrix_world.to_quaternion() @ Vector((0, 0, -1))
    return abs(forward.dot(target.translation - thing.matrix_world.translation))


def aperture_of(thing):
    """Properties of the aperture of a camera. Empty where all is in focus."""
    camera = thing.data
    dof = camera.dof
    if not dof.use_dof or camera.type != 'PERSP' or dof.aperture_fstop <= 0:
        return {}
    return {'aperture_radius': 1e-3 * camera.lens / (2 * dof.aperture_fstop), 'focus_distance': focus_of(thing),
            'aperture_blades': dof.aperture_blades if dof.aperture_blades >= 3 else 0, 'aperture_rotation': dof.aperture_rotation,
            'aperture_ratio': dof.aperture_ratio}


def extras_of(thing, scene):
    """(extras, remarks): node extras of Gnomon for a camera, and what of the camera is not drawn."""
    camera = thing.data
    if camera.type == 'PANO':
        return {}, ["a panoramic camera is neither written nor drawn"]
    x, y = shift_of(camera, scene)
    values = {'shift_x': x, 'shift_y': y} if camera.shift_x or camera.shift_y else {}
    remarks = ["its depth of field is not drawn: it is orthographic"] if camera.type == 'ORTHO' and camera.dof.use_dof else []
    return {f'gnomon_{name}': value for name, value in {**values, **aperture_of(thing)}.items()}, remarks
