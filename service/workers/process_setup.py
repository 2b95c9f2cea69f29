"""Setting up a worker process: priority, memory limit, signals, and the end together with its parent."""

import os
import resource
import signal
import threading
from multiprocessing import parent_process
from multiprocessing.connection import wait

import threadpoolctl

NICENESS = 10
"""Storing and answering come before identifying, where there are fewer cores than work."""


def set_up(memory_bytes: int) -> None:
    """Prepare this process for tasks; called once, before the first.

    It computes with one BLAS thread and may hold so much memory of its own. Whoever else waits for the processor comes first.
    It ignores the terminal's Ctrl-C, and ends when its parent does.
    """
    os.nice(NICENESS)
    resource.setrlimit(resource.RLIMIT_DATA, (memory_bytes, memory_bytes))
    threadpoolctl.threadpool_limits(1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)
