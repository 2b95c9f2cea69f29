"""Compares later runs with a baseline: changed coefficients at a coupling, an equivalent load in it, or no change.

On oil films it is the alignment in µm that has changed, and the bearings' loads with it.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from estimator.alignment.alignment_comparison import AlignmentComparison
from estimator.close_matches import did_you_mean
from estimator.diagnosis.compared_identifications import compared_identifications
from estimator.errors import Invalid
from estimator.identification.model_comparison import ModelComparison, compare_misalignment
from estimator.machine.document import Machine
from estimator.machine.film_speeds import follows_films
from estimator.phasors.measurement import joined
from rotorundown.copied_runs import copied_run, copy_words
from rotorundown.environment.blas_threads import one_blas_thread
from rotorundown.environment.notebook_text import notebook_text
from rotorundown.environment.optional_packages import optional_package
from rotorundown.identification import identify
from rotorundown.result import Result, require_result
from rotorundown.runs import MachineRun, other_channels
from rotorundown.summaries.comparison_summary import alignment_rows, comparison_text, coupling_rows
from rotorundown.summaries.estimate_summary import within_screen


class NotComparable(Invalid):
    """Raised when runs cannot be compared with a baseline; the message says why."""


@dataclass(frozen=True, eq=False)
class CouplingComparison:
    """Verdict on a coupling.

    Attributes:
        found: The compared models, the best first, with their criteria; on oil films the changes of alignment and loads.
        baseline: The baseline's result.
    """

    found: ModelComparison | AlignmentComparison
    baseline: Result

    @property
    def verdict(self) -> str:
        """Return the verdict in words."""
        return self.found.verdict

    def to_frame(self) -> Any:
        """Return a pandas DataFrame of what has changed, in SI units. Raises PackageMissing without pandas.

        It has a row per coefficient at the coupling with its value before and now, by the likeliest model; on oil films a row
        per offset, angle and load with its change and 95 % interval.
        """
        pandas = optional_package("pandas", needed_for="data frames")
        if isinstance(self.found, AlignmentComparison):
            return pandas.DataFrame(alignment_rows(self.found)).set_index("parameter")
        return pandas.DataFrame(coupling_rows(self.found, self.baseline.identification)).set_index("parameter")

    def __str__(self) -> str:
        if isinstance(self.found, AlignmentComparison):
            return "\n".join([self.verdict, "", *self.found.lines()])
        return "\n".join(map(within_screen, comparison_text(self.found, self.baseline.identification).splitlines()))

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return the text for a notebook, escaped."""
        return notebook_text(self)


def compare(baseline: Result, runs: MachineRun | Iterable[MachineRun], *, coupling: str | None = None) -> CouplingComparison:
    """Tell whether later runs show changed coefficients at a coupling, an equivalent load in it, or no change.

    Of a train on oil films it tells by how much offset, angle and the bearings' loads have changed.

    Args:
        baseline: Result of the healthy machine, accepted.
        runs: The later run, or several together.
        coupling: Id of the coupling; None where the machine has a single one.

    Returns:
        The comparison.

    Raises:
        NotComparable: The baseline, or on oil films the later run, is not accepted, the machine has no such coupling, there is
            no later run, one was not read with this machine or is a copy, or on oil films the two say nothing together of its
            alignment.
        NotIdentified: The baseline is no result of `identify`.
    """
    require_result(baseline, "the baseline")
    machine = baseline.machine
    coupling = compared_coupling(machine, coupling)
    several = _later_runs(machine, runs)
    if copied := copied_run([*baseline.runs, *several]):
        raise NotComparable(copy_words(copied))
    if not baseline.accepted:
        raise NotComparable(f"the baseline is not accepted: {baseline.verdict}")
    if follows_films(machine):
        return CouplingComparison(_on_films(machine, baseline, several, coupling), baseline)
    measurement = joined([run.measurement for run in several])
    with one_blas_thread():
        found = compare_misalignment(machine, measurement, baseline=baseline.identification, coupling=coupling)
    return CouplingComparison(found, baseline)


def compared_coupling(machine: Machine, coupling: str | None) -> str:
    """Return the id of the coupling that is named, or of the only one. Raises NotComparable."""
    known = [one.id for one in machine.couplings]
    if not known:
        raise NotComparable(f"'{machine.id}' has no coupling to compare")
    if coupling is None:
        if len(known) > 1:
            raise NotComparable(f"'{machine.id}' has several couplings, {', '.join(known)}: say which one is to be compared")
        return known[0]
    if coupling not in known:
        near = did_you_mean(str(coupling), known)
        raise NotComparable(f"'{coupling}' is no coupling of '{machine.id}'; there are {', '.join(known)}{near}")
    return coupling


def _later_runs(machine: Machine, given: Any) -> list[MachineRun]:
    """Return the later runs as a list. Raises NotComparable for what is no run of the machine."""
    one = not isinstance(given, Iterable) or isinstance(given, str | Mapping | Result) or hasattr(given, "columns")
    runs = [given] if one else list(given)
    if not runs:
        raise NotComparable("no later run is given: compare needs one at least")
    for run in runs:
        if isinstance(run, Result):
            raise NotComparable("a later run is a Result: give the runs that it was identified from, result.runs")
        if not isinstance(run, MachineRun):
            raise NotComparable(f"a later run is a {type(run).__name__}: read it first, with read_run(…, machine=…)")
        if other := other_channels(run, machine):
            raise NotComparable(other)
    return runs


def _on_films(machine: Machine, baseline: Result, runs: Sequence[MachineRun], coupling: str) -> AlignmentComparison:
    """Return the changes of alignment and loads of a train on oil films. Raises NotComparable."""
    later = identify(machine, runs)
    if not later.accepted:
        raise NotComparable(f"the later run is not accepted: {later.verdict}")
    try:
        return compared_identifications(machine, baseline.identification, later.identification, coupling)
    except ValueError as error:
        raise NotComparable(str(error)) from None
