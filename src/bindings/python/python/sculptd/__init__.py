"""Booleans, wall thickness, distance, projection and remeshing of meshes.

Read a mesh, ask it something, write what came out::

    import sculptd

    part = sculptd.read("part.stl")
    hole = sculptd.Mesh.cylinder(radius=3.0, height=50.0)
    made = part - hole
    walls = sculptd.thickness(made)
    print(made.volume, walls.min, walls.below(1.0))
    made.write("drilled.3mf")

Lengths are in the unit of the file, millimetres as a rule. A mesh never changes; every operation
gives a new one. Arrays of a mesh (``vertices``, ``faces``) are read-only views of its own memory.

Functions that may take long release the interpreter's lock, stop on Ctrl+C, and call
``progress(done)`` with a number from 0 to 1 about ten times a second. An exception that ``progress``
raises cancels the work.

``sculptd.control`` talks to a running daemon; ``sculptd.convert`` converts meshes to and from
trimesh, pyvista and Open3D, and results to pandas; ``sculptd.trimesh_engine`` gives trimesh our
Booleans.
"""

import importlib
import typing

if typing.TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from . import control, convert
    from ._native import (
        BooleanFailed,
        BooleanResult,
        EmptyResult,
        FileFormatError,
        JobCancelled,
        LossWarning,
        Mesh,
        Projection,
        SculptdError,
        Solid,
        Thickness,
        __version__,
        boolean,
        boolean_all,
        check,
        decimate,
        hollow,
        measure,
        offset,
        picture,
        project,
        read,
        remesh,
        repair,
        sections,
        slices,
        subdivide,
        thickness,
        union,
    )
else:

    def __getattr__(name):
        # On first use, so that `sculptd.control` works without the native module.
        if name not in __all__:
            raise AttributeError(f"module 'sculptd' has no attribute {name!r}")
        if name in ("control", "convert"):
            return importlib.import_module(f".{name}", __name__)
        value = getattr(importlib.import_module("._native", __name__), name)
        globals()[name] = value
        return value

    def __dir__():
        return sorted([*globals(), *__all__])


__all__ = [
    "BooleanFailed",
    "BooleanResult",
    "EmptyResult",
    "FileFormatError",
    "JobCancelled",
    "LossWarning",
    "Mesh",
    "Projection",
    "SculptdError",
    "Solid",
    "Thickness",
    "__version__",
    "boolean",
    "boolean_all",
    "check",
    "control",
    "convert",
    "decimate",
    "hollow",
    "measure",
    "offset",
    "picture",
    "project",
    "read",
    "remesh",
    "repair",
    "sections",
    "signed_distance",
    "slices",
    "subdivide",
    "thickness",
    "union",
]


def signed_distance(
    mesh: "Mesh",
    points: "ArrayLike",
    *,
    progress: "Callable[[float], object] | None" = None,
) -> "NDArray[np.float64]":
    """The distance of each of (n, 3) points to the surface of `mesh`, negative inside.

    For several questions of one mesh make a `Solid` once.
    """
    from ._native import Solid

    return Solid(mesh).signed_distance(points, progress=progress)
