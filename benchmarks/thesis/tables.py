"""Markdown tables and the numbers in them."""

import math
import textwrap
from collections.abc import Sequence

import numpy as np

from estimator.arrays import Floats
from estimator.machine.parameter_description import describe

PrintedUnbalance = tuple[float, float]
"""An unbalance as printed: magnitude [kg m], angle [°]."""


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def prose(text: str) -> str:
    """Return paragraphs for the page from an indented text."""
    return textwrap.dedent(text).strip()


def paragraphs(*parts: str) -> str:
    """Return parts of the page with an empty line between them."""
    return "\n\n".join(parts)


def percent(value: float) -> str:
    """Return a relative error for a table: two digits, in per cent."""
    shown = 100.0 * value
    if not math.isfinite(shown):
        return "-"
    if shown == 0.0:
        return "0 %"
    if shown >= 9.95e3:
        return f"{shown:.1e} %"
    if shown >= 99.5:
        return f"{float(f'{shown:.2g}'):.0f} %"
    return f"{shown:.2g} %" if shown >= 1e-3 else f"{shown:.0e} %"


def shift(value: float) -> str:
    """Return a relative shift with its sign, in per cent to two decimals."""
    shown = round(100.0 * value, 2)
    return f"{shown:+.2f} %" if shown else "0 %"


def decade(value: float) -> str:
    """Return, for a relative error that is rounding only, the power of ten that it stays below, in per cent."""
    return f"< 1e{math.ceil(math.log10(100.0 * value)):+03d} %"


def power(value: float) -> str:
    """Return a condition number with two digits and the power of ten."""
    return f"{value:.1e}" if math.isfinite(value) else "infinite"


def median_and_worst(errors: Floats) -> str:
    """Return, of errors (seeds, parameters), the median over all, and the median over seeds of each seed's largest error."""
    worst = np.nanmax(errors, axis=1)
    return f"{percent(float(np.nanmedian(errors)))} / {percent(float(np.median(worst)))}"


def worst_of_seeds(errors: Floats) -> str:
    """Return, of errors (seeds, parameters), each seed's largest error, as median over seeds (smallest to largest)."""
    worst = np.nanmax(errors, axis=1)
    return f"{percent(float(np.median(worst)))} ({percent(float(worst.min()))} to {percent(float(worst.max()))})"


def short_name(name: str) -> str:
    """Return a parameter's name without its kind of element: `B1 kxx`, `C k_phix`, `D2 U real`."""
    said = describe(name)
    quantity = "U" if said.quantity == "unbalance" else said.quantity
    return " ".join(filter(None, (said.element_id, quantity, said.component)))
