"""The worker process that prints reports, within limits of time and memory; it is started with the first report."""

import threading
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool

from estimator.errors import Unavailable
from service.reports.contents import ReportContents
from service.reports.printing import print_in_time
from service.workers.process_pool import Interrupted, ProcessPool, WorkerStuck
from service.workers.time_limit import OutOfTime

TIME_S = 60.0
"""Longest time of a report [s]."""
MEMORY_BYTES = 2 * 2**30


class NotPrinted(Unavailable):
    """A report exceeded its time or memory, or its process ended."""

    retry_after_s = 5


class ReportProcess:
    """A worker process that prints reports one after another."""

    def __init__(self, *, time_s: float = TIME_S, memory_bytes: int = MEMORY_BYTES) -> None:
        """Set the limits of each report: its time [s] and its memory [B]."""
        self._time_s = time_s
        self._memory = memory_bytes
        self._lock = threading.Lock()
        self._processes: ProcessPool | None = None

    def printed(self, contents: ReportContents) -> bytes:
        """Return a report as PDF. Raises NotPrinted, PrinterMissing."""
        with self._lock:
            if self._processes is None:
                self._processes = ProcessPool(1, memory_bytes=self._memory, tasks=[print_in_time])
            future: Future[bytes] = self._processes.submit(self._time_s, print_in_time, self._time_s, contents)
        limits = f"{self._time_s:.0f} s and {self._memory / 2**30:.1f} GiB"
        try:
            return future.result()
        except (MemoryError, OutOfTime) as error:
            raise NotPrinted(f"this report cannot be made within {limits}: ask for a shorter period") from error
        except (WorkerStuck, BrokenProcessPool) as error:
            raise NotPrinted(f"the process that prints reports ended, or did not answer within {limits}: ask again") from error
        except Interrupted as error:
            raise NotPrinted(f"{error}: ask again") from error

    def close(self) -> None:
        """Kill the process and abandon its report."""
        with self._lock:
            if self._processes is not None:
                self._processes.shutdown()
            self._processes = None
