#!/usr/bin/env python3
"""Rays a second, side by side: this program's tree and Embree's (PyPI `embreex`, or Open3D), same rays, same run.

    python3 benches/thickness/rates.py RATES_BINARY MESH.ply...

RATES_BINARY is the example `rays` (cargo build --release --no-default-features --example rays). It writes the rays of a
cone at every vertex to a file, casts them on one thread, and prints its rate; this script casts the same rays with Embree
on one thread. Medians of five, alternating, so that a busy machine is busy for both.
"""
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")
import numpy as np
from embreex import rtcore_scene as rtcs
from embreex.mesh_construction import TriangleMesh


def embree(vertices, triangles, origins, directions):
    """CPU seconds of one closest-hit pass and the number of hits."""
    scene = embree.cache.get(id(vertices))
    if scene is None:
        scene = rtcs.EmbreeScene()
        TriangleMesh(scene, vertices[triangles].astype(np.float32))
        embree.cache[id(vertices)] = scene
        scene.run(origins[:1], directions[:1])
    start = time.process_time()
    hits = scene.run(origins, directions)
    return time.process_time() - start, int((hits >= 0).sum())


embree.cache = {}


def main():
    binary, meshes = sys.argv[1], sys.argv[2:]
    for mesh in meshes:
        with tempfile.TemporaryDirectory() as folder:
            run = lambda: json.loads(subprocess.check_output([binary, mesh, folder]))
            ours = [run()]
            load = lambda name, kind: np.fromfile(os.path.join(folder, name), kind).reshape(-1, 3)
            vertices, triangles = load("vertices", np.float32), load("triangles", np.uint32)
            origins, directions = load("origins", np.float32), load("directions", np.float32)
            theirs = []
            for _ in range(5):
                theirs.append(embree(vertices, triangles, origins, directions))
                ours.append(run())
            ours = ours[1:]
            rays = len(origins)
            a = statistics.median(rays / o["seconds"] for o in ours)
            b = statistics.median(rays / t[0] for t in theirs)
            print(f"{os.path.basename(mesh)}: {len(triangles)} triangles, {rays} rays; ours {a/1e6:.2f}, Embree {b/1e6:.2f} "
                  f"million rays a CPU second: ratio {a/b:.3f}; hits {ours[0]['hits']} / {theirs[0][1]}")


main()
