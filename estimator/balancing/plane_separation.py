"""Planes whose weights do nearly the same at all measuring points, and which of them to leave out.

Darlow (The identification and elimination of non-independent balance planes in influence coefficient balancing, ASME paper
82-GT-203, doi:10.1115/82-GT-203) orthogonalises the planes' columns of influence coefficients one after the other, the
longest first; what is left of a column, over its length, is its significance. A plane with little of its own gets large
weights against another's that nearly cancel, and that any error of the coefficients changes at will.
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.balancing.measured_influence import MeasuredInfluence

LEAST_OWN = 0.15
"""Least part of a plane's column that no other plane explains [-]; a plane with less is left out."""
CLEAR_OF_ERROR = 2.0
"""Own part of a column over the rms error of the column [-] that must be seen, where that error is known."""
ALIKE = 0.95
"""Correlation between two columns [-] above which the two planes count as equivalent."""


@dataclass(frozen=True)
class PlaneSeparation:
    """Planes that can be told apart, and those that cannot.

    Attributes:
        planes: Ids of the planes that can be told apart, in the given order.
        left_out: Ids of the others.
        own: Part of each given plane's column [-] that the other planes do not explain (Q,).
        words: A sentence for each plane that is left out, and for those kept that do nearly what others do.
    """

    planes: tuple[str, ...]
    left_out: tuple[str, ...]
    own: Floats
    words: tuple[str, ...]


def separate_planes(influence: MeasuredInfluence, *, weight: Floats | None = None) -> PlaneSeparation:
    """Find the planes that can be told apart at the measuring points (Darlow 1982).

    Source: Darlow, ASME paper 82-GT-203, doi:10.1115/82-GT-203.

    Args:
        influence: Influence coefficients.
        weight: Weight (K,) of each point; None for 1 everywhere [-].

    Returns:
        Planes kept and left out.
    """
    scale = np.ones(len(influence.points)) if weight is None else weight
    matrix = influence.influence * scale[:, None]
    error = np.linalg.norm(np.nan_to_num(influence.coefficient_error()) * scale[:, None], axis=0)
    kept = _chosen(matrix, error)
    own = _own_parts(matrix[:, sorted(kept)])
    alike = [influence.planes[plane] for plane, part in zip(sorted(kept), own, strict=True) if part < LEAST_OWN]
    words = [_words(influence, matrix, error, plane, kept) for plane in range(matrix.shape[1]) if plane not in kept]
    least = f"{100 * float(own.min(initial=1.0)):.0f} %"
    if len(alike) == 1:
        words.append(
            f"{alike[0]} does nearly what other planes together do at the measuring points, only {least} is its own: weights "
            "on it nearly cancel theirs, and are no better known than their intervals say"
        )
    elif alike:
        words.append(
            f"{' and '.join(alike)} do nearly the same at the measuring points, only {least} is their "
            "own: weights on them nearly cancel, and are no better known than their intervals say"
        )
    return PlaneSeparation(
        planes=tuple(plane for number, plane in enumerate(influence.planes) if number in kept),
        left_out=tuple(plane for number, plane in enumerate(influence.planes) if number not in kept),
        own=_own_parts(matrix),
        words=tuple(words),
    )


def _chosen(matrix: Complexes, error: Floats) -> list[int]:
    """Return the numbers of the columns that have enough of their own, the longest first."""
    length = np.linalg.norm(matrix, axis=0)
    kept: list[int] = []
    left = list(range(matrix.shape[1]))
    while left:
        rest = {one: _rest(matrix, one, kept) for one in left}
        best = max(left, key=lambda one: rest[one])
        # Where nothing is known of the errors, the part itself must do.
        least = CLEAR_OF_ERROR * error[best] if error[best] > 0.0 else LEAST_OWN * length[best]
        if rest[best] < least or rest[best] == 0.0:
            break
        kept.append(best)
        left.remove(best)
    return kept


def _rest(matrix: Complexes, column: int, others: list[int]) -> float:
    """Return the length of a column that some others do not explain."""
    if not others:
        return float(np.linalg.norm(matrix[:, column]))
    basis = np.linalg.qr(matrix[:, others])[0]
    return float(np.linalg.norm(matrix[:, column] - basis @ (np.conj(basis).T @ matrix[:, column])))


def _own_parts(matrix: Complexes) -> Floats:
    length = np.linalg.norm(matrix, axis=0)
    every = range(matrix.shape[1])
    rest = np.array([_rest(matrix, one, [other for other in every if other != one]) for one in every])
    return np.asarray(np.divide(rest, length, out=np.zeros_like(rest), where=length > 0.0))


def _words(influence: MeasuredInfluence, matrix: Complexes, error: Floats, plane: int, kept: list[int]) -> str:
    name, length = influence.planes[plane], float(np.linalg.norm(matrix[:, plane]))
    if not kept or length < CLEAR_OF_ERROR * error[plane] or length == 0.0:
        return (
            f"{name} does nothing at the measuring points that could be told from their scatter: trial weights on it are too "
            "small, or runs contradict each other (was a weight or its angle entered wrongly?); it is left out"
        )
    rest = _rest(matrix, plane, kept)
    lengths = np.linalg.norm(matrix[:, kept], axis=0)
    alike = np.abs(np.conj(matrix[:, kept]).T @ matrix[:, plane]) / (lengths * length)
    most = int(np.argmax(alike))
    others = [influence.planes[kept[most]]] if alike[most] >= ALIKE else [influence.planes[one] for one in sorted(kept)]
    together = others[0] if len(others) == 1 else f"{', '.join(others)} together"
    return (
        f"{name} cannot be told apart from {together}: only {100 * rest / length:.0f} % of what it does at the measuring "
        f"points is its own. Weights on both would nearly cancel; {name} is left out. Another speed or measuring point may "
        "tell them apart"
    )
