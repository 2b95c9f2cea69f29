"""The process that prints reports, stopped (SIGSTOP) while it prints: who waits is told, and the next report is printed."""

import os
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import cast

import psutil
import pytest

from service.reports import report_process
from service.reports.contents import ReportContents
from service.reports.report_process import NotPrinted, ReportProcess
from service.workers import process_pool
from service.workers.time_limit import limit_time
from tests.end_to_end.processes import until

TIME_S, GRACE_S, WAITED_S = 2.0, 1.0, 60.0


def stop_itself(seconds: float, contents: ReportContents) -> bytes:
    """Print nothing: the process is stopped as by somebody outside; the second one prints."""
    with limit_time(seconds):
        marker = cast(str, contents)
        if not os.path.exists(marker):
            with open(marker, "x") as file:
                file.write(str(os.getpid()))
            os.kill(os.getpid(), signal.SIGSTOP)
        return b"%PDF"


@pytest.fixture
def process(monkeypatch: pytest.MonkeyPatch) -> Iterator[ReportProcess]:
    monkeypatch.setattr(process_pool, "GRACE_S", GRACE_S)
    monkeypatch.setattr(report_process, "print_in_time", stop_itself)
    one = ReportProcess(time_s=TIME_S)
    yield one
    one.close()


def _is_gone(number: int) -> bool:
    try:
        return psutil.Process(number).status() == psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return True


def test_a_stopped_process_is_killed_and_the_next_report_printed(process: ReportProcess, tmp_path: object) -> None:
    marker = cast(ReportContents, f"{tmp_path}/stopped")
    began = time.monotonic()
    with pytest.raises(NotPrinted, match="did not answer within 2 s"):
        process.printed(marker)
    assert time.monotonic() - began < WAITED_S
    stopped = int(Path(str(marker)).read_text())
    until(lambda: _is_gone(stopped), within_s=WAITED_S, what="the stopped process is killed")
    assert process.printed(marker) == b"%PDF"


def test_reports_that_wait_behind_a_stopped_process_are_printed(process: ReportProcess, tmp_path: object) -> None:
    marker = cast(ReportContents, f"{tmp_path}/stopped")
    outcomes: list[bytes | NotPrinted] = []

    def ask() -> None:
        try:
            outcomes.append(process.printed(marker))
        except NotPrinted as error:
            outcomes.append(error)

    threads = [threading.Thread(target=ask) for _ in range(3)]
    for one in threads:
        one.start()
    for one in threads:
        one.join(WAITED_S)
    assert sum(one == b"%PDF" for one in outcomes) == 2
    assert sum(isinstance(one, NotPrinted) for one in outcomes) == 1
