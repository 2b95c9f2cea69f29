"""Zero contradictions between the places that tell of one thing, and the comparison sees one when there is one."""

from collections.abc import Callable, Mapping
from typing import Any

import pytest
from sqlalchemy import update

from storage.database.engine import Database
from storage.tables.findings import DiagnosisRow
from tests.api_in_process import Api
from tests.contradictions import contradictions
from tests.estimator.alignment.drawn_runs import MODEL
from tests.plant import KEY
from tests.service.monitoring.test_alignment_alerts import Weeks as FilmWeeks
from tests.service.monitoring.test_alignment_alerts import sunk
from tests.service.monitoring.test_assessment import BASELINE, STIFFER, Weeks

STORIES: Mapping[str, Mapping[str, float]] = {
    "misalignment": STIFFER,
    "unbalance": {"disc.D1.unbalance": 3.0},
    "bearing": {"bearing.B1.kxx": 1.4, "bearing.B1.kyy": 1.4},
}
FILM_STORIES: Mapping[str, Mapping[str, float]] = {
    "misalignment": sunk(120e-6),
    "wear": {"bearing.B2.clearance": 0.15},
}


def asked(api: Api) -> Callable[[str], Any]:
    """Function that asks the API."""
    return lambda path: api.value(path)


@pytest.mark.parametrize("rule", STORIES)
def test_a_train_with_coefficients_is_told_in_one_way(plant: Database, rule: str) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE, unknown=("coupling.C1.cxx",))
        for week in range(4):
            weeks.file({name: 1.0 + (factor - 1.0) * (0.7 + 0.1 * week) for name, factor in STORIES[rule].items()})
    api = Api(plant)
    assert [one["rule"] for one in api.value("/alerts?open=true")] == [rule]
    wrong, compared = contradictions(asked(api), KEY.machine)
    assert wrong == []
    assert compared > 20


@pytest.mark.parametrize("rule", FILM_STORIES)
def test_a_train_on_oil_films_is_told_in_one_way(plant: Database, rule: str) -> None:
    weeks = FilmWeeks(plant)
    weeks.file({}, times=BASELINE + 2)
    weeks.file(FILM_STORIES[rule], times=3)
    api = Api(plant)
    assert [one["rule"] for one in api.value("/alerts?open=true")] == [rule]
    wrong, compared = contradictions(asked(api), MODEL.machine.id)
    assert wrong == []
    assert compared > 20


def test_a_contradiction_is_seen(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        weeks.file(STIFFER, times=2)
        row = session.query(DiagnosisRow).order_by(DiagnosisRow.identification_id.desc()).first()
        assert row is not None
        (cause,) = row.causes
        part = cause["parts"][0]
        lied = cause | {"parts": [part | {"value": 2.0 * part["value"]}, *cause["parts"][1:]]}
        session.execute(
            update(DiagnosisRow).where(DiagnosisRow.identification_id == row.identification_id).values(causes=[lied])
        )
    api = Api(plant)
    wrong, _ = contradictions(asked(api), KEY.machine)
    assert any(part["name"] in one and "diagnosis" in one for one in wrong)
