"""Several runs as one: averages whose errors cover the scatter between runs."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fit.identification import Identification
from estimator.fit.identify import identify
from estimator.identification.pooling import combine
from estimator.machine.document import parse_machine
from estimator.phasors.measurement import Measurement
from estimator.simulation.simulated_plant import draw_truth, measured_phasors, truth_of_run
from tests.estimator.trains import chapter_3, chapter_3_document, dense_response, noisy

SPEED = np.linspace(10.0, 300.0, 100)


def runs(count: int) -> tuple[list[Identification], dict[str, float]]:
    """Identifications of runs whose true parameters scatter, and what they scatter about."""
    rng = np.random.default_rng(3)
    drawn = draw_truth(chapter_3(), rng)
    found = [
        identify(
            chapter_3(),
            Measurement.of(speed=SPEED, phasor=measured_phasors(chapter_3(), truth_of_run(drawn, rng), SPEED, rng)),
        )
        for _ in range(count)
    ]
    names = [c.name for c in drawn.unknowns.coefficients]
    return found, dict(zip(names, drawn.coefficients.tolist(), strict=True))


def test_average_of_scattered_runs_is_accepted_and_covers_the_truth() -> None:
    results, truth = runs(4)
    together = combine(results)
    assert together.accepted
    assert together.samples == 400
    inside = [
        one.lower <= truth[one.name] <= one.upper
        for one in together.estimates
        if one.name in truth and one.lower is not None and one.upper is not None
    ]
    assert np.mean(inside) > 0.88
    own = results[0].estimate("bearing.B1.kxx").standard_error or math.nan
    wider = together.estimate("bearing.B1.kxx").standard_error or math.nan
    assert wider > 0.6 * own  # a mean of four without scatter would have half the error


def test_what_one_run_does_not_determine_is_not_estimable() -> None:
    results, _ = runs(2)
    weak = results[1].estimates
    lost = tuple(
        type(one)(one.name, one.element, one.quantity, one.unit, None, None, None, None, reason="narrow") if i == 0 else one
        for i, one in enumerate(weak)
    )
    together = combine([results[0], replace(results[1], estimates=lost)])
    assert together.estimates[0].value is None
    assert together.estimates[0].reason == "not every run determines it"
    assert together.estimates[1].value is not None


def test_one_run_is_nothing_to_combine() -> None:
    results, _ = runs(1)
    with pytest.raises(ValueError, match="at least two"):
        combine(results)


def test_fixed_and_tied_parameters_stay_what_they_are() -> None:
    document = chapter_3_document()
    document["parameters"] = [
        {"names": "coupling.C1.k_phi*", "fixed": True},
        {"names": "bearing.B2.cxx", "tied_to": "bearing.B1"},
    ]
    machine = parse_machine(document)
    phasors = [noisy(dense_response(machine, SPEED, direction=1), seed=seed) for seed in (1, 2)]
    together = combine([identify(machine, Measurement.of(speed=SPEED, phasor=one)) for one in phasors])
    assert "kept at its nominal value" in (together.estimate("coupling.C1.k_phix").reason or "")
    assert together.estimate("bearing.B2.cxx").reason == "tied to bearing.B1.cxx"
    assert together.estimate("bearing.B1.cxx").value is not None
