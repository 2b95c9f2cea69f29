"""Models of a machine's assessed runs, and how a machine on oil films varies from run to run, learnt from its baseline."""

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

from estimator.alignment.healthy_films import learnt_variation
from estimator.diagnosis.finding_kind import Cause
from estimator.diagnosis.open_channels import estimate_beside, named_errors
from estimator.fit.omitted_errors.open_errors import errors_found_along
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.document import Machine
from estimator.machine.film_speeds import follows_films
from estimator.machine.parameter_description import describe
from estimator.machine.under_conditions import under_conditions
from estimator.updated_model.model import UpdatedModel, model_at
from service.monitoring.assessment.context import AssessedRun, AssessmentContext, MachineDiagnosis

CACHED_MODELS = 4
"""Baselines of which the variation is remembered: a process mostly assesses a few machines in turns."""


def run_model(machine: Machine, run: AssessedRun, *, beside: Iterable[Cause] = ()) -> UpdatedModel:
    """Return the model that a run's identification led to, under its own operating conditions.

    beside: named causes; errors of measuring chains that they stand for are free.
    """
    fit, named = run.fit, [(one.kind, one.element) for one in beside]
    point, covariance = estimate_beside(fit.point, fit.covariance, fit.effects, named, channels=machine.channels)
    return model_at(under_conditions(machine, run.conditions), fit.coordinates, point, covariance)


def left_out(context: AssessmentContext, diagnosis: MachineDiagnosis) -> frozenset[str]:
    """Return the errors that a diagnosis has named and that the newest run's estimates on oil films do not allow for."""
    fit = context.after[-1].fit if context.after else None
    if fit is None or fit.effects is None or not follows_films(context.machine):
        return frozenset()
    found_along = {describe(fit.effects.names[place]).whole for place in errors_found_along(fit.effects)}
    known = {describe(name).whole for name in fit.effects.names}
    named = named_errors((one.cause.kind, one.cause.element) for one in diagnosis.causes)
    return frozenset((named & known) - found_along)


@dataclass(frozen=True, eq=False)
class _BaselineContents:
    """A machine's baseline, equal to another of the same contents: each assessment reads it anew."""

    machine: Machine
    runs: tuple[AssessedRun, ...]

    @cached_property
    def contents(self) -> bytes:
        """Return a digest of all that the variation follows from."""
        found = hashlib.sha256(self.machine.model_dump_json().encode())
        for one in self.runs:
            found.update(repr((one.fit.coordinates, sorted(one.conditions.items()))).encode())
            found.update(one.fit.point.tobytes() + one.fit.covariance.tobytes())
        return found.digest()

    def __hash__(self) -> int:
        return hash(self.contents)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _BaselineContents) and self.contents == other.contents


def baseline_variation(machine: Machine, baseline: Sequence[AssessedRun]) -> HealthyVariation:
    """Return how a machine on oil films varies from run to run, from its baseline; remembered for the last few of these."""
    return _baseline_variation(_BaselineContents(machine, tuple(baseline)))


@lru_cache(maxsize=CACHED_MODELS)
def _baseline_variation(baseline: _BaselineContents) -> HealthyVariation:
    return learnt_variation([run_model(baseline.machine, one) for one in baseline.runs])
