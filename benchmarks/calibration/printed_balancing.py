"""Printed field-balancing cases of the literature, as `tests/data/field-balancing.json` holds them."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.balancing.criterion import Criterion
from estimator.balancing.influence_correction import correct
from estimator.balancing.measured_influence import MeasuredInfluence, measure_influence
from estimator.balancing.trial_runs import TrialRuns, total_weights

CASES = Path(__file__).resolve().parents[2] / "tests" / "data" / "field-balancing.json"


@dataclass(frozen=True)
class PrintedCase:
    """A printed case: its influence coefficients, and the correction that was published."""

    name: str
    influence: MeasuredInfluence
    criterion: Criterion
    limit: Floats | None
    published: Complexes

    @property
    def correction(self) -> Complexes:
        """Return the correction as computed here."""
        return correct(self.influence, criterion=self.criterion, limit=self.limit).weight

    def objective(self, correction: Complexes) -> float:
        """Return what a correction leaves of what is minimised: rms or largest amplitude."""
        left = np.abs(self.influence.offset + self.influence.influence @ correction)
        return float(np.max(left) if self.criterion == "min-max" else np.sqrt(np.mean(left**2)))


def printed_cases() -> list[PrintedCase]:
    """Return all printed cases, those with trial runs computed from these."""
    return [_case(said) for said in json.loads(CASES.read_text(encoding="utf-8"))["cases"]]


def _case(said: dict[str, Any]) -> PrintedCase:
    limit = said.get("limit")
    return PrintedCase(
        name=said["id"],
        influence=_from_trials(said) if "with_trial" in said else _as_printed(said),
        criterion=said.get("criterion", "least-squares"),
        limit=None if limit is None else np.array(limit, dtype=float),
        published=vectors(said["published_correction"]),
    )


def vectors(printed: list[Any]) -> Complexes:
    """Return vectors of [amplitude, degrees]."""
    values = np.array(printed, dtype=float)
    return np.asarray(values[..., 0] * np.exp(1j * np.radians(values[..., 1])))


def _from_trials(said: dict[str, Any]) -> MeasuredInfluence:
    masses, initial = vectors(said["trial_mass"]), vectors(said["initial"])
    planes = masses.size
    on = total_weights(np.diag(masses), [bool(said.get("trial_kept"))] * planes)
    seen = np.concatenate([initial[None, :], vectors(said["with_trial"]).T])
    return measure_influence(
        TrialRuns(
            names=("initial", *(f"trial {number + 1}" for number in range(planes))),
            planes=tuple(f"P{number + 1}" for number in range(planes)),
            points=tuple(f"point {number + 1}" for number in range(initial.size)),
            vector=seen,
            added=np.concatenate([np.zeros((1, planes)), on]),
            error=np.full(seen.shape, np.nan),
        )
    )


def _as_printed(said: dict[str, Any]) -> MeasuredInfluence:
    influence, initial = vectors(said["influence"]), vectors(said["initial"])
    points, planes = influence.shape
    return MeasuredInfluence(
        planes=tuple(f"P{number + 1}" for number in range(planes)),
        points=tuple(f"point {number + 1}" for number in range(points)),
        influence=influence,
        offset=initial,
        spread=np.zeros((points, planes + 1, planes + 1), dtype=complex),
        scatter=np.zeros((points, points), dtype=complex),
        freedom=float("inf"),
    )
