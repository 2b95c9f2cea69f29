"""Identifications whose loads on oil films are balanced otherwise, by an older release: never compared in silence."""

from service.monitoring.comparison import compared
from service.monitoring.trend_bands import baseline_bands
from storage.database.engine import Database
from storage.findings import jobs, trends
from storage.machines import baselines
from storage.tables.findings import IdentificationRow
from tests.plant import KEY, START, identification, store_identification

BASELINE = 5
STIFFNESS = "coupling.C1.kxx"


def stored(database: Database, balances: list[int | None]) -> list[int]:
    """Identifications of single runs, one after the other, with their versions of the balance."""
    ids = []
    with database.transaction() as session:
        for number, version in enumerate(balances):
            row = store_identification(session, identification(), run_id=number + 1, measured_at=START + number)
            row.load_balance = version
            ids.append(row.id)
    return ids


def test_those_by_an_older_release_make_no_baseline_for_new_ones_and_are_reported(plant: Database) -> None:
    *_, last = stored(plant, [None] * BASELINE + [2])
    with plant.reading() as session:
        row = session.get_one(IdentificationRow, last)
        found = compared(session, row, baseline_runs=BASELINE)
    assert [one.id for one in found.baseline] == [last]
    assert found.missing is not None
    assert found.missing.startswith("the baseline has 1 of 5 identifications; 5 more are by a release that balances the loads")
    assert found.missing.endswith("identify their runs again")


def test_of_named_identifications_those_are_reported_whenever_they_were_measured(plant: Database) -> None:
    """Others by the older release do not matter: they would not join the baseline if they were identified again."""
    *before, last = stored(plant, [None] * BASELINE + [2])
    with plant.transaction() as session:
        baselines.begin(
            session, KEY.machine, since=START + BASELINE, identification_ids=before[:2], reason="aligned", by="anna"
        )
    with plant.reading() as session:
        found = compared(session, session.get_one(IdentificationRow, last), baseline_runs=BASELINE)
    assert found.missing is not None
    assert found.missing.startswith("the baseline has 0 of 2 identifications; 2 more are by a release that balances the loads")


def test_a_complete_baseline_has_no_hint(plant: Database) -> None:
    *_, last = stored(plant, [None] + [2] * (BASELINE + 1))
    with plant.reading() as session:
        found = compared(session, session.get_one(IdentificationRow, last), baseline_runs=BASELINE)
    assert (found.missing, found.balanced_otherwise) == (None, 0)


def test_once_their_runs_are_identified_again_there_is_a_baseline(plant: Database) -> None:
    *_, last = stored(plant, [2] * (BASELINE + 1))
    with plant.reading() as session:
        found = compared(session, session.get_one(IdentificationRow, last), baseline_runs=BASELINE)
    assert found.missing is None
    assert found.balanced_otherwise == 0


def test_where_the_balance_does_not_matter_releases_are_compared(plant: Database) -> None:
    *_, last = stored(plant, [None] * (BASELINE + 1))
    with plant.reading() as session:
        found = compared(session, session.get_one(IdentificationRow, last), baseline_runs=BASELINE)
    assert found.missing is None


def test_a_trend_has_a_band_for_each_balance(plant: Database) -> None:
    ids = stored(plant, [None] * BASELINE + [2] * BASELINE)
    with plant.reading() as session:
        history = trends.histories(session, KEY.machine, [STIFFNESS], scope=jobs.RUN)[STIFFNESS]
        bands = baseline_bands(session, KEY.machine, STIFFNESS, history, baseline_runs=BASELINE)
    assert [one.identifications for one in bands] == [tuple(ids[:BASELINE]), tuple(ids[BASELINE:])]
