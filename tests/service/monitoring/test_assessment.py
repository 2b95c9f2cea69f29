"""Tests what new identifications do to alerts: opened after two in a row, closed by the same kind of run, blinded by
nothing."""

import re
from collections.abc import Mapping

import pytest
from sqlalchemy import event
from sqlalchemy.orm import Session

from service.monitoring import conclusions, context_loading
from service.monitoring.assessment.assess import assess
from storage.alerts import alerts
from storage.alerts.alerts import ListedAlert
from storage.database.engine import Database
from storage.findings import diagnoses
from tests.assessment import judge
from tests.plant import KEY, SECOND, START, identification, store_identification

BASELINE = 5
WEEK = 7 * 86_400 * SECOND
STIFFER = {
    **{f"coupling.C1.{name}": 1.6 for name in ("kxx", "kyy")},
    **{f"bearing.{bearing}.{name}": 1.3 for bearing in ("B2", "B3") for name in ("kxx", "kyy")},
}
COUPLING = ("coupling.C1.kxx", "coupling.C1.kyy")


class Weeks:
    """Identifications of one machine, a week apart, each judged as it is filed."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self.count = 0
        self.revision = 1

    def file(
        self,
        factors: Mapping[str, float] | None = None,
        *,
        times: int = 1,
        unknown: tuple[str, ...] = (),
        kind: str = "run-down",
        accepted: bool = True,
        late: int = 0,
    ) -> None:
        """File runs, a week apart. late: so many weeks ago each was measured when it is filed."""
        for _ in range(times):
            self.count += 1
            moment = START + (self.count - late) * WEEK
            outcome = identification(factors, unknown=unknown, accepted=accepted)
            row = store_identification(
                self.session, outcome, run_id=self.count, measured_at=moment, run_kind=kind, revision=self.revision
            )
            judge(self.session, row, baseline_runs=BASELINE)

    def alerts(self) -> list[ListedAlert]:
        return list(alerts.find(self.session, machine_id=KEY.machine, only_open=False, limit=100))

    def open(self) -> list[str]:
        return [row.element for row in self.alerts() if row.closed_at is None]


def test_applying_an_assessment_reads_nothing_of_the_run_that_was_filed(plant: Database) -> None:
    """All of it is in the context, which was loaded before; what may have changed meanwhile is in the state."""
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE + 2)
        weeks.file(STIFFER)
        moment = START + (weeks.count + 1) * WEEK
        row = store_identification(session, identification(STIFFER), run_id=weeks.count + 1, measured_at=moment)
        context = context_loading.load_context(session, row, baseline_runs=BASELINE)
        assert context is not None
        assessment, state = assess(context), context_loading.load_state(session, row)
        statements: list[str] = []
        event.listen(session.connection(), "before_cursor_execute", lambda *said: statements.append(said[2].lower()))
        conclusions.apply(session, row, context, assessment, state)
        session.flush()
    assert any("insert into alerts" in one for one in statements)
    assert [one for one in statements if re.search(r"from (derived_quantities|estimates|identifications)\b", one)] == []


def test_misalignment_is_called_after_two_in_a_row_and_taken_back_after_two(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE + 2)
        weeks.file(STIFFER)
        assert weeks.open() == []
        weeks.file(STIFFER)
        assert weeks.open() == ["coupling.C1"]
        weeks.file(STIFFER, times=3)
        assert len(weeks.alerts()) == 1
        weeks.file()
        assert weeks.open() == ["coupling.C1"]
        weeks.file()
        assert [row.state for row in weeks.alerts()] == ["returned"]  # open until a person has seen it


def test_a_run_that_does_not_determine_the_coupling_blinds_nothing(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=2)
        weeks.file(unknown=COUPLING)
        weeks.file(times=BASELINE - 2)
        weeks.file(STIFFER, times=2)
        assert weeks.open() == ["coupling.C1"]


def test_runs_that_say_nothing_leave_an_alert_open(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        weeks.file(STIFFER, times=2)
        weeks.file(unknown=COUPLING, times=3)
        assert weeks.open() == ["coupling.C1"]


def test_another_kind_of_run_does_not_take_an_alert_back(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        for _ in range(BASELINE):
            weeks.file()
            weeks.file(kind="run-up")
        for _ in range(4):
            weeks.file(STIFFER)
            weeks.file(kind="run-up")
        assert weeks.open() == ["coupling.C1"]
        assert len(weeks.alerts()) == 1


def test_an_alert_says_what_the_newest_run_says_whichever_was_identified_last(plant: Database) -> None:
    """A run-up is identified after the run-down that followed it."""
    grown = {name: 1.2 * factor for name, factor in STIFFER.items()}
    with plant.transaction() as session:
        weeks = Weeks(session)
        for kind in ("run-up", "run-down"):
            weeks.file(times=BASELINE, kind=kind)
        weeks.file(STIFFER, kind="run-up")
        weeks.file(grown, times=2, kind="run-down")
        (row,) = alerts.open_alerts(session, KEY.machine)
        said, measured_at, count = row.evidence, row.measured_at, row.event_count
        weeks.file(STIFFER, kind="run-up", late=2)
        (row,) = alerts.open_alerts(session, KEY.machine)
        assert (row.measured_at, row.evidence["identification"], row.event_count) == (
            measured_at,
            said["identification"],
            count,
        )
        assert row.evidence["parts"] == said["parts"]
        assert row.evidence["since"] < said["since"], "the run-ups show it since before the run-downs do"
        weeks.file(grown, kind="run-down")
        (row,) = alerts.open_alerts(session, KEY.machine)
        assert row.measured_at > measured_at


def test_what_was_refused_before_the_baseline_was_complete_is_not_the_newest(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=2)
        weeks.file(times=2, accepted=False)
        weeks.file(times=BASELINE)
        assert weeks.alerts() == []
        weeks.file(times=2, accepted=False)
        assert [row.rule for row in weeks.alerts()] == ["misfit"]


def test_since_when_is_remembered_longer_than_runs_are_looked_at(plant: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(context_loading, "LOOKED_BACK", 6)
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE + 1)
        weeks.file(STIFFER, times=3)
        (alert,) = weeks.alerts()
        since, first = alert.evidence["since"], alert.evidence["first_identification"]
        weeks.file(STIFFER, times=6)
        (alert,) = weeks.alerts()
        assert (alert.evidence["since"], alert.evidence["first_identification"]) == (since, first)


def test_an_unbalance_that_changes_is_no_misalignment(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        weeks.file({"disc.D1.unbalance": 5.0, "disc.D2.unbalance": 0.2}, times=4)
        assert {(row.rule, row.element) for row in weeks.alerts()} == {("unbalance", "disc.D1"), ("unbalance", "disc.D2")}


def test_a_run_over_other_speeds_is_not_compared(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        for _ in range(3):
            weeks.count += 1
            slow = identification(STIFFER, speed_minimum=31.0, speed_maximum=60.0)
            row = store_identification(session, slow, run_id=weeks.count, measured_at=START + weeks.count * WEEK)
            judge(session, row, baseline_runs=BASELINE)
            assert diagnoses.of_identification(session, row.id) is None
        assert weeks.alerts() == []


def test_a_diagnosis_is_kept_with_what_it_was_made_against(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        weeks.file(STIFFER, times=2)
        kept = diagnoses.newest(session, KEY.machine)
        assert kept is not None
        assert (kept.identification_id, kept.baseline, kept.runs) == (BASELINE + 2, [1, 2, 3, 4, 5], 2)
        (cause,) = kept.causes
        assert (cause["kind"], cause["element"]) == ("misalignment", "coupling.C1")
        assert cause["first_identification"] == BASELINE + 1
        assert {"coupling.C1", "bearing.B2"} <= {one["parameter"].rsplit(".", 1)[0] for one in cause["moved"]}


def test_data_that_no_fit_explains_are_called_that_and_forgotten_when_fits_are_good_again(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        for accepted in (False, False, True, True):
            weeks.count += 1
            outcome = identification(accepted=accepted, chi_square=125.0 if accepted else 900.0)
            row = store_identification(session, outcome, run_id=weeks.count, measured_at=START + weeks.count * WEEK)
            judge(session, row, baseline_runs=BASELINE)
            if weeks.count == BASELINE + 2:
                assert [(one.rule, one.state) for one in weeks.alerts()] == [("misfit", "unacknowledged")]
        assert [(one.rule, one.state) for one in weeks.alerts()] == [("misfit", "returned")]


def test_an_alert_began_when_it_was_first_seen_however_much_it_has_grown(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        weeks.file({name: 1.0 + 0.3 * (factor - 1.0) for name, factor in STIFFER.items()}, times=2)
        (row,) = weeks.alerts()
        assert row.evidence["first_identification"] == BASELINE + 1
        weeks.file(STIFFER, times=3)
        (row,) = weeks.alerts()
        assert row.evidence["per_cent"] > 20.0
        assert row.evidence["first_identification"] == BASELINE + 1
