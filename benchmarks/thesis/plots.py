"""Small figures as hand-written SVG, in docs/evidence."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

FOLDER = Path(__file__).parents[2] / "docs" / "evidence"
WIDTH, HEIGHT = 980, 420
LEFT, RIGHT, TOP, BOTTOM = 80, 260, 40, 55
"""The names of the curves stand in the right margin."""
COLOURS = ("#1f5fa8", "#c1440e", "#2e7d32", "#6a3d9a", "#8a6d00", "#444444")


@dataclass(frozen=True)
class PlottedCurve:
    """One curve, or single points where `points` is set. Values that cannot be drawn are left out.

    Attributes:
        name: Its name, beside the chart.
        x: Places.
        y: Values.
        points: Whether single points are drawn.
        band: Lower and upper ends of a band around the curve.
        dashed: Whether the curve is dashed.
        colour: Place of its colour among `COLOURS`; None for that of its own place.
    """

    name: str
    x: Sequence[float]
    y: Sequence[float]
    points: bool = False
    band: tuple[Sequence[float], Sequence[float]] | None = None
    dashed: bool = False
    colour: int | None = None


@dataclass(frozen=True)
class _Axis:
    low: float
    high: float
    logarithmic: bool
    ticks: tuple[float, ...]

    def part(self, value: float) -> float:
        """Return the position of a value, from 0 to 1."""
        if self.logarithmic:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)


def chart(*, title: str, x_label: str, y_label: str, series: Sequence[PlottedCurve], logarithmic: bool = False) -> str:
    """Return a chart of curves and points as SVG. logarithmic: whether the y axis is; values that are not positive are then
    left out."""
    horizontal = _linear_axis([value for one in series for value in one.x])
    vertical = _axis([value for one in series for values in (one.y, *(one.band or ())) for value in values], logarithmic)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="12">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
        f'<text x="{LEFT}" y="22" font-size="14" font-weight="bold">{escape(title)}</text>',
        *_grid(horizontal, vertical),
        f'<text x="{(LEFT + WIDTH - RIGHT) / 2:.0f}" y="{HEIGHT - 12}" text-anchor="middle">{escape(x_label)}</text>',
        f'<text transform="translate(16 {(TOP + HEIGHT - BOTTOM) / 2:.0f}) rotate(-90)" text-anchor="middle">'
        f"{escape(y_label)}</text>",
    ]
    for number, one in enumerate(series):
        colour = COLOURS[(number if one.colour is None else one.colour) % len(COLOURS)]
        parts += _drawn(one, horizontal, vertical, colour)
        y = TOP + 16 + 17 * number
        parts.append(f'<circle cx="{WIDTH - RIGHT + 20}" cy="{y - 4}" r="4" fill="{colour}"/>')
        parts.append(f'<text x="{WIDTH - RIGHT + 30}" y="{y}">{escape(one.name)}</text>')
    return "\n".join([*parts, "</svg>\n"])


def save(name: str, svg: str) -> str:
    """Write a figure to docs/evidence and return its place relative to the page."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    (FOLDER / f"{name}.svg").write_text(svg, encoding="utf-8")
    return f"evidence/{name}.svg"


def _axis(values: Sequence[float], logarithmic: bool) -> _Axis:
    if not logarithmic:
        return _linear_axis(values)
    positive = [value for value in values if math.isfinite(value) and value > 0]
    low, high = math.floor(math.log10(min(positive))), math.ceil(math.log10(max(positive)))
    high = max(high, low + 1)
    return _Axis(10.0**low, 10.0**high, True, tuple(10.0**power for power in range(low, high + 1)))


def _linear_axis(values: Sequence[float]) -> _Axis:
    finite = [value for value in values if math.isfinite(value)]
    low, high = min(finite), max(finite)
    step = 10.0 ** math.floor(math.log10((high - low) or 1.0))
    if (high - low) / step < 4:
        step /= 2
    first, last = math.floor(low / step), max(math.ceil(high / step), math.floor(low / step) + 1)
    return _Axis(first * step, last * step, False, tuple(k * step for k in range(first, last + 1)))


def _grid(horizontal: _Axis, vertical: _Axis) -> list[str]:
    parts = []
    for tick in horizontal.ticks:
        x = _x(horizontal, tick)
        parts.append(f'<path d="M{x:.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="#dddddd"/>')
        parts.append(f'<text x="{x:.1f}" y="{HEIGHT - BOTTOM + 16}" text-anchor="middle">{tick:g}</text>')
    for tick in vertical.ticks:
        y = _y(vertical, tick)
        parts.append(f'<path d="M{LEFT} {y:.1f}H{WIDTH - RIGHT}" stroke="#dddddd"/>')
        parts.append(f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{tick:g}</text>')
    return parts


def _drawn(one: PlottedCurve, horizontal: _Axis, vertical: _Axis, colour: str) -> list[str]:
    shown = [
        (_x(horizontal, x), _y(vertical, y))
        for x, y in zip(one.x, one.y, strict=True)
        if math.isfinite(y) and (y > 0 or not vertical.logarithmic)
    ]
    if one.points:
        return [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{colour}" fill-opacity="0.8"/>' for x, y in shown]
    path = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in shown)
    dashes = ' stroke-dasharray="6 4"' if one.dashed else ""
    return [
        *_band(one, horizontal, vertical, colour),
        f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="1.6"{dashes}/>',
    ]


def _band(one: PlottedCurve, horizontal: _Axis, vertical: _Axis, colour: str) -> list[str]:
    if one.band is None:
        return []
    lower, upper = one.band
    around = [*zip(one.x, upper, strict=True), *reversed(list(zip(one.x, lower, strict=True)))]
    corners = "L".join(f"{_x(horizontal, x):.1f} {_y(vertical, y):.1f}" for x, y in around)
    return [f'<path d="M{corners}Z" fill="{colour}" fill-opacity="0.18"/>']


def _x(axis: _Axis, value: float) -> float:
    return LEFT + axis.part(value) * (WIDTH - LEFT - RIGHT)


def _y(axis: _Axis, value: float) -> float:
    return HEIGHT - BOTTOM - axis.part(value) * (HEIGHT - TOP - BOTTOM)
