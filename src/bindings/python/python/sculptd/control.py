"""A client of the daemon's control socket: JSON-RPC 2.0, one message a line.

    from sculptd.control import Client

    with Client() as daemon:
        daemon.stroke([(0.3, 0.5, 0.8, 0), (0.7, 0.5, 0.8, 400)], radius=0.1)
        print(daemon.status()["dabs"])
        daemon.export("/tmp/sculpture.stl")

Every method of the protocol is a method of the client: ``daemon.call("camera", {"yaw": 0.5})`` and
``daemon.camera(yaw=0.5)`` are the same. ``take-up`` and other names with a hyphen are written with
an underscore, and names with a dot as they are: ``daemon.scene.list()``. The schema is
``src/control/schema.json``; type checkers and editors read the methods, their parameters and their
replies from ``control.pyi``, which is generated from it.

A reply comes after its effect. Each reply is matched with its request by its id: after a time-out
or a Ctrl-C the next call gets its own answer. Threads may share a client; they take turns. A client
that lost its connection connects again with the next call. ``Client(wait=10.0)`` waits up to ten
seconds for a daemon that is still starting.

`AsyncClient` has the same methods for asyncio::

    async with AsyncClient() as daemon:
        await daemon.subscribe()
        async for event in daemon.events(patience=5.0):
            print(event)

It is pure Python over a Unix socket and needs nothing of the native module.
"""

import asyncio
import json
import os
import socket
import tempfile
import threading
import time
from collections import deque

__all__ = [
    "AsyncClient",
    "Client",
    "DaemonAbsent",
    "DaemonError",
    "DaemonRefused",
    "DaemonSilent",
    "default_path",
]

#: Versions of the protocol that this client speaks, oldest first.
VERSIONS = (1, 2)
#: Longest reply that is read, bytes.
MAX_REPLY = 256 << 20
#: Between two attempts to connect, while a daemon is waited for.
RETRY_SECONDS = 0.05
#: Events that are kept while an answer is waited for; the oldest are dropped beyond.
KEPT_EVENTS = 1024


class DaemonError(Exception):
    """The base of this module's exceptions."""


class DaemonAbsent(DaemonError, ConnectionError):
    """Nothing listens on the socket. Attribute: ``path``."""

    def __init__(self, path):
        super().__init__(
            f"no daemon is running (nothing listens on {path}); start one with `sculptd run`"
        )
        self.path = path


class DaemonSilent(DaemonError, TimeoutError):
    """The daemon did not answer in time, or closed the connection."""


class DaemonRefused(DaemonError):
    """The daemon refused a request. Attributes: ``code`` (JSON-RPC), ``message``, ``method``."""

    def __init__(self, method, code, message):
        super().__init__(f"{method}: {message} ({code})")
        self.method = method
        self.code = code
        self.message = message


def default_path():
    """Where a daemon listens unless it is told otherwise."""
    runtime = os.environ.get("XDG_RUNTIME_DIR")
    if runtime:
        return os.path.join(runtime, "sculptd.sock")
    return os.path.join(tempfile.gettempdir(), f"sculptd-{os.getuid()}", "sculptd.sock")


class _Method:
    """A method of the protocol, and the methods whose names begin with its name and a dot."""

    def __init__(self, client, name):
        self._client = client
        self._name = name

    def __call__(self, **params):
        return self._client.call(self._name, params)

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        return _Method(self._client, f"{self._name}.{name.replace('_', '-')}")


class _Protocol:
    """The methods of the protocol, over `call` of the class that has a connection."""

    def call(self, method, params=None, patience=None):
        """Calls a method by its name and returns its reply."""
        raise NotImplementedError

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        return _Method(self, name.replace("_", "-"))

    def hello(self):
        """Agrees on a version with the daemon; raises `DaemonRefused` where there is none."""
        return self.call("hello", {"versions": {"min": VERSIONS[0], "max": VERSIONS[1]}})

    def stroke(self, points, space="view", **brush):
        """A stroke of a virtual pen, recorded like one of a tablet.

        ``points``: rows of x, y, pressure, t_ms in view coordinates (0 to 1), or of x, y, z,
        pressure, t_ms with ``space="world"``; time rises by at least 1 ms. Further arguments are
        settings of the brush for this stroke alone, e.g. ``kind="crease", radius=0.1``.
        Returns when the daemon has taken all its samples.
        """
        params = {"points": [[float(v) for v in row] for row in points], "space": space}
        if brush:
            params["brush"] = brush
        return self.call("stroke", params)

    def export(self, path):
        """Writes the sculpture; the name's ending says the format."""
        return self.call("export", {"path": os.path.abspath(os.fspath(path))})

    def load(self, path):
        """Replaces the sculpture by a mesh from a file."""
        return self.call("load", {"path": os.path.abspath(os.fspath(path))})


def _request(own, method, params):
    request = {"jsonrpc": "2.0", "id": own, "method": method, "params": params or {}}
    return json.dumps(request).encode() + b"\n"


def _result(method, answer):
    error = answer.get("error")
    if error is not None:
        raise DaemonRefused(method, error["code"], error["message"])
    return answer.get("result")


class Client(_Protocol):
    """A connection to a running daemon; one request at a time, by any thread.

    ``path``: the socket, `default_path` unless told. ``patience``: seconds that an answer may take.
    ``wait``: seconds for which a connection is tried again while nothing listens, for a daemon that
    is still starting or starts anew. Raises `DaemonAbsent` where nothing listens by then.
    """

    def __init__(self, path=None, patience=120.0, wait=0.0):
        self.path = os.fspath(path) if path is not None else default_path()
        self.patience = patience
        self.wait = wait
        self._turn = threading.RLock()
        self._sent = 0
        self._subscribed = False
        self._events = deque(maxlen=KEPT_EVENTS)
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._connect()

    def _connect(self):
        self.close()
        self._read = b""
        until = time.monotonic() + self.wait
        while True:
            self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            try:
                self._socket.settimeout(self.patience)
                self._socket.connect(self.path)
                break
            except OSError as e:
                self._socket.close()
                if time.monotonic() + RETRY_SECONDS > until:
                    raise DaemonAbsent(self.path) from e
            time.sleep(RETRY_SECONDS)
        if self._subscribed:
            # Its answer has the id of no later request, so it is passed over.
            self._send("subscribe", None)
        self._torn = False

    def close(self):
        """Closes the connection; the next call opens another."""
        #: A message may have been sent or read in part: the connection is good for nothing more.
        self._torn = True
        self._socket.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _send(self, method, params):
        self._sent += 1
        self._torn = True
        self._socket.settimeout(self.patience)
        try:
            self._socket.sendall(_request(self._sent, method, params))
        except OSError as e:
            raise DaemonSilent(f"{self.path}: {e}") from e
        self._torn = False
        return self._sent

    def call(self, method, params=None, patience=None):
        """Calls a method by its name and returns its reply.

        Raises `DaemonRefused` with the daemon's code and message, `DaemonSilent` where no answer
        comes within ``patience`` seconds, the client's unless told.
        """
        patience = self.patience if patience is None else patience
        with self._turn:
            if self._torn:
                self._connect()
            own = self._send(method, params)
            until = time.monotonic() + patience
            while True:
                answer = self._line(until)
                if answer is None:
                    raise DaemonSilent(f"{self.path}: no answer to {method} in {patience} s")
                if answer.get("method") == "event":
                    self._events.append(answer["params"])
                    continue
                # An answer to an earlier request, which nobody waits for any more. A refusal
                # without an id is about the connection.
                if answer.get("id") not in (own, None):
                    continue
                result = _result(method, answer)
                self._subscribed = self._subscribed or method == "subscribe"
                return result

    def next_event(self, patience=None):
        """The next event after `subscribe`, a dict; None where none comes within ``patience``."""
        with self._turn:
            if self._events:
                return self._events.popleft()
            if self._torn:
                self._connect()
            until = time.monotonic() + (self.patience if patience is None else patience)
            while True:
                line = self._line(until)
                if line is None:
                    return None
                if line.get("method") == "event":
                    return line["params"]

    def events(self, patience=None):
        """Yields events after `subscribe`, until none comes within ``patience`` seconds."""
        while (event := self.next_event(patience)) is not None:
            yield event

    def _line(self, until):
        """One message; None where it does not come in time."""
        try:
            while b"\n" not in self._read:
                left = until - time.monotonic()
                if left <= 0.0:
                    return None
                self._socket.settimeout(left)
                try:
                    more = self._socket.recv(1 << 16)
                except TimeoutError:
                    return None
                except OSError as e:
                    raise DaemonSilent(f"{self.path}: {e}") from e
                if not more:
                    raise DaemonSilent(f"{self.path}: the daemon closed the connection")
                self._read += more
                if len(self._read) > MAX_REPLY:
                    raise DaemonError(f"a reply of more than {MAX_REPLY} bytes")
            line, self._read = self._read.split(b"\n", 1)
            return json.loads(line)
        except BaseException:
            # A Ctrl-C too: what was just received may be lost.
            self._torn = True
            raise


class AsyncClient(_Protocol):
    """A connection to a running daemon for asyncio. Its methods are those of `Client`, awaited.

    Tasks may share a client; each gets the answer to its request. Cancelling a task, or the end of
    its ``patience``, drops the answer of that task only.
    """

    def __init__(self, path=None, patience=120.0, wait=0.0):
        self.path = os.fspath(path) if path is not None else default_path()
        self.patience = patience
        self.wait = wait
        self._sent = 0
        self._waiting = {}
        self._subscribed = False
        self._events = deque(maxlen=KEPT_EVENTS)
        self._event_came = asyncio.Event()
        self._turn = asyncio.Lock()
        self._receiver = None
        self._writer: asyncio.StreamWriter

    async def __aenter__(self):
        await self._connect()
        return self

    async def __aexit__(self, *_):
        await self.close()

    async def close(self):
        """Closes the connection; the next call opens another."""
        if self._receiver is not None:
            self._writer.close()
            await asyncio.wait([self._receiver])

    async def _connect(self):
        async with self._turn:
            if self._receiver is not None and not self._receiver.done():
                return
            until = time.monotonic() + self.wait
            while True:
                try:
                    reader, self._writer = await asyncio.open_unix_connection(
                        self.path, limit=MAX_REPLY
                    )
                    break
                except OSError as e:
                    if time.monotonic() + RETRY_SECONDS > until:
                        raise DaemonAbsent(self.path) from e
                await asyncio.sleep(RETRY_SECONDS)
            self._receiver = asyncio.create_task(self._receive(reader, self._writer))
            if self._subscribed:
                self._send("subscribe", None)

    def _send(self, method, params):
        # The transport takes a message whole, whatever happens to the task afterwards.
        self._sent += 1
        self._writer.write(_request(self._sent, method, params))
        return self._sent

    async def call(self, method, params=None, patience=None):
        """Calls a method by its name and returns its reply; raises as `Client.call` does."""
        patience = self.patience if patience is None else patience
        await self._connect()
        answer = asyncio.get_running_loop().create_future()
        own = self._send(method, params)
        self._waiting[own] = answer
        try:
            await asyncio.wait([answer], timeout=patience)
        finally:
            del self._waiting[own]
        if not answer.done():
            raise DaemonSilent(f"{self.path}: no answer to {method} in {patience} s")
        result = _result(method, answer.result())
        self._subscribed = self._subscribed or method == "subscribe"
        return result

    async def next_event(self, patience=None):
        """The next event after `subscribe`, a dict; None where none comes within ``patience``."""
        until = time.monotonic() + (self.patience if patience is None else patience)
        while not self._events:
            await self._connect()
            self._event_came.clear()
            try:
                await asyncio.wait_for(self._event_came.wait(), until - time.monotonic())
            except asyncio.TimeoutError:
                return None
        return self._events.popleft()

    async def events(self, patience=None):
        """Yields events after `subscribe`, until none comes within ``patience`` seconds."""
        while (event := await self.next_event(patience)) is not None:
            yield event

    async def _receive(self, reader, writer):
        """Gives each message to the task that waits for it, until the connection ends."""
        reason = "the daemon closed the connection"
        try:
            while line := await reader.readline():
                self._take(json.loads(line))
        except ValueError:
            reason = f"a reply that is cut off or has more than {MAX_REPLY} bytes"
        except OSError as e:
            reason = str(e)
        finally:
            writer.close()
            for answer in self._waiting.values():
                if not answer.done():
                    answer.set_exception(DaemonSilent(f"{self.path}: {reason}"))

    def _take(self, message):
        if message.get("method") == "event":
            self._events.append(message["params"])
            self._event_came.set()
            return
        own = message.get("id")
        # A refusal without an id is about the connection. An id that is not here is of a request
        # that nobody waits for any more.
        for answer in [a for n, a in self._waiting.items() if own in (n, None)]:
            if not answer.done():
                answer.set_result(message)
