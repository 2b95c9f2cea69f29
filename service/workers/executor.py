"""The interface of an executor, which computes tasks in worker processes, and the errors that it raises."""

from collections.abc import Callable, Sequence
from concurrent.futures import Future
from typing import Protocol, TypeVar

A = TypeVar("A")
R = TypeVar("R")


class ExecutorUnavailable(ConnectionError):
    """Nothing can be computed at present; the message states the cause."""


class TaskRefused(RuntimeError):
    """A worker refused a task for a reason that is not the task's; the message states it."""


class Executor(Protocol):
    """An executor of tasks in worker processes of this machine or of a Dask cluster."""

    def capacity(self) -> int:
        """Return how many tasks can be computed at once. Raises ExecutorUnavailable."""

    def submit(self, limit_s: float, work: Callable[[A], R], task: A) -> Future[R]:
        """Compute `work(task)`. work: a function of a module, which keeps to its own time limit of `limit_s` [s].

        The future ends in the task's exception, in BrokenProcessPool or WorkerStuck when its process died or stopped,
        in TaskRefused or Interrupted, or is cancelled when the executor lost it. Raises ExecutorUnavailable.
        """

    def check_tasks(self) -> None:
        """Check the tasks that are being computed; must be called regularly. Raises ExecutorUnavailable."""

    def require_workers(self) -> None:
        """Require that tasks find a worker. Raises ExecutorUnavailable when no worker process can be started.

        Executors whose `capacity` and `submit` raise it have nothing to do.
        """
        return

    def warnings(self) -> Sequence[str]:
        """Return the executor's problems that do not prevent computing."""

    def close(self) -> None:
        """Give up all tasks."""
