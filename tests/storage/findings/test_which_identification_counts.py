"""Tests which of several identifications of a run counts, in trends and baselines."""

from storage.database.engine import Database
from storage.findings import identifications, jobs, trends
from storage.findings.identifications import ComparisonGroup
from tests.plant import (
    START,
    identification,
    store_identification,
)


def test_the_newest_accepted_identification_of_a_run_counts(plant: Database) -> None:
    like = ComparisonGroup(revisions=(1,), run_kind="run-down")
    with plant.transaction() as session:
        first = store_identification(session, identification({"coupling.C1.kxx": 1.1}), run_id=1).id
        other = store_identification(session, identification(), run_id=2, measured_at=START + 1).id

        def again(accepted: bool, scope: str = jobs.RUN) -> int:
            job = jobs.enqueue(session, "pump-7", scope=scope, run_ids=[1], options={"again": len(made), "scope": scope})
            assert job is not None
            origin = identifications.Origin("pump-7", 1, job.id, scope, "run-down", [1], START, {"starts": 10}, "0.1.0")
            made.append(identifications.add(session, origin, identification(accepted=accepted)).id)
            return made[-1]

        made: list[int] = []

        def counted() -> tuple[list[int], list[int]]:
            history = trends.histories(session, "pump-7", ["coupling.C1.kxx"], scope=jobs.RUN)["coupling.C1.kxx"]
            accepted = identifications.first_accepted(session, "pump-7", like, limit=10)
            newest = identifications.newest(session, "pump-7", like, limit=10)
            assert [row.id for row in newest] == [row.id for row in reversed(accepted)]
            return history.identification.tolist(), [row.id for row in accepted]

        assert counted() == ([first, other], [first, other])
        again(accepted=False)  # a refused one takes nobody's place
        assert counted() == ([first, other], [first, other])
        again(accepted=True, scope=jobs.VARIANT)
        assert counted() == ([first, other], [first, other])
        second = again(accepted=True)
        assert counted() == ([second, other], [second, other])
        pinned = identifications.accepted_among(session, "pump-7", like, [first])
        assert [row.id for row in pinned] == [second]  # a baseline of named identifications follows
        assert identifications.get(session, first).accepted  # the older ones stay readable
        assert len(identifications.of_machine(session, "pump-7")) == 5


def test_of_a_run_that_was_never_accepted_the_newest_identification_shows(plant: Database) -> None:
    with plant.transaction() as session:
        store_identification(session, identification(accepted=False), run_id=1)
        job = jobs.enqueue(session, "pump-7", scope=jobs.RUN, run_ids=[1], options={"reopened": True})
        assert job is not None
        origin = identifications.Origin("pump-7", 1, job.id, jobs.RUN, "run-down", [1], START, {}, "0.1.0")
        newest = identifications.add(session, origin, identification(accepted=False)).id
        history = trends.histories(session, "pump-7", ["coupling.C1.kxx"], scope=jobs.RUN)["coupling.C1.kxx"]
        assert history.identification.tolist() == [newest]
