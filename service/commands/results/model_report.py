"""Reports results of an updated model on a terminal: critical speeds, margins, loads, balance, impact test."""

import math
from collections.abc import Iterator

import numpy as np

from estimator.arrays import Floats
from estimator.balancing.balance_quality import balance_grades
from estimator.balancing.model_balancing import balance
from estimator.modes.critical_speed import CriticalSpeed
from estimator.units import METRES, PEAK, rad_per_s_to_rpm, rpm_to_rad_per_s
from estimator.updated_model.amplification import SeparationMargin
from estimator.updated_model.coupling_loads import coupling_forces
from estimator.updated_model.impact_comparison import compare_impact_test, measured_frequencies
from estimator.updated_model.modal_uncertainty import critical_speed_errors
from estimator.updated_model.model import UpdatedModel
from rotorundown.machine_model import Model
from service.commands.results.film_report import identified_films, identified_stability
from service.commands.results.response_peaks import response_peaks


def model_text(model: Model, *, service_rpm: float, grade: float) -> str:
    """Return the report. service_rpm: the machine's service speed [r/min]; grade: required balance quality G [mm/s].

    Raises ValueError for a speed or grade that is not positive.
    """
    updated, speed = model.updated, rpm_to_rad_per_s(service_rpm)
    parts = (
        identified_films(updated),
        identified_stability(updated),
        _critical_speeds(updated, model.critical_speeds().si),
        _peaks(response_peaks(model, service_rpm=service_rpm)),
        _coupling_loads(updated, speed),
        _balance(updated, grade, speed),
        _correction(updated, speed),
        impact_test_lines(updated),
    )
    return "\n\n".join("\n".join(part) for part in map(list, parts) if part)


def _critical_speeds(model: UpdatedModel, found: tuple[CriticalSpeed, ...]) -> Iterator[str]:
    yield "Critical speeds [r/min], log decrement, whirl (+1 forward to -1 backward)"
    for one, error in zip(found, critical_speed_errors(model, found), strict=True):
        rpm = f"{rad_per_s_to_rpm(one.speed):8.0f} ± {rad_per_s_to_rpm(float(error)):.1f}"
        yield f"  {rpm:<18} {one.log_decrement:6.3f} {one.whirl:+6.2f}"


def _peaks(found: list[tuple[str, SeparationMargin]]) -> Iterator[str]:
    yield "Response peaks: channel, speed [r/min], amplification factor, separation margin and what API 684 asks [%]"
    for channel, one in found:
        factor = one.peak.amplification_factor
        asked = "none asked" if one.required is None else f"{one.required:.1f} asked"
        verdict = {True: "met", False: "NOT MET", None: "open"}[one.met]
        yield (
            f"  {channel:<12} {rad_per_s_to_rpm(one.peak.speed):7.0f} "
            f"{'-' if factor is None else f'{factor:.1f}':>6} {one.actual:6.1f}, {asked}, {verdict}"
        )


def _coupling_loads(model: UpdatedModel, speed: float) -> Iterator[str]:
    if not model.machine.couplings:
        return
    yield f"Synchronous load of the couplings at {rad_per_s_to_rpm(speed):.0f} r/min, 0-to-peak with 95 % band"
    for one in coupling_forces(model, speed=np.array([speed])):
        for name, unit in (("force_x", "N"), ("force_y", "N"), ("moment_x", "N m"), ("moment_y", "N m")):
            band = getattr(one, name)
            low, high = float(band.lower[0]), float(band.upper[0])
            yield f"  {one.coupling:<12} {name:<9} {float(band.amplitude[0]):10.4g} {unit}, {low:.4g} to {high:.4g}"


def _balance(model: UpdatedModel, grade: float, speed: float) -> Iterator[str]:
    yield f"Residual unbalance in the bearing planes against ISO 21940-11 G {grade:g} and API 617 4W/N"
    for rotor in balance_grades(model, grade=grade, service_speed=speed, maximum_continuous_speed=speed):
        for plane in rotor.planes:
            yield (
                f"  {rotor.shaft:<12} {plane.bearing:<8} {1e6 * abs(plane.unbalance):10.0f} g mm, G {plane.grade:.3g}; "
                f"ISO {plane.iso} ({1e6 * plane.iso_permissible:.0f}), API {plane.api} ({1e6 * plane.api_permissible:.0f})"
            )


def _correction(model: UpdatedModel, speed: float) -> Iterator[str]:
    planes = [disc.id for disc in model.machine.discs]
    found = balance(model, planes=planes, speed=_balancing_speeds(model, speed))
    yield "Correction that leaves least vibration over the speeds to service: plane, unbalance to add [g mm] at angle [°]"
    for plane, unbalance in zip(found.planes, found.unbalance, strict=True):
        yield f"  {plane:<12} {1e6 * abs(unbalance):10.0f} {math.degrees(np.angle(unbalance)) % 360:7.1f}"
    micrometres = METRES["um"] * PEAK["peak-to-peak"]
    before, after = (float(np.max(part)) / micrometres for part in (found.before.amplitude, found.after.upper))
    yield f"  largest vibration at the probes {before:.3g} µm pp, afterwards at most {after:.3g} µm pp"
    yield f"  condition number of the influence coefficients {found.condition_number:.3g}"


def _balancing_speeds(model: UpdatedModel, speed: float) -> Floats:
    """Return speeds up to the service speed, inside the document's range."""
    limits = model.machine.speed_range
    lowest, highest = rpm_to_rad_per_s(limits.minimum_rpm), rpm_to_rad_per_s(limits.maximum_rpm)
    return np.linspace(lowest, min(max(speed, lowest), highest), 30)


def impact_test_lines(model: UpdatedModel) -> Iterator[str]:
    """Yield the frequencies of a document's impact test beside those of a model; nothing where there is no test.

    Args:
        model: The model.

    Yields:
        A heading and a line per frequency.
    """
    if model.machine.impact_test is None:
        return
    found = compare_impact_test(model, measured_frequencies(model.machine.impact_test))
    yield "Impact test: measured and model [Hz], deviation [%], in standard deviations"
    for one in found.compared:
        sigma = "-" if one.standard_deviations is None else f"{one.standard_deviations:+.1f}"
        yield f"  {one.measured.frequency:9.2f} {one.model:9.2f} {100 * one.deviation:+7.2f} {sigma:>7}"
    yield from (f"  {one.frequency:9.2f}  no mode of the model within 25 %" for one in found.unmatched)
