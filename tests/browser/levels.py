"""Machines whose sources send more: a copy of the usual one with 2×, overall levels and gaps; a train on films with gaps."""

from typing import Any

import numpy as np
import yaml

from tests.browser.copied_machine import CopiedRuns, create_copy, first_runs, lag_deg, send
from tests.browser.shown_service import MACHINE, simulate
from tests.end_to_end.processes import Service, example, until

FILMS = "motor-compressor"
COPY = "with-second-order"
SECOND_PART = 0.25
"""Of the 1×, in the same direction."""
OVERALL_PART = 1.1
"""Of the 1×; with more, the largest would be beyond what a probe can see."""
GAP_UM = 1000.0
"""Distance of each probe from the shaft at rest, less half of its 1×."""
ZONES = {"source": "a contract made up for this test", "a_b": 1e-4, "b_c": 2e-4, "c_d": 1e-3}


def add_copy(service: Service) -> dict[str, Any]:
    """Create the copy, have its runs identified, and return the batch that its source sent."""
    runs = first_runs(service)
    limits = {
        "vibration_alert": 2e-4,
        "vibration_danger": 2e-3,
        "running_rpm": float(runs.speed_rpm.max()),
        "severity_zones": ZONES,
    }
    probes = [one | {"gap_grows": "away"} for one in example(MACHINE)["probes"]]
    create_copy(service, COPY, "Train with second order", operation=limits, probes=probes)
    sent = _batch(runs)
    send(service, sent)
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


def _batch(runs: CopiedRuns) -> dict[str, Any]:
    amplitude = np.abs(runs.phasor)
    return runs.sent(COPY, runs.phasor) | {
        "amplitude_2x": (SECOND_PART * amplitude).tolist(),
        "phase_2x": np.mod(2 * lag_deg(runs.phasor), 360.0).tolist(),
        "overall": (OVERALL_PART * amplitude).tolist(),
        "gap": (GAP_UM - 0.5 * amplitude).tolist(),
        "gap_unit": "um",
    }
