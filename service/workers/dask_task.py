"""The task protocol between a service and its Dask workers, in a form that workers of every release understand.

The function `compute`, its parameters and the fields of its answer never change. Tasks do, from release to release: they
travel as bytes, which only a worker of the same release unpickles. Any other worker answers with its own release. The name of
each worker states it beforehand, because Dask's workers crash on a task that they cannot unpickle.
"""

import pickle
import uuid
from typing import TypedDict

from rotorundown.environment.release import VERSION
from service.workers.process_pool import ProcessPool
from service.workers.worker_process import failed

TASK_FORM = 8
"""Version of the tasks and their results within a release, including their modules' names: they travel pickled."""
RELEASE = f"{VERSION}, tasks of form {TASK_FORM}"
"""Release of the code that creates and unpickles tasks."""
_NAMED = "rundown "


def worker_name() -> str:
    """Return a unique name for a worker of this release."""
    return f"{_NAMED}{RELEASE} #{uuid.uuid4()}"


def release_of(name: str) -> str | None:
    """Return the release in a worker's name; None when it has none."""
    return name.removeprefix(_NAMED).rpartition(" #")[0] if name.startswith(_NAMED) else None


class TaskAnswer(TypedDict):
    """A worker's answer. release, address: release and address of the worker.

    done: pickled, whether the task succeeded, and its outcome or its error; None: refused.
    """

    release: str
    address: str
    done: bytes | None


class NoProcesses(RuntimeError):
    """The Dask worker was not started as `rundown worker`."""


class _ThisWorker:
    processes: ProcessPool | None = None


def compute_in(processes: ProcessPool) -> None:
    """Set the processes in which this Dask worker computes."""
    _ThisWorker.processes = processes


def compute(release: str, task: bytes, limit_s: float) -> TaskAnswer:
    """Compute a task of a service of any release, within limit_s [s] and some grace. Runs in a thread of a Dask worker."""
    from distributed import get_worker  # takes a second to import, which only a cluster's user should pay

    answer = TaskAnswer(release=RELEASE, address=str(get_worker().address), done=None)
    if release != RELEASE:
        return answer
    try:
        if _ThisWorker.processes is None:
            raise NoProcesses("this Dask worker has no processes that keep to a time: start it as `rundown worker`")
        answer["done"] = _ThisWorker.processes.submit(limit_s, _computed, task).result()
    except Exception as error:  # noqa: BLE001 - the service tells them apart
        answer["done"] = failed(error)
    return answer


def _computed(task: bytes) -> bytes:
    work, argument = pickle.loads(task)
    return pickle.dumps((True, work(argument)))
