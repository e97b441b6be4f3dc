# SPDX-License-Identifier: MIT
"""Used by the kinds of variants: random choices, runs of the program, and pictures."""
import os
import subprocess
import sys

import numpy
import OpenImageIO

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "../../scripts"))
import gltf_file

QUAD = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
UVS = [[0, 1], [1, 1], [1, 0], [0, 0]]
TRIANGLES = [0, 1, 2, 0, 2, 3]


class Wrong(Exception):
    """What a variant has that is not right."""


def expect(condition, *values):
    if not condition:
        raise Wrong(" ".join(str(value) for value in values))


class Choices:
    """Random choices of which each value of each is used before one is used again."""

    def __init__(self, random, values_of):
        self.random = random
        self.values_of = values_of
        self.unused = {name: [] for name in values_of}

    def draw(self):
        chosen = {}
        for name, values in self.values_of.items():
            if not self.unused[name]:
                self.unused[name] = self.random.sample(list(values), len(values))
            chosen[name] = self.unused[name].pop()
        return chosen


class Program:
    """The program in a folder."""

    def __init__(self, path, folder):
        self.path = path
        self.folder = folder

    def run(self, *arguments, **options):
        """Its status, standard output and messages."""
        finished = subprocess.run([self.path, *arguments], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False,
                                  timeout=60, **options)
        return finished.returncode, finished.stdout, finished.stderr.decode()

    def render(self, scene, *arguments, output="picture.exr"):
        """The red, green, blue and alpha of a picture with this scene; rows from the top."""
        status, _, messages = self.run("render", scene, "-o", output, *arguments)
        expect(status == 0, f"status {status}: {messages}")
        return self.read(output)

    def read(self, picture):
        return read_picture(os.path.join(self.folder, picture))


def read_picture(path):
    file = OpenImageIO.ImageInput.open(path)
    expect(file is not None, OpenImageIO.geterror())
    names = file.spec().channelnames
    return numpy.asarray(file.read_image("float"))[..., [names.index(name) for name in "RGBA" if name in names]]


def write_picture(path, pixels):
    """An EXR file of 32-bit floats in red, green and blue; rows from the top."""
    spec = OpenImageIO.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "float")
    file = OpenImageIO.ImageOutput.create(path)
    expect(file.open(path, spec) and file.write_image(numpy.ascontiguousarray(pixels, numpy.float32)), file.geterror())
    file.close()


def decoded_srgb(value):
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


def quad_scene(**material):
    """A quad that fills the picture of an orthographic camera."""
    gltf = gltf_file.Gltf()
    gltf.json["cameras"] = [{"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.01, "zfar": 100}}]
    gltf.node(camera=0, translation=[0, 0, 10])
    primitive = {"attributes": {"POSITION": gltf.accessor(QUAD, "VEC3"), "TEXCOORD_0": gltf.accessor(UVS, "VEC2")},
                 "indices": gltf.accessor([[i] for i in TRIANGLES], "SCALAR", "H", 5123), "material": gltf.material(**material)}
    gltf.json["meshes"].append({"primitives": [primitive]})
    gltf.node(mesh=0)
    return gltf
