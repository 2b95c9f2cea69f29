"""Tests of what §6.5 of the thesis leaves to future work, as the evidence page identifies it."""

import math

import numpy as np
import pytest

from benchmarks.thesis.__main__ import main
from benchmarks.thesis.future_work import report as future_work
from benchmarks.thesis.future_work.report import bearing_errors, identified, internal_damping, simulated, without_feature
from benchmarks.thesis.future_work.trains import FEATURES, INTERNAL_DAMPING


@pytest.mark.parametrize("name", FEATURES)
def test_estimates_scatter_as_the_bound_says(name: str) -> None:
    feature = FEATURES[name]
    simulation = simulated(feature)
    found = identified(feature, simulation.measured(seed=1))
    assert found.accepted, found.verdict
    assert abs(found.chi_square / found.degrees_of_freedom - 1) < 5 * math.sqrt(2 / found.degrees_of_freedom)
    assert found.coordinates == simulation.names
    deviations = (found.point - simulation.truth) / simulation.bound
    assert 0.7 < math.sqrt(np.mean(deviations**2)) < 1.3
    assert np.abs(deviations).max() < 4.5
    # The weight of the phasors and the estimates differ from the truth by a per cent or so.
    assert np.sqrt(np.diag(found.covariance)) == pytest.approx(simulation.bound, rel=0.15)


@pytest.mark.parametrize("name", [name for name in FEATURES if name != "internal-damping"])
def test_a_document_without_the_feature_is_refused(name: str) -> None:
    assert not without_feature(simulated(FEATURES[name]).measured(seed=1)).accepted


def test_internal_damping_left_out_distorts_the_bearings() -> None:
    feature = FEATURES["internal-damping"]
    simulation = simulated(feature)
    measurement = simulation.measured(seed=1)
    _, with_it = bearing_errors(identified(feature, measurement), simulation, feature)
    _, without_it = bearing_errors(without_feature(measurement), simulation, feature)
    assert with_it < 4.0
    assert without_it > 6.0


def test_internal_damping_is_found_from_the_profile() -> None:
    simulation = simulated(FEATURES["internal-damping"])
    found = [internal_damping(simulation.measured(seed=seed)) for seed in range(3)]
    for estimate, error in found:
        assert error == pytest.approx(simulation.internal_damping_bound, rel=0.15)
        assert abs(estimate - INTERNAL_DAMPING) < 4 * error
        assert error < INTERNAL_DAMPING / 10


def test_one_feature_from_the_command_line(capsys: pytest.CaptureFixture[str]) -> None:
    main(["future-work", "--feature", "seals", "--seed", "3"])
    printed = capsys.readouterr().out
    assert printed.startswith("### Seals\n")
    assert len([line for line in printed.splitlines() if line.startswith("| seal.N1.")]) == 10


def test_the_section_has_every_feature(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(future_work, "part", lambda name, **_: f"### {FEATURES[name].title}")
    monkeypatch.setattr(future_work, "SEEDS", range(1))
    text = future_work.section()
    assert text.startswith("## §6.5: what the thesis leaves to future work\n\n")
    assert text.count("\n### ") == len(FEATURES)
    assert text.count("| 1 of 1 |") == len(FEATURES)
