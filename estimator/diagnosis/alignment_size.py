"""Size of a change of a coupling's alignment, beside what is allowed: offset and angle, in µm and µrad.

It is the change that `alignment_changes` tells against the baseline, with what all causes have moved free of the baseline's;
the bearings' loads that follow are those of `load_changes`.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from estimator.alignment.alignment_change import changed_alignment
from estimator.alignment.load_change import LoadChange, changed_loads
from estimator.alignment.run_change import run_change
from estimator.alignment.tolerance import ToleratedChange, allowed_alignment, tolerated_changes
from estimator.diagnosis.equivalent_settlements import EquivalentSettlement, equivalent_settlements
from estimator.diagnosis.finding_kind import Cause, ChangeSize, SizePart
from estimator.diagnosis.moving_causes import moving_causes
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.parameter_description import describe
from estimator.updated_model.bearing_loads import WEIGHT_ERROR
from estimator.updated_model.model import UpdatedModel

MISALIGNMENT = "misalignment"
"""Kind of the causes that have such a size."""
UNITS = {"m": ("um", 1e6), "rad": ("urad", 1e6)}
"""Units that people reckon in: their ending of a quantity's name, and how many of them make the SI unit."""
VERTICAL_LOAD = "load_vertical"
"""Quantity of the loads that are told."""


def alignment_size(
    cause: Cause,
    baseline: Sequence[UpdatedModel],
    newest: UpdatedModel,
    *,
    variation: HealthyVariation,
    causes: Sequence[Cause],
) -> ChangeSize:
    """Return by how much the alignment of a cause's coupling differs from the baseline's (Laird and Ware 1982).

    Offset and angle in either plane, as far as they are determined, with their limits; the bearings' vertical loads that have
    changed; and the bearings whose settlement would be the same.

    Args:
        cause: The misalignment.
        baseline: Models of the baseline's runs.
        newest: Model of the newest run.
        variation: How the machine varies while it is healthy.
        causes: All causes of the machine's change.

    Returns:
        The size.
    """
    machine = newest.machine
    moving = moving_causes((one.kind, one.element) for one in causes)
    change = run_change(baseline, newest, variation=variation, causes=moving)
    if change is None:
        return ChangeSize(None)
    changes = tolerated_changes(machine, changed_alignment(change))
    own = [one for one in changes if describe(one.name).element == cause.element]
    known = [one for one in own if one.value is not None]
    allowed = allowed_alignment(machine, describe(cause.element).element_id)
    quantities = {"allowed_at_rpm": allowed.rpm, **_numbers(known)}
    quantities |= {f"bearing.{one.bearing}.{one.plane}_um": _um(one) for one in equivalent_settlements(machine, cause)}
    loads = [one for one in changed_loads(change) if describe(one.name).quantity == VERTICAL_LOAD and has_moved(one)]
    parts = {one.name.removesuffix("_vertical"): one.part for one in loads}
    quantities |= {f"{name}_per_cent": 100.0 * part for name, part in parts.items() if part is not None}
    size = ChangeSize(None, quantities, parts=(*_figures(known), *map(_load_figure, loads)))
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


def has_moved(one: LoadChange) -> bool:
    """Check whether a load has changed for certain, by more than masses are known to.

    Args:
        one: The change.

    Returns:
        Whether it has.
    """
    return abs(one.value) > max(CONFIDENCE_95 * one.error, WEIGHT_ERROR * one.carried)


def _load_figure(one: LoadChange) -> SizePart:
    half = CONFIDENCE_95 * one.error
    return SizePart(
        one.name, "N", one.value, one.value - half, one.value + half, one.value / one.error if one.error > 0.0 else None
    )


def _um(one: EquivalentSettlement) -> float:
    return 1e6 * one.elevation
