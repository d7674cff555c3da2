"""The client against a real daemon; skipped unless SCULPTD_BINARY names one."""

import asyncio
import pathlib
import subprocess
import sys
import time
import unittest

import sculptd
from running_daemon import BINARY, RunningDaemon
from sculptd import control


class WithoutTheNativeModule(unittest.TestCase):
    """The client is pure Python."""

    def test_the_client_is_imported_where_no_native_module_is(self):
        script = (
            "import sys; sys.modules['sculptd._native'] = None\n"
            "from sculptd import control; print(control.Client.__name__)\n"
            "import sculptd\n"
            "try: sculptd.Mesh\n"
            "except ImportError as e: print('ImportError')\n"
        )
        out = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
        self.assertEqual((out.stdout.split(), out.stderr), (["Client", "ImportError"], ""))


class Submodules(unittest.TestCase):
    def test_control_and_convert_are_there_after_one_import(self):
        script = "import sculptd; print(sculptd.control.Client, sculptd.convert.to_trimesh)"
        out = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
        self.assertEqual((out.returncode, out.stderr), (0, ""))
        self.assertTrue({"control", "convert"} <= set(dir(sculptd)))


class Absent(unittest.TestCase):
    def test_no_daemon_is_an_error_with_the_path(self):
        with self.assertRaises(control.DaemonAbsent) as caught:
            control.Client("/nowhere/sculptd.sock")
        self.assertEqual(caught.exception.path, "/nowhere/sculptd.sock")

    def test_a_client_waits_no_longer_than_told(self):
        began = time.monotonic()
        with self.assertRaises(control.DaemonAbsent):
            control.Client("/nowhere/sculptd.sock", wait=0.3)
        self.assertLess(abs(time.monotonic() - began - 0.3), 0.25)

        async def connect():
            async with control.AsyncClient("/nowhere/sculptd.sock", wait=0.3):
                pass

        began = time.monotonic()
        with self.assertRaises(control.DaemonAbsent):
            asyncio.run(connect())
        self.assertLess(abs(time.monotonic() - began - 0.3), 0.25)


@unittest.skipUnless(BINARY, "SCULPTD_BINARY is not set")
class Daemon(unittest.TestCase):
    def setUp(self):
        self.daemon = RunningDaemon()
        self.socket = self.daemon.socket

    def tearDown(self):
        self.daemon.stop()

    def test_a_stroke_changes_the_clay_and_is_exported(self):
        with control.Client(self.socket) as daemon:
            self.assertGreaterEqual(daemon.hello()["protocol"], 1)
            daemon.subscribe()
            before = daemon.hash()["hash"]
            points = [(0.3 + 0.004 * i, 0.5, 0.8, 10 * i) for i in range(100)]
            reply = daemon.stroke(points, kind="clay", radius=0.1)
            # One for each point, and one to leave the surface.
            self.assertGreaterEqual(reply["samples"], 100)
            until = time.monotonic() + 30
            while daemon.hash()["hash"] == before:
                self.assertLess(time.monotonic(), until, "the stroke changed nothing")
            self.assertIsNotNone(daemon.next_event(10.0))
            path = pathlib.Path(self.daemon.folder.name) / "sculpture.stl"
            daemon.export(path)
            made = sculptd.read(path)
            self.assertGreater(len(made), 1000)

    def test_reads_after_undo_redo_and_jump_are_current(self):
        with control.Client(self.socket) as daemon:
            states, nodes = [daemon.hash()["hash"]], [daemon.history()["here"]]
            for y in (0.35, 0.5, 0.65):
                daemon.stroke([(0.4, y, 0.9, 0), (0.6, y, 0.9, 300)], kind="clay", radius=0.1)
                states.append(daemon.hash()["hash"])
                nodes.append(daemon.history()["here"])
            self.assertEqual(len(set(states)), 4)
            path = pathlib.Path(self.daemon.folder.name) / "state.ply"
            meshes, now = {}, 3
            for to in (2, 3, 2, 1, 2, 0, 3, 1, 0, 1, 3, 0):
                if to == now - 1:
                    daemon.undo()
                elif to == now + 1:
                    daemon.redo()
                else:
                    daemon.jump(node=nodes[to])
                now = to
                self.assertEqual(daemon.hash()["hash"], states[to])
                self.assertEqual(daemon.history()["here"], nodes[to])
                daemon.export(path)
                mesh = sculptd.read(path)
                self.assertEqual(meshes.setdefault(to, mesh), mesh)
            self.assertEqual(len(set(meshes.values())), 4)

    def test_a_refusal_names_the_field(self):
        with control.Client(self.socket) as daemon:
            with self.assertRaises(control.DaemonRefused) as caught:
                daemon.camera(pitch=9)
            self.assertEqual(caught.exception.code, -32602)
            self.assertIn("pitch = 9", caught.exception.message)
            with self.assertRaises(control.DaemonRefused):
                daemon.call("frobnicate")
            self.assertIn("stroke", str(daemon.methods()))


if __name__ == "__main__":
    unittest.main()
