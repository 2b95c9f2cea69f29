"""Wrong gaps, temperatures and documents of a train on oil films, through the service: named, and no coupling is alarmed."""

from functools import partial
from typing import Any

import numpy as np
import pytest

from estimator.arrays import Floats
from estimator.machine.document import Machine, parse_machine
from estimator.machine.under_conditions import under_conditions
from estimator.simulation.simulated_gaps import simulated_gaps
from estimator.simulation.simulated_plant import Truth, draw_truth, measured_phasors, speed_law, truth_of_run
from formats.wire import WIRE_SCHEMA, SampleBatch
from formats.wire.encodings import JSON, encode_body
from formats.wire.gap_conversion import as_sent
from tests.databases import Databases
from tests.end_to_end.processes import Service, example, until

NAME = "motor-compressor"
OIL = 50.0
"""Temperature of the oil [degC]."""
BASELINE, SAMPLES, START_S, EVERY_S = 3, 100, 1_700_000_000, 7 * 86_400
SPOILED = "B2Y"
"""Channel with the wrong gap."""
FAULTS = {
    "sign": "gap_grows is away in the document, is it towards?",
    "unit": "are its unit and sensitivity right?",
    "jump": "jumps",
}
"""Fault of a gap, with words of the verdict that name it."""


def document() -> dict[str, Any]:
    said = example(NAME) | {"conditions": [{"name": "oil", "unit": "degC"}]}
    for bearing in said["bearings"]:
        bearing["film"]["oil"] = {"iso_vg": 46, "temperature_c": OIL, "temperature_from": "oil"}
    for probe in said["probes"]:
        probe["gap_grows"] = "away"
    return said


def spoiled(gaps: Floats, place: int, fault: str) -> Floats:
    """The gaps (S, m) [µm] with one channel's wrong."""
    found = gaps.copy()
    if fault == "sign":
        found[:, place] *= -1.0
    if fault == "unit":
        found[:, place] *= 10.0  # beyond 20 mm it would not be stored
    if fault == "jump":
        found[SAMPLES // 2 :, place] += 120.0
    return found


class SentRuns:
    """Run-downs of one machine, a week apart, sent over HTTP."""

    def __init__(self, service: Service) -> None:
        self.service = service
        self.rng = np.random.default_rng(4)
        self.machine: Machine = parse_machine(document())
        self.truth: Truth = draw_truth(under_conditions(self.machine, {"oil": OIL}), self.rng)
        self.count = 0

    def send(self, fault: str = "", *, oil: float = OIL) -> None:
        machine, truth = under_conditions(self.machine, {"oil": OIL}), truth_of_run(self.truth, self.rng)
        seconds, speed = speed_law(machine, "run-down", duration=300.0, samples=SAMPLES)
        phasor = measured_phasors(machine, truth, speed, self.rng)
        places = simulated_gaps(machine, truth, time=seconds, speed=speed, rng=self.rng)
        assert places is not None
        gaps = spoiled(as_sent(places, machine), machine.channels.index(SPOILED), fault)
        batch = SampleBatch(
            schema=WIRE_SCHEMA,
            plant=machine.plant,
            machine=machine.id,
            source="test",
            epoch=1,
            sequence=self.count * SAMPLES,
            channels=list(machine.channels),
            speed_unit="rad/s",
            amplitude_unit="m",
            amplitude_kind="peak",
            phase_convention="lead",
            phase_unit="rad",
            direction=machine.rotation,
            time_ns=[round((START_S + self.count * EVERY_S + one) * 1e9) for one in seconds.tolist()],
            speed=speed.tolist(),
            amplitude=np.abs(phasor).tolist(),
            phase=np.angle(phasor).tolist(),
            conditions={"oil": [oil] * SAMPLES},
            gap=gaps.tolist(),
            gap_unit="um",
        )
        self.count += 1
        url = f"/machines/{machine.id}/samples"
        answer = self.service.client.post(url, content=encode_body(batch, JSON), headers={"content-type": JSON})
        assert answer.status_code in (200, 201, 202), answer.text

    def all_judged(self) -> bool:
        """Return whether all runs are closed and everything is identified."""
        closed = [run for run in self.service.get(f"/machines/{NAME}/runs") if run["state"] == "closed"]
        return len(closed) == self.count and self.service.idle()


def verdicts(service: Service) -> list[str]:
    found = service.get(f"/machines/{NAME}/identifications")
    return [one["verdict"] for one in sorted(found, key=lambda one: str(one["measured_at"]))]


@pytest.mark.long
def test_wrong_gaps_and_degrees_fahrenheit_are_named_and_alarm_no_coupling(tmp_path: Any, databases: Databases) -> None:
    url = databases.new(tmp_path / "rundown.db")
    service = Service(tmp_path, database=url, RUNDOWN_BASELINE_RUNS=str(BASELINE))
    with service.running():
        answer = service.client.post("/machines", json=document())
        assert answer.status_code == 201, answer.text
        runs = SentRuns(service)
        for fault in ["", "", "", *(fault for fault in FAULTS for _ in range(2))]:
            runs.send(fault)
        until(partial(runs.all_judged), within_s=240, what="everything identified")
        said = verdicts(service)
        assert len(said) == runs.count
        for number, words in enumerate(FAULTS.values()):
            for verdict in said[BASELINE + 2 * number : BASELINE + 2 * number + 2]:
                assert SPOILED in verdict, verdict
                assert words in verdict, verdict
        runs.send(oil=1.8 * OIL + 32.0)
        runs.send(oil=1.8 * OIL + 32.0)
        until(partial(runs.all_judged), within_s=120, what="the last runs are judged")
        assert len(verdicts(service)) == runs.count - 2
        failed = [one for one in service.get(f"/machines/{NAME}/jobs") if one["state"] == "failed"]
        assert len(failed) == 2
        assert all("were °F sent" in one["error"] for one in failed), failed
        alerts = service.get("/alerts")
        assert [one for one in alerts if one["element"].startswith("coupling.")] == []
    service.client.close()
    databases.drop(url)


def test_documents_that_mean_another_unit_are_refused_or_warned_of(service: Service) -> None:
    said = document()
    with service.running():
        none = said | {"operation": said.get("operation", {}) | {"alignment_tolerances": [{"coupling": "C1", "offset": 0.0}]}}
        refused = service.client.post("/machines", json=none)
        assert refused.status_code == 422
        assert "alignment_tolerances" in refused.text
        assert "greater than 0" in refused.text
        said["bearings"][1]["film"]["elevation_y"] = 120.0
        slip = service.client.post("/machines", json=said)
        assert slip.status_code == 422
        assert "was 120 µm meant" in slip.text, slip.text
        said["bearings"][1]["film"]["elevation_y"] = 1.2e-3
        far = service.client.post("/machines", json=said)
        assert "radial clearance" in far.text, far.text
