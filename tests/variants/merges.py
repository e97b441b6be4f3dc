# SPDX-License-Identifier: MIT
"""Parts of one picture are merged whatever the spelling of their settings, and parts of two pictures are refused.

The settings are those that `gnomon render --help` describes. A setting of text needs values here.
"""
import os
import re

import numpy

from variants import expect, quad_scene, write_picture

VALUES = {
    "parts": ["tiles", "ranges"],
    # Options that differ between the parts.
    "change": ["nothing", "setting", "setting", "setting", "scene", "world", "harmless", "harmless"],
    "count": [0, 1, 2, 4, 8],
    "frame": [False, False, True],
}
TEXTS = {
    "camera": ["near", "far"],
    "pcf": ["1", "3x3", "5x5", "disk:8"],
    "variant": ["red", "blue"],
    "world": ["0.5,1,2", "2,1,0.5", "studio", "sky.exr"],
    "background": ["world", "0.25,0.5,1", "1,1,1", "none"],
    "animation": ["turn", "move"],
}
# Options that parts of a picture cannot have, and those that make or name the parts.
LEFT_OUT = {"output", "size", "noise-threshold", "debug", "aov", "world-layer", "frames", "step", "resume", "sample-range", "tile", "max-error",
            "max-time", "report", "time-limit", "part", "stop-after", "checkpoint", "backend", "repeat", "redraw-shadows"}
# Beside the settings whose help says so.
HARMLESS = {"explain": [None], "strict": [None], "progress": [None], "json": ["a.json", "b.json"], "trace": ["a.trace", "b.trace"],
            "only-below": ["."]}


def settings_of(program):
    """A function that draws a value, for each option; and the values of the options that the picture does not depend on."""
    status, text, _ = program.run("render", "--help")
    expect(status == 0, "no help")
    draws, harmless = {}, dict(HARMLESS)
    options = text.decode().split("\nOptions that do not go together")[0]
    for name, kind, lines in re.findall(r"^  (?:-\w,)?--([\w-]+)(?: (.*?))?((?:  .*)?$(?:\n {8}.*$)*)", options, re.M):
        if name in LEFT_OUT or name in HARMLESS or name == "help":
            continue
        words = re.search(r"{(.*?)}", kind)
        if "The picture does not depend on it." in " ".join(lines.split()):
            harmless[name] = words[1].split(",")
            continue
        limits = re.search(r"in \[(\S+) - (\S+)\]", kind)
        if name in TEXTS:
            draws[name] = lambda random, values=TEXTS[name]: random.choice(values)
        elif words:
            draws[name] = lambda random, values=words[1].split(","): random.choice(values)
        else:
            expect(limits, f"--{name} has no values in this test")
            low, high = float(limits[1]), float(limits[2])
            if kind.startswith("INT"):
                # Large enough for the scene, small enough for its time.
                low, high = {"shadow-size": (32, 300), "vertices-max": (1000, 1e6)}.get(name, (low, min(high, low + 300)))
                draws[name] = lambda random, low=int(low), high=int(high): str(random.randint(low, high))
            else:
                low, high = max(low, -8), min(high, 8)
                draws[name] = lambda random, low=low, high=high: f"{random.uniform(low, high):.3f}"
    draws["samples"] = lambda random: str(random.choice([4, 6]))
    return draws, harmless


def respelt(random, value):
    """Another spelling of a number, or of numbers."""
    def one(text):
        number = float(text)
        return random.choice([text, text + "0" if "." in text else text + ".0", f"{number:.9e}"])

    if re.fullmatch(r"-?\d+\.\d+|-?\d+(\.\d+)?(,\d+(\.\d+)?){2}", value):
        return ",".join(one(part) for part in value.split(","))
    return value


def arguments_of(random, settings):
    arguments = []
    for name in random.sample(sorted(settings), len(settings)):
        value = settings[name]
        if value is None:
            arguments.append(f"--{name}")
        elif random.random() < 0.5:
            arguments.append(f"--{name}={respelt(random, value)}")
        else:
            arguments += [f"--{name}", respelt(random, value)]
    return arguments


def write_scene(path, color):
    gltf = quad_scene(pbrMetallicRoughness={"baseColorFactor": [*color, 1]}, doubleSided=True)
    json = gltf.json
    json["extensionsUsed"] = ["KHR_materials_variants", "KHR_lights_punctual"]
    json["nodes"][0]["name"] = "near"
    json["cameras"][0] = {"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}
    json["nodes"][1]["scale"] = [0.7, 0.7, 0.7]
    gltf.node(camera=0, name="far", translation=[0.25, 0, 20])
    gltf.node(translation=[1, 1, 2], extensions={"KHR_lights_punctual": {"light": 0}})
    json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 2000}]},
                          "KHR_materials_variants": {"variants": [{"name": "red"}, {"name": "blue"}]}}
    mappings = [{"variants": [i], "material": gltf.material(pbrMetallicRoughness={"baseColorFactor": base})}
                for i, base in enumerate(([1, 0, 0, 1], [0, 0, 1, 1]))]
    json["meshes"][0]["primitives"][0]["extensions"] = {"KHR_materials_variants": {"mappings": mappings}}
    times = gltf.accessor([[0], [1]], "SCALAR")
    json["accessors"][times].update(min=[0], max=[1])
    json["animations"] = [
        {"name": name, "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}],
         "samplers": [{"input": times, "output": gltf.accessor([[0, 0, 0], to], "VEC3")}]}
        for name, to in (("turn", [0.5, 0, 0]), ("move", [0, 0.5, 0]))]
    gltf.write(path)


def check(program, random, of):
    folder = program.folder
    write_scene(f"{folder}/scene.gltf", [0.5, 0.5, 0.5])
    small = ["--size", "8x6"]
    for sky, radiance in (("sky.exr", (1, 2, 3)), ("other.exr", (3, 2, 1))):
        write_picture(f"{folder}/{sky}", numpy.full((4, 8, 3), radiance))
    draws, harmless = settings_of(program)
    if not of["frame"]:
        for name in ("fps", "animation", "shutter"):
            del draws[name]
    first = {name: draws[name](random) for name in random.sample(sorted(draws), of["count"])}
    first.setdefault("samples", "4")
    if of["change"] == "world":
        first["world"] = "sky.exr"
    if of["frame"]:
        first.setdefault("animation", "turn")
    if of["change"] == "scene":
        # Variants have materials of their own, which stay.
        first.pop("variant", None)
    second = dict(first)
    change = of["change"]
    what = change
    if change == "setting":
        name = random.choice(sorted(draws))
        values = {draws[name](random) for _ in range(50)}
        # A value that is given may be the default.
        first.setdefault(name, random.choice(sorted(values)))
        second[name] = random.choice(sorted(values - {first[name]}))
        what = f"--{name} {first[name]} and {second[name]}"
    elif change == "harmless":
        name = random.choice(sorted(harmless))
        what = f"--{name}"
        for settings in (first, second):
            if random.random() < 0.7:
                settings[name] = random.choice(harmless[name])
    samples = [int(settings["samples"]) for settings in (first, second)]
    parts = [["--tile", "1/2"], ["--tile", "2/2"]]
    if of["parts"] == "ranges":
        parts = [["--sample-range", f"0-{samples[0] // 2 - 1}"], ["--sample-range", f"{samples[0] // 2}-{samples[1] - 1}"]]
    frame = ["--frames", "12"] if of["frame"] else []

    def render(path, settings, *more):
        arguments = arguments_of(random, settings)
        status, _, messages = program.run("render", "scene.gltf", "-o", path, *small, *frame, *arguments, *more)
        expect(status == 0, f"{arguments}: status {status}: {messages}")

    render("part1.exr", first, *parts[0])
    render("whole.exr", first)
    if change == "scene":
        write_scene(f"{folder}/scene.gltf", [0.5, 0.5, 0.25])
    elif change == "world":
        os.rename(f"{folder}/other.exr", f"{folder}/sky.exr")
    render("part2.exr", second, *parts[1])
    status, _, messages = program.run("merge", "part1.exr", "part2.exr", "-o", "merged.exr")
    if change in ("setting", "scene", "world"):
        expect(status == 1 and "not a part of the same picture" in messages, f"{what}: status {status}: {messages}")
        return
    expect(status == 0, f"{what}: status {status}: {messages}")
    whole, merged = program.read("whole.exr"), program.read("merged.exr")
    error = numpy.abs(merged - whole).max()
    expect(error <= (0 if of["parts"] == "tiles" else 1e-5 * max(whole.max(), 1)), f"{what}: differs by {error}")
