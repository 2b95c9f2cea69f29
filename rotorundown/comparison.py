"""Compares later runs with a baseline: changed coefficients at a coupling, an equivalent load in it, or no change.

On oil films it is the alignment in µm that has changed, and the bearings' loads with it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from estimator.alignment.alignment_comparison import AlignmentComparison
from estimator.close_matches import did_you_mean
from estimator.diagnosis.compared_identifications import compared_identifications
from estimator.errors import Invalid
from estimator.identification.model_comparison import ModelComparison, compare_misalignment
from estimator.machine.document import Machine
from estimator.machine.film_speeds import follows_films
from estimator.phasors.measurement import joined
from rotorundown.environment.blas_threads import one_blas_thread
from rotorundown.identification import identify
from rotorundown.notebook_text import notebook_text
from rotorundown.result import Result, require_result
from rotorundown.runs import MachineRun


class NotComparable(Invalid):
    """Raised when runs cannot be compared with a baseline; the message says why."""


@dataclass(frozen=True, eq=False)
class CouplingComparison:
    """Verdict on a coupling.

    Attributes:
        found: The compared models, the best first, with their criteria; on oil films the changes of alignment and loads.
    """

    found: ModelComparison | AlignmentComparison

    @property
    def verdict(self) -> str:
        """Return the verdict in words."""
        return self.found.verdict

    def __str__(self) -> str:
        if isinstance(self.found, AlignmentComparison):
            return "\n".join([self.verdict, "", *self.found.lines()])
        lines = [
            f"  {view.name:<22} criterion {view.criterion:10.1f}  unknowns {view.unknowns:3d}  {view.identification.verdict}"
            for view in self.found.views
        ]
        return "\n".join(
            [self.verdict, "", "Compared models, the likeliest first: the smaller the criterion, the likelier", *lines]
        )

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return the text for a notebook, escaped."""
        return notebook_text(self)


def compare(baseline: Result, runs: MachineRun | Sequence[MachineRun], *, coupling: str) -> CouplingComparison:
    """Tell whether later runs show changed coefficients at a coupling, an equivalent load in it, or no change.

    Of a train on oil films it tells by how much offset, angle and the bearings' loads have changed.

    Args:
        baseline: Result of the healthy machine, accepted.
        runs: The later run, or several together.
        coupling: Id of the coupling.

    Returns:
        The comparison.

    Raises:
        NotComparable: The baseline, or on oil films the later run, is not accepted, the machine has no such coupling, or on
            oil films the two say nothing of its alignment together.
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
    if follows_films(machine):
        return CouplingComparison(_on_films(machine, baseline, several, coupling))
    measurement = joined([run.measurement for run in several])
    with one_blas_thread():
        return CouplingComparison(
            compare_misalignment(machine, measurement, baseline=baseline.identification, coupling=coupling)
        )


def _on_films(machine: Machine, baseline: Result, runs: Sequence[MachineRun], coupling: str) -> AlignmentComparison:
    """Return the changes of alignment and loads of a train on oil films. Raises NotComparable."""
    later = identify(machine, runs)
    if not later.accepted:
        raise NotComparable(f"the later run is not accepted: {later.verdict}")
    try:
        return compared_identifications(machine, baseline.identification, later.identification, coupling)
    except ValueError as error:
        raise NotComparable(str(error)) from None
