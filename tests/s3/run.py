#!/usr/bin/env python3
"""Works of an installation into a bucket: a real program, a real S3-compatible server, kills and a dead network.

    cargo build --release --no-default-features --features s3
    python3 -m venv /tmp/s3venv && /tmp/s3venv/bin/pip install 'moto[server]'
    /tmp/s3venv/bin/python tests/s3/run.py target/release/sculptd

Prints one line a claim and ends with 0 if all held. Takes about two minutes.
"""

import os
import pathlib
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

import boto3

SEED = int(os.environ.get("SEED", "1"))
BUCKET = "sculptd-works"
# A pen as any descriptor would say it: tip, barrel, in range, X and Y to 10000 over 250 x 160 mm, pressure to 1023.
DESCRIPTOR = (
    "05 0d 09 02 a1 01 85 01 09 20 a1 00 09 42 09 44 09 32 15 00 25 01 75 01 95 03 81 02 95 05 81 03"
    " 05 01 75 10 95 01 55 0d 65 33 09 30 26 10 27 46 72 26 81 02 09 31 46 9b 18 81 02"
    " 05 0d 09 30 26 ff 03 81 02 c0 c0"
)


def recording(path, visits, apart_s):
    """`visits` strokes; the pen is away between them for so long that the visit ends."""
    count = len(DESCRIPTOR.split())
    lines = ["D: 0", f"R: {count} {DESCRIPTOR}", "N: Plain Pen", "I: 3 1234 5678"]

    def event(t, flags, x, y, p):
        b = [1, flags, x & 255, x >> 8, y & 255, y >> 8, p & 255, p >> 8]
        lines.append(f"E: {t:.6f} {len(b)} " + " ".join(f"{v:02x}" for v in b))

    for v in range(visits):
        t = 0.5 + v * apart_s
        for i in range(60):
            event(t + i * 0.008, 5, 4500 + 15 * i + 40 * v, 5000 + 9 * i, 700)
        event(t + 0.49, 4, 5400, 5500, 0)
        event(t + 0.50, 0, 5400, 5500, 0)
    path.write_text("\n".join(lines) + "\n")


class Server:
    """moto's S3, its buckets in memory: what it answers with is what it has."""

    def __init__(self):
        with socket.socket() as s:
            s.bind(("127.0.0.1", 0))
            self.port = s.getsockname()[1]
        self.url = f"http://127.0.0.1:{self.port}"
        self.process = None

    def up(self):
        command = [str(pathlib.Path(sys.executable).parent / "moto_server"), "-p", str(self.port)]
        quiet = subprocess.DEVNULL
        self.process = subprocess.Popen(command, stdout=quiet, stderr=quiet)
        for _ in range(300):
            try:
                urllib.request.urlopen(urllib.request.Request(f"{self.url}/{BUCKET}", method="PUT"), timeout=2)
                return
            except (urllib.error.URLError, OSError):
                time.sleep(0.1)
        sys.exit("the server does not start")

    def down(self):
        """For ever, as far as it knows: its memory goes with it."""
        self.process.kill()
        self.process.wait()

    def pause(self):
        """A network that swallows everything: connections are taken and nothing is answered."""
        self.process.send_signal(signal.SIGSTOP)

    def go_on(self):
        self.process.send_signal(signal.SIGCONT)

    def names(self):
        pages = self.client().get_paginator("list_objects_v2").paginate(Bucket=BUCKET)
        return sorted(o["Key"] for page in pages for o in page.get("Contents", []))

    def get(self, key):
        return self.client().get_object(Bucket=BUCKET, Key=key)["Body"].read()

    def client(self):
        """Reads as somebody who has the keys."""
        keys = {"aws_access_key_id": "museum", "aws_secret_access_key": "secret", "region_name": "us-east-1"}
        return boto3.client("s3", endpoint_url=self.url, **keys)


class Museum:
    def __init__(self, binary, folder, server):
        self.binary, self.folder, self.server = binary, folder, server
        self.works = folder / "works"
        self.config = folder / "kiosk.toml"
        self.config.write_text(
            "idle_s = 1.0\ncountdown_s = 1.0\n"
            f'gallery = "{self.works}"\ngallery_store = "s3://{BUCKET}/museum"\naudit = "{folder}/audit.jsonl"\n'
        )
        self.env = dict(
            os.environ,
            XDG_RUNTIME_DIR=str(folder),
            XDG_CONFIG_HOME=str(folder),
            AWS_ACCESS_KEY_ID="museum",
            AWS_SECRET_ACCESS_KEY="secret",
            AWS_REGION="us-east-1",
            AWS_ENDPOINT=server.url,
            AWS_ALLOW_HTTP="true",
            AWS_VIRTUAL_HOSTED_STYLE_REQUEST="false",
        )

    def open(self, visits=0):
        command = [self.binary, "run", "--headless", "--kiosk", "--kiosk-config", self.config]
        if visits:
            film = self.folder / "visits.hid"
            recording(film, visits, 4.0)
            command += ["--play-device", film]
        log = open(self.folder / "log.txt", "ab")
        return subprocess.Popen(command, env=self.env, stdout=log, stderr=log)

    def here(self):
        return sorted(p.name for p in self.works.glob("work-*.glb")) if self.works.exists() else []

    def waiting(self):
        folder = self.works / "outgoing"
        return sorted(p.name for p in folder.glob("work-*.glb")) if folder.exists() else []


def until(what, so, seconds=60):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if so():
            return
        time.sleep(0.05)
    sys.exit(f"FAILED: {what}, not within {seconds} s")


def close(process):
    process.send_signal(signal.SIGTERM)
    begun = time.monotonic()
    process.wait(timeout=20)
    return time.monotonic() - begun


def same(museum, server):
    """Every work of the folder is in the bucket, to the byte."""
    there = server.names()
    for name in museum.here():
        if f"museum/{name}" not in there:
            sys.exit(f"FAILED: {name} is not in the bucket")
        if server.get(f"museum/{name}") != (museum.works / name).read_bytes():
            sys.exit(f"FAILED: {name} is another one in the bucket")
    return len(museum.here())


def main():
    binary = pathlib.Path(sys.argv[1]).resolve()
    chance = random.Random(SEED)
    folder = pathlib.Path(tempfile.mkdtemp(prefix="sculptd-s3-"))
    server = Server()
    museum = Museum(binary, folder, server)
    server.up()

    daemon = museum.open(visits=3)
    until("three works are made and sent", lambda: len(museum.here()) == 3 and not museum.waiting())
    close(daemon)
    page = server.get("museum/index.html").decode()
    links = [part.split('"')[0] for part in page.split('href="')[1:]]
    opened = sum(server.get(f"museum/{link}")[:4] == b"glTF" for link in links)
    print(f"works of {same(museum, server)} visitors are in the bucket to the byte; {opened} links of its page open")
    if opened != 3:
        sys.exit("FAILED: links")

    server.down()
    daemon = museum.open(visits=2)
    until("two more works wait", lambda: len(museum.here()) == 5 and len(museum.waiting()) == 2)
    time.sleep(1.5)
    took = close(daemon)
    assert len(museum.waiting()) == 2
    server.up()
    daemon = museum.open()
    until("what waited is sent", lambda: not museum.waiting())
    new = [n for n in server.names() if n.endswith(".glb")]
    if new != ["museum/work-000004.glb", "museum/work-000005.glb"]:
        sys.exit(f"FAILED: after the network came back: {new}")
    print(f"server down: 2 works waited over a restart (which took {took:.1f} s) and are there now")

    server.pause()
    for n in (6, 7):
        # What a visitor's end leaves: a work, and its mark.
        shutil.copy(museum.works / "work-000003.glb", museum.works / f"work-{n:06}.glb")
        (museum.works / "outgoing" / f"work-{n:06}.glb").touch()
    close(daemon)
    daemon = museum.open()
    time.sleep(3)
    took = close(daemon)
    if len(museum.waiting()) != 2 or took > 5:
        sys.exit(f"FAILED: a server that does not answer: {museum.waiting()}, ended in {took:.1f} s")
    server.go_on()
    daemon = museum.open()
    until("sent after the silence", lambda: not museum.waiting())
    close(daemon)
    print(f"server silent: 2 works kept; told to end in the middle, it took {took:.2f} s; sent afterwards")

    # kill -9 while sixty works are sent. Half have no mark yet: the kill came between the work and its mark.
    first = len(museum.here())
    for n in range(first + 1, first + 61):
        shutil.copy(museum.works / f"work-{1 + n % 5:06}.glb", museum.works / f"work-{n:06}.glb")
        if n % 2:
            (museum.works / "outgoing" / f"work-{n:06}.glb").touch()
    kills = 0
    while kills < 300:
        daemon = museum.open()
        time.sleep(chance.uniform(0.02, 0.5))
        if daemon.poll() is not None:
            sys.exit(f"FAILED: the daemon ended by itself, {daemon.returncode}")
        daemon.kill()
        daemon.wait()
        kills += 1
        if kills >= 20 and len(museum.waiting()) == 0:
            break
    # The first works went with the first server's memory.
    for n in (1, 2, 3):
        (museum.works / f"work-{n:06}.glb").unlink()
    print(f"{kills} kills while sending: {same(museum, server)} works are in the bucket to the byte")

    # Kills in the middle of visits: what the gallery has arrives, and nothing half-made is in either.
    before = len(museum.here())
    for _ in range(6):
        daemon = museum.open(visits=4)
        time.sleep(chance.uniform(2.5, 9.0))
        daemon.kill()
        daemon.wait()
    daemon = museum.open()
    until("all is sent", lambda: not museum.waiting())
    close(daemon)
    whole = same(museum, server)
    stray = [n for n in server.names() if not n.endswith(".glb") and n != "museum/index.html"]
    if stray or any(server.get(n)[:4] != b"glTF" for n in server.names() if n.endswith(".glb")):
        sys.exit(f"FAILED: something half-made is in the bucket: {stray}")
    print(f"6 kills in the middle of visits: {whole - before} works kept, all {whole} are in the bucket to the byte")
    server.down()
    shutil.rmtree(folder)
    print("all held")


if __name__ == "__main__":
    main()
