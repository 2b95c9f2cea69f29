"""Diagnoses what changed between the results of a healthy machine and later ones, as the service does with its runs."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from numbers import Integral
from typing import Any

from estimator.alignment.healthy_films import learnt_variation
from estimator.diagnosis.alignment_size import MISALIGNMENT, alignment_size
from estimator.diagnosis.bayes_factors import Diagnosis
from estimator.diagnosis.film_reference import film_observation
from estimator.diagnosis.finding_kind import Cause, ChangeSize
from estimator.diagnosis.healthy_variation import typical_amplitude
from estimator.diagnosis.observation import Observation, observation_of, observed_fit
from estimator.diagnosis.open_channels import estimate_beside
from estimator.diagnosis.run_windows import RunWindows
from estimator.diagnosis.severity_measures import change_size
from estimator.errors import Invalid
from estimator.machine.document import Machine
from estimator.machine.film_speeds import follows_films
from estimator.updated_model.model import UpdatedModel, model_at
from rotorundown.copied_runs import copied_run, copy_words
from rotorundown.environment.notebook_text import notebook_text
from rotorundown.environment.optional_packages import optional_package
from rotorundown.result import Result, require_result
from rotorundown.summaries.cause_sizes import COLUMNS, size_rows, size_words


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

    def to_frame(self) -> Any:
        """Return a pandas DataFrame with a row per figure of each cause's size, in its unit.

        Raises PackageMissing without pandas.
        """
        pandas = optional_package("pandas", needed_for="data frames")
        rows = [row for cause, size in zip(self.causes, self.sizes, strict=True) for row in size_rows(cause, size)]
        return pandas.DataFrame(rows, columns=list(COLUMNS))

    def __str__(self) -> str:
        if not self.causes:
            return "nothing that changed since the baseline is certain enough to be told"
        told = zip(self.causes, self.sizes, strict=True)
        return "\n".join(f"{one.kind} at {one.element}: {size_words(size)}evidence {one.evidence:.1f}" for one, size in told)

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
        NotDiagnosable: Results are missing, not accepted in the baseline, of different machines, or one is there twice.
        NotIdentified: Something in the lists is no result of `identify`.
    """
    for name, several in (("baseline", baseline), ("later", later)):
        if isinstance(several, Result):
            raise NotDiagnosable(f"{name} is one result: give a list of them")
        if not isinstance(several, Iterable):
            raise NotDiagnosable(f"{name} is a {type(several).__name__}: give a list of results of identify(machine, runs)")
        for one in several:
            require_result(one, f"what is in {name}")
    if isinstance(runs_that_agree, bool) or not isinstance(runs_that_agree, Integral) or runs_that_agree < 1:
        raise NotDiagnosable(f"runs_that_agree is a whole number from 1 up, not {runs_that_agree!r:.40}")
    if not baseline or not later:
        raise NotDiagnosable("a diagnosis needs results of the healthy machine and later ones")
    machine = baseline[0].machine
    others = {one.machine.id for one in (*baseline, *later)} - {machine.id}
    if others:
        raise NotDiagnosable(f"the results are of several machines: '{machine.id}' and {', '.join(sorted(others))}")
    if len(baseline) == 1:
        raise NotDiagnosable("baseline has one result: at least two show by how much a healthy machine varies")
    if copied := copied_run([run for one in (*baseline, *later) for run in one.runs]):
        raise NotDiagnosable(copy_words(copied))
    refused = next((one for one in baseline if not one.accepted), None)
    if refused is not None:
        raise NotDiagnosable(f"a result of the baseline is not accepted: {refused.verdict}")
    films = follows_films(machine)
    models = [_fitted(machine, one) for one in baseline] if films else []
    variation = learnt_variation(models) if films else None
    try:
        windows = RunWindows.from_baseline(machine, [_observed(machine, one) for one in baseline], variation=variation)
    except ValueError as error:
        raise NotDiagnosable(str(error)) from None
    observations = [_observed(machine, one) for one in later]
    found = windows.found(observations, on_delay=lambda _kind, _element: min(runs_that_agree, len(later)))
    amplitude = {channel: typical_amplitude(channel, windows.baseline) for channel in machine.channels}

    def size(cause: Cause) -> ChangeSize:
        if variation is None or cause.kind != MISALIGNMENT:
            return change_size(cause, windows.reference, amplitude=amplitude)
        newest = windows.newest_trusted(cause, observations, found.causes)
        if newest is None:
            return ChangeSize(None)
        now = _fitted(machine, later[newest], beside=found.causes)
        return alignment_size(cause, models, now, variation=variation, causes=found.causes)

    return CausesFound(found, tuple(map(size, found.causes)))


def _fitted(machine: Machine, one: Result, *, beside: Iterable[Cause] = ()) -> UpdatedModel:
    """Return the model that a fit led to; named errors of measuring chains are free."""
    fit, named = one.identification, [(cause.kind, cause.element) for cause in beside]
    effects = fit.channel_effects
    point, covariance = estimate_beside(fit.point, fit.covariance, effects, named, channels=machine.channels)
    return model_at(machine, fit.coordinates, point, covariance)


def _observed(machine: Machine, one: Result) -> Observation:
    if follows_films(machine):
        return film_observation(observed_fit(one.identification), machine, {})
    return observation_of(one.identification, machine.channels)
