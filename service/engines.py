"""Where identifications are computed: worker processes of this machine, or a Dask cluster. Both are executors to who asks."""

import logging
import os
from concurrent.futures import Executor, Future
from typing import TYPE_CHECKING, Protocol

from service import worker
from service.processes import SeparateProcesses
from service.settings import Settings

if TYPE_CHECKING:
    from distributed import Client

logger = logging.getLogger(__name__)

CONNECT_S = 5.0
"""How long a scheduler is waited for, before it is tried again."""


class EngineAway(ConnectionError):
    """Nothing can be computed at present; the message says why."""


class Engine(Protocol):
    """What computes tasks."""

    def capacity(self) -> int:
        """How many tasks it can compute at once. Raises EngineAway."""

    def submit(self, task: worker.Task) -> Future[worker.Outcome]:
        """Compute one. The future ends as an executor's does, cancelled where the engine lost it. Raises EngineAway."""

    def close(self) -> None:
        """Give up what is being computed."""


def engine(settings: Settings) -> Engine:
    """The engine that the settings ask for."""
    if settings.dask_scheduler:
        return Cluster(settings.dask_scheduler)
    return Local(settings.workers, memory_bytes=settings.identification_memory_mb * 2**20)


class Local:
    """Processes of this machine."""

    def __init__(self, workers: int, *, memory_bytes: int) -> None:
        self._workers = workers
        self._executor: Executor = SeparateProcesses(workers, memory_bytes=memory_bytes)

    def capacity(self) -> int:
        """One task for each process."""
        return self._workers

    def submit(self, task: worker.Task) -> Future[worker.Outcome]:
        """As of Engine."""
        return self._executor.submit(worker.compute, task)

    def close(self) -> None:
        """As of Engine."""
        self._executor.shutdown(wait=True, cancel_futures=True)


class Cluster:
    """A Dask cluster by the address of its scheduler. Its workers are `rundown worker`, which keep the limits."""

    def __init__(self, address: str) -> None:
        self._address = address
        self._client: Client | None = None

    def capacity(self) -> int:
        """One task for each thread of its workers. Raises EngineAway."""
        workers = self._connected().scheduler_info(n_workers=-1)["workers"]
        if not workers:
            raise EngineAway(f"the Dask scheduler at {self._address} has no workers: start some with `rundown worker`")
        return sum(int(one["nthreads"]) for one in workers.values())

    def submit(self, task: worker.Task) -> Future[worker.Outcome]:
        """As of Engine."""
        executor: Executor = self._connected().get_executor(pure=False)  # type: ignore[no-untyped-call]
        return executor.submit(worker.compute, task)

    def close(self) -> None:
        """As of Engine."""
        if self._client is not None:
            self._client.close(timeout=CONNECT_S)  # type: ignore[no-untyped-call]

    def _connected(self) -> "Client":
        """The client, a new one where there is none or the last one has given up."""
        from distributed import Client  # takes a second to import, which only a cluster's user should pay

        if self._client is not None and self._client.status == "running":
            return self._client
        if self._client is not None:
            if self._client.status == "connecting":
                raise EngineAway(f"the Dask scheduler at {self._address} does not answer")
            self._client = None
        try:
            self._client = Client(  # type: ignore[no-untyped-call]
                self._address, timeout=CONNECT_S, set_as_default=False, name=f"rundown-{os.getpid()}"
            )
        except OSError as error:
            raise EngineAway(f"the Dask scheduler at {self._address} does not answer: {error}") from error
        logger.info("identifications are computed by the Dask cluster at %s", self._address)
        return self._client
