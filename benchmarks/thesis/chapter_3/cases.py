"""Chapter 3, §3.4: the cases, with the phasors that are measured in them."""

from dataclasses import replace

import numpy as np

from benchmarks.thesis.flexible.experiments import FlexibleCase, Subject, both_ways, one_way
from estimator.arrays import Complexes
from estimator.rotor.rayleigh import rayleigh_damping
from estimator.thesis.flexible_train import flexible_train
from estimator.thesis.reduced_model import ReducedModel
from estimator.thesis.reduction import eliminated

CASES = (
    one_way("A", [100, 110]),
    one_way("B", [60, 160]),
    one_way("C", np.arange(1.0, 301.0)),
    both_ways("A", [110]),
    both_ways("B", [160]),
    both_ways("C", np.arange(2.0, 301.0, 2.0)),
)
"""§3.4.1-3.4.2; at 0 rad/s nothing moves, so Case C starts at the first speed above it."""

BEST = CASES[-1]
"""Case C of Method II, of which the thesis prints Tables 3.3-3.6, 3.9 and 3.10."""

DAMPING_FREQUENCIES = (122.0, 432.0)
"""Natural frequencies [rad/s] at which a stated shaft damping holds: the lowest and the eighth of the train."""


def damped(subject: Subject, ratio: float) -> Subject:
    """Return the train with its shafts damped by a ratio [-] at two natural frequencies (Appendix B)."""
    if ratio == 0.0:
        return subject
    lower, upper = DAMPING_FREQUENCIES
    damping = rayleigh_damping(lower_frequency=lower, lower_ratio=ratio, upper_frequency=upper, upper_ratio=ratio)
    return replace(subject, train=flexible_train(subject.machine, rayleigh=damping))


def measured(subject: Subject, case: FlexibleCase) -> tuple[ReducedModel, Complexes]:
    """Return the reduced model of a case and its phasors (S, 16) without noise."""
    model = eliminated(subject.train, speed=case.speed, direction=case.direction)
    return model, subject.response(case)[:, subject.train.interface]
