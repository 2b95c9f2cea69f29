"""Units that are asked for: of samples, phasors of runs and orbits, beside what is there; of parameters, in its place."""

import numpy as np
import pytest

from estimator.updated_model.derived_quantities import Derived
from storage.database.engine import Database
from storage.findings import derived, identifications
from storage.measurements import runs
from tests.api_in_process import Api, fields
from tests.plant import KEY, SECOND, START, identification, samples, store_identification, sweep_rpm

RUN = 20
MIL_P_PER_UM_PP = 1 / 25.4 / 2
TAKING_UNITS = ["/runs/1/phasors", f"/machines/{KEY.machine}/samples", f"/machines/{KEY.machine}/trends", "/identifications/1"]


@pytest.fixture
def api(plant: Database) -> Api:
    """An API over a machine with a run and some identifications."""
    with plant.transaction() as session:
        run = runs.open_run(session, KEY.machine, revision=1, kind="run-down", direction=1, time_first=START)
        held = samples(RUN, start=START, rpm=sweep_rpm(2900.0, 400.0, RUN))
        runs.close(run, samples=held, state=runs.CLOSED, reason="the speed left the speed range")
        for number in range(5):
            outcome = identification({"coupling.C1.kxx": 1.0 + 0.01 * number})
            store_identification(session, outcome, run_id=run.id + number, measured_at=START + number * SECOND)
    return Api(plant)


def test_phasors_stand_in_the_units_asked_for_beside_their_own(api: Api) -> None:
    own = api.value("/runs/1/phasors")
    assert own["in_units"] is None
    found = api.value("/runs/1/phasors", units="mil_p,hz,rad_lead")
    other = found.pop("in_units")
    assert found == {name: value for name, value in own.items() if name != "in_units"}
    assert other["units"] == {"speed": "hz", "amplitude": "mil_p", "phase": "rad_lead"}
    assert np.array(other["speed"]) == pytest.approx(np.array(own["speed_rpm"]) / 60)
    for ours, theirs in zip(other["amplitude"], own["amplitude_um_pp"], strict=True):
        assert np.array(ours, float) == pytest.approx(np.array(theirs, float) * MIL_P_PER_UM_PP, nan_ok=True)
    for ours, theirs in zip(other["phase"], own["phase_lag_deg"], strict=True):
        turned = np.exp(1j * np.array(ours, float)), np.exp(-1j * np.radians(np.array(theirs, float)))
        assert turned[0] == pytest.approx(turned[1], nan_ok=True)


def test_what_comes_beside_the_1x_stands_in_the_units_asked_for_too(plant: Database) -> None:
    held = samples(3, start=START)
    held.second[:, 2] = 2e-6 * np.exp(-1j * np.radians(40.0))
    held.scatter[:, 1] = 1e-6
    with plant.transaction() as session:
        run = runs.open_run(session, KEY.machine, revision=1, kind="run-down", direction=1, time_first=START)
        runs.close(run, samples=held, state=runs.CLOSED, reason="the speed left the speed range")
    other = Api(plant).value("/runs/1/phasors", units="um_p,deg_lead", include=["2x", "scatter"])["in_units"]
    assert other["amplitude_2x"] == [[None] * 3, [None] * 3, [pytest.approx(2.0)] * 3, [None] * 3]
    assert other["phase_2x"] == [[None] * 3, [None] * 3, [pytest.approx(320.0)] * 3, [None] * 3]
    assert other["scatter"] == [[None] * 3, [pytest.approx(1.0)] * 3, [None] * 3, [None] * 3]
    plain = Api(plant).value("/runs/1/phasors", units="um_p")["in_units"]
    assert [plain[name] for name in ("amplitude_2x", "phase_2x", "scatter")] == [None] * 3


def test_orbits_stand_in_the_units_asked_for_beside_their_own(api: Api) -> None:
    assert api.value("/runs/1/orbits", rpm=1000)["units"] is None
    found = api.value("/runs/1/orbits", rpm=1000, units="mm_pp,rad_s")
    assert found["units"] == {"speed": "rad_s", "amplitude": "mm_pp", "phase": "deg_lag"}
    assert found["orbits"]
    for one in found["orbits"]:
        other = one["in_units"]
        assert other["speed"] == pytest.approx(one["speed_rpm"] * np.pi / 30)
        assert other["semi_major"] == pytest.approx(one["semi_major_um"] * 2e-3)
        assert other["x"] == pytest.approx(abs(complex(one["x"]["real_um"], one["x"]["imaginary_um"])) * 2e-3)


def test_trends_are_in_the_units_asked_for(api: Api) -> None:
    asked = {"parameter": ["coupling.C1.kxx", "disc.D1.unbalance"]}
    stiffness, unbalance = api.value(f"/machines/{KEY.machine}/trends", **asked)["series"]
    assert (stiffness["unit"], unbalance["unit"]) == ("N/m", "kg m")
    other = api.value(f"/machines/{KEY.machine}/trends", units="n_um,g_mm,rpm", **asked)["series"]
    assert [one["unit"] for one in other] == ["N/µm", "g mm"]
    for name in ("value", "lower", "upper", "standard_error"):
        assert np.array(other[0][name], float) == pytest.approx(np.array(stiffness[name], float) * 1e-6, nan_ok=True)
    for name in ("value", "lower", "upper", "real", "imaginary"):
        assert np.array(other[1][name], float) == pytest.approx(np.array(unbalance[name], float) * 1e6, nan_ok=True)
    assert api.value(f"/machines/{KEY.machine}/trends", **asked)["series"] == [stiffness, unbalance]


def test_estimates_and_derived_quantities_are_in_the_units_asked_for(api: Api) -> None:
    speed = Derived("critical_speed.1", "rad/s", 100.0, 90.0, 110.0)
    with api.database.transaction() as session:
        derived.add(session, identifications.get(session, 1), [speed, Derived("damping_ratio.1", "1", 0.1, 0.0, 0.2)])
    own = api.value("/identifications/1", covariance=True)
    other = api.value("/identifications/1", covariance=True, units="n_um,g_mm,rpm")
    sizes = {"N/m": ("N/µm", 1e6), "kg m": ("g mm", 1e-6), "rad/s": ("rpm", np.pi / 30)}
    for kind in ("estimates", "derived"):
        for ours, theirs in zip(own[kind], other[kind], strict=True):
            written, size = sizes.get(ours["unit"], (ours["unit"], 1.0))
            assert theirs["unit"] == written
            for name in {"value", "standard_error", "lower", "upper", "imaginary", "imaginary_standard_error"} & ours.keys():
                assert np.array(theirs[name], float) == pytest.approx(np.array(ours[name], float) / size, nan_ok=True)
    assert other["derived"][0]["value"] == pytest.approx(955, abs=0.1)
    assert other["covariance"] == own["covariance"]
    assert api.value("/identifications/1", covariance=True) == own


@pytest.mark.parametrize(
    "path",
    [
        f"/machines/{KEY.machine}/drawing",
        f"/machines/{KEY.machine}",
        f"/machines/{KEY.machine}/deviations",
        "/identifications/1/correlation",
        "/runs/1",
        "/machines",
    ],
)
def test_where_there_are_no_others_units_are_refused(api: Api, path: str) -> None:
    assert api.get(path).status_code == 200
    answer = api.get(path, units="rpm")
    assert fields(answer) == ["query.units"]
    assert "leave it out" in answer.json()["errors"][0]["message"]


def also(path: str) -> dict[str, str]:
    """Return what else has to be asked for."""
    return {"parameter": "coupling.C1.kxx"} if path.endswith("/trends") else {}


@pytest.mark.parametrize("units", ["furlong", "rpm,hz", "rpm,"])
@pytest.mark.parametrize("path", TAKING_UNITS)
def test_units_that_are_none_are_refused(api: Api, path: str, units: str) -> None:
    assert fields(api.get(path, units=units, **also(path))) == ["query.units"]


@pytest.mark.parametrize("path", TAKING_UNITS)
def test_units_in_several_parameters_are_refused_as_only_the_last_would_count(api: Api, path: str) -> None:
    answer = api.get(path, units=["rpm", "hz"], **also(path))
    assert fields(answer) == ["query.units"]
    assert answer.json()["errors"][0]["message"].endswith("give it once, with commas between: units=rpm,hz")


@pytest.mark.parametrize("path", TAKING_UNITS)
def test_units_given_twice_are_called_so(api: Api, path: str) -> None:
    answer = api.get(path, units="hz,hz", **also(path))
    assert fields(answer) == ["query.units"]
    assert answer.json()["errors"][0]["message"] == "'hz' is given twice: name it once"


def test_of_two_units_of_a_quantity_both_are_said_as_they_were_given(api: Api) -> None:
    answer = api.get("/identifications/1", units="hz,rpm")
    assert answer.json()["errors"][0]["message"] == "'rpm' and 'hz' are both in the place of rad/s: name one"
