"""Diagnoses what changed between the results of a healthy machine and later ones, as the service does with its runs."""

from collections.abc import Sequence
from dataclasses import dataclass

from estimator.diagnosis.bayes_factors import Diagnosis
from estimator.diagnosis.finding_kind import Cause, ChangeSize
from estimator.diagnosis.healthy_variation import typical_amplitude
from estimator.diagnosis.observation import observation_of
from estimator.diagnosis.run_windows import RunWindows
from estimator.diagnosis.severity_measures import change_size
from estimator.errors import Invalid
from rotorundown.notebook_text import notebook_text
from rotorundown.result import Result, require_result


class NotDiagnosable(Invalid):
    """Raised when results cannot be diagnosed together; the message says why."""


@dataclass(frozen=True, eq=False)
class CausesFound:
    """Causes of what changed, the strongest first.

    Attributes:
        diagnosis: The causes with their evidence and runners-up.
        sizes: Size of each cause.
    """

    diagnosis: Diagnosis
    sizes: tuple[ChangeSize, ...]

    @property
    def causes(self) -> tuple[Cause, ...]:
        """Return the causes."""
        return self.diagnosis.causes

    def __str__(self) -> str:
        if not self.causes:
            return "nothing that changed since the baseline is certain enough to be told"
        return "\n".join(
            f"{cause.kind} at {cause.element}: {size.per_cent:.0f} %, evidence {cause.evidence:.1f}"
            if size.per_cent is not None
            else f"{cause.kind} at {cause.element}: evidence {cause.evidence:.1f}"
            for cause, size in zip(self.causes, self.sizes, strict=True)
        )

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return the text for a notebook, escaped."""
        return notebook_text(self)


def diagnose(baseline: Sequence[Result], later: Sequence[Result], *, runs_that_agree: int = 1) -> CausesFound:
    """Find what changed since a baseline.

    Args:
        baseline: Results of the healthy machine, at least two; more show the variation from run to run better.
        later: Later results of the same machine, oldest first.
        runs_that_agree: Number of newest runs that must agree on a cause.

    Returns:
        The causes.

    Raises:
        NotDiagnosable: Results are missing, not accepted in the baseline, or of different machines.
        NotIdentified: Something in the lists is no result of `identify`.
    """
    for name, several in (("baseline", baseline), ("later", later)):
        if isinstance(several, Result):
            raise NotDiagnosable(f"{name} is one result: give a list of them")
        for one in several:
            require_result(one, f"what is in {name}")
    if not baseline or not later:
        raise NotDiagnosable("a diagnosis needs results of the healthy machine and later ones")
    machine = baseline[0].machine
    others = {one.machine.id for one in (*baseline, *later)} - {machine.id}
    if others:
        raise NotDiagnosable(f"the results are of several machines: '{machine.id}' and {', '.join(sorted(others))}")
    refused = next((one for one in baseline if not one.accepted), None)
    if refused is not None:
        raise NotDiagnosable(f"a result of the baseline is not accepted: {refused.verdict}")
    channels = machine.channels
    try:
        windows = RunWindows.from_baseline(machine, [observation_of(one.identification, channels) for one in baseline])
    except ValueError as error:
        raise NotDiagnosable(str(error)) from None
    observations = [observation_of(one.identification, channels) for one in later]
    found = windows.found(observations, on_delay=lambda _kind, _element: min(runs_that_agree, len(later)))
    amplitude = {channel: typical_amplitude(channel, windows.baseline) for channel in channels}
    return CausesFound(found, tuple(change_size(cause, windows.reference, amplitude=amplitude) for cause in found.causes))
