"""Chapter 4, §4.5: the cases, with the phasors and the reduced model of each."""

from typing import Literal

import numpy as np

from benchmarks.thesis.flexible.experiments import FlexibleCase, Subject, both_ways, one_way
from estimator.arrays import Complexes
from estimator.thesis.reduced_model import ReducedModel, reduced_response
from estimator.thesis.reduction import high_frequency_condensed

LOWER, UPPER = np.arange(150.0, 175.1, 0.5), np.arange(275.0, 300.1, 0.5)
"""The frequency bands of Case C [rad/s]."""

CASES = (
    one_way("A", [99, 109, 121, 136]),
    one_way("B", [54, 79, 159, 171]),
    one_way("C_fb3", np.concatenate([LOWER, UPPER])),
    both_ways("A", [121, 136]),
    both_ways("B", [159, 171]),
    both_ways("C_fb3", np.concatenate([LOWER[::2], UPPER[::2]])),
)
"""§4.5.1-4.5.2."""

BANDS = (one_way("C_fb1", LOWER), one_way("C_fb2", UPPER))

RUN_DOWN = one_way("2 to 300 rad/s", np.arange(2.0, 301.0, 2.0))
"""Not one of the thesis's cases: what a run-down gives."""

Data = Literal["own", "full"]

DATA: tuple[Data, Data] = ("own", "full")
"""Phasors from the same reduced model that the regression uses, or from the full model."""


def clean_phasors(subject: Subject, case: FlexibleCase, model: ReducedModel, data: Data) -> Complexes:
    """Return noiseless phasors (S, 8) at the bearings."""
    if data == "own":
        return reduced_response(model, coefficients=subject.coefficients, unbalances=subject.unbalances)
    return subject.response(case)[:, subject.train.bearing]


def high_frequency_model(subject: Subject, case: FlexibleCase) -> ReducedModel:
    """Return the train reduced by the high-frequency condensation in a case."""
    return high_frequency_condensed(subject.train, speed=case.speed, direction=case.direction)
