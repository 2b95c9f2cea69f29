"""Gaps in the middle of a healthy machine's runs: its identifications are compared with its baseline, and no alert comes."""

import time
from pathlib import Path
from typing import Any

from tests.end_to_end.processes import EXAMPLES, Service, process, until
from tests.faults.network import Wire

MACHINE = "thesis-chapter-3"
BASELINE_RUNS = 3
"""Of each kind."""
RATE, SAMPLES = 40.0, 60
"""A second, and of each run."""
MIDDLE = 0.25, 0.6
"""Parts of its speed range that lie behind a run when the wire is cut."""


def runs_with_gaps(folder: Path, *, gaps: int, seconds: float, seed: int) -> str:
    """The wire to a healthy machine is cut in the middle of runs behind its baseline: what was missed is fetched. Then its
    source is killed while the wire is cut in the middle of a run: what it had measured meanwhile is gone for ever.
    """
    service = Service(folder, RUNDOWN_BASELINE_RUNS=str(BASELINE_RUNS))
    with service.running(), Wire(int(service.endpoint.rpartition(":")[2])) as wire:
        service.create(MACHINE)
        fetched = BASELINE_RUNS + gaps
        with _source(folder, wire, cycles=fetched + 1, seed=seed) as source:
            for number in range(BASELINE_RUNS, fetched):
                _wait_for_the_middle(service, behind=2 * number)
                wire.hold()
                time.sleep(seconds)
                wire.release()
            _wait_for_the_middle(service, behind=2 * fetched)
            wire.hold()
            time.sleep(seconds / 2)
            source.kill()
            wire.release()
        until(lambda: len(_closed(service)) > 2 * fetched, within_s=60, what="the run that broke off is closed")
        *whole, last = (run["samples"] for run in _closed(service))
        assert len(set(whole)) == 1, f"runs with gaps have fewer samples: {whole}"
        assert last < whole[0]
        until(service.idle, within_s=120, what="all runs are identified")
        found = service.get(f"/machines/{MACHINE}/identifications")
        compared = sum(service.client.get(f"/identifications/{one['id']}/diagnosis").status_code == 200 for one in found)
        assert compared >= gaps, "the runs with gaps were compared with nothing"
        assert service.get("/alerts") == []
    service.client.close()
    return f"{gaps} gaps of {seconds:.0f} s fetched, one run broken off at {last} samples; {compared} compared"


def _source(folder: Path, wire: Wire, *, cycles: int, seed: int) -> Any:
    flags = ["--cycles", str(cycles), "--samples", str(SAMPLES), "--rate", str(RATE), "--seed", str(seed)]
    machine = f"{EXAMPLES / MACHINE}.yaml:healthy"
    return process(folder / "simulate.log", "simulate", machine, *flags, "--connect", wire.endpoint)


def _closed(service: Service) -> list[dict[str, Any]]:
    """Oldest first."""
    runs = service.get(f"/machines/{MACHINE}/runs")
    return sorted((run for run in runs if run["state"] == "closed"), key=lambda run: run["started_at"])


def _wait_for_the_middle(service: Service, *, behind: int) -> None:
    """Wait until so many runs are closed and the next one is under way."""

    def under_way() -> bool:
        run = service.get(f"/machines/{MACHINE}/state")["run"]
        return len(_closed(service)) >= behind and run is not None and MIDDLE[0] < run["progress"] < MIDDLE[1]

    until(under_way, within_s=120, what=f"a run behind {behind} others is under way")
