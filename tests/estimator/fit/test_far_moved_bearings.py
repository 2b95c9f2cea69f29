"""Fits after bearings have moved far: they end where the bearings stand, and not where films make up for that."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from estimator.alignment.alignment_change import alignment_changes
from estimator.fit import identify as identification
from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.machine.document import Machine, parse_machine
from estimator.statics.alignment import alignment_motions, coupling_alignments
from estimator.updated_model.model import updated_model
from tests.estimator.updated_model.test_alignment_results import machine_of
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured
from tests.film_plant.misalignment import ONE_SUPPLY, moved
from tests.film_plant.plant import Plant
from tests.film_plant.plants import random_plant

OFFSET = 140e-6
"""Four times what is allowed [m]."""


@cache
def plant() -> Plant:
    return random_plant(39, design=None, priors=ONE_SUPPLY, discrepancy=DiscrepancySize())


@cache
def machine() -> Machine:
    believed = replace(ONE_SUPPLY, elevation=150e-6, rigid_elevation=150e-6)
    return parse_machine(film_document(plant(), priors=believed))


@cache
def healthy() -> Identification:
    found = identify(machine(), measured(plant(), seed=1))
    assert found.accepted
    return found


def lifted(options: Options | None = None) -> Identification:
    """Identify a run after a shaft has risen, from the machine's last identification on."""
    later = replace(plant(), train=moved(plant().train, offset=np.array([0.0, OFFSET]), angle=np.zeros(2)))
    return identify(machine(), measured(later, seed=2), options, beginning=healthy().point)


@pytest.mark.long
def test_a_shaft_that_has_moved_far_is_found_where_it_stands() -> None:
    found = lifted()
    assert found.accepted, found.verdict
    before, after = updated_model(machine(), healthy()), updated_model(machine(), found)
    changes = {one.name: one for one in alignment_changes([before], after)}
    offset = changes["coupling.C1.offset_vertical"]
    assert offset.value == pytest.approx(OFFSET, abs=3.0 * offset.error)
    assert offset.error < 20e-6


def test_from_the_last_identification_alone_films_would_make_up_for_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def not_moved(_problem: FitProblem, found: FitResult, _beginning: object) -> FitResult:
        return found

    monkeypatch.setattr(identification, "moved_far", not_moved)
    found = lifted(Options(explain=False))
    assert not found.accepted
    assert "deviate" in found.verdict


def test_each_motion_makes_one_offset_or_angle_and_no_other() -> None:
    motions = alignment_motions(machine_of())
    assert list(motions) == ["coupling.C1.offset", "coupling.C1.angle"]
    rows = [row for one in coupling_alignments(machine_of()) for row in (one.offset, one.angle)]
    assert np.array(rows) @ np.array(list(motions.values())).T == pytest.approx(np.eye(2), abs=1e-12)
