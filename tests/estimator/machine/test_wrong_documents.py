"""Documents with very many errors: each costs more than what it is about, and there may be a million in two megabytes."""

from collections.abc import Callable
from typing import Any

import pytest

from estimator.machine.document import DocumentError, parse_machine
from estimator.strict_model import MOST_UNKNOWN
from tests.estimator.trains import Document, one_disc_document

MANY = 30_000


def with_table(document: Document) -> None:
    bearing = document["bearings"][0]
    bearing["speed_dependence"] = {"form": "table", "speed_rpm": ["x"] * 500, "kxx": ["x"] * 500}


def with_names(document: Document) -> None:
    names = [f"k{number}" for number in range(MANY)]
    document["bearings"][0]["speed_dependence"] = {"form": "piecewise", "knots_rpm": [300, 3000], "coefficients": names}


SPOILT: dict[str, tuple[Callable[[Document], Any], str]] = {
    "parameters": (lambda one: one.update(parameters=[{}] * MANY), f"{MANY} items; at most 200"),
    "shafts[0].sections": (lambda one: one["shafts"][0].update(sections=[{}] * MANY), f"{MANY} items; at most 200"),
    "discs": (lambda one: one.update(discs=[1] * MANY), f"{MANY} items; at most 100"),
    "materials": (lambda one: one.update(materials={f"m{n}": 1 for n in range(MANY)}), f"{MANY} items; at most 50"),
    "document": (lambda one: one.update({f"k{n}": 1 for n in range(MANY)}), "fields are given; there are"),
    "bearings[0]": (lambda one: one["bearings"][0].update({f"k{n}": 1 for n in range(MANY)}), "fields are given; there are"),
    "bearings[0].speed_dependence.kxx[0]": (with_table, "valid number"),
    "bearings[0].speed_dependence.coefficients": (with_names, "items; at most"),
}


@pytest.mark.parametrize("place", SPOILT)
def test_what_is_too_long_is_one_error(place: str) -> None:
    document = one_disc_document()
    spoil, words = SPOILT[place]
    spoil(document)
    with pytest.raises(DocumentError) as found:
        parse_machine(document)
    assert words in dict(found.value.problems)[place]
    assert len(found.value.problems) <= 3


def test_a_few_unknown_fields_are_named_one_by_one() -> None:
    unknown = [f"k{number}" for number in range(MOST_UNKNOWN // 2)]
    with pytest.raises(DocumentError) as found:
        parse_machine(one_disc_document() | dict.fromkeys(unknown, 1))
    assert [field for field, _ in found.value.problems] == unknown
