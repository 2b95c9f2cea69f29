"""Impact tests: the thesis's own (Table 5.6) against the rig's document, and pairing in cases that can be seen through."""

import math
from itertools import permutations
from typing import Literal

import numpy as np
import pytest
import yaml

from estimator.machine.document import parse_machine
from estimator.machine.rules import ImpactTest
from estimator.modes.eigenmodes import natural_frequencies
from estimator.rotor.assembly import assemble_rotor
from estimator.updated_model.impact_comparison import (
    LARGEST_DEVIATION,
    MeasuredFrequency,
    compare_impact_test,
    measured_frequencies,
    share_along_x,
)
from estimator.updated_model.modal_uncertainty import modes_at, natural_frequency_errors
from estimator.updated_model.model import UpdatedModel
from tests.estimator.models import model_of
from tests.estimator.trains import ROOT, chapter_3, one_disc_document


@pytest.fixture(scope="module")
def rig() -> UpdatedModel:
    """The thesis's laboratory rig as documented: stiffnesses chosen so that the impact test is met within 1.5 %."""
    text = (ROOT / "examples" / "thesis-chapter-5-rig.yaml").read_text(encoding="utf-8")
    return model_of(parse_machine(yaml.safe_load(text)), error=0.01)


def anisotropic() -> UpdatedModel:
    """Along y four times as stiff as along x: 100 Hz, where 200 Hz is, both planes apart."""
    stiffness = 0.5 * 5.0 * (2 * math.pi * 100.0) ** 2
    document = one_disc_document(
        length=0.2, diameter=0.2, density=1e-2, kxx=stiffness, kyy=4 * stiffness, cxx=10.0, cyy=10.0, diametral_inertia=1e-3,
        polar_inertia=0.0, element_length=0.1,
    )  # fmt: skip
    return model_of(parse_machine(document), error=0.01)


def test_the_impact_test_of_the_thesis(rig: UpdatedModel) -> None:
    """150, 204 and 363 Hz without misalignment; the rig's modes come in pairs, one in each plane."""
    measured = [MeasuredFrequency(frequency) for frequency in (363.0, 150.0, 204.0)]
    found = compare_impact_test(rig, measured)
    assert [one.measured.frequency for one in found.compared] == [150.0, 204.0, 363.0]
    assert all(abs(one.deviation) < 0.02 for one in found.compared)
    assert found.unmatched == ()
    # Of each pair one is left over, the upper one of the third lies above the highest measured frequency.
    assert len(found.unseen) in (2, 3)
    assert math.sqrt(np.mean([one.deviation**2 for one in found.compared])) < 0.015


def test_an_additional_peak_stays_alone(rig: UpdatedModel) -> None:
    """80 Hz, of the foundation say: no mode of the model within 25 %."""
    frequencies = natural_frequencies(rig.machine) / (2 * math.pi)
    assert np.min(np.abs(np.log(frequencies / 80.0))) > LARGEST_DEVIATION
    without = compare_impact_test(rig, [MeasuredFrequency(one) for one in (150.0, 204.0, 363.0)])
    odd = MeasuredFrequency(80.0)
    found = compare_impact_test(rig, [odd, *(MeasuredFrequency(one) for one in (150.0, 204.0, 363.0))])
    assert found.unmatched == (odd,)
    assert found.compared == without.compared


def test_pairs_are_the_best_of_all() -> None:
    model = model_of(chapter_3())
    modes = natural_frequencies(chapter_3())[:6] / (2 * math.pi)
    measured = np.array([19.0, 21.5, 24.0, 27.5])
    best = min(
        (sum(math.log(modes[j] / f) ** 2 for f, j in zip(measured, picked, strict=True)), picked)
        for picked in permutations(range(6), 4)
    )[1]
    found = compare_impact_test(model, [MeasuredFrequency(float(one)) for one in measured])
    assert [one.model for one in found.compared] == pytest.approx([modes[j] for j in best])
    for one in found.compared:
        assert one.deviation == pytest.approx(one.model / one.measured.frequency - 1)


def test_a_hammer_along_one_axis_shows_modes_of_that_axis() -> None:
    model = anisotropic()
    axes: list[tuple[Literal["x", "y"], float]] = [("x", 100.0), ("y", 200.0)]
    for direction, expected in axes:
        near = MeasuredFrequency(math.sqrt(100.0 * 200.0), direction=direction)
        assert compare_impact_test(model, [near]).compared == ()
        (found,) = compare_impact_test(model, [MeasuredFrequency(0.9 * expected, direction=direction)]).compared
        assert found.model == pytest.approx(expected, rel=1e-3)
    wrong = compare_impact_test(model, [MeasuredFrequency(100.0, direction="y")])
    assert wrong.compared == ()
    assert wrong.unseen == pytest.approx((100.0,), rel=1e-3)


def test_shares_of_modes_in_two_planes() -> None:
    model = anisotropic()
    found = modes_at(model, speed=0.0)
    assert share_along_x(found, assemble_rotor(model.machine).mass)[:2] == pytest.approx([1.0, 0.0], abs=1e-9)


def test_deviation_in_standard_deviations() -> None:
    model = anisotropic()
    error = natural_frequency_errors(model, modes_at(model, speed=0.0), speed=0.0)[0] / (2 * math.pi)
    # 1 % of either bearing's stiffness: half a per cent of the frequency, less as far as the two are independent.
    assert 0.2 < error < 0.55
    (found,) = compare_impact_test(model, [MeasuredFrequency(98.0, standard_deviation=1.0)]).compared
    assert found.model_error == pytest.approx(error)
    assert found.standard_deviations == pytest.approx((found.model - 98.0) / math.hypot(error, 1.0))


def test_nothing_known_of_errors_gives_none() -> None:
    model = model_of(chapter_3(), error=0.0)
    (found,) = compare_impact_test(model, [MeasuredFrequency(20.0)]).compared
    assert found.standard_deviations is None


def test_no_measurement_no_comparison() -> None:
    found = compare_impact_test(model_of(chapter_3()), [])
    assert (found.compared, found.unmatched, found.unseen) == ((), (), ())


def test_impact_test_of_a_document() -> None:
    found = measured_frequencies(ImpactTest(frequencies_hz=(150.0, 204.0), relative_error=0.02))
    assert found == (MeasuredFrequency(150.0, 3.0), MeasuredFrequency(204.0, 4.08))


@pytest.mark.parametrize(("frequency", "error"), [(0.0, None), (-1.0, None), (math.inf, None), (10.0, -1.0)])
def test_wrong_measurements_are_refused(frequency: float, error: float | None) -> None:
    with pytest.raises(ValueError, match="must"):
        MeasuredFrequency(frequency, error)
