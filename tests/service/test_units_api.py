"""Units that are asked for: of samples, phasors of runs and orbits, beside what is there; of trends, in its place."""

import numpy as np
import pytest

from storage import runs
from storage.database import Database
from tests.asking import Api, fields
from tests.plant import KEY, SECOND, START, identification, samples, store_identification, sweep_rpm

RUN = 20
MIL_P_PER_UM_PP = 1 / 25.4 / 2


@pytest.fixture
def api(plant: Database) -> Api:
    """Over a machine with a run and some identifications."""
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


@pytest.mark.parametrize("units", ["furlong", "rpm,hz", "rpm,"])
@pytest.mark.parametrize("path", ["/runs/1/phasors", f"/machines/{KEY.machine}/samples", f"/machines/{KEY.machine}/trends"])
def test_units_that_are_none_are_refused(api: Api, path: str, units: str) -> None:
    assert fields(api.get(path, units=units, parameter="coupling.C1.kxx")) == ["query.units"]
