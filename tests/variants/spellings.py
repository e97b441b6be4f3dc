# SPDX-License-Identifier: MIT
"""Scenes of geometry.py are drawn as they are, however their files spell them.

The elements of a file stand in any order, with names, extras and defaults or without. Its JSON has any order of keys, escapes, white space
and forms of numbers. Its bytes are in data URIs, files and GLBs of all forms.
"""
import base64
import json
import os
import struct
import urllib.parse

import geometry

VALUES = {name: values for name, values in geometry.VALUES.items() if name != "file"} | {
    "order": [False, True],
    "unused": [False, True],
    "defaults": [False, True],
    "limits": [True, True, False],
    "names": ["none", "equal", "odd"],
    "integers": ["integers", "floats", "exponents"],
    "escapes": [False, True],
    "keys": ["in order", "in any order"],
    "white space": ["none", "lines", "tabs"],
    "buffers": [1, 2],
    "file": ["base64", "percent", "beside", "odd name", "folder", "GLB", "GLB padded with NUL", "GLB with chunks", "GLB and buffer"],
}
NAMES = ["", "a/b", "Würfel 1", "\u65b9\u5757", 'quote " and \\', "../x", "{scene}", "tab\t", "x" * 300, "\U0001f4a1"]


def references(gltf, kind):
    """The places of all references to elements of a kind, as containers with keys."""
    found = []

    def add(container, key):
        if isinstance(container, dict) and key not in container:
            return
        if isinstance(container[key], list):
            found.extend((container[key], i) for i in range(len(container[key])))
        else:
            found.append((container, key))

    if kind == "accessors":
        for mesh in gltf["meshes"]:
            for primitive in mesh["primitives"]:
                add(primitive, "indices")
                for attributes in [primitive["attributes"], *primitive.get("targets", [])]:
                    found.extend((attributes, key) for key in attributes)
        for animation in gltf.get("animations", []):
            for sampler in animation["samplers"]:
                found += [(sampler, "input"), (sampler, "output")]
        for skin in gltf.get("skins", []):
            add(skin, "inverseBindMatrices")
        for node in gltf["nodes"]:
            for key in node.get("extensions", {}).get("EXT_mesh_gpu_instancing", {}).get("attributes", {}):
                found.append((node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"], key))
    elif kind == "bufferViews":
        for accessor in gltf["accessors"]:
            add(accessor, "bufferView")
            if "sparse" in accessor:
                found += [(accessor["sparse"]["indices"], "bufferView"), (accessor["sparse"]["values"], "bufferView")]
        for image in gltf.get("images", []):
            add(image, "bufferView")
    elif kind == "nodes":
        for node in gltf["nodes"]:
            add(node, "children")
        for scene in gltf["scenes"]:
            add(scene, "nodes")
        for skin in gltf.get("skins", []):
            add(skin, "joints")
        for animation in gltf.get("animations", []):
            for channel in animation["channels"]:
                add(channel["target"], "node")
    elif kind == "materials":
        found = [(primitive, "material") for mesh in gltf["meshes"] for primitive in mesh["primitives"]]
    elif kind == "textures":
        found = [(material["pbrMetallicRoughness"]["baseColorTexture"], "index") for material in gltf["materials"]
                 if "pbrMetallicRoughness" in material]
    elif kind == "images":
        found = [(texture, "source") for texture in gltf["textures"] if "source" in texture]
    elif kind == "meshes":
        for node in gltf["nodes"]:
            add(node, "mesh")
    return found


UNUSED = {
    "accessors": {"componentType": 5126, "count": 1, "type": "SCALAR"},
    "nodes": {"translation": [7, 0, 0]},
    "materials": {"alphaMode": "BLEND"},
    "textures": {},
    "meshes": None,
    "bufferViews": {"buffer": 0, "byteLength": 1},
    "images": None,
}


def reorder(random, gltf, is_shuffled, has_unused):
    for kind, unused in UNUSED.items():
        elements = gltf.get(kind, [])
        places = references(gltf, kind)
        order = list(range(len(elements)))
        if has_unused and unused is not None:
            elements.append(dict(unused))
            order.insert(random.randrange(len(elements)), len(elements) - 1)
        if is_shuffled:
            random.shuffle(order)
        gltf[kind] = [elements[i] for i in order]
        new_place = {old: new for new, old in enumerate(order)}
        for container, key in places:
            container[key] = new_place[container[key]]
        if kind == "nodes":
            for animation in gltf.get("animations", []):
                for channel in animation["channels"]:
                    pointer = channel["target"].get("extensions", {}).get("KHR_animation_pointer")
                    if pointer:
                        parts = pointer["pointer"].split("/")
                        parts[2] = str(new_place[int(parts[2])])
                        pointer["pointer"] = "/".join(parts)
        if not gltf[kind]:
            del gltf[kind]


def add_defaults(gltf):
    for accessor in gltf["accessors"]:
        accessor.setdefault("normalized", False)
        if "bufferView" in accessor:
            accessor.setdefault("byteOffset", 0)
    for node in gltf["nodes"]:
        if "matrix" not in node:
            for key, value in (("translation", [0, 0, 0]), ("rotation", [0, 0, 0, 1]), ("scale", [1, 1, 1])):
                node.setdefault(key, value)
    for material in gltf["materials"]:
        material.setdefault("alphaMode", "OPAQUE")
        material.setdefault("alphaCutoff", 0.5)
        material.setdefault("emissiveFactor", [0, 0, 0])
        material.setdefault("pbrMetallicRoughness", {}).setdefault("roughnessFactor", 1)
    for sampler in gltf["samplers"]:
        sampler.setdefault("wrapS", 10497)


def add_names(random, gltf, kind):
    for elements in gltf.values():
        if isinstance(elements, list):
            for element in elements:
                if isinstance(element, dict):
                    element["name"] = "thing" if kind == "equal" else random.choice(NAMES)
                    if kind == "odd":
                        element["extras"] = random.choice([{"name": 1, "mesh": -1}, [], None, "text", 5, {"extensions": {}}])


def spelled(random, value, of, depth=0):
    """Its JSON."""
    def child(one):
        return spelled(random, one, of, depth + 1)

    space = {"none": "", "lines": "\n" + " " * depth, "tabs": "\r\n\t"}[of["white space"]]
    if isinstance(value, dict):
        keys = list(value)
        if of["keys"] == "in any order":
            random.shuffle(keys)
        return "{" + ",".join(f"{space}{child(key)}{space}:{child(value[key])}" for key in keys) + space + "}"
    if isinstance(value, list):
        return "[" + ",".join(space + child(one) for one in value) + space + "]"
    if isinstance(value, str) and of["escapes"]:
        return '"' + "".join(f"\\u{ord(c):04{random.choice('xX')}}" if ord(c) < 0x10000 and (ord(c) < 32 or c in '"\\' or random.random() < 0.3)
                             else c for c in value) + '"'
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        if of["integers"] == "floats" and value == int(value):
            return f"{int(value)}.0"
        if of["integers"] == "exponents" and value == int(value):
            return random.choice([f"{int(value)}e0", f"{10 * int(value)}E-1", f"{int(value)}.00e+00"])
    return json.dumps(value, ensure_ascii=random.random() < 0.5)


def data_uri(random, data, form):
    kind = random.choice(["application/octet-stream", "application/gltf-buffer", "", "Application/Octet-Stream;charset=utf-8"])
    scheme = random.choice(["data", "DATA", "Data"])
    if form == "percent":
        return f"{scheme}:{kind}," + "".join(f"%{byte:02{random.choice('xX')}}" for byte in data)
    text = base64.b64encode(data).decode()
    if random.random() < 0.5:
        text = urllib.parse.quote(text, safe="")
    return f"{scheme}:{kind};{random.choice(['base64', 'BASE64', 'Base64'])},{text}"


def write(program, random, gltf, of):
    """Returns its path."""
    form = of["file"]
    document = gltf.json
    document["scenes"] = [{"nodes": [i for i in range(len(document["nodes"]))
                                     if not any(i in node.get("children", []) for node in document["nodes"])]}]
    buffers = [bytes(gltf.bytes)]
    if of["buffers"] == 2:
        # The second half of the views are in a second buffer.
        split = document["bufferViews"][len(document["bufferViews"]) // 2]["byteOffset"]
        buffers = [buffers[0][:split], buffers[0][split:]]
        for view in document["bufferViews"]:
            if view["byteOffset"] >= split:
                view.update(buffer=1, byteOffset=view["byteOffset"] - split)
    if not of["limits"]:
        for accessor in document["accessors"]:
            accessor.pop("min", None), accessor.pop("max", None)
    reorder(random, document, of["order"], of["unused"])
    if of["defaults"]:
        add_defaults(document)
    document["buffers"] = []
    for i, data in enumerate(buffers):
        uri = None
        if form in ("base64", "percent"):
            uri = data_uri(random, data, form)
        elif i > 0 or not form.startswith("GLB") or form == "GLB and buffer":
            name = {"odd name": f"büffer #{i} 100%.bin", "folder": f"below/it/{i}.bin"}.get(form, f"{i}.bin")
            os.makedirs(os.path.dirname(os.path.join(program.folder, name)), exist_ok=True)
            with open(os.path.join(program.folder, name), "wb") as file:
                file.write(data)
            uri = random.choice(["", "./"]) + urllib.parse.quote(name)
        document["buffers"].append({"byteLength": len(data)} | ({"uri": uri} if uri else {}))
    if of["names"] != "none":
        add_names(random, document, of["names"])
    text = spelled(random, document, of).encode()
    path = os.path.join(program.folder, random.choice(["scene", "a scene", "szene ü"]) + (".glb" if form.startswith("GLB") else ".gltf"))
    if form.startswith("GLB"):
        padding = b"\0" if form == "GLB padded with NUL" else b" "
        chunks = [(b"JSON", text + padding * (-len(text) % 4))]
        if form != "GLB and buffer":
            chunks.append((b"BIN\0", buffers[0] + bytes(-len(buffers[0]) % 4)))
        if form == "GLB with chunks":
            chunks += [(b"ABCD", b"1234"), (b"EMPT", b"")]
        body = b"".join(struct.pack("<I", len(data)) + kind + data for kind, data in chunks)
        text = b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body
    with open(path, "wb") as file:
        file.write(text)
    return path


def check(program, random, of):
    gltf, left, right = geometry.scene_of(random, of)
    geometry.check_halves(program, write(program, random, gltf, of), gltf, of, left, right)
