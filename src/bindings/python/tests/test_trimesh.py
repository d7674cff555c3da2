"""sculptd as an engine of trimesh; skipped where trimesh is not installed."""

import unittest

try:
    import trimesh
except ImportError:
    raise unittest.SkipTest("trimesh is not installed") from None

import numpy as np
import sculptd
import sculptd.trimesh_engine
from sculptd.convert import from_trimesh, to_trimesh


class Engine(unittest.TestCase):
    def setUp(self):
        self.a = trimesh.creation.icosphere(subdivisions=3)
        self.b = trimesh.creation.box(extents=(1, 1, 4))

    def test_it_is_registered(self):
        self.assertIn("sculptd", trimesh.boolean._engines)

    def test_volumes_add_up(self):
        volume = {
            what: getattr(trimesh.boolean, what)([self.a, self.b], engine="sculptd")
            for what in ("union", "intersection", "difference")
        }
        self.assertTrue(all(m.is_volume for m in volume.values()))
        union, both, less = (volume[k].volume for k in ("union", "intersection", "difference"))
        self.assertAlmostEqual(union + both, self.a.volume + self.b.volume, places=9)
        self.assertAlmostEqual(less + both, self.a.volume, places=9)

    def test_many_operands(self):
        balls = [trimesh.creation.icosphere(subdivisions=2) for _ in range(5)]
        for i, ball in enumerate(balls):
            ball.apply_translation([1.5 * i, 0.1 * i, 0])
        made = trimesh.boolean.union(balls, engine="sculptd")
        self.assertTrue(made.is_volume)
        self.assertEqual(made.body_count, 1)
        left = trimesh.boolean.difference(balls, engine="sculptd")
        self.assertLess(left.volume, balls[0].volume)

    def test_colours_are_kept(self):
        self.a.visual = trimesh.visual.ColorVisuals(self.a, vertex_colors=(200, 40, 40, 255))
        self.b.visual = trimesh.visual.ColorVisuals(self.b, vertex_colors=(40, 40, 200, 255))
        made = trimesh.boolean.union([self.a, self.b], engine="sculptd")
        found = {tuple(c) for c in np.asarray(made.visual.vertex_colors)}
        self.assertEqual(found, {(200, 40, 40, 255), (40, 40, 200, 255)})

    def test_what_is_no_volume_is_refused(self):
        sheet = trimesh.Trimesh(np.eye(3), [[0, 1, 2]])
        with self.assertRaises(ValueError):
            trimesh.boolean.union([self.a, sheet], engine="sculptd")
        with self.assertRaises(sculptd.BooleanFailed):
            trimesh.boolean.union([self.a, sheet], engine="sculptd", check_volume=False)

    def test_there_and_back(self):
        again = to_trimesh(from_trimesh(self.a))
        np.testing.assert_array_equal(again.vertices, self.a.vertices)
        np.testing.assert_array_equal(again.faces, self.a.faces)


if __name__ == "__main__":
    unittest.main()
