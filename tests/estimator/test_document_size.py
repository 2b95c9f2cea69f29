"""What a document costs is counted without its model, as the model then has it, and bounded."""

import time
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.large_documents import KINDS, largest, train
from estimator.condensation import condense
from estimator.coordinates import Coordinates
from estimator.document_size import (
    LARGEST_ELEMENTS,
    LARGEST_NUMBERS_PER_SPEED,
    LARGEST_UNKNOWNS,
    document_size,
    require_affordable,
)
from estimator.machine import DocumentError, parse_machine
from estimator.rotor import assemble_rotor
from estimator.shaft import NODE_DOFS

A_SPEED = np.array([100.0])


def problems(document: dict[str, Any]) -> list[tuple[str, str]]:
    """What the door has against a document."""
    with pytest.raises(DocumentError) as caught:
        require_affordable(parse_machine(document))
    return caught.value.problems


@settings(max_examples=25, deadline=None)
@given(
    shafts=st.integers(1, 4),
    sections=st.integers(1, 30),
    bearings=st.integers(2, 8),
    discs=st.integers(1, 6),
    seals=st.integers(0, 3),
    probes=st.integers(2, 12),
    knots=st.sampled_from([0, 2, 3]),
    spread=st.booleans(),
    loads=st.booleans(),
    rules=st.sampled_from(
        [[], [{"names": "bearing.*.k?y", "fixed": True}], [{"names": "bearing.B1.*", "tied_to": "bearing.B0"}]]
    ),
)
def test_what_is_counted_is_what_the_model_has(rules: list[dict[str, Any]], **parts: Any) -> None:
    machine = parse_machine(train(**parts) | {"parameters": rules})
    size = document_size(machine)
    rotor = assemble_rotor(machine)
    assert size.elements == rotor.size // NODE_DOFS - len(machine.shafts)
    condensed = condense(machine, speed=A_SPEED, direction=np.ones(1))
    assert size.unknowns == Coordinates.of(condensed, unbalance_scale=1.0).size
    assert size.excitations == sum(not one.fixed for one in condensed.unknowns.excitations)
    # Places that coincide with a coupling's end are counted twice; never is anything left out.
    assert condensed.known.shape[1] <= size.joined


def test_sections_count_as_elements_whether_or_not_an_element_length_is_given() -> None:
    assert problems(train(shafts=4, sections=600)) == [
        ("shafts", "604 elements of the shafts (600 sections); at most 500 are taken: join sections")
    ]
    ((field, words),) = problems(train(element_length=0.001))
    assert field == "element_length"
    assert words == "6000 elements of the shafts (4 sections); at most 500 are taken: raise it"


def test_an_element_length_of_a_hair_is_refused_at_once() -> None:
    began = time.perf_counter()
    ((field, _),) = problems(train(element_length=1.1e-6))
    assert field == "element_length"
    assert time.perf_counter() - began < 1.0


def test_unknowns_and_what_they_cost_for_each_speed_are_bounded() -> None:
    assert problems(train(bearings=10, knots=12))[0] == (
        "document",
        "978 unknowns to identify; at most 800 are taken: fix or tie some in `parameters`, or give fewer `knots_rpm`",
    )
    ((field, words),) = problems(train(probes=120, bearings=60, discs=20))
    assert field == "document"
    assert "numbers for each speed; at most 60000 are taken" in words
    assert "fewer probes" in words


def test_an_honest_train_is_taken() -> None:
    require_affordable(parse_machine(train(sections=300)))
    require_affordable(parse_machine(train(shafts=9, sections=300, bearings=20, discs=18, probes=40)))


@pytest.mark.parametrize("kind", KINDS)
def test_the_worst_of_each_kind_is_within_all_bounds(kind: str) -> None:
    size = document_size(parse_machine(largest(kind)))
    assert size.elements <= LARGEST_ELEMENTS
    assert size.unknowns <= LARGEST_UNKNOWNS
    assert size.numbers_per_speed <= LARGEST_NUMBERS_PER_SPEED
