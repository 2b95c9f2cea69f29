"""Gaps beside vibration on a plant of other make: what they add, and which of them are left out by name."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.fit.gap_checks import GapVerdict, with_gaps
from estimator.fit.identification import Options
from estimator.fit.identify import identify
from estimator.fit.optimisation.maximum_likelihood import fit
from estimator.fit.optimisation.multistart import chosen_start
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.problem_setup import fit_problem
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import MeasuredGaps, Measurement, joined
from tests.film_plant.documents import film_document, measured, measured_gaps
from tests.film_plant.plant import Plant
from tests.film_plant.plants import motor_compressor_plant

SAMPLES = 80
B2Y = 3
"""Number of that channel."""


class Fitted:
    """A plant whose vibration has been fitted, and gaps that go with it."""

    def __init__(self) -> None:
        self.plant: Plant = motor_compressor_plant(4, "rigid")
        said = film_document(self.plant)
        for probe in said["probes"]:
            probe["gap_grows"] = "away"
        self.machine: Machine = parse_machine(said)
        films = self.plant.films(self.plant.speeds(SAMPLES))
        self.gaps = measured_gaps(films, np.random.default_rng(5))
        self.measurement: Measurement = measured(self.plant, clean=(films.speed, self.plant.phasors(films)))
        self.problem: FitProblem = fit_problem(self.machine, self.measurement, robust=True)
        self.found: FitResult = fit(self.problem, chosen_start(self.problem, np.random.default_rng(0), first=True))

    def judged(self, gaps: MeasuredGaps) -> GapVerdict:
        measurement = replace(self.problem.measurement, gaps=gaps)
        return with_gaps(replace(self.problem, measurement=measurement), self.found)

    def with_channel(self, place: Floats, channel: int = B2Y) -> MeasuredGaps:
        whole = self.gaps.place.copy()
        whole[:, channel] = place
        return replace(self.gaps, place=whole)

    def errors(self, verdict: GapVerdict) -> dict[str, float]:
        problem = verdict.problem
        covariance = np.linalg.inv(verdict.found.information + problem.coordinates.prior.precision)
        error = np.sqrt(np.diag(covariance)) * problem.coordinates.unit
        return dict(zip(problem.coordinates.names, error.tolist(), strict=True))


@pytest.fixture(scope="module")
def fitted() -> Fitted:
    return Fitted()


def only_left_out(verdict: GapVerdict) -> str:
    """The remark on the one channel that is left out; the others are fitted."""
    assert verdict.problem.gaps is not None
    assert sorted(one.channel for one in verdict.problem.gaps.channels) == [0, 1, 2, 4, 5, 6, 7]
    said, whole = verdict.remarks
    assert "with the shaft centreline of 7 channels" in whole
    assert "B2Y" in said
    assert "left out" in said
    return said


def test_gaps_narrow_what_the_vibration_leaves_open_and_the_truth_stays_inside(fitted: Fitted) -> None:
    verdict = fitted.judged(fitted.gaps)
    assert verdict.remarks[0].startswith("with the shaft centreline of 8 channels, χ²/dof ")
    before, after = fitted.errors(GapVerdict(fitted.problem, fitted.found)), fitted.errors(verdict)
    assert all(after[name] <= 1.1 * before[name] for name in before)
    coordinates, truth = fitted.problem.coordinates, fitted.plant.truth(fitted.plant.speeds(2))
    point = dict(zip(coordinates.names, coordinates.point(verdict.found.theta).tolist(), strict=True))
    for number, clearance in enumerate(truth.clearance, start=1):
        name = f"bearing.B{number}.clearance"
        assert after[name] < before[name]
        assert abs(point[name] - np.log(clearance)) < 4.0 * after[name]


def test_a_gap_with_the_wrong_sign_is_named_with_the_right_one(fitted: Fitted) -> None:
    said = only_left_out(fitted.judged(fitted.with_channel(-fitted.gaps.place[:, B2Y])))
    assert "gap_grows is away in the document, is it towards?" in said


@pytest.mark.parametrize(("factor", "words"), [(25.4, "are its unit and sensitivity right?"), (0.0, "direct current")])
def test_a_gap_in_another_unit_or_without_its_mean_is_named(fitted: Fitted, factor: float, words: str) -> None:
    assert words in only_left_out(fitted.judged(fitted.with_channel(factor * fitted.gaps.place[:, B2Y])))


def test_a_gap_that_jumps_with_its_probe_is_named_with_the_speed(fitted: Fitted) -> None:
    place = fitted.gaps.place[:, B2Y].copy()
    place[SAMPLES // 2 :] += 120e-6
    said = only_left_out(fitted.judged(fitted.with_channel(place)))
    rpm = fitted.measurement.speed[SAMPLES // 2] * 30.0 / np.pi
    assert f"jumps by 1{'2' if '12' in said else '1'}" in said
    assert f"at {rpm:.0f} r/min" in said


def test_a_gap_that_goes_its_own_way_is_left_out(fitted: Fitted) -> None:
    wander = 40e-6 * np.sin(np.linspace(0.0, 9.0, SAMPLES))
    said = only_left_out(fitted.judged(fitted.with_channel(fitted.gaps.place[:, B2Y] + wander)))
    assert "as the journals do" in said


def test_gaps_of_which_none_is_believed_leave_the_fit_of_the_vibration_as_it_was(fitted: Fitted) -> None:
    verdict = fitted.judged(replace(fitted.gaps, place=-fitted.gaps.place))
    assert verdict.found is fitted.found
    assert verdict.problem.gaps is None
    assert len(verdict.remarks) == 8


def test_every_run_has_zeros_of_its_own(fitted: Fitted) -> None:
    """Two halves of a run, the second with other zeros: joined as runs they fit, as one run each probe has jumped."""
    half = np.arange(SAMPLES) < SAMPLES // 2
    moved = fitted.gaps.place + np.where(half[:, None], 0.0, 60e-6)
    parts = [
        replace(fitted.measurement.pick(which), gaps=replace(fitted.gaps, place=moved).pick(which)) for which in (half, ~half)
    ]
    gaps = joined(parts).gaps
    assert gaps is not None
    assert gaps.run.tolist() == [0] * (SAMPLES // 2) + [1] * (SAMPLES // 2)
    verdict = fitted.judged(gaps)
    assert verdict.problem.gaps is not None
    assert len(verdict.problem.gaps.channels) == 16
    assert len(fitted.judged(replace(fitted.gaps, place=moved)).remarks) == 8


def test_an_identification_tells_of_its_gaps(fitted: Fitted) -> None:
    found = identify(fitted.machine, replace(fitted.measurement, gaps=fitted.gaps), Options(starts=2))
    assert found.accepted
    assert "with the shaft centreline of 8 channels" in found.verdict
    assert "centreline" not in identify(fitted.machine, fitted.measurement, Options(starts=2)).verdict
