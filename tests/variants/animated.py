# SPDX-License-Identifier: MIT
"""Four columns, each animated in its own way by one or several animations, have at any time the colour that glTF 2.0 says.

Values are interpolated in steps, along lines and along splines, before, between and after their keys. The camera may mirror the picture.
"""
import math

import numpy

from variants import expect, gltf_file

VALUES = {
    "animations": ["one", "one for each column", "one for each channel"],
    "interpolation": ["STEP", "LINEAR", "CUBICSPLINE"],
    "keys": [1, 2, 3, 5],
    "frame": range(7),
    "columns": ["colour", "factor", "strength", "factor and strength", "factor and strength", "offset", "scale", "rotation", "visible",
                "moved", "parent moved", "still"],
    "axes": [(1, 1), (-1, 1), (1, -1), (-1, -1)],
    "file": ["data URI", "buffer beside", "GLB", "GLB and buffer"],
    "names": [None, "equal"],
}
FPS = 4


def value_at(times, values, tangents, interpolation, time):
    """glTF 2.0, appendix C."""
    if time <= times[0]:
        return values[0]
    if time >= times[-1]:
        return values[-1]
    k = max(i for i in range(len(times)) if times[i] <= time)
    length = times[k + 1] - times[k]
    t = (time - times[k]) / length
    if interpolation == "STEP":
        return values[k]
    if interpolation == "LINEAR":
        return (1 - t) * values[k] + t * values[k + 1]
    return ((2 * t**3 - 3 * t**2 + 1) * values[k] + length * (t**3 - 2 * t**2 + t) * tangents[k][1] + (3 * t**2 - 2 * t**3) * values[k + 1] +
            length * (t**3 - t**2) * tangents[k + 1][0])


def check(program, random, of):
    gltf = gltf_file.Gltf()
    json = gltf.json
    json["extensionsUsed"] = ["KHR_materials_unlit", "KHR_texture_transform", "KHR_node_visibility", "KHR_animation_pointer",
                              "KHR_materials_emissive_strength", "KHR_materials_specular"]
    x_axis, y_axis = of["axes"]
    json["cameras"] = [{"type": "orthographic", "orthographic": {"xmag": x_axis, "ymag": 0.25 * y_axis, "znear": 0.01, "zfar": 100}}]
    gltf.node(camera=0, translation=[0, 0, 10])
    halves = gltf.texture(16, lambda u, v: (1, 0, 0, 1) if u < 0.5 else (0, 1, 0, 1))
    json["samplers"] = [{"magFilter": 9728, "minFilter": 9728}]
    json["textures"][0]["sampler"] = 0
    time = of["frame"] / FPS
    animations = []

    def animated(column, target, kind, low=0.0, high=1.0, values=None, interpolation=of["interpolation"]):
        """Adds a channel; its value at the time."""
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[kind]
        count = of["keys"]
        times = sorted(random.sample([i / 8 for i in range(12)], count))
        keys = [numpy.array(random.choice(values) if values else [random.uniform(low, high) for _ in range(width)], float) for _ in range(count)]
        tangents = [[numpy.array([random.uniform(-0.2, 0.2) for _ in range(width)]) for _ in range(2)] for _ in range(count)]
        rows = keys if interpolation != "CUBICSPLINE" else [row for key, (before, after) in zip(keys, tangents) for row in (before, key, after)]
        inputs = gltf.accessor([[t] for t in times], "SCALAR")
        json["accessors"][inputs].update(min=[times[0]], max=[times[-1]])
        code, component = ("B", 5121) if values == [[0], [1]] else ("f", 5126)
        output = gltf.accessor([[int(x) if code == "B" else float(x) for x in row] for row in rows], kind, code, component)
        if of["animations"] == "one for each channel" or not animations or \
                of["animations"] == "one for each column" and animations[-1]["column"] != column:
            animations.append({"column": column, "channels": [], "samplers": []})
        animations[-1]["channels"].append({"sampler": len(animations[-1]["samplers"]), "target": target})
        animations[-1]["samplers"].append({"input": inputs, "output": output, "interpolation": interpolation})
        return value_at(times, keys, tangents, interpolation, time)

    def pointer(path):
        return {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": path}}}

    expected = []
    unlit = {"KHR_materials_unlit": {}}
    for column in range(4):
        kind = random.choice(VALUES["columns"]) if column else of["columns"]
        low, high = column / 2 - 1, column / 2 - 0.5
        at = len(json.get("materials", []))
        color = [random.random() for _ in range(3)]
        material = {"pbrMetallicRoughness": {"baseColorFactor": [*color, 1]}, "extensions": unlit}
        node = {}
        parent = {}
        node_at, parent_at = len(json["nodes"]), len(json["nodes"]) + 1
        path = f"/materials/{at}/"
        if kind == "colour":
            color = animated(column, pointer(path + "pbrMetallicRoughness/baseColorFactor"), "VEC4", 0.3, 0.7)[:3]
        elif kind in ("factor", "strength", "factor and strength"):
            factor = numpy.array([random.uniform(0, 0.8) for _ in range(3)])
            strength = random.choice([0, 0.5, 5])
            material = {"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0},
                        "emissiveFactor": list(factor),
                        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": strength},
                                       "KHR_materials_specular": {"specularFactor": 0}}}
            channels = [one for one in ("factor", "strength") if one in kind]
            for one in random.sample(channels, len(channels)):
                if one == "factor":
                    factor = animated(column, pointer(path + "emissiveFactor"), "VEC3", 0.3, 0.7)
                else:
                    strength = animated(column, pointer(path + "extensions/KHR_materials_emissive_strength/emissiveStrength"), "SCALAR", 1, 9)
            color = factor * strength
        elif kind in ("offset", "scale", "rotation"):
            # The texture is looked up at one place, which moves along u in steps.
            material = {"pbrMetallicRoughness": {"baseColorTexture": dict(halves)}, "extensions": unlit}
            values = {"offset": [[0, 0], [0.5, 0]], "scale": [[1, 1], [3, 1]], "rotation": [[0], [math.pi]]}[kind]
            material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = {"KHR_texture_transform": {}}
            target = pointer(path + f"pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/{kind}")
            value = animated(column, target, "SCALAR" if kind == "rotation" else "VEC2", values=values, interpolation="STEP")
            color = (1, 0, 0) if list(value) == values[0] else (0, 1, 0)
        elif kind == "visible":
            node["extensions"] = {"KHR_node_visibility": {"visible": random.choice([False, True])}}
            target = pointer(f"/nodes/{node_at}/extensions/KHR_node_visibility/visible")
            color = color if animated(column, target, "SCALAR", values=[[0], [1]], interpolation="STEP")[0] else (0, 0, 0)
        elif kind in ("moved", "parent moved"):
            moved_at = node_at if kind == "moved" else parent_at
            target = random.choice([{"node": moved_at, "path": "translation"}, pointer(f"/nodes/{moved_at}/translation")])
            value = animated(column, target, "VEC3", values=[[0, 0, 0], [0, 9, 0]], interpolation="STEP")
            color = color if value[1] == 0 else (0, 0, 0)
        expected.append(color)
        primitive = {"attributes": {"POSITION": gltf.accessor([[low, -1, 0], [high, -1, 0], [high, 1, 0], [low, 1, 0]], "VEC3"),
                                    "TEXCOORD_0": gltf.accessor([[0.25, 0.25]] * 4, "VEC2")},
                     "indices": gltf.accessor([[i] for i in (0, 1, 2, 0, 2, 3)], "SCALAR", "H", 5123), "material": gltf.material(**material)}
        json["meshes"].append({"primitives": [primitive]})
        gltf.node(mesh=column, **node)
        gltf.node(children=[node_at], **parent)
    for animation in animations:
        del animation["column"]
        if of["names"]:
            animation["name"] = of["names"]
    if animations:
        json["animations"] = random.sample(animations, len(animations))
    path = gltf.write_form(f"{program.folder}/scene", of["file"])
    frame = ["--frames", str(of["frame"]), "--fps", str(FPS)] if animations else []
    status, _, messages = program.run("render", path, "-o", "picture.exr", "--size", "16x4", "--samples", "1", "--world", "none", *frame)
    expect(status == 0 and "animation" not in messages, f"status {status}: {messages}")
    pixels = program.read("picture.exr")[::y_axis, ::x_axis]
    for column, color in enumerate(expected):
        error = numpy.abs(pixels[1:3, 4 * column + 1:4 * column + 3, :3] - numpy.array(color)).max()
        expect(error <= 2e-3 * max(1, max(color)), f"column {column} differs by {error}: {pixels[1, 4 * column + 1]}, not {color}; {messages}")
