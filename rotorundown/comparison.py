"""Compares later runs with a baseline: changed coefficients at a coupling, an equivalent load in it, or no change."""

from collections.abc import Sequence
from dataclasses import dataclass

from estimator.close_matches import did_you_mean
from estimator.errors import Invalid
from estimator.identification.model_comparison import ModelComparison, compare_misalignment
from estimator.phasors.measurement import joined
from rotorundown.environment.blas_threads import one_blas_thread
from rotorundown.notebook_text import notebook_text
from rotorundown.result import Result, require_result
from rotorundown.runs import MachineRun


class NotComparable(Invalid):
    """Raised when runs cannot be compared with a baseline; the message says why."""


@dataclass(frozen=True, eq=False)
class CouplingComparison:
    """Verdict on a coupling.

    Attributes:
        found: The compared models, the best first, with their criteria.
    """

    found: ModelComparison

    @property
    def verdict(self) -> str:
        """Return the verdict in words."""
        return self.found.verdict

    def __str__(self) -> str:
        lines = [
            f"  {view.name:<22} criterion {view.criterion:10.1f}  unknowns {view.unknowns:3d}  {view.identification.verdict}"
            for view in self.found.views
        ]
        return "\n".join([self.verdict, "", *lines])

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return the text for a notebook, escaped."""
        return notebook_text(self)


def compare(baseline: Result, runs: MachineRun | Sequence[MachineRun], *, coupling: str) -> CouplingComparison:
    """Tell whether later runs show changed coefficients at a coupling, an equivalent load in it, or no change.

    Args:
        baseline: Result of the healthy machine, accepted.
        runs: The later run, or several together.
        coupling: Id of the coupling.

    Returns:
        The comparison.

    Raises:
        NotComparable: The baseline is not accepted, or the machine has no such coupling.
        NotIdentified: The baseline is no result of `identify`.
    """
    require_result(baseline, "the baseline")
    machine = baseline.machine
    known = [one.id for one in machine.couplings]
    if coupling not in known:
        raise NotComparable(
            f"'{coupling}' is no coupling of '{machine.id}'; there are {', '.join(known)}{did_you_mean(coupling, known)}"
        )
    if not baseline.accepted:
        raise NotComparable(f"the baseline is not accepted: {baseline.verdict}")
    several = [runs] if isinstance(runs, MachineRun) else list(runs)
    measurement = joined([run.measurement for run in several])
    with one_blas_thread():
        return CouplingComparison(
            compare_misalignment(machine, measurement, baseline=baseline.identification, coupling=coupling)
        )
