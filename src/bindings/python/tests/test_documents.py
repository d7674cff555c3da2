"""The Python code of the documents, run from top to bottom in a folder of its own."""

import contextlib
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[4]
DOCUMENTS = ["README.md", "src/bindings/python/README.md", "config/guide/src/python.md"]


class Documents(unittest.TestCase):
    def test_every_block_runs(self):
        for name in DOCUMENTS:
            text = (ROOT / name).read_text(encoding="utf-8")
            blocks = re.findall(r"^```python\n(.*?)^```$", text, re.S | re.M)
            self.assertTrue(blocks, name)
            for block in blocks:
                if "Client" in block:
                    continue  # test_control does the same with a daemon of its own.
                here = os.getcwd()
                with self.subTest(document=name), tempfile.TemporaryDirectory() as folder:
                    os.chdir(folder)
                    try:
                        with contextlib.redirect_stdout(io.StringIO()):
                            exec(compile(block, name, "exec"), {"__name__": "block"})
                    finally:
                        os.chdir(here)


class Stub(unittest.TestCase):
    def test_the_client_s_types_are_the_schema_s(self):
        script = ROOT / "src/bindings/python/generate_control_stub.py"
        subprocess.run([sys.executable, script, "--check"], check=True)


if __name__ == "__main__":
    unittest.main()
