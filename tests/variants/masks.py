# SPDX-License-Identifier: MIT
"""Masks and blended textures cover their part of a picture, in their colour, at any size of the picture and of the texture."""
import numpy

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
    "filter": ["linear", "nearest"],
    # As far above the cutoff as below it, or 0 and 1.
    "alphas": ["near the cutoff", "all or nothing"],
    # Factors of the alpha: of the material, and of all vertices, in floats or bytes.
    "factor": [1, 1, 0.8],
    "vertex alpha": [None, None, 1.0, 0.8, 204],
    "colour of nothing": [(1, 0, 0), (0, 0, 0), (1, 1, 1)],
    "file": ["data URI", "GLB"],
}
LINEAR, NEAREST = (9729, 9987), (9728, 9986)
GREEN = 200 / 255


def filtered_part(alphas, cutoff):
    """The part that a linear filter between texels, which repeat, shows: the mean of 16 x 16 points of each texel."""
    def finer(values, axis):
        steps = (numpy.arange(16) + 0.5) / 16
        return numpy.stack([values * (1 - step) + numpy.roll(values, -1, axis) * step for step in steps])

    return float(numpy.mean([finer(row, 0) >= cutoff for row in finer(alphas, 1)]))


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
    gltf = quad_scene()
    json = gltf.json
    json["extensionsUsed"] = ["KHR_materials_unlit"]
    vertex_alpha = 1 if of["vertex alpha"] is None else of["vertex alpha"] / (255 if isinstance(of["vertex alpha"], int) else 1)
    if of["mode"] == "BLEND":
        cutoff = 0
    else:
        # The least alpha of texels that are covered is below 1.
        of["cutoff"] = min(of["cutoff"], 0.5) if min(of["factor"], vertex_alpha) < 1 else of["cutoff"]
        cutoff = of["cutoff"] / (of["factor"] * vertex_alpha)
    # An alpha of vertices covers other texels, so that their alphas must be nearer to the cutoff.
    distance = min(cutoff, 1 - cutoff) / (4 if vertex_alpha < 1 else 1)
    is_near = of["mode"] == "MASK" and of["alphas"] == "near the cutoff"
    low, high = (cutoff - distance, cutoff + distance) if is_near else (0, 1)
    texture = gltf.texture(size, lambda u, v: (0, GREEN, 0, high) if is_covered(int(u * size), int(v * size)) else
                           (*of["colour of nothing"], low))
    # Few samples of a pixel that has few texels are at one place between their centres. With a whole number of texels in a pixel, it is the
    # same place for all pixels, and an irregular mask covers there what it covers at that place.
    reduced = of["reduced"]
    is_at_one_place = pattern not in ("columns", "rows") and size / reduced % of["pixels"] == 0 and of["samples"] < 16
    if is_at_one_place:
        reduced = 1
    texels_in_pixel = size / reduced / of["pixels"]
    is_linear = of["filter"] == "linear" and not is_at_one_place and \
        (of["samples"] == 16 or texels_in_pixel >= (2 if pattern in ("columns", "rows") else 4))
    magnified, minified = LINEAR if is_linear else NEAREST
    alphas = numpy.array([[high if is_covered(x, y) else low for x in range(size)] for y in range(size)])
    part = alphas.mean() * of["factor"] * vertex_alpha if of["mode"] == "BLEND" else filtered_part(alphas, cutoff) if is_linear else \
        (alphas >= cutoff).mean()
    json["samplers"] = [{"magFilter": magnified, "minFilter": minified}]
    json["textures"][0]["sampler"] = 0
    json["materials"][0].update(pbrMetallicRoughness={"baseColorTexture": texture, "baseColorFactor": [1, 1, 1, of["factor"]]},
                                alphaMode=of["mode"],
                                extensions={"KHR_materials_unlit": {}})
    if of["mode"] == "MASK":
        json["materials"][0]["alphaCutoff"] = of["cutoff"]
    if of["vertex alpha"] is not None:
        number, code, component = (255, "B", 5121) if isinstance(of["vertex alpha"], int) else (1.0, "f", 5126)
        accessor = gltf.accessor([[number, number, number, of["vertex alpha"]]] * 4, "VEC4", code, component)
        json["accessors"][accessor]["normalized"] = component == 5121
        json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = accessor
    path = gltf.write_form(f"{program.folder}/scene", of["file"])
    limit = ["--texture-size-max", str(size // reduced)] if reduced > 1 else []
    pixels = program.render(path, "--size", f"{of['pixels']}x{of['pixels']}", "--samples", str(of["samples"]), "--world", "1,1,1", *limit)
    # Without the pixels whose filter reaches over the edge.
    color = pixels[2:-2, 2:-2].mean((0, 1))
    width = of["pixels"] - 4
    # A part of a period at the edge along each axis, or three standard deviations of independent pixels. The samples of a pixel fall on one
    # phase of a pattern that repeats with the pixels.
    axis_count = 1 if pattern in ("columns", "rows") else 2
    tolerance = 0.02 + (1.5 / width if pattern == "random" else axis_count * 0.25 * 8 / size * of["pixels"] / width)
    tolerance += axis_count * {1: 0, 4: 0.08, 16: 0.02}[of["samples"]]
    expect(abs(color[3] - part) <= tolerance,
           f"covers {color[3]:.4f}, not {part:.4f} to {tolerance:.3f}; {texels_in_pixel} texels in a pixel")
    green = decoded_srgb(GREEN)
    # A linear filter mixes in the colour of texels with a little alpha, as glTF has it.
    # The colours of levels are those of texels that are covered without the alpha of vertices.
    if color[3] > 0.01 and (low == 0 or (magnified == NEAREST[0] and vertex_alpha == 1)):
        expect(abs(color[1] / color[3] - green) < 0.02, f"green is {color[1] / color[3]}, not {green}")
        expect(max(color[0], color[2]) / color[3] < 0.02, f"the colour of nothing is seen: {color}")
