"""Printed field-balancing cases of the literature."""

import json
from typing import Any

import numpy as np

from estimator.arrays import Complexes
from estimator.balancing.measured_influence import MeasuredInfluence, measure_influence
from estimator.balancing.trial_runs import TrialRuns, total_weights
from tests.paths import ROOT

CASES: dict[str, dict[str, Any]] = {
    one["id"]: one for one in json.loads((ROOT / "tests/data/field-balancing.json").read_text(encoding="utf-8"))["cases"]
}


def vectors(printed: Any) -> Complexes:
    """Vectors of [amplitude, degrees]."""
    values = np.array(printed, dtype=float)
    return np.asarray(values[..., 0] * np.exp(1j * np.radians(values[..., 1])))


def names(letter: str, count: int) -> tuple[str, ...]:
    """P1, P2 …"""
    return tuple(f"{letter}{number + 1}" for number in range(count))


def known_influence(influence: Complexes, initial: Complexes) -> MeasuredInfluence:
    """Influence coefficients without errors."""
    points, planes = influence.shape
    none = np.zeros((points, planes + 1, planes + 1), dtype=complex)
    scatter = np.zeros((points, points), dtype=complex)
    return MeasuredInfluence(names("P", planes), names("V", points), influence, initial, none, scatter, float("inf"))


def trial_runs(vector: Complexes, added: Complexes, error: float = np.nan) -> TrialRuns:
    """Runs with names of their own."""
    runs, points = vector.shape
    return TrialRuns(
        names=names("run ", runs),
        planes=names("P", added.shape[1]),
        points=names("V", points),
        vector=np.asarray(vector, dtype=complex),
        added=np.asarray(added, dtype=complex),
        error=np.full(vector.shape, error),
    )


def printed_influence(case: dict[str, Any]) -> MeasuredInfluence:
    """The influence coefficients of a case, from its trial runs where it has some."""
    initial = vectors(case["initial"])
    if "with_trial" not in case:
        return known_influence(vectors(case["influence"]), initial)
    masses = vectors(case["trial_mass"])
    on = total_weights(np.diag(masses), [bool(case.get("trial_kept"))] * masses.size)
    seen = np.concatenate([initial[None], vectors(case["with_trial"]).T])
    return measure_influence(trial_runs(seen, np.concatenate([np.zeros((1, masses.size)), on])))
