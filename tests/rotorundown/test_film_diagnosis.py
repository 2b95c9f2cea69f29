"""Diagnosis of a train on oil films with the library: the same figures as `alignment_changes`, beside a worn bearing too."""

import re
from collections.abc import Mapping

import numpy as np
import pytest

import rotorundown as rd
from estimator.alignment.alignment_change import alignment_changes
from estimator.alignment.alignment_comparison import AlignmentComparison
from estimator.diagnosis.moving_causes import moving_causes
from estimator.machine.alignment_rules import HealthyVariation
from rotorundown.comparison import NotComparable
from rotorundown.diagnosis import diagnose
from rotorundown.result import Result
from tests.estimator.alignment.drawn_runs import COORDINATES, MODEL, drawn_machine, drawn_run, fitted, place
from tests.estimator.diagnosis.test_film_reference import effects
from tests.paths import ROOT
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


def test_an_offset_beside_a_worn_bearing_is_reported_in_micrometres() -> None:
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
    vertical, *_ = alignment_changes(models[:-1], models[-1], causes=moving_causes([("wear", "bearing.B2")]))
    assert told["offset_vertical_um"] == pytest.approx(1e6 * vertical.value, rel=1e-6)
    assert "misalignment at coupling.C1: coupling.C1.offset_vertical -1" in str(found)
    share = told["bearing.B2.load_per_cent"]
    assert f"({share:+.0f} %)" in str(found), "what the bearings carry is told with the same part"


def test_a_coupling_on_films_is_compared_in_micrometres_with_the_loads() -> None:
    """Real fits of simulated runs; the loads of the bearings beside the coupling change places."""
    machine = rd.read_machine(ROOT / "examples/motor-compressor.yaml")
    before = rd.identify(machine, rd.simulate(machine))
    found = rd.compare(before, rd.simulate(machine, scenario="misalignment", run_seed=2), coupling="C1")
    told = found.found
    assert isinstance(told, AlignmentComparison)
    assert found.verdict.startswith("the alignment of C1 has changed: vertical offset by -")
    assert found.verdict in str(found)
    vertical = {one.name: one for one in told.loads if one.name.endswith("load_vertical")}
    parts = [vertical[f"bearing.{bearing}.load_vertical"].part or 0.0 for bearing in ("B2", "B3")]
    assert parts[0] > 0.05
    assert parts[1] < -0.05
    assert re.search(rf"bearing.B2.load_vertical .* N, [+]{100.0 * parts[0]:.0f} %$", str(found), re.MULTILINE)
    assert "allowed" in str(found)
    with pytest.raises(NotComparable, match="is not of machine 'motor-compressor': it lacks"):
        rd.compare(Result(machine, (), identification(), ()), before.runs[0], coupling="C1")
    same = rd.compare(before, rd.simulate(machine, run_seed=3), coupling="C1")
    assert same.verdict == "no change of the alignment of C1 is certain"
