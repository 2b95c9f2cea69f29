"""Quality of runs through the worker, the store and the API; the measured run-up that rings among them."""

import httpx
import numpy as np
import pytest
from msgspec.structs import replace
from sqlalchemy.orm import Session

from estimator.fit.identification import Options
from estimator.machine.document import Machine
from estimator.machine.rules import QualityRules
from estimator.phasors.channel_status import ChannelStatus
from estimator.phasors.quality import Flag
from formats.files.document_files import read_machine
from formats.recordings.recording import read_recording
from formats.wire import to_samples
from service.identification import computation
from service.identification.task import IdentificationTask
from storage.clock import now
from storage.database.engine import Database
from storage.encoding.sample_blocks import DamagedBlock, Samples, encode
from storage.machines import machines
from storage.measurements import runs
from tests.api_in_process import Api
from tests.paths import ROOT


@pytest.fixture
def kit() -> Machine:
    return read_machine(ROOT / "examples" / "rk4-rotor-kit.yaml")


def measured(kit: Machine) -> Samples:
    """The run-up of tests/data."""
    samples, taken, _ = to_samples(read_recording(ROOT / "tests" / "data" / "rk4_runup_1x.csv"), kit, received_at=now())
    return samples.pick(taken)


def closed(session: Session, kit: Machine, samples: Samples) -> int:
    machines.create(session, kit)
    row = runs.open_run(session, kit.id, revision=1, kind="run-up", direction=1, time_first=int(samples.time[0]))
    runs.close(row, samples=samples, state=runs.CLOSED, reason="the speed stood still")
    return row.id


def get(database: Database, path: str) -> httpx.Response:
    """Return what the API answers."""
    return Api(database).ask("GET", path)


def test_measured_run_up_is_reported_to_ring_point_by_point(database: Database, kit: Machine) -> None:
    samples = measured(kit)
    outcome = computation.compute(IdentificationTask(kit.model_dump(mode="json"), [encode(samples)], Options(starts=1), 60.0))
    with database.transaction() as session:
        run_id = closed(session, kit, samples)
        runs.store_quality(session, run_id, outcome.qualities[0])
    found = get(database, f"/api/v1/runs/{run_id}/quality").json()
    assert found["judged"]
    assert found["counts"]["sweep-rate-beat"] > 60
    assert "sweep rate" in found["meaning"]["sweep-rate-beat"]
    assert found["findings"][0].startswith("sweep rate: V1 beats behind 1")
    assert "not to be trusted" in found["findings"][0]  # the file has no clock; its sidecar invents one
    (reasons,) = found["reasons"]
    rpm = get(database, f"/api/v1/runs/{run_id}/phasors").json()["speed_rpm"]
    ringing = [speed for speed, why in zip(rpm, reasons, strict=True) if "sweep-rate-beat" in why]
    # README of the data: the vector beats from 1730 to 2100 rpm.
    assert ringing[0] < 1700
    assert 2000 < ringing[-1] < 2200
    assert all("sweep-rate-beat" in why for speed, why in zip(rpm, reasons, strict=True) if 1730 < speed < 2000)
    assert not any(why for speed, why in zip(rpm, reasons, strict=True) if speed < 1400)
    assert found["noise"]["V1"]["seen"] > 0
    summary = get(database, f"/api/v1/runs/{run_id}").json()["quality"]
    assert summary["counts"] == found["counts"]
    assert summary["usable"] == found["usable"] == sum(not why for why in reasons)


def test_a_run_that_was_not_judged_says_so(database: Database, kit: Machine) -> None:
    with database.transaction() as session:
        run_id = closed(session, kit, measured(kit))
    found = get(database, f"/api/v1/runs/{run_id}/quality").json()
    assert (found["judged"], found["counts"], found["reasons"]) == (False, {}, [])
    assert get(database, f"/api/v1/runs/{run_id}").json()["quality"] is None
    assert get(database, "/api/v1/runs/999/quality").status_code == 404


def test_damaged_flags_are_distinguished_from_missing_ones(database: Database, kit: Machine) -> None:
    with database.transaction() as session:
        run_id = closed(session, kit, measured(kit))
        assert runs.flags(session, run_id) is None
        runs.get(session, run_id).flags = b"\x01\x00nonsense"
    with database.reading() as session, pytest.raises(DamagedBlock, match=f"flags of run {run_id}"):
        runs.flags(session, run_id)


def test_samples_that_can_no_longer_be_read_are_said_to_be_damaged(database: Database, kit: Machine) -> None:
    with database.transaction() as session:
        run_id = closed(session, kit, measured(kit))
        runs.get(session, run_id).data = b"\x01\x00nonsense"
    answer = get(database, f"/api/v1/runs/{run_id}/phasors")
    assert answer.status_code == 503
    assert answer.json()["detail"].startswith(f"the samples of run {run_id} cannot be read")
    assert answer.json()["detail"].endswith("restore a backup")


def test_a_gate_that_leaves_too_little_is_an_error_with_its_reasons(kit: Machine) -> None:
    samples = measured(kit)
    rules = QualityRules(accepted_rpm=(1040.0, 1100.0))
    outcome = computation.compute(IdentificationTask(kit.model_dump(mode="json"), [encode(samples)], Options(), 60.0, rules))
    assert outcome.identification is None
    assert outcome.error is not None
    assert "left out for their quality" in outcome.error
    assert "not-accepted" in outcome.error
    assert np.any(outcome.qualities[0].flags & np.uint16(Flag.NOT_ACCEPTED))


def test_a_run_is_compared_with_the_one_before(kit: Machine) -> None:
    samples = measured(kit)
    status = samples.status.copy()
    status[:20] = ChannelStatus.BAD
    larger = replace(samples, phasor=3.0 * samples.phasor, status=status)
    task = IdentificationTask(
        kit.model_dump(mode="json"), [encode(larger)], Options(starts=1), 60.0, earlier=("run 4", encode(samples))
    )
    quality = computation.compute(task).qualities[0]
    assert any(words.startswith("repeatability: V1 by") and "run 4" in words for words in quality.findings)
    assert any(words.startswith("channel lost: V1") for words in quality.findings)
