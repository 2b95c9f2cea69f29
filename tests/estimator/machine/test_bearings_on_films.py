"""Bearings on films: all bearings of a train with films, none of any other, and none without what its film is."""

from estimator.machine.bearings_on_films import bearings_on_films
from estimator.machine.document import parse_machine
from estimator.machine.parts import Bearing
from tests.estimator.trains import chapter_3_document

FILM = {"diameter": 0.2, "length": 0.1, "radial_clearance": 2e-4, "oil": {"viscosity": 0.03}}


def test_none_of_a_train_without_films_is_on_one() -> None:
    assert bearings_on_films(parse_machine(chapter_3_document()).bearings) == ()


def test_those_on_films_are_given_with_film_and_form() -> None:
    plain = parse_machine(chapter_3_document()).bearings[1]
    fields = plain.model_dump(exclude_none=True) | {"film": FILM}
    without_form = Bearing.model_validate(fields)
    first, second = (
        Bearing.model_validate(fields | {"id": one, "speed_dependence": {"form": "journal"}}) for one in ("F1", "F2")
    )
    found = bearings_on_films([plain, first, without_form, second])
    assert [(one.number, one.id) for one in found] == [(1, "F1"), (3, "F2")]
    assert all(one.film == first.film and one.form == first.speed_dependence for one in found)
