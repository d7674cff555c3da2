#!/usr/bin/env python3
"""A shared sculpture over a bad network: real daemons, each in a network namespace of its own, whose
packets all pass through this program, which delays, loses, reorders and bounds them.

    cargo build --release --no-default-features --features network
    cargo build --release --no-default-features --features network --example transitions
    tests/netns/run.py strokes --people 8 --minutes 10 RECORDING...
    tests/netns/run.py join --vertices 10000000 --mbit 100
    tests/netns/run.py kills --times 100

Needs Linux, root, `ip` and /dev/net/tun. Prints one line a claim and ends with 0 if all held. As with netem's `delay 200ms
loss 1% reorder 2%` on each interface, what one process sends is late by 200 ms each way.
"""

import argparse
import fcntl
import heapq
import json
import math
import os
import pathlib
import random
import select
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time

TUNSETIFF, IFF_TUN, IFF_NO_PI = 0x400454CA, 0x0001, 0x1000
ROOT = pathlib.Path(__file__).resolve().parents[2]


def ip(*words):
    subprocess.run(["ip", *words], check=True)


class Air(threading.Thread):
    """The network: namespace k (from 1) has the address 10.77.0.k."""

    def __init__(self, count, delay_s, loss, reorder, mbit, seed):
        super().__init__(daemon=True)
        self.names = [f"sculptd-{os.getpid()}-{k}" for k in range(1, count + 1)]
        self.fds = []
        self.random = random.Random(seed)
        self.delay_s, self.loss, self.reorder = delay_s, loss, reorder
        self.bytes_s = mbit * 125_000 if mbit else None
        self.cut = set()
        self.sent, self.received = [0] * count, [0] * count
        self.free_at = [0.0] * count
        self.waiting, self.serial = [], 0
        self.lost = 0
        self.stop = False
        for k, name in enumerate(self.names, 1):
            ip("netns", "add", name)
            fd = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
            tun = f"sc{os.getpid() % 100000}x{k}"
            fcntl.ioctl(fd, TUNSETIFF, struct.pack("16sH", tun.encode(), IFF_TUN | IFF_NO_PI))
            self.fds.append(fd)
            ip("link", "set", tun, "netns", name)
            ip("-n", name, "link", "set", "lo", "up")
            ip("-n", name, "addr", "add", f"10.77.0.{k}/24", "dev", tun)
            ip("-n", name, "link", "set", tun, "up", "txqueuelen", "4000")

    def run(self):
        poll = select.poll()
        by_fd = {fd: k for k, fd in enumerate(self.fds)}
        for fd in self.fds:
            poll.register(fd, select.POLLIN)
        while not self.stop:
            now = time.monotonic()
            wait = self.waiting[0][0] - now if self.waiting else 0.05
            for fd, _ in poll.poll(max(0, min(wait, 0.05)) * 1000):
                for _ in range(64):
                    try:
                        packet = os.read(fd, 65536)
                    except BlockingIOError:
                        break
                    self.take(by_fd[fd], packet)
            now = time.monotonic()
            while self.waiting and self.waiting[0][0] <= now:
                _, _, k, packet = heapq.heappop(self.waiting)
                if k not in self.cut:
                    self.received[k] += len(packet)
                    try:
                        os.write(self.fds[k], packet)
                    except OSError:
                        pass

    def take(self, source, packet):
        # IPv4 to one of ours: nothing else, multicast too, leaves a namespace.
        if len(packet) < 20 or packet[0] >> 4 != 4 or packet[16:19] != b"\x0a\x4d\x00":
            return
        k = packet[19] - 1
        self.sent[source] += len(packet)
        if not 0 <= k < len(self.fds) or source in self.cut or k in self.cut:
            return
        if self.random.random() < self.loss:
            self.lost += 1
            return
        at = time.monotonic()
        if self.bytes_s:
            # A queue of 100 ms before the link.
            at = max(at, self.free_at[source])
            if at > time.monotonic() + 0.1:
                self.lost += 1
                return
            self.free_at[source] = at = at + len(packet) / self.bytes_s
        if self.random.random() >= self.reorder:
            at += self.delay_s
        self.serial += 1
        heapq.heappush(self.waiting, (at, self.serial, k, packet))

    def end(self):
        self.stop = True
        self.join()
        for fd in self.fds:
            os.close(fd)
        for name in self.names:
            subprocess.run(["ip", "netns", "del", name], check=False)


class Daemon:
    """`sculptd run --headless` in a namespace, in a home of its own."""

    def __init__(self, binary, air, k, folder, *words):
        self.binary, self.netns, self.home = binary, air.names[k], pathlib.Path(folder)
        self.home.mkdir(parents=True, exist_ok=True)
        self.log = open(self.home / "log", "ab")
        self.process = subprocess.Popen(
            self.command("run", "--headless", *words), env=self.env(), stdout=self.log, stderr=self.log,
            stdin=subprocess.DEVNULL)

    def env(self):
        names = ["XDG_RUNTIME_DIR", "XDG_DATA_HOME", "XDG_STATE_HOME", "XDG_CONFIG_HOME", "HOME"]
        return os.environ | {name: str(self.home) for name in names}

    def command(self, *words):
        return ["ip", "netns", "exec", self.netns, self.binary, *map(str, words)]

    def ctl(self, method, **params):
        words = ["--json", "ctl", method] + ([json.dumps(params)] if params else [])
        out = subprocess.run(self.command(*words), env=self.env(), capture_output=True, timeout=60)
        try:
            return json.loads(out.stdout)
        except ValueError:
            return None

    def hash(self):
        return (self.ctl("hash") or {}).get("hash")

    def told(self, what):
        return (self.home / "log").read_text(errors="replace").count(what)

    def kill(self):
        self.process.kill()
        self.process.wait()

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        try:
            return self.process.wait(60)
        except subprocess.TimeoutExpired:
            self.kill()
            return None


class Claims:
    def __init__(self):
        self.failed = 0

    def __call__(self, holds, text):
        print(("ok   " if holds else "FAIL ") + text, flush=True)
        self.failed += not holds
        return holds


def until(what, so, seconds=120, every=0.2):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if so():
            return True
        time.sleep(every)
    print(f"never: {what}", flush=True)
    return False


def lengthened(recording, seconds, to):
    """A recording again and again, with a second between, for so long; whole each time."""
    lines = pathlib.Path(recording).read_text(errors="replace").splitlines()
    head = [line for line in lines if not line.startswith("E:")]
    events = [line.split(maxsplit=2) for line in lines if line.startswith("E:")]
    first, last = float(events[0][1]), float(events[-1][1])
    out, start = head, 0.5
    while start < seconds:
        out += [f"E: {start + float(t) - first:.6f} {rest}" for _, t, rest in events]
        start += last - first + 1
    to.write_text("\n".join(out) + "\n")
    return start


def transitions(args, session):
    out = subprocess.run([args.transitions, str(session)], capture_output=True, text=True, check=True)
    return {int(k): v["transitions"] for k, v in json.loads(out.stdout).items()}


def played_alone(args, folder, count, seconds):
    """Recordings of that length, K.hid; the transitions of each where it is played alone, and the longest's seconds."""
    expected, lasting = [], 0
    for k in range(count):
        to = folder / f"{k}.hid"
        lasting = max(lasting, lengthened(args.recordings[k % len(args.recordings)], seconds, to))
        alone = folder / f"alone-{k}.sculpt"
        subprocess.run([args.binary, "run", "--headless", "--play-device", to, "--session", alone], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        expected.append(sum(transitions(args, alone).values()))
    return expected, lasting


def begin(args, air, folder, people, host_words=(), words=lambda k: ()):
    keys, at = folder / "keys", "tcp/10.77.0.1:7447"
    host = Daemon(args.binary, air, 0, folder / "0", "--host", "rig", "--keys", keys, "--as", "person-0",
                  "--listen", at, *host_words)
    until("the host answers", lambda: host.hash())
    all_of = [host]
    for k in range(1, people):
        all_of.append(Daemon(args.binary, air, k, folder / str(k), "--join", "rig", "--key", keys / "sculptor.key",
                             "--as", f"person-{k}", "--listen", f"tcp/10.77.0.{k + 1}:7447", "--connect", at, *words(k)))
    return all_of


def strokes(args, folder, claim):
    count, seconds = args.people, args.minutes * 60
    expected, lasting = played_alone(args, folder, count, seconds)
    mesh = folder / "ball.ply"
    # A join takes about as long as its bytes at what TCP makes of such a network: 300 kbit/s.
    for words in [["run", "--headless", "--for", "0.1", "--export", folder / "fine.ply"],
                  ["decimate", folder / "fine.ply", "--faces", "40000", "-o", mesh]]:
        subprocess.run([args.binary, *words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    air = Air(count + 1, args.delay_ms / 1e3, args.loss, args.reorder, 0, args.seed)
    air.start()
    try:
        # Devices play from when a daemon has its world.
        all_of = begin(args, air, folder, count,
                       ["--mesh", mesh, "--session", folder / "host.sculpt", "--play-device", folder / "0.hid"],
                       lambda k: ["--play-device", folder / f"{k}.hid"])
        # A viewer takes nothing over: its file holds what all agree on, where it need not join anew.
        archive = Daemon(args.binary, air, count, folder / "archive", "--join", "rig", "--key", folder / "keys/viewer.key",
                         "--role", "viewer", "--as", "archive", "--connect", "tcp/10.77.0.1:7447", "--connect",
                         "tcp/10.77.0.2:7447", "--session", folder / "archive.sculpt")
        all_of.append(archive)
        claim(until("all are there", lambda: all(d.hash() for d in all_of), 300), f"{count} daemons and a viewer share a sculpture")
        begun, sent, received = time.monotonic(), air.sent[:], air.received[:]
        outages = [] if args.steady else [(0.25, {count - 1}), (0.5, set(range(count + 1))), (0.75, {0})]

        def traffic():
            took = time.monotonic() - begun
            for k in range(count):
                up, down = (air.sent[k] - sent[k]) * 8e-3 / took, (air.received[k] - received[k]) * 8e-3 / took
                text = f"person {k}: {up:.1f} kbit/s sent, {down:.1f} received of all {count}, with all headers"
                # The host sends everybody everybody's.
                if k == 0:
                    print(f"     {text}: the host", flush=True)
                else:
                    claim(up < 64 and (count > 2 or up + down < 64), text)

        for n, (share, cut) in enumerate(outages):
            time.sleep(max(0, begun + share * seconds - time.monotonic()))
            if n == 0:
                traffic()
            air.cut = cut
            time.sleep(10)
            air.cut = set()
            print(f"     10 s of nothing for {len(cut)} of {count} at {share * args.minutes:.1f} minutes", flush=True)
        time.sleep(max(0, begun + seconds - time.monotonic()))
        if not outages:
            traffic()
        time.sleep(max(0, begun + lasting + 5 - time.monotonic()))
        same = lambda: len({d.hash() for d in all_of}) == 1 and all_of[0].hash() is not None
        claim(until("all are level", same), f"all have the hash {all_of[0].hash()}")
        differs = sum(d.told("differs") for d in all_of)
        claim(differs == 0, f"{differs} comparisons in which a replica differed")
        takeovers = sum(d.told("takes over as the host") for d in all_of)
        print(f"     {takeovers} takeovers; {air.lost} packets lost", flush=True)
        own = [(d.ctl("people") or {}).get("own_input") or {} for d in all_of[:count]]
        for k, (o, taken) in enumerate(zip(own, expected)):
            # Batches are numbered without a gap, and stepped once, in the order of their numbers.
            whole = o and o["lost"] == 0 and o["batches"] == o["ordered"] == o["acknowledged"]
            claim(whole and o["transitions"] == taken,
                  f"person {k}: {o.get('transitions')} of {taken} transitions taken in, {o.get('ordered')} of "
                  f"{o.get('batches')} batches in the order of all, {o.get('acknowledged')} acknowledged, {o.get('lost')} lost")
        codes = [d.end() for d in all_of]
        claim(not any(codes), f"all end with {codes}")
        files = sorted(folder.glob("archive*.sculpt"))
        print(f"     the viewer has {len(files)} files: it was let in so often", flush=True)
        found = {}
        for file in files:
            for device, n in transitions(args, file).items():
                found[device >> 8] = found.get(device >> 8, 0) + n
        # People are numbered as they come.
        found = sorted(found.values())
        if len(files) == 1:
            claim(found == sorted(expected), f"transitions in the viewer's file: {found} of {sorted(expected)}")
        else:
            # What was stepped while it was away came to it in a checkpoint.
            print(f"     transitions in the viewer's files: {found} of {sorted(expected)}", flush=True)
    finally:
        for d in locals().get("all_of", []):
            d.kill()
        air.end()


def kills(args, folder, claim):
    """Three sculptors, of whom the host is killed again and again; two tablets that sculpt all the time; a viewer
    that records. What the tablets did is in the viewer's file, once; all files are whole."""
    random.seed(args.seed)
    sculptors, tablets = 3, 2
    # A kill and a return take about that long.
    seconds = args.times * 3.5
    expected, lasting = played_alone(args, folder, tablets, seconds)
    air = Air(sculptors + tablets + 1, args.delay_ms / 1e3, 0, 0, 0, args.seed)
    air.start()
    keys, serial = folder / "keys", [0]

    def ends(own):
        others = [k for k in range(sculptors) if k != own]
        return [word for k in others for word in ["--connect", f"tcp/10.77.0.{k + 1}:7447"]]

    def start(k, name, *words):
        serial[0] += 1
        return Daemon(args.binary, air, k, folder / f"home-{k}", *words, "--as", name, "--listen",
                      f"tcp/10.77.0.{k + 1}:7447", *ends(k))

    def sculptor(k):
        session = folder / f"sculptor-{k}-{serial[0]}.sculpt"
        return start(k, f"sculptor-{k}", "--join", "rig", "--key", keys / "sculptor.key", "--session", session)

    others = []
    try:
        all_of = [start(0, "sculptor-0", "--host", "rig", "--keys", keys, "--session", folder / "sculptor-0.sculpt")]
        until("the host answers", lambda: all_of[0].hash())
        all_of += [sculptor(k) for k in range(1, sculptors)]
        others.append(start(sculptors, "archive", "--join", "rig", "--key", keys / "viewer.key", "--role", "viewer",
                            "--session", folder / "archive.sculpt"))
        claim(until("all are there", lambda: all(d.hash() for d in all_of + others)), "three sculptors and a viewer")
        for k in range(tablets):
            others.append(start(sculptors + 1 + k, f"tablet-{k}", "--join", "rig", "--key", keys / "device.key",
                                "--role", "device", "--play-device", folder / f"{k}.hid"))
        begun, host, times = time.monotonic(), 0, []
        for n in range(args.times):
            time.sleep(random.uniform(0.2, 2.0))
            before = [d.told("takes over as the host") for d in all_of]
            all_of[host].kill()
            at = time.monotonic()
            rest = [k for k in range(sculptors) if k != host]
            new = lambda: [k for k in rest if all_of[k].told("takes over as the host") > before[k]]
            if not until("somebody takes over", new, 20, 0.01):
                claim(False, f"kill {n}: nobody took over")
                break
            times.append(time.monotonic() - at)
            gone, host = host, new()[0]
            all_of[gone] = sculptor(gone)
            if not until("it is back", lambda: all_of[gone].hash(), 60, 0.05):
                claim(False, f"kill {n}: the killed one did not come back")
                break
            if n % 10 == 9:
                print(f"     {n + 1} kills, {time.monotonic() - begun:.0f} s", flush=True)
        times.sort()
        claim(len(times) == args.times and times[-1] < 2,
              f"{len(times)} takeovers, median {times[len(times) // 2]:.2f} s, longest {times[-1]:.2f} s")
        time.sleep(max(0, begun + lasting + 5 - time.monotonic()))
        level = all_of + others[:1]
        same = lambda: len({d.hash() for d in level}) == 1 and level[0].hash() is not None
        claim(until("all are level", same), "all have one hash")
        final = level[0].hash()
        codes = [d.end() for d in others + all_of]
        claim(not any(codes), f"all end with {codes}")
        found = {}
        for file in sorted(folder.glob("archive*.sculpt")):
            for device, n in transitions(args, file).items():
                found[device >> 8] = found.get(device >> 8, 0) + n
        # Where the viewer had a frame that the next host had not, it joins anew, and that frame's input, which nobody had
        # acknowledged, comes again: it stands at the end of the old file too.
        pairs = list(zip(sorted(found.values()), sorted(expected)))
        once = len(list(folder.glob("archive*.sculpt"))) == 1
        claim(len(pairs) == tablets and all(f == e if once else f >= e for f, e in pairs),
              f"{found} of {expected} transitions of the tablets")
        hashes = []
        for file in sorted(folder.glob("sculptor-*.sculpt")) + sorted(folder.glob("archive*.sculpt")):
            out = subprocess.run([args.binary, "--json", "replay", str(file)], capture_output=True, text=True)
            hashes.append(json.loads(out.stdout)["hash"] if out.returncode == 0 else f"exit {out.returncode}")
            if out.returncode:
                print(f"     {file.name}: {out.stderr.strip()}", flush=True)
        broken = sum(h.startswith("exit") for h in hashes)
        claim(broken == 0, f"{len(hashes)} files, {broken} that cannot be replayed")
        claim(hashes.count(final) >= len(level), f"{hashes.count(final)} files end with the hash {final}, of {len(level)} that lived")
    finally:
        for d in others + locals().get("all_of", []):
            d.kill()
        air.end()


def join(args, folder, claim):
    small, mesh = folder / "small.ply", folder / "ball.ply"
    levels = max(0, round(math.log(args.vertices / 160_000, 4)))
    for words in [["run", "--headless", "--for", "0.1", "--export", small],
                  ["subdivide", "--scheme", "loop", "--levels", str(levels), small, "-o", mesh]]:
        subprocess.run([args.binary, *words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    air = Air(2, args.delay_ms / 1e3, 0, 0, args.mbit, args.seed)
    air.start()
    try:
        host = begin(args, air, folder, 1, ["--mesh", mesh, "--stats", folder / "stats.json"])[0]
        sent = air.sent[0]
        begun = time.monotonic()
        other = Daemon(args.binary, air, 1, folder / "1", "--join", "rig", "--key", folder / "keys/sculptor.key",
                       "--as", "person-1", "--connect", "tcp/10.77.0.1:7447")
        there = until("it has joined", lambda: other.ctl("status"), 600, 0.05)
        took = time.monotonic() - begun
        went = air.sent[0] - sent
        bound = went / (args.mbit * 125_000) + 2 if args.mbit else 5
        claim(there and took <= bound, f"{args.vertices} vertices joined in {took:.2f} s, {went / 1e6:.1f} MB; bound {bound:.2f} s")
        claim(host.hash() == other.hash(), "both have one hash")
        other.end()
        host.end()
        stats = json.loads((folder / "stats.json").read_text())
        claim(stats["tick_ms"]["p99"] < 8.33, f"the host's ticks meanwhile: p99 {stats['tick_ms']['p99']} ms, {stats['overruns']} overruns")
    finally:
        for d in [locals().get("host"), locals().get("other")]:
            if d:
                d.kill()
        air.end()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", default=ROOT / "target/release/sculptd")
    parser.add_argument("--transitions", default=ROOT / "target/release/examples/transitions")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=pathlib.Path, help="work here, and leave it")
    of = parser.add_subparsers(dest="what", required=True)
    one = of.add_parser("strokes")
    one.add_argument("--people", type=int, default=8)
    one.add_argument("--minutes", type=float, default=10)
    one.add_argument("--delay-ms", type=float, default=200)
    one.add_argument("--loss", type=float, default=0.01)
    one.add_argument("--reorder", type=float, default=0.02)
    one.add_argument("--steady", action="store_true", help="without the three times of 10 s of nothing")
    one.add_argument("recordings", nargs="+")
    one = of.add_parser("kills")
    one.add_argument("--times", type=int, default=100)
    one.add_argument("--delay-ms", type=float, default=5)
    one.add_argument("recordings", nargs="+")
    one = of.add_parser("join")
    one.add_argument("--vertices", type=int, default=10_000_000, help="about: 160,000 by powers of four")
    one.add_argument("--mbit", type=float, default=0, help="0: as fast as this program is")
    one.add_argument("--delay-ms", type=float, default=0)
    args = parser.parse_args()
    folder = args.keep or pathlib.Path(tempfile.mkdtemp(prefix="netns-"))
    folder.mkdir(parents=True, exist_ok=True)
    claim = Claims()
    try:
        {"strokes": strokes, "join": join, "kills": kills}[args.what](args, folder, claim)
    finally:
        if not args.keep:
            shutil.rmtree(folder, ignore_errors=True)
    print("all held" if not claim.failed else f"{claim.failed} did not hold")
    return 1 if claim.failed else 0


if __name__ == "__main__":
    sys.exit(main())
