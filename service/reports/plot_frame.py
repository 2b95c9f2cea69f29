"""Frames of plots as SVG: axes with ticks, and lines, points and bands within them. No more is drawn than paper can show.

Styles are attributes of the elements: what prints the page applies no style sheet to drawings in it.
"""

import html
import math
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np

from estimator.arrays import Floats
from service.wording.language import ENGLISH, Language

INK, GRID, MEASURED, FITTED, BEFORE, MARKED = "#333333", "#d5d9de", "#6b7280", "#1f5a93", "#9a5b00", "#b3261e"
"""Colours: text and axes, grid, measured points, the model, what was before, what an alert is about."""
LEFT, RIGHT, TOP, BOTTOM = 52.0, 8.0, 16.0, 28.0
"""Margins of a frame [px]."""
MOST_POINTS = 300
"""Points of one cloud that are drawn: more would cover each other."""
MOST_OF_A_CURVE = 1_200
"""Points of one curve that are drawn: fewer would cut off resonances."""
MARGIN = 0.05
"""Space beside the data, as a part of their extent [-]."""
TIME_MARGIN = 0.02
"""Space beside times, likewise [-]."""
HOUR_NS = 3_600 * 10**9
HOURS_OF_A_DAY = 24
DAY_NS = HOURS_OF_A_DAY * HOUR_NS
SHORTEST_NS = 4.0 * HOUR_NS
"""Least time that an axis spans [ns]: runs of an hour would otherwise have ticks by the minute."""
TICK_HOURS = (1, 2, 3, 6, 12, 24, 48, 72, 120, 168)
"""Times between two ticks [h]; beyond these whole days."""
MOST_TICKS = 5
SHORT_LABEL = 6
"""Characters of words that fit at a frame's end."""
LABEL_REACH = 24.0
"""Half the width of a tick's words: nearer to a frame's end they would be cut off [px]."""


@dataclass(frozen=True)
class PlotAxis:
    """One axis: its ends, ticks with their words, and its title."""

    low: float
    high: float
    ticks: tuple[tuple[float, str], ...]
    title: str


def axis_over(values: Floats, title: str, language: Language = ENGLISH, *, from_zero: bool = False) -> PlotAxis:
    """Return an axis that holds all finite values, with round ticks in the digits of a language."""
    finite = np.asarray(values, dtype=float).ravel()
    finite = finite[np.isfinite(finite)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    low = min(low, 0.0) if from_zero else low
    room = MARGIN * (high - low) or 0.05 * max(abs(high), 1e-12)
    low, high = low if from_zero and low == 0.0 else low - room, high + room
    step = round_step((high - low) / 4.0)
    first = math.ceil(low / step - 1e-9)
    ticks = [number * step for number in range(first, math.floor(high / step + 1e-9) + 1)]
    return PlotAxis(low, high, tuple((one, language.digits(f"{one:.6g}") if one else "0") for one in ticks), title)


def time_axis(first: float, last: float) -> PlotAxis:
    """Return an axis over times [ns since 1970], with days as ticks; with hours where the times are of few days."""
    span = max(last - first, SHORTEST_NS)
    first, span = (first + last - span) / 2.0 - TIME_MARGIN * span, (1.0 + 2.0 * TIME_MARGIN) * span
    hours = next((one for one in TICK_HOURS if one * HOUR_NS >= span / MOST_TICKS), 24 * math.ceil(span / DAY_NS / MOST_TICKS))
    step = hours * HOUR_NS
    ticks = [step * number for number in range(math.ceil(first / step), int((first + span) // step) + 1)]
    form = "%Y-%m-%d" if hours >= HOURS_OF_A_DAY else "%m-%d %H:%M"
    said = tuple((float(one), datetime.fromtimestamp(one / 1e9, UTC).strftime(form)) for one in ticks)
    return PlotAxis(first, first + span, said, "")


def round_step(size: float) -> float:
    """Return 1, 2 or 5 times a power of ten that is at least a size."""
    power = 10.0 ** math.floor(math.log10(size)) if size > 0.0 else 1.0
    return next(one * power for one in (1.0, 2.0, 5.0, 10.0) if one * power >= size * 0.999)


def thinned_slice(count: int, most: int = MOST_POINTS) -> slice:
    """Return a slice that leaves at most so many points of a count."""
    return slice(None, None, max(1, math.ceil(count / most)))


class PlotFrame:
    """A plot under way: what is drawn goes into `parts`, in pixels."""

    def __init__(self, x: PlotAxis, y: PlotAxis, *, width: float, height: float) -> None:
        """Begin a plot with its grid and the words of its axes."""
        self.x, self.y, self.width, self.height = x, y, width, height
        self.parts: list[str] = []
        for at, words in x.ticks:
            (px,) = self.across(np.array([at]))
            self.parts.append(segment(px, TOP, px, height - BOTTOM, GRID))
            within = px + LABEL_REACH <= width or len(words) <= SHORT_LABEL
            self.parts.append(label(px, height - BOTTOM + 10, words) if within else "")
        for at, words in y.ticks:
            (py,) = self.up(np.array([at]))
            self.parts.append(segment(LEFT, py, width - RIGHT, py, GRID))
            self.parts.append(label(LEFT - 4, py + 3, words, anchor="end"))
        self.parts.append(label((LEFT + width - RIGHT) / 2, height - 5, x.title))
        self.parts.append(label(3, TOP - 6, y.title, anchor="start"))

    def across(self, values: Floats) -> Floats:
        """Return places from left to right [px]."""
        return LEFT + (values - self.x.low) / (self.x.high - self.x.low) * (self.width - LEFT - RIGHT)

    def up(self, values: Floats) -> Floats:
        """Return places from top to bottom [px]."""
        part = (values - self.y.low) / (self.y.high - self.y.low)
        return self.height - BOTTOM - part * (self.height - TOP - BOTTOM)

    def line(self, x: Floats, y: Floats, colour: str, *, dashed: bool = False) -> None:
        """Draw a curve with gaps where it is not finite."""
        few = thinned_slice(len(x), MOST_OF_A_CURVE)
        self.parts.append(curve(self.across(x[few]), self.up(y[few]), colour, dashed=dashed))

    def points(self, x: Floats, y: Floats, colour: str, *, radius: float = 1.3) -> None:
        """Draw points."""
        few = thinned_slice(len(x))
        self.parts.append(dots(self.across(x[few]), self.up(y[few]), colour, radius=radius))

    def whiskers(self, x: Floats, lower: Floats, upper: Floats, colour: str) -> None:
        """Draw intervals, cut at the frame's ends."""
        few = thinned_slice(len(x))
        low, high = (np.clip(one[few], self.y.low, self.y.high) for one in (lower, upper))
        ends = zip(self.across(x[few]).tolist(), self.up(low).tolist(), self.up(high).tolist(), strict=True)
        known = (f"M{at:.1f} {begin:.1f}V{end:.1f}" for at, begin, end in ends if math.isfinite(begin + end))
        self.parts.append(f'<path d="{"".join(known)}" stroke="{colour}" stroke-width="0.6"/>')

    def between(self, x: Floats, lower: Floats, upper: Floats, colour: str) -> None:
        """Fill the band between two curves, cut at the frame's ends."""
        few = thinned_slice(len(x))
        low, high = (np.clip(one[few], self.y.low, self.y.high) for one in (lower, upper))
        known = np.isfinite(low) & np.isfinite(high)
        across = self.across(x[few][known])
        edge = [*zip(across, self.up(high[known]), strict=True), *zip(across[::-1], self.up(low[known])[::-1], strict=True)]
        places = " ".join(f"{px:.1f},{py:.1f}" for px, py in edge)
        self.parts.append(f'<polygon points="{places}" fill="{colour}" fill-opacity="0.18" stroke="none"/>')

    def drawing(self) -> str:
        """Return the plot as SVG."""
        box = f'<rect x="{LEFT}" y="{TOP}" width="{self.width - LEFT - RIGHT}" height="{self.height - TOP - BOTTOM}" '
        return svg("".join([*self.parts, box + f'fill="none" stroke="{INK}" stroke-width="0.6"/>']), self.width, self.height)


def svg(content: str, width: float, height: float, *, left: float = 0.0, top: float = 0.0) -> str:
    """Return a drawing. left, top: coordinates of its upper left corner."""
    head = f'viewBox="{left:.1f} {top:.1f} {width:.1f} {height:.1f}" width="{width:.0f}" height="{height:.0f}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {head}>{content}</svg>'


def segment(x1: float, y1: float, x2: float, y2: float, colour: str, *, width: float = 0.6) -> str:
    """Return a straight line."""
    ends = f'x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"'
    return f'<line {ends} stroke="{colour}" stroke-width="{width}"/>'


def label(x: float, y: float, words: str, *, anchor: str = "middle", colour: str = INK, size: float = 8.0) -> str:
    """Return words at a place."""
    place = f'x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}"'
    return f'<text {place} font-family="DejaVu Sans, sans-serif" font-size="{size}">{html.escape(words)}</text>'


def plain_label(x: float, y: float, words: str, *, anchor: str = "middle", size: float = 7.0) -> str:
    """Return words at a place on white, which no curve beneath strikes through."""
    width, height = 0.64 * size * len(words), 1.1 * size
    left = {"start": x, "middle": x - width / 2.0, "end": x - width}[anchor]
    place = f'x="{left:.1f}" y="{y - 0.85 * size:.1f}" width="{width:.1f}" height="{height:.1f}"'
    return f'<rect {place} fill="#ffffff" fill-opacity="0.85"/>' + label(x, y, words, anchor=anchor, size=size)


def curve(x: Floats, y: Floats, colour: str, *, dashed: bool = False) -> str:
    """Return a curve through places [px], with gaps where they are not finite."""
    steps: list[str] = []
    begun = False
    for px, py in zip(x.tolist(), y.tolist(), strict=True):
        known = math.isfinite(px) and math.isfinite(py)
        if known:
            steps.append(f"{'L' if begun else 'M'}{px:.1f} {py:.1f}")
        begun = known
    dash = ' stroke-dasharray="4 3"' if dashed else ""
    return f'<path d="{" ".join(steps)}" fill="none" stroke="{colour}" stroke-width="1.2"{dash}/>' if steps else ""


def dots(x: Floats, y: Floats, colour: str, *, radius: float = 1.3) -> str:
    """Return points at places [px], as one path, which prints much faster than an element each; none where not finite."""
    found = zip(x.tolist(), y.tolist(), strict=True)
    known = "".join(f"M{px:.1f} {py:.1f}h0.01" for px, py in found if math.isfinite(px + py))
    return f'<path d="{known}" stroke="{colour}" stroke-width="{2.0 * radius}" stroke-linecap="round"/>' if known else ""
