"""Vector plots of a balancing as SVG: one circle a channel, arrows from run to run, the prediction with its 95 % circle."""

import html
import math
from collections.abc import Sequence
from dataclasses import dataclass

from service.wording.language import ENGLISH, Language

SIZE = 220
RADIUS = 88
COLOURS = ("#1f5a93", "#9a5b00", "#5c7c1e", "#7a3b8f", "#555555", "#a02b2b", "#0f7f7f", "#b03a7e")


@dataclass(frozen=True)
class PlottedVector:
    """A vector: complex amplitude in the plot's unit, phase lead, and the radius of its 95 % circle."""

    name: str
    value: complex
    uncertain: float = 0.0
    dashed: bool = False


def vector_plot(title: str, vectors: Sequence[PlottedVector], *, unit: str, language: Language = ENGLISH) -> str:
    """Return a polar plot: amplitude as radius, phase lag clockwise from the right, as the page's plots have it."""
    largest = max([1e-12, *(abs(one.value) + one.uncertain for one in vectors)])
    step = _ring(largest / 3)
    rings = max(1, math.ceil(largest / step))
    scale = RADIUS / (step * rings)
    parts = [f'<circle class="ring" r="{(number + 1) * step * scale:.1f}"/>' for number in range(rings)]
    parts += [f'<line class="ring" x1="-{RADIUS}" x2="{RADIUS}" transform="rotate({angle})"/>' for angle in (0, 45, 90, 135)]
    parts += [_degrees(angle) for angle in (0, 90, 180, 270)]
    for number, one in enumerate(vectors):
        parts.append(_arrow(one, scale, COLOURS[number % len(COLOURS)]))
    head = html.escape(language.translate("balancing.rings", title=title, step=language.digits(f"{step:.3g}"), unit=unit))
    return (
        f'<figure><svg viewBox="{-SIZE // 2} {-SIZE // 2} {SIZE} {SIZE}" width="{SIZE}" height="{SIZE}" role="img" '
        f'aria-label="{head}">{"".join(parts)}</svg><figcaption>{head}<br/>{_key(vectors, language)}</figcaption></figure>'
    )


def _arrow(one: PlottedVector, scale: float, colour: str) -> str:
    # Lag grows clockwise on the screen, whose y points down: the conjugate of a lead.
    x, y = one.value.real * scale, -one.value.imag * scale
    dash = ' stroke-dasharray="4 3"' if one.dashed else ""
    circle = ""
    if one.uncertain > 0.0:
        circle = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{one.uncertain * scale:.1f}" fill="none" stroke="{colour}"{dash}/>'
    return (
        f'<line x1="0" y1="0" x2="{x:.1f}" y2="{y:.1f}" stroke="{colour}" stroke-width="2"{dash}/>'
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.5" fill="{colour}"/>{circle}'
    )


def _key(vectors: Sequence[PlottedVector], language: Language) -> str:
    return ", ".join(
        f'<span style="color:{COLOURS[number % len(COLOURS)]}">{html.escape(_read_out(one, language))}</span>'
        for number, one in enumerate(vectors)
    )


def _read_out(one: PlottedVector, language: Language) -> str:
    lag = -math.degrees(math.atan2(one.value.imag, one.value.real)) % 360
    return language.translate("balancing.lag", name=one.name, size=language.digits(f"{abs(one.value):.3g}"), angle=lag)


def _degrees(angle: int) -> str:
    x, y = (RADIUS + 11) * math.cos(math.radians(angle)), (RADIUS + 11) * math.sin(math.radians(angle)) + 3
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="middle">{angle}°</text>'


def _ring(size: float) -> float:
    """Return a round number near a size."""
    power = 10.0 ** math.floor(math.log10(size))
    return next(one for one in (power, 2 * power, 5 * power, 10 * power) if one >= size * 0.999)
