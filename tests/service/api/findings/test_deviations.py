"""Deviations and trend tests over HTTP, of identifications filed week by week."""

from collections.abc import Iterator, Mapping
from datetime import UTC, datetime, timedelta
from typing import Any

import httpx
import numpy as np
import pytest

from benchmarks.serving import served
from estimator.machine.rules import Condition
from estimator.trends.covariates import adjustment
from estimator.trends.deviations import deviations
from estimator.trends.trend_tests import RUN_LENGTH
from service.monitoring import baseline_changes
from service.monitoring.assessment.context import WEEK
from service.monitoring.limits_in_force import set_limits
from service.monitoring.rules.limits import Limits
from storage.database.engine import Database
from storage.findings import identifications, jobs
from storage.machines import machines
from storage.tables.findings import IdentificationRow
from tests.api_in_process import refused
from tests.plant import START, identification, machine, store_identification

BASELINE = 5
STIFFER = {f"coupling.C1.{name}": 1.3 for name in ("kxx", "kyy")}
BEGAN = datetime.fromtimestamp(START / 1e9, UTC)


@pytest.fixture
def api(plant: Database) -> Iterator[httpx.Client]:
    """A client of a real server over the plant's database."""
    with served(plant) as url, httpx.Client(base_url=f"{url}/machines/pump-7", trust_env=False, timeout=10.0) as client:
        yield client


class WeeklyIdentifications:
    """Identifications a week apart, numbered from 1."""

    def __init__(self, plant: Database) -> None:
        self.plant = plant
        self.count = 0

    def file(
        self,
        factors: Mapping[str, float] | None = None,
        *,
        times: int = 1,
        kind: str = "run-down",
        scope: str = jobs.RUN,
        revision: int = 1,
        **outcome: Any,
    ) -> None:
        """Errors of 1 % and of 10 g mm; outcome: as `identification`."""
        names = identification().coordinates
        errors = np.array([1e-5 if ".unbalance." in name else 0.01 for name in names])
        with self.plant.transaction() as session:
            for _ in range(times):
                self.count += 1
                found = identification(factors, covariance=np.diag(errors**2), **outcome)
                moment = START + self.count * WEEK
                store_identification(
                    session,
                    found,
                    run_id=self.count,
                    measured_at=moment,
                    run_kind=kind,
                    scope=scope,
                    revision=revision,
                )


def asked(api: httpx.Client, path: str, **parameters: Any) -> dict[str, Any]:
    answer = api.get(path, params=parameters)
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


def by(key: str, rows: list[dict[str, Any]]) -> dict[str, dict[str, Any]]:
    return {row[key]: row for row in rows}


def test_deviations_are_those_of_the_estimator_with_the_limits_they_reach(plant: Database, api: httpx.Client) -> None:
    weeks = WeeklyIdentifications(plant)
    weeks.file(times=BASELINE)
    weeks.file(STIFFER | {"bearing.B2.kxx": 1.02, "disc.D1.unbalance": 3.0})
    found = asked(api, "/deviations")
    assert (found["identification"], found["missing"], found["left_out"]) == (BASELINE + 1, None, {})
    assert found["baseline"] == {"identifications": [1, 2, 3, 4, 5], "wanted": 5, "since": None, "reason": None, "by": None}
    with plant.reading() as session:
        rows = [identifications.get(session, number) for number in range(1, BASELINE + 2)]
        points = identifications.points(session, rows)
    expected = deviations([points[number] for number in range(1, BASELINE + 1)], points[BASELINE + 1])
    parameters, elements = by("parameter", found["parameters"]), by("element", found["elements"])
    assert list(parameters) == [one.name for one in expected.parameters]
    assert [parameters[one.name]["sigma"] for one in expected.parameters] == [one.sigma for one in expected.parameters]
    assert [elements[one.element]["distance"] for one in expected.elements] == [one.distance for one in expected.elements]
    assert parameters["coupling.C1.kxx"]["per_cent"] == pytest.approx(30.0)
    assert parameters["coupling.C1.kxx"]["reaches"] == "danger"
    assert parameters["bearing.B2.kxx"]["per_cent"] == pytest.approx(2.0)
    assert parameters["bearing.B2.kxx"]["reaches"] is None
    unbalance = parameters["disc.D1.unbalance"]
    # Three times 1e-3 - 5e-4j kg m: twice as much came on top.
    assert unbalance["added"] == pytest.approx(2 * np.hypot(1e-3, 5e-4))
    assert unbalance["added_angle_deg"] == pytest.approx(360 - np.degrees(np.arctan(0.5)))
    assert unbalance["per_cent"] == pytest.approx(200.0)
    assert unbalance["reaches"] == "danger"
    assert parameters["disc.D2.unbalance"]["reaches"] is None
    assert elements["coupling.C1"]["probability"] < 1e-6 < 0.5 < elements["bearing.B1"]["probability"]


def test_deviations_are_measured_by_the_machines_own_limits(plant: Database, api: httpx.Client) -> None:
    weeks = WeeklyIdentifications(plant)
    weeks.file(times=BASELINE)
    weeks.file({"bearing.B2.kxx": 1.2, "bearing.B3.kxx": 1.2})
    lenient = {"elements": {"bearing.B2": {"bearing": {"alert": {"per_cent": 50}}}}}
    with plant.transaction() as session:
        set_limits(session, "pump-7", Limits.model_validate(lenient), by="anna", comment="worn in")
    found = by("parameter", asked(api, "/deviations")["parameters"])
    assert (found["bearing.B2.kxx"]["reaches"], found["bearing.B3.kxx"]["reaches"]) == (None, "alert")


def test_what_is_not_compared_is_said_with_the_reason(plant: Database, api: httpx.Client) -> None:
    weeks = WeeklyIdentifications(plant)
    weeks.file(times=BASELINE - 1)
    weeks.file(unknown=("coupling.C1.kxx",))
    weeks.file(unknown=("bearing.B2.cxx",))
    found = asked(api, "/deviations")
    assert found["left_out"] == {
        "bearing.B2.cxx": "the data leave it uncertain by 200 % of its value",
        "coupling.C1.kxx": "not determined in the baseline, by identification 5",
    }
    assert not set(found["left_out"]) & set(by("parameter", found["parameters"]))


def test_nothing_is_compared_before_the_baseline_is_complete(plant: Database, api: httpx.Client) -> None:
    assert "of machine 'pump-7' was accepted yet" in refused(api.get("/deviations"), 404)
    weeks = WeeklyIdentifications(plant)
    weeks.file(times=2)
    for path in ("/deviations", "/trend-tests"):
        assert asked(api, path)["missing"] == "the baseline has 2 of 5 identifications"
    weeks.file(times=3)
    assert asked(api, "/deviations")["missing"] == "identification 5 is part of the baseline"
    assert asked(api, "/deviations")["parameters"] == []
    weeks.file(accepted=False)
    assert "does not count" in asked(api, "/deviations", identification=6)["missing"]


def test_an_older_identification_is_compared_as_it_was_then(plant: Database, api: httpx.Client) -> None:
    weeks = WeeklyIdentifications(plant)
    weeks.file(times=BASELINE)
    weeks.file(STIFFER)
    weeks.file(times=3)
    found = by("parameter", asked(api, "/deviations", identification=BASELINE + 1)["parameters"])
    assert found["coupling.C1.kxx"]["per_cent"] == pytest.approx(30.0)
    tests = asked(api, "/trend-tests", identification=BASELINE + 2, parameter="coupling.C1.kxx")["tests"]
    assert tests[0]["runs"] == 2


def test_after_a_maintenance_the_new_baseline_is_used(plant: Database, api: httpx.Client) -> None:
    weeks = WeeklyIdentifications(plant)
    weeks.file(times=BASELINE)
    since = START + weeks.count * WEEK + WEEK // 2
    with plant.transaction() as session:
        baseline_changes.note(session, "pump-7", at=since, kind="maintenance", text="re-shimmed", by="anna")
    weeks.file(STIFFER, times=BASELINE + 1)
    found = asked(api, "/deviations")
    assert (found["baseline"]["identifications"], found["baseline"]["reason"], found["baseline"]["by"]) == (
        [6, 7, 8, 9, 10],
        "re-shimmed",
        "anna",
    )
    assert by("parameter", found["parameters"])["coupling.C1.kxx"]["per_cent"] == pytest.approx(0.0, abs=1e-9)


def test_like_is_compared_with_like(plant: Database, api: httpx.Client) -> None:
    weeks = WeeklyIdentifications(plant)
    weeks.file(times=BASELINE)
    weeks.file(kind="run-up")
    assert asked(api, "/deviations")["missing"] == "the baseline has 1 of 5 identifications"


def test_a_step_is_dated_and_its_element_too(plant: Database, api: httpx.Client) -> None:
    weeks = WeeklyIdentifications(plant)
    weeks.file(times=BASELINE + 3)
    weeks.file(STIFFER, times=2)
    found = asked(api, "/trend-tests", parameter=["coupling.C1.kxx", "bearing.B1.kxx"], element="coupling.C1")
    assert found["run_length"] == RUN_LENGTH
    tests = by("name", found["tests"])
    assert list(tests) == ["bearing.B1.kxx", "coupling.C1.kxx", "coupling.C1"]
    for name in ("coupling.C1.kxx", "coupling.C1"):
        assert tests[name]["step_up"]["passed"]
        assert datetime.fromisoformat(tests[name]["step_up"]["began"]) == BEGAN + timedelta(weeks=BASELINE + 4)
        assert tests[name]["step_up"]["runs"] == 2
    assert tests["coupling.C1"]["step_down"] is None
    assert not tests["bearing.B1.kxx"]["step_up"]["passed"]
    assert tests["coupling.C1.kxx"]["newest"] == pytest.approx(30.0)


def test_a_drift_says_when_it_will_reach_the_limits(plant: Database, api: httpx.Client) -> None:
    """0.4 % a week since the baseline, which stands at 4 % after ten weeks; 5 % and 25 % are the default limits."""
    weeks = WeeklyIdentifications(plant)
    weeks.file(times=BASELINE)
    for week in range(1, 11):
        weeks.file({"bearing.B2.kxx": 1.004**week})
    (test,) = asked(api, "/trend-tests", parameter="bearing.B2.kxx")["tests"]
    drift = test["drift"]
    assert drift["per_week"] == pytest.approx(0.4)
    assert drift["probability"] < 1e-3
    for level, per_cent in (("alert", 5.0), ("danger", 25.0)):
        assert drift[level]["per_cent"] == per_cent
        assert drift[level]["expected"] == pytest.approx(np.log(1 + per_cent / 100) / np.log(1.004) - 10)
    assert drift["alert"]["earliest"] <= drift["alert"]["expected"] <= drift["alert"]["latest"]
    (steady,) = asked(api, "/trend-tests", parameter="bearing.B3.kxx")["tests"]
    assert steady["drift"]["alert"] == {"per_cent": 5.0, "expected": None, "earliest": None, "latest": None}


def test_without_a_choice_everything_is_tested(plant: Database, api: httpx.Client) -> None:
    weeks = WeeklyIdentifications(plant)
    weeks.file(times=BASELINE + 1)
    weeks.file(unknown=("bearing.B2.cxx",))
    found = asked(api, "/trend-tests")
    names = set(by("name", found["tests"]))
    assert {"bearing.B1.kxy", "disc.D2.unbalance.imaginary", "coupling.C1", "disc.D1"} <= names
    assert set(found["left_out"]) == {"bearing.B2.cxx"}
    both = asked(api, "/trend-tests", parameter=["disc.D1.unbalance", "bearing.B2.cxx", "bearing.B9.kxx"])
    assert [one["name"] for one in both["tests"]] == ["disc.D1.unbalance.real", "disc.D1.unbalance.imaginary"]
    assert both["left_out"]["bearing.B9.kxx"] == "machine 'pump-7' has nothing of that name"
    assert all(one["drift"] is None for one in both["tests"])


def test_derived_quantities_are_not_tested_and_the_answer_says_why(plant: Database, api: httpx.Client) -> None:
    WeeklyIdentifications(plant).file(times=BASELINE + 1)
    names = ["critical_speed.1", "coupling.C1.misalignment_force", "critical_speed.N"]
    found = asked(api, "/trend-tests", parameter=names)
    derived = "derived from the parameters: trend tests are of identified parameters and of elements"
    unknown = "machine 'pump-7' has nothing of that name"
    assert found["left_out"] == dict(zip(names, [derived, derived, unknown], strict=True))
    assert found["tests"] == []


def test_runs_are_compared_as_under_the_baselines_conditions(plant: Database, api: httpx.Client) -> None:
    """A bearing that softens by 0.3 % per kelvin of its oil; five runs teach two thirds of that."""
    oil = Condition(name="oil", unit="degC")
    with plant.transaction() as session:
        machines.revise(session, machine(conditions=[oil.model_dump()]))
    weeks = WeeklyIdentifications(plant)
    temperatures = [30.0, 40.0, 60.0, 70.0, 50.0, 80.0]
    for temperature in temperatures:
        weeks.file({"bearing.B2.kxx": float(np.exp(-0.003 * (temperature - 50.0)))}, revision=2)
    plain = by("parameter", asked(api, "/deviations")["parameters"])["bearing.B2.kxx"]
    with plant.transaction() as session:
        for number, temperature in enumerate(temperatures, start=1):
            identifications.get(session, number).conditions = {"oil": temperature}
    found = asked(api, "/deviations")
    told = by("parameter", found["parameters"])["bearing.B2.kxx"]
    assert (found["adjusted_for"], found["conditions"]) == (["oil"], {"oil": 80.0})
    assert plain["per_cent"] == pytest.approx(100 * np.expm1(-0.09))
    assert abs(told["per_cent"]) < 0.4 * abs(plain["per_cent"])
    assert abs(told["sigma"]) < 0.4 * abs(plain["sigma"])
    with plant.reading() as session:
        points = identifications.points(session, rows := [identifications.get(session, n) for n in range(1, BASELINE + 2)])
    conditions = [row.conditions or {} for row in rows]
    by_oil = adjustment([points[row.id] for row in rows[:BASELINE]], conditions[:BASELINE], [oil])
    adjusted = [by_oil.adjusted(points[row.id], one) for row, one in zip(rows, conditions, strict=True)]
    expected = next(one for one in deviations(adjusted[:BASELINE], adjusted[-1]).parameters if one.name == "bearing.B2.kxx")
    assert told["sigma"] == pytest.approx(expected.sigma, rel=1e-12)
    (test,) = asked(api, "/trend-tests", parameter="bearing.B2.kxx")["tests"]
    assert test["newest"] == pytest.approx(told["per_cent"])


def test_what_cannot_be_compared_is_refused(plant: Database, api: httpx.Client) -> None:
    WeeklyIdentifications(plant).file(scope=jobs.GATHERED)
    with plant.reading() as session:
        (gathered,) = session.query(IdentificationRow).all()
    for path in ("/deviations", "/trend-tests"):
        assert "only those of single runs" in refused(api.get(path, params={"identification": gathered.id}), 422)
        assert "no identification 99" in refused(api.get(path, params={"identification": 99}), 404)
        assert refused(api.get(path, params={"identification": -1}), 422)
        elsewhere = str(api.base_url).replace("pump-7", "nobody").rstrip("/")
        assert refused(api.get(elsewhere + path), 404).startswith("no machine nobody")
