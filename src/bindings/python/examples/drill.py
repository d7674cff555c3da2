"""Reads a part, drills it, measures its walls, checks it, draws it.

    python drill.py FOLDER
"""

import pathlib
import sys

import sculptd

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
sculptd.Mesh.box((0, 0, 0), (40, 30, 20)).write(folder / "part.stl")
part = sculptd.repair(sculptd.read(folder / "part.stl"))

hole = sculptd.Mesh.cylinder(radius=6, height=60).transformed(offset=(20, 15, 10))
made = sculptd.boolean(part, hole, "difference")
print(f"{made.volume:.1f} mm3, {len(made.mesh)} faces, {(made.operand == 1).sum()} from the drill")

walls = sculptd.thickness(made.mesh, progress=lambda done: print(f"\r{done:.0%}", end=""))
area, share = walls.below(10.0)
print(f"\nthinnest wall {walls.min:.2f} mm, {share:.1%} of the surface under 10 mm")
assert walls.min is not None and abs(walls.min - 9.0) < 0.01

facts = sculptd.check(made.mesh)
print(f"closed: {facts['closed']}, triangles that cross: {facts['self_intersections']}")

made.mesh.write(folder / "drilled.3mf")
# A finer mesh shows how the wall changes within a face.
fine = sculptd.remesh(made.mesh, side=128, sharp=True)
(folder / "drilled.png").write_bytes(sculptd.picture(fine, thickness=sculptd.thickness(fine)))
