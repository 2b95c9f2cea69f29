"""Rundown's commands in processes that have loaded the service's modules already: to load them takes longer than to start it.

A process of each run of tests loads them once, opens nothing and begins no thread, and is forked for each command, which then
runs as `python -m service …` does: its own arguments, environment, folder and log, its own end.

    python -m tests.end_to_end.prepared NUMBER_OF_A_SOCKET
"""

import atexit
import contextlib
import functools
import gc
import json
import os
import runpy
import select
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Sequence
from typing import IO, Any

LONGEST_MESSAGE = 2**18
FORK_TIMEOUT_S = 60.0
"""Longest time until a process is there [s], the first loading included, on a machine that is busy with other tests."""


class PreparedProcess(subprocess.Popen[bytes]):
    """A command that was forked; whoever forked it tells its end, as the system tells that only to a parent."""

    def __init__(
        self, arguments: Sequence[str], output: IO[Any], environment: dict[str, str], *, errors: IO[Any] | None = None
    ) -> None:
        """Fork a process for a command. errors: where its errors go, by default where its output goes. Raises TimeoutError."""
        self._told, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.args = ["rundown", *arguments]
        self.returncode = None
        self.stdin = self.stdout = self.stderr = None
        request = {"arguments": arguments, "environment": environment, "folder": os.getcwd()}
        with theirs:
            files = [theirs.fileno(), output.fileno(), (errors or output).fileno()]
            socket.send_fds(_fork_server(), [json.dumps(request).encode()], files)
        if (pid := self._next_number(FORK_TIMEOUT_S)) is None:
            self._told.close()  # a process that comes later is ended at once
            raise TimeoutError(f"no process after {FORK_TIMEOUT_S:.0f} s")
        self.pid = pid

    def poll(self) -> int | None:
        """Return how it ended, None while it runs."""
        if self.returncode is None:
            self._note_end(0.0)
        return self.returncode

    def wait(self, timeout: float | None = None) -> int:
        """Return how it ended, once it has. Raises TimeoutExpired."""
        if self.returncode is None:
            self._note_end(timeout)
        if self.returncode is None:
            raise subprocess.TimeoutExpired(self.args, timeout or 0.0)
        return self.returncode

    def _note_end(self, timeout: float | None) -> None:
        try:
            status = self._next_number(timeout)
        except ProcessLookupError:
            with contextlib.suppress(ProcessLookupError):
                os.kill(self.pid, signal.SIGKILL)
            status = signal.SIGKILL  # as a parent is told it
        if status is not None:
            self.returncode = os.waitstatus_to_exitcode(status)
            self._told.close()

    def _next_number(self, timeout: float | None) -> int | None:
        if not select.select([self._told], [], [], timeout)[0]:
            return None
        told = self._told.recv(LONGEST_MESSAGE)
        if not told:
            raise ProcessLookupError("the process that forks is gone")
        return int(told)


@functools.cache
def _fork_server() -> socket.socket:
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with theirs:
        command = [sys.executable, "-m", "tests.end_to_end.prepared", str(theirs.fileno())]
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, pass_fds=[theirs.fileno()])

    def end() -> None:
        ours.close()
        process.wait(FORK_TIMEOUT_S)

    atexit.register(end)
    return ours


def main(requests: socket.socket) -> None:
    """Fork a process for each request until nobody can ask any more; in each of them, run what was asked for."""
    _load()
    woken, wake = socket.socketpair()
    wake.setblocking(False)
    woken.setblocking(False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    signal.set_wakeup_fd(wake.fileno(), warn_on_full_buffer=False)
    running: dict[int, int] = {}
    while True:
        ready, _, _ = select.select([requests, woken], [], [])
        with contextlib.suppress(BlockingIOError):
            woken.recv(LONGEST_MESSAGE)
        _tell_ends(running)
        if requests not in ready:
            continue
        message, files, _, _ = socket.recv_fds(requests, LONGEST_MESSAGE, 3)
        if not message:
            return
        tell, output, errors = files
        pid = os.fork()
        if pid == 0:
            signal.set_wakeup_fd(-1)
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            for one in (requests, woken, wake):
                one.close()
            for file in (tell, *running.values()):
                os.close(file)
            _become(output, errors, **json.loads(message))
            return
        os.close(output)
        os.close(errors)
        running[pid] = tell
        if not _send(tell, pid):
            os.kill(pid, signal.SIGKILL)


def _load() -> None:
    """Import what the commands do, under the same conditions."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    gc.disable()
    import service.commands.app
    import service.commands.serve
    import service.sources.simulator  # noqa: F401

    gc.freeze()
    assert len(os.listdir("/proc/self/task")) == 1, "a module starts a thread: processes that are forked would lack it"


def _become(output: int, errors: int, arguments: list[str], environment: dict[str, str], folder: str) -> None:
    os.dup2(output, 1)
    os.dup2(errors, 2)
    os.close(output)
    os.close(errors)
    os.environ.clear()
    os.environ.update(environment)
    time.tzset()
    os.chdir(folder)
    sys.argv[1:] = arguments
    gc.enable()
    runpy.run_module("service", run_name="__main__", alter_sys=True)


def _tell_ends(running: dict[int, int]) -> None:
    while running:
        pid, status = os.waitpid(-1, os.WNOHANG)
        if pid == 0:
            return
        tell = running.pop(pid)
        _send(tell, status)
        os.close(tell)


def _send(to: int, number: int) -> bool:
    """Tell a number; return whether anybody waits for it."""
    try:
        os.write(to, str(number).encode())
    except BrokenPipeError:
        return False
    return True


if __name__ == "__main__":
    main(socket.socket(fileno=int(sys.argv[1])))
