"""Where identifications are computed: worker processes of this machine, or a Dask cluster."""

from collections.abc import Callable, Sequence
from concurrent.futures import Future
from typing import Protocol, TypeVar

from service.processes import SeparateProcesses
from service.settings import Settings

A = TypeVar("A")
R = TypeVar("R")


class EngineAway(ConnectionError):
    """Nothing can be computed at present; the message says why."""


class Refused(RuntimeError):
    """A task was not taken, which is not its fault; the message says why."""


class Engine(Protocol):
    """What computes tasks."""

    def capacity(self) -> int:
        """How many tasks it can compute at once. Raises EngineAway."""

    def submit(self, limit_s: float, work: Callable[[A], R], task: A) -> Future[R]:
        """Compute one, a module's function of a task, that keeps to its own time of `limit_s` [s]. Raises EngineAway.

        The future ends in what the task raises, in BrokenProcessPool or Stuck where its process died or stopped answering, in
        Refused or Interrupted, or is cancelled where the engine lost it.
        """

    def look(self) -> None:
        """Look after what is being computed; called every now and then. Raises EngineAway."""

    def warnings(self) -> Sequence[str]:
        """What is wrong with it, though it computes."""

    def close(self) -> None:
        """Give up what is being computed."""


def engine(settings: Settings) -> Engine:
    """The engine that the settings ask for."""
    if settings.dask_scheduler:
        from service.cluster import Cluster

        return Cluster(settings.dask_scheduler)
    return Local(settings.workers, memory_bytes=settings.identification_memory_mb * 2**20)


class Local:
    """Processes of this machine, which look after themselves."""

    def __init__(self, workers: int, *, memory_bytes: int) -> None:
        self._workers = workers
        self._processes = SeparateProcesses(workers, memory_bytes=memory_bytes)

    def capacity(self) -> int:
        """One task for each process."""
        return self._workers

    def submit(self, limit_s: float, work: Callable[[A], R], task: A) -> Future[R]:
        """As of Engine."""
        return self._processes.submit(limit_s, work, task)

    def look(self) -> None:
        """Nothing to do."""

    def warnings(self) -> Sequence[str]:
        """None: what happened to a task is told by its future."""
        return ()

    def close(self) -> None:
        """As of Engine."""
        self._processes.shutdown()
