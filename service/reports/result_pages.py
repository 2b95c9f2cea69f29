"""The pages of a report behind the first one: trends, Bode, polar, orbits, centreline, alignment, balance, history.

What cannot be computed is said to be missing in its place, with the reason; the rest is told all the same.
"""

import logging
from collections.abc import Callable, Sequence

import numpy as np

from estimator.alignment.alignment_change import alignment_changes
from estimator.alignment.tolerance import ToleratedChange, tolerated_changes
from estimator.machine.film_speeds import follows_films
from estimator.machine.parameter_description import describe
from estimator.machine.train_layout import shaft_begins
from estimator.phasors.probe_axes import probe_stations
from estimator.units import RAD_PER_S
from estimator.updated_model.balancing import balance
from service.identification.stored_model import Identified
from service.reports.centreline_figure import centreline_figure, journal_paths
from service.reports.contents import ReportContents, ReportedFit
from service.reports.orbit_figure import orbit_figure
from service.reports.page_parts import captioned, figures, muted, section, shown_time, table
from service.reports.response_curves import measured_points, response_curves
from service.reports.response_figures import bode_figure, polar_figure
from service.reports.trend_figure import trend_figure

logger = logging.getLogger(__name__)

MOST_CHANNELS = 12
"""Channels that are drawn: those nearest to what has an alert first."""
BALANCE_SPEEDS = 20
MILLIMETRES_GRAM = 1e6
"""g mm in a kg m."""


def result_pages(contents: ReportContents) -> str:
    """Return the pages."""
    parts = [section("Trends", _trends(contents))]
    fit = contents.fit
    if fit is not None:
        with_fit: Sequence[tuple[str, Callable[[ReportContents, ReportedFit], str]]] = (
            ("Vibration over speed (1×)", _responses),
            ("Orbits", _orbits),
            ("Shaft centreline", _centrelines),
            ("Alignment", _alignment),
            ("Balance", _balance),
        )
        parts += [section(title, _made(title, part, contents, fit)) for title, part in with_fit]
    return "".join(parts)


def _made(title: str, part: Callable[[ReportContents, ReportedFit], str], contents: ReportContents, fit: ReportedFit) -> str:
    try:
        return part(contents, fit)
    except (ValueError, ArithmeticError, np.linalg.LinAlgError) as error:
        logger.warning("report of %s: %s cannot be computed: %s", contents.machine.id, title, error)
        return muted(f"This cannot be computed from identification {fit.one.id}: {error}")


def _trends(contents: ReportContents) -> str:
    drawn = "".join(captioned(one.name, trend_figure(one)) for one in contents.trends)
    return drawn and figures("Points with 95 % intervals; the band holds 95 % of what the baseline lets expect.", drawn)


def _responses(contents: ReportContents, fit: ReportedFit) -> str:
    curves = response_curves(fit.one)
    runs, before = ([measured_points(one) for one in each] for each in (fit.runs, fit.reference))
    if fit.reference and fit.reference[0].machine.channels != fit.one.machine.channels:
        before = []
    shown = _channels(contents, fit)
    names = fit.one.machine.channels
    drawn = "".join(
        captioned(f"Bode, {names[number]}", bode_figure(number, curves, runs, before)) for number in shown
    ) + "".join(captioned(f"Polar, {names[number]}", polar_figure(number, curves, runs, before)) for number in shown)
    compared = f", brown points: baseline, identification {fit.baseline[0].id}" if before else ""
    key = f"Grey points: measured, run of {shown_time(fit.measured_at)}; blue: fit with 95 % band{compared}."
    more = f" {len(names) - len(shown)} channels are not shown." if len(names) > len(shown) else ""
    return figures(key + more, drawn)


def _channels(contents: ReportContents, fit: ReportedFit) -> list[int]:
    """Return the numbers of the channels that are drawn; those at the shafts and places of open alerts first."""
    machine = fit.one.machine
    begins = shaft_begins(machine)
    places = {f"coupling.{one.id}": begins[one.driven] for one in machine.couplings}
    for kind, parts in (("bearing", machine.bearings), ("disc", machine.discs), ("seal", machine.seals)):
        places |= {f"{kind}.{one.id}": begins[one.shaft] + one.station for one in parts}
    alerted = [places[one.last.element] for one in contents.open_alerts if one.last.element in places][:1]
    probes = [begins[one.shaft] + one.station for one in machine.probes]
    order = sorted(range(len(probes)), key=lambda number: abs(probes[number] - alerted[0]) if alerted else number)
    return order[:MOST_CHANNELS]


def _orbits(_contents: ReportContents, fit: ReportedFit) -> str:
    places = [one for one in probe_stations(fit.one.machine) if one.sees_both_axes][:MOST_CHANNELS]
    if not places:
        return ""
    rpm = _running_rpm(fit)
    now = response_curves(fit.one, np.array([rpm])).value[0]
    first = fit.baseline[0] if fit.baseline else None
    alike = first is not None and first.machine.channels == fit.one.machine.channels
    before = response_curves(first, np.array([rpm])).value[0] if first is not None and alike else None
    drawn = "".join(captioned(", ".join(one.channels), orbit_figure(one, now, before)) for one in places)
    key = f"1× at {rpm:.0f} r/min by the fit; dot: keyphasor; bars: probes"
    return figures(key + ("; brown, dashed: baseline." if before is not None else "."), drawn)


def _running_rpm(fit: ReportedFit) -> float:
    """Return the speed at which the machine works; the highest of the fit where its document does not say, or beyond it."""
    highest = fit.one.speed_maximum / RAD_PER_S["rpm"]
    return min(fit.one.machine.operation.running_rpm or highest, highest)


def _centrelines(_contents: ReportContents, fit: ReportedFit) -> str:
    paths = journal_paths(fit.one)
    if not paths:
        return ""
    first = journal_paths(fit.baseline[0]) if fit.baseline else []
    before = {one.bearing: one for one in first}
    ends = (fit.one.speed_minimum / RAD_PER_S["rpm"], fit.one.speed_maximum / RAD_PER_S["rpm"])
    drawn = "".join(captioned(one.bearing, centreline_figure(one, before.get(one.bearing), ends)) for one in paths)
    key = "Journals in their clearance by the model of the films; numbers: r/min, dot: highest speed"
    return figures(key + ("; brown, dashed: baseline." if first else "."), drawn)


def _alignment(_contents: ReportContents, fit: ReportedFit) -> str:
    if not follows_films(fit.one.machine) or not fit.baseline:
        return ""
    models = [one.model for one in fit.baseline]
    if any(one.coordinates != fit.one.model.coordinates for one in models):
        return muted("The baseline was identified with other unknowns: identify its runs again.")
    changes = tolerated_changes(fit.one.machine, alignment_changes(models, fit.one.model))
    heads = ("coupling", "of", "change against the baseline", "95 % ±", "allowed", "chance of more")
    return table(heads, [_aligned(one) for one in changes]) if changes else ""


def _aligned(one: ToleratedChange) -> tuple[str, ...]:
    said = describe(one.name)
    scale, unit = (1e6, "µm") if one.unit == "m" else (1e3, "mrad")
    allowed = f"{scale * one.allowed:.3g} {unit}"
    if one.value is None:
        return said.element_id, said.quantity.replace("_", " "), f"not determined: {one.reason}", "–", allowed, "–"
    change, half = f"{scale * one.value:+.3g} {unit}", f"{scale * one.half:.2g} {unit}"
    return said.element_id, said.quantity.replace("_", " "), change, half, allowed, f"{100.0 * one.beyond:.0f} %"


def _balance(contents: ReportContents, fit: ReportedFit) -> str:
    rows = [(shown_time(one.at), one.by, one.state, one.comment) for one in contents.balancings]
    done = table(("Field balancing", "begun by", "step", "comment"), rows) if rows else ""
    return done + _proposal(contents, fit.one)


def _proposal(contents: ReportContents, one: Identified) -> str:
    """Return what the model proposes; nothing to correct while an open alert names another cause."""
    if contents.not_to_balance is not None:
        return muted(f"No correction is proposed: {contents.not_to_balance}.")
    if not one.machine.discs:
        return ""
    speed = np.linspace(one.speed_minimum, one.speed_maximum, BALANCE_SPEEDS)
    found = balance(one.model, planes=[disc.id for disc in one.machine.discs], speed=speed)
    before, after = (float(np.abs(each.value).max()) for each in (found.before, found.after))
    rows = [
        (plane, f"{MILLIMETRES_GRAM * abs(mass):.3g} g mm", f"{np.degrees(np.angle(mass)) % 360.0:.0f}°")
        for plane, mass in zip(found.planes, found.unbalance.tolist(), strict=True)
    ]
    told = f"By the model, the largest 1× over the speeds falls from {2e6 * before:.3g} to {2e6 * after:.3g} µm pp."
    return table(("plane", "correction", "angle from x with the rotation"), rows) + muted(told)
