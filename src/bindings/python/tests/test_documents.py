"""The Python code of the documents: each block runs as a program in a folder of its own."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

from documents import DOCUMENTS, ROOT, blocks
from running_daemon import BINARY, RunningDaemon

#: What a block may ask for beyond NumPy.
LIBRARIES = ("pandas", "trimesh")


class Documents(unittest.TestCase):
    def test_every_block_runs(self):
        for document in DOCUMENTS:
            self.assertTrue(list(blocks(document)), document)
            for heading, text in blocks(document):
                with self.subTest(document=document, heading=heading):
                    self.runs(text)

    def runs(self, text):
        daemon = None
        if "Client" in text:
            if not BINARY:
                self.skipTest("SCULPTD_BINARY is not set")
            daemon = RunningDaemon()
        try:
            with tempfile.TemporaryDirectory() as folder:
                (pathlib.Path(folder) / "program.py").write_text(text, encoding="utf-8")
                done = subprocess.run(
                    [sys.executable, "program.py"],
                    cwd=folder,
                    env=daemon.environment if daemon else os.environ,
                    capture_output=True,
                    text=True,
                    timeout=300,
                )
        finally:
            if daemon:
                daemon.stop()
        for library in LIBRARIES:
            if f"ModuleNotFoundError: No module named '{library}'" in done.stderr:
                self.skipTest(f"{library} is not installed")
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)


class Stub(unittest.TestCase):
    def test_the_client_s_types_are_the_schema_s(self):
        script = ROOT / "src/bindings/python/generate_control_stub.py"
        subprocess.run([sys.executable, script, "--check"], check=True)


if __name__ == "__main__":
    unittest.main()
