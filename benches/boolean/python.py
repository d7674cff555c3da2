#!/usr/bin/env python3
"""A Boolean through Python beside the same one by the Rust library, on the same meshes in one run.

    cargo build --release --example library
    python python.py target/release/examples/library [--triangles 1000000] [--rounds 15]

Needs numpy and the module `sculptd`. Two spheres that cross, of that many triangles in all. Both
processes hold the loaded meshes and take turns: each time is from there to the checked result in
triangles. Medians, least, and the ratio. Also shows, by their addresses, that the arrays are not
copied. Exits with 1 where the volumes differ by more than 1e-12.
"""
import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import sculptd


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
    arguments.add_argument("library")
    arguments.add_argument("--triangles", type=int, default=1_000_000)
    arguments.add_argument("--rounds", type=int, default=15)
    options = arguments.parse_args()
    pair = [sphere(options.triangles / 2, s) for s in ((0.0, 0.0, 0.0), (0.51, 0.37, 0.23))]
    meshes = [sculptd.Mesh(v, f) for v, f in pair]
    seen = address(meshes[0].vertices)
    assert seen == address(meshes[0].vertices), "an array was copied"
    print(f"{sum(len(f) for _, f in pair)} triangles; vertices seen twice at {seen:#x}: no copy")
    by_library, by_python = [], []
    with tempfile.TemporaryDirectory() as folder:
        files = [str(Path(folder) / name) for name in ("a.ply", "b.ply")]
        for mesh, file in zip(meshes, files):
            mesh.write(file)
        library = subprocess.Popen([options.library, *files], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for turn in range(options.rounds + 1):
            library.stdin.write("\n")
            library.stdin.flush()
            seconds, triangles, volume = library.stdout.readline().split()
            begun = time.perf_counter()
            made = sculptd.boolean(*meshes, "difference")
            arrays = made.mesh.vertices, made.mesh.triangulated().faces
            took = time.perf_counter() - begun
            if turn > 0:  # The first turn warms both.
                by_library.append(float(seconds))
                by_python.append(took)
        library.stdin.close()
        library.wait()
    ratios = sorted(p / r for p, r in zip(by_python, by_library))
    print(f"library {statistics.median(by_library):.3f} s (least {min(by_library):.3f})")
    print(f"Python  {statistics.median(by_python):.3f} s (least {min(by_python):.3f})")
    print(f"Python / library: median of {len(ratios)} pairs {statistics.median(ratios):.3f}, of the least"
          f" {min(by_python) / min(by_library):.3f}; {len(arrays[1])} and {triangles} triangles, volume {made.volume!r}")
    sys.exit(abs(made.volume - float(volume)) > 1e-12 * max(1.0, abs(made.volume)))


if __name__ == "__main__":
    main()
