# SPDX-License-Identifier: MIT
"""An output has one content, wherever its path leads, and is refused where it would replace what is read or written beside it."""
import json
import os
import stat
import threading

import numpy

from variants import expect, quad_scene, write_picture

VALUES = {
    "output": ["exr", "png", "part", "layers", "json", "trace", "difference", "merge", "report of compare"],
    "place": ["new", "old", "read-only", "link", "link to nothing", "two links", "folder", "FIFO", "link to a FIFO", "/dev/null", "/dev/full",
              "descriptor"],
    "other": [None, None, None, "scene", "buffer", "world", "picture", "output"],
    "spelling": ["plain", "./", "whole", "folder", "link", "hard link"],
}
NULL_DEVICE = ("/dev/null", "/dev/full")


def command_of(output, path):
    """The command that writes it, and the end of a name that it has."""
    render = ["render", "scene.gltf", "--size", "8x8", "--samples", "2", "--world", "sky.exr"]
    return {
        "exr": render + ["-o", path],
        "png": render + ["-o", path],
        "part": render + ["-o", path, "--tile", "1/2"],
        "layers": render + ["-o", path, "--aov", "depth"],
        "json": render + ["-o", "beside.exr", "--json", path],
        "trace": render + ["-o", "beside.exr", "--trace", path],
        "difference": ["compare", "a.exr", "b.exr", "--difference", path],
        "report of compare": ["compare", "a.exr", "b.exr", "--json", path],
        "merge": ["merge", "part1.exr", "part2.exr", "-o", path],
    }[output]


def content_of(output, data):
    """What is the same each time."""
    if output == "trace":
        return sorted({event["name"] for event in json.loads(data)["traceEvents"] if "name" in event} & {"write picture"})
    if output in ("json", "report of compare"):
        return sorted(json.loads(data))
    return data


def prepare(program, output):
    gltf = quad_scene(pbrMetallicRoughness={"baseColorFactor": [0.2, 0.5, 0.8, 1]})
    gltf.write_form(f"{program.folder}/scene", "buffer beside")
    for name, color in (("sky", (1, 1, 1)), ("a", (1, 2, 3)), ("b", (3, 2, 1))):
        write_picture(f"{program.folder}/{name}.exr", numpy.full((8, 8, 3), color))
    for i in (1, 2) if output == "merge" else ():
        status, _, messages = program.run("render", "scene.gltf", "-o", f"part{i}.exr", "--tile", f"{i}/2", "--size", "8x8", "--samples", "1")
        expect(status == 0, messages)


def files_of(folder):
    files = {}
    for name in sorted(os.listdir(folder)):
        path = os.path.join(folder, name)
        mode = os.lstat(path).st_mode
        files[name] = (stat.S_IFMT(mode), open(path, "rb").read() if stat.S_ISREG(mode) else None)
    return files


def respelt(folder, name, spelling):
    """Another name of the file, and whether a new name of it was made."""
    if spelling == "./":
        return "./" + name
    if spelling == "whole":
        return os.path.join(folder, name)
    if spelling == "folder":
        return f"inner/../{name}"
    if spelling == "plain":
        return name
    link = f"again{os.path.splitext(name)[1]}"
    if spelling == "hard link" and os.path.exists(os.path.join(folder, name)):
        os.link(os.path.join(folder, name), os.path.join(folder, link))
    else:
        os.symlink(name, os.path.join(folder, link))
    return link


def check_refused(program, of):
    """The output is an input or another output of its command."""
    output = of["output"]
    folder = program.folder
    os.mkdir(f"{folder}/inner")
    reads = {"difference": ["a.exr", "b.exr"], "report of compare": ["a.exr", "b.exr"], "merge": ["part1.exr", "part2.exr"]}
    if output in reads:
        name = reads[output][len(of["spelling"]) % 2]
    else:
        name = {"scene": "scene.gltf", "buffer": "scene.bin", "world": "sky.exr", "picture": "sky.exr", "output": "beside.exr"}[of["other"]]
    end = ".png" if output == "png" else ".json" if output in ("json", "trace", "report of compare") else ".exr"
    path = respelt(folder, name, of["spelling"])
    if os.path.splitext(path)[1] != end and end != ".json":
        # Such a name is only possible by a link.
        path = "named" + end
        os.symlink(name, os.path.join(folder, path))
    command = command_of(output, path)
    if name == "beside.exr" and output in ("exr", "png", "part", "layers"):
        command += ["--json", "beside.exr"]
    before = files_of(folder)
    status, _, messages = program.run(*command)
    expect(status == 2, f"{command}: status {status}: {messages}")
    expect("would replace" in messages or "is the same file as" in messages, messages)
    expect(files_of(folder) == before, f"{command}: files were changed")


def check(program, random, of):
    output, place, folder = of["output"], of["place"], program.folder
    prepare(program, output)
    if of["other"]:
        check_refused(program, of)
        return
    end = ".png" if output == "png" else ".json" if output in ("json", "trace", "report of compare") else ".exr"
    status, _, messages = program.run(*command_of(output, "right" + end))
    expect(status == 0, messages)
    with open(f"{folder}/right{end}", "rb") as file:
        right = content_of(output, file.read())
    name = "named" + end
    path = f"{folder}/{name}"
    target = None
    if place in ("old", "read-only", "link", "two links"):
        target = path if place in ("old", "read-only") else f"{folder}/target"
        with open(target, "wb") as file:
            file.write(b"old" * 10000)
        os.chmod(target, 0o440 if place == "read-only" else 0o640)
    if place in ("link", "link to nothing"):
        target = f"{folder}/target"
        os.symlink("target", path)
    elif place == "two links":
        os.mkdir(f"{folder}/inner")
        os.symlink("../target", f"{folder}/inner/second")
        os.symlink("inner/second", path)
    elif place == "folder":
        os.mkdir(f"{folder}/inner")
        os.symlink("inner", f"{folder}/linked")
        name = "linked/./" + name
        target = f"{folder}/inner/named{end}"
    elif place in ("FIFO", "link to a FIFO"):
        fifo = path if place == "FIFO" else f"{folder}/fifo"
        os.mkfifo(fifo)
        if place != "FIFO":
            os.symlink("fifo", path)
    elif place in NULL_DEVICE:
        os.symlink(place, path)
    elif place == "descriptor":
        os.symlink("/dev/stdout", path)
    elif target is None:
        target = path
    links = {at: os.readlink(f"{folder}/{at}") for at in os.listdir(folder) if os.path.islink(f"{folder}/{at}")}
    read = []
    if "FIFO" in place:
        def read_fifo():
            with open(fifo, "rb") as file:
                read.append(file.read())
        reader = threading.Thread(target=read_fifo, daemon=True)
        reader.start()
    status, out, messages = program.run(*command_of(output, name))
    if "FIFO" in place:
        reader.join(10)
        expect(read, f"status {status}, and the reader of the pipe waits: {messages}")
        data = read[0]
    expect(status == (5 if place == "/dev/full" else 0), f"status {status}: {messages}")
    for at, to in links.items():
        expect(os.path.islink(f"{folder}/{at}") and os.readlink(f"{folder}/{at}") == to, f"{at} is no link to {to}")
    if place == "/dev/full":
        expect(name in messages and "No space left on device" in messages, messages)
    if place in NULL_DEVICE:
        expect(stat.S_ISCHR(os.stat(path).st_mode), "the device is gone")
        return
    if place == "descriptor":
        # The lines of the command stand beside it.
        return expect(right in out if isinstance(right, bytes) else b"{" in out, "the content is not in standard output")
    if "FIFO" in place:
        expect(stat.S_ISFIFO(os.stat(fifo).st_mode), "the pipe is gone")
    else:
        expect(stat.S_ISREG(os.lstat(target).st_mode), f"{target} is no regular file")
        if place in ("old", "link", "two links"):
            expect(stat.S_IMODE(os.stat(target).st_mode) == 0o640, "its permissions are other ones")
        with open(target, "rb") as file:
            data = file.read()
    expect(content_of(output, data) == right, "the content differs")
    left = [at for at in os.listdir(folder) if at.startswith(".") or "tmp" in at]
    expect(not left, f"left: {left}")
