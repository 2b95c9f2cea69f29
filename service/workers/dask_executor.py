"""An executor that computes on a Dask cluster, found by the address of its scheduler. Its workers are `rundown worker`.

Workers enforce the limits of time and memory and kill what exceeds them. This side detects what they cannot: a worker that is
frozen or cut off is silent to the scheduler; it gets no more tasks, and its tasks are given up when their time is over. A
worker of another release, as its name tells, gets no tasks, as it could not unpickle them. Should it get a task after all, it
refuses the task (`service.workers.dask_task`).
"""

import logging
import os
import pickle
import threading
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import CancelledError, Future
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

from service.workers import dask_task
from service.workers.dask_worker_states import DaskWorkerStates
from service.workers.executor import Executor, ExecutorUnavailable
from service.workers.process_pool import WorkerStuck

if TYPE_CHECKING:
    from distributed import Client

logger = logging.getLogger(__name__)

A = TypeVar("A")
R = TypeVar("R")

CONNECT_S = 5.0
"""Time that a connection to the scheduler may take before it is retried."""
LOOK_S = 2.0
GRACE_S = 60.0
"""Time after its limit at which a task of a silent worker is given up."""


@dataclass(frozen=True)
class _SubmittedTask:
    """A submitted task. future: Dask's; since: on the monotonic clock [s]; to: the workers that may have it."""

    future: Any
    limit_s: float
    since: float
    to: tuple[str, ...]


class DaskExecutor(Executor):
    """An executor on the workers of a Dask scheduler; see `service.workers.executor.Executor`."""

    def __init__(self, address: str) -> None:
        self._address = address
        self._client: Client | None = None
        self._lock = threading.Lock()
        self._sent: dict[Future[Any], _SubmittedTask] = {}
        self._checked_at = 0.0
        self._states = DaskWorkerStates()
        self._usable: tuple[str, ...] = ()
        self._warnings: tuple[str, ...] = ()

    def capacity(self) -> int:
        """Return the number of threads of the usable workers. Raises ExecutorUnavailable."""
        workers = self._workers()
        if not workers:
            raise ExecutorUnavailable(
                f"the Dask scheduler at {self._address} has no workers: start some with `rundown worker`"
            )
        doubtful = self._unusable_workers(workers)
        self._usable = tuple(address for address in workers if address not in doubtful)
        if not self._usable:
            raise ExecutorUnavailable("; ".join(doubtful.values()))
        return sum(int(workers[address]["nthreads"]) for address in self._usable)

    def submit(self, limit_s: float, work: Callable[[A], R], task: A) -> Future[R]:
        """Compute a task, see `Executor.submit`."""
        release, to = dask_task.RELEASE, self._usable
        future: Any = self._connected().submit(
            dask_task.compute, release, pickle.dumps((work, task)), limit_s, pure=False, workers=to
        )
        answer: Future[R] = Future()
        with self._lock:
            self._sent[answer] = _SubmittedTask(future, limit_s, time.monotonic(), to)
        future.add_done_callback(partial(self._forward_outcome, answer))
        return answer

    def check_tasks(self) -> None:
        """Find silent workers, and give up their overdue tasks. Raises ExecutorUnavailable."""
        with self._lock:
            sent = dict(self._sent)
        if not (sent or self._warnings) or time.monotonic() < self._checked_at + LOOK_S:
            return
        self._checked_at = time.monotonic()
        workers = self._workers()
        self._unusable_workers(workers)
        for answer, one in sent.items():
            if not set(one.to) & set(workers):
                self._give_up(answer, None)
        late = {a: one for a, one in sent.items() if time.monotonic() > one.since + one.limit_s + GRACE_S}
        if late and (silent := self._states.silent()):
            tasks: Mapping[str, Collection[str]] = self._query_scheduler("processing", workers=None)
            for answer, one in late.items():
                for address in silent.keys() & {address for address, keys in tasks.items() if one.future.key in keys}:
                    self._give_up(answer, WorkerStuck(silent[address]))

    def warnings(self) -> Sequence[str]:
        """Return why some workers get no tasks at present."""
        return self._warnings

    def close(self) -> None:
        """Disconnect from the scheduler and give up all tasks."""
        if self._client is not None:
            self._client.close(timeout=CONNECT_S)  # type: ignore[no-untyped-call]

    def _workers(self) -> dict[str, Any]:
        """Return the scheduler's workers by address."""
        workers: dict[str, Any] = self._query_scheduler("identity", n_workers=-1)["workers"]
        self._states.observe(workers)
        return workers

    def _query_scheduler(self, question: str, **how: Any) -> Any:
        """Return the scheduler's answer within a time limit: it may be frozen itself. Raises ExecutorUnavailable."""
        client = self._connected()
        ask = getattr(client.scheduler, question)
        try:
            return client.sync(ask, callback_timeout=CONNECT_S, **how)  # type: ignore[no-untyped-call]
        except (OSError, TimeoutError) as error:
            why = str(error) or "it takes too long"
            raise ExecutorUnavailable(f"the Dask scheduler at {self._address} does not answer: {why}") from error

    def _unusable_workers(self, workers: Mapping[str, Any]) -> dict[str, str]:
        """Return the workers that get no tasks now, and why; record these reasons as warnings."""
        doubtful = self._states.unusable(workers)
        self._warnings = tuple(doubtful.values())
        return doubtful

    def _forward_outcome(self, answer: Future[Any], future: Any) -> None:
        """Pass on the outcome of a task that is computed, refused or lost; runs in a thread of Dask's."""
        from distributed import KilledWorker

        with self._lock:
            if answer not in self._sent:
                return
        try:
            told: dask_task.TaskAnswer = future.result(timeout=2 * CONNECT_S)
            if told["done"] is None:
                raise self._states.refuse(told["address"], told["release"])
            done, value = pickle.loads(told["done"])
        except (CancelledError, TimeoutError, OSError):
            self._give_up(answer, None)
        except KilledWorker as error:
            self._give_up(answer, BrokenProcessPool(f"its Dask workers died: {error}"))
        except Exception as error:  # noqa: BLE001 - whoever waits for it is told
            self._give_up(answer, error)
        else:
            self._finish(answer, value) if done else self._give_up(answer, value)

    def _finish(self, answer: Future[Any], outcome: object) -> None:
        with self._lock:
            known = self._sent.pop(answer, None)
        if known is not None:
            known.future.release()
            answer.set_result(outcome)

    def _give_up(self, answer: Future[Any], reason: Exception | None) -> None:
        """End a task without an outcome, unless it has one by now; without a reason it is lost."""
        with self._lock:
            known = self._sent.pop(answer, None)
        if known is None:
            return
        known.future.release()
        if reason is None:
            answer.cancel()
        else:
            answer.set_exception(reason)

    def _connected(self) -> "Client":
        """Return the client, a new one when there is none or the last one has given up."""
        from distributed import Client  # takes a second to import, which only a cluster's user should pay

        if self._client is not None and self._client.status == "running":
            return self._client
        if self._client is not None:
            if self._client.status == "connecting":
                raise ExecutorUnavailable(f"the Dask scheduler at {self._address} does not answer")
            self._client = None
        try:
            self._client = Client(  # type: ignore[no-untyped-call]
                self._address, timeout=CONNECT_S, set_as_default=False, name=f"rundown-{os.getpid()}"
            )
        except OSError as error:
            raise ExecutorUnavailable(f"the Dask scheduler at {self._address} does not answer: {error}") from error
        logger.info("identifications are computed by the Dask cluster at %s", self._address)
        return self._client
