"""Renders identifications, advice, the unbalance gained since a calibration and comparisons as text for a terminal."""

import cmath
from collections.abc import Sequence

import numpy as np

from estimator.calibration.unbalance_since import UnbalanceSince
from estimator.fit.estimates import CONFIDENCE_95, Estimate
from estimator.fit.identification import Identification
from estimator.identification.experiment_design import Benefit, helpful_probes, helpful_speeds
from estimator.machine.disc_scale import DiscScale
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement
from estimator.phasors.quality import Quality
from estimator.phasors.slow_roll import Capture
from estimator.thesis.machine_regression import PublishedEstimate
from estimator.units import METRES, PEAK, rad_per_s_to_rpm, rpm_to_rad_per_s
from rotorundown.summaries.estimate_summary import ERRORS, REFUSED_VALUES, element_lines, sample_words
from rotorundown.summaries.estimate_words import GRAM_MILLIMETRES, angle_half_words, estimate_words

CANDIDATE_SPEEDS = 60
EXPLAINED = 2.0
"""Largest χ²/dof at which the regression's values count as explaining a run."""


def quality_text(names: Sequence[str], qualities: Sequence[Quality], *, gate: bool) -> str:
    """Describe the quality of each run before it is identified; empty where there is nothing to report."""
    lines = []
    for name, quality in zip(names, qualities, strict=True):
        found = [*quality.findings, *([quality.words] if gate and quality.words else [])]
        lines += [f"{name}: {words}" for words in found]
    return "\n".join(lines)


def verdict_text(result: Identification) -> str:
    """Return the verdict, which says first where a fit is refused."""
    return result.verdict if result.accepted else f"NOT ACCEPTED, not to be used: {result.verdict}"


def identification_text(machine: Machine, result: Identification, *, every: bool) -> str:
    """Return the verdict and estimates of a machine ± standard error, under a heading of their own where refused.

    every: give each parameter a line, and the reason of one that is not estimable, where else each element has one.
    """
    lines = [
        verdict_text(result),
        f"{sample_words(result, machine)}; {result.starts} start{'' if result.starts == 1 else 's'}, "
        f"{result.iterations} iterations; condition number {result.condition_number:.2g}",
        *(("",) if result.accepted else ("", REFUSED_VALUES)),
    ]
    return "\n".join(lines + (_parameter_lines(result.estimates) if every else _summary_lines(result.estimates)))


def _parameter_lines(estimates: Sequence[Estimate]) -> list[str]:
    width = max(len(estimate.name) for estimate in estimates)
    return [ERRORS, *(f"{estimate.name:<{width}}  {estimate_words(estimate)}" for estimate in estimates)]


def _summary_lines(estimates: Sequence[Estimate]) -> list[str]:
    return [*element_lines(estimates), "", "All parameters, a line each: --all; for a program: --json"]


def find_helpful(machine: Machine, result: Identification, measurement: Measurement) -> list[Benefit]:
    """Return the additional speeds and probes that would help most."""
    limits = machine.speed_range
    lowest, highest = rpm_to_rad_per_s(limits.minimum_rpm), rpm_to_rad_per_s(limits.maximum_rpm)
    speeds = helpful_speeds(machine, result, candidates=np.linspace(lowest, highest, CANDIDATE_SPEEDS))
    probes = helpful_probes(machine, result, measurement)
    return [*speeds, *probes]


def advice_text(helpful: Sequence[Benefit]) -> str:
    """Return what would help most, with its effect, a line each."""
    lines = ["", "What would help most, and by how much the standard errors would shrink together:"]
    return "\n".join([*lines, *(f"  {one.what}: by {100 * (1 - one.shrinkage):.1f} %" for one in helpful)])


def since_text(since: UnbalanceSince, scale: DiscScale, *, direction: int, beyond: str = "", accepted: bool = True) -> str:
    """Return the unbalance gained since the calibration, a line per disc, with 95 % intervals, angles on the discs' scale.

    beyond: the weights that were stated, which are not part of it. accepted: whether the fit may be used.
    """
    counted = "from +x towards +y" if scale == DiscScale() else f"on the discs' scale, {scale.counted}"
    refused = "" if accepted else "NOT TO BE USED, the fit is refused. "
    of = "(± 95 %, with the calibration's uncertainty and that of a new mounting)"
    heading = f"{refused}Unbalance gained since the calibration{beyond} {of}"
    lines = ["", f"{heading}, angles {counted}"]
    for place, (disc, value) in enumerate(zip(since.discs, since.value, strict=True)):
        half = CONFIDENCE_95 * since.standard_error(place) * GRAM_MILLIMETRES
        size, open_angle = abs(value) * GRAM_MILLIMETRES, since.angle_error_deg(place)
        reading = _reading(complex(value), scale, direction)
        angle = f"{reading} ± {angle_half_words(open_angle)}°" if open_angle < 180.0 else f"{reading}°, which is left open"
        lines.append(f"  {disc:<12} {size:9.3f} ± {half:.3f} g mm at {angle}")
    return "\n".join(lines)


def beyond_stated_weights(machine: Machine, measurement: Measurement, scale: DiscScale, *, direction: int) -> str:
    """Return a clause naming the trial weights that a run states and its unbalances leave out; empty without any."""
    added = measurement.added
    if added is None or not np.any(added):
        return ""
    if np.any(added != added[0]):
        return ", beyond the weights that the sidecar states for each row"
    weights = [
        f"{disc.id} {GRAM_MILLIMETRES * abs(value):.4g} g mm at {_reading(complex(value), scale, direction)}°"
        for disc, value in zip(machine.discs, added[0], strict=True)
        if value
    ]
    return f", beyond the weights that the sidecar states: {' and '.join(weights)}"


def _reading(value: complex, scale: DiscScale, direction: int) -> str:
    """Return the angle of an unbalance on the discs' scale [°]."""
    return f"{round(scale.reading(cmath.phase(value), direction=direction), 1) % 360.0:.1f}"  # not 360.0


def regression_text(found: PublishedEstimate) -> str:
    """Return the values of the thesis's regression, which has no intervals."""
    solution = found.solution
    regularised = f", regularised with λ = {solution.parameter:.2g}" if solution.parameter else ""
    explained = found.reduced_chi_square <= EXPLAINED and not found.impossible
    verdict = f"χ²/dof of the machine with these values against the run {found.reduced_chi_square:.3g}"
    if found.impossible:
        verdict += f"; not positive, as they must be: {', '.join(found.impossible)}"
    lines = [
        verdict if explained else f"NOT TO BE USED: these values do not explain the run, {verdict}",
        "Regression of the thesis, Chapter 4: no intervals, biased by noise; see the evidence page",
        f"condition number {solution.condition_number_before:.2g}, {solution.condition_number_after:.2g} after column scaling"
        + regularised,
        "",
    ]
    width = max(len(name) for name in found.names)
    rows = zip(found.names, solution.values, found.units, strict=True)
    return "\n".join(lines + [f"{name:<{width}}  {value:+.4e} {unit}" for name, value, unit in rows])


def slow_roll_text(machine: Machine, found: Capture) -> str:
    """Return the vectors of a capture, a line per channel, with the reasons of channels without one."""
    speeds = f"{rad_per_s_to_rpm(found.speed_minimum):.0f} to {rad_per_s_to_rpm(found.speed_maximum):.0f} r/min"
    lines = [f"Slow-roll vectors ± standard error from {found.samples} samples, {speeds}"]
    width = max(map(len, machine.channels))
    scale = METRES["um"] * PEAK["peak-to-peak"]
    for channel, vector, error in zip(machine.channels, found.slow_roll.vector, found.slow_roll.standard_error, strict=True):
        if channel in found.reasons:
            lines.append(f"  {channel:<{width}}  none: {found.reasons[channel]}")
        else:
            lag = round(float(-np.degrees(np.angle(vector))) % 360.0, 1) % 360.0  # not 360.0 for nearly a full turn
            lines.append(f"  {channel:<{width}}  {abs(vector) / scale:8.3f} ± {error / scale:.2g} µm pp, lag {lag:6.1f}°")
    return "\n".join(lines)
