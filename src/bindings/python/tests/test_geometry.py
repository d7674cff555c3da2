"""The module over meshes whose answers are known."""

import gc
import json
import math
import os
import pathlib
import signal
import subprocess
import tempfile
import threading
import time
import unittest

import numpy as np
import sculptd
from sculptd import Mesh

BINARY = os.environ.get("SCULPTD_BINARY")


def address(array):
    return array.__array_interface__["data"][0]


def cubes():
    return Mesh.box((0, 0, 0), (2, 2, 2)), Mesh.box((1, 1, 1), (3, 3, 3))


class Arrays(unittest.TestCase):
    def test_arrays_share_the_memory_of_the_mesh(self):
        mesh = Mesh.sphere(1.0, 16)
        first, second = mesh.vertices, mesh.vertices
        self.assertIsNot(first, second)
        self.assertEqual(address(first), address(second))
        self.assertEqual(address(mesh.faces), address(mesh.corners))
        self.assertTrue(np.shares_memory(first, second))
        self.assertEqual((first.dtype, first.shape), (np.float64, (2562, 3)))
        self.assertEqual((mesh.faces.dtype, mesh.faces.shape), (np.uint32, (5120, 3)))

    def test_a_result_s_arrays_are_those_that_rust_made(self):
        made = sculptd.boolean(*cubes(), "union")
        self.assertEqual(address(made.mesh.vertices), address(made.mesh.vertices))
        self.assertEqual(address(made.face), address(made.face))
        walls = sculptd.thickness(made.mesh)
        self.assertEqual(address(walls.values), address(walls.values))

    def test_arrays_are_read_only_and_outlive_the_mesh(self):
        mesh = Mesh.sphere(1.0, 40)
        vertices = mesh.vertices
        with self.assertRaises(ValueError):
            vertices[0, 0] = 9.0
        before = vertices.sum()
        del mesh
        gc.collect()
        fill = [np.full((100_000, 3), 7.0) for _ in range(8)]
        self.assertEqual(vertices.sum(), before)
        self.assertEqual(len(fill), 8)

    def test_a_mesh_from_arrays(self):
        box = Mesh.box((0, 0, 0), (1, 2, 3)).triangulated()
        for kind in (np.int64, np.uint32, np.int32):
            copy = Mesh(box.vertices.tolist(), box.faces.astype(kind))
            np.testing.assert_array_equal(copy.vertices, box.vertices)
            np.testing.assert_array_equal(copy.faces, box.faces)
        mixed = Mesh(np.eye(4, 3), [0, 1, 2, 0, 1, 2, 3], face_starts=[0, 3, 7])
        self.assertEqual(len(mixed), 2)
        with self.assertRaises(ValueError):
            mixed.faces
        self.assertEqual(mixed.triangulated().faces.shape, (3, 3))

    def test_wrong_arrays_are_refused_by_name_and_place(self):
        points = np.eye(3)
        for error, text, arguments in [
            (IndexError, "faces: entry 1 is 3", (points, [[0, 1, 2], [0, 1, 3]])),
            (IndexError, "faces: entry 0 is -1", (points, [[0, 1, -1]])),
            (TypeError, "faces: expected integers", (points, [[0.0, 1.0, 2.0]])),
            (ValueError, "vertices: expected an array of shape", (np.zeros((3, 2)), [[0, 1, 2]])),
            (ValueError, "vertices: entry 2", ([[0, 0, 0], [1, 0, 0], [0, math.nan, 0]], [])),
            (ValueError, "face_starts", (points, [0, 1, 2], [0, 2])),
        ]:
            with self.assertRaisesRegex(error, text):
                Mesh(*arguments)


class Files(unittest.TestCase):
    def test_every_format_keeps_the_solid(self):
        part = Mesh.box((0, 0, 0), (4, 5, 6))
        with tempfile.TemporaryDirectory() as folder:
            for ending in ("obj", "stl", "ply", "off", "glb", "3mf"):
                path = pathlib.Path(folder) / f"part.{ending}"
                part.write(path)
                again = sculptd.read(path)
                self.assertIsNotNone(again.format)
                self.assertAlmostEqual(sculptd.measure(again)["volume"], 120.0, places=4)

    def test_an_error_has_its_place_and_its_reason(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "bad.obj")
            with open(path, "w") as out:
                out.write("v 0 0 0\nv 1 0 0\nv 0 1 x\nf 1 2 3\n")
            with self.assertRaises(sculptd.FileFormatError) as caught:
                sculptd.read(path)
            e = caught.exception
            self.assertEqual((e.path, e.line, e.byte), (path, 3, None))
            self.assertIn("x", e.found)
            self.assertTrue(e.expected)
            with self.assertRaises(FileNotFoundError) as caught:
                sculptd.read(os.path.join(folder, "absent.stl"))
            self.assertTrue(caught.exception.filename.endswith("absent.stl"))
            with self.assertRaisesRegex(ValueError, "ends in .obj"):
                Mesh.sphere(1, 2).write(os.path.join(folder, "part.txt"))


class Booleans(unittest.TestCase):
    def test_four_results_and_their_volumes(self):
        results = sculptd.boolean_all(*cubes())
        volumes = {name: round(r.volume, 9) for name, r in results.items()}
        self.assertEqual(
            volumes,
            {"union": 15, "intersection": 1, "difference": 7, "reverse-difference": 7},
        )
        self.assertTrue(all(r.closed and r.manifold for r in results.values()))

    def test_every_face_has_an_origin_in_an_operand(self):
        a, b = cubes()
        made = sculptd.boolean(a, b, "difference", faces="triangles")
        vertices, faces = made.mesh.vertices, made.mesh.faces
        self.assertEqual(len(made.operand), len(faces))
        for corners, operand, face in zip(faces, made.operand, made.face):
            origin = (a, b)[operand]
            plane = origin.vertices[origin.faces[face]]
            normal = np.cross(plane[1] - plane[0], plane[2] - plane[0])
            away = (vertices[corners] - plane[0]) @ normal
            np.testing.assert_allclose(away, 0.0, atol=1e-12)
        self.assertEqual(set(made.operand), {0, 1})

    def test_a_list_is_joined_one_after_another(self):
        row = [Mesh.box((x, 0, 0), (x + 1, 1, 1)) for x in range(8)]
        made = sculptd.union(row)
        self.assertEqual((made.volume, made.components), (8.0, 1))
        self.assertTrue(made.closed and made.manifold)
        self.assertEqual(set(made.operand), set(range(8)))
        drilled = sculptd.boolean(made.mesh, row[2:5], "difference")
        self.assertEqual((drilled.volume, drilled.components), (5.0, 2))
        self.assertEqual(sculptd.union(row[:1]).mesh.volume, 1.0)
        with self.assertRaises(ValueError):
            sculptd.union([])
        with self.assertRaises(TypeError):
            sculptd.union([1, 2])
        many = sculptd.union([Mesh.box((x, 0, 0), (x + 1, 1, 1)) for x in range(300)])
        self.assertEqual((many.volume, many.operand.dtype), (300.0, np.uint32))

    def test_every_state_of_a_part_stays_as_it_was(self):
        part = Mesh.box((0, 0, 0), (10, 1, 1))
        states = [part]
        for x in range(8):
            part = part - Mesh.box((x + 0.5, -1, -1), (x + 1, 2, 2))
            states.append(part)
        for n, state in enumerate(states):
            self.assertAlmostEqual(state.volume, 10 - 0.5 * n, places=12)
        # On from the middle, once more.
        other = states[3] | Mesh.box((20, 0, 0), (21, 1, 1))
        self.assertAlmostEqual(other.volume, 9.5, places=12)
        self.assertAlmostEqual((other - states[1]).volume, 1.0, places=12)
        self.assertAlmostEqual(states[8].volume, 6.0, places=12)
        self.assertTrue(all(s.is_closed for s in [*states, other]))

    def test_an_open_operand_is_named(self):
        a, _ = cubes()
        open_ = Mesh(a.vertices, a.faces[1:])
        with self.assertRaises(sculptd.BooleanFailed) as caught:
            sculptd.boolean(a, open_, "union")
        e = caught.exception
        self.assertEqual((e.operand, e.kind, e.edges), ("B", "open", 4))

    def test_a_tolerance_joins_what_nearly_touches(self):
        a = Mesh.box((0, 0, 0), (1, 1, 1))
        b = Mesh.box((1 + 1e-6, 0, 0), (2, 1, 1))
        self.assertEqual(sculptd.boolean(a, b, tolerance=0.0).components, 2)
        self.assertEqual(sculptd.boolean(a, b, tolerance=1e-4).components, 1)
        with self.assertRaisesRegex(ValueError, "operation: expected one of union"):
            sculptd.boolean(a, b, "add")

    def test_slices(self):
        ball = Mesh.sphere(5.0, 24)
        (middle,), (high,), none = sculptd.slices(ball, (0, 0, 1), [0.1, 3.0, 9.0])
        radius = np.linalg.norm(middle[:, :2], axis=1)
        np.testing.assert_allclose(middle[:, 2], 0.1, atol=1e-9)
        np.testing.assert_allclose(radius, 5.0, atol=0.03)
        np.testing.assert_allclose(np.linalg.norm(high[:, :2], axis=1), 4.0, atol=0.03)
        self.assertEqual(none, [])
        box = Mesh.box((0, 0, 0), (40, 30, 20))
        for lines in sculptd.slices(box, (0, 0, 1), [0, 1e-9, 5, 20]):
            (line,) = lines
            np.testing.assert_array_equal(line[0], line[-1])
            self.assertAlmostEqual(np.linalg.norm(np.diff(line, axis=0), axis=1).sum(), 140)
        with self.assertRaisesRegex(ValueError, "the normal not zero"):
            sculptd.slices(box, (0, 0, 0), [1])


class Questions(unittest.TestCase):
    def test_thickness_of_a_plate(self):
        plate = sculptd.remesh(Mesh.box((0, 0, 0), (20, 20, 2)), side=64, sharp=True)
        walls = sculptd.thickness(plate)
        self.assertEqual(walls.values.shape, (len(plate.vertices),))
        self.assertAlmostEqual(walls.median, 2.0, delta=0.05)
        self.assertIs(walls.reaches(1.5), True)
        self.assertIs(walls.reaches(2.5), False)
        self.assertAlmostEqual(walls.least["lower"], walls.min, delta=1e-3)
        area, share = walls.below(3.0)
        # Both sides, facet by facet.
        self.assertTrue(780 < area < 805, area)
        self.assertAlmostEqual(area / share, 960.0, delta=2.0)
        self.assertEqual(walls.below(0.5), (0.0, 0.0))
        worst = walls.worst(3.0)[0]
        self.assertLess(worst.thickness, 3.0)
        self.assertEqual(set(walls.summary()) & {"min", "histogram"}, {"min", "histogram"})
        balls = sculptd.thickness(plate, method="sphere")
        self.assertAlmostEqual(balls.median, 2.0, delta=0.05)
        self.assertLessEqual(balls.min, balls.median)
        faces = sculptd.thickness(plate, method="cone", faces=True)
        self.assertGreater(faces.face_values.size, len(plate.vertices))
        with self.assertRaisesRegex(ValueError, "rays"):
            sculptd.thickness(plate, rays=0)

    @unittest.skipUnless(BINARY, "SCULPTD_BINARY is not set")
    def test_the_command_and_the_module_measure_the_same_walls(self):
        ball, rod = Mesh.sphere(10.0, 24), Mesh.cylinder(3.0, 40.0)
        box = Mesh.box((0, 0, 0), (20, 12, 4))
        solids = [ball, box, rod, ball - rod, box - Mesh.box((5, 3, 2), (15, 9, 9))]
        parts = []
        for n, solid in enumerate(solids * 4):
            # A turn by a quarter and a third of one, a scale, a shift.
            turns = ([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
                     [[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]], [[1, 0, 0], [0, 0.28, -0.96], [0, 0.96, 0.28]])
            turn = np.array(turns[n // 5]) * (1 + n % 3)
            vertices = solid.vertices @ turn.T + [0.1 * n, 0, 0]
            parts.append(Mesh(vertices, solid.triangulated().faces))
        compared = 0
        with tempfile.TemporaryDirectory() as folder:
            for n, part in enumerate(parts):
                file = pathlib.Path(folder) / f"part-{n}.off"
                part.write(file)
                for method in ("ray", "cone", "sphere"):
                    limit = 2.5
                    told = subprocess.run(
                        [BINARY, "thickness", file, "--method", method, "--warn-below", str(limit), "--json"],
                        capture_output=True, text=True, check=True,
                    )
                    told = json.loads(told.stdout)
                    walls = sculptd.thickness(sculptd.read(file), method=method)
                    summary = walls.summary()
                    for name in ("min", "max", "mean", "median", "valid", "histogram", "error_bound"):
                        self.assertEqual(told[name], summary[name], (n, method, name))
                    share = 100 * walls.below(limit)[1]
                    self.assertAlmostEqual(told["below"]["area_percent"], share, 9, (n, method))
                    compared += 1
        self.assertEqual(compared, 60)

    def test_distance_inside_and_outside(self):
        solid = sculptd.Solid(Mesh.box((0, 0, 0), (2, 2, 2)))
        at = [[1, 1, 1], [1, 1, 1.75], [5, 1, 1]]
        np.testing.assert_allclose(solid.signed_distance(at), [-1.0, -0.25, 3.0])
        places, triangles = solid.nearest(at)
        np.testing.assert_allclose(places[2], [2, 1, 1])
        self.assertLess(triangles.max(), 12)
        np.testing.assert_allclose(solid.winding(at), [1, 1, 0], atol=1e-9)
        far = Mesh.box((1e7, 0, 0), (1e7 + 2, 2, 2))
        found = sculptd.signed_distance(far, [[1e7 + 3, 1, 1]])
        np.testing.assert_allclose(found, [1.0], atol=1e-6)

    def test_measure_check_and_projection(self):
        part = Mesh.box((10, 20, 30), (11, 22, 33))
        m = sculptd.measure(part)
        self.assertAlmostEqual(m["volume"], 6.0)
        self.assertAlmostEqual(m["area"], 22.0)
        np.testing.assert_allclose(m["dimensions"], [1, 2, 3])
        np.testing.assert_allclose(m["centroid"], [10.5, 21, 31.5])
        facts = sculptd.check(part)
        self.assertTrue(facts["closed"] and facts["manifold"])
        self.assertEqual(facts["self_intersections"], 0)
        shadow = sculptd.project(part, (0, 0, -1))
        self.assertAlmostEqual(shadow.area, 2.0, places=6)
        ((outer, holes),) = shadow.regions
        self.assertEqual(holes, [])
        u, v = (np.array(a) for a in shadow.axes)
        space = outer @ np.stack([u, v])
        np.testing.assert_allclose(space[:, :2].min(axis=0), [10, 20], atol=1e-6)
        np.testing.assert_allclose(space[:, :2].max(axis=0), [11, 22], atol=1e-6)

    def test_another_mesh_of_the_same_solid(self):
        ball = Mesh.sphere(10.0, 24)
        volume = sculptd.measure(ball)["volume"]
        fine = sculptd.remesh(ball, side=48)
        self.assertAlmostEqual(sculptd.measure(fine)["volume"] / volume, 1.0, delta=0.01)
        grown = sculptd.offset(ball, 1.0, side=48)
        self.assertAlmostEqual(grown.vertices[:, 0].max(), 11.0, delta=0.05)
        shell = sculptd.hollow(ball, 2.0, side=48)
        inner = 4 / 3 * math.pi * 8**3
        self.assertAlmostEqual(sculptd.measure(shell)["volume"] / (volume - inner), 1.0, delta=0.05)
        with self.assertRaises(sculptd.EmptyResult):
            sculptd.hollow(ball, 11.0, side=48)
        few = sculptd.decimate(ball, 500)
        self.assertLessEqual(len(few), 500)
        self.assertTrue(sculptd.check(few)["closed"])
        self.assertEqual(len(sculptd.subdivide(few)), 4 * len(few))
        quads = sculptd.subdivide(Mesh.box((0, 0, 0), (1, 1, 1)), 2, scheme="catmull-clark")
        self.assertEqual(quads.faces.shape, (96, 4))

    def test_places_are_where_the_mesh_has_them(self):
        part = Mesh.box((100, 200, 300), (140, 230, 320))
        walls = sculptd.thickness(part)
        answer = walls.judge("fdm")
        low, high = np.array(part.bounds)
        for name in ("thinnest", "thickest"):
            place = np.array(answer[name])
            self.assertTrue(((low - 1e-3 <= place) & (place <= high + 1e-3)).all(), (name, place))
        np.testing.assert_allclose(answer["thinnest"], answer["least"]["position"], atol=1e-3)

    def test_a_part_is_divided_by_its_walls(self):
        thin = Mesh.box((0, 0, 0), (31, 40, 2))
        part = thin | Mesh.box((30, 0, 0), (60, 40, 5))
        fine = sculptd.remesh(part, side=120, sharp=True)
        with self.assertRaisesRegex(ValueError, "faces=True"):
            sculptd.thickness(fine).parts()
        of, answer = sculptd.thickness(fine, faces=True).parts(levels=3)
        self.assertEqual(len(of), len(fine))
        large = sorted(round(p["median"], 1) for p in answer["parts"][:2])
        self.assertEqual(large, [2.0, 5.0])
        with self.assertRaises(ValueError):
            sculptd.thickness(fine, faces=True).parts(levels=17)

    def test_a_ring_has_one_closed_line(self):
        turn, tube = np.mgrid[0:160, 0:32].reshape(2, -1)
        u, v = 2 * np.pi * turn / 160, 2 * np.pi * tube / 32
        out = 20 + 3 * np.cos(v)
        places = np.stack([out * np.cos(u), out * np.sin(u), 3 * np.sin(v)], axis=1)
        at = lambda i, j: (i % 160) * 32 + j % 32
        quads = [at(turn, tube), at(turn + 1, tube), at(turn + 1, tube + 1), at(turn, tube + 1)]
        ring = Mesh(places, np.stack(quads, axis=1))
        curve = sculptd.thickness(ring, method="sphere", faces=True).medial_curve()
        (line,) = curve["branches"]
        self.assertAlmostEqual(line["length"], 2 * np.pi * 20, delta=0.03 * 2 * np.pi * 20)
        with self.assertRaisesRegex(ValueError, "sphere"):
            sculptd.thickness(ring, faces=True).medial_curve()

    def test_walls_are_judged_as_the_command_does(self):
        plate = Mesh.box((0, 0, 0), (40, 40, 0.7))
        walls = sculptd.thickness(plate)
        for settings, verdict in [
            ({"preset": "fdm"}, "fail"),
            ({"fail_below": 0.5, "warn_below": 0.6}, "pass"),
            ({"fail_below": 0.5, "warn_below": 0.8}, "warn"),
            ({"fail_below": 0.5, "fail_above": 0.6}, "fail"),
            ({}, "unjudged"),
        ]:
            answer = walls.judge(**settings)
            self.assertEqual(answer["verdict"], verdict, settings)
        self.assertAlmostEqual(walls.judge("fdm")["least"]["upper"], 0.7, delta=1e-4)
        for bad in ({"preset": "glass"}, {"fail_below": 0.0}):
            with self.assertRaises(ValueError):
                walls.judge(**bad)

    def test_repair_closes_and_turns(self):
        box = Mesh.box((0, 0, 0), (1, 1, 1)).triangulated()
        faces = box.faces.copy()
        faces[3] = faces[3][::-1]
        broken = Mesh(box.vertices, faces[:-1])
        self.assertFalse(sculptd.check(broken)["closed"])
        sound = sculptd.repair(broken)
        facts = sculptd.check(sound)
        self.assertTrue(facts["closed"] and facts["oriented"])
        self.assertAlmostEqual(facts["volume"], 1.0)
        self.assertTrue(any("holes closed" in w for w in sound.warnings), sound.warnings)

    def test_a_picture(self):
        ball = Mesh.sphere(10.0, 8)
        plain = sculptd.picture(ball, width=80, height=60)
        self.assertEqual(plain[:8], b"\x89PNG\r\n\x1a\n")
        coloured = sculptd.picture(ball, thickness=sculptd.thickness(ball), width=80, height=60)
        self.assertNotEqual(plain, coloured)


class LongWork(unittest.TestCase):
    def setUp(self):
        self.big = Mesh.sphere(10.0, 64)

    def test_progress_is_told_and_ends_at_one(self):
        told = []
        sculptd.thickness(self.big, progress=told.append)
        self.assertEqual(told[-1], 1.0)
        self.assertEqual(told, sorted(told))
        told = []
        sculptd.remesh(Mesh.sphere(10.0, 40), side=128, sharp=True, progress=told.append)
        self.assertEqual(told, sorted(told))

    def test_an_exception_of_progress_cancels(self):
        class Enough(Exception):
            pass

        def progress(_):
            raise Enough

        with self.assertRaises(Enough):
            sculptd.thickness(self.big, method="cone", rays=500, progress=progress)

    def test_the_interpreter_runs_meanwhile(self):
        ticks = []
        stop = threading.Event()

        def count():
            while not stop.is_set():
                ticks.append(time.monotonic())
                time.sleep(0.005)

        thread = threading.Thread(target=count)
        thread.start()
        start = time.monotonic()
        sculptd.thickness(self.big, method="cone", rays=200)
        took = time.monotonic() - start
        stop.set()
        thread.join()
        during = sum(start < t < start + took for t in ticks)
        # Without the lock the other thread ticks all the time, with it once.
        self.assertGreater(during, min(took / 0.2, 5))

    def test_an_interrupt_stops_the_work(self):
        # A program that a shell has put into the background is begun with interrupts ignored.
        before = signal.signal(signal.SIGINT, signal.default_int_handler)
        self.addCleanup(signal.signal, signal.SIGINT, before)
        main = threading.main_thread().ident
        timer = threading.Timer(0.2, lambda: signal.pthread_kill(main, signal.SIGINT))
        timer.start()
        start = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            sculptd.thickness(self.big, method="cone", rays=1000)
        self.assertLess(time.monotonic() - start, 20.0)
        timer.join()


if __name__ == "__main__":
    unittest.main()
