#!/usr/bin/env python3
"""Hands from a webcam, served as a hand tracker's WebSocket frames (protocol 6) on the loopback interface.

    pip install mediapipe opencv-python
    python3 webcam_hands.py --model hand_landmarker.task     # the model: MediaPipe's page "Hand Landmarker"
    sculptd run                                              # finds it where a tracker's service would be

--synthetic SECONDS serves a hand that opens, pinches and moves, with neither camera nor packages: to try the rest.
See README.md beside this file for what a webcam can and cannot tell, and for OpenXR's joints.
"""

import argparse
import base64
import hashlib
import json
import math
import socket
import struct
import sys
import threading
import time

# Millimetres from the camera at which the hand counts as over the tracker's middle, and how wide the camera sees there.
MIDDLE_MM = 450.0
# Tracker heights: the middle of the picture is this high over the (absent) device.
HEIGHT_MM = 200.0
# From the wrist to the knuckle of the middle finger of an adult; the apparent size of it tells the distance.
PALM_MM = 92.0
# A hand that moved further between two pictures is another one.
SAME_HAND_MM = 150.0
# What protocol 6 calls the joints, and MediaPipe's landmark for each; None: made up between wrist and knuckle. A thumb
# has no metacarpal of its own there: its first two joints are one.
JOINTS = ["carpPosition", "mcpPosition", "pipPosition", "dipPosition", "btipPosition"]
LANDMARKS = [[1, 1, 2, 3, 4], [None, 5, 6, 7, 8], [None, 9, 10, 11, 12], [None, 13, 14, 15, 16], [None, 17, 18, 19, 20]]
WIDTHS = [20.0, 18.0, 18.0, 17.0, 15.0]
MAX_FROM_CLIENT = 4096


def add(a, b):
    return [a[0] + b[0], a[1] + b[1], a[2] + b[2]]


def sub(a, b):
    return [a[0] - b[0], a[1] - b[1], a[2] - b[2]]


def scale(a, k):
    return [a[0] * k, a[1] * k, a[2] * k]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def length(a):
    return math.sqrt(sum(v * v for v in a))


def unit(a, otherwise):
    n = length(a)
    return scale(a, 1.0 / n) if n > 1e-6 else otherwise


def clamp(v, low=0.0, high=1.0):
    return max(low, min(high, v))


def in_tracker_space(world, image, aspect, focal):
    """World landmarks (metres about the hand, y down, z away from the camera) to the tracker's mm: x to the person's right, y
    up, z toward the person. `image`: landmarks as shares of a picture that is mirrored, as a mirror would show it;
    `focal`: in widths of the picture."""
    local = [[1000.0 * x, -1000.0 * y, 1000.0 * z] for x, y, z in world]
    flat = [[x, y / aspect] for x, y, _ in image]
    apparent = math.hypot(flat[9][0] - flat[0][0], flat[9][1] - flat[0][1])
    bone = sub(local[9], local[0])
    # Only what lies across the line of sight shows its size; a hand that points at the camera shows hardly any.
    across = max(math.hypot(bone[0], bone[1]), 0.3 * PALM_MM)
    distance = clamp(focal * across / max(apparent, 1e-3), 120.0, 1200.0)
    middle = [sum(p[0] for p in flat) / len(flat), sum(p[1] for p in flat) / len(flat)]
    centre = [
        (middle[0] - 0.5) * distance / focal,
        HEIGHT_MM - (middle[1] - 0.5 / aspect) * distance / focal,
        distance - MIDDLE_MM,
    ]
    mean = scale([sum(p[i] for p in local) for i in range(3)], 1.0 / len(local))
    return [add(centre, sub(p, mean)) for p in local]


def hand_of(points, left, confidence, hand_id, velocity, visible):
    """A hand and its five fingers as protocol 6 writes them. What MediaPipe does not tell is made up: the metacarpals' roots,
    grab, pinch and the arm."""
    wrist, index, middle, little = points[0], points[5], points[9], points[17]
    palm = scale([sum(points[k][i] for k in (0, 5, 9, 13, 17)) for i in range(3)], 0.2)
    direction = unit(sub(middle, wrist), [0.0, 0.0, -1.0])
    normal = cross(sub(index, wrist), sub(little, wrist))
    normal = unit(scale(normal, -1.0) if left else normal, [0.0, -1.0, 0.0])
    width = max(length(sub(index, little)) * 1.25, 40.0)
    reach = sum(length(sub(points[k], palm)) for k in (8, 12, 16, 20)) / 4.0 / width
    gap = length(sub(points[4], points[8]))
    hand = {
        "id": hand_id,
        "type": "left" if left else "right",
        "confidence": confidence,
        "palmPosition": palm,
        "stabilizedPalmPosition": palm,
        "palmNormal": normal,
        "palmVelocity": velocity,
        "direction": direction,
        "grabStrength": clamp((1.1 - reach) / 0.6),
        "pinchStrength": clamp(1.0 - (gap - 12.0) / 50.0),
        "timeVisible": visible,
        "palmWidth": width,
        "wrist": wrist,
        "elbow": add(wrist, scale(direction, -260.0)),
        "armWidth": 60.0,
        "sphereCenter": add(palm, scale(normal, 50.0)),
        "sphereRadius": 60.0,
        "r": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
        "s": 1,
        "t": [0, 0, 0],
    }
    pointables = []
    for kind, marks in enumerate(LANDMARKS):
        # A metacarpal begins beside the wrist: a sixth of the way to its knuckle.
        root = add(wrist, scale(sub(points[marks[1]], wrist), 0.16))
        joints = [root if m is None else points[m] for m in marks]
        straight = length(sub(joints[4], joints[1])) / max(sum(length(sub(joints[k + 1], joints[k])) for k in (1, 2, 3)), 1e-6)
        finger = {
            "id": 10 * hand_id + kind,
            "handId": hand_id,
            "type": kind,
            "tool": False,
            "length": sum(length(sub(joints[k + 1], joints[k])) for k in (1, 2, 3)),
            "width": WIDTHS[kind],
            "direction": unit(sub(joints[4], joints[3]), direction),
            "tipPosition": joints[4],
            "stabilizedTipPosition": joints[4],
            "tipVelocity": velocity,
            "extended": straight > 0.9,
            "timeVisible": visible,
            "touchZone": "none",
            "touchDistance": 1,
        }
        finger.update(zip(JOINTS, joints))
        pointables.append(finger)
    return hand, pointables


class Tracks:
    """Gives a hand the id that it had in the last picture."""

    def __init__(self):
        self.known, self.next_id, self.frame = [], 1, 0

    def frame_of(self, seen, now_us, rate):
        """`seen`: (points in tracker space, left, confidence) for each hand. The frame as a dictionary."""
        hands, pointables, known = [], [], []
        for points, left, confidence in seen:
            wrist = points[0]
            near = [k for k in self.known if k["left"] == left and length(sub(k["wrist"], wrist)) < SAME_HAND_MM]
            if near:
                mine = min(near, key=lambda k: length(sub(k["wrist"], wrist)))
                self.known.remove(mine)
                seconds = max((now_us - mine["us"]) / 1e6, 1e-3)
                velocity = scale(sub(wrist, mine["wrist"]), 1.0 / seconds)
            else:
                mine, velocity = {"id": self.next_id, "since": now_us}, [0.0, 0.0, 0.0]
                self.next_id += 1
            mine = {**mine, "left": left, "wrist": wrist, "us": now_us}
            known.append(mine)
            visible = (now_us - mine["since"]) / 1e6
            hand, fingers = hand_of(points, left, confidence, mine["id"], velocity, visible)
            hands.append(hand)
            pointables.extend(fingers)
        self.known = known
        self.frame += 1
        return {
            "id": self.frame,
            "timestamp": now_us,
            "currentFrameRate": rate,
            "r": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
            "s": 1,
            "t": [0, 0, 0],
            "interactionBox": {"center": [0, 200, 0], "size": [235.247, 235.247, 147.751]},
            "gestures": [],
            "hands": hands,
            "pointables": pointables,
        }


class Server:
    """A WebSocket server for a few clients on this machine. Web pages are turned away: they name an origin."""

    def __init__(self, port):
        self.clients, self.lock = [], threading.Lock()
        self.socket = socket.create_server(("127.0.0.1", port))
        self.port = self.socket.getsockname()[1]
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            client, _ = self.socket.accept()
            threading.Thread(target=self.serve, args=(client,), daemon=True).start()

    def serve(self, client):
        try:
            client.settimeout(5)
            request = b""
            while b"\r\n\r\n" not in request and len(request) < MAX_FROM_CLIENT:
                part = client.recv(1024)
                if not part:
                    return
                request += part
            lines = request.decode("latin-1").split("\r\n")
            headers = {k.lower(): v.strip() for k, _, v in (line.partition(":") for line in lines[1:])}
            path = (lines[0].split(" ") + ["", ""])[1]
            if "origin" in headers or "sec-websocket-key" not in headers or path not in ("/v6.json", "/v7.json"):
                client.sendall(b"HTTP/1.1 403 Forbidden\r\nContent-Length: 0\r\n\r\n")
                return
            key = headers["sec-websocket-key"] + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
            accept = base64.b64encode(hashlib.sha1(key.encode()).digest()).decode()
            head = f"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: {accept}\r\n\r\n"
            client.sendall(head.encode())
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            hello = {"serviceVersion": "webcam bridge", "version": 7 if path == "/v7.json" else 6}
            client.sendall(text_frame(json.dumps(hello)))
            with self.lock:
                self.clients.append(client)
            client.settimeout(None)
            # What a client wishes for is all the same here; reading keeps its buffer empty and shows when it goes.
            while client.recv(MAX_FROM_CLIENT):
                pass
        except OSError:
            pass
        finally:
            with self.lock:
                if client in self.clients:
                    self.clients.remove(client)
            client.close()

    def send(self, frame):
        data = text_frame(json.dumps(frame, allow_nan=False, separators=(",", ":")))
        with self.lock:
            for client in list(self.clients):
                try:
                    client.sendall(data)
                except OSError:
                    self.clients.remove(client)


def text_frame(text):
    data = text.encode()
    n = len(data)
    if n < 126:
        return struct.pack("!BB", 0x81, n) + data
    if n < 65536:
        return struct.pack("!BBH", 0x81, 126, n) + data
    return struct.pack("!BBQ", 0x81, 127, n) + data


def synthetic(seconds):
    """Landmarks as MediaPipe gives them, of a right hand that comes, opens and closes thumb and index finger, and goes."""
    start = time.monotonic()
    while (t := time.monotonic() - start) < seconds:
        pinch = 0.5 - 0.5 * math.cos(t * math.tau)
        world = [[0.0, 0.0, 0.0]] * 21
        for kind, x in enumerate([-0.035, -0.024, -0.003, 0.016, 0.034]):
            for k in range(4):
                world[1 + 4 * kind + k] = [x * (1.0 + 0.2 * k), -0.03 - 0.022 * k if kind == 0 else -0.085 - 0.028 * k, 0.0]
        meet = [-0.05, -0.11, 0.02]
        for tip in (4, 8):
            world[tip] = [a + (b - a) * 0.9 * pinch for a, b in zip(world[tip], meet)]
        # A camera whose picture is as wide as what it sees at its focal length, 0.45 m off.
        at = [0.5 + 0.2 * math.sin(t), 0.55]
        image = [[at[0] + x / 0.45, at[1] + (y + 0.08) / 0.45 * 16 / 9, z] for x, y, z in world]
        gone = 0.4 < t % 3.0 < 0.5
        yield [] if gone else [(world, image, False, 0.97)], 16 / 9
        time.sleep(1 / 60)


def webcam(model, camera):
    """Landmarks of every picture, which is mirrored first: MediaPipe tells left from right as in a mirror."""
    try:
        import cv2
        import mediapipe as mp
    except ImportError as e:
        sys.exit(f"{e}: pip install mediapipe opencv-python")
    vision = mp.tasks.vision
    options = vision.HandLandmarkerOptions(
        base_options=mp.tasks.BaseOptions(model_asset_path=model),
        running_mode=vision.RunningMode.VIDEO,
        num_hands=2,
    )
    source = cv2.VideoCapture(camera)
    if not source.isOpened():
        sys.exit(f"camera {camera} cannot be opened")
    with vision.HandLandmarker.create_from_options(options) as landmarker:
        start = time.monotonic()
        while True:
            good, picture = source.read()
            if not good:
                sys.exit("the camera gives no more pictures")
            picture = cv2.cvtColor(cv2.flip(picture, 1), cv2.COLOR_BGR2RGB)
            ms = int((time.monotonic() - start) * 1000)
            found = landmarker.detect_for_video(mp.Image(image_format=mp.ImageFormat.SRGB, data=picture), ms)
            seen = []
            for world, image, hand in zip(found.hand_world_landmarks, found.hand_landmarks, found.handedness):
                plain = lambda marks: [[m.x, m.y, m.z] for m in marks]
                seen.append((plain(world), plain(image), hand[0].category_name == "Left", hand[0].score))
            yield seen, picture.shape[1] / picture.shape[0]


def main():
    args = argparse.ArgumentParser(description="A webcam as a hand tracker")
    args.add_argument("--model", default="hand_landmarker.task", help="MediaPipe's model file")
    args.add_argument("--camera", type=int, default=0)
    args.add_argument("--port", type=int, default=6437, help="0: any free one")
    args.add_argument("--focal", type=float, default=1.0, help="focal length in picture widths; 1.0 is about 53 degrees")
    args.add_argument("--synthetic", type=float, metavar="SECONDS", help="no camera: a made-up hand")
    args = args.parse_args()
    server, tracks = Server(args.port), Tracks()
    print(f"ws://127.0.0.1:{server.port}/v6.json", flush=True)
    source = synthetic(args.synthetic) if args.synthetic else webcam(args.model, args.camera)
    last_us, rate = time.monotonic_ns() // 1000, 30.0
    for seen, aspect in source:
        now_us = time.monotonic_ns() // 1000
        rate += (1e6 / max(now_us - last_us, 1) - rate) * 0.05
        last_us = now_us
        hands = [(in_tracker_space(w, i, aspect, args.focal), left, score) for w, i, left, score in seen]
        server.send(tracks.frame_of(hands, now_us, round(rate, 1)))


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
