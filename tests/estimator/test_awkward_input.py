"""Input that is legal but awkward: zeros and gaps under a noise model without floor, parts nearly in one place."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fit.fit_samples import NotEnoughData
from estimator.fit.identify import identify
from estimator.machine.document import DocumentError, Machine, parse_machine
from estimator.modes.critical_speed import critical_speeds
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from tests.estimator.fit.test_identify import CLEAN, SPEED, assert_at_the_bound, measured
from tests.estimator.modes.test_eigenmodes import jeffcott
from tests.estimator.trains import chapter_3, chapter_3_document, dense_response, noisy, one_disc_document


def test_missing_channel_with_a_noise_model_without_floor() -> None:
    phasor = noisy(CLEAN, seed=0)
    phasor[3, 2] = np.nan
    assert_at_the_bound(identify(chapter_3(), Measurement.of(speed=SPEED, phasor=phasor)))


def test_single_usable_zero_with_a_noise_model_without_floor() -> None:
    phasor = noisy(CLEAN, seed=0)
    phasor[5, 3] = 0.0
    identify(chapter_3(), Measurement.of(speed=SPEED, phasor=phasor))


def test_all_zero_with_a_noise_model_without_floor() -> None:
    with pytest.raises(NotEnoughData, match="every usable phasor is zero"):
        identify(chapter_3(), Measurement.of(speed=SPEED, phasor=np.zeros_like(CLEAN)))


def test_scatter_of_zero_with_a_noise_model_without_floor() -> None:
    measurement = measured(0)
    scatter = measurement.scatter.copy()
    scatter[0, 0] = 0.0
    identify(chapter_3(), replace(measurement, scatter=scatter))


def test_critical_speeds_far_below_the_highest() -> None:
    low = critical_speeds(chapter_3(), highest=440.0)
    assert critical_speeds(chapter_3(), highest=6000.0)[:8] == pytest.approx(low, rel=1e-6)


def test_jeffcott_far_below_the_highest() -> None:
    assert critical_speeds(jeffcott(), highest=6000.0)[:2] == pytest.approx([200.0, 200.0], rel=1e-2)


def test_only_the_wrong_field_of_a_lone_part_is_named() -> None:
    document = chapter_3_document()
    document["shafts"][0]["sections"][0]["length"] = -1
    with pytest.raises(DocumentError) as caught:
        parse_machine(document)
    assert [field for field, _ in caught.value.problems] == ["shafts[0].sections[0].length"]


def test_chain_of_near_stations() -> None:
    document = one_disc_document()
    document["probes"] = [{"id": f"P{i}", "shaft": "S", "station": 0.3 + i * 0.9e-9, "angle_deg": 0} for i in range(4)]
    condense(parse_machine(document), speed=np.array([10.0]), direction=np.array([1.0]))


def computed(speed: np.ndarray, machine: Machine | None = None, relative: float = 0.01) -> Measurement:
    """The dense model's response with noise."""
    clean = dense_response(machine or chapter_3(), speed, direction=1)
    return Measurement.of(speed=speed, phasor=noisy(clean, seed=3, relative=relative))


def test_too_few_speeds() -> None:
    with pytest.raises(NotEnoughData, match="48 measured numbers cannot determine 50 unknowns"):
        identify(chapter_3(), computed(np.array([100.0, 150.0, 200.0])))


@pytest.mark.parametrize("same", [True, False], ids=["the very sample", "noisy samples"])
def test_one_sample_repeated(same: bool) -> None:
    at = computed(np.full(150, 130.0))
    phasor = np.tile(at.phasor[0], (150, 1)) if same else at.phasor
    with pytest.raises(NotEnoughData, match=r"16 measured numbers.*samples at one speed repeat each other"):
        identify(chapter_3(), Measurement.of(speed=at.speed, phasor=phasor))


def test_one_channel_determines_next_to_nothing_and_says_so() -> None:
    document = chapter_3_document()
    document["probes"] = document["probes"][:1]
    machine = parse_machine(document)
    found = identify(machine, computed(np.arange(2.0, 300.0, 2.0), machine))
    assert sum(one.estimable for one in found.estimates) < 10
    assert all(one.reason for one in found.estimates if not one.estimable)


def test_all_speeds_in_one_mode_leave_the_coupling_open() -> None:
    found = identify(chapter_3(), computed(np.linspace(118.0, 128.0, 60)))
    open_ones = {one.name: one.reason for one in found.estimates if not one.estimable}
    assert "coupling.C1.cxx" in open_ones
    assert any("crosses no mode that moves coupling C1" in (reason or "") for reason in open_ones.values())


def test_contradictory_nominal_values_do_not_matter() -> None:
    document = chapter_3_document()
    for bearing in document["bearings"]:
        bearing["kxx"] *= 8.0
        bearing["kyy"] /= 8.0
    assert_at_the_bound(identify(parse_machine(document), measured(0)))


@pytest.mark.parametrize("estimated", [False, True])
def test_data_without_noise(estimated: bool) -> None:
    document = chapter_3_document()
    document["noise"] = {"relative": 1e-6, "floor": 0.0, "estimated": estimated}
    found = identify(parse_machine(document), computed(np.arange(2.0, 300.0, 4.0), relative=0.0))
    assert found.accepted
    assert ("no noise to be seen" if estimated else "the stated noise is too large") in found.verdict


def test_noise_of_zero_is_no_noise_model() -> None:
    document = chapter_3_document()
    document["noise"] = {"relative": 0.0, "floor": 0.0}
    with pytest.raises(DocumentError, match=r"noise\.relative"):
        parse_machine(document)


@pytest.mark.parametrize("size", [1e-9, 1e7])
def test_the_size_of_the_response_does_not_matter(size: float) -> None:
    clean = computed(np.arange(2.0, 300.0, 4.0))
    found = identify(chapter_3(), Measurement.of(speed=clean.speed, phasor=size * clean.phasor))
    expected = identify(chapter_3(), clean)
    assert found.accepted
    assert found.chi_square == pytest.approx(expected.chi_square, rel=1e-3)
    one, other = found.estimate("disc.D1.unbalance"), expected.estimate("disc.D1.unbalance")
    assert other.value is not None
    assert one.value == pytest.approx(size * other.value, rel=1e-3)


def test_a_dead_channel_is_named() -> None:
    phasor = noisy(CLEAN[::2], seed=0)
    phasor[:, 3] = 1e-12
    found = identify(chapter_3(), Measurement.of(speed=SPEED[::2], phasor=phasor))
    assert not found.accepted
    assert "most of them of B2Y" in found.verdict


def test_amplitudes_beyond_all_machines_are_an_error() -> None:
    clean = computed(np.arange(2.0, 300.0, 4.0))
    with pytest.raises(ValueError, match="are the units right"):
        identify(chapter_3(), Measurement.of(speed=clean.speed, phasor=1e200 * clean.phasor))


def test_an_eccentricity_that_no_disc_can_have_is_remarked() -> None:
    clean = computed(np.arange(2.0, 300.0, 4.0))
    found = identify(chapter_3(), Measurement.of(speed=clean.speed, phasor=1e3 * clean.phasor))
    assert found.accepted
    assert "mm eccentric: are the amplitudes' units right" in found.verdict
