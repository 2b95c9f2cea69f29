"""Laws that no machine may break: what the order, the unit or the mirror changes in a document, it changes in the answer."""

import copy

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimator.fit.identify import identify
from estimator.machine.document import parse_machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from tests.estimator.full_train import full_response
from tests.estimator.trains import Floats, chapter_3, chapter_3_document, mirrored, noisy, truth

SPEED: Floats = np.arange(10.0, 300.0, 4.0)
MEASURED = noisy(full_response(chapter_3(), SPEED), seed=0)
PLAIN = identify(chapter_3(), Measurement.of(speed=SPEED, phasor=MEASURED))
few = settings(max_examples=5, deadline=None, derandomize=True)


@few
@given(st.permutations(range(4)), st.permutations(range(4)), st.permutations(range(8)))
def test_order_of_the_parts_changes_no_estimate(bearings: list[int], discs: list[int], probes: list[int]) -> None:
    document = chapter_3_document()
    for name, order in (("bearings", bearings), ("discs", discs), ("probes", probes)):
        document[name] = [document[name][i] for i in order]
    found = identify(parse_machine(document), Measurement.of(speed=SPEED, phasor=MEASURED[:, probes]))
    for one in PLAIN.estimates:
        other = found.estimate(one.name)
        assert other.estimable == one.estimable, one.name
        if one.value is not None and one.standard_error is not None:
            assert other.value == pytest.approx(one.value, abs=1e-3 * one.standard_error), one.name
            assert other.standard_error == pytest.approx(one.standard_error, rel=1e-4), one.name


def test_names_of_bearings_change_only_the_names() -> None:
    document = chapter_3_document()
    for bearing in document["bearings"]:
        bearing["id"] = f"Z{bearing['id']}"
    found = identify(parse_machine(document), Measurement.of(speed=SPEED, phasor=MEASURED))
    assert [one.value for one in found.estimates] == [one.value for one in PLAIN.estimates]


@few
@given(st.floats(1e-3, 1e3), st.floats(-3.0, 3.0), st.sampled_from([1.0, -1.0]))
def test_response_goes_with_the_excitations(size: float, angle: float, direction: float) -> None:
    machine = chapter_3()
    train = condense(machine, speed=SPEED, direction=np.full(SPEED.size, direction))
    coefficients, unbalances = truth(machine)
    factor = size * np.exp(1j * angle)
    plain = response(train, coefficients=coefficients, excitations=unbalances)
    found = response(train, coefficients=coefficients, excitations=factor * unbalances)
    # Turning backwards, an angle on the shaft comes past the probe with the other sign.
    expected = plain * (factor if direction > 0 else np.conj(factor))
    assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()


@few
@given(st.floats(0.01, 100.0))
def test_unit_of_force_cancels(factor: float) -> None:
    document = copy.deepcopy(chapter_3_document())
    for name in ("young_modulus", "density"):
        document["materials"]["steel"][name] *= factor
    for disc in document["discs"]:
        for name in ("mass", "diametral_inertia", "polar_inertia"):
            disc[name] *= factor
        disc["unbalance"]["magnitude"] *= factor
    for part in (*document["bearings"], *document["couplings"]):
        for name in [name for name in part if name[0] in "kc" and isinstance(part[name], float)]:
            part[name] *= factor
    machine = parse_machine(document)
    train = condense(machine, speed=SPEED, direction=np.ones(SPEED.size))
    coefficients, unbalances = truth(machine)
    expected = full_response(chapter_3(), SPEED)
    found = response(train, coefficients=coefficients, excitations=unbalances)
    assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()


def test_mirrored_train_with_a_bow_and_run_out_gives_mirrored_estimates() -> None:
    document = chapter_3_document()
    document["shafts"][0]["bow_spread"] = 1e-3
    document["probes"][0]["run_out_spread"] = 1e-4
    plain = identify(parse_machine(document), Measurement.of(speed=SPEED, phasor=MEASURED))
    other = identify(parse_machine(mirrored(document)), Measurement.of(speed=SPEED, phasor=MEASURED, direction=-1))
    for one in plain.estimates:
        twin = other.estimate(one.name)
        assert one.value is not None
        assert one.standard_error is not None
        sign = -1.0 if one.name.endswith(("xy", "yx")) else 1.0
        assert twin.value == pytest.approx(sign * one.value, abs=1e-3 * one.standard_error), one.name
        if one.imaginary is not None:
            assert twin.imaginary == pytest.approx(-one.imaginary, abs=1e-3 * one.standard_error), one.name
