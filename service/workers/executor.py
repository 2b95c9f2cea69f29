"""The interface of an executor, which computes tasks in worker processes, and the errors that it raises."""

from collections.abc import Callable, Sequence
from concurrent.futures import Future
from typing import Protocol, TypeVar

A = TypeVar("A")
R = TypeVar("R")


class ExecutorUnavailable(ConnectionError):
    """Nothing can be computed at present; the message says why."""


class TaskRefused(RuntimeError):
    """A worker did not take a task, which is not the task's fault; the message says why."""


class Executor(Protocol):
    """Computes tasks in worker processes: of this machine, or of a Dask cluster."""

    def capacity(self) -> int:
        """Return how many tasks can be computed at once. Raises ExecutorUnavailable."""

    def submit(self, limit_s: float, work: Callable[[A], R], task: A) -> Future[R]:
        """Compute `work(task)`. work: a function of a module, which keeps to its own time limit of `limit_s` [s].

        The future ends in what the task raises, in BrokenProcessPool or WorkerStuck where its process died or stopped
        answering, in TaskRefused or Interrupted, or is cancelled where the executor lost it. Raises ExecutorUnavailable.
        """

    def look(self) -> None:
        """Check the tasks that are being computed; to be called every now and then. Raises ExecutorUnavailable."""

    def warnings(self) -> Sequence[str]:
        """Return what is wrong with the executor, though it computes."""

    def close(self) -> None:
        """Give up what is being computed."""
