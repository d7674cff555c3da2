#!/usr/bin/env python3
"""Holds `sculptd boolean` against other ways to the same answer, and lists the answers that are silently wrong.

    python told_true.py path/to/sculptd shifts FOLDER_OF_MESHES [--every N] [--faces MOST] [--seconds S]
    python told_true.py path/to/sculptd parts [--count N] [--seconds S]
    python told_true.py path/to/sculptd shells [--count N] [--seconds S]

shifts: each closed mesh of the folder against itself shifted by 24 lengths from 1e-16 to 1e-2 of its size, straight and
    turned, in double precision, 9 digits, 6 decimals and single precision. All four volumes must add up, the difference
    must be Manifold's (manifold3d, PyPI) within what the answer itself states, and an answer that is not Manifold's must
    say that it depends on the tolerance (Manifold's own is not believed where it is more than the shift can sweep over). `--every N` runs each Nth scene; `--samples N` compares the results at N places
    near both surfaces, between them where there is room, with the winding numbers of the operands.
parts: flat-faced parts cut by turned ones, as written in STL, OBJ, PLY and 3MF: closed, manifold, no triangles that cross,
    at most 1.05 times Manifold's triangles.
shells: files of random overlapping and nested shells, some turned inside out, made one solid by `--solve winding`; the
    volume is compared with the sum over the cells of the boxes' grid, which is exact.

Exits with 1 where anything is wrong. Needs numpy and manifold3d.
"""
import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import manifold3d as m3
import numpy as np

BY = np.array([0.48, 0.6, 0.64])
STORED = ["double", "nine", "six", "single"]


def turn(angle):
    x, y, z = np.array([0.3, -0.7, 0.55]) / np.linalg.norm([0.3, -0.7, 0.55])
    c, s, k = np.cos(angle), np.sin(angle), 1 - np.cos(angle)
    return np.array(
        [
            [c + x * x * k, x * y * k - z * s, x * z * k + y * s],
            [y * x * k + z * s, c + y * y * k, y * z * k - x * s],
            [z * x * k - y * s, z * y * k + x * s, c + z * z * k],
        ]
    )


def stored(v, how):
    if how == "single":
        return v.astype(np.float32).astype(np.float64)
    form = {"nine": "%.8e", "six": "%.6f"}.get(how)
    if form is None:
        return v.copy()
    return np.array([float(form % x) for x in v.ravel()]).reshape(v.shape)


def write(path, v, t):
    faces = np.empty(len(t), dtype=[("n", "u1"), ("v", "<i4", 3)])
    faces["n"], faces["v"] = 3, t
    with open(path, "wb") as out:
        out.write(
            f"ply\nformat binary_little_endian 1.0\nelement vertex {len(v)}\nproperty double x\nproperty double y\n"
            f"property double z\nelement face {len(t)}\nproperty list uchar int vertex_indices\nend_header\n".encode()
        )
        out.write(v.astype("<f8").tobytes())
        out.write(faces.tobytes())


def read_off(path):
    """Corners and triangles of an OFF or COFF file of our own."""
    lines = Path(path).read_text().split("\n")
    n, m = map(int, lines[1].split()[:2])
    v = np.array([line.split()[:3] for line in lines[2 : 2 + n]], dtype=np.float64)
    rings = [[int(x) for x in line.split()] for line in lines[2 + n : 2 + n + m]]
    # Corners from the first on; a polygon as a fan.
    fans = [(r[1], r[k], r[k + 1]) for r in rings for k in range(2, r[0])]
    return v, np.array(fans, dtype=np.int64).reshape(-1, 3)


def volume(v, t):
    c = (v.max(0) + v.min(0)) / 2
    a, b, d = ((v[t[:, k]] - c) for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, d)).sum() / 6)


def area(v, t):
    a, b, c = (v[t[:, k]] for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def manifold(v, t):
    return m3.Manifold(m3.Mesh64(np.ascontiguousarray(v), np.ascontiguousarray(t, dtype=np.uint64)))


def command(binary, *words):
    start = time.perf_counter()
    try:
        done = subprocess.run([binary, *map(str, words), "--json"], capture_output=True, text=True, timeout=300)
    except subprocess.TimeoutExpired:
        return None, "no answer in 300 s", 300.0
    took = time.perf_counter() - start
    try:
        said = json.loads(done.stdout)
    except json.JSONDecodeError:
        said = None
    return (said if done.returncode == 0 else None), f"{done.returncode}: {done.stderr.strip()[-300:]}", took


def meshes(binary, folder, most, work):
    """Closed, oriented, outward meshes that do not cross themselves, as triangles."""
    for file in sorted(Path(folder).iterdir()):
        if file.suffix.lower() not in (".obj", ".off", ".stl", ".ply") or file.stat().st_size > 90 * most:
            continue
        facts, _, _ = command(binary, "info", file)
        if facts is None or facts["triangles"] > most:
            continue
        out = work / "mesh.off"
        said, _, _ = command(binary, "convert", file, out, "--weld", 0, "--triangulate")
        facts, _, _ = command(binary, "info", out) if said else (None, "", 0)
        if not facts or not facts["closed"] or not facts["manifold"] or facts["self_intersections"]:
            continue
        v, t = read_off(out)
        if np.abs(v).max() > 1e30:
            continue
        if facts["volume"] and facts["volume"] > 0 and manifold(v, t).status() == m3.Error.NoError:
            yield file.name, v, t


def winding(v, t, points):
    """The winding number of a mesh at points (Van Oosterom and Strackee, 1983)."""
    out = np.zeros(len(points))
    if not len(t):
        return out
    corners = v[t]
    for n, q in enumerate(points):
        a, b, c = (corners[:, k] - q for k in range(3))
        la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        top = np.einsum("ij,ij->i", a, np.cross(b, c))
        dot = lambda x, y: np.einsum("ij,ij->i", x, y)
        below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
        out[n] = np.arctan2(top, below).sum() / (2 * np.pi)
    return out


def sample_fault(work, a, b, t, by, tolerance, count, seed):
    """Where the results, at places near both surfaces, are not what the operands' winding numbers say; and how many
    places were told. Left out: places within twice the tolerance of a surface, where the numbers change."""
    rng = np.random.default_rng(seed)
    faces = rng.integers(0, len(t), count)
    weights = rng.dirichlet([1, 1, 1], count)
    p = np.einsum("ij,ijk->ik", weights, a[t[faces]])
    n = np.cross(a[t[faces, 1]] - a[t[faces, 0]], a[t[faces, 2]] - a[t[faces, 0]])
    n /= np.maximum(np.linalg.norm(n, axis=1), 1e-300)[:, None]
    # Between the surfaces where there is room, else just beside both.
    between = by / 2 > 4 * tolerance
    middle = p + np.where(rng.random(count) < 0.5, 0.5, 1.5)[:, None] * by * BY
    beside = p + n * (4 * tolerance + by) * rng.choice([-1, 1], count)[:, None]
    places = middle if between else beside
    jitter = [np.zeros(3), *(2 * tolerance * np.eye(3)), *(-2 * tolerance * np.eye(3))]
    told = [np.stack([winding(m, t, places + j) for j in jitter]) for m in (a, b)]
    clear = np.all([(abs(w - w[0]).max(0) < 0.02) & (abs(w[0] - w[0].round()) < 0.02) for w in told], axis=0)
    places = places[clear]
    ina, inb = (w[0][clear] > 0.5 for w in told)
    wanted = {"union": ina | inb, "intersection": ina & inb, "difference": ina & ~inb, "reverse-difference": inb & ~ina}
    faults = []
    for name, want in wanted.items():
        v, faces = read_off(work / f"out-{name}.off")
        wrong = int(((winding(v, faces, places) > 0.5) != want).sum())
        if wrong:
            faults.append(f"{name} is wrong at {wrong} of {len(places)} places")
    return faults, len(places)


def shift_fault(binary, work, v, t, length, angle, how, samples):
    """What is wrong with the answer, whether it was an error, and the seconds it took."""
    size = np.abs(v).max()
    a = v @ turn(angle).T
    b = stored(a + BY * length * size, how)
    a = stored(a, how)
    write(work / "a.ply", a, t)
    write(work / "b.ply", b, t)
    said, error, took = command(binary, "boolean", "all", work / "a.ply", work / "b.ply", "-o", work / "out.off")
    if said is None:
        return f"error {error}", True, took
    va, vb, s = volume(a, t), volume(b, t), area(a, t)
    made = {r["name"]: r for r in said["results"]}
    u, i, d, r = (made[n]["volume"] for n in ("union", "intersection", "difference", "reverse-difference"))
    if None in (u, i, d, r):
        return f"a result without a volume {made}", False, took
    bound = said["volume_bound"]
    off = max(abs(u + i - va - vb), abs(d + i - va), abs(r + i - vb))
    faults = []
    if off > bound * 1.001 + 1e-12 * va:
        faults.append(f"volumes do not add up by {off:.3e} (stated {bound:.3e})")
    one, other = manifold(a, t), manifold(b, t)
    theirs = (one - other).volume()
    # Manifold takes places within its own precision as one.
    near = bound + s * np.abs(a).max() * 1e-11
    # No more can be in A - B than the surface sweeps over on its way from A to B, and no less than nothing:
    # where Manifold says more or less, it is wrong.
    most = np.linalg.norm(b - a, axis=1).max() * max(s, area(b, t)) * 1.001 + near
    if not -near <= theirs <= most:
        faults.append(f"note: Manifold says {theirs:.6e} where at most {most:.6e} can be")
        if not -bound <= d <= most:
            faults.append(f"A - B {d:.6e}, at most {most:.6e} can be")
    elif abs(d - theirs) > near + 1e-6 * theirs and abs(theirs + (one ^ other).volume() - va) > bound + 1e-12 * va:
        faults.append(f"note: Manifold's A - B and A & B are not A: {theirs:.6e}, ours {d:.6e}")
    elif abs(d - theirs) > near + 1e-6 * theirs:
        far = abs(d - theirs) > near + s * 2 * said["tolerance"]
        if far or not said["depends_on_tolerance"]:
            faults.append(f"A - B {d:.6e}, Manifold {theirs:.6e}, tolerance {said['tolerance']:.1e}, depends {said['depends_on_tolerance']}")
    if samples:
        wrong, told = sample_fault(work, a, b, t, length * size, said["tolerance"], samples, samples + int(-np.log10(length) * 100))
        faults += wrong
        shift_fault.told += told
    for name, m in made.items():
        if not (m["closed"] and m["manifold"]):
            faults.append(f"{name} closed {m['closed']} manifold {m['manifold']}")
        if m["self_intersections"]:
            faults.append(f"note: {name} crosses itself {m['self_intersections']} times")
    return "; ".join(faults), False, took


shift_fault.told = 0


def shifts(args, work):
    wrong = crossed = errors = scenes = count = 0
    slow = []
    end = time.monotonic() + args.seconds
    for name, v, t in meshes(args.binary, args.folder, args.faces, work):
        count += 1
        for k, exponent in enumerate(np.linspace(-16, -2, 24)):
            for way in range(8):
                number = (count * 24 + k) * 8 + way
                if number % args.every != args.first % args.every:
                    continue
                if time.monotonic() > end:
                    break
                angle, how = (0.0, 0.7)[way // 4], STORED[way % 4]
                scenes += 1
                fault, error, took = shift_fault(args.binary, work, v, t, 10.0**exponent, angle, how, args.samples)
                errors += error
                slow.append((took, name, len(t)))
                real = [f for f in fault.split("; ") if f and not f.startswith("note: ")]
                crossed += "crosses itself" in fault
                wrong += bool(real) and not error
                if fault:
                    print(f"{name} ({len(t)}) by 1e{exponent:.2f}, {angle}, {how}: {fault}", flush=True)
    print(f"shifts: {count} meshes, {scenes} scenes, {wrong} silently wrong, {errors} errors, {crossed} with a result that crosses itself, {shift_fault.told} places told by the winding number")
    for took, name, faces in sorted(slow, reverse=True)[:8]:
        print(f"   {took:.1f} s {name} ({faces} faces)")
    return wrong


def flat_part(n, rng):
    """Two flat-faced solids, the second turned."""
    cube = lambda *size: m3.Manifold.cube(size, True)
    a = cube(4, 3 + 0.01 * n, 1)
    kind = n % 5
    if kind == 1:
        a = a + cube(1, 1, 3).translate([0.5, 0.2, 0])
    elif kind == 2:
        a = a - cube(1, 1, 3).translate([0.5, 0.2, 0])
    elif kind == 3:
        a = m3.Manifold.extrude(m3.CrossSection([[(0, 0), (4, 0), (4, 1), (1, 1), (1, 3), (0, 3)]]), 2).translate([-1, -1, -1])
    elif kind == 4:
        a = m3.Manifold.cylinder(2, 1.5, 1.2, 6 + n % 7, True)
    b = cube(2, 1, 4) if n % 2 else m3.Manifold.cylinder(3, 0.7, 0.7, 5 + n % 9, True)
    b = b.rotate(list(rng.uniform(-180, 180, 3))).translate(list(rng.uniform(-0.5, 0.5, 3)))
    if n % 3 == 0:
        a, b = (m.rotate([31, 17, 53]) for m in (a, b))
    return a, b


def arrays(m):
    mesh = m.to_mesh64()
    return np.asarray(mesh.vert_properties)[:, :3].copy(), np.asarray(mesh.tri_verts).astype(np.int64).copy()


def parts(args, work):
    wrong = results = ours = theirs = 0
    rng = np.random.default_rng(7)
    end = time.monotonic() + args.seconds
    names = {"union": "__add__", "difference": "__sub__", "intersection": "__xor__"}
    for n in range(args.count):
        if time.monotonic() > end:
            break
        a, b = flat_part(n, rng)
        kind = ["stl", "obj", "ply", "3mf"][n % 4]
        for name, m in zip("ab", (a, b)):
            write(work / f"{name}.ply", *arrays(m))
        said, error, _ = command(args.binary, "boolean", "all", work / "a.ply", work / "b.ply", "-o", work / f"part.{kind}")
        if said is None:
            print(f"part {n}: {error}")
            wrong += 1
            continue
        (va, ta), (vb, tb) = arrays(a), arrays(b)
        a, b = manifold(va, ta), manifold(vb, tb)
        for made in said["results"]:
            peer = b - a if made["name"] == "reverse-difference" else getattr(a, names[made["name"]])(b)
            results += 1
            facts, _, _ = command(args.binary, "info", made["file"]) if made["faces"] else ({"self_intersections": 0, "triangles": 0}, "", 0)
            faults = []
            if not (made["closed"] and made["manifold"]):
                faults.append("not a closed manifold")
            if made["self_intersections"] or facts["self_intersections"]:
                faults.append(f"crosses itself {made['self_intersections']} {facts['self_intersections']} times")
            ours, theirs = ours + facts["triangles"], theirs + peer.num_tri()
            if facts["triangles"] > 1.05 * peer.num_tri() + 0.5:
                faults.append(f"{facts['triangles']} triangles for {peer.num_tri()}")
            near = 1e-9 if kind == "ply" or kind == "obj" else 1e-6
            if abs(made["volume"] - peer.volume()) > near * max(a.volume(), 1e-30):
                faults.append(f"volume {made['volume']} for {peer.volume()}")
            if faults:
                wrong += 1
                print(f"part {n} {made['name']} {kind}: {'; '.join(faults)}", flush=True)
    print(f"parts: {results} results, {wrong} wrong, {ours} triangles for Manifold's {theirs}")
    return wrong


def box(lo, hi, inside_out):
    v, t = arrays(m3.Manifold.cube(list(hi - lo)).translate(list(lo)))
    return v, t[:, ::-1] if inside_out else t


def shells(args, work):
    wrong = loud = 0
    rng = np.random.default_rng(11)
    end = time.monotonic() + args.seconds
    done = 0
    for n in range(args.count):
        if time.monotonic() > end:
            break
        done += 1
        boxes = []
        for k in range(int(rng.integers(2, 7))):
            lo = rng.uniform(0, 6, 3)
            hi = lo + rng.uniform(1, 4, 3)
            if n % 3 == 1:
                lo, hi = np.round(lo), np.round(hi) + 1
            if n % 4 == 2 and k > 0:
                # Within the first.
                first = boxes[0]
                span = first[1] - first[0]
                lo = first[0] + span * rng.uniform(0.05, 0.4, 3)
                hi = first[0] + span * rng.uniform(0.6, 0.95, 3)
            boxes.append((lo, hi))
        # Every third file has a cavity: a box within the first, inside out.
        cavity = n % 3 == 0
        turned = [False] * len(boxes)
        if cavity:
            lo, hi = boxes[0]
            boxes.append((lo + (hi - lo) * 0.3, lo + (hi - lo) * 0.7))
            turned.append(True)
        spin = turn(0.7 * (n % 2))
        vs, ts, base = [], [], 0
        for (lo, hi), back in zip(boxes, turned):
            v, t = box(lo, hi, back)
            vs.append(v @ spin.T)
            ts.append(t + base)
            base += len(v)
        write(work / "shells.ply", np.concatenate(vs), np.concatenate(ts))
        # Exact: cells of the grid of all coordinates, in the frame of the boxes.
        lines = [np.unique(np.array([[b[0][k], b[1][k]] for b in boxes])) for k in range(3)]
        middles = [(x[1:] + x[:-1]) / 2 for x in lines]
        x, y, z = np.meshgrid(*middles, indexing="ij")
        winding = np.zeros(x.shape, int)
        for (lo, hi), back in zip(boxes, turned):
            within = (x > lo[0]) & (x < hi[0]) & (y > lo[1]) & (y < hi[1]) & (z > lo[2]) & (z < hi[2])
            winding += np.where(within, -1 if back else 1, 0)
        sizes = np.einsum("i,j,k->ijk", *(np.diff(l) for l in lines))
        want = float(sizes[winding > 0].sum())
        said, error, _ = command(args.binary, "convert", work / "shells.ply", work / "solved.ply", "--mend")
        if said is None:
            loud += 1
            print(f"shells {n}: {error}", flush=True)
        elif said["volume"] is None or abs(said["volume"] - want) > 1e-7 * want:
            wrong += 1
            print(f"shells {n}: volume {said['volume']} for {want} ({len(boxes)} boxes, cavity {cavity}): {said['warnings']}", flush=True)
    print(f"shells: {done} files, {wrong} wrong, {loud} errors")
    return wrong + loud


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binary")
    parser.add_argument("what", choices=["shifts", "parts", "shells"])
    parser.add_argument("folder", nargs="?")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--samples", type=int, default=0)
    parser.add_argument("--faces", type=int, default=20_000)
    parser.add_argument("--count", type=int, default=None)
    parser.add_argument("--seconds", type=float, default=1e9)
    args = parser.parse_args()
    if args.count is None:
        args.count = {"parts": 200, "shells": 1000}.get(args.what, 0)
    with tempfile.TemporaryDirectory() as folder:
        wrong = {"shifts": shifts, "parts": parts, "shells": shells}[args.what](args, Path(folder))
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
