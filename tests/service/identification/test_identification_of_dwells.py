"""Runs of dwells are identified on request, as steady as the library takes them, and no trend, baseline or alert follows."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from estimator.machine.document import Machine
from estimator.simulation.simulated_plant import draw_truth, measured_phasors
from estimator.units import rpm_to_rad_per_s
from formats.wire import Key, encode_batch
from rotorundown.identification import identify
from rotorundown.runs import read_run
from service.monitoring.context_loading import load_context
from service.runs.collector import Collector
from service.workers.executors import LocalExecutor
from service.write_path.batch import ArrivedBatch
from service.write_path.sample_writer import SampleWriter
from storage.clock import now
from storage.database.engine import Database
from storage.findings import identifications
from storage.machines import machines
from storage.measurements import runs
from tests.api_in_process import Api
from tests.identification import chapter_3, counts, identifying
from tests.plant import SECOND, START, batch, samples, wait_until

COUNT = 60
"""Number of speeds."""
HELD_S = 45
"""Time at each speed [s], so short that by the clock all of them would be a sweep that is a little too fast."""


def sent(database: Database, rpm: list[float]) -> Machine:
    """Create the train of Chapter 3, and store one sample of it at each speed; return the train."""
    train, rng = chapter_3(), np.random.default_rng(5)
    turning = np.array([rpm_to_rad_per_s(one) for one in rpm])
    phasor = measured_phasors(train, draw_truth(train, rng), turning, rng)
    said = batch(
        rpm,
        step=HELD_S * SECOND,
        plant=train.plant,
        machine=train.id,
        channels=list(train.channels),
        amplitude=(2e6 * np.abs(phasor)).tolist(),
        phase=(-np.degrees(np.angle(phasor))).tolist(),
    )
    with database.transaction() as session:
        machines.create(session, train)
    arrived = ArrivedBatch(said, Key(train.plant, train.id).samples, encode_batch(said), now())
    SampleWriter(database, Collector(late_s=0.0)).store([arrived], [])
    return train


def made(api: Api, train: Machine, count: int) -> dict[str, Any]:
    """Make a run of the dwells of as many samples."""
    first, last = (f"{np.datetime64(START + place * HELD_S * SECOND, 'ns')}Z" for place in (0, count - 1))
    run: dict[str, Any] = api("POST", f"/machines/{train.id}/runs", 201, json={"from": first, "to": last, "by": "Ada"})
    return run


def recorded(api: Api, run: dict[str, Any], train: Machine, folder: Path, kind: str) -> Path:
    """The samples of a run as a recording of a kind, with its sidecar."""
    read = api("GET", f"/runs/{run['id']}/phasors")
    table = folder / f"{kind}.csv"
    columns = [
        [float(HELD_S * place) for place in range(COUNT)],
        read["speed_rpm"],
        *read["amplitude_um_pp"],
        *read["phase_lag_deg"],
    ]
    names = ["t", "speed", *(f"{one}_um" for one in train.channels), *(f"{one}_deg" for one in train.channels)]
    rows = zip(*columns, strict=True)
    table.write_text("\n".join([",".join(names), *(",".join(map(json.dumps, row)) for row in rows)]) + "\n")
    sidecar = {
        "plant": train.plant,
        "machine": train.id,
        "source": "test",
        "kind": kind,
        "direction": "positive",
        "time": "t",
        "speed": "speed",
        "speed_unit": "rpm",
        "channels": [{"channel": one, "amplitude": f"{one}_um", "phase": f"{one}_deg"} for one in train.channels],
        "amplitude_unit": "um",
        "amplitude_kind": "peak-to-peak",
        "phase_convention": "lag",
        "phase_unit": "deg",
    }
    table.with_suffix(".yaml").write_text(yaml.safe_dump(sidecar))
    return table


def test_the_service_finds_of_dwells_what_the_library_does_and_nothing_follows(
    database: Database, api: Api, executor: LocalExecutor, tmp_path: Path
) -> None:
    train = sent(database, np.linspace(320.0, 2980.0, COUNT).tolist())
    run = made(api, train, COUNT)
    assert (run["kind"], run["state"], run["samples"]) == ("dwells", "discarded", COUNT)
    job = api("POST", f"/runs/{run['id']}/identifications", 202, json={})
    assert (job["scope"], job["options"]) == ("variant", {"slow_roll_version": None})
    with identifying(database, executor):
        wait_until(lambda: counts(database) == {"done": 1}, seconds=120.0)
    (listed,) = api("GET", f"/machines/{train.id}/identifications")
    assert (listed["scope"], listed["run_kind"], listed["runs"]) == ("variant", "dwells", [run["id"]])
    assert listed["accepted"], listed["verdict"]
    found = api("GET", f"/identifications/{listed['id']}")
    result = identify(train, read_run(recorded(api, run, train, tmp_path, "dwells"), machine=train))
    expected = result.identification.estimates
    assert [one["parameter"] for one in found["estimates"]] == [one.name for one in expected]
    for one, other in zip(found["estimates"], expected, strict=True):
        size = other.standard_error
        assert one["value"] == (None if other.value is None else pytest.approx(other.value, rel=1e-6))
        assert one["standard_error"] == (None if size is None else pytest.approx(size, rel=1e-4)), one["parameter"]
    assert found["verdict"] == result.identification.verdict
    swept = identify(train, read_run(recorded(api, run, train, tmp_path, "sweep"), machine=train))
    assert swept.identification.verdict != found["verdict"], "by their times, the samples would be taken for a sweep"
    path = f"/machines/{train.id}"
    assert api("GET", f"{path}/trends", params={"parameter": "bearing.B1.kxx"})["series"][0]["value"] == []
    assert api("GET", f"{path}/alerts") == []
    with database.reading() as session:
        stored = identifications.get(session, listed["id"])
        assert load_context(session, stored, baseline_runs=1) is None, "nothing is assessed"
    quality = api("GET", f"/runs/{run['id']}/quality")
    assert quality["judged"]
    assert quality["findings"] == list(result.qualities[0].findings) == []
    assert len(api("GET", f"/identifications/{listed['id']}/bode", params={"run": run["id"]})["measured"][0]["time"]) == COUNT


def test_too_few_dwells_are_said_as_of_any_run(database: Database, api: Api, executor: LocalExecutor) -> None:
    train = sent(database, [1000.0, 1100.0])
    job = api("POST", f"/runs/{made(api, train, 2)['id']}/identifications", 202, json={})
    with identifying(database, executor):
        wait_until(lambda: counts(database) == {"failed": 1}, seconds=60.0)
    assert "needed" in api("GET", f"/jobs/{job['id']}")["error"]


def test_sweeps_that_were_discarded_and_dwells_without_their_samples_are_refused(database: Database, api: Api) -> None:
    train = sent(database, [1000.0, 1100.0])
    with database.transaction() as session:
        discarded = runs.open_run(session, train.id, revision=1, kind="run-up", direction=1, time_first=START - SECOND)
        runs.close(discarded, samples=samples(4), state=runs.DISCARDED, reason="not identified")
        path = f"/runs/{discarded.id}/identifications"
    said = api("POST", path, 409, json={})["detail"]
    assert said.endswith("is discarded; only closed runs are identified")
    run = made(api, train, 2)
    with database.transaction() as session:
        runs.get(session, run["id"]).released_at = START
    said = api("POST", f"/runs/{run['id']}/identifications", 409, json={})["detail"]
    assert said == f"run {run['id']} no longer has its samples, as the retention of runs says"
