"""A daemon that answers each request with the request itself, late and between events."""

import json
import os
import random
import socket
import tempfile
import threading
import time


class FakeDaemon:
    """Listens on `path`. An answer takes up to `delay` seconds; an event comes before some."""

    def __init__(self, delay=0.0, seed=1):
        self.folder = tempfile.TemporaryDirectory()
        self.path = os.path.join(self.folder.name, "sculptd.sock")
        self.delay, self.random = delay, random.Random(seed)
        self.requests = 0
        self.connections = []
        self.listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.listener.bind(self.path)
        self.listener.listen()
        threading.Thread(target=self.accept, daemon=True).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.listener.close()
        self.drop()
        self.folder.cleanup()

    def drop(self):
        """Closes every connection."""
        for connection in self.connections:
            try:
                connection.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass  # It is closed already.

    def accept(self):
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            self.connections.append(connection)
            threading.Thread(target=self.serve, args=(connection,), daemon=True).start()

    def serve(self, connection):
        with connection, connection.makefile("rb") as lines:
            try:
                for line in lines:
                    self.answer(connection, json.loads(line))
            except (OSError, ValueError):
                return

    def answer(self, connection, request):
        self.requests += 1
        if self.delay:
            time.sleep(self.random.random() * self.delay)
        out = [{"jsonrpc": "2.0", "id": request["id"], "result": request}]
        if request["method"] == "frobnicate":
            out = [{"jsonrpc": "2.0", "id": request["id"], "error": {"code": -1, "message": "no"}}]
        if request["method"] == "subscribe" or self.random.random() < 0.1:
            notice = {"event": "work", "after": request["id"]}
            out.insert(0, {"jsonrpc": "2.0", "method": "event", "params": notice})
        for message in out:
            connection.sendall(json.dumps(message).encode() + b"\n")
