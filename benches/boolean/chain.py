#!/usr/bin/env python3
"""Booleans one after another beside manifold3d (PyPI), on the same meshes in the same run.

    cargo build --release -p sculptd-geometry --example chain
    python chain.py target/release/examples/chain [--cases ball,dome] [--rounds 3] [--old OTHER]

Every operand is made here by a formula, in triangles. Both sides hold the operands in memory and
start from there. Ours checks each operand and the result (closed, manifold, volume); `+ look` is the
same with a look at the whole result for triangles that cross. Manifold's time is making its solids
from the arrays, the operations in the order of the list, and the number of triangles of the result,
for it computes lazily. CPU seconds of the process, medians of the rounds; `--one-by-one` adds ours with each step as a Boolean
of its own. Exits with 1 where volumes differ by more than 1e-9 or ours is not a closed manifold
without crossings.
"""
import argparse
import json
import statistics
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import manifold3d as m3
import numpy as np


def turn():
    """An odd rotation."""
    axis = np.array([0.3, -0.7, 0.55])
    axis /= np.linalg.norm(axis)
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(0.7) * cross + (1 - np.cos(0.7)) * cross @ cross


def ball(radius, triangles):
    """A sphere of rings, about so many triangles."""
    rings = max(3, round((triangles / 4) ** 0.5))
    return revolved(np.sin(np.pi * np.arange(1, rings) / rings) * radius,
                    np.cos(np.pi * np.arange(1, rings) / rings) * radius, radius, -radius, 2 * rings)


def capsule(radius, length, around=24, caps=6):
    """A cylinder with round ends along z."""
    angle = np.pi / 2 * np.arange(1, caps + 1) / caps
    r = np.concatenate([np.sin(angle), np.sin(angle)[::-1]]) * radius
    z = np.concatenate([np.cos(angle) * radius + length / 2, -np.cos(angle)[::-1] * radius - length / 2])
    return revolved(r, z, length / 2 + radius, -length / 2 - radius, around)


def revolved(r, z, top, bottom, around):
    phi = 2 * np.pi * np.arange(around) / around
    rings = np.stack([r[:, None] * np.cos(phi), r[:, None] * np.sin(phi), np.repeat(z[:, None], around, 1)], -1)
    vertices = np.concatenate([rings.reshape(-1, 3), [[0, 0, top], [0, 0, bottom]]])
    here, on = np.arange(around), (np.arange(around) + 1) % around
    faces = []
    for k in range(len(r) - 1):
        a, b = k * around, (k + 1) * around
        faces += [np.stack([a + here, b + here, b + on], 1), np.stack([a + here, b + on, a + on], 1)]
    last = (len(r) - 1) * around
    first = len(r) * around
    faces.append(np.stack([np.full(around, first), here, on], 1))
    faces.append(np.stack([np.full(around, first + 1), last + on, last + here], 1))
    return vertices, np.concatenate(faces)


def cube(low, size):
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float) * size + low
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return corners, np.array([t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])])


def towards(n):
    """A rotation that takes z to a direction."""
    n = n / np.linalg.norm(n)
    x = np.cross(n, [0.12, 0.93, 0.34])
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(n, x), n], 1)


def spiral(count):
    """Directions spread over the sphere (Fibonacci's lattice)."""
    i = np.arange(count)
    z = 1 - (2 * i + 1) / count
    phi = np.pi * (1 + 5**0.5) * i
    r = np.sqrt(1 - z * z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], 1)


def placed(mesh, rotation, shift):
    return mesh[0] @ rotation.T + shift, mesh[1]


def capsules(part, count, radius, length, around):
    tool = capsule(radius, length, around)
    return [("+", part)] + [("-", placed(tool, towards(n + [0.1, 0.2, -0.1]), n * 0.97)) for n in spiral(count)]


def dome(count):
    """The upper half of a ball with as many dents as tools, which overlap."""
    size = 1.1 * (2 / count) ** 0.5
    tool = ball(1.0, 320)
    spots = [n for n in spiral(2 * count) if n[2] > 0][:count]
    wave = lambda i: size * (0.6 + 0.4 * np.sin(1.7 * i))
    return [("+", ball(1.0, 20_000)), ("-", cube([-2, -2, -4], 4.0))] + [
        ("-", placed((tool[0] * wave(i), tool[1]), towards(n), n)) for i, n in enumerate(spots)
    ]


def grid(side):
    """Cubes that touch, joined one by one, then taken away again but for one."""
    places = [np.array([x, y, z], float) for z in range(side) for y in range(side) for x in range(side)]
    cubes = [cube(p, 1.0) for p in places]
    return [("+", c) for c in cubes] + [("-", c) for c in cubes[1:]]


def plate(count, together):
    """A plate and a pattern of drills, one by one or as one mesh."""
    v, t = capsule(3.0, 20.0, 32, 1)
    drills = [(v + [5 + 10 * (i % 10), 5 + 10 * (i // 10), 5], t) for i in range(count)]
    if together:
        drills = [(np.concatenate([d[0] for d in drills]), np.concatenate([t + i * len(v) for i in range(count)]))]
    corners, faces = cube(np.zeros(3), 1.0)
    return [("+", (corners * [100, 10 * (count // 10), 10], faces))] + [("-", d) for d in drills]


CASES = {
    "ball 10k - 50 small capsules": lambda: capsules(ball(1.0, 10_000), 50, 0.04, 0.2, 24),
    "ball 100k - 50 small capsules": lambda: capsules(ball(1.0, 100_000), 50, 0.04, 0.2, 24),
    "ball 20k - 100 capsules that overlap": lambda: capsules(ball(1.0, 20_000), 100, 0.12, 0.5, 32),
    "ball 1M - 50 small capsules": lambda: capsules(ball(1.0, 1_000_000), 50, 0.02, 0.1, 24),
    "grid of 4 cubes": lambda: grid(4),
    "grid of 6 cubes": lambda: grid(6),
    "grid of 10 cubes": lambda: grid(10),
    "plate - 50 drills": lambda: plate(50, False),
    "plate - 50 drills in one mesh": lambda: plate(50, True),
    "dome, 100 tools": lambda: dome(100),
    "dome, 1000 tools": lambda: dome(1000),
}


def peer(operands):
    solids = [
        m3.Manifold(m3.Mesh64(np.ascontiguousarray(v, dtype=np.float64), np.ascontiguousarray(t, dtype=np.uint64)))
        for _, (v, t) in operands
    ]
    made = solids[0]
    for (operation, _), solid in zip(operands[1:], solids[1:]):
        made = made + solid if operation == "+" else made - solid
    return made.num_tri(), made


class Ours:
    def __init__(self, binary, file, *more):
        self.process = subprocess.Popen([binary, file, *more], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.triangles = json.loads(self.process.stdout.readline())["triangles"]
        # The clock of that process's CPU time, as clock_getcpuclockid(3) makes it.
        self.clock = ((~self.process.pid) << 3) | 2

    def run(self, line=""):
        before = time.clock_gettime(self.clock)
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        said = json.loads(self.process.stdout.readline())
        return time.clock_gettime(self.clock) - before, said

    def end(self):
        self.process.stdin.close()
        self.process.wait()


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("chain")
    arguments.add_argument("--cases", default="", help="parts of names, with commas between")
    arguments.add_argument("--rounds", type=int, default=3)
    arguments.add_argument("--one-by-one", action="store_true")
    arguments.add_argument("--old", help="another build of the bench, of which the same is measured")
    arguments.add_argument("--phases", action="store_true")
    options = arguments.parse_args()
    wanted = [w for w in options.cases.split(",") if w]
    wrong = False
    print("| case | ours CPU s | + look | Manifold CPU s | ours / Manifold | triangles | volumes differ | local steps |")
    print("|---|---|---|---|---|---|---|---|")
    for name, make in CASES.items():
        if wanted and not any(w in name for w in wanted):
            continue
        for turned in (False, True):
            operands = make()
            if turned:
                operands = [(o, placed(m, turn(), [0.1, -0.3, 0.7])) for o, m in operands]
            with tempfile.NamedTemporaryFile() as file:
                for operation, (v, t) in operands:
                    file.write(operation.encode() + struct.pack("<QQ", len(v), len(t)))
                    file.write(np.ascontiguousarray(v, "<f8").tobytes() + np.ascontiguousarray(t, "<u4").tobytes())
                file.flush()
                ours = Ours(options.chain, file.name)
                others = {}
                if options.one_by_one:
                    others["one by one"] = Ours(options.chain, file.name, "one-by-one")
                if options.old:
                    others["old"] = Ours(options.old, file.name, "one-by-one")
                times, looks, peers, more = [], [], [], {n: [] for n in others}
                for _ in range(options.rounds):
                    times.append(ours.run()[0])
                    took, said = ours.run("look")
                    looks.append(took)
                    begun = time.process_time()
                    count, made = peer(operands)
                    peers.append(time.process_time() - begun)
                    for n, other in others.items():
                        more[n].append(other.run())
                [o.end() for o in [ours, *others.values()]]
            volume = made.volume()
            size = max(1.0, abs(volume))
            off = abs(said["volume"] - volume) / size
            wrong |= off > 1e-9 or not said["closed"] or said["crossings"] > 0
            t, k, p = (statistics.median(x) for x in (times, looks, peers))
            print(f"| {name}{', turned' if turned else ''} | {t:.3f} | {k:.3f} | {p:.3f} | {t / p:.2f} "
                  f"| {said['triangles']} and {count} | {off:.1e}{'' if said['crossings'] == 0 else ', CROSSES'} "
                  f"| {said['local']} of {len(operands) - 1} |", flush=True)
            for n, runs in more.items():
                v = runs[-1][1]["volume"]
                print(f"  {n}: {statistics.median(r[0] for r in runs):.3f} CPU s, volumes differ by "
                      f"{abs(said['volume'] - v) / size:.1e}, {runs[-1][1]['triangles']} triangles")
            if options.phases:
                print("  " + ", ".join(f"{n} {s:.3f}" for n, s in said["phases"].items()), f"wall {said['seconds']:.3f}")
    sys.exit(wrong)


if __name__ == "__main__":
    main()
