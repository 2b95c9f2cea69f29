"""Orbits of a run over the API: without its slow roll, with swapped channels, with one axis only."""

import numpy as np
import pytest

from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples
from storage.measurements import runs
from tests.api_in_process import Api
from tests.plant import (
    CHANNELS,
)
from tests.slow_roll import PUMP, given


def test_orbits_of_a_run_without_its_slow_roll(train: tuple[Database, int]) -> None:
    database, run = train
    api = Api(database)
    body = api("GET", f"/runs/{run}/orbits", params={"rpm": 900})
    assert [one["channels"] for one in body["orbits"]] == [[f"B{i}X", f"B{i}Y"] for i in range(1, 5)]
    assert body["findings"] == []  # a run-out does not grow with the speed
    one = body["orbits"][0]
    raw = api("GET", f"/runs/{run}/phasors")
    sample = int(np.argmin(np.abs(np.array(raw["speed_rpm"]) - 900)))
    assert one["speed_rpm"] == pytest.approx(raw["speed_rpm"][sample])
    assert 2 * np.hypot(one["x"]["real_um"], one["x"]["imaginary_um"]) == pytest.approx(raw["amplitude_um_pp"][0][sample])
    assert 0 < one["semi_major_error_um"] < 0.05 * one["semi_major_um"]
    assert one["angles_condition"] == pytest.approx(1.0)
    assert api("GET", f"/runs/{run}/orbits", 422)["errors"][0]["field"] == "query.rpm"
    api("GET", f"/runs/{run}/orbits", 404, params={"rpm": 900, "slow_roll": "1"})


def test_orbits_show_swapped_channels(train: tuple[Database, int]) -> None:
    database, run = train
    api = Api(database)
    with database.transaction() as session:
        held = runs.samples(session, run)
        assert held is not None
        phasor = held.phasor.copy()
        phasor[:, [2, 3]] = phasor[:, [3, 2]]
        swapped = Samples(held.time, held.speed, held.direction, phasor, held.status, held.scatter, held.second)
        runs.close(runs.get(session, run), samples=swapped, state=runs.CLOSED, reason="swapped")
    (finding,) = api("GET", f"/runs/{run}/orbits", params={"rpm": 500})["findings"]
    assert (finding["code"], finding["channels"]) == ("swapped_channels", ["B2X", "B2Y"])


def test_orbits_need_both_axes(pump: Api) -> None:
    (run,) = pump("GET", "/machines/pump-7/runs")
    body = pump("GET", f"/runs/{run['id']}/orbits", params={"rpm": 1000})
    assert len(body["orbits"]) == 2
    # All channels show the same: a straight line.
    assert {one["sense"] for one in body["orbits"]} == {"undecided"}
    assert {one["code"] for one in body["findings"]} == {"orbit_sense_undetectable"}


def test_orbits_name_the_channels_that_they_leave_as_measured(pump: Api) -> None:
    pump("POST", PUMP, 201, json=given())
    (run,) = pump("GET", "/machines/pump-7/runs")
    raw, without = (
        pump("GET", f"/runs/{run['id']}/orbits", params={"rpm": 900, "slow_roll": choice}) for choice in ("none", "1")
    )
    assert (raw["slow_roll_version"], raw["slow_roll_left_out"]) == (None, {})
    assert (without["slow_roll_version"], without["slow_roll_left_out"]) == (
        1,
        dict.fromkeys(CHANNELS[1:], "it has no vector"),
    )
