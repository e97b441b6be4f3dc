# SPDX-License-Identifier: MIT
"""A picture with a world is the same however its file spells the radiances.

The other spelling of each is an EXR file of 32-bit floats in red, green and blue, without another window, that --world names.
"""
import struct

import numpy
import OpenImageIO

from variants import expect, quad_scene, write_picture

VALUES = {
    "format": ["EXR", "HDR"],
    "size": [(1, 1), (2, 1), (9, 5), (16, 8), (31, 7), (64, 32), (600, 2)],
    "named by": ["option", "extras", "accessor"],
    "channels": ["RGB", "RGBA", "Y", "YA", "lower case", "only layer", "chosen layer", "beside layers", "only part", "chosen part"],
    "type": ["half", "float"],
    "compression": ["none", "rle", "zips", "zip", "piz", "pxr24"],
    "tiles": [False, False, True],
    "window": ["whole", "left", "right", "middle", "larger", "elsewhere"],
    "moved": [(0, 0), (5, -3)],
    "damage": [None, -1e-5, float("nan"), float("inf"), float("-inf")],
    "order": [f"{y}Y {{h}} {x}X {{w}}" for y in "-+" for x in "+-"] + [f"{x}X {{w}} {y}Y {{h}}" for y in "-+" for x in "+-"],
    "runs": ["new", "old", "none"],
    "exposure": [None, 2.0, 0.25],
    "strength": [1, 2],
}


def radiances(random, width, height, is_grey):
    """Radiances that halves, and mantissas of 8 bits with one exponent, hold exactly. The largest is 128 or more of 256."""
    rows = numpy.zeros((height, width, 3), numpy.float32)
    for y in range(height):
        repeats = random.choice([0.5, 0.5, 1])
        for x in range(width):
            # Runs of equal pixels, as older files have them.
            if x > 0 and random.random() < repeats:
                rows[y, x] = rows[y, x - 1]
                continue
            mantissas = [random.randrange(256) for _ in range(3)]
            mantissas[random.randrange(3)] |= 128
            rows[y, x] = numpy.array([max(mantissas)] * 3 if is_grey else mantissas) / 256 * 2.0 ** random.randrange(-3, 3)
    return rows


def write_exr(path, specs, pixels):
    """Writes parts of (width, height, channels) values."""
    output = OpenImageIO.ImageOutput.create(path)
    for i, (spec, values) in enumerate(zip(specs, pixels)):
        if len(specs) == 1:
            is_open = output.open(path, spec)
        else:
            is_open = output.open(path, tuple(specs)) if i == 0 else output.open(path, spec, "AppendSubimage")
        expect(is_open, output.geterror())
        write = output.write_tiles if spec.tile_width else output.write_image
        values = numpy.ascontiguousarray(values, numpy.float32)
        if spec.tile_width:
            expect(write(spec.x, spec.x + spec.width, spec.y, spec.y + spec.height, 0, 1, values), output.geterror())
        else:
            expect(write(values), output.geterror())
    output.close()


def exr_spec(of, width, height, names):
    spec = OpenImageIO.ImageSpec(width, height, len(names), of["type"])
    spec.channelnames = tuple(names)
    spec.attribute("compression", of["compression"])
    return spec


def write_variant(random, of, path, rows):
    """Writes an EXR file; returns its radiances in the display window, and the name of a layer."""
    height, width = rows.shape[:2]
    # The data window, from the upper left of the display window.
    x, y, data_width, data_height = {"left": (0, 0, max(width // 2, 1), height), "right": (width // 2, 0, width - width // 2, height),
                                     "middle": (width // 4, height // 4, max(width // 2, 1), max(height // 2, 1)),
                                     "larger": (-2, -1, width + 5, height + 3), "elsewhere": (width + 3, 0, 4, height)
                                     }.get(of["window"], (0, 0, width, height))
    shown = numpy.zeros_like(rows)
    data = radiances(random, data_width, data_height, of["channels"] in ("Y", "YA"))
    for j in range(data_height):
        for i in range(data_width):
            if 0 <= y + j < height and 0 <= x + i < width:
                data[j, i] = rows[y + j, x + i]
                shown[y + j, x + i] = rows[y + j, x + i]
    channels = of["channels"]
    other = radiances(random, data_width, data_height, False)
    values = [data]
    layer = None
    if channels in ("Y", "YA"):
        names = [list(channels)]
        values = [data[..., :len(channels)]]
    elif channels == "RGBA":
        names = [["R", "G", "B", "A"]]
        values = [numpy.concatenate([data, other[..., :1]], 2)]
    elif channels == "lower case":
        names = [["r", "g", "b"]]
    elif channels == "only layer":
        names = [["Sky.R", "Sky.G", "Sky.B"]]
    elif channels in ("chosen layer", "beside layers"):
        prefix = "Sky." if channels == "chosen layer" else ""
        layer = "Sky" if prefix else None
        names = [[prefix + c for c in "RGB"] + ["Fog." + c for c in "RGB"]]
        values = [numpy.concatenate([data, other], 2)]
    elif channels in ("only part", "chosen part"):
        names = [["R", "G", "B"], ["U", "V", "W"] if channels == "only part" else ["R", "G", "B"]]
        values = [data, other]
        layer = "Sky" if channels == "chosen part" else None
    else:
        names = [["R", "G", "B"]]
    specs = [exr_spec(of, data_width, data_height, of_part) for of_part in names]
    for spec, part in zip(specs, ("Sky", "Fog")):
        spec.x, spec.y = x + of["moved"][0], y + of["moved"][1]
        spec.full_x, spec.full_y = of["moved"]
        spec.full_width, spec.full_height = width, height
        if len(specs) > 1:
            spec.attribute("oiio:subimagename", part)
        if of["tiles"] and len(specs) == 1:
            spec.tile_width = spec.tile_height = 16
    write_exr(path, specs, values)
    return shown, layer


def old_runs(pixels):
    data = b""
    i = 0
    while i < len(pixels):
        count = 1
        while i + count < len(pixels) and pixels[i + count] == pixels[i] and count < 1000:
            count += 1
        data += pixels[i]
        for shift in (0, 8):
            if (count - 1) >> shift & 255:
                # The count of the second run in succession is of 256.
                data += (b"\1\1\1\0" if shift and not (count - 1) & 255 else b"") + bytes([1, 1, 1, (count - 1) >> shift & 255])
        i += count
    return data


def new_runs(pixels):
    data = bytes([2, 2, len(pixels) >> 8, len(pixels) & 255])
    for channel in range(4):
        values = [pixel[channel] for pixel in pixels]
        i = 0
        while i < len(values):
            run = 1
            while i + run < len(values) and values[i + run] == values[i] and run < 127:
                run += 1
            data += bytes([128 + run, values[i]]) if run > 2 else bytes([run] + values[i:i + run])
            i += run
    return data


def write_hdr(of, path, rows):
    height, width = rows.shape[:2]
    scaled = rows * (of["exposure"] or 1.0)
    order = of["order"]
    if order[1] == "X":
        scaled = scaled.transpose(1, 0, 2)
    # Rows of the file are from the top, or columns from the left, where their letters have these signs.
    if order[0] != ("-" if order[1] == "Y" else "+"):
        scaled = scaled[::-1]
    if order[7] != ("+" if order[1] == "Y" else "-"):
        scaled = scaled[:, ::-1]
    lines = []
    for row in scaled:
        pixels = []
        for color in row:
            exponent = int(numpy.ceil(numpy.log2(color.max() * 256 / 255))) if color.max() > 0 else -128
            while color.max() >= 2.0 ** exponent:
                exponent += 1
            while color.max() < 2.0 ** (exponent - 1):
                exponent -= 1
            pixels.append(bytes([int(value * 256 / 2.0 ** exponent) for value in color] + [exponent + 128]))
        lines.append(old_runs(pixels) if of["runs"] == "old" else
                     new_runs(pixels) if of["runs"] == "new" and 8 <= len(pixels) else b"".join(pixels))
    exposure = f"EXPOSURE={of['exposure']}\n" if of["exposure"] else ""
    with open(path, "wb") as file:
        file.write(f"#?RADIANCE\n# a comment\nFORMAT=32-bit_rle_rgbe\n{exposure}\n{order.format(w=width, h=height)}\n".encode())
        file.write(b"".join(lines))


def write_scene(path, rows=None, strength=None, picture=None):
    """A white quad in front of the world. With rows, their radiances are an accessor of the scene; picture names a file."""
    gltf = quad_scene(pbrMetallicRoughness={"metallicFactor": 0, "roughnessFactor": 0.5})
    gltf.json["nodes"][1]["scale"] = [0.5, 0.5, 0.5]
    gltf.json["cameras"] = [{"type": "perspective", "perspective": {"yfov": 2, "aspectRatio": 1, "znear": 0.01}}]
    gltf.json["nodes"][0]["translation"] = [0, 0, 1]
    extras = {}
    if rows is not None:
        accessor = gltf.accessor([[float(value) for value in pixel] for row in rows for pixel in row], "VEC3")
        for limit in ("min", "max"):
            del gltf.json["accessors"][accessor][limit]
        extras = {"gnomon_world_accessor": accessor, "gnomon_world_width": rows.shape[1]}
    elif picture:
        extras = {"gnomon_world": picture}
    if strength:
        extras["gnomon_world_strength"] = strength
    gltf.json["nodes"][0]["extras"] = extras
    gltf.write(path)


def check(program, random, of):
    is_hdr = of["format"] == "HDR"
    width, height = of["size"]
    rows = radiances(random, width, height, not is_hdr and of["channels"] in ("Y", "YA"))
    right = rows.copy()
    name = "sky map.hdr" if is_hdr else "sky map.exr"
    layer = None
    if of["damage"] is not None and not (is_hdr and of["named by"] != "accessor") and of["compression"] != "pxr24":
        x, y = random.randrange(width), random.randrange(height)
        rows[y, x] = of["damage"]
        right[y, x] = 0
        if of["damage"] == float("inf"):
            right[y, x] = right.max((0, 1))
    if of["named by"] == "accessor":
        if not numpy.isfinite(rows).all():
            return
    elif is_hdr:
        write_hdr(of, f"{program.folder}/{name}", rows)
    else:
        if of["window"] != "whole" or of["named by"] == "extras" and of["channels"].startswith("chosen"):
            rows = right.copy()
        shown, layer = write_variant(random, of, f"{program.folder}/{name}", rows)
        if of["window"] != "whole":
            right = shown
        if layer and of["named by"] == "extras":
            return
    write_picture(f"{program.folder}/right.exr", right)
    settings = ["--size", "24x24", "--samples", "1", "--background", "world"]
    strength = of["strength"]
    write_scene(f"{program.folder}/plain.gltf")
    expected = program.render("plain.gltf", "--world", "right.exr", "--world-strength", str(strength), *settings)
    if of["named by"] == "option":
        chosen = ["--world-layer", layer] if layer else []
        picture = program.render("plain.gltf", "--world", name, "--world-strength", str(strength), *chosen, *settings)
    else:
        write_scene(f"{program.folder}/lit.gltf", rows if of["named by"] == "accessor" else None, strength, name.replace(" ", "%20"))
        picture = program.render("lit.gltf", *settings)
    error = numpy.abs(picture - expected).max()
    expect(error <= 1e-6 * max(expected.max(), 1), f"differs by {error}")
