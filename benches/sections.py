#!/usr/bin/env python3
"""Sections beside a sum over triangles that joins nothing, in NumPy.

    python sections.py FOLDER_OR_MESH... [--heights 100]

Each mesh is cut at so many heights along each axis, a fifth of them through vertices (and so
through faces and edges), and along three turned directions. The program beside it places each
vertex by the same rule, above or below the plane, and sums the pieces of the triangles as they
come: their length, and the area by their direction. Where `turned` is above 0, the directions
disagree; then the area is that of the even-odd rule over horizontal slabs.

Prints a line for each mesh that differs by more than 1e-9, and the sums; exits with 1 if one does.
Two differences are only counted. A crack within the rounding to single precision is closed by a
line, which no triangle has. Where the mesh crosses itself, contours cross, and the rule counts
their overlap otherwise than their area does. Needs the wheel and SciPy.
"""
import argparse
import collections
import sys
import warnings
from pathlib import Path

import numpy as np
import sculptd
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

#: The widest crack that is closed, as a part of the largest coordinate.
CRACK = 4 * np.finfo(np.float32).eps
#: The least length that is one, as a part of the mesh's size.
ROUNDING = 1e-12

ENDINGS = {".obj", ".stl", ".ply", ".off", ".glb", ".3mf"}


def lowest(count, triangles, heights):
    """The least height in the shell of each vertex."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]]])
    graph = coo_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count))
    shells = connected_components(graph, directed=False)[1]
    least = np.full(shells.max() + 1, np.inf)
    np.minimum.at(least, shells, heights)
    return least[shells]


def pieces(vertices, triangles, least, height):
    """Starts and ends, in x and y, of what the plane z = height meets."""
    z = vertices[:, 2]
    above = np.where(least == height, z > height, z >= height)
    sides = above[triangles]
    cut = sides.sum(1) % 3 != 0
    corners, sides = triangles[cut], sides[cut]
    ends = np.empty((2, len(corners), 2))
    for k in range(3):
        a, b = corners[:, k], corners[:, (k + 1) % 3]
        for end, goes in ((0, sides[:, k] & ~sides[:, (k + 1) % 3]), (1, ~sides[:, k] & sides[:, (k + 1) % 3])):
            low, high = np.minimum(a, b)[goes], np.maximum(a, b)[goes]
            share = (z[low] - height) / (z[low] - z[high])
            share[z[low] == height] = 0.0
            share[z[high] == height] = 1.0
            ends[end, goes] = vertices[low, :2] + (vertices[high, :2] - vertices[low, :2]) * share[:, None]
    return ends


def even_odd(starts, ends):
    """The area between lines that do not cross, by the even-odd rule."""
    heights = np.unique(np.concatenate([starts[:, 1], ends[:, 1]]))
    area = 0.0
    for low, high in zip(heights, heights[1:]):
        y = (low + high) / 2
        spans = (starts[:, 1] < y) != (ends[:, 1] < y)
        p, q = starts[spans], ends[spans]
        x = np.sort(p[:, 0] + (q[:, 0] - p[:, 0]) * ((y - p[:, 1]) / (q[:, 1] - p[:, 1])))
        area += (high - low) * (x[1::2] - x[::2][: len(x) // 2]).sum()
    return area


def cross(starts, ends):
    """Whether two of the lines go through each other."""

    def side(p, q, x):
        return (q[:, None, 0] - p[:, None, 0]) * (x[None, :, 1] - p[:, None, 1]) - (
            q[:, None, 1] - p[:, None, 1]
        ) * (x[None, :, 0] - p[:, None, 0])

    apart = side(starts, ends, starts) * side(starts, ends, ends)
    return bool(((apart < 0.0) & (apart.T < 0.0)).any())


def frames(rng):
    """Rotations, of which the last row is the direction of the cuts."""
    for axis in range(3):
        yield np.roll(np.eye(3), axis + 1, 0), True
    for _ in range(3):
        q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        yield q * np.sign(np.linalg.det(q)), False


def compare(mesh, planes, counts):
    vertices, triangles = np.asarray(mesh.vertices), np.asarray(mesh.faces).astype(int)
    used, rng = np.unique(triangles), np.random.default_rng(1)
    found = collections.Counter()
    for frame, exact in frames(rng):
        turned = vertices @ frame.T
        z = turned[:, 2]
        least = lowest(len(z), triangles, z)
        low, high = z[used].min(), z[used].max()
        through = planes // 5 if exact else 0
        heights = [*(low + (high - low) * (np.arange(planes - through) + 0.5) / (planes - through))]
        heights += [*rng.choice(np.unique(z[used]), through)]
        middle, size = turned[:, :2].mean(0), np.ptp(turned, axis=0).max()
        for height, ours in zip(heights, sculptd.sections(mesh, list(frame[2]), heights)):
            starts, ends = pieces(turned, triangles, least, height)
            length = np.linalg.norm(ends - starts, axis=1).sum()
            p, q = starts - middle, ends - middle
            area = 0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum()
            counts["planes"] += 1
            closed = not ours["open"]
            counts["closed"] += closed
            counts["through faces, edges, vertices"] += exact and height in z
            if ours["turned"] > 0.0:
                counts["turned"] += 1
                area = even_odd(starts, ends)
            longer = ours["perimeter"] + ours["folded"] - length
            if abs(longer) > 1e-9 * max(1.0, length):
                crack = 0.0 < longer <= 2 * CRACK * np.abs(vertices).max()
                (counts if crack else found)["length, of a crack that is closed" if crack else "length"] += 1
            if closed and abs(ours["area"] - area) > 1e-9 * max(1e-3 * size * size, abs(area)):
                crossing = ours["turned"] > 0.0 and cross(starts, ends)
                (counts if crossing else found)["area of contours that cross" if crossing else "area"] += 1
            if length > ROUNDING * size and not (ours["contours"] or ours["open"] or ours["folded"]):
                found["silently nothing"] += 1
    return found


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("meshes", nargs="+", type=Path)
    arguments.add_argument("--heights", type=int, default=100)
    options = arguments.parse_args()
    warnings.simplefilter("ignore", sculptd.LossWarning)
    files = [f for m in options.meshes for f in (sorted(m.rglob("*")) if m.is_dir() else [m])]
    counts, wrong = collections.Counter(), False
    for file in files:
        if file.suffix.lower() not in ENDINGS:
            continue
        try:
            mesh = sculptd.read(file).triangulated()
        except sculptd.FileFormatError as e:
            print(f"{file.name}: not read: {e.expected}")
            continue
        counts["meshes"] += 1
        if found := compare(mesh, options.heights, counts):
            wrong = True
            print(f"{file.name}: {dict(found)}", flush=True)
    print(dict(counts))
    sys.exit(wrong)


if __name__ == "__main__":
    main()
