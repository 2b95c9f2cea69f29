"""Reports a field balancing as text: correction, what it leaves, residual unbalance, and the check run."""

from collections.abc import Iterator

import numpy as np

from estimator.calibration.balancing_check import BalancingCheck
from estimator.calibration.field_balancing import FieldBalancing
from estimator.units import rad_per_s_to_rpm
from estimator.updated_model.balance_quality import GRAM_MILLIMETRE, RotorBalance
from service.balancing.correction_rows import channel_effects, limit_verdicts, plane_weights, trim_weights


def balancing_text(found: FieldBalancing, check: BalancingCheck | None = None) -> str:
    """Return the report of a correction and, where there is one, of its check run."""
    parts = [_head(found), _correction(found), _effects(found, check), _residual(found, check)]
    if check is not None:
        parts.append(_check(found, check))
    return "\n\n".join("\n".join(part) for part in map(list, parts) if part)


def _head(found: FieldBalancing) -> Iterator[str]:
    speeds = [f"{rad_per_s_to_rpm(one):.0f}" for one in found.speed]
    shown = ", ".join(speeds) if len(speeds) <= 6 else f"{len(speeds)} speeds from {speeds[0]} to {speeds[-1]}"
    yield f"Balancing of {found.machine.name} ({found.machine.id}) at {shown} r/min"
    yield f"Runs: {', '.join(found.runs.names)}"
    yield f"Influence: {found.choice.words}"
    yield from (f"Note: {one}" for one in found.notes)


def _correction(found: FieldBalancing) -> Iterator[str]:
    criterion = {"least-squares": "least squares of vibration", "min-max": "least largest vibration"}
    yield (
        f"Correction, {criterion[found.correction.criterion]}: plane, unbalance to add [g mm] and angle [°] from the "
        "keyphasor mark, +x to +y, 95 % intervals"
    )
    for one in plane_weights(found):
        angle = "any angle" if one.half_width_deg >= 180.0 else f"{one.angle_deg:6.1f} ± {one.half_width_deg:.0f}"
        yield f"  {one.plane:<12} {one.g_mm:10.4g} ({one.lower_g_mm:.3g} to {one.upper_g_mm:.3g}) at {angle}"
        for place, grams in one.masses:
            yield f"      {grams:8.4g} g at the place at {place:.1f}°"
        if one.missed is not None and one.missed > 0.01:
            yield f"      the places miss the best unbalance by {100 * one.missed:.0f} %"
    yield "The weights are counted from the state without trial weights: take these off first, or put on the difference."


def _effects(found: FieldBalancing, check: BalancingCheck | None) -> Iterator[str]:
    yield "Largest vibration over the speeds [µm pp]: channel, before, predicted after, 95 % below" + (
        ", check run" if check else ""
    )
    for one in channel_effects(found, check):
        shown = "" if one.check is None else f" {one.check:9.3g}  {'as promised' if one.held else 'MORE THAN PROMISED'}"
        yield f"  {one.channel:<12} {one.before:9.3g} {one.after:9.3g} {one.upper:9.3g}{shown}"
    limit = limit_verdicts(found)
    if limit is not None:
        yield f"  limit of the document {limit[0]:.3g} µm pp: {_verdict_text(limit[1])}"


def _residual(found: FieldBalancing, check: BalancingCheck | None) -> Iterator[str]:
    yield (
        f"Residual unbalance in the bearing planes against ISO 21940-11 G {found.options.grade:g} at "
        f"{rad_per_s_to_rpm(found.service_speed):.0f} r/min [g mm], as a rigid rotor, from {', '.join(found.known.planes)}: "
        f"before, predicted after{', check run' if check else ''}"
    )
    states = [found.before, found.after, *([check.residual] if check else [])]
    for rotors in zip(*states, strict=True):
        yield from _planes(rotors)


def _planes(rotors: tuple[RotorBalance, ...]) -> Iterator[str]:
    for planes in zip(*(rotor.planes for rotor in rotors), strict=True):
        shown = "; ".join(
            f"{_g_mm(one.unbalance, one.iso_permissible)} (below {one.upper / GRAM_MILLIMETRE:.3g}), "
            f"G {round(one.grade, 3):.2g}, {_verdict_text(one.iso)}"
            for one in planes
        )
        first = planes[0]
        yield f"  {rotors[0].shaft:<10} {first.bearing:<8} permissible {first.iso_permissible / GRAM_MILLIMETRE:.3g}: {shown}"


def _g_mm(unbalance: complex, permissible: float) -> str:
    """Return an unbalance in g mm with no more digits than the permissible one is looked at with."""
    return f"{round(abs(unbalance) / permissible, 4) * permissible / GRAM_MILLIMETRE:.3g}"


def _check(found: FieldBalancing, check: BalancingCheck) -> Iterator[str]:
    shown = np.isfinite(check.vector)
    kept, points = int(np.count_nonzero(check.held)), int(np.count_nonzero(shown))
    yield f"Check run {check.name}: {kept} of {points} points within the prediction for the weights that were on"
    limit = found.machine.operation.vibration_limit
    if limit is not None:
        kept_limit = bool(np.nanmax(np.abs(check.vector)) <= limit)
        yield f"  limit of the document: {'met' if kept_limit else 'NOT MET'}"
    yield "  further correction, with what this run adds: plane, unbalance to add [g mm] at angle [°]"
    for plane, size, angle in trim_weights(found, check):
        yield f"  {plane:<12} {size:10.4g} {angle:7.1f}"


def _verdict_text(verdict: str) -> str:
    return "NOT MET" if verdict == "not met" else verdict
