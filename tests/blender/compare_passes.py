# SPDX-License-Identifier: MIT
"""compare_passes BLENDER PROGRAM: passes of Blender's engine are the layers of the program, to rounding."""

import sys

import numpy
import OpenImageIO


def channels(path):
    file = OpenImageIO.ImageInput.open(path)
    return dict(zip(file.spec().channelnames, numpy.moveaxis(file.read_image("float"), -1, 0)))


blender, program = (channels(path) for path in sys.argv[1:])
# +Z is up in Blender, and +Y in files.
names = {"Combined.R": "R", "Combined.G": "G", "Combined.B": "B", "Depth.Z": "depth.Z", "Normal.X": "normal.X",
         "Normal.Z": "normal.Y", "DiffCol.R": "albedo.R", "DiffCol.G": "albedo.G", "DiffCol.B": "albedo.B"}
for name, own in names.items():
    a, b = blender[f"ViewLayer.{name}"], program[own]
    error = abs(a - b).max() / max(1, abs(b).max() if own != "depth.Z" else 1)
    assert error < 1e-4, f"{name} and {own} differ by {error}"
assert (blender["ViewLayer.Combined.A"] == 1).all()
assert (blender["ViewLayer.Normal.Y"] == -program["normal.Z"]).all()
assert program["depth.Z"].min() < 10
