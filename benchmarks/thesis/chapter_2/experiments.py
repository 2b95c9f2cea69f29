"""The numerical experiments of Chapter 2: cases, noise, regression, maximum likelihood and bounds, for its tables."""

import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.fit.identification import Identification
from estimator.fit.identify import identify_train
from estimator.machine.rules import Noise
from estimator.phasors.measurement import Measurement, joined
from estimator.rotor.condensation import CondensedTrain
from estimator.rotor.response import response, sensitivity
from estimator.thesis.noise import Sharing, multiplicative_noise
from estimator.thesis.parameter_rules import RegularisationRule
from estimator.thesis.regression import RegressionMethod, Scaling, Solution, solve
from estimator.thesis.rigid_regression import rigid_regression
from estimator.thesis.rigid_train import RigidTrain, condensed, printed_train

NOISE = (1.0, 2.0, 5.0)
"""Noise levels of the thesis's tables [%]."""
SEEDS = 20
START_SPAN = 0.5
"""Maximum likelihood starts from coefficients that are off by a factor uniform between 1 - and 1 + this."""
SINGULAR = 1e-9
"""A direction whose singular value is below this part of the largest one is not determined."""


@dataclass(frozen=True, eq=False)
class RigidCase:
    """Speeds (S,) [rad/s] and senses of rotation (S,) of one of the thesis's cases."""

    method: str
    name: str
    speed: Floats
    direction: Floats

    @property
    def title(self) -> str:
        """Return the case's name in the tables."""
        return f"{self.method}, {self.name}"


def _case(method: str, name: str, speed: list[int] | range) -> RigidCase:
    once = np.array(speed, dtype=float)
    if method == "I":
        return RigidCase(method, name, once, np.ones(once.size))
    return RigidCase(method, name, np.tile(once, 2), np.repeat([1.0, -1.0], once.size))


CASES = (
    _case("I", "A", [150, 170, 200, 220]),
    _case("I", "B", [100, 185, 240, 330]),
    _case("I", "C", range(10, 2001, 10)),
    _case("II", "A", [150, 170]),
    _case("II", "B", [100, 240]),
    _case("II", "C", range(20, 2001, 20)),
)


@dataclass(frozen=True)
class Experiment:
    """A rigid train in one case, with its noise-free response (S, 8) [m]."""

    rigid: RigidTrain
    train: CondensedTrain
    clean: Complexes

    def noisy(self, percent: float, seed: int, sharing: Sharing = "none") -> Complexes:
        """Return the response with the thesis's noise."""
        return multiplicative_noise(self.clean, percent=percent, rng=np.random.default_rng(seed), sharing=sharing)

    def error(self, values: Floats) -> Floats:
        """Return the relative error (50,) of estimates."""
        return np.asarray(np.abs(values / self.rigid.values - 1.0))


@cache
def case(method: str, name: str) -> RigidCase:
    """Return the case of that name. Raises StopIteration for one that the thesis does not have."""
    return next(one for one in CASES if (one.method, one.name) == (method, name))


def experiment(which: RigidCase, rigid: RigidTrain | None = None) -> Experiment:
    """Return a case with the printed train, or another."""
    rigid = printed_train() if rigid is None else rigid
    train = condensed(rigid, speed=which.speed, direction=which.direction)
    return Experiment(rigid, train, response(train, coefficients=rigid.coefficients, excitations=rigid.unbalances))


def regression(
    subject: Experiment,
    phasor: Complexes,
    *,
    scaling: Scaling = "norm",
    method: RegressionMethod = "orthogonal",
    tikhonov: RegularisationRule | None = None,
    expected: Floats | None = None,
) -> Solution:
    """Return the thesis's regression of phasors (S, 8)."""
    return solve(rigid_regression(subject.train, phasor), scaling=scaling, method=method, tikhonov=tikhonov, expected=expected)


def regression_errors(subject: Experiment, percent: float, *, seeds: int = SEEDS, sharing: Sharing = "none") -> Floats:
    """Return the relative errors (seeds, 50) of the regression with the thesis's noise."""
    return np.array(
        [subject.error(regression(subject, subject.noisy(percent, seed, sharing)).values) for seed in range(seeds)]
    )


def likelihood(subject: Experiment, phasor: Complexes, *, rms: float, seed: int) -> Identification:
    """Fit phasors (S, 8) by maximum likelihood, from coefficients that are off by up to ± 50 %.

    rms: relative error of the phasors, taken as circular and Gaussian, which the thesis's noise is not.
    """
    factor = 1.0 + np.random.default_rng(7000 + seed).uniform(-START_SPAN, START_SPAN, subject.rigid.coefficients.size)
    wrong = replace(subject.rigid, coefficients=subject.rigid.coefficients * factor)
    speed, direction = subject.train.speed, subject.train.direction
    parts = [
        Measurement.of(speed=speed[way], phasor=phasor[way], direction=sense)
        for sense in (1.0, -1.0)
        if (way := direction == sense).any()
    ]
    train = condensed(wrong, speed=speed, direction=direction)
    return identify_train(train, joined(parts), noise=Noise(relative=rms, floor=0.0))


def likelihood_values(outcome: Identification) -> Floats:
    """Return estimates (50,) in the order of Table 2.1, NaN where the fit says that the data do not determine a parameter."""
    values: list[float] = []
    for one in outcome.estimates:
        values.append(math.nan if one.value is None else one.value)
        if one.quantity == "unbalance":
            values.append(math.nan if one.imaginary is None else one.imaginary)
    return np.array(values)


def bound(subject: Experiment, *, rms: float) -> Floats:
    """Return the Cramér-Rao bound (50,), relative, for circular complex noise of that rms."""
    radial, tangential = _relative_slopes(subject)
    return _standard_errors(np.concatenate([radial, tangential]) / (rms / math.sqrt(2.0)))


def exact_phase_bound(subject: Experiment, *, rms: float) -> tuple[Floats, int]:
    """Return the bound (50,) for real noise that leaves every phase exact, and how many combinations the phases fix.

    Exact phases are constraints; within what they leave open, the amplitudes' noise counts.
    """
    radial, tangential = _relative_slopes(subject)
    size = np.linalg.norm(tangential, axis=0) + np.linalg.norm(radial, axis=0)
    _, values, right = np.linalg.svd(tangential / size, full_matrices=True)
    rank = int(np.count_nonzero(values > SINGULAR * values[0]))
    free = right[rank:].T
    if free.shape[1] == 0:
        return np.zeros(size.size), rank
    information = (radial / size) @ free / rms
    _, singular_values, across = np.linalg.svd(information, full_matrices=False)
    errors = free @ (across.T / singular_values)
    return np.linalg.norm(errors, axis=1) / size, rank


def in_phase(rigid: RigidTrain) -> RigidTrain:
    """Return the train with the unbalances that Table 2.7 assumes: all at 36°."""
    return replace(rigid, unbalances=np.array([9.4e-3, 5.6e-3, 7.8e-3, 11.1e-3]) * np.exp(1j * np.deg2rad(36.0)))


def _relative_slopes(subject: Experiment) -> tuple[Floats, Floats]:
    """Return the derivatives (8 S, 50) of ln|q| and of the phase of q, by the relative change of each unknown."""
    found = sensitivity(subject.train, coefficients=subject.rigid.coefficients, excitations=subject.rigid.unbalances)
    phasor, slope = found.phasor, found.by_parameter
    relative = (slope / phasor[..., None]).reshape(-1, slope.shape[-1]) * subject.rigid.values
    return np.ascontiguousarray(relative.real), np.ascontiguousarray(relative.imag)


def _standard_errors(weighted: Floats) -> Floats:
    size = np.linalg.norm(weighted, axis=0)
    _, values, right = np.linalg.svd(weighted / size, full_matrices=False)
    return np.asarray(np.sqrt(np.sum((right / values[:, None]) ** 2, axis=0)) / size)
