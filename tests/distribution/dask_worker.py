"""A Dask worker that is not quite as `rundown worker` is: `SCHEDULER NAME=VALUE …`, as a process of the tests.

release: of another one; pretends: another one that calls itself right; without: a release that has no such module;
hand_over: seconds in which a process must say that it has its work; killing: computations end their process while a file of
`tests.distribution.killed_computation` is there.
"""

import logging
import sys
import threading
from collections.abc import Callable


def main() -> None:
    """Work until killed."""
    logging.basicConfig(level="INFO")
    scheduler, *changes = sys.argv[1:]
    changed = dict(one.split("=", 1) for one in changes)
    if "without" in changed:
        from distributed.cli.dask_worker import main as bare

        sys.modules[changed["without"]] = None  # type: ignore[assignment]
        sys.argv = ["dask-worker", scheduler, "--nworkers", "1", "--nthreads", "1", "--no-dashboard", "--no-nanny"]
        bare()
        return
    from service.identification.worker_tasks import TASKS
    from service.workers import dask_task, process_pool
    from service.workers.dask_worker import work

    if "pretends" in changed:
        name = dask_task.worker_name()
        dask_task.worker_name = lambda: name
        dask_task.RELEASE = changed["pretends"]
    dask_task.RELEASE = changed.get("release", dask_task.RELEASE)
    process_pool.HAND_OVER_S = float(changed.get("hand_over", process_pool.HAND_OVER_S))
    tasks: tuple[Callable[..., object], ...] = TASKS
    if "killing" in changed:
        from tests.distribution.killed_computation import killed_compute

        tasks = (*tasks, killed_compute)
    work(scheduler, processes=1, memory_bytes=2**31, tasks=tasks, stop=threading.Event())


if __name__ == "__main__":
    main()
