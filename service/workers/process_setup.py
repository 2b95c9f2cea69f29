"""Setting up a worker process: priority, memory limit, signals, and its end together with the parent."""

import os
import resource
import signal
import threading
from multiprocessing import parent_process
from multiprocessing.connection import wait

import threadpoolctl

NICENESS = 10
"""Niceness of workers: storing and answering take precedence over identifying when cores are scarce."""


def set_up(memory_bytes: int, niceness: int) -> None:
    """Prepare this process for tasks; called once, before the first.

    It computes with one BLAS thread, within the memory limit, and gives way to its parent by `niceness`. It ignores the
    terminal's Ctrl-C, and ends when its parent does.
    """
    os.nice(niceness)
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
