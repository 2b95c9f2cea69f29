"""The pages of a report behind the first one: trends, Bode, polar, orbits, centreline, alignment, balance, history.

What cannot be computed is said to be missing in its place, with the reason; the rest is told all the same.
"""

import logging
from collections.abc import Callable, Sequence

import numpy as np

from estimator.balancing.model_balancing import balance
from estimator.machine.film_speeds import follows_films
from estimator.machine.train_layout import shaft_begins
from estimator.phasors.probe_axes import probe_stations
from estimator.units import RAD_PER_S
from service.identification.stored_model import Identified
from service.reports.alignment_page import alignment_page
from service.reports.centreline_figure import centreline_figure, journal_paths
from service.reports.contents import ReportContents, ReportedFit
from service.reports.orbit_figure import orbit_figure
from service.reports.page_parts import captioned, figures, muted, section, shown_time, table
from service.reports.response_curves import MICROMETRES_PP, measured_points, response_curves
from service.reports.response_figures import bode_figure, polar_figure
from service.reports.trend_figure import trend_figure
from service.wording.finding_words import rounded, whole_degrees
from service.wording.parameter_words import parameter_words
from service.wording.stored_sentences import in_language

logger = logging.getLogger(__name__)

MOST_CHANNELS = 12
"""Channels that are drawn: those nearest to what has an alert first."""
BALANCE_SPEEDS = 20
MILLIMETRES_GRAM = 1e6
"""g mm in a kg m."""


def result_pages(contents: ReportContents) -> str:
    """Return the pages."""
    translate = contents.language.translate
    parts = [section(translate("report.trends"), _trends(contents))]
    fit = contents.fit
    if fit is not None:
        with_fit: Sequence[tuple[str, Callable[[ReportContents, ReportedFit], str]]] = (
            (translate("report.responses"), _responses),
            (translate("report.orbits"), _orbits),
            (translate("report.centreline"), _centrelines),
            (translate("report.alignment"), alignment_page),
            (translate("report.balance"), _balance),
        )
        parts += [section(title, _render(title, part, contents, fit)) for title, part in with_fit]
    return "".join(parts)


def _render(title: str, part: Callable[[ReportContents, ReportedFit], str], contents: ReportContents, fit: ReportedFit) -> str:
    try:
        return part(contents, fit)
    except (ValueError, ArithmeticError, np.linalg.LinAlgError) as error:
        logger.warning("report of %s: %s cannot be computed: %s", contents.machine.id, title, error)
        reason = in_language(str(error), contents.language)
        return muted(contents.language.translate("report.not_computed", id=fit.one.id, reason=reason))


def _trends(contents: ReportContents) -> str:
    drawn = "".join(
        captioned(parameter_words(one.name, contents.language), trend_figure(one, contents.language))
        for one in contents.trends
    )
    return drawn and figures(contents.language.translate("report.trend_key"), drawn)


def _responses(contents: ReportContents, fit: ReportedFit) -> str:
    units = contents.units
    curves = response_curves(fit.one).shown_in(units)
    runs, before = ([measured_points(one).shown_in(units) for one in each] for each in (fit.runs, fit.reference))
    if fit.reference and fit.reference[0].machine.channels != fit.one.machine.channels:
        before = []
    shown = _channels(contents, fit)
    names = fit.one.machine.channels
    language = contents.language
    drawn = "".join(
        captioned(
            language.translate(f"report.{kind}", channel=names[number]), draw(number, curves, runs, before, language, units)
        )
        for kind, draw in (("bode", bode_figure), ("polar", polar_figure))
        for number in shown
    )
    at = shown_time(fit.measured_at)
    if before:
        key = language.translate("report.response_key_compared", at=at, id=fit.baseline[0].id)
    else:
        key = language.translate("report.response_key", at=at)
    more = language.translate("report.channels_left", count=len(names) - len(shown)) if len(names) > len(shown) else ""
    return figures(key + more, drawn)


def _channels(contents: ReportContents, fit: ReportedFit) -> list[int]:
    """Return the numbers of the channels that are drawn; those at the shafts and places of open alerts first."""
    machine = fit.one.machine
    begins = shaft_begins(machine)
    places = {f"coupling.{one.id}": begins[one.driven] for one in machine.couplings}
    for kind, parts in (("bearing", machine.bearings), ("disc", machine.discs), ("seal", machine.seals)):
        places |= {f"{kind}.{one.id}": begins[one.shaft] + one.station for one in parts}
    probes = [begins[one.shaft] + one.station for one in machine.probes]
    places |= {f"pedestal.{one.id}": places[f"bearing.{one.bearing}"] for one in machine.pedestals}
    places |= {f"probe.{one.id}": place for one, place in zip(machine.probes, probes, strict=True)}
    alerted = [places[one.last.element] for one in contents.open_alerts if one.last.element in places][:1]
    order = sorted(range(len(probes)), key=lambda number: abs(probes[number] - alerted[0]) if alerted else number)
    return order[:MOST_CHANNELS]


def _orbits(contents: ReportContents, fit: ReportedFit) -> str:
    places = [one for one in probe_stations(fit.one.machine) if one.sees_both_axes][:MOST_CHANNELS]
    if not places:
        return muted(contents.language.translate("report.no_orbit"))
    rpm = _running_rpm(fit)
    scale = contents.units.in_length(1.0)
    now = scale * response_curves(fit.one, np.array([rpm])).value[0]
    first = fit.baseline[0] if fit.baseline else None
    alike = first is not None and first.machine.channels == fit.one.machine.channels
    before = scale * response_curves(first, np.array([rpm])).value[0] if first is not None and alike else None
    drawn = "".join(captioned(", ".join(one.channels), orbit_figure(one, now, before, contents.language)) for one in places)
    key = "report.orbit_key" if before is None else "report.orbit_key_compared"
    return figures(contents.language.translate(key, speed=contents.units.speed(rpm, contents.language)), drawn)


def _running_rpm(fit: ReportedFit) -> float:
    """Return the speed at which the machine works; the highest of the fit where its document names none, or one beyond it."""
    highest = fit.one.speed_maximum / RAD_PER_S["rpm"]
    return min(fit.one.machine.operation.running_rpm or highest, highest)


def _centrelines(contents: ReportContents, fit: ReportedFit) -> str:
    paths = journal_paths(fit.one)
    if not paths:
        why = "report.no_equilibrium" if follows_films(fit.one.machine) else "report.no_centreline"
        return muted(contents.language.translate(why))
    first = journal_paths(fit.baseline[0]) if fit.baseline else []
    before = {one.bearing: one for one in first}
    ends = (fit.one.speed_minimum / RAD_PER_S["rpm"], fit.one.speed_maximum / RAD_PER_S["rpm"])
    language, units = contents.language, contents.units
    drawn = "".join(
        captioned(one.bearing, centreline_figure(one, before.get(one.bearing), ends, language, units)) for one in paths
    )
    key = "report.centreline_key_compared" if first else "report.centreline_key"
    return figures(language.translate(key, unit=units.speed_label(language)), drawn)


def _balance(contents: ReportContents, fit: ReportedFit) -> str:
    language = contents.language
    rows = [(shown_time(one.at), one.by, language.named(one.state), one.comment) for one in contents.balancings]
    heads = [language.translate(f"report.{one}") for one in ("field_balancing", "begun_by", "step", "comment")]
    done = table(heads, rows) if rows else ""
    return done + _proposal(contents, fit.one)


def _proposal(contents: ReportContents, one: Identified) -> str:
    """Return what the model proposes; nothing to correct while an open alert names another cause."""
    if contents.not_to_balance is not None:
        return muted(contents.language.translate("report.no_correction", reason=contents.not_to_balance))
    if not one.machine.discs:
        return ""
    language = contents.language
    speed = np.linspace(one.speed_minimum, one.speed_maximum, BALANCE_SPEEDS)
    found = balance(one.model, planes=[disc.id for disc in one.machine.discs], speed=speed)
    before, after = float(np.abs(found.before.value).max()), float(found.after.upper.max())
    rows = [
        (plane, f"{rounded(MILLIMETRES_GRAM * abs(mass), 3, language)} g mm", f"{whole_degrees(np.degrees(np.angle(mass)))}°")
        for plane, mass in zip(found.planes, found.unbalance.tolist(), strict=True)
    ]
    said = {"before": before, "after": after}
    told = language.translate(
        "report.falls" if after < before else "report.falls_uncertain",
        unit=contents.units.amplitude_label(),
        **{name: rounded(contents.units.amplitude_factor() * one / MICROMETRES_PP, 3, language) for name, one in said.items()},
    )
    sense = "positive" if one.direction > 0 else "negative"
    heads = [language.translate(f"report.{head}") for head in ("plane", "correction", f"angle.{sense}")]
    return table(heads, rows) + muted(told)
