"""Threads for those requests that wait for a computation: others are served as if they were not there."""

from collections.abc import Iterator
from contextlib import contextmanager

from anyio import from_thread
from anyio.to_thread import current_default_thread_limiter


@contextmanager
def another_thread() -> Iterator[None]:
    """Let the server use one more thread for requests while this one waits or computes.

    Call it from a thread that serves a request. How many may be in it at a time is the caller's to bound.
    """
    from_thread.run_sync(_change, 1)
    try:
        yield
    finally:
        from_thread.run_sync(_change, -1)


def _change(by: int) -> None:
    current_default_thread_limiter().total_tokens += by
