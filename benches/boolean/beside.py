#!/usr/bin/env python3
"""Booleans beside manifold3d (PyPI), on the same meshes in the same run: wall time, volumes, components.

    python beside.py path/to/sculptd [--large]

Ours is `seconds` of `sculptd boolean --json --trust`: from the loaded polygons, everything built on the way, the result
checked and ready; writing is left out on both sides. The peer's is making its manifolds from arrays, then A - B.
Medians of five (three when large); `--once` runs each once. Peak memory is that of a process of its own on both sides, reading
and the operands with it; the peer's has Python and numpy in it. Exits with 1 where volumes differ by more than 1e-9 or
components differ.
"""
import json
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import manifold3d as m3
import numpy as np


def sphere(radius, triangles, shift):
    """About so many triangles, an octahedron subdivided, in a place that touches nothing exactly."""
    n = max(4, 4 * round((triangles / 8) ** 0.5))
    mesh = m3.Manifold.sphere(radius, n).rotate([13.7, 5.1, 41.3]).translate(shift).to_mesh64()
    return np.asarray(mesh.vert_properties)[:, :3].copy(), np.asarray(mesh.tri_verts).astype(np.int32).copy()


def write(path, mesh):
    v, t = mesh
    faces = np.empty(len(t), dtype=[("n", "u1"), ("v", "<i4", 3)])
    faces["n"], faces["v"] = 3, t
    with open(path, "wb") as out:
        out.write(
            f"ply\nformat binary_little_endian 1.0\nelement vertex {len(v)}\nproperty double x\nproperty double y\n"
            f"property double z\nelement face {len(t)}\nproperty list uchar int vertex_indices\nend_header\n".encode()
        )
        out.write(v.astype("<f8").tobytes())
        out.write(faces.tobytes())


def peer(a, b):
    start = time.perf_counter()
    made = [
        m3.Manifold(m3.Mesh64(np.ascontiguousarray(v, dtype=np.float64), np.ascontiguousarray(t, dtype=np.uint64)))
        for v, t in (a, b)
    ]
    [m.num_tri() for m in made]
    built = time.perf_counter()
    out = made[0] - made[1]
    out.num_tri()
    return built - start, time.perf_counter() - built, out.volume(), len(out.decompose())


# Between this process, whose memory a child would be charged with, and the command.
BETWEEN = """import resource, subprocess, sys
done = subprocess.run(sys.argv[1:], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
sys.stdout.buffer.write(done.stdout)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, file=sys.stderr)
sys.exit(done.returncode)"""


def peak(command):
    """Output and peak memory, MiB, of a command."""
    done = subprocess.run([sys.executable, "-c", BETWEEN, *map(str, command)], check=True, capture_output=True)
    return done.stdout, int(done.stderr) / 1024


def alone(folder):
    """The peer in a process of its own: `--alone FOLDER`."""
    a, b = ((np.load(Path(folder) / f"{n}v.npy"), np.load(Path(folder) / f"{n}t.npy")) for n in "ab")
    peer(a, b)


def main():
    if "--alone" in sys.argv:
        return alone(sys.argv[-1])
    binary, large, once = sys.argv[1], "--large" in sys.argv, "--once" in sys.argv
    cases = [
        ("8,480 and 480", sphere(1.0, 8480, [0, 0, 0]), sphere(0.5, 480, [0.9, 0.1, 0.05])),
        ("100k and 100k", sphere(1.0, 100_000, [0, 0, 0]), sphere(1.0, 100_000, [0.7, 0.3, 0.2])),
    ]
    if large:
        cases += [
            ("1M and 1M", sphere(1.0, 1_000_000, [0, 0, 0]), sphere(1.0, 1_000_000, [0.7, 0.3, 0.2])),
            ("2M and a tool of 2k", sphere(1.0, 2_000_000, [0, 0, 0]), sphere(0.05, 2000, [0.7, 0.6, 0.4])),
        ]
    wrong = False
    print(f"{'faces':24}{'ours ms':>10}{'peer ms':>18}{'MiB':>12}{'volumes differ':>18}  components")
    for name, a, b in cases:
        with tempfile.TemporaryDirectory() as folder:
            files = [Path(folder) / f for f in ("a.ply", "b.ply", "out.ply")]
            write(files[0], a)
            write(files[1], b)
            for n, (v, t) in zip("ab", (a, b)):
                np.save(Path(folder) / f"{n}v.npy", v)
                np.save(Path(folder) / f"{n}t.npy", t)
            times, peers, last, theirs, used = [], [], None, None, 0
            for _ in range(1 if once else 3 if len(a[1]) > 500_000 else 5):
                command = [binary, "boolean", "difference", files[0], files[1], "-o", files[2], "--json", "--trust"]
                said, used = peak(command)
                last = json.loads(said)
                times.append(last["seconds"] * 1e3)
                theirs = peer(a, b)
                peers.append((theirs[0] * 1e3, theirs[1] * 1e3))
            _, theirs_used = peak([sys.executable, __file__, "--alone", folder])
        ours = last["results"][0]
        off = abs(ours["volume"] - theirs[2]) / theirs[2]
        wrong |= off > 1e-9 or ours["components"] != theirs[3]
        both = f"{statistics.median(p[0] for p in peers):.1f} + {statistics.median(p[1] for p in peers):.1f}"
        print(f"{name:24}{statistics.median(times):10.1f}{both:>18}{f'{used:.0f}/{theirs_used:.0f}':>12}{off:18.1e}  {ours['components']} and {theirs[3]}")
        print("   " + ", ".join(f"{k} {v * 1e3:.1f}" for k, v in sorted(last["phases"].items())))
    sys.exit(wrong)


if __name__ == "__main__":
    main()
