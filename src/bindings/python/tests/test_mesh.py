"""Meshes as Python objects: operators, sizes, copies, pickles, other processes, sections."""

import copy
import multiprocessing
import pickle
import unittest

import numpy as np

import sculptd


def drilled(height):
    """Parallel work in whichever process this runs in."""
    ball = sculptd.Mesh.sphere(10.0, 24)
    return (ball - sculptd.Mesh.cylinder(3.0, height)).volume


class Operators(unittest.TestCase):
    def test_they_are_the_booleans(self):
        a = sculptd.Mesh.box([0, 0, 0], [2, 2, 2])
        b = sculptd.Mesh.box([1, 0, 0], [3, 2, 2])
        self.assertAlmostEqual((a | b).volume, 12.0)
        self.assertAlmostEqual((a & b).volume, 4.0)
        self.assertAlmostEqual((a - b).volume, 4.0)
        with self.assertRaises(TypeError):
            a - 3

    def test_sizes(self):
        box = sculptd.Mesh.box([1, 2, 3], [5, 4, 4])
        self.assertEqual((box.volume, box.area), (8.0, 28.0))
        self.assertEqual(box.bounds, ([1.0, 2.0, 3.0], [5.0, 4.0, 4.0]))
        self.assertTrue(box.is_closed)
        open_box = sculptd.Mesh(box.vertices, box.faces[:-1])
        self.assertFalse(open_box.is_closed)
        with self.assertRaisesRegex(ValueError, "not closed"):
            open_box.volume

    def test_sizes_are_in_double_precision_at_any_scale(self):
        for scale in (1e-12, 1.0, 1e12):
            box = sculptd.Mesh.box([1 / 3] * 3, [4 / 3 + 1e-9] * 3).transformed(scale)
            side = 1.0 + 1e-9
            self.assertAlmostEqual(box.volume / scale**3 / side**3, 1.0, delta=1e-14)
            measured = sculptd.measure(box)
            self.assertAlmostEqual(measured["area"] / scale**2 / (6 * side**2), 1.0, delta=1e-14)

    def test_a_matrix_that_mirrors_keeps_a_solid(self):
        box = sculptd.Mesh.box([0, 0, 0], [1, 2, 3])
        mirror = np.diag([-1.0, 2.0, 1.0, 1.0])
        mirror[0, 3] = 5.0
        turned = box.transformed(matrix=mirror)
        self.assertEqual((turned.volume, turned.bounds[0]), (12.0, [4.0, 0.0, 0.0]))
        for bad in (np.zeros((4, 4)), np.full((4, 4), np.nan), np.ones((4, 4))):
            with self.assertRaises(ValueError):
                box.transformed(matrix=bad)


class Copies(unittest.TestCase):
    def test_a_pickle_has_the_same_bits(self):
        ball = sculptd.Mesh.sphere(3.0, 9)
        colours = np.arange(4 * len(ball.vertices)).reshape(-1, 4) % 256
        mesh = sculptd.Mesh(ball.vertices, ball.faces, colours=colours)
        for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
            again = pickle.loads(pickle.dumps(mesh, protocol))
            self.assertEqual(again.vertices.tobytes(), mesh.vertices.tobytes())
            self.assertEqual(again.faces.tobytes(), mesh.faces.tobytes())
            self.assertEqual(again.colours.tobytes(), mesh.colours.tobytes())
            self.assertEqual(again, mesh)
            self.assertEqual(hash(again), hash(mesh))

    def test_equality_is_by_content(self):
        a, b = sculptd.Mesh.sphere(3.0, 4), sculptd.Mesh.sphere(3.0, 4)
        self.assertEqual(a, b)
        self.assertEqual(len({a, b, copy.copy(a), copy.deepcopy(b)}), 1)
        self.assertNotEqual(a, sculptd.Mesh.sphere(3.0, 5))
        self.assertNotEqual(a, "a mesh")
        below = sculptd.Mesh([[-0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        above = sculptd.Mesh([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        self.assertNotEqual(below, above, "equal meshes would need equal hashes")

    def test_a_damaged_pickle_is_refused(self):
        bytes_of = pickle.dumps(sculptd.Mesh.sphere(1.0, 2), 2)
        restore, (content,) = sculptd.Mesh.sphere(1.0, 2).__reduce__()
        for cut in (0, 1, len(content) // 2, len(content) - 1):
            with self.assertRaises(ValueError):
                restore(content[:cut])
        self.assertGreater(len(bytes_of), len(content) // 2)

    def test_a_notebook_has_a_picture(self):
        self.assertTrue(sculptd.Mesh.sphere(1.0, 8)._repr_png_().startswith(b"\x89PNG"))


class Processes(unittest.TestCase):
    def test_every_way_to_start_a_process(self):
        here = drilled(30.0)
        for method in ("fork", "spawn", "forkserver"):
            with self.subTest(method=method), multiprocessing.get_context(method).Pool(2) as pool:
                there = pool.map_async(drilled, [30.0] * 4).get(timeout=120)
                self.assertEqual(there, [here] * 4)


class Sections(unittest.TestCase):
    def test_a_drilled_box(self):
        box = sculptd.Mesh.box([0, 0, 0], [40, 30, 20])
        hole = sculptd.Mesh.box([10, 10, -1], [20, 20, 21])
        part = box - hole
        below, half, above = sculptd.sections(part, [0, 0, 1], [-1.0, 10.0, 21.0])
        self.assertEqual((below["area"], above["contours"]), (0.0, []))
        self.assertIsNone(below["centroid"])
        self.assertAlmostEqual(half["area"], 1100.0)
        self.assertAlmostEqual(half["perimeter"], 180.0)
        self.assertEqual((len(half["contours"]), half["open"]), (2, []))
        centre = (np.array([20.0, 15.0]) * 1200 - np.array([15.0, 15.0]) * 100) / 1100
        np.testing.assert_allclose(half["centroid"][:2], centre)

    def test_a_doubled_face_is_measured_apart_from_the_perimeter(self):
        box = sculptd.Mesh.box([0, 0, 0], [4, 4, 4]).triangulated()
        low, high = (int(np.flatnonzero((box.vertices == p).all(1))[0]) for p in [(4, 4, 0), (4, 4, 4)])
        vertices = np.vstack([box.vertices, [[6, 6, 1]]])
        faces = np.vstack([box.faces, [[low, high, len(box.vertices)], [high, low, len(box.vertices)]]])
        (cut,) = sculptd.sections(sculptd.Mesh(vertices, faces), [0, 0, 1], [2.0])
        self.assertAlmostEqual(cut["perimeter"], 16.0)
        self.assertAlmostEqual(cut["folded"], 2 * 4 / 3 * 2**0.5)

    def test_the_bottom_and_the_top_of_a_box_have_its_outline(self):
        box = sculptd.Mesh.box([0, 0, 0], [40, 30, 20])
        for cut in sculptd.sections(box, [0, 0, 1], [0.0, 10.0, 20.0]):
            self.assertEqual((cut["area"], cut["perimeter"], cut["turned"]), (1200.0, 140.0, 0.0))
        for cut in sculptd.sections(box, [0, 0, 1], [-1e-9, 20.0 + 1e-9]):
            self.assertEqual((cut["area"], cut["contours"]), (0.0, []))

    def test_turned_faces_leave_the_area_and_are_measured(self):
        box = sculptd.Mesh.box([0, 0, 0], [4, 4, 4]) - sculptd.Mesh.box([1, 1, -1], [2, 2, 5])
        faces = box.triangulated().faces.copy()
        faces[::3] = faces[::3, ::-1]
        (cut,) = sculptd.sections(sculptd.Mesh(box.vertices, faces), [0, 0, 1], [1.75])
        self.assertAlmostEqual(cut["area"], 15.0)
        self.assertAlmostEqual(cut["perimeter"], 20.0)
        self.assertTrue(0.0 < cut["turned"] < 20.0)

    def test_an_open_mesh_says_where_it_is_open(self):
        box = sculptd.Mesh.box([0, 0, 0], [2, 2, 2])
        front = [f for f in box.faces if not np.all(box.vertices[f][:, 0] == 2.0)]
        (cut,) = sculptd.sections(sculptd.Mesh(box.vertices, front), [0, 0, 1], [1.0])
        self.assertEqual((len(cut["contours"]), len(cut["open"])), (0, 1))


class PartCheck(unittest.TestCase):
    def test_a_table_has_a_bridge_too_wide(self):
        slab = sculptd.Mesh.box([0, 0, 20], [80, 20, 24])
        legs = [sculptd.Mesh.box([x, 0, 0], [x + 6, 20, 20]) for x in (0, 74)]
        table = slab | legs[0] | legs[1]
        answer = sculptd.check(table, process="fdm")
        bridges = [f for f in answer["findings"] if f["kind"] == "bridge"]
        self.assertFalse(answer["ok"])
        self.assertAlmostEqual(bridges[0]["value"], 68.0, delta=0.68)
        self.assertTrue(sculptd.check(sculptd.Mesh.box([0] * 3, [20] * 3), process="fdm")["ok"])

    def test_units_and_names(self):
        box = sculptd.Mesh.box([0, 0, 0], [1, 1, 1])
        inch = sculptd.check(box, process="fdm", scale=25.4)
        self.assertAlmostEqual(inch["volume"], 25.4**3, delta=0.1)
        for bad in ({"process": "glass"}, {"printer": "x"}, {"process": "fdm", "up": [0, 0, 0]}):
            with self.assertRaises(ValueError):
                sculptd.check(box, **bad)


if __name__ == "__main__":
    unittest.main()
