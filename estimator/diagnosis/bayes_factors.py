"""Diagnosis of a machine since its baseline: the hypotheses that explain its newest runs best, and the runners-up.

The runs of the baseline are observations of one machine that varies from run to run, those of the window of newest runs of one
that may besides have varied with the season (`healthy_variation`), and changed. Each hypothesis adds changes of an expected
size; its evidence is the logarithm of the factor by which the window is more probable with it than without (Kass and Raftery,
J. Am. Stat. Assoc. 90 (1995) 773, doi:10.1080/01621459.1995.10476572), in closed form, as everything is Gaussian. The
strongest is taken first; more is added as long as the evidence for it is strong, so that an unbalance and a misalignment are
both named. Where beginning with another of the strongest leads to causes that are far more probable together, those are taken.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy.special

from estimator.arrays import Floats
from estimator.diagnosis.baseline_reference import Reference, symmetric
from estimator.diagnosis.finding_kind import Cause
from estimator.diagnosis.finding_kinds import finding_kind
from estimator.diagnosis.hypotheses import Hypothesis
from estimator.diagnosis.observation import Observation
from estimator.symmetric_eigen import symmetric_eigen

STRONG = 4.0
"""Evidence from which on a cause is reported [-]: a factor of 55, in runs that each speak for it."""
FURTHER_CAUSE_PART = 0.05
"""Part of the strongest cause's evidence that a further cause needs as well [-]: a large cause is never explained quite
exactly.
"""
LARGEST_FURTHER_EVIDENCE = 6.0
"""Most evidence that a cause which enters the response linearly asks of a further one [-]: however large it is, a cause that
stands for months must not hide a misalignment.
"""
GAIN_SQUARED_PART = 3.0
"""Part of the evidence of a gain's change that a further cause needs besides, per square of that change [-]: a fit has taken
the gain in, and its effects hold to first order only.
"""
DOUBTFUL = 3.0
"""Evidence by which a cause such as a misalignment must be ahead of any fault of a measuring chain [-]: a factor of 20, so
that of the two it is the right one with a probability of 0.95.
"""
MAXIMUM_CAUSES = 4
"""Most causes at once that are told apart."""
BEGINNINGS = 4
"""Number of single causes, the strongest, from each of which causes are chosen."""
LARGEST_STEPS = 10
"""Most steps in which causes are added and taken back."""
RUNNERS_UP = 3
"""Number of runners-up that are named."""


@dataclass(frozen=True)
class Diagnosis:
    """Causes of the changes in a window of runs.

    Attributes:
        causes: The causes, the strongest first.
        runners_up: Per cause the other causes that would explain it, the best first.
        evidence: Evidence [-] by kind and element of everything that was considered, beside the other causes.
    """

    causes: tuple[Cause, ...]
    runners_up: tuple[tuple[Cause, ...], ...]
    evidence: dict[tuple[str, str], float] = field(default_factory=dict)


def diagnose(baseline: Reference, window: Sequence[Observation]) -> Diagnosis:
    """Diagnose what has happened between the baseline and some runs, all of them after it (Kass and Raftery 1995).

    Args:
        baseline: The baseline.
        window: Observations of the runs.

    Returns:
        The diagnosis.

    Raises:
        ValueError: There is no run, or one of other quantities.
    """
    if not window or any(one.names != baseline.names for one in window):
        raise ValueError("the identifications are not of the baseline's quantities")
    deviation = Deviation.of(baseline, window)
    chosen = _chosen(deviation)
    causes = []
    for one in chosen:
        beside = deviation.allowing_for([other for other in chosen if other is not one])
        rest = sorted((o for o in baseline.hypotheses if o not in chosen), key=beside.evidence, reverse=True)
        runners_up = tuple(beside.cause(o) for o in rest[:RUNNERS_UP] if beside.evidence(o) > 0.0)
        causes.append((beside.cause(one), runners_up))
    causes.sort(key=lambda pair: -pair[0].evidence)
    left = deviation.allowing_for(chosen)
    evidence: dict[tuple[str, str], float] = {(one.kind, one.element): left.evidence(one) for one in baseline.hypotheses}
    evidence |= {(cause.kind, cause.element): cause.evidence for cause, _ in causes}
    told = [pair for cause, others in causes if (pair := _chain_first(cause, others))[0].evidence >= STRONG]
    return Diagnosis(tuple(cause for cause, _ in told), tuple(others for _, others in told), evidence)


def _chain_first(cause: Cause, runners_up: tuple[Cause, ...]) -> tuple[Cause, tuple[Cause, ...]]:
    """Return a cause with its runners-up; a fault of a measuring chain in place of one that must be ahead of it and is not.

    A probe is looked at sooner than a coupling is opened, and the misalignment is the first of the runners-up.
    """
    if not finding_kind(cause.kind).ahead_of_chains:
        return cause, runners_up
    chains = [one for one in runners_up if finding_kind(one.kind).place == "channels"]
    best = max(chains, key=lambda one: one.evidence, default=None)
    if best is None or best.evidence <= cause.evidence - DOUBTFUL:
        return cause, runners_up
    return best, (cause, *(one for one in runners_up if one is not best))


def _chosen(deviation: "Deviation") -> list[Hypothesis]:
    """Choose the hypotheses that explain a deviation, from the strongest one on or from another where that is far better.

    A cause with many freedoms, such as all deviations of a film, may explain most of two others at once and hide them: so do
    those of the bearing that is worn beside a coupling that has moved. Each of the strongest is a beginning.
    """
    beginnings = sorted(deviation.baseline.hypotheses, key=deviation.evidence, reverse=True)[:BEGINNINGS]
    strong = [one for one in beginnings if deviation.evidence(one) >= STRONG]
    if not strong:
        return []
    chosen = _chosen_from(deviation, strong[0])
    together = _evidence_together(deviation, chosen)
    for one in strong[1:]:
        others = [] if one in chosen else _chosen_from(deviation, one)
        found = _evidence_together(deviation, others)
        asked = max(STRONG, FURTHER_CAUSE_PART * together) * max(1, len(others) - len(chosen))
        if found - together > asked:
            chosen, together = others, found
    return chosen


def _evidence_together(deviation: "Deviation", causes: Sequence[Hypothesis]) -> float:
    """Return the evidence of several causes together: that of each beside those before it (chain rule)."""
    return sum(deviation.allowing_for(causes[:place]).evidence(one) for place, one in enumerate(causes))


def _chosen_from(deviation: "Deviation", first: Hypothesis) -> list[Hypothesis]:
    """Choose hypotheses from one on: one after another, as long as the evidence for the next is strong."""
    chosen = [first]
    least = max(STRONG, _required_evidence(deviation, first))
    for _ in range(LARGEST_STEPS - 1):
        within = deviation.allowing_for(chosen)
        left = [one for one in deviation.baseline.hypotheses if one not in chosen and not _is_subset(one, chosen)]
        if not left or len(chosen) == MAXIMUM_CAUSES:
            break
        best = max(left, key=within.evidence)
        if within.evidence(best) < least:
            break
        # A whole takes the place of its parts.
        chosen = [*(one for one in chosen if not _is_subset(one, [best])), best]
        least = max([STRONG, *(_required_evidence(deviation, one) for one in chosen)])
        # What a new cause explains better is taken back.
        needed = [one for one in chosen if deviation.allowing_for([o for o in chosen if o is not one]).evidence(one) >= STRONG]
        if len(needed) < len(chosen) and best not in needed:
            break
        chosen = needed
    return chosen


def _required_evidence(deviation: "Deviation", one: Hypothesis) -> float:
    """Return the evidence that a further cause needs beside one, apart from what any needs."""
    if one.fitted:
        return 0.0
    part, evidence = FURTHER_CAUSE_PART, deviation.evidence(one)
    if "gain" in finding_kind(one.kind).errors:
        change = deviation.cause(one).change
        part += GAIN_SQUARED_PART * float(change @ change)
    return min(part * evidence, LARGEST_FURTHER_EVIDENCE if one.linear else math.inf)


def _is_subset(one: Hypothesis, of: Sequence[Hypothesis]) -> bool:
    """Check whether a cause moves nothing but what another one moves as well, such as a bearing beside a misaligned
    coupling."""
    return bool(one.elements) and any(one.elements < other.elements for other in of)


@dataclass(frozen=True)
class Deviation:
    """Deviation of the runs of a window from the baseline, in units of the run-to-run variation.

    Attributes:
        baseline: The baseline.
        precision: Precision (N, N) of the likelihood of a change [-].
        pull: Pull (N,) of the likelihood of a change [-].
        runs: Of each run by itself the precision (N, N) of the quantities around which it varies and its pull (N,) away from
            the baseline's mean [-].
    """

    baseline: Reference
    precision: Floats
    pull: Floats
    runs: tuple[tuple[Floats, Floats], ...]
    _evidence: dict[int, tuple[float, ...]] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, baseline: Reference, window: Sequence[Observation]) -> "Deviation":
        """Compute the deviation of some observations from the baseline.

        Source: standard result: score and information of Gaussian likelihoods, what varies marginalised.

        Args:
            baseline: The baseline.
            window: The observations.

        Returns:
            The deviation.
        """
        runs = [baseline.likelihood(one) for one in window]
        precision = np.sum([seen for seen, _ in runs], axis=0)
        pull = np.sum([drawn for _, drawn in runs], axis=0)
        kept = np.linalg.inv(np.eye(len(pull)) + precision @ baseline.doubt)
        alone = tuple(baseline.alone(one) for one in window)
        return cls(baseline, symmetric(kept @ precision), kept @ pull, alone)

    def allowing_for(self, causes: Sequence[Hypothesis]) -> "Deviation":
        """Return the deviation with some causes allowed for.

        Source: standard result: score and information of Gaussian likelihoods, what varies marginalised.

        Args:
            causes: The causes.

        Returns:
            The deviation that is left.
        """
        if not causes:
            return self
        columns = np.concatenate([self._best(one) for one in causes], axis=1) / self.baseline.unit[:, None]
        spread = np.linalg.inv(np.eye(columns.shape[1]) + columns.T @ self.precision @ columns)
        gain = self.precision @ columns @ spread
        precision = symmetric(self.precision - gain @ columns.T @ self.precision)
        pull = self.pull - gain @ (columns.T @ self.pull)
        explained = columns @ (spread @ (columns.T @ self.pull))
        runs = tuple((seen, drawn - seen @ explained) for seen, drawn in self.runs)
        return Deviation(self.baseline, precision, pull, runs)

    def evidence(self, one: Hypothesis) -> float:
        """Compute the logarithm of the factor by which a hypothesis makes the window more probable.

        All of its variants are equally probable before.

        Source: Kass and Raftery, J. Am. Stat. Assoc. 90 (1995) 773, doi:10.1080/01621459.1995.10476572.

        Args:
            one: The hypothesis.

        Returns:
            Evidence [-].
        """
        found = self._by_variant(one)
        return float(np.logaddexp.reduce(found) - np.log(len(found)))

    def cause(self, one: Hypothesis) -> Cause:
        """Return the hypothesis with the changes that it has most probably made.

        Source: standard result: mean and covariance of a Gaussian posterior.

        Args:
            one: The hypothesis.

        Returns:
            The cause.
        """
        columns = self._best(one)
        mean, spread = self._posterior(columns)
        change = columns @ mean
        white = change / self.baseline.unit
        moved = np.flatnonzero(np.any(columns != 0.0, axis=1))
        return Cause(
            kind=one.kind,
            element=one.element,
            evidence=self.evidence(one),
            names=tuple(self.baseline.names[place] for place in moved),
            change=change[moved],
            covariance=columns[moved] @ spread @ columns[moved].T,
            distance=math.sqrt(max(0.0, float(mean @ self._projected_pull(columns)))),
            agreement=tuple(float(white @ drawn - 0.5 * white @ seen @ white) for seen, drawn in self.runs),
        )

    def _projected_pull(self, columns: Floats) -> Floats:
        return np.asarray((columns / self.baseline.unit[:, None]).T @ self.pull)

    def _projected_precision(self, columns: Floats) -> Floats:
        """Return the precision (r, r) of the sizes of r changes, with what is believed of them: no eigenvalue is below one."""
        white = columns / self.baseline.unit[:, None]
        seen = symmetric(white.T @ self.precision @ white)
        if np.any(np.diag(seen) < 0.0):  # what is left beside other causes is a small difference of large numbers
            size, directions = symmetric_eigen(seen)
            seen = directions * np.maximum(size, 0.0) @ directions.T
        return np.asarray(np.eye(columns.shape[1]) + seen)

    def _by_variant(self, one: Hypothesis) -> tuple[float, ...]:
        if id(one) not in self._evidence:
            self._evidence[id(one)] = tuple(self._evidence_of(columns, one.rising) for columns in one.variants)
        return self._evidence[id(one)]

    def _best(self, one: Hypothesis) -> Floats:
        return one.variants[int(np.argmax(self._by_variant(one)))]

    def _evidence_of(self, columns: Floats, rising: Floats) -> float:
        pull = self._projected_pull(columns)
        whole = self._projected_precision(columns)
        found = 0.5 * float(pull @ np.linalg.solve(whole, pull)) - 0.5 * float(np.linalg.slogdet(whole)[1])
        if len(rising):
            mean, spread = self._posterior(columns)
            along = rising @ columns
            size = np.sqrt(np.einsum("ij,jk,ik->i", along, spread, along))
            # Half of what was believed before has it fall.
            found += float(np.sum(scipy.special.log_ndtr((along @ mean) / size) + np.log(2.0)))
        return found

    def _posterior(self, columns: Floats) -> tuple[Floats, Floats]:
        spread = np.linalg.inv(self._projected_precision(columns))
        return np.asarray(spread @ self._projected_pull(columns)), np.asarray(spread)


def agreement(baseline: Reference, cause: Cause, one: Observation) -> float:
    """Compute the logarithm of the factor by which a cause's change makes a run by itself more probable.

    Args:
        baseline: The baseline.
        cause: The cause.
        one: Observation of the run.

    Returns:
        Logarithm of the factor [-].
    """
    white = np.zeros(len(baseline.names))
    white[[baseline.names.index(name) for name in cause.names]] = cause.change
    white /= baseline.unit
    seen, drawn = baseline.alone(one)
    return float(white @ drawn - 0.5 * white @ seen @ white)
