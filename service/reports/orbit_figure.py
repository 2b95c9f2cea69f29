"""Orbits (1×) at stations whose probes see both axes, as the fit has them, now and in the baseline."""

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.phasors.probe_axes import ProbeStation
from service.reports.plot_frame import BEFORE, FITTED, GRID, INK, curve, dots, label, round_step, segment, svg
from service.wording.finding_words import rounded
from service.wording.language import ENGLISH, Language

SIZE, RADIUS = 164.0, 60.0
POINTS = 120
NAME_SIZE = 7.0
REACH = 50.0
"""Reach of the largest orbit: names of axes and of most probes stand outside of it [px]."""
BAR_AT = RADIUS + 24.0
"""Height of the scale's bar, below the name of a probe that looks upwards."""


def orbit_figure(place: ProbeStation, now: Complexes, before: Complexes | None, language: Language = ENGLISH) -> str:
    """Return a station's orbit with the keyphasor's dot. now, before: phasors (m,) of all channels, peak-to-peak in the
    readers' unit of lengths."""
    paths = [(colour, _path(place, one)) for colour, one in ((BEFORE, before), (FITTED, now)) if one is not None]
    largest = max(float(np.abs(one).max()) for _, one in paths)
    step = round_step(max(largest, 1e-9) / 2.0)
    scale = REACH / max(largest, step)
    parts = [segment(-RADIUS, 0, RADIUS, 0, GRID), segment(0, -RADIUS, 0, RADIUS, GRID)]
    parts += [label(RADIUS - 4, 9, "x"), label(6, -RADIUS + 6, "y")]
    for angle, channel in zip(place.angle, place.channels, strict=True):
        px, py = (RADIUS + 6) * np.cos(angle), -(RADIUS + 6) * np.sin(angle)
        parts.append(segment(0.93 * px, 0.93 * py, px, py, INK, width=2.0))
        parts.append(_name(float(px), float(py) + (10 if py > 0 else -4), channel))
    for colour, path in paths:
        parts.append(curve(path[:, 0] * scale, -path[:, 1] * scale, colour, dashed=colour == BEFORE))
        parts.append(dots(path[:1, 0] * scale, -path[:1, 1] * scale, colour, radius=2.6))
    bar = step * scale
    parts.append(segment(-bar / 2, BAR_AT, bar / 2, BAR_AT, INK, width=1.2))
    parts.append(label(bar / 2 + 4, BAR_AT + 3, f"{rounded(step, 1, language)} {language.length_unit}", anchor="start"))
    return svg("".join(parts), SIZE, SIZE / 2 + BAR_AT + 8, left=-SIZE / 2, top=-SIZE / 2)


def _name(x: float, y: float, channel: str) -> str:
    """Return the name of a probe; one that would go over the figure's edge lies within it."""
    within = SIZE / 2.0 - 0.32 * NAME_SIZE * len(channel)
    return label(float(np.clip(x, -within, within)) if within > 0.0 else 0.0, y, channel, size=NAME_SIZE)


def _path(place: ProbeStation, phasors: Complexes) -> Floats:
    """Return the path (POINTS, 2) from the keyphasor's pulse on: an orbit of 1 µm pp is a circle of that diameter."""
    axes = np.linalg.lstsq(place.directions, phasors[list(place.columns)], rcond=None)[0]
    turn = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, POINTS))
    return np.asarray(np.real(turn[:, None] * axes[None, :]) / 2.0)
