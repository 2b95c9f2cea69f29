"""Bode and polar plots of one channel: measured and fitted 1×, with the baseline's run where there is one."""

from collections.abc import Iterator

import numpy as np

from estimator.arrays import Complexes, Floats
from service.reports.plot_frame import (
    BEFORE,
    FITTED,
    GRID,
    INK,
    MEASURED,
    MOST_OF_A_CURVE,
    PlotAxis,
    PlotFrame,
    axis_over,
    curve,
    dots,
    label,
    plain_label,
    round_step,
    segment,
    svg,
    thinned_slice,
)
from service.reports.response_curves import MeasuredPoints, ResponseCurves, lag_deg
from service.wording.finding_words import rounded
from service.wording.language import ENGLISH, Language
from service.wording.shown_units import USUAL_UNITS, ShownUnits

WIDTH, AMPLITUDE_HEIGHT, PHASE_HEIGHT = 335.0, 130.0, 95.0
SIZE, RADIUS = 215.0, 82.0
LAGS = tuple((float(one), f"{one}°") for one in range(0, 361, 90))
SPEED_LABELS, WORDS_APART = 4, 18.0
"""Speeds that are written beside a curve, where they lie so far apart [px]."""


def bode_figure(
    number: int,
    curves: ResponseCurves,
    runs: list[MeasuredPoints],
    before: list[MeasuredPoints],
    language: Language = ENGLISH,
    units: ShownUnits = USUAL_UNITS,
) -> str:
    """Return amplitude above phase lag over speed of a channel. units: those that the curves are in."""
    shown = [abs(curves.value[:, number]), *(abs(one.value[:, number]) for one in (*runs, *before))]
    speeds = axis_over(np.concatenate([curves.speed, *(one.speed for one in (*runs, *before))]), "", language)
    amplitudes = axis_over(np.concatenate(shown), f"1× [{units.amplitude_label()}]", language, from_zero=True)
    above = PlotFrame(speeds, amplitudes, width=WIDTH, height=AMPLITUDE_HEIGHT)
    named = PlotAxis(speeds.low, speeds.high, speeds.ticks, units.speed_label(language))
    lags = PlotAxis(0.0, 360.0, LAGS, language.translate("plot.lag"))
    below = PlotFrame(named, lags, width=WIDTH, height=PHASE_HEIGHT)
    above.between(curves.speed, curves.lower[:, number], curves.upper[:, number], FITTED)
    for colour, drawn in ((BEFORE, before), (MEASURED, runs)):
        for one in drawn:
            above.points(one.speed, np.abs(one.value[:, number]), colour)
            below.points(one.speed, lag_deg(one.value[:, number]), colour)
    above.line(curves.speed, np.abs(curves.value[:, number]), FITTED)
    below.line(curves.speed, curves.lag[:, number], FITTED)
    return above.drawing() + below.drawing()


def polar_figure(
    number: int,
    curves: ResponseCurves,
    runs: list[MeasuredPoints],
    before: list[MeasuredPoints],
    language: Language = ENGLISH,
    units: ShownUnits = USUAL_UNITS,
) -> str:
    """Return the 1× vectors of a channel; lag grows clockwise from the right, as on the page.

    units: those that the curves are in.
    """
    fitted = curves.value[:, number]
    sizes = np.abs(np.concatenate([fitted, *(one.value[:, number] for one in (*runs, *before))]))
    largest = float(np.nanmax(sizes)) if np.isfinite(sizes).any() else 1.0
    step = round_step(max(largest, 1e-9) / 3.0)
    rings = max(1, int(np.ceil(largest / step)))
    scale = RADIUS / (rings * step)
    parts = [_ring((ring + 1) * step * scale) for ring in range(rings)]
    parts += [segment(-RADIUS, 0.0, RADIUS, 0.0, GRID), segment(0.0, -RADIUS, 0.0, RADIUS, GRID)]
    parts += [label(RADIUS + 12, 3, "0°"), label(0, RADIUS + 11, "90°"), label(-RADIUS - 13, 3, "180°")]
    parts.append(label(0, -RADIUS - 4, "270°"))
    rings_of = language.translate("plot.rings", step=rounded(step, 1, language), unit=units.amplitude_label())
    parts.append(label(-SIZE / 2, -SIZE / 2 + 8, rings_of, anchor="start"))
    for colour, drawn in ((BEFORE, before), (MEASURED, runs)):
        parts += [dots(*_place(one.value[thinned_slice(one.speed.size), number], scale), colour) for one in drawn]
    few = thinned_slice(fitted.size, MOST_OF_A_CURVE)
    parts.append(curve(*_place(fitted[few], scale), FITTED))
    parts += _speeds(fitted, curves.speed, scale, units, language)
    return svg("".join(parts), SIZE, SIZE, left=-SIZE / 2, top=-SIZE / 2)


def _speeds(fitted: Complexes, speed: Floats, scale: float, units: ShownUnits, language: Language) -> Iterator[str]:
    """Yield dots with their speeds on a curve, outwards of it and on white; no words over others."""
    said: list[complex] = []
    for asked in np.linspace(speed[0], speed[-1], SPEED_LABELS):
        at = int(np.argmin(abs(speed - asked)))
        px, py = _place(fitted[at : at + 1], scale)
        yield dots(px, py, FITTED, radius=2.0)
        place = complex(px[0], py[0])
        if all(abs(place - other) > WORDS_APART for other in said):
            said.append(place)
            away = place / max(abs(place), 1e-9)
            anchor = "start" if away.real >= 0.0 else "end"
            words = units.speed_number(float(speed[at]) / units.speed_factor(), language)
            yield plain_label(px[0] + 5 * away.real, py[0] + 8 * away.imag + 2.5, words, anchor=anchor)


def _place(value: Complexes, scale: float) -> tuple[Floats, Floats]:
    """Return places [px] with lag clockwise: the screen's y points down, as lags grow."""
    return value.real * scale, -value.imag * scale


def _ring(radius: float) -> str:
    colour = INK if radius >= RADIUS - 0.1 else GRID
    return f'<circle r="{radius:.1f}" cx="0" cy="0" fill="none" stroke="{colour}" stroke-width="0.6"/>'
