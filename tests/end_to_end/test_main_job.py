"""Simulator and service as processes: a machine that drifts into misalignment, and a service that is killed meanwhile."""

import json
import signal
import subprocess
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from tests.databases import Databases
from tests.end_to_end.processes import EXAMPLES, Service, process, until

CYCLES, BASELINE_RUNS = 5, 3
"""So few that the baseline of each kind of run is complete and two more runs agree on an alert."""
SAMPLES = 120
DRIFTING, HEALTHY = "thesis-chapter-3", "motor-pump"


@pytest.fixture
def service(tmp_path: Path, databases: Databases) -> Iterator[Service]:
    """A place for a service that has its baseline soon, on the kind of database that is asked for."""
    url = databases.new(tmp_path / "rundown.db")
    place = Service(tmp_path, database=url, RUNDOWN_BASELINE_RUNS=str(BASELINE_RUNS))
    yield place
    place.client.close()
    databases.drop(url)


def simulation(service: Service, truth: Path, *machines: str, rate: float) -> list[str]:
    """Arguments of `rundown simulate`."""
    options = {"cycles": CYCLES, "samples": SAMPLES, "rate": rate, "seed": 3, "truth": truth}
    flags = [str(part) for name, value in options.items() for part in (f"--{name}", value)]
    return ["simulate", *machines, *flags, "--connect", service.endpoint]


def all_identified(service: Service, machine: str, runs: int) -> bool:
    """Return whether that many runs are closed and everything is identified."""
    closed = [run for run in service.get(f"/machines/{machine}/runs") if run["state"] == "closed"]
    return len(closed) == runs and service.idle()


def test_misalignment_is_found_and_only_there(service: Service, tmp_path: Path) -> None:
    truth = tmp_path / "truth.jsonl"
    with service.running() as serving:
        service.create(DRIFTING)
        service.create(HEALTHY)
        machines = [f"{EXAMPLES / DRIFTING}.yaml:misalignment", f"{EXAMPLES / HEALTHY}.yaml:healthy"]
        with process(tmp_path / "simulate.log", *simulation(service, truth, *machines, rate=250)) as simulator:
            simulator.wait(120)
        for machine in (DRIFTING, HEALTHY):
            until(partial(all_identified, service, machine, 2 * CYCLES), within_s=150, what=f"{machine} identified")
        check_runs_and_samples(service)
        check_alerts(service)
        check_trend_follows_truth(service, truth)
        serving.send_signal(signal.SIGINT)
        assert serving.wait(20) == 0


def check_runs_and_samples(service: Service) -> None:
    """Every sample came once, and each sweep became one run of its kind."""
    for source in service.get("/sources"):
        assert source["received"] == source["next_sequence"]
        assert source["lost"] == 0
    for machine in (DRIFTING, HEALTHY):
        kinds = [run["kind"] for run in service.get(f"/machines/{machine}/runs")]
        assert kinds == ["run-down", "run-up"] * CYCLES
    assert service.get("/quarantine")["counts"] == {}


def check_alerts(service: Service) -> None:
    """One open alert, on the coupling that drifts, with its evidence."""
    alerts = service.get("/alerts", open=True)
    assert [(alert["machine"], alert["rule"], alert["element"]) for alert in alerts] == [
        (DRIFTING, "misalignment", "coupling.C1")
    ]
    evidence = alerts[0]["evidence"]
    assert (evidence["kind"], evidence["sigma"] > 3.0, evidence["per_cent"] > 3.0) == ("misalignment", True, True)
    assert {one["parameter"].rsplit(".", 1)[0] for one in evidence["moved"]} == {"coupling.C1", "bearing.B2", "bearing.B3"}
    assert len(evidence["baseline"]) == BASELINE_RUNS
    assert service.get(f"/identifications/{alerts[0]['identification']}")["machine"] == DRIFTING


def check_trend_follows_truth(service: Service, truth: Path) -> None:
    """The history of the coupling's stiffness over a time range is the simulated one, within its errors."""
    lines = [json.loads(line) for line in truth.read_text().splitlines()]
    true = [line["parameters"]["coupling.C1.kxx"] for line in lines if line["machine"] == DRIFTING]
    series = service.get(f"/machines/{DRIFTING}/trends", parameter="coupling.C1.kxx")["series"][0]
    assert len(series["value"]) == len(true) == 2 * CYCLES
    errors = [(v - t) / s for v, t, s in zip(series["value"], true, series["standard_error"], strict=True)]
    assert max(map(abs, errors)) < 4.5
    assert true[-1] > 1.4 * true[0]
    half = series["measured_at"][CYCLES]
    part = service.get(f"/machines/{DRIFTING}/trends", parameter="coupling.C1.kxx", **{"from": half})["series"][0]
    assert part["value"] == series["value"][CYCLES:]


@pytest.mark.long
def test_service_killed_twice_resumes_with_nothing_lost_and_nothing_twice(service: Service, tmp_path: Path) -> None:
    truth = tmp_path / "truth.jsonl"
    arguments = simulation(service, truth, f"{EXAMPLES / DRIFTING}.yaml:misalignment", rate=30)
    with process(tmp_path / "simulate.log", *arguments) as simulator:
        with service.running() as serving:
            service.create(DRIFTING)
            until(lambda: len(service.get(f"/machines/{DRIFTING}/runs")) >= 3, within_s=150, what="three runs")
            kill(serving)
        time.sleep(2)
        with service.running() as serving:
            until(lambda: len(service.get(f"/machines/{DRIFTING}/runs")) >= 6, within_s=150, what="six runs")
            kill(serving)
        with service.running():
            assert simulator.wait(60) == 0
            until(lambda: all_identified(service, DRIFTING, 2 * CYCLES), within_s=150, what="everything identified")
            source = service.get("/sources")[0]
            assert source["received"] == source["next_sequence"] == CYCLES * (2 * SAMPLES + 6)
            assert source["lost"] == 0
            times = service.get(f"/machines/{DRIFTING}/samples", limit=10_000)["time"]
            assert len(times) == len(set(times)) == source["received"]
            identified = [one["runs"] for one in service.get(f"/machines/{DRIFTING}/identifications")]
            assert len(identified) == len({tuple(runs) for runs in identified}) == 2 * CYCLES
            assert [alert["element"] for alert in service.get("/alerts")] == ["coupling.C1"]


def kill(serving: "subprocess.Popen[bytes]") -> None:
    """Kill it without warning, like a power cut."""
    serving.kill()
    serving.wait()
