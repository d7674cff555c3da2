#!/usr/bin/env python3
"""The licences of everything that is linked into the program.

    licences.py FOLDER [cargo features...]

Writes FOLDER/copyright (our own licence and a line for each dependency, in Debian's machine-readable
form), FOLDER/THIRD-PARTY.txt (their texts, each once) and FOLDER/sbom.cdx.json (CycloneDX 1.5).
Ends with 1 where a dependency's licence is not one that can be combined with MIT OR Apache-2.0.
"""

import hashlib
import json
import pathlib
import re
import subprocess
import sys

# Each way to read an expression must be possible with one of these alone.
ALLOWED = {
    "0BSD", "Apache-2.0", "Apache-2.0 WITH LLVM-exception", "BSD-2-Clause", "BSD-3-Clause",
    "BSL-1.0", "CC0-1.0", "ISC", "MIT", "MIT-0", "MPL-2.0", "OFL-1.1", "Ubuntu-font-1.0",
    "Unicode-3.0", "Unlicense", "Zlib",
}


def allowed(expression):
    """Whether an SPDX expression (with AND, OR and brackets) can be met by `ALLOWED`."""
    text = expression.replace("/", " OR ")
    tokens = re.findall(r"\(|\)|[^\s()]+", text)
    at = 0

    def either():
        nonlocal at
        good = both()
        while at < len(tokens) and tokens[at] == "OR":
            at += 1
            good = both() or good
        return good

    def both():
        nonlocal at
        good = one()
        while at < len(tokens) and tokens[at] == "AND":
            at += 1
            good = one() and good
        return good

    def one():
        nonlocal at
        if tokens[at] == "(":
            at += 1
            good = either()
            at += 1
            return good
        name = tokens[at]
        at += 1
        if tokens[at : at + 1] == ["WITH"]:
            name += " WITH " + tokens[at + 1]
            at += 2
        return name in ALLOWED

    return either()


def linked(features):
    """The packages that are linked on Linux: no development and no build dependency."""
    tree = ["cargo", "tree", "--locked", "-p", "sculptd", "-e", "normal", "--prefix", "none"]
    tree += ["--format", "{p}", *features]
    lines = subprocess.run(tree, check=True, capture_output=True, text=True).stdout.splitlines()
    names = {tuple(line.split()[:2]) for line in lines if line.strip()}
    data = ["cargo", "metadata", "--locked", "--format-version", "1"]
    found = json.loads(subprocess.run(data, check=True, capture_output=True, text=True).stdout)
    return sorted(
        (p for p in found["packages"] if (p["name"], "v" + p["version"]) in names),
        key=lambda p: (p["name"], p["version"]),
    )


def texts(package):
    folder = pathlib.Path(package["manifest_path"]).parent
    for path in sorted(folder.iterdir()):
        if re.match(r"(?i)(licen[sc]e|copying|notice|unlicense|ofl)", path.name) and path.is_file():
            yield path.read_text(encoding="utf-8", errors="replace").strip()


def main():
    out = pathlib.Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    packages = linked(sys.argv[2:])
    others = [p for p in packages if not p["name"].startswith("sculptd")]
    bad = [p for p in others if not allowed(p["license"] or "none")]
    for p in bad:
        print(f"{p['name']} {p['version']}: licence {p['license']} is not allowed", file=sys.stderr)

    ours = next(p for p in packages if p["name"] == "sculptd")
    head = [
        "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/",
        "Upstream-Name: sculptd",
        f"Source: {ours['repository']}",
        "Comment: The texts of all dependencies' licences are in THIRD-PARTY.txt.gz beside this"
        " file.",
        "",
        "Files: *",
        "Copyright: The sculptd authors",
        "License: MIT or Apache-2.0",
        "",
        "License: MIT",
        *(" " + (line.rstrip() or ".") for line in open("LICENSE-MIT", encoding="utf-8")),
        "",
        "License: Apache-2.0",
        " On Debian systems the text is in /usr/share/common-licenses/Apache-2.0.",
        "",
    ]
    for p in others:
        names = ", ".join(p["authors"]) or f"the authors of {p['name']}"
        head += [f"Files: {p['name']}-{p['version']}", f"Copyright: {names}"]
        head += [f"License: {p['license']}", ""]
    (out / "copyright").write_text("\n".join(head), encoding="utf-8")

    once = {}
    for p in others:
        for text in texts(p):
            key = re.sub(r"\s+", " ", text)
            once.setdefault(key, (text, []))[1].append(f"{p['name']} {p['version']}")
    parts = ["; ".join(names) + "\n\n" + text for text, names in once.values()]
    (out / "THIRD-PARTY.txt").write_text(("\n\n" + "=" * 80 + "\n").join(parts), encoding="utf-8")

    components = [
        {
            "type": "library",
            "bom-ref": f"pkg:cargo/{p['name']}@{p['version']}",
            "name": p["name"],
            "version": p["version"],
            "purl": f"pkg:cargo/{p['name']}@{p['version']}",
            "licenses": [{"expression": (p["license"] or "NONE").replace("/", " OR ")}],
        }
        for p in packages
        if p["name"] != "sculptd"
    ]
    serial = hashlib.sha256(json.dumps(components, sort_keys=True).encode()).hexdigest()
    bom = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "serialNumber": "urn:uuid:{}-{}-4{}-8{}-{}".format(
            serial[:8], serial[8:12], serial[13:16], serial[17:20], serial[20:32]
        ),
        "version": 1,
        "metadata": {
            "component": {"type": "application", "name": "sculptd", "version": ours["version"]}
        },
        "components": components,
    }
    (out / "sbom.cdx.json").write_text(json.dumps(bom, indent=1) + "\n", encoding="utf-8")
    print(f"{len(others)} dependencies, {len(once)} licence texts")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
