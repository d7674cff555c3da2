#!/usr/bin/env python3
"""A Boolean through Python beside the same one by the program, on the same meshes in the same run.

    python python.py path/to/sculptd [--triangles 1000000]

Needs numpy and the module `sculptd`. Two spheres that cross, of that many triangles in all; ours by
`seconds` of `sculptd boolean --json` (from the loaded polygons to the checked result), Python's by
the clock around `sculptd.boolean` from meshes that were made of arrays to the result's arrays. They
take turns, five times each; medians, least, and the ratio. Also shows, by their addresses, that the
arrays are not copied. Exits with 1 where the volumes differ by more than 1e-12.
"""
import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import sculptd

ROUNDS = 5


def sphere(triangles, shift):
    """A closed sphere of rings, about so many triangles."""
    rings = max(8, round((triangles / 4) ** 0.5))
    sides = 2 * rings
    theta = np.pi * np.arange(1, rings) / rings
    phi = 2 * np.pi * np.arange(sides) / sides
    around = np.stack(
        [
            np.sin(theta)[:, None] * np.cos(phi),
            np.sin(theta)[:, None] * np.sin(phi),
            np.repeat(np.cos(theta)[:, None], sides, axis=1),
        ],
        axis=-1,
    ).reshape(-1, 3)
    vertices = np.concatenate([around, [[0, 0, 1], [0, 0, -1]]]) + shift
    faces = []
    here, on = np.arange(sides), (np.arange(sides) + 1) % sides
    for ring in range(rings - 2):
        a, b = ring * sides, (ring + 1) * sides
        faces += [np.stack([a + here, b + here, b + on], 1), np.stack([a + here, b + on, a + on], 1)]
    top, bottom, last = len(around), len(around) + 1, (rings - 2) * sides
    faces.append(np.stack([np.full(sides, top), here, on], 1))
    faces.append(np.stack([np.full(sides, bottom), last + on, last + here], 1))
    return np.ascontiguousarray(vertices), np.ascontiguousarray(np.concatenate(faces).astype(np.uint32))


def address(array):
    return array.__array_interface__["data"][0]


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("program")
    arguments.add_argument("--triangles", type=int, default=1_000_000)
    options = arguments.parse_args()
    pair = [sphere(options.triangles / 2, s) for s in ((0.0, 0.0, 0.0), (0.51, 0.37, 0.23))]
    meshes = [sculptd.Mesh(v, f) for v, f in pair]
    seen = address(meshes[0].vertices)
    assert seen == address(meshes[0].vertices), "an array was copied"
    print(f"{sum(len(f) for _, f in pair)} triangles; vertices seen twice at {seen:#x}: no copy")
    by_program, by_python = [], []
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        files = [folder / "a.ply", folder / "b.ply"]
        for mesh, file in zip(meshes, files):
            mesh.write(str(file))
        command = [options.program, "boolean", "difference", *map(str, files), "-o", str(folder / "out.ply"), "--json"]
        for _ in range(ROUNDS):
            told = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
            by_program.append(told["seconds"])
            begun = time.perf_counter()
            made = sculptd.boolean(*meshes, "difference")
            arrays = made.mesh.vertices, made.mesh.triangulated().faces
            by_python.append(time.perf_counter() - begun)
    volumes = made.volume, told["results"][0]["volume"]
    print(f"program {statistics.median(by_program):.3f} s (least {min(by_program):.3f})")
    print(f"Python  {statistics.median(by_python):.3f} s (least {min(by_python):.3f})")
    print(f"ratio of medians {statistics.median(by_python) / statistics.median(by_program):.3f}, of the least"
          f" {min(by_python) / min(by_program):.3f}; {len(arrays[1])} triangles, volume {volumes[0]!r}")
    sys.exit(abs(volumes[0] - volumes[1]) > 1e-12 * max(1.0, abs(volumes[0])))


if __name__ == "__main__":
    main()
