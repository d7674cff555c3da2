"""Processor time of every command on every mesh of a folder, beside a clean mesh of the same size.

    python benches/cliffs.py path/to/sculptd FOLDER... [--only COMMAND,...] [--most FACES] [--limit SECONDS] [--report RATIO]

The clean mesh is a ball, at eight sizes; between them its time is interpolated over the logarithm of its triangles. A
box of twelve triangles, which gets places to measure at, is the least that a clean mesh of any size is taken to need. A
ratio counts `FLOOR` seconds more on both sides, so that the start of a process is not a ratio. A command that ends with an error is
listed and has no ratio. Prints each command and mesh above the ratio, the largest first, and exits with 1 where there is
one. Needs Python alone.
"""
import argparse
import json
import math
import os
import resource
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

FLOOR = 0.02
KINDS = (".obj", ".off", ".stl", ".ply")

COMMANDS = {
    "info": ["info", "M"],
    "convert": ["convert", "M", "O.ply"],
    "triangulate": ["convert", "M", "O.stl", "--triangulate"],
    "mend": ["convert", "M", "O.ply", "--mend"],
    "measure": ["measure", "M"],
    "thickness": ["thickness", "M"],
    "spheres": ["thickness", "M", "--method", "sphere"],
    "project": ["project", "M"],
    "project-x": ["project", "M", "--direction", "1,0,0"],
    "project-oblique": ["project", "M", "--direction", "1,2,3"],
    "distance": ["distance", "M", "--grid", "48"],
    "decimate": ["decimate", "M", "-o", "O.ply", "--faces", "H"],
    "subdivide": ["subdivide", "M", "-o", "O.ply"],
    "remesh": ["remesh", "M", "-o", "O.ply", "--side", "64"],
    "hollow": ["hollow", "M", "-o", "O.ply", "--wall", "W", "--side", "96"],
    "offset": ["offset", "M", "-o", "O.ply", "--distance", "W", "--side", "96"],
    "difference": ["boolean", "difference", "M", "S", "-o", "O.ply"],
    "intersection": ["boolean", "intersection", "M", "S", "-o", "O.ply"],
}


def ball(path, rings, centre=(0.0, 0.0, 0.0), radius=50.0):
    """A ball of about `4 rings * rings` triangles, as binary PLY."""
    around = 2 * rings
    points = [(0.0, 0.0, radius)]
    for i in range(1, rings):
        a = math.pi * i / rings
        for j in range(around):
            b = 2 * math.pi * (j + 0.5 * (i % 2)) / around
            points.append((radius * math.sin(a) * math.cos(b), radius * math.sin(a) * math.sin(b), radius * math.cos(a)))
    points.append((0.0, 0.0, -radius))
    at = lambda i, j: 1 + (i - 1) * around + j % around
    faces = []
    for j in range(around):
        faces.append((0, at(1, j), at(1, j + 1)))
        faces.append((len(points) - 1, at(rings - 1, j + 1), at(rings - 1, j)))
    for i in range(1, rings - 1):
        for j in range(around):
            k = j + (i % 2)
            a, b, c, d = at(i, j), at(i, j + 1), at(i + 1, k), at(i + 1, k - 1)
            faces += [(a, d, c), (a, c, b)]
    with open(path, "wb") as out:
        out.write(
            f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty double x\nproperty double y\n"
            f"property double z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n".encode()
        )
        for p in points:
            out.write(struct.pack("<3d", *(x + c for x, c in zip(p, centre))))
        for f in faces:
            out.write(struct.pack("<B3i", 3, *f))
    return len(faces)


def cube(path):
    """A box of twelve triangles, as OFF."""
    points = [(x, y, z) for z in (0, 40) for y in (0, 30) for x in (0, 50)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    faces = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    rows = [" ".join(map(str, p)) for p in points] + ["3 " + " ".join(map(str, f)) for f in faces]
    path.write_text(f"OFF\n8 {len(faces)} 0\n" + "\n".join(rows) + "\n")


def timed(binary, words, limit):
    """Exit code, seconds of processor time, standard output, and the last line of standard error."""

    def bounded():
        resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 1))

    child = subprocess.Popen([binary, *words, "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=bounded)
    out, err = child.communicate()
    return child.returncode, out, (err.strip().splitlines() or [""])[-1]


def seconds(binary, words, limit):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    code, out, err = timed(binary, words, limit)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return code, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, out, err


def words(name, mesh, shifted, wall, half, folder):
    swap = {"M": str(mesh), "S": str(shifted), "W": repr(wall), "H": str(half)}
    return [swap.get(w, str(folder / w) if w.startswith("O.") else w) for w in COMMANDS[name]]


def shift(binary, mesh, folder, name):
    """The mesh moved by 1e-10 of its size, as OFF: where two surfaces nearly coincide everywhere."""
    plain = folder / f"{name}.off"
    code, _, _ = timed(binary, ["convert", str(mesh), str(plain), "--triangulate"], 60)
    if code:
        return None
    lines = plain.read_text().split("\n")
    count = int(lines[1].split()[0])
    points = [[float(x) for x in line.split()[:3]] for line in lines[2 : 2 + count]]
    finite = [abs(x) for p in points for x in p if math.isfinite(x)]
    by = max(finite, default=1.0) * 1e-10
    lines[2 : 2 + count] = [" ".join(repr(x + by * k) for x, k in zip(p, (0.48, 0.6, 0.64))) for p in points]
    moved = folder / f"{name}.off"
    moved.write_text("\n".join(lines))
    return moved


def facts(binary, mesh):
    code, out, _ = timed(binary, ["info", str(mesh)], 120)
    if code:
        return 0, 1.0
    said = json.loads(out)
    lo, hi = said["bounds"]["min"], said["bounds"]["max"]
    size = max((b - a for a, b in zip(lo, hi)), default=1.0)
    return said["triangles"], size


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binary")
    parser.add_argument("folders", nargs="+")
    parser.add_argument("--only", default="")
    parser.add_argument("--most", type=int, default=60_000)
    parser.add_argument("--limit", type=int, default=60)
    parser.add_argument("--report", type=float, default=5.0)
    parser.add_argument("--meshes", default="", help="only meshes whose name holds one of these")
    args = parser.parse_args()
    names = [n for n in COMMANDS if not args.only or n in args.only.split(",")]
    found, failed, runs = [], [], 0
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        clean = {n: [] for n in names}
        plain, moved = folder / "box.off", folder / "box-moved.off"
        cube(plain)
        moved = shift(args.binary, plain, folder, "box-moved")
        least = {n: seconds(args.binary, words(n, plain, moved, 0.5, 6, folder), args.limit)[1] for n in names}
        for rings in (4, 8, 16, 32, 64, 128, 192, 256):
            mesh = folder / "clean.ply"
            count = ball(mesh, rings)
            if count > 2 * args.most:
                break
            moved = shift(args.binary, mesh, folder, "clean-moved")
            for name in names:
                code, took, _, err = seconds(args.binary, words(name, mesh, moved, 1.0, count // 2, folder), args.limit)
                if code not in (0, 1):
                    print(f"clean {name} {count}: {code} {err}")
                clean[name].append((math.log(count), took))

        def expected(name, count):
            return max(least[name], by_balls(name, count))

        def by_balls(name, count):
            table = clean[name]
            x = math.log(max(count, 1))
            for (a, s), (b, t) in zip(table, table[1:]):
                if x <= b:
                    w = min(max((x - a) / (b - a), 0.0), 1.0)
                    return s + (t - s) * w
            return table[-1][1] * max(count, 1) / math.exp(table[-1][0])

        files = [f for one in args.folders for f in sorted(Path(one).iterdir()) if f.suffix.lower() in KINDS]
        wanted = [w for w in args.meshes.split(",") if w]
        for file in files:
            if wanted and not any(w in file.name for w in wanted):
                continue
            count, size = facts(args.binary, file)
            if not count or count > args.most:
                continue
            moved = shift(args.binary, file, folder, "moved") if {"difference", "intersection"} & set(names) else file
            for name in names:
                if moved is None:
                    continue
                code, took, _, err = seconds(args.binary, words(name, file, moved, size * 0.01, count // 2, folder), args.limit)
                ratio = (took + FLOOR) / (expected(name, count) + FLOOR)
                runs += 1
                if code not in (0, 1):
                    failed.append(f"{file.name} ({count}) {name}: {code} {took:.2f} s {err[:160]}")
                if ratio > args.report:
                    found.append((ratio, f"{ratio:6.1f} {took:7.2f} s, clean {expected(name, count):.3f} s: {name} {file.name} ({count})"))
                    print(found[-1][1], flush=True)
    print(f"{runs} runs, {len(found)} above {args.report} times a clean mesh; {len(failed)} ended with an error")
    for _, line in sorted(found, reverse=True):
        print(line)
    for line in failed:
        print("error:", line)
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
