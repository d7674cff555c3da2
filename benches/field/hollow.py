#!/usr/bin/env python3
"""Hollows parts to a wall of 2 mm and measures the wall again: python3 benches/field/hollow.py SCULPTD MESH...

Every part is first scaled so that its longest side is 100 mm. A line: the part, and what the thickness check says of it
(largest inscribed sphere at every vertex, sharp edges told apart), with the share of the area under 1.9 mm.
"""
import json
import os
import subprocess
import sys
import tempfile


def scaled(sculptd, mesh, folder):
    """The part with a longest side of 100 mm, as an OBJ file."""
    whole = os.path.join(folder, "whole.obj")
    subprocess.run([sculptd, "convert", mesh, whole], check=True, capture_output=True)
    lines = open(whole).read().splitlines()
    points = [[float(x) for x in l.split()[1:4]] for l in lines if l.startswith("v ")]
    side = max(max(c) - min(c) for c in zip(*points))
    points = iter(points)
    with open(whole, "w") as out:
        for l in lines:
            if l.startswith("v "):
                l = "v " + " ".join(repr(x * 100 / side) for x in next(points))
            out.write(l + "\n")
    return whole


def main():
    sculptd, meshes = sys.argv[1], sys.argv[2:]
    for mesh in meshes:
        with tempfile.TemporaryDirectory() as folder:
            hollow = os.path.join(folder, "hollow.ply")
            try:
                whole = scaled(sculptd, mesh, folder)
                made = subprocess.run([sculptd, "hollow", whole, "--wall", "2", "-o", hollow], capture_output=True, text=True)
                if made.returncode:
                    print(f"{os.path.basename(mesh)}: not hollowed: {made.stderr.strip().splitlines()[-1]}", flush=True)
                    continue
                told = subprocess.run(
                    [sculptd, "--json", "thickness", hollow, "--method", "sphere", "--fail-below", "1.9"],
                    capture_output=True, text=True)
                facts = json.loads(told.stdout)
            except (subprocess.CalledProcessError, ValueError, OSError) as e:
                print(f"{os.path.basename(mesh)}: {e}", flush=True)
                continue
            say = {k: v for k, v in facts.items() if isinstance(v, (int, float, str)) and k != "file"}
            print(f"{os.path.basename(mesh)}: exit {told.returncode}, {json.dumps(say)}", flush=True)


main()
