#!/usr/bin/env python3
"""Reads every report descriptor of a folder of hid-recorder files with hid-tools (pip install hid-tools), a parser that is
not ours, and prints one line for each: file, its place in the file, input reports, variable input fields, and a CRC-32 over
the fields, each as `id usage start len min max` in order. `devices/tests/hid/facts.rs` computes the same with our parser.

    python3 hid_tools_facts.py FOLDER > hid/facts.txt
"""

import pathlib
import sys
import zlib

from hidtools.hid import ReportDescriptor


def descriptors(path):
    for line in path.read_text(errors="replace").splitlines():
        if line.startswith("R:"):
            count, *data = line[2:].split()
            yield bytes(int(b, 16) for b in data[: int(count)])


def facts(data):
    kept = data
    try:
        parsed = ReportDescriptor.from_bytes(kept)
    except Exception:  # Stray zero bytes at the end.
        parsed = ReportDescriptor.from_bytes(kept.rstrip(b"\0"))
    lines = []
    for rid, report in parsed.input_reports.items():
        for field in report:
            if field.is_const or field.is_array:
                continue
            usages = field.usages or [field.usage]
            for k in range(field.count):
                # More controls than usages: the last usage goes on.
                usage = usages[min(k, len(usages) - 1)]
                if usage >= 0xFF000000:  # A maker's own: by page.
                    usage &= 0xFFFF0000
                start = field.start + k * field.size
                number = rid if report.numbered else -1
                lines.append((number, usage, start, field.size, field.logical_min, field.logical_max))
    return len(parsed.input_reports), lines


def main():
    folder = pathlib.Path(sys.argv[1])
    for path in sorted(folder.glob("*.hid"), key=lambda p: p.name):
        for place, data in enumerate(descriptors(path)):
            try:
                reports, lines = facts(data)
            except Exception as e:
                print(f"{path.name} {place} declined", file=sys.stdout)
                print(f"{path.name} {place}: {e}", file=sys.stderr)
                continue
            if "-v" in sys.argv:
                for line in sorted(lines):
                    print(path.name, place, *line)
            text = "\n".join(" ".join(map(str, line)) for line in sorted(lines))
            print(path.name, place, reports, len(lines), f"{zlib.crc32(text.encode()):08x}")


main()
