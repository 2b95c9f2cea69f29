"""Values that only a slip of the unit explains: refused at the door by name, and read from the store all the same."""

from typing import Any

import pytest

from estimator.machine.document import DocumentError, parse_machine
from estimator.machine.document_size import accepted_machine
from tests.estimator.trains import chapter_3_document


def gigapascals(document: dict[str, Any]) -> None:
    document["materials"]["steel"]["young_modulus"] = 210.0


def millimetres(document: dict[str, Any]) -> None:
    document["shafts"][0]["sections"][0]["outer_diameter"] = 20.0


def newtons_per_micrometre(document: dict[str, Any]) -> None:
    document["bearings"][1]["kxx"] = 90.0


@pytest.mark.parametrize(
    ("slip", "field", "words"),
    [
        (gigapascals, "materials.steel.young_modulus", "210 N/m²: steel has 2.1e\\+11 N/m²; was 210 GPa meant"),
        (millimetres, "shafts\\[0\\].sections\\[0\\].outer_diameter", "20 m: usual is 0.01 to 2 m; was 20 mm meant"),
        (newtons_per_micrometre, "bearings\\[1\\].kxx", "90 N/m: usual is 1e\\+6 to 1e\\+10 N/m; was 90 N/µm meant"),
    ],
)
def test_a_slip_of_the_unit_is_refused_where_the_document_enters(slip: Any, field: str, words: str) -> None:
    document = chapter_3_document()
    slip(document)
    with pytest.raises(DocumentError, match=f"{field}: {words}"):
        accepted_machine(document)
    assert parse_machine(document).id == "thesis-chapter-3"


def test_the_thesis_train_is_plausible() -> None:
    assert accepted_machine(chapter_3_document()).bearings
