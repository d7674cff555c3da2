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

    Difference takes every further mesh from the first. ``tolerance`` and ``progress`` are those of
    `sculptd.boolean`.
    """
    if operation not in ("union", "intersection", "difference"):
        raise ValueError(f"Invalid boolean operation: '{operation}'")
    if operation == "difference" and len(meshes) < 2:
        raise ValueError("Difference only defined over two meshes.")
    if check_volume and not all(m.is_volume for m in meshes):
        raise ValueError("Not all meshes are volumes!")

    def two(a, b, what):
        made = boolean(a, b, what, tolerance=tolerance, faces="triangles", progress=progress)
        return made.mesh

    parts = [from_trimesh(m) for m in meshes]
    if operation == "difference":
        return to_trimesh(two(parts[0], _cascade(parts[1:], two, "union"), "difference"))
    return to_trimesh(_cascade(parts, two, operation))


def _cascade(parts, two, operation):
    # Neighbours first: operands of like size, and no long chain through one growing mesh.
    while len(parts) > 1:
        pairs = [parts[i : i + 2] for i in range(0, len(parts), 2)]
        parts = [two(*pair, operation) if len(pair) == 2 else pair[0] for pair in pairs]
    return parts[0]


def _register():
    # trimesh has no public function for this; `_engines` is the table that its functions look in.
    trimesh.boolean._engines["sculptd"] = engine
    available = getattr(trimesh.boolean, "engines_available", None)
    if available is not None:
        available.add("sculptd")


_register()
