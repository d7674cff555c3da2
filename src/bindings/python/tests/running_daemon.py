"""A daemon of SCULPTD_BINARY without a window, in a home of its own."""

import os
import pathlib
import subprocess
import tempfile
import time

BINARY = os.environ.get("SCULPTD_BINARY")


class RunningDaemon:
    """`socket` is where it listens, `environment` what its clients need to find it."""

    def __init__(self):
        self.folder = tempfile.TemporaryDirectory()
        home = pathlib.Path(self.folder.name)
        self.socket = home / "sculptd.sock"
        self.environment = {**os.environ, "XDG_RUNTIME_DIR": str(home), "HOME": str(home)}
        for name in ("XDG_DATA_HOME", "XDG_CONFIG_HOME", "DISPLAY", "WAYLAND_DISPLAY"):
            self.environment.pop(name, None)
        self.log = open(home / "log", "wb")
        self.process = subprocess.Popen(
            [BINARY, "run", "--headless", "--for", "120", "--session", str(home / "session")],
            env=self.environment,
            stdout=self.log,
            stderr=self.log,
        )
        until = time.monotonic() + 60
        while not self.socket.exists() and self.process.poll() is None:
            if time.monotonic() > until:
                raise TimeoutError("the daemon opens no socket")
            time.sleep(0.05)

    def stop(self):
        self.process.terminate()
        self.process.wait(60)
        self.log.close()
        self.folder.cleanup()
