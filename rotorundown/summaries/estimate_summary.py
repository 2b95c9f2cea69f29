"""Text of estimates that fits a screen: a line per element, its direct terms and its unbalance with their errors."""

import cmath
import math
import textwrap
from collections import Counter
from collections.abc import Iterator, Sequence

from estimator.fit.estimates import KEPT, TIED, Estimate
from estimator.fit.identification import Identification
from estimator.machine.document import Machine
from estimator.machine.film_speeds import slowest_rpm
from estimator.machine.parameter_description import describe
from estimator.units import rad_per_s_to_rpm

G_MM = 1e6
"""g mm in a kg m."""
MOST_ELEMENTS = 30
"""Most elements that are listed."""
SCREEN_COLUMNS = 100
"""Longest line."""
MOST_TERMS = 4
"""Most terms of an element on its line: the direct ones come first."""
CROSS_COUPLED = ("xy", "yx")
"""Ends of the names of cross-coupled terms, which come last."""
LARGEST_PER_CENT = 0.5
"""Largest standard error that is given in per cent, as a part of the value [-]: beyond it the value may be zero."""
UNBALANCE = "unbalance"
REFUSED_VALUES = "Where the refused fit ended; these are no results, neither the values nor their errors:"
"""Heading of the values of a fit that is not accepted."""
ERRORS = "Values ± standard error"
"""Heading of estimates."""


def sample_words(found: Identification, machine: Machine) -> str:
    """Return how many samples were fitted and over which speeds; on films that hold from a speed on, that speed."""
    slowest = slowest_rpm(machine)
    held = f" (films hold from {slowest:.0f} r/min on)" if slowest > machine.speed_range.minimum_rpm else ""
    low, high = rad_per_s_to_rpm(found.speed_minimum), rad_per_s_to_rpm(found.speed_maximum)
    return f"{found.samples} samples, {low:.0f} to {high:.0f} r/min{held}"


def element_lines(estimates: Sequence[Estimate]) -> list[str]:
    """Return a heading and a line per element, the first `MOST_ELEMENTS` of them."""
    elements: dict[str, list[Estimate]] = {}
    for one in estimates:
        elements.setdefault(one.element, []).append(one)
    width = max((len(element) for element in elements), default=0)
    room = SCREEN_COLUMNS - width - 2
    lines = [f"{element:<{width}}  {_terms(element, those, room=room)}" for element, those in elements.items()]
    left_out = len(lines) - MOST_ELEMENTS
    if left_out > 0:
        lines = [*lines[:MOST_ELEMENTS], f"and {left_out} more elements"]
    return [ERRORS, *lines]


def within_screen(line: str) -> str:
    """Return a line broken at blanks where it is longer than a screen is wide."""
    return textwrap.fill(line, SCREEN_COLUMNS, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def _terms(element: str, estimates: Sequence[Estimate], *, room: int) -> str:
    """Return an element's terms, as many as its line has room for, at least one."""
    known = sorted((one for one in estimates if one.estimable), key=lambda one: one.name.endswith(CROSS_COUPLED))
    terms = [_term(one.name.removeprefix(f"{element}."), one) for one in known[:MOST_TERMS]]
    unsought = [*_unsought(estimates)]
    open_ones = sum(one.sought for one in estimates) - len(known)
    for count in range(len(terms), -1, -1):
        more = [f"+ {len(known) - count} more"] if len(known) > count else []
        said = ", ".join([*terms[:count], *more, *unsought, *([f"{open_ones} not estimable"] if open_ones else [])])
        if len(said) <= room or count <= 1:
            break
    return said


def _unsought(estimates: Sequence[Estimate]) -> Iterator[str]:
    """Yield how many of an element's terms are kept, or tied to those of which element."""
    reasons = [one.reason or "" for one in estimates if not one.sought]
    kept = sum(one.startswith(KEPT) for one in reasons)
    if kept:
        yield f"{kept} kept"
    leaders = [describe(one.removeprefix(TIED).strip()).element for one in reasons if one.startswith(TIED)]
    for element, count in Counter(leaders).items():
        yield f"{count} {TIED} {element}"


def _term(label: str, one: Estimate) -> str:
    value, error = float(one.value or 0.0), float(one.standard_error or 0.0)
    if one.imaginary is not None:
        return _vector(label, one, complex(value, one.imaginary), max(error, float(one.imaginary_standard_error or 0.0)))
    unit = "" if one.unit == "1" else f" {one.unit}"
    if error < LARGEST_PER_CENT * abs(value):
        return f"{label} {value:.3g}{unit} ±{100 * error / abs(value):.2g} %"
    return f"{label} {value:.2g} ±{error:.2g}{unit}"


def _vector(label: str, one: Estimate, value: complex, error: float) -> str:
    angle = math.degrees(cmath.phase(value)) % 360.0
    if one.quantity == UNBALANCE:
        return f"{label} {float(f'{G_MM * abs(value):.3g}'):.12g} ±{G_MM * error:.2g} g mm at {angle:.0f}°"
    return f"{label} {abs(value):.3g} ±{error:.2g} {one.unit} at {angle:.0f}°"
