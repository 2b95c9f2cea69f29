"""Forces that a document calls exact and a fit doubts widen what they act on at once, as those that may be off do."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fit.identification import Identification
from estimator.fit.validation.doubted_force import DoubtedForce
from estimator.identification.pooling import combine
from estimator.machine.document import parse_machine
from estimator.updated_model.film_results import film_results
from estimator.updated_model.model import expected_model, updated_model
from estimator.updated_model.static_coupling_loads import static_coupling_loads
from tests.estimator.statics.test_film_model import document
from tests.estimator.statics.test_process_forces import FORCE_Y, with_force
from tests.estimator.updated_model.test_derived_quantities import outcome

SIZE = 200.0
"""Rms by which the force may be off [N]."""


def test_loads_and_shear_are_as_uncertain_as_with_a_force_that_the_document_leaves_open() -> None:
    exact = parse_machine(with_force(document(discrepancy=0.0), force_y=-500.0))
    free = expected_model(parse_machine(with_force(document(discrepancy=0.0), force_y=-500.0, force_y_spread=SIZE)))
    known = outcome(expected_model(exact))
    answer = np.random.default_rng(2).standard_normal(len(known.coordinates)) * 1e-6
    doubted = replace(
        known,
        covariance=SIZE**2 * np.outer(answer, answer),
        doubted_forces=(DoubtedForce(FORCE_Y, SIZE, answer),),
    )
    along = np.array([1.0 if name == FORCE_Y else answer[known.coordinates.index(name)] for name in free.coordinates])
    wanted = replace(free, covariance=SIZE**2 * np.outer(along, along))
    found = updated_model(exact, doubted)
    assert set(found.coordinates) == set(free.coordinates)
    for results in (film_results, static_coupling_loads):
        of_wanted = {one.name: one for one in results(wanted)}
        of_found = {one.name: one for one in results(found)}
        assert list(of_found) == list(of_wanted)
        for name, one in of_wanted.items():
            assert of_found[name].value == pytest.approx(one.value, rel=1e-9, abs=1e-12)
            assert of_found[name].error == pytest.approx(one.error, rel=1e-6, abs=1e-12)
    by_coordinates_alone = {one.name: one for one in film_results(updated_model(exact, replace(doubted, doubted_forces=())))}
    wide = {one.name: one.error for one in film_results(found)}
    assert wide["bearing.B1.load_vertical"] > 30.0
    assert by_coordinates_alone["bearing.B1.load_vertical"].error < 0.5 * wide["bearing.B1.load_vertical"]


def test_runs_together_leave_open_what_one_does_of_a_force() -> None:
    known = outcome(expected_model(parse_machine(with_force(document(discrepancy=0.0), force_y=-500.0))))
    count = len(known.coordinates)
    answer = np.eye(count)[0] * 1e-5
    own = np.diag(np.full(count, 1e-6))
    doubted = replace(
        known, covariance=own + SIZE**2 * np.outer(answer, answer), doubted_forces=(DoubtedForce(FORCE_Y, SIZE, answer),)
    )
    (force,) = combine([doubted] * 4).doubted_forces
    assert force.name == FORCE_Y
    assert force.size == pytest.approx(SIZE)
    assert force.answer == pytest.approx(answer)
    assert combine([doubted] * 4).covariance[0, 0] == pytest.approx(1e-6 / 4 + (SIZE * answer[0]) ** 2)
    (half,) = combine([doubted, doubted, replace(known, covariance=own), replace(known, covariance=own)]).doubted_forces
    assert half.size == pytest.approx(SIZE / np.sqrt(2.0))


def test_a_run_that_doubts_more_counts_for_more_and_no_correlation_exceeds_one() -> None:
    machine = parse_machine(with_force(document(discrepancy=0.0), force_y=-500.0))
    known = outcome(expected_model(machine))
    count = len(known.coordinates)

    def doubting(size: float, along: float) -> Identification:
        answer = np.eye(count)[0] * along
        covariance = np.diag(np.full(count, 1e-12)) + size**2 * np.outer(answer, answer)
        return replace(known, covariance=covariance, doubted_forces=(DoubtedForce(FORCE_Y, size, answer),))

    together = updated_model(machine, combine([doubting(400.0, 0.7e-5), doubting(100.0, 1.3e-5)]))
    sizes = np.sqrt(np.diag(together.covariance))
    assert np.linalg.eigvalsh(together.covariance / np.outer(sizes, sizes))[0] > -1e-9
