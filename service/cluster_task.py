"""What a service has done on a Dask cluster, in a form that workers of every release understand.

The function `compute`, its parameters and the fields of its answer never change. Tasks do, from release to release: they
travel as bytes, which only a worker of the same release opens. Any other one says which it is. The name of each worker tells
it beforehand: Dask's workers end where they get something that they cannot unpickle.
"""

import pickle
import uuid
from importlib.metadata import version
from typing import TypedDict

from service import worker
from service.processes import SeparateProcesses, failed

RELEASE = f"{version('rundown')}, tasks of form {worker.TASK_FORM}"
"""Of the code that makes tasks and opens them."""
_NAMED = "rundown "


def worker_name() -> str:
    """A name for a worker of this release, which no other worker has."""
    return f"{_NAMED}{RELEASE} #{uuid.uuid4()}"


def release_of(name: str) -> str | None:
    """The release that a worker's name tells; None where it tells none."""
    return name.removeprefix(_NAMED).rpartition(" #")[0] if name.startswith(_NAMED) else None


class Answer(TypedDict):
    """release, address: of the worker; done: pickled, whether it went well and the outcome or the error; None: refused."""

    release: str
    address: str
    done: bytes | None


class NoProcesses(RuntimeError):
    """A Dask worker that was not started as `rundown worker`."""


class _Here:
    processes: SeparateProcesses | None = None


def compute_in(processes: SeparateProcesses) -> None:
    """Say where this Dask worker computes."""
    _Here.processes = processes


def compute(release: str, task: bytes, limit_s: float) -> Answer:
    """Compute a task of a service of some release, within limit_s [s] and some grace. Runs in a thread of a Dask worker."""
    from distributed import get_worker  # takes a second to import, which only a cluster's user should pay

    answer = Answer(release=RELEASE, address=str(get_worker().address), done=None)
    if release != RELEASE:
        return answer
    try:
        if _Here.processes is None:
            raise NoProcesses("this Dask worker has no processes that keep to a time: start it as `rundown worker`")
        answer["done"] = _Here.processes.submit(limit_s, _computed, task).result()
    except Exception as error:  # noqa: BLE001 - the service tells them apart
        answer["done"] = failed(error)
    return answer


def _computed(task: bytes) -> bytes:
    work, argument = pickle.loads(task)
    return pickle.dumps((True, work(argument)))
