"""Offsets whose load follows by a stiffness that is open: by the part of a spring in series, and only of soft couplings."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.alignment.alignment_change import alignment_changes
from estimator.alignment.open_stiffness import OPEN, open_alignments
from estimator.updated_model.model import UpdatedModel, expected_model
from tests.estimator.updated_model.test_alignment_results import NAMES, machine_of
from tests.film_plant.motor_compressor import CouplingKind

STIFFNESSES = ("kxx", "kyy", "k_phix", "k_phiy")


def run(kind: CouplingKind, *, error: float, factor: float = 1.0) -> UpdatedModel:
    """A run that has found the coupling by a factor as stiff, with an error of the logarithm of each stiffness."""
    model = expected_model(machine_of(kind))
    coordinates = model.coordinates_at(np.ones(1))
    values, covariance = model.values.copy(), np.diag((0.1 * coordinates.spread * coordinates.unit) ** 2)
    for term in STIFFNESSES:
        place = model.coordinates.index(f"coupling.C1.{term}")
        values[place] += math.log(factor)
        covariance[place, place] = error**2
    return replace(model, values=values, covariance=covariance)


def test_a_soft_coupling_that_single_runs_leave_open_says_nothing_of_offsets() -> None:
    found = open_alignments([run("flexible", error=0.9), run("flexible", error=0.7), run("flexible", error=0.2)])
    assert {"coupling.C1.offset_vertical", "coupling.C1.offset_horizontal"} <= set(found)
    # The shafts give way by a fiftieth of what the coupling does, so that its load follows by 0.98 of that error.
    reason = "single runs leave the coupling's stiffness open, by which its load follows: ± 68 %"
    assert found["coupling.C1.offset_vertical"] == reason


@pytest.mark.parametrize(("kind", "error"), [("flexible", 0.4), ("rigid", 2.0)])
def test_a_stiffness_that_is_known_or_does_not_count_leaves_no_offset_open(kind: CouplingKind, error: float) -> None:
    assert open_alignments([run(kind, error=error)] * 3) == {}


def test_it_is_the_stiffness_that_runs_have_found_which_counts() -> None:
    soft = [run("rigid", error=2.0 * OPEN, factor=1e-5)] * 3
    assert "coupling.C1.offset_vertical" in open_alignments(soft)
    assert open_alignments([run("flexible", error=2.0 * OPEN, factor=1e6)] * 3) == {}


def test_changes_of_open_offsets_are_left_open_with_the_reason() -> None:
    soft = [run("flexible", error=0.8)] * 3
    told = {one.name: one.undefined for one in alignment_changes(soft[:2], soft[2])}
    assert set(told) == set(NAMES)
    assert told["coupling.C1.offset_vertical"] == open_alignments(soft)["coupling.C1.offset_vertical"]
