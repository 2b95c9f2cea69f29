"""The choice of executor: worker processes of this machine, or a Dask cluster."""

from collections.abc import Callable, Collection, Sequence
from concurrent.futures import Future
from typing import TypeVar

from service.configuration.settings import Settings
from service.workers.dask_executor import DaskExecutor
from service.workers.executor import Executor, ExecutorUnavailable
from service.workers.process_pool import ProcessPool

A = TypeVar("A")
R = TypeVar("R")


def executor_of(settings: Settings, tasks: Collection[Callable[..., object]]) -> Executor:
    """Return the executor that the settings ask for. tasks: functions that it will compute."""
    if settings.dask_scheduler:
        return DaskExecutor(settings.dask_scheduler)
    return LocalExecutor(settings.workers, memory_bytes=settings.identification_memory_mb * 2**20, tasks=tasks)


class LocalExecutor:
    """An executor in processes of this machine, which enforce their own time limits."""

    def __init__(self, workers: int, *, memory_bytes: int, tasks: Collection[Callable[..., object]]) -> None:
        """Set up the executor without starting a process. memory_bytes: limit of each process; tasks: functions to compute."""
        self._workers = workers
        self._processes = ProcessPool(workers, memory_bytes=memory_bytes, tasks=tasks)

    def capacity(self) -> int:
        """Return the number of processes."""
        return self._workers

    def submit(self, limit_s: float, work: Callable[[A], R], task: A) -> Future[R]:
        """Compute a task, see `Executor.submit`."""
        return self._processes.submit(limit_s, work, task)

    def check_tasks(self) -> None:
        """Do nothing: the process pool monitors its processes itself."""

    def require_workers(self) -> None:
        """Require that processes can be started, see `Executor.require_workers`."""
        if (trouble := self._processes.start_trouble) is not None:
            self._processes.retry_start()
            raise ExecutorUnavailable(trouble)

    def warnings(self) -> Sequence[str]:
        """Return nothing: problems with a task appear in its future."""
        return ()

    def close(self) -> None:
        """Kill the processes and give up what they compute."""
        self._processes.shutdown()
