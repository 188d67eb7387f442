"""Firefox without a window, driven by its Marionette protocol: a length, a colon, and JSON."""

import json
import shutil
import socket
import subprocess
import time
from contextlib import contextmanager, suppress

START_S = 60.0


class Firefox:
    """One window of a browser that listens."""

    def __init__(self, stream):
        self._stream = stream
        self._count = 0
        self._read()  # its greeting
        self.ask("WebDriver:NewSession", {})
        self.ask("WebDriver:SetTimeouts", {"pageLoad": 120_000, "script": 120_000})

    def ask(self, command, given):
        self._count += 1
        words = json.dumps([0, self._count, command, given]).encode()
        self._stream.write(b"%d:" % len(words) + words)
        self._stream.flush()
        _, _, error, value = self._read()
        if error:
            raise RuntimeError(f"{command}: {error['message']}")
        return value

    def _read(self):
        length = b""
        while not length.endswith(b":"):
            length += self._stream.read(1)
        return json.loads(self._stream.read(int(length[:-1])))

    def open(self, address):
        """Open a page, until its document is loaded."""
        self.ask("WebDriver:Navigate", {"url": address})

    def run(self, script):
        """The value that a script returns."""
        return self.ask("WebDriver:ExecuteScript", {"script": script, "args": []})["value"]

    def until(self, truth, limit_s=60.0):
        """Wait until an expression is true."""
        end = time.monotonic() + limit_s
        while not self.run(f"return Boolean({truth})"):
            assert time.monotonic() < end, f"never true: {truth}"
            time.sleep(0.05)


@contextmanager
def firefox(folder):
    """A Firefox with a profile of its own in an empty folder; None where there is none."""
    program = shutil.which("firefox-esr") or shutil.which("firefox")
    if program is None:
        yield None
        return
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    (folder / "user.js").write_text(f'user_pref("marionette.port", {port});\n')
    words = [program, "--headless", "--marionette", "--no-remote", "--profile", str(folder)]
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        with _connected(port) as channel, channel.makefile("rwb") as stream:
            yield Firefox(stream)
    finally:
        process.kill()
        process.wait()


def _connected(port):
    end = time.monotonic() + START_S
    while True:
        with suppress(OSError):
            return socket.create_connection(("127.0.0.1", port))
        assert time.monotonic() < end, "Firefox does not listen"
        time.sleep(0.1)
