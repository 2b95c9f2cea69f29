"""Identification end to end, on responses that ROSS (or the dense model of `trains`) computed.

Noise: real and imaginary part of each phasor have standard deviation 0.01 |X| / √2, which is what the Chapter 3 document
states. Laws: (estimate - truth) / standard error has rms 1 over the 50 real unknowns (0.8 to 1.2 asked, which is ±2 standard
deviations of an rms of 50; none beyond 4), χ²/dof lies within 5 √(2/dof) of 1, and the answer does not depend on where the
document's nominal values lie (0.05 standard errors, the convergence tolerance).
"""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fit.estimates import Estimate
from estimator.fit.fit_samples import NotEnoughData
from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.fit.validation.goodness_of_fit import accepted
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement, joined
from tests.estimator.trains import (
    Complexes,
    Document,
    Floats,
    chapter_3,
    chapter_3_document,
    dense_response,
    mirrored,
    noisy,
    perturbed,
    ross,
    truth,
    without,
)

SPEED: Floats = ross()[0][1::2]
CLEAN: Complexes = ross()[1][1::2]
ONE_START = Options(starts=1)


def with_floor(floor: float) -> Machine:
    """The Chapter 3 train whose noise model has a floor [m]."""
    document = chapter_3_document()
    document["noise"] = {"relative": 0.01, "floor": floor}
    return parse_machine(document)


def measured(seed: int, clean: Complexes = CLEAN, speed: Floats = SPEED, direction: float = 1.0) -> Measurement:
    return Measurement.of(speed=speed, phasor=noisy(clean, seed=seed), direction=direction)


def at(speeds: Floats, *, seed: int = 3, machine: Machine | None = None) -> Measurement:
    """A noisy measurement of the dense model at other speeds."""
    return measured(seed, dense_response(machine or chapter_3(), speeds, direction=1), speeds)


def standardised(found: Identification, machine: Machine | None = None) -> Floats:
    """(estimate - truth) / standard error of every real unknown that is estimable."""
    coefficients, unbalances = truth(machine or chapter_3())
    result: list[float] = []
    for one, value in zip(found.estimates, [*coefficients, *unbalances], strict=True):
        if one.value is None or one.standard_error is None:
            continue
        result.append((one.value - value.real) / one.standard_error)
        if one.imaginary is not None and one.imaginary_standard_error is not None:
            result.append((one.imaginary - value.imag) / one.imaginary_standard_error)
    return np.array(result)


def assert_at_the_bound(found: Identification, unknowns: int = 50) -> None:
    """Accepted, complete, and as far from the truth as the standard errors say."""
    assert found.accepted, found.verdict
    assert abs(found.chi_square / found.degrees_of_freedom - 1) <= 5 * math.sqrt(2 / found.degrees_of_freedom)
    deviation = standardised(found)
    assert deviation.size == unknowns
    assert 0.8 < math.sqrt(np.mean(deviation**2)) < 1.2
    assert np.abs(deviation).max() < 4.0


def assert_same_estimates(found: Identification, expected: Identification, *, within: float) -> None:
    """Equal estimates to a part of the standard error."""
    assert [one.name for one in found.estimates] == [one.name for one in expected.estimates]
    for one, other in zip(found.estimates, expected.estimates, strict=True):
        assert one.value is not None
        assert other.value is not None
        assert other.standard_error is not None
        assert abs(one.value - other.value) < within * other.standard_error, one.name
        assert one.standard_error == pytest.approx(other.standard_error, rel=within)
        if one.imaginary is not None and other.imaginary is not None:
            assert abs(one.imaginary - other.imaginary) < within * other.standard_error, one.name


@pytest.fixture(scope="module")
def reference() -> Identification:
    """The identification from the true nominal values, noise seed 0."""
    return identify(chapter_3(), measured(0))


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_estimates_are_as_good_as_their_standard_errors(seed: int) -> None:
    found = identify(chapter_3(), measured(seed))
    assert_at_the_bound(found)
    assert found.verdict.startswith("accepted: χ²/dof")
    assert found.starts == 1


def test_standard_errors_are_those_that_the_prototype_found(reference: Identification) -> None:
    # An independent prototype: bearing stiffness 0.06-0.3 %, direct bearing damping 0.4-0.5 %, unbalance 0.1-0.3 %.
    for one in reference.estimates:
        assert one.value is not None
        assert one.standard_error is not None
        part = one.standard_error / abs(one.value)
        if one.element.startswith("bearing") and one.name.endswith(("kxx", "kyy")):
            assert 0.0005 < part < 0.0035, one.name
        if one.element.startswith("bearing") and one.name.endswith(("cxx", "cyy")):
            assert 0.003 < part < 0.006, one.name
        if one.name.endswith(("k_phix", "k_phiy")):
            assert 0.05 < part < 0.25, one.name
        if one.quantity == "unbalance" and one.imaginary is not None:
            assert 0.0005 < one.standard_error / math.hypot(one.value, one.imaginary) < 0.004, one.name


def test_noiseless_data_give_the_truth() -> None:
    found = identify(chapter_3(), Measurement.of(speed=SPEED, phasor=CLEAN))
    assert found.accepted
    assert "the stated noise is too large" in found.verdict
    assert np.abs(standardised(found)).max() < 1e-4


@pytest.mark.parametrize("seed", range(4))
def test_wrong_nominal_values_lead_to_the_same_estimates(seed: int, reference: Identification) -> None:
    found = identify(parse_machine(perturbed(chapter_3_document(), seed=seed)), measured(0))
    assert found.accepted
    assert found.starts == 1  # of 600 such documents 580 need no second start
    assert_same_estimates(found, reference, within=0.05)


@pytest.mark.parametrize(
    ("parts", "names"),
    [(("bearings", "couplings"), ("kxy", "kyx", "cxy", "cyx")), (("bearings", "couplings"), ("cxy", "cyx", "cxx", "cyy"))],
    ids=["cross-coupled terms", "damping"],
)
def test_unknown_nominal_values_lead_to_the_same_estimates(
    parts: tuple[str, ...], names: tuple[str, ...], reference: Identification
) -> None:
    found = identify(parse_machine(without(chapter_3_document(), parts, names)), measured(0))
    assert found.accepted
    assert_same_estimates(found, reference, within=0.05)


def test_coupling_of_which_nothing_is_known() -> None:
    found = identify(parse_machine(without(chapter_3_document(), ("couplings",))), measured(0))
    assert found.accepted
    deviation = standardised(found)
    assert deviation.size >= 49
    assert np.abs(deviation).max() < 4.0


def test_channels_that_are_missing_for_part_of_the_run() -> None:
    phasor = noisy(CLEAN, seed=0)
    phasor[:50, 2] = np.nan
    phasor[70:100, 5:8] = np.nan
    phasor[10] = np.nan
    found = identify(with_floor(1e-12), Measurement.of(speed=SPEED, phasor=phasor))
    assert_at_the_bound(found)
    assert found.samples == 149
    assert found.degrees_of_freedom == 2 * np.count_nonzero(np.isfinite(phasor)) - 50


def test_values_marked_unusable_do_not_count(reference: Identification) -> None:
    measurement = measured(0)
    usable = measurement.usable.copy()
    usable[::7, 3] = False
    spoilt = np.where(usable, measurement.phasor, 1.0)  # a metre
    empty = np.where(usable, measurement.phasor, np.nan)
    found, expected = (identify(with_floor(1e-12), replace(measurement, phasor=p, usable=usable)) for p in (spoilt, empty))
    assert found.estimates == expected.estimates
    assert found.degrees_of_freedom < reference.degrees_of_freedom
    assert_at_the_bound(found)


def test_both_senses_of_rotation_together(reference: Identification) -> None:
    backward = measured(9, dense_response(chapter_3(), SPEED, direction=-1), direction=-1)
    found = identify(chapter_3(), joined([measured(0), backward]))
    assert_at_the_bound(found)
    assert found.samples == 300
    for one, other in zip(found.estimates, reference.estimates, strict=True):
        assert one.standard_error is not None
        assert other.standard_error is not None
        assert one.standard_error < 1.02 * other.standard_error, f"more data must not make {one.name} worse"


def test_backward_rotation_alone() -> None:
    backward = measured(9, dense_response(chapter_3(), SPEED, direction=-1), direction=-1)
    assert_at_the_bound(identify(chapter_3(), backward))


def test_mirrored_train_gives_the_mirrored_estimates(reference: Identification) -> None:
    machine = parse_machine(mirrored(chapter_3_document()))
    measurement = measured(0)
    found = identify(machine, replace(measurement, direction=-measurement.direction))
    for one, other in zip(found.estimates, reference.estimates, strict=True):
        sign = -1.0 if one.name.endswith(("xy", "yx")) else 1.0
        assert one.value is not None
        assert other.value is not None
        assert one.value == pytest.approx(sign * other.value, rel=1e-6)
        if one.imaginary is not None and other.imaginary is not None:
            assert one.imaginary == pytest.approx(-other.imaginary, rel=1e-6)


def test_scatter_of_the_source_replaces_the_noise_model() -> None:
    document = chapter_3_document()
    document["noise"] = {"relative": 0.3, "floor": 0.0}
    measurement = measured(1)
    told = replace(measurement, scatter=0.01 * np.abs(CLEAN))
    assert_at_the_bound(identify(parse_machine(document), told))
    untold = identify(parse_machine(document), measurement)
    assert untold.accepted
    assert "the stated noise is too large" in untold.verdict


def test_strong_noise_does_not_bias_the_estimates() -> None:
    # Weights from noisy amplitudes favour what came out small: with 20 % noise the unbalances would be 4 % too small.
    document = chapter_3_document()
    document["noise"] = {"relative": 0.2, "floor": 0.0}
    runs = [Measurement.of(speed=SPEED, phasor=noisy(CLEAN, seed=seed, relative=0.2)) for seed in range(6)]
    found = identify(parse_machine(document), joined(runs), ONE_START)
    assert found.accepted
    ratio = [
        math.hypot(one.value, one.imaginary) / abs(value)
        for one, value in zip(found.estimates[-4:], truth(chapter_3())[1], strict=True)
        if one.value is not None and one.imaginary is not None
    ]
    assert np.mean(ratio) == pytest.approx(1.0, abs=0.01)


def test_noise_stated_too_small_is_not_accepted() -> None:
    document = chapter_3_document()
    document["noise"] = {"relative": 0.005, "floor": 0.0}
    found = identify(parse_machine(document), measured(0), ONE_START)
    assert not found.accepted
    assert found.verdict.startswith("the model does not fit the data: χ²/dof")
    assert found.chi_square / found.degrees_of_freedom == pytest.approx(4.0, rel=0.1)


def assert_withheld(one: Estimate) -> None:
    """No number at all, and a reason."""
    assert not one.estimable
    assert (one.value, one.standard_error, one.lower, one.upper, one.imaginary) == (None,) * 5
    assert one.reason is not None
    assert one.reason.startswith(("the data leave it uncertain by", "the data leave it open far beyond"))


def test_damping_that_cannot_be_seen_is_withheld() -> None:
    document = chapter_3_document()
    document["couplings"][0].update(cxx=1.0, cyy=1.0, cxy=0.0, cyx=0.0)  # a standard error of 100 N s/m at best
    machine = parse_machine(document)
    found = identify(machine, at(SPEED, machine=machine))
    assert found.accepted
    for name in ("cxx", "cxy", "cyx", "cyy"):
        assert_withheld(found.estimate(f"coupling.C1.{name}"))
    assert "of its value" in (found.estimate("coupling.C1.cxx").reason or "")
    assert "of the direct terms of its element" in (found.estimate("coupling.C1.cxy").reason or "")
    deviation = standardised(found, machine)
    assert deviation.size == 46
    assert 0.8 < math.sqrt(np.mean(deviation**2)) < 1.2
    assert np.abs(deviation).max() < 4.0
    assert all(one.reason is None for one in found.estimates if one.estimable)


def test_narrow_speed_range_withholds_most_of_the_coupling_and_none_of_the_bearings() -> None:
    found = identify(chapter_3(), at(np.linspace(200.0, 300.0, 80)))
    assert found.accepted
    withheld = [one for one in found.estimates if not one.estimable]
    assert withheld
    for one in withheld:
        assert_withheld(one)
        assert one.element == "coupling.C1"
    assert np.abs(standardised(found)).max() < 4.0
    wide = identify(chapter_3(), measured(0))
    assert found.condition_number > 10 * wide.condition_number


def test_unbalance_that_hardly_moves_a_probe_is_withheld() -> None:
    # A second disc at a bearing 1e5 times as stiff as the rest: its unbalance pulls at what does not give.
    document = chapter_3_document()
    document["bearings"][0].update(kxx=2.5e10, kyy=2.75e10, kxy=0.0, kyx=0.0)
    document["discs"].append(
        {**document["discs"][0], "id": "D5", "station": 0.0, "mass": 0.01, "diametral_inertia": 0.0, "polar_inertia": 0.0}
    )
    document["probes"] = document["probes"][2:]  # none at that bearing
    machine = parse_machine(document)
    found = identify(machine, at(SPEED, machine=machine), ONE_START)
    hidden = found.estimate("disc.D5.unbalance")
    assert_withheld(hidden)
    assert "kg m, more than the largest unbalance found" in (hidden.reason or "")
    assert found.estimate("disc.D3.unbalance").estimable


def test_too_few_numbers_are_refused() -> None:
    with pytest.raises(NotEnoughData, match="48 measured numbers cannot determine 50 unknowns"):
        identify(chapter_3(), Measurement.of(speed=SPEED[:3], phasor=CLEAN[:3]))
    phasor = CLEAN.copy()
    phasor[:, 1:] = np.nan
    with pytest.raises(NotEnoughData, match="50 measured numbers"):
        identify(chapter_3(), Measurement.of(speed=SPEED[:25], phasor=phasor[:25]))


def test_nothing_usable_is_refused() -> None:
    with pytest.raises(NotEnoughData, match="no sample has a usable channel"):
        identify(chapter_3(), Measurement.of(speed=SPEED, phasor=np.full_like(CLEAN, np.nan)))
    with pytest.raises(NotEnoughData, match="no sample has a usable channel"):
        identify(chapter_3(), Measurement.of(speed=SPEED[:0], phasor=CLEAN[:0]))


@pytest.mark.parametrize("channels", [7, 9])
def test_wrong_number_of_channels_is_refused(channels: int) -> None:
    phasor = np.ones((SPEED.size, channels), dtype=complex)
    with pytest.raises(ValueError, match=f"has {channels} channels, machine 'thesis-chapter-3' has 8"):
        identify(chapter_3(), Measurement.of(speed=SPEED, phasor=phasor))


def test_response_of_zeros_is_refused() -> None:
    with pytest.raises(NotEnoughData, match="every usable phasor is zero"):
        identify(with_floor(1e-9), Measurement.of(speed=SPEED, phasor=np.zeros_like(CLEAN)))


def test_zeros_below_the_floor_are_values_like_any_other() -> None:
    phasor = noisy(CLEAN, seed=0)
    small = np.abs(phasor) < 3e-7
    phasor[small] = 0.0
    assert np.count_nonzero(small) == 8  # all channels at 2 rad/s
    found = identify(with_floor(1e-6), Measurement.of(speed=SPEED, phasor=phasor))
    assert found.accepted
    assert found.degrees_of_freedom == 2 * 150 * 8 - 50
    assert np.abs(standardised(found)).max() < 4.0


@pytest.mark.parametrize("diameter", [0.0202, pytest.param(0.021, marks=pytest.mark.long)])
def test_wrong_model_is_not_accepted_and_says_so(diameter: float) -> None:
    document = chapter_3_document()
    document["shafts"][0]["sections"][0]["outer_diameter"] = diameter
    found = identify(chapter_3(), at(SPEED, machine=parse_machine(document)), Options(starts=2))
    assert not found.accepted
    assert found.starts == 2
    assert found.verdict.startswith(("the model does not fit the data: χ²/dof", "not converged, χ²/dof"))
    assert found.chi_square / found.degrees_of_freedom > 2.0


def test_wrong_sense_of_rotation_is_not_accepted() -> None:
    backward = measured(9, dense_response(chapter_3(), SPEED, direction=-1), direction=1)
    assert not identify(chapter_3(), backward, ONE_START).accepted


def test_same_input_gives_the_same_output() -> None:
    document: Document = chapter_3_document()
    document["shafts"][0]["sections"][0]["outer_diameter"] = 0.0202
    measurement = at(SPEED[::3], machine=parse_machine(document))
    one, other = (identify(chapter_3(), measurement, Options(starts=2, seed=5)) for _ in range(2))
    assert one.starts == 2, "the second start is a random one"
    assert one.estimates == other.estimates
    assert (one.chi_square, one.iterations, one.verdict) == (other.chi_square, other.iterations, other.verdict)
    assert np.array_equal(one.covariance, other.covariance)


def test_input_is_left_alone() -> None:
    measurement = measured(0)
    for array in (measurement.speed, measurement.direction, measurement.phasor, measurement.usable, measurement.scatter):
        array.flags.writeable = False
    copy = measurement.phasor.copy()
    identify(chapter_3(), measurement)
    assert np.array_equal(measurement.phasor, copy)


def test_long_runs_are_thinned(reference: Identification) -> None:
    found = identify(chapter_3(), joined([measured(seed) for seed in range(20, 56)]))
    assert 4900 <= found.samples <= 5000  # of 5400
    assert found.accepted
    assert np.abs(standardised(found)).max() < 4.0
    for one, other in zip(found.estimates, reference.estimates, strict=True):
        assert one.standard_error is not None
        assert other.standard_error is not None
        # The same speeds 33 times over.
        assert one.standard_error == pytest.approx(other.standard_error / math.sqrt(33), rel=0.25)


def test_report_is_complete(reference: Identification) -> None:
    assert len(reference.estimates) == 46
    assert reference.degrees_of_freedom == 2 * 150 * 8 - 50
    assert (reference.samples, reference.speed_minimum, reference.speed_maximum) == (150, 2.0, 300.0)
    assert reference.covariance.shape == (50, 50)
    assert len(reference.coordinates) == 50
    assert reference.coordinates[-2:] == ("disc.D4.unbalance.real", "disc.D4.unbalance.imaginary")
    assert np.array_equal(reference.covariance, reference.covariance.T)
    size = np.sqrt(np.diag(reference.covariance))
    assert np.linalg.eigvalsh(reference.covariance / np.outer(size, size)).min() > 0
    assert reference.condition_number > 1
    units = {one.quantity: one.unit for one in reference.estimates}
    assert units == {"stiffness": "N/m", "damping": "N s/m", "angular stiffness": "N m/rad", "unbalance": "kg m"}
    with pytest.raises(KeyError, match=r"bearing\.B9\.kxx"):
        reference.estimate("bearing.B9.kxx")


def test_intervals_and_covariance_say_the_same(reference: Identification) -> None:
    spread = dict(zip(reference.coordinates, np.sqrt(np.diag(reference.covariance)), strict=True))
    for one in reference.estimates:
        assert one.value is not None
        assert one.standard_error is not None
        assert one.lower is not None
        assert one.upper is not None
        if one.quantity == "unbalance":
            assert one.imaginary is not None
            size = math.hypot(one.value, one.imaginary)
            worst = max(spread[f"{one.name}.real"], spread[f"{one.name}.imaginary"])
            assert one.standard_error == pytest.approx(spread[f"{one.name}.real"], rel=1e-9)
            assert one.imaginary_standard_error == pytest.approx(spread[f"{one.name}.imaginary"], rel=1e-9)
            assert (one.lower, one.upper) == pytest.approx((size - 1.959964 * worst, size + 1.959964 * worst), rel=1e-9)
        elif one.name.split(".")[-1] in ("kxx", "kyy", "cxx", "cyy", "k_phix", "k_phiy"):
            assert one.standard_error == pytest.approx(one.value * spread[one.name], rel=1e-9)
            factor = math.exp(1.959964 * spread[one.name])
            assert (one.lower, one.upper) == pytest.approx((one.value / factor, one.value * factor), rel=1e-9)
        else:
            assert one.standard_error == pytest.approx(spread[one.name], rel=1e-9)
            assert one.upper - one.lower == pytest.approx(2 * 1.959964 * spread[one.name], rel=1e-9)


def test_intervals_hold_the_truth_19_times_of_20() -> None:
    coefficients, unbalances = truth(chapter_3())
    expected = [*coefficients, *np.abs(unbalances)]
    inside = [
        one.lower <= value <= one.upper
        for seed in range(10)
        for one, value in zip(identify(chapter_3(), measured(seed)).estimates, expected, strict=True)
        if one.lower is not None and one.upper is not None
    ]
    # 460 intervals, correlated within a run: 0.95 ± 0.01 for independent ones. An unbalance's interval takes the greater
    # of two errors and so errs on the safe side.
    assert len(inside) == 460
    assert 0.92 < np.mean(inside) < 0.98


@pytest.mark.parametrize(("freedom", "limit"), [(200, 1.5), (5000, 1.1)])
def test_limit_of_acceptance(freedom: int, limit: float) -> None:
    assert accepted(freedom * (limit - 1e-6), freedom)
    assert not accepted(freedom * (limit + 1e-6), freedom)
    assert accepted(0.0, freedom)
    assert not accepted(math.nan, freedom)
