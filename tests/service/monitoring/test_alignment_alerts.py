"""A coupling on oil films that goes out of alignment, from stored identifications to the words of the alert."""

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from estimator.machine.alignment_rules import HealthyVariation
from estimator.updated_model.derived_quantities import Derived
from service.advice.alert_advice import alert_advice, alert_message
from service.advice.site_texts import SiteTexts
from service.reports.period import ReportPeriod
from service.reports.reading import read_contents
from service.wording.film_words import LEAST_LOAD
from storage.alerts import alerts
from storage.alerts.alerts import ListedAlert
from storage.database.engine import Database
from storage.findings import derived
from storage.machines import machines
from tests.api_in_process import Api
from tests.assessment import judge_between
from tests.estimator.alignment.drawn_runs import COORDINATES, MODEL, drawn_machine, drawn_run, fitted, place
from tests.estimator.diagnosis.test_film_reference import effects
from tests.plant import SECOND, START, identification, store_identification

BASELINE = 5
WEEK = 7 * 86_400 * SECOND
VARIATION = HealthyVariation()
MACHINE = MODEL.machine
TRENDED = Derived("bearing.B2.load_vertical", "N", 1000.0, 990.0, 1010.0)
"""Of which the runs have a trend; alerts take loads from models."""


class FilmWeeks:
    """Run-downs of the motor and compressor, a week apart, each judged as it is filed."""

    def __init__(self, database: Database) -> None:
        self.database = database
        self.rng = np.random.default_rng(7)
        self.machine = drawn_machine(np.random.default_rng(3))
        self.count = 0
        with database.transaction() as session:
            machines.create(session, MACHINE)

    def file(self, changes: Mapping[str, float], *, times: int) -> None:
        moved = self.machine.copy()
        for name, by in changes.items():
            moved[place(name)] += by / COORDINATES.unit[place(name)]
        for _ in range(times):
            self.count += 1
            self._store(identification_of(drawn_run(moved, VARIATION, self.rng), self.rng))

    def _store(self, outcome: Any) -> None:
        with self.database.transaction() as session:
            moment = START + self.count * WEEK
            row = store_identification(session, outcome, run_id=self.count, measured_at=moment, machine_id=MACHINE.id)
            derived.add(session, row, [TRENDED])
            stored = row.id
        judge_between(self.database, stored, baseline_runs=BASELINE)

    def alerts(self) -> list[ListedAlert]:
        with self.database.reading() as session:
            return list(alerts.find(session, machine_id=MACHINE.id, only_open=False, limit=100))


def words_of(alert: ListedAlert) -> str:
    """Return what the alert says in one sentence."""
    return alert_message(alert, alert_advice(alert, SiteTexts()), SiteTexts())


def identification_of(theta: Any, rng: np.random.Generator) -> Any:
    model = fitted(theta, rng)
    return identification(
        estimates=(),
        coordinates=model.coordinates,
        point=model.values,
        covariance=model.covariance,
        channel_effects=effects(len(model.coordinates)),
    )


def sunk(by: float) -> dict[str, float]:
    return {f"bearing.{bearing}.elevation_y": -by for bearing in ("B3", "B4")}


@pytest.fixture
def weeks(plant: Database) -> FilmWeeks:
    one = FilmWeeks(plant)
    one.file({}, times=BASELINE + 2)
    return one


def test_a_shaft_beyond_tolerance_is_a_danger_with_the_numbers_of_the_table(weeks: FilmWeeks) -> None:
    weeks.file(sunk(120e-6), times=1)
    assert weeks.alerts() == []
    weeks.file(sunk(120e-6), times=1)
    (alert,) = weeks.alerts()
    assert (alert.rule, alert.element, alert.severity) == ("misalignment", "coupling.C1", 2)
    assert words_of(alert).startswith("Coupling C1 is out of alignment: the driven shaft lies ")
    assert "µm lower (allowed " in words_of(alert)
    assert words_of(alert).endswith(", against the baseline, since 2024-01-09")
    api = Api(weeks.database)
    table = {one["name"]: one for one in api.value(f"/machines/{MACHINE.id}/alignment")["numbers"]}
    change = table["coupling.C1.offset_vertical"]["change"]
    told = alert.evidence["quantities"]
    assert told["offset_vertical_um"] == pytest.approx(1e6 * change["value"], rel=1e-6)
    assert told["offset_vertical_half_width_um"] == pytest.approx(5e5 * (change["upper"] - change["lower"]), rel=1e-4)
    assert alert.evidence["moved"] == []  # single elevations would contradict their trends
    shown = re.search(r"lies ([\d.]+) ± ([\d.]+) µm lower", words_of(alert))
    assert shown is not None
    assert float(shown[1]) == pytest.approx(-1e6 * change["value"], abs=0.6)


def test_loads_of_the_sentence_are_those_of_its_figures_and_of_the_table(weeks: FilmWeeks) -> None:
    """A shaft that sinks hangs in the coupling: its first bearing is relieved, and the other shaft's last one loaded."""
    weeks.file(sunk(300e-6), times=2)
    (alert,) = weeks.alerts()
    table = {one["name"]: one for one in Api(weeks.database).value(f"/machines/{MACHINE.id}/alignment")["loads"]}
    assert set(table) == {f"bearing.B{n}.load_{way}" for n in range(1, 5) for way in ("vertical", "horizontal")}
    vertical = [one for name, one in table.items() if name.endswith("vertical")]
    moved = [one for one in vertical if one["change"]["lower"] * one["change"]["upper"] > 0.0]
    told = re.search(r"bearing (B\d carries [^;]*?)(?:;|, against)", words_of(alert))
    assert told is not None, words_of(alert)
    said = dict(re.findall(r"(B\d)(?: carries)? (\d+ % (?:more|less))", told[1]))
    assert said == {
        one["bearing"]: f"{abs(one['change_per_cent']):.0f} % {'more' if one['change']['value'] > 0 else 'less'}"
        for one in moved
        if abs(one["change_per_cent"]) >= LEAST_LOAD
    }
    assert {"more", "less"} == {words.split()[-1] for words in said.values()}
    assert all(abs(one["change_per_cent"]) < 200.0 for one in table.values()), (
        "of the whole load, not of a component near zero"
    )
    parts = {one["name"]: one for one in alert.evidence["parts"] if one["unit"] == "N"}
    assert set(parts) == {one["name"] for one in moved}
    for name, part in parts.items():
        for end in ("value", "lower", "upper"):
            assert part[end] == pytest.approx(table[name]["change"][end], rel=1e-6)


def test_beside_a_worn_bearing_alert_table_and_report_tell_the_offset_that_is_there(weeks: FilmWeeks) -> None:
    weeks.file(sunk(120e-6) | {"bearing.B2.clearance": 0.15}, times=2)
    by_rule = {one.rule: one for one in weeks.alerts()}
    assert set(by_rule) == {"misalignment", "wear"}
    told = by_rule["misalignment"].evidence["quantities"]
    half = told["offset_vertical_half_width_um"]
    assert told["offset_vertical_um"] == pytest.approx(-120.0, abs=half)
    table = {one["name"]: one for one in Api(weeks.database).value(f"/machines/{MACHINE.id}/alignment")["numbers"]}
    change = table["coupling.C1.offset_vertical"]["change"]
    assert 1e6 * change["value"] == pytest.approx(told["offset_vertical_um"], rel=1e-6)
    assert 5e5 * (change["upper"] - change["lower"]) == pytest.approx(half, rel=1e-4)
    period = ReportPeriod(START, START + 60 * WEEK)
    with weeks.database.reading() as session:
        fit = read_contents(session, MACHINE.id, period, texts=SiteTexts(), baseline_runs=BASELINE).fit
    assert fit is not None
    assert set(fit.causes) == {("misalignment", "coupling.C1"), ("wear", "bearing.B2")}


def test_what_is_within_tolerance_is_reported_as_a_change(weeks: FilmWeeks) -> None:
    weeks.file(sunk(20e-6), times=3)
    (alert,) = weeks.alerts()
    assert (alert.rule, alert.severity) == ("misalignment", 1)
    assert words_of(alert).startswith("Coupling C1 has changed its alignment: the driven shaft lies ")


@pytest.mark.long
def test_what_stands_for_months_is_reported_since_it_began(weeks: FilmWeeks) -> None:
    """The newest runs alone say what is there, all of them since when."""
    weeks.file(sunk(120e-6), times=2)
    (first,) = weeks.alerts()
    weeks.file(sunk(120e-6), times=8)
    (alert,) = weeks.alerts()
    assert alert.evidence["runs"] != first.evidence["runs"] or alert.evidence != first.evidence  # it was told anew
    assert words_of(alert).endswith(", against the baseline, since 2024-01-09")


def test_a_season_of_oil_is_nothing_and_does_not_hide_a_shaft_that_sinks(weeks: FilmWeeks) -> None:
    cold = {f"bearing.B{number}.viscosity": 0.45 for number in range(1, 5)}
    weeks.file(cold, times=4)
    assert weeks.alerts() == []
    weeks.file(cold | sunk(120e-6), times=3)
    (alert,) = weeks.alerts()
    assert (alert.rule, alert.element) == ("misalignment", "coupling.C1")


def test_wear_is_reported_in_per_cent_of_the_clearance(weeks: FilmWeeks) -> None:
    weeks.file({"bearing.B2.clearance": np.log(1.15)}, times=2)
    (alert,) = weeks.alerts()
    assert (alert.rule, alert.element) == ("wear", "bearing.B2")
    expected = r"Bearing B2 is worn: its radial clearance is 1[2-8] ± \d(\.\d)? % larger, \d+ µm in place of"
    assert re.match(expected, words_of(alert))


def test_a_step_against_the_growth_of_pedestals_is_told_stays_and_ends_when_it_is_put_back(weeks: FilmWeeks) -> None:
    """The baseline alone allows pedestals so much."""
    weeks.file(sunk(-5e-6), times=4)
    assert weeks.alerts() == []
    weeks.file(sunk(12e-6), times=3)
    (alert,) = weeks.alerts()
    assert (alert.rule, alert.element, alert.severity) == ("misalignment", "coupling.C1", 1)
    told = alert.evidence["quantities"]
    assert told["step_offset_vertical_um"] == pytest.approx(-17.0, abs=told["step_offset_vertical_half_width_um"])
    weeks.file(sunk(12e-6), times=6)
    (standing,) = weeks.alerts()
    assert (standing.id, standing.closed_at, standing.condition) == (alert.id, None, alert.condition)
    assert standing.evidence["since"] == alert.evidence["since"]
    weeks.file(sunk(-5e-6), times=3)
    assert [one.state for one in weeks.alerts()] == ["returned"]


def test_an_alert_ends_when_the_shaft_is_put_back(weeks: FilmWeeks) -> None:
    weeks.file(sunk(120e-6), times=2)
    weeks.file({}, times=2)
    assert [one.state for one in weeks.alerts()] == ["returned"]
