"""The attack itself on `rundown serve`: its worker processes are stopped, and far too many identifications asked for."""

import signal
from pathlib import Path

import psutil
import pytest

from storage.database.engine import Database
from tests.end_to_end.processes import Service, until
from tests.identification import chapter_3, close_run

NAME = "thesis-chapter-3"


@pytest.mark.long
def test_stopped_workers_are_replaced_and_health_and_metrics_say_so_and_too_many_jobs_are_refused(tmp_path: Path) -> None:
    service = Service(tmp_path, RUNDOWN_IDENTIFICATION_TIMEOUT_S="20", RUNDOWN_ASKED_JOBS_PER_MACHINE="30")
    with service.client, service.running() as process:
        service.create(NAME)
        database = Database(service.database)
        try:
            run_id = close_run(database, chapter_3(), seed=1, start_s=1_700_000_000)
            until(service.idle, within_s=60, what="it is identified")
            stopped = [
                one for one in psutil.Process(process.pid).children(recursive=True) if "spawn_main" in str(one.cmdline())
            ]
            for one in stopped:
                one.send_signal(signal.SIGSTOP)
            answers = [service.client.post(f"/runs/{run_id}/identifications", json={"seed": seed}) for seed in range(1, 41)]
            assert {answer.status_code for answer in answers} == {202, 429}
            assert all(int(one.headers["retry-after"]) > 0 for one in answers if one.status_code == 429)
            close_run(database, chapter_3(), seed=2, start_s=1_700_086_400)
            until(lambda: "did not answer for" in str(service.get("/health")["warnings"]), within_s=60, what="health says so")
            until(service.idle, within_s=90, what="all are identified")
            assert not [one for one in stopped if one.is_running() and one.status() != psutil.STATUS_ZOMBIE]
            metrics = service.client.get(f"http://127.0.0.1:{service.port}/metrics").text
            assert "rundown_stuck_identifications 0" not in metrics
            assert "rundown_stuck_identifications" in metrics
            assert service.get("/health")["healthy"]
        finally:
            database.close()
