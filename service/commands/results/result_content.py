"""Contents of the JSON that commands on recorded runs print: what their texts say, by names."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from msgspec import structs

from estimator.calibration.unbalance_since import UnbalanceSince
from estimator.fit.estimates import CONFIDENCE_95, Estimate
from estimator.fit.identification import Identification
from estimator.identification.experiment_design import Benefit, HelpfulProbe, HelpfulSpeed
from estimator.identification.model_comparison import ModelComparison
from estimator.machine.disc_scale import DiscScale
from estimator.machine.document import Machine
from estimator.phasors.quality import Quality
from estimator.phasors.slow_roll import Capture
from estimator.thesis.machine_regression import PublishedEstimate
from estimator.units import METRES, PEAK, rad_per_s_to_rpm
from estimator.updated_model.impact_comparison import compare_impact_test, measured_frequencies
from estimator.updated_model.uncertainty import PhasorBand
from rotorundown.machine_model import Model
from service.commands.results.response_peaks import response_peaks

GRAM_MILLIMETRES = 1e6
"""g mm per kg m."""
MICROMETRES_PP = METRES["um"] * PEAK["peak-to-peak"]
LOADS = {"force_x": "N", "force_y": "N", "moment_x": "N m", "moment_y": "N m"}
"""Unit of each load of a coupling."""


def identification_content(machine: Machine, found: Identification) -> dict[str, Any]:
    """Return the verdict, the fit's figures and the estimates, unbalances in g mm at degrees too."""
    return {
        "machine": machine.id,
        "accepted": found.accepted,
        "verdict": found.verdict,
        "chi_square": found.chi_square,
        "degrees_of_freedom": found.degrees_of_freedom,
        "samples": found.samples,
        "speed_minimum_rpm": rad_per_s_to_rpm(found.speed_minimum),
        "speed_maximum_rpm": rad_per_s_to_rpm(found.speed_maximum),
        "starts": found.starts,
        "iterations": found.iterations,
        "condition_number": found.condition_number,
        "estimates": [_estimate(one) for one in found.estimates],
    }


def quality_content(names: Sequence[str], qualities: Sequence[Quality]) -> list[dict[str, Any]]:
    """Return what there is to say of each run."""
    return [
        {"run": name, "findings": quality.findings, "left_out": quality.words or None}
        for name, quality in zip(names, qualities, strict=True)
    ]


def advice_content(helpful: Sequence[Benefit]) -> list[dict[str, Any]]:
    """Return what would help most: the factor on all standard errors together [-], and the speed or the probe."""
    return [
        {"what": one.what, "shrinkage": one.shrinkage}
        | ({"speed_rpm": rad_per_s_to_rpm(one.speed)} if isinstance(one, HelpfulSpeed) else {})
        | ({"probe": one.probe} if isinstance(one, HelpfulProbe) else {})
        for one in helpful
    ]


def since_content(since: UnbalanceSince, scale: DiscScale, *, direction: int) -> list[dict[str, Any]]:
    """Return the unbalance that each disc has gained since the calibration; angles from +x towards +y, and on the scale."""
    return [
        {
            "disc": disc,
            **_vector(complex(value)),
            "scale_deg": scale.reading(float(np.angle(value)), direction=direction),
            "standard_error_g_mm": GRAM_MILLIMETRES * since.standard_error(place),
            "half_width_g_mm": GRAM_MILLIMETRES * CONFIDENCE_95 * since.standard_error(place),
            "angle_half_width_deg": since.angle_error_deg(place),
        }
        for place, (disc, value) in enumerate(zip(since.discs, since.value, strict=True))
    ]


def model_content(model: Model, *, service_rpm: float, grade: float) -> dict[str, Any]:
    """Return critical speeds, peaks of the response, coupling loads, residual unbalance and correction at a speed [r/min]."""
    loads, correction = model.coupling_loads(service_rpm).si, model.balance(service_rpm).si
    return {
        "machine": model.machine.id,
        "service_rpm": service_rpm,
        "critical_speeds": critical_speed_content(model),
        "coupling_loads": [
            {"coupling": load.coupling, "load": name, "unit": unit, **_band(getattr(load, name))}
            for load in loads
            for name, unit in LOADS.items()
        ],
        "residual_unbalance": [
            {
                "shaft": rotor.shaft,
                "bearing": plane.bearing,
                **_vector(plane.unbalance),
                "grade": plane.grade,
                "iso_21940_11": plane.iso,
                "iso_permissible_g_mm": GRAM_MILLIMETRES * plane.iso_permissible,
                "api_617": plane.api,
                "api_permissible_g_mm": GRAM_MILLIMETRES * plane.api_permissible,
            }
            for rotor in model.balance_grades(service_rpm, grade=grade).si[0]
            for plane in rotor.planes
        ],
        "correction_at_service_speed": [
            {"disc": disc, **_vector(complex(value))}
            for disc, value in zip(correction.planes, correction.unbalance, strict=True)
        ],
        "response_peaks": [
            {
                "channel": channel,
                "rpm": rad_per_s_to_rpm(one.peak.speed),
                "amplification_factor": one.peak.amplification_factor,
                "separation_margin_per_cent": one.actual,
                "api_684_required_per_cent": one.required,
                "met": one.met,
            }
            for channel, one in response_peaks(model, service_rpm=service_rpm)
        ],
        **impact_test_content(model),
    }


def impact_test_content(model: Model) -> dict[str, Any]:
    """Return the frequencies of the document's impact test beside those of a model; nothing where there is no test."""
    if model.machine.impact_test is None:
        return {}
    found = compare_impact_test(model.updated, measured_frequencies(model.machine.impact_test))
    compared = [
        {
            "measured_hz": one.measured.frequency,
            "model_hz": one.model,
            "deviation": one.deviation,
            "standard_deviations": one.standard_deviations,
        }
        for one in found.compared
    ]
    return {"impact_test": {"compared": compared, "unmatched_hz": [one.frequency for one in found.unmatched]}}


def critical_speed_content(model: Model) -> list[dict[str, float]]:
    """Return the critical speeds of a model with their standard errors."""
    return [
        {
            "rpm": one.speed_rpm,
            "standard_error_rpm": one.standard_error_rpm,
            "log_decrement": one.log_decrement,
            "whirl": one.whirl,
        }
        for one in model.critical_speeds()
    ]


def comparison_content(found: ModelComparison) -> dict[str, Any]:
    """Return the verdict, the compared models, the best first, and its values at the coupling."""
    best = found.views[0].identification
    return {
        "coupling": found.coupling,
        "preferred": found.preferred,
        "verdict": found.verdict,
        "models": [
            {"name": one.name, "criterion": one.criterion, "unknowns": one.unknowns, "verdict": one.identification.verdict}
            for one in found.views
        ],
        "estimates": [
            _estimate(one) for one in best.estimates if one.element in found.elements and one.quantity != "unbalance"
        ],
    }


def slow_roll_content(machine: Machine, found: Capture) -> dict[str, Any]:
    """Return the vectors of a capture by channel, with the reasons of channels without one."""
    rows = zip(machine.channels, found.slow_roll.vector, found.slow_roll.standard_error, strict=True)
    return {
        "machine": machine.id,
        "samples": found.samples,
        "speed_minimum_rpm": rad_per_s_to_rpm(found.speed_minimum),
        "speed_maximum_rpm": rad_per_s_to_rpm(found.speed_maximum),
        "channels": [
            {"channel": channel, "reason": found.reasons[channel]}
            if channel in found.reasons
            else {
                "channel": channel,
                "um_pp": abs(vector) / MICROMETRES_PP,
                "standard_error_um_pp": error / MICROMETRES_PP,
                "lag_deg": float(-np.degrees(np.angle(vector)) % 360.0),
            }
            for channel, vector, error in rows
        ],
    }


def regression_content(machine: Machine, found: PublishedEstimate, *, accepted: bool) -> dict[str, Any]:
    """Return the values of the thesis's regression, which has no intervals."""
    return {
        "machine": machine.id,
        "accepted": accepted,
        "reduced_chi_square": found.reduced_chi_square,
        "not_positive": found.impossible,
        "condition_number": found.solution.condition_number_before,
        "regularisation": found.solution.parameter,
        "estimates": [
            {"name": name, "value": value, "unit": unit}
            for name, value, unit in zip(found.names, found.solution.values, found.units, strict=True)
        ],
    }


def _estimate(one: Estimate) -> dict[str, Any]:
    vector = (
        _vector(complex(one.value, one.imaginary))
        if one.quantity == "unbalance" and one.value is not None and one.imaginary is not None
        else {}
    )
    return {**structs.asdict(one), **vector}


def _band(band: PhasorBand) -> dict[str, float]:
    """Return a load at its one speed, 0-to-peak, with its 95 % band."""
    return {"amplitude": float(band.amplitude[0]), "lower": float(band.lower[0]), "upper": float(band.upper[0])}


def _vector(value: complex) -> dict[str, float]:
    """Return an unbalance [kg m] in g mm, and its angle from the keyphasor mark, +x to +y."""
    return {"g_mm": GRAM_MILLIMETRES * abs(value), "angle_deg": float(np.degrees(np.angle(value)) % 360.0)}
