"""sculptd as a Boolean engine of trimesh.

Importing this module registers it::

    import sculptd.trimesh_engine
    import trimesh

    joined = trimesh.boolean.union([a, b], engine="sculptd")

Colours of the operands are kept: faces of the result have those of the operand that they are from.
"""

from collections.abc import Callable, Sequence
from typing import Any, Literal

import trimesh

from . import boolean
from .convert import from_trimesh, to_trimesh

__all__ = ["engine"]


def engine(
    meshes: Sequence[Any],
    operation: Literal["union", "intersection", "difference"],
    check_volume: bool = True,
    tolerance: float | None = None,
    progress: Callable[[float], object] | None = None,
    **_: Any,
) -> Any:
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


def _register() -> None:
    # trimesh has no public function for this; `_engines` is the table that its functions look in.
    trimesh.boolean._engines["sculptd"] = engine
    available = getattr(trimesh.boolean, "engines_available", None)
    if available is not None:
        available.add("sculptd")


_register()
