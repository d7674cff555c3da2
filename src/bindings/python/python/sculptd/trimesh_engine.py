"""sculptd as a Boolean engine of trimesh.

Importing this module registers it::

    import sculptd.trimesh_engine
    import trimesh

    joined = trimesh.boolean.union([a, b], engine="sculptd")

``to_trimesh`` and ``from_trimesh`` convert meshes.
"""

import numpy as np
import trimesh

from . import Mesh, boolean

__all__ = ["engine", "from_trimesh", "to_trimesh"]


def from_trimesh(mesh):
    """A `sculptd.Mesh` of a `trimesh.Trimesh`."""
    return Mesh(np.asarray(mesh.vertices), np.asarray(mesh.faces))


def to_trimesh(mesh):
    """A `trimesh.Trimesh` of a `sculptd.Mesh`; polygons are cut into triangles."""
    whole = mesh.triangulated()
    return trimesh.Trimesh(vertices=whole.vertices, faces=whole.faces, process=False)


def engine(meshes, operation, check_volume=True, tolerance=None, progress=None, **_):
    """One operation on a list of meshes, as trimesh's engines are called.

    Difference takes every further mesh from the first. The meshes are joined one after another, each
    at the cost of what it cuts. ``tolerance`` and ``progress`` are those of
    `sculptd.boolean`.
    """
    if operation not in ("union", "intersection", "difference"):
        raise ValueError(f"Invalid boolean operation: '{operation}'")
    if operation == "difference" and len(meshes) < 2:
        raise ValueError("Difference only defined over two meshes.")
    if check_volume and not all(m.is_volume for m in meshes):
        raise ValueError("Not all meshes are volumes!")

    parts = [from_trimesh(m) for m in meshes]
    if len(parts) == 1:
        return to_trimesh(parts[0])
    made = boolean(
        parts[0], parts[1:], operation, tolerance=tolerance, faces="triangles", progress=progress
    )
    return to_trimesh(made.mesh)


def _register():
    # trimesh has no public function for this; `_engines` is the table that its functions look in.
    trimesh.boolean._engines["sculptd"] = engine
    available = getattr(trimesh.boolean, "engines_available", None)
    if available is not None:
        available.add("sculptd")


_register()
