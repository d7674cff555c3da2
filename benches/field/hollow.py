#!/usr/bin/env python3
"""Hollows parts to a wall of 2 mm and measures the wall again: python3 benches/field/hollow.py SCULPTD MESH...

Every part is first scaled so that its longest side is 100 mm. Then the thickness check (largest inscribed sphere at every
vertex, sharp edges told apart) looks at the hollowed part, and at the part as it was: towards its own sharp corners a solid
part is thinner than any wall, so only what hollowing made thinner than 1.9 mm counts against it.
A line: the part, what is under 1.9 mm on the old surface and was not before, the same on the cavity, and the least of them.
Exits with 1 when there is any.
"""
import json
import os
import struct
import subprocess
import sys
import tempfile

LIMIT = 1.9


def scaled(sculptd, mesh, folder):
    """The part with a longest side of 100 mm, as an OBJ file, and its number of vertices."""
    whole = os.path.join(folder, "whole.obj")
    subprocess.run([sculptd, "convert", mesh, whole], check=True, capture_output=True)
    lines = open(whole).read().splitlines()
    points = [[float(x) for x in l.split()[1:4]] for l in lines if l.startswith("v ")]
    side = max(max(c) - min(c) for c in zip(*points))
    count, points = len(points), iter(points)
    with open(whole, "w") as out:
        for l in lines:
            if l.startswith("v "):
                l = "v " + " ".join(repr(x * 100 / side) for x in next(points))
            out.write(l + "\n")
    return whole, count


def measured(sculptd, mesh, folder):
    """The thickness at each vertex, None where there is none (a sharp edge among the reasons)."""
    ply = os.path.join(folder, "values.ply")
    told = subprocess.run([sculptd, "--json", "thickness", mesh, "--method", "sphere", "--ply", ply], capture_output=True, text=True)
    if told.returncode not in (0, 1):
        raise OSError(told.stderr.strip().splitlines()[-1])
    head, body = open(ply, "rb").read().split(b"end_header\n", 1)
    count = int(head.split(b"element vertex ")[1].split()[0])
    row = struct.Struct("<3d3BfB")
    rows = (row.unpack_from(body, i * row.size) for i in range(count))
    return [r[6] if r[7] == 0 else None for r in rows], json.loads(told.stdout)


def main():
    sculptd, meshes = sys.argv[1], sys.argv[2:]
    bad = False
    for mesh in meshes:
        name = os.path.basename(mesh)
        with tempfile.TemporaryDirectory() as folder:
            hollow = os.path.join(folder, "hollow.ply")
            try:
                whole, count = scaled(sculptd, mesh, folder)
                made = subprocess.run([sculptd, "hollow", whole, "--wall", "2", "-o", hollow], capture_output=True, text=True)
                if made.returncode:
                    print(f"{name}: not hollowed: {made.stderr.strip().splitlines()[-1]}", flush=True)
                    continue
                before, _ = measured(sculptd, whole, folder)
                after, facts = measured(sculptd, hollow, folder)
            except (subprocess.CalledProcessError, ValueError, OSError) as e:
                print(f"{name}: {e}", flush=True)
                continue
            thin = [t is not None and t < LIMIT for t in after]
            old = [after[i] for i in range(count) if thin[i] and not (before[i] is None or before[i] < LIMIT)]
            new = [after[i] for i in range(count, len(after)) if thin[i]]
            least = min(old + new, default=None)
            bad |= least is not None
            print(f"{name}: {'thin' if bad and least is not None else 'sound'}, {len(old)} of {count} and {len(new)} of {len(after) - count}, "
                  f"least {least}, mean {facts['mean']:.3f}, own corners {sum(thin[:count]) - len(old)}", flush=True)
    sys.exit(bad)


main()
