"""Files: paths and file objects, what a format does not hold, colours to the byte."""

import io
import pathlib
import tempfile
import unittest
import warnings

import numpy as np
import sculptd
from sculptd import Mesh

try:
    import lib3mf
except ImportError:
    lib3mf = None

ENDINGS = ("obj", "stl", "ply", "off", "glb", "3mf")


def coloured(alpha=255):
    """A ball that has every value of a byte in each of its colours' parts."""
    ball = Mesh.sphere(10.0, 9)
    n = np.arange(len(ball.vertices))
    colours = np.column_stack([n, n * 7, n * 13, np.full(len(n), 255)]) % 256
    colours[:, 3] = alpha
    return Mesh(ball.vertices, ball.faces, colours=colours)


def in_order(mesh):
    """Rows of place and colour, in an order that no format changes."""
    rows = np.column_stack([mesh.vertices.round(4) + 0.0, mesh.colours])
    return rows[np.lexsort(rows.T)]


@unittest.skipUnless(lib3mf, "needs lib3mf, the 3MF Consortium's reader")
class OtherReader(unittest.TestCase):
    def test_the_consortiums_reader_finds_the_same_triangles_and_colours(self):
        mesh = coloured(alpha=200)
        with tempfile.TemporaryDirectory() as folder:
            path = str(pathlib.Path(folder) / "ball.3mf")
            mesh.write(path)
            model = lib3mf.get_wrapper().CreateModel()
            reader = model.QueryReader("3mf")
            reader.SetStrictModeActive(True)
            reader.ReadFromFile(path)
        self.assertEqual(reader.GetWarningCount(), 0)
        objects = model.GetMeshObjects()
        self.assertEqual(objects.Count(), 1)
        objects.MoveNext()
        found = objects.GetCurrentMeshObject()
        triangles = [tuple(t.Indices) for t in found.GetTriangleIndices()]
        self.assertEqual(triangles, [tuple(t) for t in mesh.faces])
        places = np.array([v.Coordinates for v in found.GetVertices()])
        np.testing.assert_allclose(places, mesh.vertices, atol=1e-5)
        for corners, of in zip(triangles, found.GetAllTriangleProperties()):
            group = model.GetColorGroupByID(of.ResourceID)
            for corner, colour in zip(corners, map(group.GetColor, of.PropertyIDs)):
                rgba = (colour.Red, colour.Green, colour.Blue, colour.Alpha)
                self.assertEqual(rgba, tuple(mesh.colours[corner]))


class Objects(unittest.TestCase):
    def test_every_format_goes_through_memory(self):
        part = Mesh.box((0, 0, 0), (4, 5, 6)).triangulated()
        for ending in ENDINGS:
            with self.subTest(format=ending):
                file = io.BytesIO()
                part.write(file, ending)
                file.seek(0)
                again = sculptd.read(file, format=ending)
                self.assertAlmostEqual(again.volume if ending != "stl" else 120.0, 120.0)
                with tempfile.TemporaryDirectory() as folder:
                    path = pathlib.Path(folder) / f"part.{ending}"
                    part.write(path)
                    self.assertEqual(path.read_bytes(), file.getvalue())
                    with open(path, "rb") as opened:
                        self.assertEqual(sculptd.read(opened), again)
                    path.rename(path.with_suffix(".dat"))
                    self.assertEqual(sculptd.read(path.with_suffix(".dat"), format=ending), again)

    def test_a_format_that_is_missing_or_unknown_is_an_error(self):
        part = Mesh.box((0, 0, 0), (1, 1, 1))
        with self.assertRaisesRegex(ValueError, "format"):
            part.write(io.BytesIO())
        with self.assertRaisesRegex(ValueError, "ends in .obj"):
            part.write(io.BytesIO(), "docx")
        with self.assertRaises(sculptd.FileFormatError):
            sculptd.read(io.BytesIO(b"\x00\x01\x02"))
        with self.assertRaises(TypeError):
            part.write(io.StringIO(), "obj")


class Loss(unittest.TestCase):
    def test_colours_come_back_to_the_byte_or_are_warned_of(self):
        mesh = coloured()
        for ending in ENDINGS:
            with self.subTest(format=ending), warnings.catch_warnings(record=True) as told:
                warnings.simplefilter("always")
                file = io.BytesIO()
                mesh.write(file, ending)
                again = sculptd.read(io.BytesIO(file.getvalue()), format=ending)
                if ending == "stl":
                    self.assertIsNone(again.colours)
                    self.assertIn("colours", str(told[0].message))
                    self.assertEqual(told[0].category, sculptd.LossWarning)
                    self.assertEqual(told[0].filename, __file__)
                else:
                    self.assertEqual(told, [])
                    np.testing.assert_array_equal(in_order(again), in_order(mesh))

    def test_opacity_comes_back_or_is_warned_of(self):
        mesh = coloured(alpha=77)
        for ending in ("ply", "off", "glb", "3mf"):
            file = io.BytesIO()
            mesh.write(file, ending, strict=ending != "glb")
            again = sculptd.read(io.BytesIO(file.getvalue()), format=ending)
            np.testing.assert_array_equal(in_order(again), in_order(mesh), ending)
        with self.assertWarnsRegex(sculptd.LossWarning, "opacity"):
            mesh.write(io.BytesIO(), "obj")

    def test_strict_writes_nothing_where_something_is_lost(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "part.stl"
            with self.assertRaisesRegex(sculptd.LossWarning, "colours"):
                coloured().write(path, strict=True)
            self.assertFalse(path.exists())
            box = Mesh.box((0, 0, 0), (1, 2, 3))
            with self.assertRaisesRegex(sculptd.LossWarning, "polygons"):
                box.write(path, strict=True)
            with self.assertRaisesRegex(sculptd.LossWarning, "single precision"):
                box.triangulated().transformed(scale=0.1).write(path, strict=True)
            self.assertFalse(path.exists())
            box.triangulated().write(path, strict=True)
            sculptd.read(path, strict=True)

    def test_visible_rounding_is_warned_of_and_cut_polygons_are_not(self):
        box = Mesh.box((0, 0, 0), (0.1, 0.2, 0.3))
        far = box.triangulated().transformed(offset=(1e6, 0, 0))
        for ending in ("stl", "glb", "3mf"):
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                box.write(io.BytesIO(), ending)
            with self.assertRaisesRegex(sculptd.LossWarning, "polygons"):
                box.write(io.BytesIO(), ending, strict=True)
        for ending in ("stl", "glb"):
            with self.assertWarnsRegex(sculptd.LossWarning, "single precision"):
                far.write(io.BytesIO(), ending)
        for ending in ("obj", "ply", "off", "3mf"):
            far.write(io.BytesIO(), ending, strict=True)

    def test_an_offset_warns_that_it_has_no_colours(self):
        with self.assertWarnsRegex(sculptd.LossWarning, "colours"):
            sculptd.offset(coloured(), 0.5, side=24)

    def test_groups_have_names(self):
        text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ng base\nf 1 2 3\ng side\nf 1 4 2\n"
        mesh = sculptd.read(io.BytesIO(text), format="obj")
        self.assertEqual([mesh.group_names[g] for g in mesh.groups], ["base", "side"])
        made = Mesh(mesh.vertices, mesh.faces, groups=[0, 1], group_names=["base", "side"])
        self.assertEqual((list(made.groups), made.group_names), ([0, 1], ["base", "side"]))
        with self.assertRaisesRegex(ValueError, "groups: expected shape"):
            Mesh(mesh.vertices, mesh.faces, groups=[0])


class Numbers(unittest.TestCase):
    def test_points_that_are_no_numbers_are_refused_by_their_place(self):
        solid = sculptd.Solid(Mesh.sphere(1.0, 8))
        for bad in (np.nan, np.inf):
            for ask in (solid.signed_distance, solid.nearest, solid.winding):
                with self.assertRaisesRegex(ValueError, "points: entry 1 is not finite"):
                    ask([[0, 0, 0], [0, bad, 0]])

    def test_figures_are_written_as_figures(self):
        walls = sculptd.thickness(Mesh.sphere(3.0, 9))
        self.assertRegex(repr(walls), r"^<sculptd.Thickness min [0-9.]+, median [0-9.]+, max")

    def test_a_wide_rim_is_closed_only_if_asked(self):
        ball = Mesh.sphere(10.0, 40)
        bowl = Mesh(ball.vertices, ball.faces[ball.vertices[ball.faces][:, :, 2].max(1) < 5.0])
        left = sculptd.repair(bowl)
        self.assertFalse(left.is_closed)
        self.assertIn("open edges left", left.warnings[0])
        self.assertTrue(sculptd.repair(bowl, longest_hole=10_000).is_closed)


if __name__ == "__main__":
    unittest.main()
