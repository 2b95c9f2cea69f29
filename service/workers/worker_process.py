"""The side of a pool's worker process: it receives pickled tasks through a pipe, and sends their results or errors back.

A process imports this module and its tasks, and none of what its parent needs to manage it.
"""

import contextlib
import pickle
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection

from service.workers import process_setup

HERE = b"here"
"""Sent when the process is ready, and when it has received a task."""


@dataclass(frozen=True)
class WorkerSetup:
    """The setup sent to each process at its start; unpickling its tasks there imports their modules."""

    memory_bytes: int
    niceness: int
    tasks: tuple[Callable[..., object], ...]


def serve(pipe: Connection, setup: WorkerSetup) -> None:
    """Compute one task after the other in the process, until the parent closes the pipe or is gone."""
    process_setup.set_up(setup.memory_bytes, setup.niceness)
    with contextlib.suppress(EOFError, BrokenPipeError, ConnectionResetError):  # what a task raises is part of its outcome
        pipe.send_bytes(HERE)
        while True:
            payload = pipe.recv_bytes()
            pipe.send_bytes(HERE)
            pipe.send_bytes(_outcome(payload))


def _outcome(payload: bytes) -> bytes:
    try:
        work, args, kwargs = pickle.loads(payload)
        return pickle.dumps((True, work(*args, **kwargs)))
    except Exception as error:  # noqa: BLE001 - whatever it is, it is told
        return failed(error)


def failed(error: BaseException) -> bytes:
    """Pickle an error for another process; as a RuntimeError with its message when it does not survive pickling."""
    try:
        told = pickle.dumps((False, error))
        pickle.loads(told)
    except Exception:  # noqa: BLE001 - errors may be anything
        return pickle.dumps((False, RuntimeError(f"{type(error).__name__}: {error}")))
    return told
