"""A contact sheet of strokes: each brush on a flat square and on one with relief, shaded.

    python3 benches/strokes/sheet.py PROGRAM OUT.png [--beside FOLDER] [--rest] [BRUSH ...]

Each brush, with its own preset, draws one straight stroke (radius 0.2, pressure 0.7, 151 reports in 1.2 s)
over a square of side 2 with 301 x 301 vertices, seen from the front; the relief is 0.02 sin(9x + 1) cos(8y).
With --beside, another program's vertices after the same stroke are drawn to the left of ours: the folder
holds `blender34_flat.npz` and `blender34_relief.npz`, arrays of 301 x 301 places (x slowest) by brush.
That picture is for looking at: it is made of another program's data and is not kept here.

With --rest, the pen stays where the stroke ends, before it lifts, for two seconds, and trembles by 0.5 mm of a
tablet 152 mm high. How far that takes vertices from where the stroke alone leaves them is printed, as a share
of the stroke's height.
Needs numpy.
"""
import math, struct, subprocess, sys, tempfile, zlib
import numpy as np

N, RADIUS, HALF_VIEW, ASPECT = 301, 0.2, 1.05, 1.6
# Half a millimetre on a tablet 152 mm high, as far as the view shows it.
TREMBLE = 0.5 / 152 * 2 * HALF_VIEW
# A pen's report descriptor: a tip switch, in range, pressure of 11 bits, 40,000 x 24,000 units.
DESCRIPTOR = bytes.fromhex(
    '050d0902a10185070920a100094209440945093c093215002501750195058102950381030501093075109501a4550d65133500'
    '46102726409c8102093146701726c05d8102b4050d093026ff078102093d093e15c4253c750895028102c0c0')
# Ours, and the other program's name for it.
BRUSHES = {
    'draw': 'SculptDraw', 'clay': 'Clay', 'clay-strips': 'Clay_Strips', 'layer': 'Layer',
    'inflate': 'Inflate_Deflate', 'blob': 'Blob', 'crease': 'Crease', 'gaussian': None, 'texture': None,
    'smooth': 'Smooth', 'surface-smooth': None, 'sharpen': None, 'flatten': 'Flatten_Contrast',
    'fill': 'Fill_Deepen', 'scrape': 'Scrape_Peaks', 'plane': None, 'trim': None,
    'multiplane-scrape': 'Multi-plane_Scrape', 'pinch': 'Pinch_Magnify', 'nudge': 'Nudge',
}
COLUMNS = 2


def form(relief):
    x, y = np.meshgrid(*[np.linspace(-1, 1, N)] * 2, indexing='ij')
    return np.stack([x, y, 0.02 * np.sin(9 * x + 1) * np.cos(8 * y) if relief else 0 * x], -1)


def write_obj(path, places):
    i = np.arange(N - 1)[:, None] * N + np.arange(N - 1)[None, :] + 1
    quads = np.stack([i, i + N, i + N + 1, i + 1], -1).reshape(-1, 4)
    with open(path, 'w') as f:
        f.writelines('v %.9g %.9g %.9g\n' % tuple(p) for p in places.reshape(-1, 3))
        f.writelines('f %d %d %d %d\n' % tuple(q) for q in quads)


def write_recording(path, rest):
    def report(u, v, pressure, near):
        flags = (1 if pressure else 0) | (0x10 if near else 0)
        x, y = int(round((0.5 + u / (2 * HALF_VIEW * ASPECT)) * 40000)), int(round(12000 + v / (2 * HALF_VIEW) * 24000))
        return struct.pack('<BBHHHBB', 7, flags, x, y, int(round(pressure * 2047)), 0, 0)
    events = [(0.05, -0.6, 0, 0, True)]
    events += [(0.1 + 0.008 * k, -0.6 + 1.2 * k / 150, 0, 0.7, True) for k in range(151)]
    dice = np.random.default_rng(5)
    for k in range(250 if rest else 0):
        off = dice.uniform(-TREMBLE, TREMBLE, 2)
        events.append((1.308 + 0.008 * k, 0.6 + off[0], off[1], 0.7, True))
    end = events[-1][0] + 0.02
    events += [(end, 0.6, 0, 0, True), (end + 0.1, 0.6, 0, 0, False)]
    with open(path, 'w') as f:
        f.write('D: 0\nR: %d %s\nN: a pen\nP: usb-0000:00:14.0-1/input0\nI: 3 1234 5678\n'
                % (len(DESCRIPTOR), DESCRIPTOR.hex(' ')))
        for t, u, v, pressure, near in events:
            b = report(u, v, pressure, near)
            f.write('E: %06d.%06d %d %s\n' % (int(t), round(t % 1 * 1e6), len(b), b.hex(' ')))


def stroke(program, brush, relief, rest=False):
    """The places after a stroke, and before."""
    before = form(relief)
    corners = before.reshape(-1, 3)
    extent = float(np.linalg.norm(corners.max(0) - corners.min(0))) / 2
    with tempfile.TemporaryDirectory() as d:
        write_obj(d + '/form.obj', before)
        write_recording(d + '/stroke.hid', rest)
        with open(d + '/sculptd.toml', 'w') as f:
            f.write('[camera]\nfov_degrees = 40.0\naspect = %g\northographic = true\nyaw_degrees = 0.0\n'
                    'pitch_degrees = 0.0\n[brush]\nkind = "%s"\nradius = %.6f\n'
                    'pressure_radius = { at_zero = 1.0, gamma = 1.0 }\n' % (ASPECT, brush, RADIUS / extent))
        run = subprocess.run(
            [program, 'run', '--headless', '--mesh', d + '/form.obj', '--config', d + '/sculptd.toml',
             '--play-device', d + '/stroke.hid', '--play-area', 'full', '--export', d + '/out.obj', '--json'],
            capture_output=True, text=True)
        if run.returncode:
            sys.exit('%s: %s' % (brush, run.stderr.strip()))
        lines = (line.split()[1:4] for line in open(d + '/out.obj') if line.startswith('v '))
        return np.array([[float(c) for c in line] for line in lines]).reshape(N, N, 3), before


def shaded(places):
    """Grey by the light from the upper left, the part of the square that the stroke is in."""
    normal = np.cross(np.gradient(places, axis=0), np.gradient(places, axis=1))
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True) + 1e-20
    light = np.array([-0.5, 0.6, 0.62])
    lit = np.clip(normal @ (light / np.linalg.norm(light)), 0, 1)[30:271, 95:206]
    return (255 * np.clip(0.15 + 0.9 * lit, 0, 1)).astype(np.uint8).T[::-1]


def write_png(path, grey):
    def chunk(kind, data):
        return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))
    height, width = grey.shape
    rows = b''.join(b'\0' + row.tobytes() for row in grey)
    with open(path, 'wb') as f:
        f.write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', width, height, 8, 0, 0, 0, 0))
                + chunk(b'IDAT', zlib.compress(rows, 9)) + chunk(b'IEND', b''))


def main():
    args = sys.argv[1:]
    others = None
    if '--beside' in args:
        at = args.index('--beside')
        folder = args[at + 1]
        del args[at:at + 2]
        others = {r: np.load('%s/blender34_%s.npz' % (folder, 'relief' if r else 'flat')) for r in (False, True)}
    rest = '--rest' in args
    args = [a for a in args if a != '--rest']
    program, out, brushes = args[0], args[1], args[2:] or list(BRUSHES)
    cells = []
    for brush in brushes:
        row = []
        for relief in (False, True):
            ours, before = stroke(program, brush, relief)
            height = float(np.linalg.norm(ours - before, axis=-1).max())
            if rest:
                alone, (ours, _) = ours, stroke(program, brush, relief, True)
                most = float(np.linalg.norm(ours - alone, axis=-1).max())
                print('%s, %s: %.4f high, %.2f %% further by a rest of two seconds'
                      % (brush, 'relief' if relief else 'flat', height, 100 * most / max(height, 1e-12)), flush=True)
            if others is not None:
                name = BRUSHES.get(brush)
                theirs = others[relief][name] if name in others[relief] else None
                row.append(np.full_like(shaded(ours), 60) if theirs is None
                           else shaded(theirs.reshape(N, N, 3)))
                if theirs is not None:
                    there = float(np.abs(theirs.reshape(N, N, 3) - before)[..., 2].max())
                    print('%s, %s: %.4f high, theirs %.4f'
                          % (brush, 'relief' if relief else 'flat', height, there), flush=True)
            row.append(shaded(ours))
        cells.append(np.concatenate(row, 1))
    columns = 1 if others is not None else COLUMNS
    while len(cells) % columns:
        cells.append(np.full_like(cells[0], 255))
    gap = np.full((cells[0].shape[0], 6), 255, np.uint8)
    rows = []
    for i in range(0, len(cells), columns):
        line = [piece for cell in cells[i:i + columns] for piece in (cell, gap)][:-1]
        rows += [np.concatenate(line, 1), np.full((3, sum(p.shape[1] for p in line)), 255, np.uint8)]
    write_png(out, np.concatenate(rows[:-1], 0))


main()
