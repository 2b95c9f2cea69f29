"""The rig of Chapter 5 as the evidence page measures and identifies it."""

import numpy as np
import pytest

from benchmarks.thesis.__main__ import main
from benchmarks.thesis.chapter_5.misalignment import diagnosed, stiffnesses
from benchmarks.thesis.chapter_5.mode_shapes import nodes, plane_modes
from benchmarks.thesis.chapter_5.rig import (
    BOTH_WAYS,
    DENSE,
    PRINTED,
    RESONANCES,
    RUN_UP,
    Rig,
    bounds,
    fitted,
    information_root,
    load,
    regressed,
)
from benchmarks.thesis.chapter_5.simple_supports import PRINTED_HZ, fit_coupling
from estimator.arrays import Floats
from estimator.diagnosis.observation import observation_of
from estimator.diagnosis.run_windows import RunWindows


@pytest.fixture(scope="module")
def rig() -> Rig:
    return load()


def test_far_below_resonance_each_channel_says_one_complex_number(rig: Rig) -> None:
    """X = ω² a: sixteen numbers from eight channels, at eight speeds as at a hundred, and twice that from both senses."""
    for campaign, count in ((PRINTED, 16), (DENSE, 16), (BOTH_WAYS, 32)):
        directions = bounds(rig, campaign).directions
        assert directions[count - 1] < 0.1
        assert np.count_nonzero(directions > 1.0) >= 10
    directions = bounds(rig, PRINTED).directions
    assert directions[16] > 10 * directions[15], "a gap behind the sixteenth"


def test_stiffness_and_unbalance_can_grow_together(rig: Rig) -> None:
    """The printed speeds see a growth of the unbalances, but not one of unbalances and all stiffnesses alike."""
    rows = information_root(rig, PRINTED)
    elements = rig.train(PRINTED).unknowns.coefficients
    growth = [0.0 if one.quantity == "damping" else one.expected / one.scale for one in elements]
    parts = np.stack([rig.unbalances.real, rig.unbalances.imag], axis=1).reshape(-1) / np.abs(rig.unbalances).max()
    unbalance = np.concatenate([np.zeros(len(elements)), parts])
    stiffness = np.concatenate([growth, np.zeros(parts.size)])
    assert np.linalg.norm(rows @ (unbalance + stiffness)) < 0.1 * np.linalg.norm(rows @ unbalance)


def test_eight_speeds_around_two_resonances_determine_what_eight_below_do_not(rig: Rig) -> None:
    stiffness = [k for k, name in enumerate(rig.names) if name.startswith("bearing") and name.endswith(("kxx", "kyy"))]
    assert np.median(bounds(rig, PRINTED).parameters[stiffness]) > 1.0
    assert np.median(bounds(rig, RESONANCES).parameters[stiffness]) < 0.05


def test_the_regression_is_exact_on_its_own_data_and_far_off_with_noise(rig: Rig) -> None:
    parts = np.stack([rig.unbalances.real, rig.unbalances.imag], axis=1).reshape(-1)
    truth = np.concatenate([rig.coefficients, parts])
    assert regressed(rig, PRINTED, seed=None, own_model=True) == pytest.approx(truth, rel=1e-2)
    for seed, own_model in ((0, True), (None, False)):
        found = regressed(rig, PRINTED, seed=seed, own_model=own_model)
        assert np.median(np.abs(found / truth - 1.0)) > 1.0


def test_run_ups_find_misalignment_and_nothing_else(rig: Rig) -> None:
    runs = [fitted(rig, RUN_UP, seed=seed) for seed in range(3)]
    watch = RunWindows.from_baseline(rig.machine, [observation_of(one, rig.machine.channels) for one in runs])

    def said(factors: Floats) -> list[tuple[str, str]]:
        after = [fitted(rig, RUN_UP, seed=seed, factors=factors) for seed in (10, 11)]
        return [(one.kind, one.element) for one in diagnosed(rig, watch, after)]

    assert said(np.ones_like(rig.coefficients)) == []
    beside = [name.rsplit(".", 1)[0] for name in stiffnesses(rig)]
    misaligned = np.array([1.2 if name.rsplit(".", 1)[0] in beside else 1.0 for name in rig.names])
    assert said(misaligned) == [("misalignment", beside[0])]


def test_one_experiment_prints_every_parameter(rig: Rig, capsys: pytest.CaptureFixture[str]) -> None:
    main(["chapter-5", "--speeds", "resonances", "--case", "C1"])
    printed = capsys.readouterr().out
    assert all(f"| {name} |" in printed for name in (*rig.names, "disc.D1.unbalance", "disc.D2.unbalance"))
    assert "χ²/dof" in printed


def test_simple_supports_have_the_printed_frequencies_only_with_the_misprinted_inertia(rig: Rig) -> None:
    """155.7, 239.3 and 419.9 Hz (§5.6) within 1 %, 12 elements per shaft; without a coupling 161 and 331 Hz."""
    right = fit_coupling(rig.document, element_length=0.0265, printed_inertia=False)
    printed = fit_coupling(rig.document, element_length=0.0265, printed_inertia=True)
    assert right.frequencies[1] > 325.0
    assert printed.elements == 12
    assert printed.frequencies == pytest.approx(PRINTED_HZ, rel=0.01)


def test_mode_shapes_of_the_rig_belong_to_its_frequencies(rig: Rig) -> None:
    """Each of the three modes is one rotor's; the second has its node where the other rotor begins, at the coupling."""
    modes = plane_modes(rig)
    assert [mode.frequency / (2 * np.pi) for mode in modes] == pytest.approx([150.0, 204.0, 363.0], rel=0.02)
    largest = [[float(np.max(np.abs(shaft.x))) for shaft in mode.shafts] for mode in modes]
    assert [int(np.argmax(one)) for one in largest] == [1, 0, 0]
    assert all(min(one) < 0.1 * max(one) for one in largest)
    assert nodes(modes[1]) == 1
