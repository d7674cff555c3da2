#!/usr/bin/env python3
"""Voxel remeshing and decimation of files: self-intersections, distance from the old surface, and time.

    python corpus.py remesh path/to/sculptd [--side 128] MESH...
    python corpus.py decimate path/to/sculptd MESH...
    python corpus.py million path/to/sculptd [--side 410] [--runs 5] MESH

`remesh`: every mesh with and without `--sharp`. `crossings`: `sculptd info` of the written file; `far`: the greatest distance of the
new mesh's vertices and face centres from the old surface; `back`: of the old one's from the new surface, where the old mesh is closed
and does not cross itself (else some of it lies inside the new one and is rightly gone). Both in voxels: what is thinner than a voxel
vanishes, and `back` tells it.

`decimate`: each mesh, welded, to half and to a tenth of its triangles. `old` and `new`: pairs of triangles that cross before and after.

`million`: seconds of one mesh, wall and processor, with reading and writing; choose the side so that about a million faces come out.
"""
import argparse
import json
import resource
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

LIMIT = 300


def ask(binary, *words):
    try:
        done = subprocess.run([binary, "--json", *map(str, words)], capture_output=True, text=True, timeout=LIMIT)
    except subprocess.TimeoutExpired:
        raise RuntimeError(f"more than {LIMIT} seconds")
    if done.returncode:
        raise RuntimeError(done.stderr.strip()[-120:] or f"ended with {done.returncode}")
    return json.loads(done.stdout)


def read(path):
    """Vertices and triangles of an OBJ file that this program wrote."""
    vertices, faces = [], []
    for line in open(path):
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(w) for w in words[1:4]])
        elif words[:1] == ["f"]:
            faces.append([int(w.split("/")[0]) - 1 for w in words[1:4]])
    return np.array(vertices), np.array(faces)


def far(binary, folder, mesh, of):
    """The greatest distance of a mesh's vertices and face centres from another."""
    vertices, faces = of
    points = np.vstack([vertices, vertices[faces].mean(axis=1)])
    np.savetxt(folder / "points.txt", points, fmt="%.9g")
    found = ask(binary, "distance", mesh, "--points", folder / "points.txt", "--sign", "pseudonormal")
    return float(np.abs(found["distances"]).max())


def used():
    r = resource.getrusage(resource.RUSAGE_CHILDREN)
    return r.ru_utime + r.ru_stime


def row(cells):
    print("| " + " | ".join(f"{c:.2f}" if isinstance(c, float) else str(c) for c in cells) + " |", flush=True)


def head(cells):
    row(cells)
    row(["---"] * len(cells))


def remesh(o, folder):
    head(["mesh", "kind", "faces", "closed", "crossings", "far", "back", "wall s", "processor s"])
    sums = {}
    for mesh in o.meshes:
        source = folder / "source.obj"
        try:
            ask(o.binary, "convert", mesh, source, "--triangulate", "--weld", 0)
            old, info = read(source), ask(o.binary, "info", source)
        except RuntimeError as e:
            row([mesh.stem, str(e)])
            continue
        sound = info["closed"] and info["manifold"] and not info["self_intersections"]
        voxel = (old[0].max(axis=0) - old[0].min(axis=0)).max() / o.side
        for kind in ("smooth", "sharp"):
            made = folder / "made.obj"
            try:
                before, begun = used(), time.perf_counter()
                words = ["--sharp"] if kind == "sharp" else []
                ask(o.binary, "remesh", source, "--side", o.side, *words, "-o", made)
                wall, processor = time.perf_counter() - begun, used() - before
                new = read(made)
                there = far(o.binary, folder, source, new) / voxel
                back = far(o.binary, folder, made, old) / voxel if sound else float("nan")
                found = ask(o.binary, "info", made)
            except RuntimeError as e:
                row([mesh.stem, kind, str(e)])
                continue
            whole = found["closed"] and found["manifold"] and found["oriented"]
            crossings = found["self_intersections"]
            row([mesh.stem, kind, len(new[1]), "yes" if whole else "no", crossings, there, back, wall, processor])
            sums.setdefault(kind, []).append((whole, crossings, there, back))
    for kind, rows in sums.items():
        wholes, crossings, there, back = zip(*rows)
        back = [b for b in back if b == b]
        print(
            f"{kind}: {len(rows)} meshes, {sum(wholes)} closed, {sum(c == 0 for c in crossings)} without a crossing"
            f" ({sum(crossings)} in all), far {max(there):.2f} voxels at most, {sum(f >= 1 for f in there)} of a voxel or more;"
            f" back {max(back, default=0):.2f} at most, {sum(b >= 1 for b in back)} of {len(back)} of a voxel or more"
        )


def decimate(o, folder):
    head(["mesh", "kept", "triangles", "old", "new", "wall s"])
    worse = runs = 0
    for mesh in o.meshes:
        source, made = folder / "source.obj", folder / "made.obj"
        try:
            ask(o.binary, "convert", mesh, source, "--triangulate", "--weld", 0)
            info = ask(o.binary, "info", source)
            for kept in (50, 10):
                begun = time.perf_counter()
                ask(o.binary, "decimate", source, "--faces", max(4, info["triangles"] * kept // 100), "-o", made)
                wall = time.perf_counter() - begun
                new = ask(o.binary, "info", made)
                runs += 1
                worse += new["self_intersections"] > info["self_intersections"]
                row([mesh.stem, f"{kept} %", new["triangles"], info["self_intersections"], new["self_intersections"], wall])
        except RuntimeError as e:
            row([mesh.stem, str(e)])
    print(f"{worse} of {runs} runs left more crossings than there were")


def million(o, folder):
    for kind in ("smooth", "sharp"):
        walls, processors = [], []
        for _ in range(o.runs):
            before, begun = used(), time.perf_counter()
            words = ["--sharp"] if kind == "sharp" else []
            made = ask(o.binary, "remesh", o.meshes[0], "--side", o.side, *words, "-o", folder / "made.ply")
            walls.append(made["seconds"])
            processors.append(used() - before)
            last = time.perf_counter() - begun
        print(
            f"{kind}: {made['triangles']} triangles; remeshing {statistics.median(walls):.2f} s (median of {o.runs}, {min(walls):.2f}"
            f" to {max(walls):.2f}); processor with files {statistics.median(processors):.2f} s; last run with files {last:.2f} s"
        )


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("what", choices=["remesh", "decimate", "million"])
    options.add_argument("binary")
    options.add_argument("meshes", nargs="+", type=Path)
    options.add_argument("--side", type=int)
    options.add_argument("--runs", type=int, default=5)
    o = options.parse_args()
    o.side = o.side or {"million": 410}.get(o.what, 128)
    with tempfile.TemporaryDirectory() as folder:
        {"remesh": remesh, "decimate": decimate, "million": million}[o.what](o, Path(folder))


if __name__ == "__main__":
    main()
