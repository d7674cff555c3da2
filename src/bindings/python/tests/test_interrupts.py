"""Ctrl-C stops every long function within 0.3 seconds, wherever in its work it comes.

A place that took longer is tried once more, because other programs may take the processor for a
moment. With SCULPTD_LONG each function is interrupted at ten places instead of two.
"""

import os
import pathlib
import signal
import tempfile
import threading
import time
import unittest

import numpy as np
import sculptd
from sculptd import Mesh

LONG = bool(os.environ.get("SCULPTD_LONG"))
PLACES = np.linspace(0.05, 0.95, 10) if LONG else (0.1, 0.5)
#: Seconds from the signal to the exception.
BOUND = 0.3
ENDINGS = ("obj", "stl", "ply", "off", "glb", "3mf")


def interrupted(work, after):
    """Seconds from a SIGINT, sent `after` seconds, to the exception; None where none came."""
    sent = []

    def send():
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(after, send)
    try:
        timer.start()
        work()
        timer.cancel()
        timer.join()
        time.sleep(0.01)
    except KeyboardInterrupt:
        return time.perf_counter() - sent[0]
    return None


class Interrupts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        ball = Mesh.sphere(50.0, 240 if LONG else 40)
        v = ball.vertices
        bumps = 1 + 0.05 * np.sin(v[:, :1] * 0.7) * np.cos(v[:, 1:2] * 0.9)
        cls.part = Mesh(v * bumps, ball.faces)
        cls.tool = cls.part.transformed(offset=(30, 7, 3))
        cls.holed = Mesh(cls.part.vertices, ball.faces[np.arange(len(ball)) % 50 != 0])
        cls.points = np.random.default_rng(1).uniform(-60, 60, (1_000_000 if LONG else 200_000, 3))
        cls.folder = tempfile.TemporaryDirectory()
        cls.files = {e: pathlib.Path(cls.folder.name) / f"part.{e}" for e in ENDINGS}
        for path in cls.files.values():
            cls.part.write(path)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def stops(self, name, work):
        """Runs `work` whole, then stops it at several places."""
        began = time.perf_counter()
        work()
        took = time.perf_counter() - began
        for place in PLACES:
            with self.subTest(function=name, place=place):
                wait = interrupted(work, place * took) or 0
                if wait >= BOUND:
                    wait = interrupted(work, place * took) or 0
                self.assertLess(wait, BOUND, f"{name} takes {took:.2f} s")
        if LONG:
            print(f"{name}: {took:.2f} s")

    def test_questions(self):
        part, z = self.part, (0, 0, 1)
        heights = np.linspace(-50, 50, 200).tolist()
        solid = sculptd.Solid(part)
        walls = sculptd.thickness(part)
        faces = sculptd.thickness(part, faces=True)
        balls = sculptd.thickness(part, method="sphere", faces=True)
        for name, work in {
            "thickness": lambda: sculptd.thickness(part, faces=True),
            "thickness by cones": lambda: sculptd.thickness(part, method="cone"),
            "thickness by spheres": lambda: sculptd.thickness(part, method="sphere"),
            "below": lambda: walls.below(1.0),
            "parts": lambda: faces.parts(),
            "medial curve": lambda: balls.medial_curve(),
            "measure": lambda: sculptd.measure(part),
            "check": lambda: sculptd.check(part),
            "check to print": lambda: sculptd.check(part, process="fdm"),
            "check to mould": lambda: sculptd.check(part, process="moulding"),
            "sections": lambda: sculptd.sections(part, z, heights),
            "project": lambda: sculptd.project(part),
            "picture": lambda: sculptd.picture(part, width=4000, height=4000),
            "Solid": lambda: sculptd.Solid(part),
            "signed_distance": lambda: solid.signed_distance(self.points),
            "nearest": lambda: solid.nearest(self.points),
            "winding": lambda: solid.winding(self.points[:50_000]),
            "volume": lambda: part.volume,
        }.items():
            self.stops(name, work)

    def test_new_meshes(self):
        part, tool = self.part, self.tool
        for name, work in {
            "decimate": lambda: sculptd.decimate(part, 1000),
            "repair": lambda: sculptd.repair(self.holed, weld=1e-6),
            "remesh": lambda: sculptd.remesh(part, side=128, sharp=True),
            "hollow": lambda: sculptd.hollow(part, 2.0, side=128),
            "offset": lambda: sculptd.offset(part, 2.0, side=128),
            "subdivide": lambda: sculptd.subdivide(part, 2),
            "boolean": lambda: sculptd.boolean(part, tool),
            "boolean of a list": lambda: sculptd.boolean(part, [tool, tool], "difference"),
            "boolean_all": lambda: sculptd.boolean_all(part, tool),
            "operator": lambda: part - tool,
        }.items():
            self.stops(name, work)

    def test_files(self):
        for ending, path in self.files.items():
            self.stops(f"read {ending}", lambda: sculptd.read(path))
            whole = path.read_bytes()
            self.stops(f"write {ending}", lambda: self.part.write(path))
            self.assertEqual(path.read_bytes(), whole, "a file is whole or as it was")
        left = sorted(os.listdir(self.folder.name))
        until = time.monotonic() + 30
        while left != sorted(p.name for p in self.files.values()) and time.monotonic() < until:
            time.sleep(0.1)
            left = sorted(os.listdir(self.folder.name))
        self.assertEqual(left, sorted(p.name for p in self.files.values()))


if __name__ == "__main__":
    unittest.main()
