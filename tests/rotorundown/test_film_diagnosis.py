"""Diagnosis of a train on oil films with the library: the same figures as `alignment_changes`, beside a worn bearing too."""

from collections.abc import Mapping

import numpy as np
import pytest

from estimator.alignment.alignment_change import alignment_changes
from estimator.machine.alignment_rules import HealthyVariation
from rotorundown.diagnosis import diagnose
from rotorundown.result import Result
from tests.estimator.alignment.drawn_runs import COORDINATES, MODEL, drawn_machine, drawn_run, fitted, place
from tests.estimator.diagnosis.test_film_reference import effects
from tests.plant import identification

BASELINE = 5


def result(moved: Mapping[str, float], rng: np.random.Generator) -> Result:
    """A run of the machine with some of its coordinates moved."""
    theta = drawn_machine(np.random.default_rng(3))
    for name, by in moved.items():
        theta[place(name)] += by / COORDINATES.unit[place(name)]
    model = fitted(drawn_run(theta, HealthyVariation(), rng), rng)
    fit = identification(
        estimates=(),
        coordinates=model.coordinates,
        point=model.values,
        covariance=model.covariance,
        channel_effects=effects(len(model.coordinates)),
    )
    return Result(MODEL.machine, (), fit, ())


def test_an_offset_beside_a_worn_bearing_is_told_in_micrometres() -> None:
    rng = np.random.default_rng(7)
    baseline = [result({}, rng) for _ in range(BASELINE)]
    sunk = {f"bearing.{bearing}.elevation_y": -120e-6 for bearing in ("B3", "B4")}
    later = [result(sunk | {"bearing.B2.clearance": 0.15}, rng) for _ in range(2)]
    found = diagnose(baseline, later, runs_that_agree=2)
    sizes = {one.kind: size for one, size in zip(found.causes, found.sizes, strict=True)}
    assert set(sizes) == {"misalignment", "wear"}
    told = sizes["misalignment"].quantities
    assert told["offset_vertical_um"] == pytest.approx(-120.0, abs=told["offset_vertical_half_width_um"])
    models = [one.model.updated for one in (*baseline, later[-1])]
    vertical, *_ = alignment_changes(models[:-1], models[-1], causes=[("wear", "bearing.B2")])
    assert told["offset_vertical_um"] == pytest.approx(1e6 * vertical.value, rel=1e-6)
    assert "misalignment at coupling.C1: coupling.C1.offset_vertical -1" in str(found)
