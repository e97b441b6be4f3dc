# SPDX-License-Identifier: MIT
"""Masks and blended textures cover their part of a picture, in their colour, at any size of the picture and of the texture."""
from variants import decoded_srgb, expect, quad_scene

VALUES = {
    "mode": ["MASK", "MASK", "MASK", "BLEND"],
    "pattern": ["columns", "rows", "dots", "holes", "random"],
    "covered": [1, 2, 3, 4, 5, 6, 7],
    "texels": [64, 128, 256],
    "pixels": [16, 23, 32, 45, 64, 101, 128],
    "samples": [1, 1, 4, 16],
    "reduced": [1, 1, 2, 4],
    "cutoff": [0.25, 0.5, 0.8],
    # A linear filter rounds the corners of dots and fills random texels where a pixel's centre is a corner of four.
    "filter": ["linear for stripes", "nearest"],
    "colour of nothing": [(1, 0, 0), (0, 0, 0), (1, 1, 1)],
    "file": ["data URI", "GLB"],
}
LINEAR, NEAREST = (9729, 9987), (9728, 9986)
GREEN = 200 / 255


def check(program, random, of):
    covered = of["covered"]
    pattern = of["pattern"]
    if pattern == "random":
        cells = [random.random() < covered / 8 for _ in range(of["texels"] ** 2)]
    # Dots and holes of a quarter of the period along both edges, or of more.
    side = min(max(covered, 2), 6) if pattern in ("dots", "holes") else covered

    def is_covered(x, y):
        if pattern == "random":
            return cells[y * of["texels"] + x]
        return {"columns": x % 8 < side, "rows": y % 8 < side, "dots": x % 8 < side and y % 8 < side,
                "holes": x % 8 >= side or y % 8 >= side}[pattern]

    size = of["texels"]
    part = sum(is_covered(x, y) for y in range(size) for x in range(size)) / size ** 2
    gltf = quad_scene()
    json = gltf.json
    json["extensionsUsed"] = ["KHR_materials_unlit"]
    # Alphas as far above the cutoff as below it, so that the filter between two texels changes sides in their middle.
    distance = min(of["cutoff"], 1 - of["cutoff"])
    low, high = (0, 1) if of["mode"] == "BLEND" else (of["cutoff"] - distance, of["cutoff"] + distance)
    texture = gltf.texture(size, lambda u, v: (0, GREEN, 0, high) if is_covered(int(u * size), int(v * size)) else
                           (*of["colour of nothing"], low))
    has_stripes = pattern in ("columns", "rows")
    magnified, minified = LINEAR if has_stripes and of["filter"] != "nearest" else NEAREST
    json["samplers"] = [{"magFilter": magnified, "minFilter": minified}]
    json["textures"][0]["sampler"] = 0
    json["materials"][0].update(pbrMetallicRoughness={"baseColorTexture": texture}, alphaMode=of["mode"],
                                extensions={"KHR_materials_unlit": {}})
    if of["mode"] == "MASK":
        json["materials"][0]["alphaCutoff"] = of["cutoff"]
    path = gltf.write_form(f"{program.folder}/scene", of["file"])
    limit = ["--texture-size-max", str(size // of["reduced"])] if of["reduced"] > 1 else []
    pixels = program.render(path, "--size", f"{of['pixels']}x{of['pixels']}", "--samples", str(of["samples"]), "--world", "1,1,1", *limit)
    # Without the pixels whose filter reaches over the edge.
    color = pixels[2:-2, 2:-2].mean((0, 1))
    width = of["pixels"] - 4
    # A part of a period at the edge, or three standard deviations of independent pixels. Four samples fall on one phase of a pattern that
    # repeats with the pixels.
    tolerance = 0.02 + (1.5 / width if pattern == "random" else 0.25 * 8 / size * of["pixels"] / width) + (0.08 if of["samples"] == 4 else 0)
    expect(abs(color[3] - part) <= tolerance,
           f"covers {color[3]:.4f}, not {part:.4f} to {tolerance:.3f}; {size / of['reduced'] / of['pixels']} texels in a pixel")
    green = decoded_srgb(GREEN)
    # A linear filter mixes in the colour of texels with a little alpha, as glTF has it.
    if color[3] > 0.01 and (low == 0 or magnified == NEAREST[0]):
        expect(abs(color[1] / color[3] - green) < 0.02, f"green is {color[1] / color[3]}, not {green}")
        expect(max(color[0], color[2]) / color[3] < 0.02, f"the colour of nothing is seen: {color}")
