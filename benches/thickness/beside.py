#!/usr/bin/env python3
"""Maps of wall thickness, side by side: this program's and MeshLib's (PyPI `meshlib`), the same vertices, the same run.

    python3 benches/thickness/beside.py MESH...

Needs the module `sculptd`. For each mesh: the share of vertices whose values by the ray and by the ball agree within 1 %,
the side to which the others differ, the least values, and the seconds of both. Vertices on sharp edges are left out. A value of
MeshLib that is the largest float means that it found no wall.
"""
import pathlib
import sys
import time

import meshlib.mrmeshnumpy as mn
import meshlib.mrmeshpy as mm
import numpy as np
import sculptd

NONE = 1e30


def theirs(mesh, method):
    """Values at the vertices, and seconds."""
    made = mn.meshFromFacesVerts(mesh.faces.astype(np.int32), mesh.vertices.astype(np.float64))
    began = time.perf_counter()
    if method == "ray":
        found = mm.computeRayThicknessAtVertices(made)
    else:
        settings = mm.InSphereSearchSettings()
        settings.maxRadius = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
        found = mm.computeInSphereThicknessAtVertices(made, settings)
    took = time.perf_counter() - began
    values = np.array([found.vec[i] for i in range(len(mesh.vertices))], dtype=np.float64)
    values[values > NONE] = np.nan
    return values, took


def ours(mesh, method):
    began = time.perf_counter()
    # As measured, also on sharp edges: that is what the other program gives.
    walls = sculptd.thickness(mesh, method=method, edges="raw")
    return walls, time.perf_counter() - began


def main():
    for name in sys.argv[1:]:
        mesh = sculptd.read(name).triangulated()
        for method in ("ray", "sphere"):
            try:
                walls, seconds = ours(mesh, method)
            except ValueError as why:
                print(f"{pathlib.Path(name).stem} {method}: {why}")
                continue
            a, (b, other) = np.array(walls.values, dtype=np.float64), theirs(mesh, method)
            inside = np.isin(walls.reasons, [0])
            both = np.isfinite(a) & np.isfinite(b) & inside
            ratio = b[both] / a[both]
            near = np.abs(ratio - 1.0) < 0.01
            least = np.nanmin(b[b > 0]) if np.any(b > 0) else float("nan")
            print(
                f"{pathlib.Path(name).stem} {method}: {len(a)} vertices, {both.sum()} with both values, "
                f"{100 * near.mean():.1f} % within 1 %; theirs larger at {100 * (ratio > 1.01).mean():.1f} %, smaller at "
                f"{100 * (ratio < 0.99).mean():.1f} %; least {walls.min:.4f}, theirs {least:.4f}; "
                f"{seconds:.2f} s with the certificate, theirs {other:.2f} s"
            )


if __name__ == "__main__":
    main()
