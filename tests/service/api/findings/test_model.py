"""Tests what follows from an identification, through the API: against the estimator itself and closed forms; what is
refused."""

import math

import numpy as np
import pytest

from estimator.modes.critical_speed import critical_speed_table
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.coupling_loads import coupling_forces
from estimator.updated_model.model import model_at
from storage.database.engine import Database
from tests.api_in_process import Api, fields, problem
from tests.plant import machine, store_identification
from tests.service.api.findings.modelled import MAXIMUM_RPM, MODEL, outcome, values


def test_critical_speeds_are_those_of_the_updated_model(modelled: Api) -> None:
    body = modelled.value("/identifications/1/model/critical-speeds")
    model = model_at(machine(), *values())
    expected = critical_speed_table(
        model.scaled_machine, highest=rpm_to_rad_per_s(1.25 * MAXIMUM_RPM), coefficients=model.coefficients
    )
    assert body["units"]["speed"] == "rpm"
    assert len(expected) == 4
    assert [rpm_to_rad_per_s(one["speed"]) for one in body["critical_speeds"]] == pytest.approx(
        [one.speed for one in expected]
    )
    for one in body["critical_speeds"]:
        assert one["upper"] - one["lower"] == pytest.approx(2 * 1.959964 * one["standard_error"], rel=1e-6)
        assert 0 < one["standard_error"] < 0.02 * one["speed"]
    hertz = modelled.value("/identifications/1/model/critical-speeds", units="hz")
    for one, other in zip(hertz["critical_speeds"], body["critical_speeds"], strict=True):
        assert 60 * one["speed"] == pytest.approx(other["speed"])
        assert 60 * one["standard_error"] == pytest.approx(other["standard_error"])


def test_the_curves_of_the_campbell_diagram_cross_at_the_critical_speeds(modelled: Api) -> None:
    body = modelled.value("/identifications/1/model/campbell", points=30)
    assert len(body["speed"]) == len(body["synchronous_hz"]) == 30
    assert body["speed"][0] == 0.0
    crossings = 0
    for curve in body["curves"]:
        above = [f > s for f, s in zip(curve["frequency_hz"], body["synchronous_hz"], strict=True) if f is not None]
        crossings += sum(one != other for one, other in zip(above[:-1], above[1:], strict=True))
    assert crossings == len(body["critical_speeds"])
    assert all(one["standard_error"] is None for one in body["critical_speeds"])


def test_modes_have_their_shapes_along_the_train(modelled: Api) -> None:
    body = modelled.value("/identifications/1/model/modes", rpm=1500)
    assert body["speed"] == pytest.approx(1500)
    frequencies = [one["frequency_hz"] for one in body["modes"]]
    assert frequencies == sorted(frequencies)
    assert frequencies
    for mode in body["modes"]:
        assert [shaft["shaft"] for shaft in mode["shafts"]] == ["S1", "S2"]
        assert mode["shafts"][0]["at"][0] == 0.0
        assert mode["shafts"][1]["at"][0] == pytest.approx(0.6)
        assert max(max(shaft["semi_major"]) for shaft in mode["shafts"]) == pytest.approx(1.0)
        assert 0 < mode["standard_error_hz"] < 0.02 * mode["frequency_hz"]


def test_misalignment_force_over_speed_with_its_band(modelled: Api) -> None:
    body = modelled.value("/identifications/1/model/misalignment-force", from_rpm=500, to_rpm=2500, points=21)
    assert body["speed"] == pytest.approx(np.linspace(500, 2500, 21).tolist())
    (expected,) = coupling_forces(model_at(machine(), *values()), speed=rpm_to_rad_per_s(1.0) * np.linspace(500, 2500, 21))
    (load,) = body["couplings"]
    for name in ("force_x", "force_y", "moment_x", "moment_y"):
        band = getattr(expected, name)
        assert load[name]["amplitude"] == pytest.approx(band.amplitude.tolist())
        assert load[name]["upper"] == pytest.approx(band.upper.tolist())
        assert load[name]["phase"] == pytest.approx(np.mod(-np.degrees(band.phase), 360.0).tolist())


def test_balancing_leaves_less_vibration(modelled: Api) -> None:
    body = modelled.value("/identifications/1/model/balancing")
    assert [one["plane"] for one in body["corrections"]] == ["D1", "D2"]
    # Two planes, two unbalances: the correction takes both away.
    added = [one["unbalance_g_mm"] * np.exp(1j * math.radians(one["angle_deg"])) for one in body["corrections"]]
    assert added == pytest.approx([-(8e-4 + 5e-4j) * 1e6, -(-1e-3 + 1.5e-3j) * 1e6], rel=1e-6)
    before = np.array([one["amplitude"] for one in body["before"]])
    after = np.array([one["amplitude"] for one in body["after"]])
    assert np.max(after) < 1e-6 * np.max(before)
    one = modelled.value("/identifications/1/model/balancing", plane="D2")
    assert [correction["plane"] for correction in one["corrections"]] == ["D2"]
    squares = [sum(np.sum(np.square(channel["amplitude"])) for channel in one[when]) for when in ("before", "after")]
    assert squares[1] < squares[0]


def test_no_correction_is_proposed_for_speeds_outside_the_documents_range(modelled: Api) -> None:
    body = modelled.value("/identifications/1/model/balancing")
    assert 300 <= min(body["speed"]) <= max(body["speed"]) <= MAXIMUM_RPM
    answer = modelled.get("/identifications/1/model/balancing", to_rpm=MAXIMUM_RPM + 1)
    assert "lies outside the document's speed range" in problem(answer, 422)["detail"]


@pytest.mark.parametrize("path", [*(f"model/{name}" for name in MODEL), "bode", "correlation"])
def test_of_an_unknown_identification_there_is_nothing(modelled: Api, path: str) -> None:
    problem(modelled.get(f"/identifications/77/{path}"), 404)
    problem(modelled.get("/identifications/compare", first=1, second=77), 404)


def test_an_identification_of_an_older_release_has_no_model(plant: Database) -> None:
    with plant.transaction() as session:
        row = store_identification(session, outcome(), run_id=1)
        row.point = None
        number = row.id
    assert "older release" in problem(Api(plant).get(f"/identifications/{number}/bode"), 409)["detail"]


@pytest.mark.parametrize(
    ("path", "word"),
    [
        ("model/misalignment-force?from_rpm=2000&to_rpm=1000", "from_rpm"),
        ("model/balancing?plane=D9", "D9"),
        ("model/balancing?plane=D1&plane=D1", "once"),
        ("bode?run=99", "run 99"),
    ],
)
def test_what_cannot_be_made_is_refused_in_words(modelled: Api, path: str, word: str) -> None:
    assert word in problem(modelled.get(f"/identifications/1/{path}"), 422)["detail"]


@pytest.mark.parametrize("what", ["balancing", "misalignment-force"])
@pytest.mark.parametrize(
    ("asked", "speeds"),
    [
        ({"from_rpm": 2000, "to_rpm": 1000}, "2000 and 1000"),
        ({"from_rpm": 5000}, "5000 and 2900"),
        ({"to_rpm": 100}, "400 and 100"),
    ],
)
def test_an_empty_range_of_speeds_is_refused_by_its_own_name(
    modelled: Api, what: str, asked: dict[str, float], speeds: str
) -> None:
    detail = problem(modelled.get(f"/identifications/1/model/{what}", **asked), 422)["detail"]
    assert detail.startswith(f"from_rpm must be below to_rpm, not {speeds}: ")
    assert "400 and 2900" in detail
    assert "plane" not in detail


@pytest.mark.parametrize(
    ("path", "field"),
    [
        ("model/modes?rpm=0", "query.rpm"),
        ("model/modes?rpm=NaN", "query.rpm"),
        ("model/campbell?points=1000", "query.points"),
        ("model/misalignment-force?from_rpm=-1", "query.from_rpm"),
        ("model/misalignment-force?from_rpm=5e-324", "query.from_rpm"),
        ("bode?points=1", "query.points"),
    ],
)
def test_bounds_of_what_may_be_asked(modelled: Api, path: str, field: str) -> None:
    assert fields(modelled.get(f"/identifications/1/{path}")) == [field]


def test_the_drawing_is_to_scale(modelled: Api) -> None:
    body = modelled.value("/machines/pump-7/drawing")
    assert body["length"] == pytest.approx(1.2)
    assert [(one["begin"], one["end"]) for one in body["sections"]] == [(0.0, 0.6), (0.6, 1.2)]
    assert {one["element"]: one["at"] for one in body["bearings"]} == pytest.approx(
        {"bearing.B1": 0.0, "bearing.B2": 0.6, "bearing.B3": 0.6, "bearing.B4": 1.2}
    )
    assert [one["at"] for one in body["discs"]] == pytest.approx([0.3, 0.9])
    (coupling,) = body["couplings"]
    assert (coupling["element"], coupling["driver"], coupling["driven"], coupling["at"]) == ("coupling.C1", "S1", "S2", 0.6)
    assert [(one["channel"], one["at"]) for one in body["probes"]][-1] == ("B3Y", 0.6)
    problem(modelled.get("/machines/nobody/drawing"), 404)
