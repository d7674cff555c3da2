from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, BinaryIO, Literal, TypedDict, final

from typing_extensions import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .convert import ThinPlace

__all__ = [
    "__version__",
    "SculptdError",
    "FileFormatError",
    "BooleanFailed",
    "EmptyResult",
    "JobCancelled",
    "LossWarning",
    "Mesh",
    "read",
    "BooleanResult",
    "boolean",
    "boolean_all",
    "union",
    "sections",
    "slices",
    "Thickness",
    "thickness",
    "Projection",
    "measure",
    "check",
    "project",
    "Solid",
    "remesh",
    "offset",
    "hollow",
    "decimate",
    "subdivide",
    "repair",
    "picture",
]

__version__: str

_Progress = Callable[[float], object] | None
_Path = str | PathLike[str]
_Vector = Sequence[float]
_Operation = Literal["union", "intersection", "difference", "reverse-difference"]
_Faces = Literal["as-operands", "triangles", "convex", "polygons"]

class SculptdError(Exception): ...

class FileFormatError(SculptdError):
    path: str
    line: int | None
    byte: int | None
    expected: str
    found: str

class BooleanFailed(SculptdError):
    operand: Literal["A", "B"] | None
    kind: Literal["open", "inside-out", "not-finite", "inconsistent"]
    edges: int | None

class EmptyResult(SculptdError): ...
class JobCancelled(SculptdError): ...
class LossWarning(UserWarning): ...

@final
class Mesh:
    def __new__(
        cls,
        vertices: ArrayLike,
        faces: ArrayLike,
        face_starts: ArrayLike | None = None,
        colours: ArrayLike | None = None,
        groups: ArrayLike | None = None,
        group_names: Sequence[str] | None = None,
    ) -> Self: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def faces(self) -> NDArray[np.uint32]: ...
    @property
    def corners(self) -> NDArray[np.uint32]: ...
    @property
    def face_starts(self) -> NDArray[np.uint32]: ...
    @property
    def colours(self) -> NDArray[np.uint8] | None: ...
    @property
    def groups(self) -> NDArray[np.uint32] | None: ...
    @property
    def group_names(self) -> list[str] | None: ...
    @property
    def format(self) -> str | None: ...
    @property
    def warnings(self) -> list[str]: ...
    def triangulated(self) -> Mesh: ...
    def transformed(
        self,
        scale: float = 1.0,
        offset: _Vector = ...,
        matrix: Sequence[Sequence[float]] | NDArray[np.float64] | None = None,
    ) -> Mesh: ...
    @property
    def volume(self) -> float: ...
    @property
    def area(self) -> float: ...
    @property
    def bounds(self) -> tuple[list[float], list[float]] | None: ...
    @property
    def is_closed(self) -> bool: ...
    def __sub__(self, other: Mesh, /) -> Mesh: ...
    def __or__(self, other: Mesh, /) -> Mesh: ...
    def __and__(self, other: Mesh, /) -> Mesh: ...
    def __rsub__(self, other: Mesh, /) -> Mesh: ...
    def __ror__(self, other: Mesh, /) -> Mesh: ...
    def __rand__(self, other: Mesh, /) -> Mesh: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __copy__(self) -> Mesh: ...
    def __deepcopy__(self, _memo: object, /) -> Mesh: ...
    def __reduce__(self) -> tuple[Callable[[bytes], Mesh], tuple[bytes]]: ...
    def _repr_png_(self) -> bytes: ...
    def _repr_html_(self) -> str: ...
    def plot(self, **settings: Any) -> Any: ...
    def write(
        self, path: _Path | BinaryIO, format: str | None = None, *, strict: bool = False
    ) -> None: ...
    @classmethod
    def box(cls, low: _Vector, high: _Vector) -> Mesh: ...
    @classmethod
    def sphere(cls, radius: float, frequency: int = 32) -> Mesh: ...
    @classmethod
    def cylinder(cls, radius: float, height: float, around: int = 64) -> Mesh: ...
    def __len__(self) -> int: ...

@final
class BooleanResult:
    @property
    def operation(self) -> _Operation: ...
    @property
    def mesh(self) -> Mesh: ...
    @property
    def operand(self) -> NDArray[np.uint8] | NDArray[np.uint32]: ...
    @property
    def face(self) -> NDArray[np.uint32]: ...
    @property
    def volume(self) -> float: ...
    @property
    def area(self) -> float: ...
    @property
    def components(self) -> int: ...
    @property
    def closed(self) -> bool: ...
    @property
    def manifold(self) -> bool: ...
    @property
    def tolerance(self) -> float: ...
    @property
    def depends_on_tolerance(self) -> bool: ...
    @property
    def warnings(self) -> list[str]: ...

@final
class Thickness:
    @property
    def values(self) -> NDArray[np.float32]: ...
    @property
    def reasons(self) -> NDArray[np.uint8]: ...
    @property
    def errors(self) -> NDArray[np.float32]: ...
    @property
    def face_values(self) -> NDArray[np.float32]: ...
    @property
    def least(self) -> dict[str, Any] | None: ...
    # A limit between the bounds of a certified least wall is a tie, and counts as reached.
    def reaches(self, limit: float) -> bool | None: ...
    @property
    def min(self) -> float | None: ...
    @property
    def max(self) -> float | None: ...
    @property
    def mean(self) -> float | None: ...
    @property
    def median(self) -> float | None: ...
    @property
    def valid(self) -> float: ...
    @property
    def error_bound(self) -> float: ...
    def summary(self) -> dict[str, Any]: ...
    def below(self, limit: float) -> tuple[float, float]: ...
    def judge(
        self,
        preset: str | None = None,
        *,
        fail_below: float | None = None,
        warn_below: float | None = None,
        fail_above: float | None = None,
        progress: _Progress = None,
    ) -> dict[str, Any]: ...
    def worst(self, limit: float, count: int = 10) -> list[ThinPlace]: ...
    def parts(
        self, levels: int | None = None, smoothing: float = 1.25
    ) -> tuple[NDArray[np.uint32], dict[str, Any]]: ...
    def medial_curve(self) -> dict[str, Any]: ...

@final
class Projection:
    @property
    def area(self) -> float: ...
    @property
    def axes(self) -> tuple[list[float], list[float]]: ...
    @property
    def regions(self) -> list[tuple[NDArray[np.float64], list[NDArray[np.float64]]]]: ...

@final
class Solid:
    def __new__(
        cls,
        mesh: Mesh,
        *,
        sign: Literal["winding", "pseudonormal"] = "winding",
        progress: _Progress = None,
    ) -> Self: ...
    def signed_distance(
        self, at: ArrayLike, *, progress: _Progress = None
    ) -> NDArray[np.float64]: ...
    def nearest(
        self, at: ArrayLike, *, progress: _Progress = None
    ) -> tuple[NDArray[np.float64], NDArray[np.uint32]]: ...
    def winding(self, at: ArrayLike) -> NDArray[np.float64]: ...

class _Measures(TypedDict):
    volume: float
    area: float
    dimensions: list[float]
    centroid: list[float] | None

def read(
    path: _Path | BinaryIO,
    progress: _Progress = None,
    *,
    format: str | None = None,
    strict: bool = False,
) -> Mesh: ...
def boolean(
    a: Mesh,
    b: Mesh | Sequence[Mesh],
    operation: _Operation = "union",
    *,
    tolerance: float | None = None,
    faces: _Faces = "as-operands",
    keep_contact: bool = False,
    progress: _Progress = None,
) -> BooleanResult: ...
def boolean_all(
    a: Mesh,
    b: Mesh,
    *,
    tolerance: float | None = None,
    faces: _Faces = "as-operands",
    keep_contact: bool = False,
    progress: _Progress = None,
) -> dict[_Operation, BooleanResult]: ...
def union(
    meshes: Sequence[Mesh],
    *,
    tolerance: float | None = None,
    faces: _Faces = "as-operands",
    progress: _Progress = None,
) -> BooleanResult: ...
class _Section(TypedDict):
    area: float
    perimeter: float
    folded: float
    turned: float
    centroid: list[float] | None
    contours: list[NDArray[np.float64]]
    open: list[NDArray[np.float64]]

def sections(
    mesh: Mesh, normal: _Vector, offsets: Sequence[float], *, progress: _Progress = None
) -> list[_Section]: ...
def slices(
    mesh: Mesh, normal: _Vector, offsets: Sequence[float], *, progress: _Progress = None
) -> list[list[NDArray[np.float64]]]: ...
def thickness(
    mesh: Mesh,
    *,
    method: Literal["ray", "cone", "sphere"] = "ray",
    rays: int = 25,
    opening: float = 60.0,
    side: Literal["wall", "gap"] = "wall",
    edges: Literal["extrapolate", "raw", "sphere", "neutral"] = "extrapolate",
    faces: bool = False,
    progress: _Progress = None,
) -> Thickness: ...
def measure(mesh: Mesh) -> _Measures: ...
def check(
    mesh: Mesh,
    *,
    crossings: bool = True,
    process: Literal["fdm", "sla", "sls", "moulding"] | None = None,
    printer: str | None = None,
    material: str | None = None,
    up: _Vector = ...,
    scale: float = 1.0,
    orient: bool = False,
    progress: _Progress = None,
) -> dict[str, Any]: ...
def project(
    mesh: Mesh, direction: _Vector = ..., *, progress: _Progress = None
) -> Projection: ...
def remesh(
    mesh: Mesh, *, side: int = 256, sharp: bool = False, progress: _Progress = None
) -> Mesh: ...
def offset(
    mesh: Mesh, distance: float, *, side: int = 256, progress: _Progress = None
) -> Mesh: ...
def hollow(mesh: Mesh, wall: float, *, side: int = 256, progress: _Progress = None) -> Mesh: ...
def decimate(
    mesh: Mesh, triangles: int = 0, *, error: float = ..., progress: _Progress = None
) -> Mesh: ...
def subdivide(
    mesh: Mesh,
    levels: int = 1,
    *,
    scheme: Literal["loop", "catmull-clark"] = "loop",
    progress: _Progress = None,
) -> Mesh: ...
def repair(
    mesh: Mesh, *, weld: float = 0.0, longest_hole: int = ..., progress: _Progress = None
) -> Mesh: ...
def picture(
    mesh: Mesh,
    *,
    thickness: Thickness | None = None,
    width: int = 640,
    height: int = 480,
    towards_eye: _Vector | None = None,
) -> bytes: ...
