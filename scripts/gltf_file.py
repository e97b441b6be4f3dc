# SPDX-License-Identifier: MIT
"""Used by scripts/animation, scripts/test_scenes and scripts/textured_scene: writes glTF files."""
import base64
import json
import os
import struct
import zlib


def is_seen(corners, normal):
    """Whether the front of a triangle is on the side of the normal."""
    a, b, c = corners
    one, two = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
    return sum(normal[i] * (one[(i + 1) % 3] * two[(i + 2) % 3] - one[(i + 2) % 3] * two[(i + 1) % 3]) for i in range(3)) > 0


def png(size, color):
    """A PNG of 8 bits: color(u, v) gives four values from 0 to 1 for the middle of a texel; v is down."""
    rows = b"".join(b"\0" + bytes(round(255 * value) for x in range(size) for value in color((x + 0.5) / size, (y + 0.5) / size))
                    for y in range(size))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 6, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


class Gltf:
    """A glTF file of one buffer."""

    def __init__(self):
        self.bytes = bytearray()
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "bufferViews": [], "accessors": [], "meshes": [], "nodes": []}

    def add_bytes(self, data):
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(data)})
        self.bytes += data + bytes(-len(data) % 4)
        return len(self.json["bufferViews"]) - 1

    def accessor(self, rows, kind, code="f", component=5126):
        flat = [value for row in rows for value in row]
        data = struct.pack(f"<{len(flat)}{code}", *flat)
        accessor = {"bufferView": self.add_bytes(data), "componentType": component, "count": len(rows), "type": kind}
        if kind == "VEC3":
            accessor["min"] = [min(row[i] for row in rows) for i in range(3)]
            accessor["max"] = [max(row[i] for row in rows) for i in range(3)]
        self.json["accessors"].append(accessor)
        return len(self.json["accessors"]) - 1

    def node(self, **node):
        self.json["nodes"].append(node)
        return len(self.json["nodes"]) - 1

    def material(self, **material):
        self.json.setdefault("materials", []).append(material)
        return len(self.json["materials"]) - 1

    def texture(self, size, color):
        """A texture of png(size, color)."""
        self.json.setdefault("images", []).append({"bufferView": self.add_bytes(png(size, color)), "mimeType": "image/png"})
        self.json.setdefault("textures", []).append({"source": len(self.json["images"]) - 1})
        return {"index": len(self.json["textures"]) - 1}

    def grid(self, across, along, place, material=0):
        """
        Adds a mesh: place(u, v) gives position and normal for u and v from 0 to 1, which are its texture coordinates. Fronts are
        on the side of the normals.
        Returns its primitive and its rows.
        """
        rows = [place(i / across, j / along) for j in range(along + 1) for i in range(across + 1)]
        indices = []
        for j in range(along):
            for i in range(across):
                a = j * (across + 1) + i
                for triangle in ([a, a + 1, a + across + 1], [a + across + 1, a + 1, a + across + 2]):
                    indices += triangle if is_seen([rows[k][0] for k in triangle], rows[a][1]) else triangle[::-1]
        self.json["meshes"].append({"primitives": [{
            "attributes": {"POSITION": self.accessor([row[0] for row in rows], "VEC3"),
                           "NORMAL": self.accessor([row[1] for row in rows], "VEC3"),
                           "TEXCOORD_0": self.accessor([[i / across, j / along] for j in range(along + 1)
                                                        for i in range(across + 1)],
                                                       "VEC2")},
            "indices": self.accessor([[index] for index in indices], "SCALAR", "I", 5125), "material": material}]})
        return self.json["meshes"][-1]["primitives"][0], rows

    def write(self, path):
        self._write(path, "data:application/octet-stream;base64," + base64.b64encode(self.bytes).decode())

    def write_form(self, stem, form):
        """Writes it as "data URI", "buffer beside", "GLB" or "GLB and buffer". Returns its path."""
        path = stem + (".glb" if form.startswith("GLB") else ".gltf")
        if form == "data URI":
            self.write(path)
            return path
        if form != "GLB":
            with open(stem + ".bin", "wb") as file:
                file.write(self.bytes)
        self._write(path, None if form == "GLB" else os.path.basename(stem) + ".bin")
        return path

    def _write(self, path, uri):
        """No uri: the buffer is the GLB's."""
        self.json["scenes"] = [{"nodes": [i for i in range(len(self.json["nodes"]))
                                          if not any(i in node.get("children", []) for node in self.json["nodes"])]}]
        self.json["buffers"] = [{"byteLength": len(self.bytes)} | ({"uri": uri} if uri else {})]
        text = json.dumps(self.json).encode()
        if path.endswith(".glb"):
            chunks = [(b"JSON", text + b" " * (-len(text) % 4))] + ([] if uri else [(b"BIN\0", self.bytes + bytes(-len(self.bytes) % 4))])
            body = b"".join(struct.pack("<I", len(data)) + kind + data for kind, data in chunks)
            text = b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body
        with open(path, "wb") as file:
            file.write(text)
