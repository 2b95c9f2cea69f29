"""A source without a log whose messages overtake each other, against a real service: counters, reopened run, trend."""

from pathlib import Path
from typing import Any

import numpy as np

from estimator.simulation.simulated_plant import draw_truth, measured_phasors, speed_law
from formats.files.document_files import read_machine
from formats.wire import JSON, WIRE_SCHEMA, SampleBatch, encode_body
from tests.end_to_end.processes import EXAMPLES, Service, until

MACHINE = "thesis-chapter-3"
START_S = 1_700_000_000


def sweeps_of_a_day() -> list[SampleBatch]:
    """A hold, a run-down of 200 samples and standstill in batches of 20, a sample a second."""
    machine = read_machine(EXAMPLES / f"{MACHINE}.yaml")
    rng = np.random.default_rng(3)
    _, sweep = speed_law(machine, "run-down", duration=200.0, samples=200)
    speed = np.concatenate([np.full(20, sweep[0]), sweep, np.full(20, 0.5 * sweep[-1])])
    phasor = measured_phasors(machine, draw_truth(machine, rng), speed, rng)
    batches = []
    for first in range(0, speed.size, 20):
        part = slice(first, first + 20)
        batches.append(
            SampleBatch(
                schema=WIRE_SCHEMA,
                plant=machine.plant,
                machine=machine.id,
                source="overtaking",
                epoch=1,
                sequence=first,
                channels=list(machine.channels),
                speed_unit="rad/s",
                amplitude_unit="m",
                amplitude_kind="peak",
                phase_convention="lead",
                phase_unit="rad",
                direction=machine.rotation,
                time_ns=[(START_S + first + i) * 1_000_000_000 for i in range(20)],
                speed=speed[part].tolist(),
                amplitude=np.abs(phasor[part]).tolist(),
                phase=np.angle(phasor[part]).tolist(),
            )
        )
    return batches


def post(service: Service, batch: SampleBatch) -> dict[str, Any]:
    answer = service.client.post(
        f"/machines/{MACHINE}/samples", content=encode_body(batch, JSON), headers={"content-type": JSON}
    )
    assert answer.status_code in (200, 201), answer.text
    return dict(answer.json())


def test_what_came_late_is_in_the_run_and_its_newest_identification_counts(tmp_path: Path) -> None:
    service = Service(tmp_path, RUNDOWN_LATE_S="0.5", RUNDOWN_SILENCE_S="60")
    batches = sweeps_of_a_day()
    listing = f"/machines/{MACHINE}/identifications"
    with service.running():
        service.create(MACHINE)
        for number in (0, 1, 3, 2, 2, 4, 8, 9, 10, 11):
            post(service, batches[number])
        (run,) = service.get(f"/machines/{MACHINE}/runs")
        until(lambda: service.get(f"/runs/{run['id']}")["state"] == "closed", within_s=30, what="the run is closed")
        run = service.get(f"/runs/{run['id']}")
        assert (run["kind"], run["state"], run["reopened_at"]) == ("run-down", "closed", None)
        assert service.get(f"/machines/{MACHINE}/state")["state"] in ("slow roll", "stopped")
        (source,) = service.get("/sources")
        assert (source["received"], source["duplicates"], source["lost"]) == (180, 20, 60)
        until(lambda: len(service.get(listing)) == 1, within_s=150, what="the run is identified")
        for number in (6, 5, 7, 6):
            post(service, batches[number])
        (source,) = service.get("/sources")
        assert (source["received"], source["duplicates"], source["lost"]) == (240, 40, 0)

        def rebuilt() -> bool:
            row = service.get(f"/runs/{run['id']}")
            return row["reopened_at"] is not None and row["state"] == "closed"

        until(rebuilt, within_s=30, what="the run is reopened and closed again")
        until(lambda: len(service.get(listing)) == 2, within_s=150, what="it is identified again")
        again = service.get(f"/runs/{run['id']}")
        assert again["samples"] == run["samples"] + 60
        assert again["coverage"]["late_samples_left_out"] == 0
        newest, first = service.get(listing)
        assert newest["runs"] == first["runs"] == [run["id"]]
        assert newest["samples"] == first["samples"] + 60
        (series,) = service.get(f"/machines/{MACHINE}/trends", parameter="coupling.C1.kxx")["series"]
        assert series["identification"] == [newest["id"]]
    service.client.close()
