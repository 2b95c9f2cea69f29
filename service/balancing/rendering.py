"""Renders a correction and its check run as fields of plain numbers, as the API answers them and the store keeps them."""

import cmath
import math
from typing import Any

import numpy as np

from estimator.balancing.balance_quality import GRAM_MILLIMETRE, PlaneBalance, RotorBalance
from estimator.balancing.balancing_check import BalancingCheck
from estimator.balancing.field_balancing import FieldBalancing
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.disc_scale import DiscScale
from estimator.units import rad_per_s_to_rpm
from service.balancing.correction_rows import (
    MICROMETRES,
    WeightToAdd,
    effect_rows,
    has_other_weights,
    limit_verdicts,
    plane_weights,
    trim_weights,
)


def correction_fields(found: FieldBalancing) -> dict[str, Any]:
    """Return a correction: weights, what they leave, residual unbalances, vectors."""
    limit = limit_verdicts(found)
    return {
        "speeds_rpm": [rad_per_s_to_rpm(float(one)) for one in found.speed],
        "criterion": found.correction.criterion,
        "grade": found.options.grade,
        "service_rpm": rad_per_s_to_rpm(found.service_speed),
        "influence": found.choice.words,
        "notes": list(found.notes),
        "planes": [
            {
                **_weight(one),
                "masses": [{"angle_deg": angle, "grams": grams} for angle, grams in one.masses],
                "missed": one.missed,
            }
            for one in plane_weights(found)
        ],
        "channels": [
            {"channel": one.channel, "before_um_pp": one.before, "after_um_pp": one.after, "upper_um_pp": one.upper}
            for one in effect_rows(found)
        ],
        "limit_um_pp": None if limit is None else limit[0],
        "limit_verdict": None if limit is None else limit[1],
        "residual": [
            {**_plane(shaft, before), "before": _residual(before), "after": _residual(after)}
            for shaft, before, after in _pairs(found.before, found.after)
        ],
        "vectors": _vectors(found),
    }


def _weight(one: WeightToAdd) -> dict[str, Any]:
    return {
        "disc": one.plane,
        "g_mm": one.g_mm,
        "lower_g_mm": one.lower_g_mm,
        "upper_g_mm": one.upper_g_mm,
        "angle_deg": one.angle_deg,
        "half_width_deg": one.half_width_deg,
    }


def check_fields(found: FieldBalancing, check: BalancingCheck) -> dict[str, Any]:
    """Return what a check run shows beside what was promised."""
    shown = np.isfinite(check.vector)
    limit = found.machine.operation.vibration_limit
    return {
        "points": int(np.count_nonzero(shown)),
        "points_kept": int(np.count_nonzero(check.held)),
        "other_weights": has_other_weights(found, check),
        "channels": [
            {"channel": one.channel, "check_um_pp": one.check, "upper_um_pp": one.check_upper, "kept": one.held}
            for one in effect_rows(found, check)
        ],
        "limit_met": None if limit is None else bool(np.nanmax(np.abs(check.vector)) <= limit),
        "residual": [{**_plane(shaft, one), **_residual(one)} for shaft, one, _ in _pairs(check.residual, check.residual)],
        "unpredicted": list(check.unpredicted),
        "trim": [_weight(one) for one in trim_weights(found, check)],
        "trim_is_noise": check.is_trim_noise,
        "vectors": [
            {"point": point, **_polar(complex(value))}
            for point, value in zip(found.runs.points, check.vector, strict=True)
            if np.isfinite(value)
        ],
    }


def on_scale(fields: Any, scale: DiscScale, direction: int) -> Any:
    """Return fields in which each weight's angle stands beside its number on the disc's scale, `scale_deg`."""
    if isinstance(fields, list):
        return [on_scale(one, scale, direction) for one in fields]
    if not isinstance(fields, dict):
        return fields
    found = {name: on_scale(one, scale, direction) for name, one in fields.items()}
    if "angle_deg" in found:
        found["angle_deg"] = found["angle_deg"] % 360.0 % 360.0  # requests may say -90°, or 450°
        found["scale_deg"] = scale.reading(math.radians(found["angle_deg"]), direction=direction)
    return found


def _vectors(found: FieldBalancing) -> list[dict[str, Any]]:
    """Return each point's vectors of all runs, and the prediction with the radius of its 95 % circle."""
    after, runs = found.correction.after, found.runs
    radius = found.correction.influence.widening * CONFIDENCE_95 * np.sqrt(np.trace(after.covariance, axis1=1, axis2=2) / 2)
    return [
        {
            "point": point,
            "channel": point.partition(" at ")[0],
            "runs": [
                {"name": name, **_polar(complex(value))}
                for name, value in zip(runs.names, runs.vector[:, at], strict=True)
                if np.isfinite(value)
            ],
            "predicted": _polar(complex(after.value[at])),
            "radius_um_pp": float(radius[at]) / MICROMETRES,
        }
        for at, point in enumerate(runs.points)
    ]


def _polar(value: complex) -> dict[str, float]:
    return {"amplitude_um_pp": abs(value) / MICROMETRES, "lag_deg": -math.degrees(cmath.phase(value)) % 360.0 % 360.0}


def _pairs(one: tuple[RotorBalance, ...], other: tuple[RotorBalance, ...]) -> list[tuple[str, PlaneBalance, PlaneBalance]]:
    return [
        (first.shaft, plane, beside)
        for first, second in zip(one, other, strict=True)
        for plane, beside in zip(first.planes, second.planes, strict=True)
    ]


def _plane(shaft: str, plane: PlaneBalance) -> dict[str, Any]:
    return {"shaft": shaft, "bearing": plane.bearing, "permissible_g_mm": plane.iso_permissible / GRAM_MILLIMETRE}


def _residual(plane: PlaneBalance) -> dict[str, Any]:
    if plane.untold:
        nothing = dict.fromkeys(("g_mm", "upper_g_mm", "reached_grade"))
        return nothing | {"verdict": plane.iso, "untold": plane.untold}
    return {
        "g_mm": abs(plane.unbalance) / GRAM_MILLIMETRE,
        "upper_g_mm": plane.upper / GRAM_MILLIMETRE,
        "reached_grade": plane.grade,
        "verdict": plane.iso,
        "untold": "",
    }
