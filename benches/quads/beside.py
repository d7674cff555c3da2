#!/usr/bin/env python3
"""Quad remeshing of files beside Instant Meshes and QuadriFlow (PyPI: pyinstantmeshes, pyQuadriFlow), on the same meshes.

    python beside.py path/to/sculptd [--quads 5000] [--creases DEGREES] [--ours] MESH...

Every mesh is welded and cut into triangles first, the same for all three. Instant Meshes runs with and without `pure_quad`
(its subdivision into quads alone, asked for a quarter of the faces), QuadriFlow with its minimum-cost flow; each in a process of its
own that is ended after two minutes. A missing peer is left out. `quads`: share of faces with four corners; `closed`, `manifold`,
`crossings`: `sculptd info` of the written file; `regular`: vertices with four faces (border vertices with two); `off 90`: mean
difference of the quads' angles from 90 degrees; `far`: the greatest distance of the new mesh's vertices and face centres from the
old mesh, and of the old one's from the new, in thousandths of the box's diagonal. Seconds are wall time of the remeshing alone for
`sculptd`, with reading and writing for the peers.
"""
import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy as np

LIMIT = 120


def read(path):
    """Vertices and faces of an OBJ file."""
    vertices, faces = [], []
    for line in open(path):
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(w) for w in words[1:4]])
        elif words[:1] == ["f"]:
            faces.append([int(w.split("/")[0]) - 1 for w in words[1:]])
    return np.array(vertices), faces


def write(path, vertices, faces):
    with open(path, "w") as out:
        out.writelines("v {!r} {!r} {!r}\n".format(*map(float, v)) for v in vertices)
        for face in faces:
            # A triangle comes as a quad that repeats a corner.
            corners = [c for i, c in enumerate(face) if c != face[i - 1]]
            if len(corners) > 2:
                out.write("f " + " ".join(str(c + 1) for c in corners) + "\n")


def peer(name, source, out, quads, creases):
    """Runs in a process of its own; prints the seconds."""
    start = time.perf_counter()
    if name.startswith("instant"):
        import pyinstantmeshes

        pure = name.endswith("pure")
        pyinstantmeshes.remesh_file(
            source,
            out,
            target_face_count=quads // 4 if pure else quads,
            crease_angle=creases or -1.0,
            extrinsic=True,
            align_to_boundaries=True,
            pure_quad=pure,
            deterministic=True,
        )
    else:
        from pyQuadriFlow.pyQuadriFlow import pyquadriflow

        vertices, faces = read(source)
        made = pyquadriflow(quads, 0, vertices.tolist(), faces, bool(creases), True, False, False, True)
        write(out, made["vertices"], made["faces"])
    print("seconds", time.perf_counter() - start)


def ask(binary, *words):
    done = subprocess.run([binary, "--json", *map(str, words)], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stderr.strip()[-200:])
    return json.loads(done.stdout)


def far(binary, folder, mesh, vertices, faces):
    """The greatest distance of the vertices and face centres of one mesh from a mesh file."""
    points = np.vstack([vertices, [vertices[f].mean(axis=0) for f in faces]])
    (folder / "points.txt").write_text("\n".join("{!r} {!r} {!r}".format(*map(float, p)) for p in points))
    found = ask(binary, "distance", mesh, "--points", folder / "points.txt")["distances"]
    return max(map(abs, found))


def row(binary, folder, source, made, seconds):
    old, new = read(source), read(made)
    vertices, faces = new
    sizes = Counter(map(len, faces))
    corners, edges = Counter(), Counter()
    for face in faces:
        corners.update(face)
        edges.update((min(a, b), max(a, b)) for a, b in zip(face, face[1:] + face[:1]))
    border = {v for edge, n in edges.items() if n == 1 for v in edge}
    regular = sum(n == (2 if v in border else 4) for v, n in corners.items()) / len(corners)
    angles = []
    quads = np.array([f for f in faces if len(f) == 4])
    for k in range(4):
        at, to, back = (vertices[quads[:, (k + i) % 4]] for i in (0, 1, 3))
        u, v = to - at, back - at
        angles.append(np.degrees(np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), (u * v).sum(axis=1))))
    angles = np.concatenate(angles)
    diagonal = np.linalg.norm(old[0].max(axis=0) - old[0].min(axis=0))
    info = ask(binary, "info", made)
    return {
        "faces": len(faces),
        "quads": 100 * sizes[4] / len(faces),
        "closed": info["closed"],
        "manifold": info["manifold"],
        "crossings": info["self_intersections"],
        "regular": 100 * regular,
        "least": angles.min(),
        "off 90": np.abs(angles - 90).mean(),
        "far": 1000 * far(binary, folder, source, *new) / diagonal,
        "and back": 1000 * far(binary, folder, made, *old) / diagonal,
        "s": seconds,
    }


def show(name, r):
    cells = [f"{v:.2f}" if isinstance(v, float) else {True: "yes", False: "no"}.get(v, v) if isinstance(v, bool) else str(v) for v in r.values()]
    print(f"| {name} | " + " | ".join(cells) + " |", flush=True)


def main():
    if sys.argv[1:2] == ["--peer"]:
        name, source, out, quads, creases = sys.argv[2:]
        return peer(name, source, out, int(quads), float(creases))
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("binary")
    options.add_argument("meshes", nargs="+", type=Path)
    options.add_argument("--quads", type=int, default=5000)
    options.add_argument("--creases", type=float, default=0.0)
    options.add_argument("--ours", action="store_true", help="leave the peers out")
    o = options.parse_args()
    all_rows = {}
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for mesh in o.meshes:
            source = folder / "source.obj"
            ask(o.binary, "convert", mesh, source, "--triangulate", "--weld", 0)
            for name in ["sculptd"] + ([] if o.ours else ["instant", "instant pure", "quadriflow"]):
                made = folder / (name.replace(" ", "_") + ".obj")
                try:
                    if name == "sculptd":
                        creases = ["--creases", o.creases] if o.creases else []
                        seconds = ask(o.binary, "remesh", source, "--quads", o.quads, *creases, "-o", made)["seconds"]
                    else:
                        words = [sys.executable, __file__, "--peer", name, source, made, o.quads, o.creases]
                        done = subprocess.run([str(w) for w in words], capture_output=True, text=True, timeout=LIMIT)
                        if done.returncode:
                            raise RuntimeError((done.stderr.strip() or f"ended with {done.returncode}").splitlines()[-1][-120:])
                        seconds = float(done.stdout.split("seconds")[-1])
                    r = row(o.binary, folder, source, made, seconds)
                except (RuntimeError, subprocess.TimeoutExpired, ValueError, IndexError) as e:
                    print(f"| {mesh.stem}: {name} | {e} |", flush=True)
                    continue
                if not all_rows:
                    print("| mesh: program | " + " | ".join(r) + " |")
                    print("|---" * (len(r) + 1) + "|")
                all_rows.setdefault(name, []).append(r)
                show(f"{mesh.stem}: {name}", r)
    for name, rows in all_rows.items():
        numbers = {k: float(np.mean([float(r[k]) for r in rows])) for k in rows[0]}
        show(f"mean of {len(rows)}: {name}", numbers)


if __name__ == "__main__":
    main()
