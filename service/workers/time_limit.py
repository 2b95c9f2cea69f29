"""The time limit of a task, enforced by the process that computes it."""

import faulthandler
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

GRACE_S = 10.0
"""Time after the limit within which a process must notice that its time is over."""
REPEAT_S = 1.0
"""Time after which the error is raised again: an error within a destructor or a callback of native code is lost."""

SOON_S = 1e-3
"""Time after which a limit that is over already takes effect: zero would switch it off."""


class OutOfTime(RuntimeError):
    """A task exceeded its time limit."""


@contextmanager
def limit_time(seconds: float) -> Iterator[None]:
    """Limit the time of the block [s]. Raises OutOfTime; a process that hangs in native code is ended some seconds later."""
    if threading.current_thread() is not threading.main_thread():
        raise RuntimeError("a task needs a process of its own to keep to its time")
    signal.signal(signal.SIGALRM, _out_of_time)
    signal.setitimer(signal.ITIMER_REAL, seconds, REPEAT_S)
    faulthandler.dump_traceback_later(seconds + GRACE_S, exit=True)
    try:
        yield
    finally:
        try:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        finally:
            faulthandler.cancel_dump_traceback_later()


@contextmanager
def reserve_time(seconds: float) -> Iterator[None]:
    """Limit a block within `limit_time` so that at least so much of its time is left afterwards [s]. Raises OutOfTime."""
    left, repeat = signal.getitimer(signal.ITIMER_REAL)
    began = time.monotonic()
    signal.setitimer(signal.ITIMER_REAL, max(left - seconds, SOON_S), repeat)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, max(left - (time.monotonic() - began), SOON_S), repeat)


def _out_of_time(_number: int, _frame: FrameType | None) -> None:
    raise OutOfTime("the identification took longer than allowed")
