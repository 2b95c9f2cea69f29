"""Machines on oil films through the whole service: simulated, identified, trended with units, no job failing."""

import json
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.end_to_end.processes import EXAMPLES, Service, process, until

CYCLES = 2


def all_identified(service: Service, machine: str) -> bool:
    """Return whether all runs are closed and everything is identified."""
    closed = [run for run in service.get(f"/machines/{machine}/runs") if run["state"] == "closed"]
    return len(closed) == 2 * CYCLES and service.idle()


@pytest.mark.long
@pytest.mark.parametrize("machine", ["motor-compressor", "turbine-on-tilting-pads", "motor-on-rolling-elements"])
def test_films_are_identified_and_trended(service: Service, tmp_path: Path, machine: str) -> None:
    truth = tmp_path / "truth.jsonl"
    options = {"cycles": CYCLES, "samples": 120, "rate": 250, "seed": 3, "truth": truth, "connect": service.endpoint}
    flags = [str(part) for name, value in options.items() for part in (f"--{name}", value)]
    with service.running():
        service.create(machine)
        with process(tmp_path / "simulate.log", "simulate", f"{EXAMPLES / machine}.yaml", *flags) as simulator:
            assert simulator.wait(120) == 0
        until(partial(all_identified, service, machine), within_s=150, what="everything identified")
        assert service.get("/health")["jobs"].get("failed", 0) == 0
        found = service.get(f"/machines/{machine}/identifications")
        assert [one["accepted"] for one in found] == [True] * 2 * CYCLES, [one["verdict"] for one in found]
        true = [json.loads(line)["parameters"]["bearing.B3.clearance"] for line in truth.read_text().splitlines()]
        check_trend(service, machine, true)
        load = trend(service, machine, "bearing.B3.load_vertical")
        assert load["unit"] == "N"
        assert min(load["value"]) > 500.0
        check_alignment(service, machine)


def check_trend(service: Service, machine: str, true: list[float]) -> None:
    """The history of a clearance is the simulated one, within its errors."""
    series = trend(service, machine, "bearing.B3.clearance")
    assert series["unit"] == "m"
    away = (np.array(series["value"]) - true) / np.array(series["standard_error"])
    assert np.abs(away).max() < 4.0
    gap = trend(service, machine, "bearing.B3.eccentricity_ratio")["value"]
    assert all(0.05 < one < 0.95 for one in gap)


def check_alignment(service: Service, machine: str) -> None:
    """Offsets are trended in metres with their intervals; simulated machines are left well aligned."""
    coupling = service.get(f"/machines/{machine}")["document"]["couplings"][0]["id"]
    for plane in ("vertical", "horizontal"):
        offset = trend(service, machine, f"coupling.{coupling}.offset_{plane}")
        assert offset["unit"] == "m"
        values, lower, upper = (np.array(offset[what]) for what in ("value", "lower", "upper"))
        assert np.all((lower < values) & (values < upper))
        assert np.all(np.abs(values) < 120e-6 + (upper - lower))


def trend(service: Service, machine: str, parameter: str) -> dict[str, Any]:
    """The series of one parameter or derived quantity."""
    (series,) = service.get(f"/machines/{machine}/trends", parameter=parameter)["series"]
    return dict(series)
