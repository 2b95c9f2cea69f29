"""Keeps BLAS to one thread while a machine is fitted: its matrices are small, and threads only get in each other's way."""

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Keep BLAS to one thread within, where threadpoolctl is installed; without it the fit is only slower."""
    try:
        from threadpoolctl import threadpool_limits
    except ImportError:
        yield
        return
    with threadpool_limits(1):
        yield
