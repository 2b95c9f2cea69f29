"""Tests what a further measurement would help, against identifications that had it.

The prediction is the Fisher information's: standard errors after adding the sample or probe agree with those that an
identification with it reports (5 %: it is fitted to other noise). Helping one parameter is compared with a brute-force search.
"""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fit.identification import Identification
from estimator.fit.identify import identify
from estimator.identification.experiment_design import helpful_probes, helpful_speeds
from estimator.machine.document import parse_machine
from estimator.phasors.measurement import Measurement, joined
from tests.estimator.trains import Floats, chapter_3, chapter_3_document, dense_response, noisy

NARROW = np.linspace(100.0, 200.0, 60)
CANDIDATES = np.arange(10.0, 450.0, 20.0)


def measured(speed: Floats, seed: int = 1) -> Measurement:
    return Measurement.of(speed=speed, phasor=noisy(dense_response(chapter_3(), speed, direction=1), seed=seed))


@pytest.fixture(scope="module")
def narrow() -> Identification:
    return identify(chapter_3(), measured(NARROW))


def errors(found: Identification) -> Floats:
    return np.sqrt(np.diag(found.covariance))


def test_standard_errors_after_the_best_speeds_are_those_of_an_identification_with_them(narrow: Identification) -> None:
    best = helpful_speeds(chapter_3(), narrow, candidates=CANDIDATES, count=3)
    more = np.array([one.speed for one in best])
    found = identify(chapter_3(), joined([measured(NARROW), measured(more, seed=2)]))
    determined = errors(found) < 0.1 * np.maximum(1.0, np.abs(found.point))
    assert determined.sum() > 30
    assert np.median(errors(found)[determined] / best[-1].standard_error[determined]) == pytest.approx(1.0, abs=0.05)
    assert all(one.shrinkage < 1.0 for one in best)
    assert len(set(more)) == 3


def test_the_first_speed_for_a_parameter_is_the_best_of_all(narrow: Identification) -> None:
    target = "coupling.C1.k_phix"
    place = narrow.coordinates.index(target)
    best = helpful_speeds(chapter_3(), narrow, candidates=CANDIDATES, count=1, targets=[target])[0]
    alone = [helpful_speeds(chapter_3(), narrow, candidates=np.array([speed]), count=1)[0] for speed in CANDIDATES]
    assert best.standard_error[place] == pytest.approx(min(one.standard_error[place] for one in alone), rel=1e-9)
    assert best.shrinkage == pytest.approx(best.standard_error[place] / errors(narrow)[place], rel=1e-6)


def test_a_probe_that_would_help_does(narrow: Identification) -> None:
    best = helpful_probes(chapter_3(), narrow, measured(NARROW), count=1)[0]
    document = chapter_3_document()
    document["probes"].append(best.probe.model_dump(exclude_none=True))
    machine = parse_machine(document)
    phasor = np.concatenate(
        [measured(NARROW).phasor, noisy(dense_response(machine, NARROW, direction=1)[:, -1:], seed=9)], axis=1
    )
    found = identify(machine, Measurement.of(speed=NARROW, phasor=phasor))
    determined = errors(found) < 0.1 * np.maximum(1.0, np.abs(found.point))
    assert np.median(errors(found)[determined] / best.standard_error[determined]) == pytest.approx(1.0, abs=0.05)
    assert "probe on shaft" in best.what


def test_only_speeds_inside_the_documents_range_are_advised(narrow: Identification) -> None:
    document = chapter_3_document()
    document["speed_range"] = {"minimum_rpm": 900, "maximum_rpm": 2000}
    machine = parse_machine(document)
    everywhere = helpful_speeds(chapter_3(), narrow, candidates=CANDIDATES, count=3)
    assert max(one.speed for one in everywhere) > 2000 * np.pi / 30, "which speeds beyond would help"
    within = helpful_speeds(machine, narrow, candidates=CANDIDATES, count=3)
    assert all(900 <= one.speed * 30 / np.pi <= 2000 for one in within)
    with pytest.raises(ValueError, match="no candidate lies in the speed range, 900 to 2000 r/min"):
        helpful_speeds(machine, narrow, candidates=np.array([300.0, 400.0]))


def test_a_target_that_is_none_is_named(narrow: Identification) -> None:
    with pytest.raises(ValueError, match=r"coordinates: bearing\.B9\.kxx"):
        helpful_speeds(chapter_3(), narrow, candidates=CANDIDATES, targets=["bearing.B9.kxx"])


def test_an_identification_of_another_machine_is_refused(narrow: Identification) -> None:
    other = replace(narrow, coordinates=narrow.coordinates[:-1])
    with pytest.raises(ValueError, match="other unknowns"):
        helpful_speeds(chapter_3(), other, candidates=CANDIDATES)
