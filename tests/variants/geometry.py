# SPDX-License-Identifier: MIT
"""Pictures of random spellings of one scene are what glTF 2.0 says.

Each scene is a quad that fills the picture, red on the left and green on the right, or mirrored. It differs in the mode and the
indices of its primitive, in what opens it (morph targets, joints, sparse accessors, an animation), in its node (mirrored, instanced,
below others), in its set of texture coordinates and their transform, in its light, in its visibility and
in its files.
"""
import math
import struct

import numpy

from variants import QUAD, UVS, expect, gltf_file

VALUES = {
    "mode": [4, 5, 6],
    "indices": [None, "B", "H", "I"],
    "opened": ["at rest", "morph", "two morphs", "morph of node", "animated morph", "skin", "skin and morph", "sparse", "zeros and morph"],
    "node": ["plain", "mirrored", "matrix", "parent", "all axes", "instance", "far away"],
    "uv set": range(8),
    "transform": ["none", "offset", "scale", "rotation", "other set"],
    "material": ["unlit", "unlit", "lit", "lit front", "lit back"],
    "normals": [False, True],
    "seen": ["always", "visible", "animated", "hidden above"],
    "file": ["data URI", "buffer beside", "GLB", "GLB and buffer"],
}
COMPONENTS = {"B": 5121, "H": 5123, "I": 5125}
ORDERS = {4: [0, 1, 2, 0, 2, 3], 5: [0, 1, 3, 2], 6: [0, 1, 2, 3]}


def scene_of(random, of):
    """The scene of a choice; the colours of the left and the right half."""
    gltf = gltf_file.Gltf()
    json = gltf.json
    json["extensionsUsed"] = ["KHR_materials_unlit", "KHR_texture_transform", "EXT_mesh_gpu_instancing", "KHR_node_visibility",
                              "KHR_animation_pointer"]
    json["cameras"] = [{"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.01, "zfar": 100}}]
    gltf.node(camera=0, translation=[0, 0, 10])
    order = ORDERS[of["mode"]]

    def rows(of_vertices):
        return of_vertices if of["indices"] else [of_vertices[i] for i in order]

    def vectors(of_vertices):
        return gltf.accessor(rows(of_vertices), "VEC3")

    texture = gltf.texture(16, lambda u, v: (1, 0, 0, 1) if u < 0.5 else (0, 1, 0, 1))
    json["samplers"] = [{"magFilter": 9728, "minFilter": 9728}]
    json["textures"][0]["sampler"] = 0
    uv_set = of["uv set"]
    texture["texCoord"] = uv_set
    transform = {"none": None, "offset": {"offset": [0.5, 0]}, "scale": {"offset": [1, 0], "scale": [-1, 1]},
                 "rotation": {"offset": [1, 1], "rotation": math.pi}, "other set": {"texCoord": uv_set}}[of["transform"]]
    is_swapped = of["transform"] in ("offset", "scale", "rotation")
    if transform:
        texture["extensions"] = {"KHR_texture_transform": transform}
    if of["transform"] == "other set":
        texture["texCoord"] = (uv_set + 1) % 8
    brightness = 1
    if of["material"] == "unlit":
        material = gltf.material(pbrMetallicRoughness={"baseColorTexture": texture}, extensions={"KHR_materials_unlit": {}})
    else:
        # A sun of 1 W/m2 towards -Z, on a surface that scatters it and has no highlight.
        json["extensionsUsed"] += ["KHR_lights_punctual", "KHR_materials_specular"]
        json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "directional", "intensity": 683}]}}
        gltf.node(extensions={"KHR_lights_punctual": {"light": 0}})
        material = gltf.material(pbrMetallicRoughness={"baseColorTexture": texture, "metallicFactor": 0},
                                 extensions={"KHR_materials_specular": {"specularFactor": 0}})
        brightness = 1 / math.pi

    primitive = {"attributes": {}, "mode": of["mode"], "material": material}
    if of["indices"]:
        primitive["indices"] = gltf.accessor([[i] for i in order], "SCALAR", of["indices"], COMPONENTS[of["indices"]])
    attributes = primitive["attributes"]
    if of["normals"]:
        attributes["NORMAL"] = vectors([[0, 0, 1]] * 4)
    for i in range(8):
        attributes[f"TEXCOORD_{i}"] = gltf.accessor(rows(UVS if i == uv_set else [[0.2, 0.2]] * 4), "VEC2")
    mesh = {"primitives": [primitive]}
    node = {}
    opened = of["opened"]
    rest = QUAD
    if opened in ("skin", "skin and morph"):
        # The second joint moves the right edge away from the left one.
        rest = [[-1, y if opened == "skin" else 0, 0] for _, y, _ in QUAD]
        attributes["JOINTS_0"] = gltf.accessor(rows([[int(x > 0), 0, 0, 0] for x, _, _ in QUAD]), "VEC4", "B", 5121)
        attributes["WEIGHTS_0"] = gltf.accessor(rows([[1, 0, 0, 0]] * 4), "VEC4")
        json["skins"] = [{"joints": [gltf.node(), gltf.node(translation=[2, 0, 0])]}]
        node["skin"] = 0
    elif "morph" in opened:
        rest = [[0, 0, 0]] * 4
    if "morph" in opened:
        morph_count = 2 if opened == "two morphs" else 1
        shift = [2, 0, 0] if node else [0, 0, 0]
        moves = [[(to[i] - at[i] - (shift[i] if to[0] > 0 else 0)) / morph_count for i in range(3)] for to, at in zip(QUAD, rest)]
        primitive["targets"] = [{"POSITION": vectors(moves)} for _ in range(morph_count)]
        if opened == "morph of node":
            mesh["weights"], node["weights"] = [0], [1]
        elif opened != "animated morph":
            mesh["weights"] = [1] * morph_count
    if opened == "sparse":
        vertices = rows(QUAD)
        json["accessors"].append({
            "componentType": 5126, "count": len(vertices), "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0],
            "sparse": {"count": len(vertices),
                       "indices": {"componentType": 5123,
                                   "bufferView": gltf.add_bytes(struct.pack(f"<{len(vertices)}H", *range(len(vertices))))},
                       "values": {"bufferView": gltf.add_bytes(b"".join(struct.pack("<3f", *row) for row in vertices))}}})
        attributes["POSITION"] = len(json["accessors"]) - 1
    elif opened == "zeros and morph":
        json["accessors"].append({"componentType": 5126, "count": len(rows(QUAD)), "type": "VEC3", "min": [0, 0, 0], "max": [0, 0, 0]})
        attributes["POSITION"] = len(json["accessors"]) - 1
    else:
        attributes["POSITION"] = vectors(rest)
    json["meshes"].append(mesh)
    node["mesh"] = 0

    parent = {}
    placed = of["node"]
    if placed == "instance" and "skin" in node or placed == "far away" and "skin" not in node:
        placed = "mirrored"
    if placed == "mirrored":
        node["scale"] = [-1, 1, 1]
    elif placed == "matrix":
        node["matrix"] = [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
    elif placed == "parent":
        parent["scale"] = [-1, 1, 1]
    elif placed == "all axes":
        # The half turn about Y makes the point reflection a reflection of y.
        node["scale"], node["rotation"] = [-1, -1, -1], [0, 1, 0, 0]
    elif placed == "instance":
        node["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": {"SCALE": gltf.accessor([[-1, 1, 1]], "VEC3")}}}
    elif placed == "far away":
        node["translation"], node["rotation"] = [50, 0, 0], [0, 1, 0, 0]
    # The transform of a node with a skin has no effect.
    is_swapped ^= placed in ("mirrored", "matrix", "parent", "instance") and "skin" not in node
    index = gltf.node(**node)
    above = gltf.node(children=[index], **parent)

    channels = []
    samplers = []

    def animate(target, values, kind, code="f", component=5126, **sampler):
        times = gltf.accessor([[0], [1]], "SCALAR")
        json["accessors"][times].update(min=[0], max=[1])
        channels.append({"sampler": len(samplers), "target": target})
        samplers.append({"input": times, "output": gltf.accessor(values, kind, code, component), **sampler})

    def set_visible(of_node, is_visible):
        json["nodes"][of_node].setdefault("extensions", {})["KHR_node_visibility"] = {"visible": is_visible}

    if opened == "animated morph":
        animate({"node": index, "path": "weights"}, [[0], [1]], "SCALAR")
    red, green = (brightness, 0, 0, 1), (0, brightness, 0, 1)
    left, right = (green, red) if is_swapped else (red, green)
    if of["seen"] == "visible":
        set_visible(index, True)
    elif of["seen"] == "hidden above":
        set_visible(above, False)
        left = right = (0, 0, 0, 0)
    elif of["seen"] == "animated":
        seen = random.choice([index, above])
        set_visible(seen, False)
        pointer = f"/nodes/{seen}/extensions/KHR_node_visibility/visible"
        animate({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}}, [[0], [1]], "SCALAR", "B", 5121,
                interpolation="STEP")
    if channels:
        json["animations"] = [{"channels": channels, "samplers": samplers}]
    return gltf, left, right


def check_halves(program, path, gltf, of, left, right):
    """The picture of a file has the colours left and right."""
    options = ["--frames", "1", "--fps", "1"] if "animations" in gltf.json else []
    if of["material"].startswith("lit "):
        options += ["--casters", of["material"].split()[1]]
    pixels = program.render(path, "--size", "8x8", "--samples", "1", "--world", "none", "--background", "none", *options)
    # Filters reach over the middle and the edges.
    for x, color in ((1, left), (6, right)):
        error = numpy.abs(pixels[1:7, x] - color).max()
        expect(error <= 1e-3, f"column {x} differs by {error}: {pixels[4, x]}, not {color}")


def check(program, random, of):
    gltf, left, right = scene_of(random, of)
    check_halves(program, gltf.write_form(f"{program.folder}/scene", of["file"]), gltf, of, left, right)
