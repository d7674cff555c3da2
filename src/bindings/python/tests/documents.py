"""The Python code of the documents: each block is a program.

    python documents.py FOLDER   writes every block into a file of FOLDER, for type checkers
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[4]
DOCUMENTS = [
    "README.md",
    "src/bindings/python/README.md",
    "config/guide/src/python.md",
    "config/guide/src/cookbook.md",
]


def blocks(document):
    """Each block's name, from the heading above it, and its text."""
    text, heading = (ROOT / document).read_text(encoding="utf-8"), ""
    for found in re.finditer(r"^#+ ([^\n]*)$|^```python\n(.*?)^```$", text, re.S | re.M):
        if found[2] is None:
            heading = found[1]
        else:
            yield heading, found[2]


def main():
    folder, count = pathlib.Path(sys.argv[1]), 0
    folder.mkdir(parents=True, exist_ok=True)
    for document in DOCUMENTS:
        for _, text in blocks(document):
            count += 1
            name = pathlib.Path(document).stem.lower().replace("-", "_")
            (folder / f"{name}_{count}.py").write_text(text, encoding="utf-8")
    print(f"{count} programs of {len(DOCUMENTS)} documents")


if __name__ == "__main__":
    main()
