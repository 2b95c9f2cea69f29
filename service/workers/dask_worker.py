"""A worker of a Dask cluster: it computes each identification in a process of its own, within its limits of time and
memory."""

import asyncio
import logging
import threading
from collections.abc import Callable, Collection
from functools import partial

from distributed import Worker

from service.workers import dask_task
from service.workers.process_pool import ProcessPool

logger = logging.getLogger(__name__)

RETRY_S = 2.0
LOOK_S = 0.2
"""Time after which it looks again whether it is to stop [s]."""


def work(
    scheduler: str,
    *,
    processes: int,
    memory_bytes: int,
    tasks: Collection[Callable[..., object]],
    stop: threading.Event,
) -> None:
    """Work for a scheduler until `stop`, reconnecting when it is away. tasks: functions that it may be asked to compute."""
    asyncio.run(_work(scheduler, processes, partial(ProcessPool, processes, memory_bytes=memory_bytes, tasks=tasks), stop))


async def _has_started(worker: Worker, stop: threading.Event) -> bool:
    """Start a worker, which waits until there is a scheduler; return False where `stop` comes first."""
    starting = asyncio.ensure_future(worker.start())  # type: ignore[no-untyped-call]
    while not starting.done():
        if stop.is_set():
            starting.cancel()
            return False
        await asyncio.wait([starting], timeout=LOOK_S)
    await starting
    return True


async def _work(scheduler: str, processes: int, new_pool: Callable[[], ProcessPool], stop: threading.Event) -> None:
    while not stop.is_set():
        computing = new_pool()
        dask_task.compute_in(computing)
        try:
            # Each process has its own memory limit; this process only passes tasks on, each in a thread that waits.
            name = dask_task.worker_name()
            worker = Worker(scheduler, name=name, nthreads=processes, memory_limit=0, dashboard=False)
            if not await _has_started(worker, stop):
                return
            async with worker:
                logger.info("working for the scheduler at %s, %d at once; %s", scheduler, processes, dask_task.RELEASE)
                while not stop.is_set() and worker.status.name in ("running", "paused", "init"):
                    await asyncio.sleep(LOOK_S)
                computing.shutdown()
        except (OSError, TimeoutError) as error:
            logger.warning("no scheduler at %s: %s; trying again", scheduler, error)
        finally:
            computing.shutdown()
        await asyncio.sleep(0.0 if stop.is_set() else RETRY_S)
