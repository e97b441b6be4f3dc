# SPDX-License-Identifier: MIT
"""Closed bodies among the triangles of a mesh."""

import numpy


# A thickness without an end, metres: behind an open surface, the medium goes on to the next surface.
ENDLESS = 1e6


def thickness(positions, triangles):
    """The thickness of the medium behind some triangles: that of a closed body, ENDLESS behind an open surface, and 0 in a plane.

    Cycles refracts light at each surface. A pane is a thin wall all the same: its light goes straight on, and so does that of a lamp.
    """
    chord = mean_chord(positions, triangles)
    if chord is not None or len(triangles) == 0:
        return chord or 0.0
    points = numpy.asarray(positions, numpy.float64)[numpy.unique(triangles)]
    spread = numpy.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return ENDLESS if len(spread) > 2 and spread[2] > 1e-4 * spread[0] else 0.0


def mean_chord(positions, triangles):
    """The mean length of the straight ways through a closed body, 4 · volume / surface (Cauchy), in the positions' unit.

    positions: n x 3; triangles: m x 3 indices. None if an edge does not have two triangles, or if the volume is 0.
    Vertices at the same place count as one, and triangles without area do not count.
    """
    if len(triangles) == 0:
        return None
    positions = numpy.asarray(positions, numpy.float64)
    scale = numpy.abs(positions - positions.mean(axis=0)).max()
    if not scale > 0:
        return None
    # Floats of a place that was computed twice differ in their last digits.
    _, place = numpy.unique(numpy.round((positions - positions.mean(axis=0)) / scale * 1e5), axis=0, return_inverse=True)
    corners = place.reshape(-1)[numpy.asarray(triangles, numpy.int64)]
    a, b, c = corners.T
    used = (a != b) & (b != c) & (c != a)
    corners, triangles = corners[used], numpy.asarray(triangles)[used]
    edges = numpy.sort(numpy.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), axis=1)
    _, counts = numpy.unique(edges, axis=0, return_counts=True)
    if len(counts) == 0 or (counts != 2).any():
        return None
    p, q, r = (positions[triangles[:, i]] - positions.mean(axis=0) for i in range(3))
    cross = numpy.cross(q - p, r - p)
    area = 0.5 * numpy.linalg.norm(cross, axis=1).sum()
    volume = abs(numpy.einsum("ij,ij->", p, cross)) / 6
    return 4 * volume / area if volume > 1e-9 * scale**3 else None
