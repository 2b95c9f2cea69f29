"""Machines whose sources send more: a copy of the story's with 2×, overall levels and gaps, and a train on films with gaps."""

from datetime import datetime
from typing import Any

import numpy as np
import yaml

from tests.browser.story import MACHINE, closed, simulate
from tests.end_to_end.processes import Service, example, until

FILMS = "motor-compressor"
COPY = "with-second-order"
RUNS = 3
SECOND_PART = 0.25
"""Of the 1×, in the same direction."""
OVERALL_PART = 1.1
"""Of the 1×; with more, the largest would be beyond what a probe can see."""
GAP_UM = 1000.0
"""Distance of each probe from the shaft at rest, less half of its 1×."""
ZONES = {"source": "a contract made up for this test", "a_b": 1e-4, "b_c": 2e-4, "c_d": 1e-3}


def add_copy(service: Service) -> dict[str, Any]:
    """Create the copy, have its runs identified, and return the batch that its source sent."""
    document = example(MACHINE) | {"id": COPY, "name": "Train with second order"}
    sent = _batch(service)
    limits = {"vibration_alert": 2e-4, "vibration_danger": 2e-3, "running_rpm": max(sent["speed"]), "severity_zones": ZONES}
    document["operation"] = limits
    document["probes"] = [one | {"gap_grows": "away"} for one in document["probes"]]
    assert service.client.post("/machines", json=document).status_code == 201
    assert service.client.post(f"/machines/{COPY}/samples", json=sent).status_code == 200
    until(lambda: closed(service, COPY) >= RUNS, within_s=60, what="the runs of the copy are closed")
    until(service.idle, within_s=180, what="they are identified")
    return sent


def add_films(service: Service) -> None:
    """Have a run-up and a run-down identified of a train on oil films whose source sends gaps."""
    document = example(FILMS)
    document["probes"] = [one | {"gap_grows": "away"} for one in document["probes"]]
    path = service.folder / "films.yaml"
    path.write_text(yaml.safe_dump(document), encoding="utf-8")
    assert service.client.post("/machines", json=document).status_code == 201
    simulate(service, FILMS, cycles=1, rate=1000, wait_s=180, document=path)
    until(service.idle, within_s=300, what="both runs are identified")


def _batch(service: Service) -> dict[str, Any]:
    end = sorted(run["started_at"] for run in service.get(f"/machines/{MACHINE}/runs"))[RUNS + 1]
    read = service.get(f"/machines/{MACHINE}/samples", to=end, limit=10_000)
    amplitude, phase = (np.array(read[name], float).T for name in ("amplitude_um_pp", "phase_lag_deg"))
    return {
        "schema": 1,
        "plant": example(MACHINE)["plant"],
        "machine": COPY,
        "source": "copy",
        "epoch": 1,
        "sequence": 0,
        "channels": read["channels"],
        "speed_unit": "rpm",
        "amplitude_unit": "um",
        "amplitude_kind": "peak-to-peak",
        "phase_convention": "lag",
        "phase_unit": "deg",
        "direction": "positive",
        "time_ns": [int(datetime.fromisoformat(time).timestamp() * 1e6) * 1000 for time in read["time"]],
        "speed": read["speed_rpm"],
        "amplitude": amplitude.tolist(),
        "phase": phase.tolist(),
        "amplitude_2x": (SECOND_PART * amplitude).tolist(),
        "phase_2x": np.mod(2 * phase, 360.0).tolist(),
        "overall": (OVERALL_PART * amplitude).tolist(),
        "gap": (GAP_UM - 0.5 * amplitude).tolist(),
        "gap_unit": "um",
    }
