# SPDX-License-Identifier: MIT
"""Images are drawn in the order of their use as long as --image-memory has room for them; others have a stand-in and a message."""
import os
import struct
import zlib

import numpy

from variants import QUAD, TRIANGLES, UVS, decoded_srgb, expect, gltf_file

VALUES = {
    "count": [2, 5, 8],
    # Most texels along an edge, after a reduction.
    "limit": [None, 64, 200, 512],
    "memory": [1, 1, 2, 64],
    "sizes": ["equal", "mixed", "long"],
    "kind": ["colour and alpha", "colour", "grey", "palette"],
    "shared": [False, True],
    "files": ["data URI", "GLB", "images beside"],
}


def png(width, height, grey, kind):
    """Of one grey value."""
    depth_and_type, row, palette = {"colour and alpha": ((8, 6), bytes([grey, grey, grey, 255]) * width, b""),
                                    "colour": ((8, 2), bytes([grey] * 3) * width, b""), "grey": ((8, 0), bytes([grey]) * width, b""),
                                    "palette": ((8, 3), b"\1" * width, bytes([0, 0, 0, grey, grey, grey]))}[kind]

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, *depth_and_type, 0, 0, 0)) +
            (chunk(b"PLTE", palette) if palette else b"") + chunk(b"IDAT", zlib.compress((b"\0" + row) * height)) + chunk(b"IEND", b""))


def check(program, random, of):
    count, limit = of["count"], of["limit"]
    gltf = gltf_file.Gltf()
    json = gltf.json
    json["extensionsUsed"] = ["KHR_materials_unlit"]
    json["cameras"] = [{"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.01, "zfar": 100}}]
    gltf.node(camera=0, translation=[0, 0, 10])
    json.update(images=[], textures=[], samplers=[{"magFilter": 9728, "minFilter": 9728}])
    quad_count = count * (2 if of["shared"] else 1)
    primitives = []
    room = of["memory"] * 2 ** 20 // 4
    expected = []
    for i in range(count):
        grey = 40 + 25 * i
        width, height = {"equal": (256, 256), "mixed": (random.choice([100, 256, 400]), random.choice([100, 256, 700])),
                         "long": (random.choice([3000, 20000]), random.choice([1, 16]))}[of["sizes"]]
        kept = (width, height)
        if limit and max(kept) > limit:
            # Halves are rounded up.
            kept = [max(int(edge * limit / max(width, height) + 0.5), 1) for edge in kept]
        is_right = kept[0] * kept[1] <= room and max(kept) <= 16384
        room -= kept[0] * kept[1] if is_right else 0
        data = png(width, height, grey, of["kind"])
        image = {"mimeType": "image/png"}
        if of["files"] == "images beside":
            image = {"uri": f"image%20{i}.png"}
            with open(os.path.join(program.folder, f"image {i}.png"), "wb") as file:
                file.write(data)
        else:
            image["bufferView"] = gltf.add_bytes(data)
        json["images"].append(image)
        for _ in range(2 if of["shared"] else 1):
            json["textures"].append({"source": i, "sampler": 0})
            texture = {"index": len(json["textures"]) - 1}
            low, high = (2 * at / quad_count - 1 for at in (len(primitives), len(primitives) + 1))
            primitives.append({
                "attributes": {"POSITION": gltf.accessor([[low if x < 0 else high, y, z] for x, y, z in QUAD], "VEC3"),
                               "TEXCOORD_0": gltf.accessor(UVS, "VEC2")},
                "indices": gltf.accessor([[index] for index in TRIANGLES], "SCALAR", "H", 5123),
                "material": gltf.material(pbrMetallicRoughness={"baseColorTexture": texture}, extensions={"KHR_materials_unlit": {}})})
            expected.append(decoded_srgb(grey / 255) if is_right else None)
    json["meshes"].append({"primitives": primitives})
    gltf.node(mesh=0)
    path = gltf.write_form(f"{program.folder}/scene", "GLB" if of["files"] == "GLB" else "data URI")
    size = 8 * quad_count
    status, _, messages = program.run("render", path, "-o", "picture.exr", "--size", f"{size}x{size}", "--samples", "1", "--world", "1,1,1",
                                      "--image-memory", str(of["memory"]), *(["--texture-size-max", str(limit)] if limit else []))
    expect(status == 0, f"status {status}: {messages}")
    pixels = program.read("picture.exr")
    for i, right in enumerate(expected):
        column = pixels[2:-2, 8 * i + 2:8 * i + 6, :3]
        if right is not None:
            error = numpy.abs(column - right).max()
            expect(error < 2e-3, f"texture {i} differs by {error}: {column[4, 1]}, not {right}; {messages}")
        else:
            # The stand-in has squares of two colours.
            expect(numpy.ptp(column) > 0.01 or numpy.abs(column - decoded_srgb((40 + 25 * i) / 255)).max() > 2e-3, f"texture {i} is drawn")
    expect(messages.count("is too large") + messages.count("--image-memory") >= (None in expected), messages)
