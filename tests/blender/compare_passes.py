# SPDX-License-Identifier: MIT
"""compare_passes BLENDER PROGRAM: passes of Blender's engine are the layers of the program, to rounding.

They are the same bit for bit, unless the scene has a picture as its world: its texels are then rounded once more on their way
through Blender. The largest difference in eight scenes was 2.6e-6, of a normal.
"""

import json
import sys

import numpy
import OpenImageIO

BOUND = 1e-5


def channels(path):
    file = OpenImageIO.ImageInput.open(path)
    return dict(zip(file.spec().channelnames, numpy.moveaxis(file.read_image("float"), -1, 0)))


blender, program = (channels(path) for path in sys.argv[1:])
passes = {"Combined": "{}", "Depth": "depth.{}", "Normal": "normal.{}", "Position": "position.{}", "DiffCol": "albedo.{}",
          "Emit": "emission.{}", "Env": "world.{}",
          **{f"Crypto{kind}{i:02}": f"Crypto{kind}{i:02}.{{}}" for kind in ("Object", "Material") for i in range(3)}}
# The manifest resolves the ids.
metadata = OpenImageIO.ImageInput.open(sys.argv[1]).spec()
for stem in ("CryptoObject", "CryptoMaterial"):
    key, = (each.name.rsplit("/", 1)[0] for each in metadata.extra_attribs
            if each.name.startswith("cryptomatte/") and each.name.endswith("/name") and each.value == f"ViewLayer.{stem}")
    ids = {int(text, 16) for text in json.loads(metadata[f"{key}/manifest"]).values()}
    found = set(blender[f"ViewLayer.{stem}00.R"].view(numpy.uint32).ravel().tolist()) - {0}
    assert found and found <= ids, (stem, found, ids)
compared = set()
for name, picture in blender.items():
    _, kind, channel = name.split(".")
    if name == "ViewLayer.Combined.A":
        assert (picture == 1).all()
        continue
    # +Z is up in Blender, and +Y in files.
    is_turned = kind in ("Normal", "Position")
    own = {"Y": "Z", "Z": "Y"}.get(channel, channel) if is_turned else channel
    expected = program[passes[kind].format(own)] * (-1 if is_turned and channel == "Y" else 1)
    # Ids are numbers of all magnitudes.
    is_id = kind.startswith("Crypto") and channel in "RB"
    error = (picture != expected).mean() if is_id else (abs(picture - expected) / numpy.maximum(1, abs(expected))).max()
    assert error < BOUND, f"{name} differs by {error}"
    compared.add(kind)
assert compared == set(passes), compared
assert program["depth.Z"].min() < 100
