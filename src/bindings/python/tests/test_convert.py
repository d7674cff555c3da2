"""Meshes and results for other libraries; each test is skipped where its library is not."""

import importlib
import os
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

import numpy as np
import sculptd
from sculptd import Mesh, convert


def needs(library):
    try:
        importlib.import_module(library)
    except ImportError:
        return unittest.skip(f"{library} is not installed")
    return lambda test: test


def parts(alpha):
    """Coloured triangles in two groups with names."""
    box = Mesh.box((0, 0, 0), (1, 2, 3)).triangulated()
    colours = np.arange(len(box.vertices) * 4).reshape(-1, 4) * 7 % 256
    colours[:, 3] = alpha
    groups = [0] * 6 + [1] * 6
    names = ["base", "side"]
    return Mesh(box.vertices, box.faces, colours=colours, groups=groups, group_names=names)


class Libraries(unittest.TestCase):
    def there_and_back(self, there, back, groups, alpha):
        mesh = parts(alpha)
        again = back(there(mesh))
        np.testing.assert_array_equal(again.vertices, mesh.vertices)
        np.testing.assert_array_equal(again.faces, mesh.faces)
        np.testing.assert_array_equal(again.colours, mesh.colours)
        if groups:
            np.testing.assert_array_equal(again.groups, mesh.groups)
            self.assertEqual(again.group_names, mesh.group_names)
        plain = Mesh.box((0, 0, 0), (1, 1, 1))
        self.assertEqual(back(there(plain)), plain.triangulated())

    @needs("trimesh")
    def test_trimesh(self):
        self.there_and_back(convert.to_trimesh, convert.from_trimesh, True, 200)

    @needs("pyvista")
    def test_pyvista(self):
        self.there_and_back(convert.to_pyvista, convert.from_pyvista, True, 200)

    @needs("open3d")
    def test_open3d(self):
        with self.assertWarnsRegex(sculptd.LossWarning, "groups"):
            self.there_and_back(convert.to_open3d, convert.from_open3d, False, 255)

    @needs("pandas")
    def test_pandas(self):
        plate = sculptd.subdivide(Mesh.box((0, 0, 0), (20, 20, 2)), 3, scheme="catmull-clark")
        places = convert.to_pandas(sculptd.thickness(plate).worst(5.0))
        self.assertEqual(list(places), ["x", "y", "z", "thickness", "area"])
        self.assertGreater(len(places), 0)
        cuts = convert.to_pandas(sculptd.sections(plate, (0, 0, 1), [0.5, 1.0]))
        self.assertEqual(len(cuts), 2)
        self.assertIn("centroid_x", cuts)
        findings = sculptd.check(plate, process="fdm", printer=None)["findings"]
        self.assertEqual(len(convert.to_pandas(findings)), len(findings))


class Notebook(unittest.TestCase):
    def test_html_has_a_picture_and_facts(self):
        whole = ElementTree.fromstring(Mesh.box((0, 0, 0), (1, 2, 3))._repr_html_())
        facts = {row[0].text: row[1].text for row in whole.iter("tr")}
        self.assertEqual((facts["faces"], facts["volume"]), ("6", "6"))
        self.assertTrue(whole.find("img").get("src").startswith("data:image/png;base64,"))
        ball = Mesh.sphere(1.0, 4)
        self.assertIn("the mesh is open", Mesh(ball.vertices, ball.faces[1:])._repr_html_())

    @needs("pyvista")
    def test_a_plot_is_drawn(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "plot.png")
            parts(255).plot(off_screen=True, screenshot=path)
            self.assertGreater(os.path.getsize(path), 1000)


if __name__ == "__main__":
    unittest.main()
