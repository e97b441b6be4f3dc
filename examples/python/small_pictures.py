#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Render many small pictures of many scenes in several processes, which share nothing but the list of scenes.

    small_pictures.py PROCESSES SCENE...

Drivers do not survive a fork, so that processes are started by spawn, and each makes its own device. A device compiles its programs once,
for all scenes.
"""
import multiprocessing
import sys
import time

import gnomon

PICTURES = 50
SIZE_PX = (64, 64)


def render_scenes(names):
    """Draw pictures of each scene while its first lamp moves. Return their number and the sum of all values."""
    device = gnomon.Device()
    count, total = 0, 0.0
    for name in names:
        scene = gnomon.load(name)
        renderer = gnomon.Renderer(device, scene, SIZE_PX, sample_count=1)
        lamp = next(node for node in scene.nodes if node.lamp)
        x, y, z = lamp.position
        for i in range(PICTURES):
            lamp.position = (x + 0.02 * i, y, z)
            total += float(renderer.render().sum())
            count += 1
    return count, total


def main():
    process_count, names = int(sys.argv[1]), sys.argv[2:]
    shares = [names[i::process_count] for i in range(process_count)]
    start = time.perf_counter()
    with multiprocessing.get_context("spawn").Pool(process_count) as pool:
        results = pool.map(render_scenes, shares, chunksize=1)
    count = sum(result[0] for result in results)
    print(f"{count} pictures, {count / (time.perf_counter() - start):.0f} a second with {process_count} processes, their start included")


if __name__ == "__main__":
    main()
