"""Copies of the scenario's machine in the same service: its first runs, changed by a test, as a source would send them."""

from dataclasses import dataclass
from datetime import datetime
from typing import Any

import numpy as np

from estimator.arrays import Complexes, Floats
from tests.browser.shown_service import MACHINE, closed
from tests.end_to_end.processes import Service, example, until

RUNS = 3
"""Runs of the scenario that a copy has."""


@dataclass(frozen=True)
class CopiedRuns:
    """Samples of the first runs. times: of S samples; begins: of the runs; phasor: (S, m) [µm peak-to-peak], phase lead."""

    channels: tuple[str, ...]
    times: tuple[datetime, ...]
    begins: tuple[datetime, ...]
    speed_rpm: Floats
    phasor: Complexes

    def sent(self, machine: str, phasor: Complexes) -> dict[str, Any]:
        """A batch of all samples with other phasors (S, m) [µm peak-to-peak], from a source of its own."""
        return {
            "schema": 1,
            "plant": example(MACHINE)["plant"],
            "machine": machine,
            "source": "copy",
            "epoch": 1,
            "sequence": 0,
            "channels": list(self.channels),
            "speed_unit": "rpm",
            "amplitude_unit": "um",
            "amplitude_kind": "peak-to-peak",
            "phase_convention": "lag",
            "phase_unit": "deg",
            "direction": "positive",
            "time_ns": [int(time.timestamp() * 1e6) * 1000 for time in self.times],
            "speed": self.speed_rpm.tolist(),
            "amplitude": np.abs(phasor).tolist(),
            "phase": lag_deg(phasor).tolist(),
        }


def lag_deg(phasor: Complexes) -> Floats:
    """Phase lag of phasors [°]."""
    return np.asarray(-np.degrees(np.angle(phasor)))


def phasors(amplitude: Any, lag_deg: Any) -> Complexes:
    """Phasors of amplitudes and phase lags [°]."""
    return np.asarray(np.array(amplitude, dtype=float) * np.exp(-1j * np.radians(np.array(lag_deg, dtype=float))))


def first_runs(service: Service) -> CopiedRuns:
    """The first runs of the scenario's machine."""
    begins = sorted(run["started_at"] for run in service.get(f"/machines/{MACHINE}/runs"))[: RUNS + 2]
    read = service.get(f"/machines/{MACHINE}/samples", to=begins[-1], limit=10_000)
    return CopiedRuns(
        channels=tuple(read["channels"]),
        times=tuple(map(datetime.fromisoformat, read["time"])),
        begins=tuple(map(datetime.fromisoformat, begins)),
        speed_rpm=np.array(read["speed_rpm"], dtype=float),
        phasor=phasors(read["amplitude_um_pp"], read["phase_lag_deg"]).T,
    )


def create_copy(service: Service, machine: str, name: str, **changes: Any) -> dict[str, Any]:
    """Create the scenario's machine under another id, with changes of its document; return the document."""
    document = example(MACHINE) | {"id": machine, "name": name} | changes
    answer = service.client.post("/machines", json=document)
    assert answer.status_code == 201, answer.text
    return document


def send(service: Service, batch: dict[str, Any]) -> None:
    """Send the runs of a copy, which are closed when this returns."""
    answer = service.client.post(f"/machines/{batch['machine']}/samples", json=batch)
    assert answer.status_code == 200, answer.text
    until(lambda: closed(service, batch["machine"]) >= RUNS, within_s=30, what="the runs of the copy are closed")
