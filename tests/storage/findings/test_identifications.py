"""Identifications, the points and the histories made of them, over a real database."""

import math
from typing import Any

import numpy as np
import pytest
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from storage.database.engine import Database
from storage.findings import identifications, jobs, trends
from storage.machines import baselines, machines
from storage.measurements import runs
from tests.plant import (
    START,
    identification,
    machine,
    samples,
    store_identification,
)


def test_an_identification_comes_back_whole(plant: Database) -> None:
    outcome = identification(unknown=["bearing.B1.kxy"], condition_number=math.inf)
    with plant.transaction() as session:
        stored = store_identification(session, outcome, run_id=1).id
    with plant.reading() as session:
        row = identifications.get(session, stored)
        assert row.accepted
        assert (row.chi_square, row.degrees_of_freedom, row.condition_number) == (123.0, 120, math.inf)
        assert tuple(row.coordinates) == outcome.coordinates
        assert np.array_equal(identifications.covariance(row), outcome.covariance)
        found = identifications.estimates(session, stored)
        assert [one.parameter for one in found] == [one.name for one in outcome.estimates]
        for one, expected in zip(found, outcome.estimates, strict=True):
            for name in ("value", "standard_error", "lower", "upper", "imaginary", "imaginary_standard_error", "reason"):
                assert getattr(one, name) == getattr(expected, name), (one.parameter, name)


def test_unknown_identifications_are_said(plant: Database) -> None:
    with plant.reading() as session, pytest.raises(identifications.IdentificationUnknown):
        identifications.get(session, 5)


def test_a_job_has_one_identification(plant: Database) -> None:
    with plant.transaction() as session:
        first = store_identification(session, identification(), run_id=1)
        origin = identifications.Origin("pump-7", 1, first.job_id, "run", "run-up", [1], START, {}, "0.1.0")
        with pytest.raises(IntegrityError, match=r"(?i)unique"):
            identifications.add(session, origin, identification())
        session.rollback()


def test_identifications_in_a_time_range_newest_first(plant: Database) -> None:
    with plant.transaction() as session:
        for run_id, moment in enumerate((20, 0, 10)):
            store_identification(session, identification(), run_id=run_id, measured_at=START + moment)
    with plant.reading() as session:

        def found(first: int | None = None, last: int | None = None, limit: int | None = None) -> list[int]:
            rows = identifications.of_machine(session, "pump-7", first=first, last=last, limit=limit)
            return [row.measured_at - START for row in rows]

        assert found() == [20, 10, 0]
        assert found(first=START + 10, last=START + 10) == [10]
        assert found(limit=2) == [20, 10]


def test_only_accepted_single_runs_of_one_kind_and_revision_make_a_baseline(plant: Database) -> None:
    with plant.transaction() as session:
        machines.revise(session, machine(name="New"))
        good = [
            store_identification(session, identification(), run_id=i, measured_at=START + 10 * (3 - i)).id for i in range(3)
        ]
        store_identification(session, identification(accepted=False), run_id=10)
        store_identification(session, identification(), run_id=11, run_kind="run-up")
        store_identification(session, identification(), run_id=12, scope=jobs.GATHERED)
        store_identification(session, identification(), run_id=13, revision=2)
    with plant.reading() as session:

        def ids(rows: Any) -> list[int]:
            return [row.id for row in rows]

        like = identifications.ComparisonGroup(revisions=(1,), run_kind="run-down")
        assert ids(identifications.first_accepted(session, "pump-7", like, limit=2)) == good[:0:-1]
        assert ids(identifications.newest(session, "pump-7", like, limit=2)) == good[:2]


def test_history_of_parameters_oldest_first(plant: Database) -> None:
    with plant.transaction() as session:
        for run_id, (moment, factor) in enumerate([(20, 1.2), (0, 1.0), (10, 1.1)]):
            outcome = identification({"coupling.C1.kxx": factor})
            store_identification(session, outcome, run_id=run_id, measured_at=START + moment)
        store_identification(session, identification({"coupling.C1.kxx": 9.0}), run_id=9, scope=jobs.GATHERED)
    names = ["coupling.C1.kxx", "disc.D1.unbalance", "nothing"]
    with plant.reading() as session:
        stiffness, unbalance, nothing = trends.histories(session, "pump-7", names, scope=jobs.RUN).values()
        gathered = trends.histories(session, "pump-7", names, scope=jobs.GATHERED)["coupling.C1.kxx"]
    assert (stiffness.value / 2e6).tolist() == pytest.approx([1.0, 1.1, 1.2])
    assert stiffness.measured_at.tolist() == [START, START + 10, START + 20]
    assert np.isnan(stiffness.imaginary).all()
    assert (gathered.value / 2e6).tolist() == pytest.approx([9.0])
    assert (len(unbalance), unbalance.unit, unbalance.imaginary.tolist()) == (3, "kg m", [-5e-4] * 3)
    assert (len(nothing), nothing.unit) == (0, None)


def test_the_stamp_of_histories_changes_with_what_they_hold(plant: Database) -> None:
    seen = []

    def look(session: Session) -> None:
        seen.append(trends.stamp(session, "pump-7"))

    with plant.transaction() as session:
        look(session)
        look(session)
        store_identification(session, identification(), run_id=1)
        look(session)
        baselines.begin(session, "pump-7", since=START, identification_ids=None, reason="why", by="anna")
        look(session)
        run = runs.open_run(session, "pump-7", revision=1, kind="run-down", direction=1, time_first=START)
        runs.close(run, samples=samples(), state=runs.DISCARDED, reason="joined")
        look(session)
        machines.revise(session, machine(name="New"))
        look(session)
    assert seen[0] == seen[1]
    assert len(set(seen)) == 5
