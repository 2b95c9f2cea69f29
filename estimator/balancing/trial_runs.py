"""Runs of one machine with known unbalances added, as vectors at measuring points, and what is wrong with them.

A measuring point is a channel at a speed. The vibration is V = V0 + A w, with the influence coefficients A and the
unbalances w that were added. For rotation from +x to +y, w is the unbalance; against it, w is its conjugate
(`in_sense_of_rotation`).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.errors import Invalid

SAME = 1e-12
"""Relative difference below which the vectors of two runs are copies of each other [-]."""
COLLINEAR = 1e-6
"""Smallest singular value of the trial weights over the largest one, each plane's scaled to 1, that counts as a rank [-]."""


class TrialsUnusable(Invalid):
    """Raised for trial runs from which no influence coefficients can be computed; the message names the run or plane."""


@dataclass(frozen=True)
class TrialRuns:
    """R runs with known unbalances in Q planes, seen at K measuring points.

    Attributes:
        names: Names of the R runs.
        planes: Ids of the Q planes.
        points: Names of the K measuring points.
        vector: Vibration (R, K), complex 0-to-peak [m]; NaN where a run does not show it.
        added: Unbalances (R, Q) beside those of the machine itself [kg m]; all that was on, whether kept from a trial before
            or put on for this one.
        error: Expected rms of the complex error (R, K) of one vector [m]; NaN where nothing is known of it.
    """

    names: tuple[str, ...]
    planes: tuple[str, ...]
    points: tuple[str, ...]
    vector: Complexes
    added: Complexes
    error: Floats

    def __post_init__(self) -> None:
        runs, points, planes = len(self.names), len(self.points), len(self.planes)
        for name, shape in {"vector": (runs, points), "added": (runs, planes), "error": (runs, points)}.items():
            if getattr(self, name).shape != shape:
                raise TrialsUnusable(f"{name} has shape {getattr(self, name).shape}, should have {shape}")

    def pick(self, runs: Sequence[int]) -> "TrialRuns":
        """Return some of the runs.

        Args:
            runs: Numbers of the runs wanted.

        Returns:
            These runs.
        """
        rows = list(runs)
        names = tuple(self.names[row] for row in rows)
        return TrialRuns(names, self.planes, self.points, self.vector[rows], self.added[rows], self.error[rows])

    def with_planes(self, planes: Sequence[str]) -> "TrialRuns":
        """Return the same runs with some of the planes.

        Args:
            planes: Ids of planes, those without any trial weight may be missing.

        Returns:
            The runs.

        Raises:
            TrialsUnusable: A plane that is left out was loaded in a run.
        """
        loaded = [plane for plane, column in zip(self.planes, self.added.T, strict=True) if np.any(column != 0.0)]
        left_out = [plane for plane in loaded if plane not in planes]
        if left_out:
            raise TrialsUnusable(f"a trial weight was on {', '.join(left_out)}, which is left out of the planes")
        columns = [self.planes.index(plane) for plane in planes]
        return TrialRuns(self.names, tuple(planes), self.points, self.vector, self.added[:, columns], self.error)

    def determined(self) -> tuple["TrialRuns", tuple[str, ...]]:
        """Return the runs at the measuring points whose vectors determine the coefficients of every plane.

        Source: standard result: rank of the matrix of weights.

        Returns:
            The runs, and the names of the points that are left out.

        Raises:
            TrialsUnusable: There is no such point, or what `require_usable` finds.
        """
        require_usable(self)
        shown = np.isfinite(self.vector)
        enough = np.array([_rank(self.added[column]) == len(self.planes) for column in shown.T])
        if not np.any(enough):
            raise TrialsUnusable(
                "no measuring point is shown by the initial run and a trial on every plane: the runs have no speed or channel "
                "in common"
            )
        points = tuple(np.array(self.points)[enough].tolist())
        kept = TrialRuns(self.names, self.planes, points, self.vector[:, enough], self.added, self.error[:, enough])
        return kept, tuple(np.array(self.points)[~enough].tolist())


def in_sense_of_rotation(unbalance: Complexes, direction: float) -> Complexes:
    """Convert unbalances to the weights that act linearly on the vibration, and back.

    Args:
        unbalance: Unbalances (...), angles from +x to +y [kg m].
        direction: Sense of rotation, +1 from +x to +y, else -1 [-].

    Returns:
        The same or their conjugates (...) [kg m].
    """
    return np.asarray(unbalance if direction > 0 else np.conj(unbalance), dtype=complex)


def total_weights(weights: Complexes, kept: Sequence[bool]) -> Complexes:
    """Sum the weights of trials that follow each other, some of which stay on.

    Args:
        weights: Weights (R, Q) put on for each of R trials in their order [kg m].
        kept: Whether each of these trials' weights stays on during the later ones.

    Returns:
        What was on during each trial (R, Q) [kg m].
    """
    staying = np.array(kept, dtype=float)[:, None] * weights
    before = np.cumsum(staying, axis=0) - staying
    return np.asarray(before + weights, dtype=complex)


def require_usable(runs: TrialRuns) -> None:
    """Check that the runs' weights and vectors can determine influence coefficients of every plane.

    Source: standard result: rank of the matrix of weights.

    Args:
        runs: The runs.

    Raises:
        TrialsUnusable: A plane has no trial weight, the weights of planes always go together, the runs are too few, or two
            runs are copies of each other.
    """
    _require_no_copies(runs)
    size = np.max(np.abs(runs.added), axis=0)
    bare = [plane for plane, largest in zip(runs.planes, size, strict=True) if not largest > 0.0]
    if bare:
        raise TrialsUnusable(f"no trial weight was on {', '.join(bare)}: a trial run needs a weight that is not zero")
    rank = _rank(runs.added)
    if rank < len(runs.planes):
        raise TrialsUnusable(_few_trials(runs, rank))


def _rank(added: Complexes) -> int:
    """Return how many combinations of planes the weights (R, Q) of some runs tell apart, beside the vibration without any."""
    if len(added) < 2:
        return 0
    size = np.max(np.abs(added), axis=0)
    scaled = added / np.where(size > 0.0, size, 1.0)
    spread = np.linalg.svd(scaled - scaled.mean(axis=0), compute_uv=False)
    return int(np.count_nonzero(spread > COLLINEAR * max(1.0, float(spread[0]))))


def _few_trials(runs: TrialRuns, rank: int) -> str:
    """Describe why the weights of R runs do not tell Q planes apart."""
    distinct = {tuple(np.round(row / max(1e-300, np.max(np.abs(runs.added))), 9)) for row in runs.added}
    need = len(runs.planes) + 1
    if len(distinct) < need:
        return (
            f"{len(runs.names)} runs with {len(distinct)} different sets of trial weights cannot determine {len(runs.planes)} "
            f"planes: {need} are needed, the initial state and a trial on each of {', '.join(runs.planes)}"
        )
    return (
        f"the trial weights of {', '.join(runs.planes)} always went together in one proportion: they tell only {rank} of "
        f"{len(runs.planes)} planes apart; put a weight on one plane alone"
    )


def _require_no_copies(runs: TrialRuns) -> None:
    for one in range(len(runs.names)):
        for other in range(one):
            if are_copies(runs.vector[one], runs.vector[other]):
                raise TrialsUnusable(
                    f"{runs.names[other]} and {runs.names[one]} hold the same vectors: one is a copy of the other, not a "
                    "run with another trial weight"
                )


def are_copies(one: Complexes, other: Complexes) -> bool:
    """Return whether the vectors of two runs are copies of each other: no two runs measure the same to the last digit.

    Args:
        one: Vectors (K,) of a run, NaN where it shows none [m].
        other: Those of another run (K,) [m].

    Returns:
        Whether they are the same wherever both are shown.
    """
    both = np.isfinite(one) & np.isfinite(other)
    return bool(both.any() and np.max(np.abs(one - other)[both]) <= SAME * np.max(np.abs(one[both])))


def weak_trials(runs: TrialRuns) -> tuple[str, ...]:
    """Name the trial runs that show nothing of their weight beyond the expected error.

    Args:
        runs: The runs, the first one the initial state.

    Returns:
        A sentence for each.
    """
    found = []
    for number in range(1, len(runs.names)):
        change = np.abs(runs.vector[number] - runs.vector[0])
        error = np.sqrt(runs.error[number] ** 2 + runs.error[0] ** 2)
        known = np.isfinite(change) & (error > 0.0)
        loaded = np.any(runs.added[number] != runs.added[0])
        if loaded and known.any() and np.mean((change[known] / error[known]) ** 2) < WEAK:
            found.append(
                f"{runs.names[number]} differs from {runs.names[0]} by no more than the error of the vectors: its trial "
                "weight is too small, or was entered in the wrong unit"
            )
    return tuple(found)


WEAK = 4.0
"""Mean squared change over that of the error [-] below which a trial shows nothing of its weight."""
