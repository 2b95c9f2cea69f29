"""Tests what a machine is compared with: its first runs, the first after a maintenance, or those that a person names."""

import pytest

from service.monitoring import baseline_changes, context_loading
from service.monitoring.assessment.baseline_comparison import compare
from service.monitoring.baseline_changes import BaselineRefused
from storage.alerts import alerts
from storage.database.engine import Database
from storage.machines import baselines, machines
from storage.tables.findings import IdentificationRow
from tests.plant import START, identification, machine, store_identification
from tests.service.monitoring.test_assessment import BASELINE, STIFFER, WEEK, Weeks


def after(weeks: Weeks) -> int:
    """A moment behind the newest identification [ns]."""
    return START + weeks.count * WEEK + WEEK // 2


def test_after_a_maintenance_the_machine_is_compared_with_its_new_self(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        weeks.file(STIFFER, times=2)
        assert weeks.open() == ["coupling.C1"]
        baseline_changes.note(session, "pump-7", at=after(weeks), kind="maintenance", text="coupling re-shimmed", by="anna")
        (alert,) = weeks.alerts()
        assert alert.state == "returned"
        assert alerts.history(session, alert.id)[-1].comment == "a new baseline begins: coupling re-shimmed"
        # As stiff as before the maintenance: that is how it is now.
        weeks.file(STIFFER, times=BASELINE + 3)
        assert [row.state for row in weeks.alerts()] == ["returned"]
        (kept,) = baselines.of_machine(session, "pump-7")
        assert (kept.reason, kept.by, kept.identification_ids) == ("coupling re-shimmed", "anna", None)


def test_a_maintenance_ends_a_rate_of_change_too(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        for week in range(14):
            weeks.file({"bearing.B1.kxx": 1.01**week})
        assert [row.rule for row in weeks.alerts() if row.condition == "unacknowledged"].count("rate_of_change") == 1
        baseline_changes.note(session, "pump-7", at=after(weeks), kind="maintenance", text="new shells", by="anna")
        assert {row.state for row in weeks.alerts()} == {"returned"}


def test_a_maintenance_that_is_said_late_ends_what_rested_on_the_runs_before_it(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        done = after(weeks)
        weeks.file(STIFFER, times=2)
        (alert,) = weeks.alerts()
        assert (alert.state, alert.measured_at > done) == ("unacknowledged", True)
        baseline_changes.note(session, "pump-7", at=done, kind="maintenance", text="coupling re-shimmed", by="anna")
        assert [one.state for one in weeks.alerts()] == ["returned"]
        # One that was done before an alert's own baseline changes nothing for it.
        weeks.file(STIFFER, times=BASELINE)
        weeks.file({"coupling.C1.kxx": 2.0, "coupling.C1.kyy": 2.0}, times=2)
        states = [one.state for one in weeks.alerts()]
        assert "unacknowledged" in states
        baseline_changes.note(session, "pump-7", at=done - 1, kind="maintenance", text="said even later", by="anna")
        assert [one.state for one in weeks.alerts()] == states


def test_a_note_begins_no_baseline(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        baseline_changes.note(session, "pump-7", at=after(weeks), kind="note", text="painted", by="anna")
        weeks.file(STIFFER, times=2)
        assert weeks.open() == ["coupling.C1"]


def test_a_person_may_name_the_baseline(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(STIFFER, times=BASELINE)  # not yet run in
        weeks.file(times=4)
        rows = session.query(IdentificationRow).order_by(IdentificationRow.id).all()
        named = [row.id for row in rows[BASELINE:]]
        baseline_changes.begin(session, "pump-7", since=after(weeks), reason="run in", by="anna", identification_ids=named)
        weeks.file(STIFFER, times=2)
        assert [row.state for row in weeks.alerts() if row.rule == "misalignment"] == ["unacknowledged"]


def test_what_makes_no_baseline_is_refused(plant: Database) -> None:
    with plant.transaction() as session:
        machines.create(session, machine(id="fan-2"))
        good = [store_identification(session, identification(), run_id=i, measured_at=START + i).id for i in (1, 2, 3)]
        bad = store_identification(session, identification(accepted=False), run_id=9, measured_at=START).id

        def begin(ids: list[int], machine_id: str = "pump-7") -> None:
            baseline_changes.begin(session, machine_id, since=START, reason="why", by="anna", identification_ids=ids)

        with pytest.raises(BaselineRefused, match="at least 3"):
            begin([good[0], good[1], good[1]])
        with pytest.raises(BaselineRefused, match="was not accepted"):
            begin([*good, bad])
        with pytest.raises(BaselineRefused, match="is of machine 'pump-7', not of 'fan-2'"):
            begin(good, "fan-2")
        assert baselines.of_machine(session, "pump-7") == []
        begin(good)


def filed_under(weeks: Weeks, revision: int, factors: dict[str, float] | None = None) -> None:
    """One more identification, under a revision."""
    weeks.revision = revision
    weeks.file(factors)


@pytest.mark.parametrize(
    ("change", "found"),
    [({"name": "Feed pump 7"}, ["coupling.C1"]), ({"element_length": 0.01}, [])],
    ids=["a rename changes nothing", "another model begins anew"],
)
def test_a_revision_keeps_the_baseline_when_it_describes_the_same(
    plant: Database, change: dict[str, object], found: list[str]
) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        machines.revise(session, machine(**change))
        for _ in range(2):
            filed_under(weeks, 2, STIFFER)
        assert weeks.open() == found


def test_a_revision_that_describes_another_machine_ends_what_was_said_of_the_one_before(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        weeks.file(STIFFER, times=2)
        baseline_changes.revise(session, machine(name="Feed pump 7"))
        assert [row.state for row in weeks.alerts()] == ["unacknowledged"]
        baseline_changes.revise(session, machine(element_length=0.01))
        (alert,) = weeks.alerts()
        assert alert.state == "returned"
        assert "revision 3 describes the machine otherwise" in alerts.history(session, alert.id)[-1].comment


def test_comparable_revisions_are_those_without_a_break_between(plant: Database) -> None:
    with plant.transaction() as session:
        for change in ({"name": "b"}, {"element_length": 0.01}, {"element_length": 0.01, "name": "c"}, {"name": "d"}):
            machines.revise(session, machine(**change))
        found = [machines.comparable_revisions(session, "pump-7", number) for number in range(1, 6)]
        assert found == [[1, 2], [1, 2], [3, 4], [3, 4], [5]]


def test_baselines_hold_identifications_of_one_slow_roll_version(plant: Database) -> None:
    with plant.transaction() as session:
        for number in range(7):
            row = store_identification(session, identification(), run_id=number, measured_at=START + number)
        context = context_loading.load_context(session, row, baseline_runs=5)
        assert context is not None
        found = compare(context)
        assert found is not None
        assert len(found.after) == 2
        row.slow_roll_version = 1
        session.flush()
        context = context_loading.load_context(session, row, baseline_runs=5)
        assert context is not None
        assert compare(context) is None
