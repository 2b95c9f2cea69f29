"""Size of a change of a coupling's alignment: the same numbers as `GET /machines/{id}/alignment`, beside what is allowed."""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

from estimator.alignment.alignment_change import alignment_changes
from estimator.alignment.healthy_films import learnt_variation
from estimator.alignment.tolerance import ToleratedChange, allowed_alignment, tolerated_changes
from estimator.diagnosis.equivalent_settlements import EquivalentSettlement, equivalent_settlements
from estimator.diagnosis.finding_kind import Cause, ChangeSize, SizePart
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.machine.under_conditions import under_conditions
from estimator.updated_model.model import UpdatedModel, model_at
from service.monitoring.assessment.context import AssessedRun

UNITS = {"m": ("um", 1e6), "rad": ("urad", 1e6)}
"""Units that people reckon in: their ending of a quantity's name, and how many of them make the SI unit."""

REMEMBERED = 4
"""Baselines of which the variation is remembered: a process mostly assesses a few machines in turns."""


def run_model(machine: Machine, run: AssessedRun) -> UpdatedModel:
    """Return the model that a run's identification led to, under its own operating conditions."""
    return model_at(under_conditions(machine, run.conditions), run.fit.coordinates, run.fit.point, run.fit.covariance)


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


def learnt(machine: Machine, baseline: Sequence[AssessedRun]) -> HealthyVariation:
    """Return how a machine on oil films varies from run to run, from its baseline; remembered for the last few of these."""
    return _learnt(_BaselineContents(machine, tuple(baseline)))


@lru_cache(maxsize=REMEMBERED)
def _learnt(baseline: _BaselineContents) -> HealthyVariation:
    return learnt_variation([run_model(baseline.machine, one) for one in baseline.runs])


def alignment_size(
    machine: Machine, cause: Cause, baseline: Sequence[AssessedRun], newest: AssessedRun, variation: HealthyVariation
) -> ChangeSize:
    """Return by how much the alignment of the cause's coupling differs in the newest run from the baseline's.

    Offset and angle in either plane, as far as they are determined, with their limits; and the bearings whose settlement would
    be the same.
    """
    models = [run_model(machine, one) for one in baseline]
    changes = alignment_changes(models, run_model(machine, newest), variation=variation)
    own = [one for one in tolerated_changes(machine, changes) if describe(one.name).element == cause.element]
    known = [one for one in own if one.value is not None]
    allowed = allowed_alignment(machine, describe(cause.element).element_id)
    quantities = {"allowed_at_rpm": allowed.rpm, **_numbers(known)}
    quantities |= {f"bearing.{one.bearing}.{one.plane}_um": _um(one) for one in equivalent_settlements(machine, cause)}
    size = ChangeSize(None, quantities, parts=tuple(_figures(known)))
    if not known:
        return size
    return replace(
        size,
        tolerance_per_cent=100.0 * max(one.part for one in known),
        beyond_tolerance=max(one.beyond for one in known),
    )


def _numbers(known: Sequence[ToleratedChange]) -> dict[str, float]:
    found = {}
    for one in known:
        unit, factor = UNITS[one.unit]
        name = describe(one.name).quantity
        found[f"{name}_{unit}"] = factor * (one.value or 0.0)
        found[f"{name}_half_width_{unit}"] = factor * one.half
        found[f"{name}_allowed_{unit}"] = factor * one.allowed
    return found


def _figures(known: Sequence[ToleratedChange]) -> Iterator[SizePart]:
    """Yield the changes with their intervals, the one that takes most of what is allowed first."""
    for one in sorted(known, key=lambda each: -each.part):
        unit, factor = UNITS[one.unit]
        value, half = factor * (one.value or 0.0), factor * one.half
        sigma = CONFIDENCE_95 * value / half if half > 0.0 else None
        yield SizePart(one.name, unit, value, value - half, value + half, sigma, factor * one.allowed)


def _um(one: EquivalentSettlement) -> float:
    return 1e6 * one.elevation
