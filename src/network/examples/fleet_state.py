#!/usr/bin/env python3
"""Reads what the installations of a fleet publish, without sculptd: for a dashboard, an alarm.

    pip install eclipse-zenoh            (and, to check each state against the schema, jsonschema)
    python3 fleet_state.py museum --key staff.key --connect tcp/staff.example:7447 --for 6

Prints one JSON object: each installation's newest state, whether its tag is that of the key, and
how many seconds ago it came. Ends with 1 where a state is not as ../fleet/schema.json says
or its tag is wrong. Without --key states are read all the same, and believed by nobody.
"""

import argparse
import hashlib
import hmac
import json
import pathlib
import struct
import sys
import time
import tomllib

import zenoh

ROOT = "sculptd/fleet/1"
SCHEMA = pathlib.Path(__file__).resolve().parents[1] / "fleet/schema.json"


def code(key, purpose, part):
    """HMAC-SHA-256 of the purpose, the length of the part in eight bytes, and the part."""
    return hmac.new(key, purpose + struct.pack("<Q", len(part)) + part, hashlib.sha256).digest()


def tag(staff, name, state):
    """The tag that an installation of this name gives its state."""
    own = code(staff, b"sculptd fleet installation 1", name.encode())
    return code(own, b"sculptd fleet state 1", state)


def checker():
    try:
        import jsonschema
    except ImportError:
        return None
    whole = json.loads(SCHEMA.read_text())
    return jsonschema.Draft202012Validator({**whole["state"], "$defs": whole["$defs"]})


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("fleet")
    arguments.add_argument("--key", type=pathlib.Path)
    arguments.add_argument("--connect", action="append", default=[])
    arguments.add_argument("--for", dest="seconds", type=float, default=6.0)
    given = arguments.parse_args()
    staff = given.key and bytes.fromhex(tomllib.loads(given.key.read_text())["key"])

    config = zenoh.Config()
    if given.connect:
        config.insert_json5("connect/endpoints", json.dumps(given.connect))
        config.insert_json5("scouting/multicast/enabled", "false")
    found, wrong = {}, []

    def published(sample):
        name = str(sample.key_expr).rsplit("/", 1)[-1]
        state = sample.payload.to_bytes()
        sent = sample.attachment.to_bytes() if sample.attachment else b""
        believed = staff and hmac.compare_digest(sent, tag(staff, name, state))
        try:
            read = json.loads(state)
        except ValueError as e:
            wrong.append(f"{name}: {e}")
            return
        found[name] = {"tag": "right" if believed else "wrong" if staff else "unchecked",
                       "heard": time.monotonic(), "state": read}

    with zenoh.open(config) as session:
        states = session.declare_subscriber(f"{ROOT}/{given.fleet}/state/*", published)
        time.sleep(given.seconds)
        states.undeclare()

    schema = checker()
    for name, entry in found.items():
        entry["silent_s"] = round(time.monotonic() - entry.pop("heard"), 1)
        if schema:
            wrong += [f"{name}: {e.message}" for e in schema.iter_errors(entry["state"])]
        if entry["tag"] == "wrong":
            wrong.append(f"{name}: the tag is wrong")
    print(json.dumps({"fleet": given.fleet, "installations": found, "wrong": wrong,
                      "schema": "checked" if schema else "unchecked"}, indent=1))
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
