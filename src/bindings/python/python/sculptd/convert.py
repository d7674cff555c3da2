"""Meshes and results for other libraries: trimesh, pyvista, Open3D, pandas, notebooks.

Each function imports its library when it is called; `sculptd` itself needs none of them. Colours
of vertices survive every conversion, there and back. Groups of faces and their names survive to
trimesh and pyvista. These libraries hold triangles here: polygons are cut.
"""

import base64
import html as escaping
import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import LossWarning, Mesh

if TYPE_CHECKING:
    import pandas

__all__ = [
    "ThinPlace",
    "from_open3d",
    "from_pyvista",
    "from_trimesh",
    "html",
    "plot",
    "to_open3d",
    "to_pandas",
    "to_pyvista",
    "to_trimesh",
]


class ThinPlace(NamedTuple):
    """A thin region of a part: its thinnest place, the thickness there, and its area."""

    position: tuple[float, float, float]
    thickness: float
    area: float


def _restored(
    vertices: Any, faces: Any, colours: Any, groups: Any, names: Sequence[object] | None
) -> Mesh:
    """A mesh of what another library holds."""
    settings: dict[str, Any] = {}
    if colours is not None and len(colours):
        settings["colours"] = colours
    if groups is not None:
        settings["groups"] = groups
    if names is not None:
        settings["group_names"] = [str(name) for name in names]
    return Mesh(np.asarray(vertices, dtype=float), faces, **settings)


def to_trimesh(mesh: Mesh) -> Any:
    """A `trimesh.Trimesh` with the colours; groups are `face_attributes["group"]`, their names
    `metadata["group_names"]`.
    """
    import trimesh

    whole = mesh.triangulated()
    made = trimesh.Trimesh(
        vertices=whole.vertices,
        faces=whole.faces,
        vertex_colors=whole.colours,
        process=False,
    )
    if whole.groups is not None:
        made.face_attributes["group"] = np.array(whole.groups)
    if whole.group_names is not None:
        made.metadata["group_names"] = whole.group_names
    return made


def from_trimesh(mesh: Any) -> Mesh:
    """A `sculptd.Mesh` of a `trimesh.Trimesh`; its colours are those of vertices."""
    coloured = mesh.visual.kind in ("vertex", "face") and mesh.visual.defined
    return _restored(
        mesh.vertices,
        np.asarray(mesh.faces),
        np.asarray(mesh.visual.vertex_colors) if coloured else None,
        mesh.face_attributes.get("group"),
        mesh.metadata.get("group_names"),
    )


def to_pyvista(mesh: Mesh) -> Any:
    """A `pyvista.PolyData`; colours are `point_data["colours"]`, groups `cell_data["group"]`, their
    names `field_data["group_names"]`.
    """
    import pyvista

    whole = mesh.triangulated()
    made = pyvista.PolyData.from_regular_faces(
        np.array(whole.vertices), whole.faces.astype(int)
    )
    if whole.colours is not None:
        made.point_data["colours"] = np.array(whole.colours)
    if whole.groups is not None:
        made.cell_data["group"] = np.array(whole.groups)
    if whole.group_names is not None:
        made.field_data["group_names"] = whole.group_names
    return made


def from_pyvista(mesh: Any) -> Mesh:
    """A `sculptd.Mesh` of a `pyvista.PolyData`."""
    whole = mesh.triangulate()
    cells, fields = whole.cell_data, whole.field_data
    return _restored(
        whole.points,
        whole.regular_faces,
        np.array(whole.point_data["colours"]) if "colours" in whole.point_data else None,
        np.array(cells["group"]) if "group" in cells else None,
        list(fields["group_names"]) if "group_names" in fields else None,
    )


def to_open3d(mesh: Mesh) -> Any:
    """An `open3d.geometry.TriangleMesh` with the colours. It has no place for opacity and groups;
    a `LossWarning` says so.
    """
    import open3d

    whole = mesh.triangulated()
    if whole.groups is not None or whole.colours is not None and whole.colours[:, 3].min() < 255:
        text = "groups and the opacity of colours are left out: Open3D has no place for them"
        warnings.warn(text, LossWarning, stacklevel=2)
    made = open3d.geometry.TriangleMesh(
        open3d.utility.Vector3dVector(np.array(whole.vertices)),
        open3d.utility.Vector3iVector(whole.faces.astype(np.int32)),
    )
    if whole.colours is not None:
        colours = whole.colours[:, :3] / 255.0
        made.vertex_colors = open3d.utility.Vector3dVector(colours)
    return made


def from_open3d(mesh: Any) -> Mesh:
    """A `sculptd.Mesh` of an `open3d.geometry.TriangleMesh`."""
    colours = None
    if mesh.has_vertex_colors():
        parts = np.rint(np.asarray(mesh.vertex_colors) * 255.0).astype(np.uint8)
        colours = np.column_stack([parts, np.full(len(parts), 255, np.uint8)])
    return _restored(mesh.vertices, np.asarray(mesh.triangles), colours, None, None)


def to_pandas(rows: Iterable[Mapping[str, Any] | ThinPlace]) -> "pandas.DataFrame":
    """A `pandas.DataFrame` of thin places, findings or sections: one row each.

    Places become columns: ``position`` becomes ``x``, ``y``, ``z``, and ``centroid`` becomes
    ``centroid_x`` and so on. Lists that are no place stay as they are.
    """
    import pandas

    flat: list[dict[str, Any]] = []
    for row in rows:
        if not isinstance(row, (Mapping, ThinPlace)):
            raise TypeError("to_pandas: expected rows such as worst(), sections() or findings")
        out: dict[str, Any] = {}
        for name, value in (row._asdict() if isinstance(row, ThinPlace) else row).items():
            if _is_place(value):
                start = "" if name == "position" else f"{name}_"
                out.update({start + axis: v for axis, v in zip("xyz", value)})
            else:
                out[name] = value
        flat.append(out)
    return pandas.DataFrame(flat)


def _is_place(value: object) -> bool:
    if not isinstance(value, (list, tuple)) or len(value) != 3:
        return False
    return all(isinstance(v, (int, float)) for v in value)


def plot(mesh: Mesh, **settings: Any) -> Any:
    """Shows a mesh by pyvista; see `Mesh.plot`."""
    shown = to_pyvista(mesh)
    if "colours" in shown.point_data and not {"scalars", "color"} & set(settings):
        settings.update(scalars="colours", rgb=True)
    return shown.plot(**settings)


def html(mesh: Mesh) -> str:
    """What a notebook shows of a mesh: a picture, and its facts beside it."""
    facts = [("vertices", f"{len(mesh.vertices):,}"), ("faces", f"{len(mesh):,}")]
    if mesh.bounds is not None:
        low, high = mesh.bounds
        size = " × ".join(f"{b - a:.6g}" for a, b in zip(low, high))
        closed = mesh.is_closed
        facts += [("size", size), ("area", f"{mesh.area:.6g}")]
        facts += [("volume", f"{mesh.volume:.6g}" if closed else "none: the mesh is open")]
    facts += [("colours", "yes")] if mesh.colours is not None else []
    facts += [("from", mesh.format)] if mesh.format else []
    facts += [("warning", text) for text in mesh.warnings]
    rows = "".join(
        f"<tr><th>{escaping.escape(name)}</th><td>{escaping.escape(text)}</td></tr>"
        for name, text in facts
    )
    picture = base64.b64encode(mesh._repr_png_()).decode()
    return (
        f'<div style="display:flex"><img alt="mesh" src="data:image/png;base64,{picture}"/>'
        f"<table>{rows}</table></div>"
    )
