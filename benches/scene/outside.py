"""A scene as other programs see it: glTF by trimesh (nodes, names, transforms) and by pygltflib
(morph targets), OBJ by trimesh (faces of a quad file with texture coordinates and materials), and
glTF read in again with its morph targets as layers.

    python3 -m venv VENV && VENV/bin/pip install trimesh pygltflib numpy
    VENV/bin/python benches/scene/outside.py target/release/sculptd
"""

import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np
import pygltflib
import trimesh

PROGRAM = os.path.abspath(sys.argv[1])
FOLDER = tempfile.mkdtemp()
ENVIRONMENT = dict(os.environ, XDG_RUNTIME_DIR=FOLDER, XDG_CONFIG_HOME=FOLDER,
                   XDG_DATA_HOME=FOLDER, HOME=FOLDER)


def ask(method, **params):
    done = subprocess.run([PROGRAM, "--json", "ctl", method, json.dumps(params)], env=ENVIRONMENT,
                          capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{method}: {done.stdout}{done.stderr}")
    return json.loads(done.stdout)


def file(name):
    return os.path.join(FOLDER, name)


def array(gltf, number):
    """The numbers of an accessor of single-precision vectors."""
    accessor = gltf.accessors[number]
    view = gltf.bufferViews[accessor.bufferView]
    begin = (view.byteOffset or 0) + (accessor.byteOffset or 0)
    data = gltf.binary_blob()[begin:begin + 12 * accessor.count]
    return np.frombuffer(data, "<f4").reshape(-1, 3).astype(float)


def stroke(high):
    points = [[0.35, high, 0.9, 0], [0.5, high, 0.9, 300], [0.65, high, 0.9, 600]]
    ask("stroke", points=points, space="view", brush={"kind": "draw", "radius": 0.3})
    time.sleep(1.0)  # The answer may come before the last tick of the stroke.


def scene():
    ask("scene.rename", id=0, name="head")
    for name, high in [("wrinkles", 0.45), ("scar", 0.55)]:
        ask("layers.add", name=name)
        stroke(high)
    ask("layers.set", layer=0, intensity=0.75)
    ask("layers.set", layer=1, intensity=-1.5)
    turn = [0.1, 0.7, -0.3, 0.2]
    place = {"shift": [4.0, 1.0, -2.0], "turn": turn, "scale": 1.5}
    box = ask("scene.add", primitive={"box": [1, 2, 3]}, edge=0.5, name="hat", transform=place)
    path = file("scene.glb")
    told = ask("export", path=path, objects="all")
    ask("export", path=file("head.obj"), objects={"object": 0})
    return path, box["id"], place, told["warnings"]


def by_trimesh(path, place):
    loaded = trimesh.load(path)
    nodes = sorted(loaded.graph.nodes_geometry)
    print(f"trimesh {trimesh.__version__}: nodes {nodes}")
    assert nodes == ["hat", "head"]
    matrix, _ = loaded.graph["hat"]
    x, y, z, w = np.array(place["turn"]) / np.linalg.norm(place["turn"])
    wanted = trimesh.transformations.quaternion_matrix([w, x, y, z])
    wanted[:3, :3] *= place["scale"]
    wanted[:3, 3] = place["shift"]
    off = np.abs(matrix - wanted).max()
    print(f"transform of 'hat' off by {off:.1e}")
    assert off < 1e-6
    hat = loaded.geometry[loaded.graph["hat"][1]]
    assert hat.is_watertight and abs(hat.volume - 6.0) < 1e-4
    targets = [k for k in loaded.geometry[loaded.graph["head"][1]].metadata if "arget" in k]
    print(f"trimesh keeps of morph targets: {targets or 'nothing, it shows the base'}")


def by_pygltflib(path):
    gltf = pygltflib.GLTF2().load(path)
    head = next(n for n in gltf.nodes if n.name == "head")
    mesh = gltf.meshes[head.mesh]
    primitive = mesh.primitives[0]
    names = mesh.extras["targetNames"]
    print(f"pygltflib: morph targets {names}, weights {mesh.weights}")
    assert names == ["wrinkles", "scar"] and np.allclose(mesh.weights, [0.75, -1.5])
    seen = array(gltf, primitive.attributes.POSITION)
    for target, weight in zip(primitive.targets, mesh.weights):
        number = target["POSITION"] if isinstance(target, dict) else target.POSITION
        offsets = array(gltf, number)
        print(f"  {np.count_nonzero(np.abs(offsets).max(axis=1))} vertices moved by a target")
        seen = seen + weight * offsets
    lines = (line.split() for line in open(file("head.obj")) if line.startswith("v "))
    surface = np.array([[float(n) for n in line[1:4]] for line in lines])
    off = np.abs(seen - surface).max()
    print(f"base and weighted targets against the surface that is seen: off by {off:.1e}")
    assert seen.shape == surface.shape and off < 1e-6


def again(path):
    """The head alone, out and in again: its layers come with it."""
    one = file("head.glb")
    ask("export", path=one, objects={"object": 0})
    ask("scene.add", path=one, name="twin")
    layers = ask("layers.list")["layers"]
    told = [(layer["name"], layer["intensity"]) for layer in layers]
    print(f"read in again: layers {told}")
    assert told == [("wrinkles", 0.75), ("scar", -1.5)]


def quads():
    """A quad file with texture coordinates and materials, strokes, and what trimesh reads."""
    grid = np.arange(48 * 24).reshape(48, 24)
    faces = [[grid[i, j], grid[(i + 1) % 48, j], grid[(i + 1) % 48, (j + 1) % 24],
              grid[i, (j + 1) % 24]] for i in range(48) for j in range(24)]
    angles = [(2 * np.pi * i / 48, 2 * np.pi * j / 24) for i in range(48) for j in range(24)]
    vertices = np.array([[(3 + np.cos(b)) * np.cos(a), (3 + np.cos(b)) * np.sin(a), np.sin(b)]
                         for a, b in angles])
    path = file("ring.obj")
    with open(path, "w") as out:
        out.write("mtllib ring.mtl\n")
        for v in vertices:
            out.write("v {} {} {}\n".format(*v))
        for i in range(49):
            for j in range(25):
                out.write(f"vt {i / 48} {j / 24}\n")
        for n, face in enumerate(faces):
            if n % 288 == 0:
                out.write(f"g part{n // 288}\n")
            if n % 576 == 0:
                out.write(f"usemtl metal{n // 576}\n")
            i, j = divmod(n, 24)
            uv = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            corners = [f"{v + 1}/{a * 25 + b + 1}" for v, (a, b) in zip(face, uv)]
            out.write("f " + " ".join(corners) + "\n")
    ring = ask("scene.add", path=path, name="ring")["id"]
    ask("camera", distance=14.0, target=[0, 0, 0])
    stroke(0.5)
    result = file("out.obj")
    warnings = ask("export", path=result, objects={"object": ring})["warnings"]

    def words(line):
        """Numbers of texture coordinates by their values: 1 and 1.0 are one."""
        head, *rest = line.split()
        return (head, *(map(float, rest) if head == "vt" else rest))

    def kept(name):
        """The lines of each kind in their order, faces and what groups them together."""
        lines = [words(line) for line in open(name) if line.strip()]
        return [[w for w in lines if w[0] in kinds]
                for kinds in (("mtllib",), ("vt",), ("f", "g", "usemtl"))]

    def places(name):
        return [line for line in open(name) if line.startswith("v ")]

    same = kept(path) == kept(result)
    moved = sum(a != b for a, b in zip(places(path), places(result)))
    print(f"quads: {len(faces)} faces, every line of f, g, usemtl, vt, mtllib the same: {same}; "
          f"{moved} of {len(vertices)} vertices moved; warnings {warnings}")
    assert same and moved > 50 and not warnings
    open(file("ring.mtl"), "w").write("newmtl metal0\nKd 1 0 0\nnewmtl metal1\nKd 0 1 0\n")
    read = trimesh.load(result, process=False, force="scene")
    parts = [(len(g.faces), g.visual.uv.shape) for g in read.geometry.values()]
    print(f"trimesh reads {sum(p[0] for p in parts)} triangles in {len(parts)} parts with "
          "texture coordinates")
    assert sum(p[0] for p in parts) == 2 * len(faces)


def main():
    daemon = subprocess.Popen([PROGRAM, "run", "--headless"], env=ENVIRONMENT,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        while not os.path.exists(file("sculptd.sock")):
            time.sleep(0.05)
        path, _, place, warnings = scene()
        print(f"told of the glTF: {warnings}")
        by_trimesh(path, place)
        by_pygltflib(path)
        again(path)
        quads()
        print("all as it should be")
    finally:
        daemon.terminate()
        daemon.wait()


main()
