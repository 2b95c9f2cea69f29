"""One printed page of a balancing: the report's text, and a vector plot of each channel at the speed where it moves most."""

import html
from collections.abc import Sequence

import numpy as np

from estimator.balancing.balancing_check import BalancingCheck
from estimator.balancing.field_balancing import FieldBalancing
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.disc_scale import DiscScale
from service.balancing.balancing_text import FROM_MARK, balancing_text
from service.balancing.correction_rows import MICROMETRES
from service.balancing.vector_plot import PlottedVector, vector_plot
from service.wording.language import ENGLISH, Language
from service.wording.stored_sentences import in_language

STYLE = (
    "@page{size:A4;margin:10mm}body{font:10px/1.3 sans-serif;margin:1em;color:#111;orphans:1;widows:1}"
    "@media print{body{margin:0}}pre{font:8.5px/1.3 monospace;white-space:pre-wrap;margin:0 0 1em}"
    "figure{display:inline-block;margin:0 1% 6px 0;width:24%;max-width:220px;vertical-align:top;break-inside:avoid}"
    "svg{width:100%;height:auto}figcaption{font:8px/1.2 sans-serif}"
    ".ring{fill:none;stroke:#bbb;stroke-width:.6}text{font-size:8px;fill:#555}"
)


def printed_page(
    found: FieldBalancing,
    check: BalancingCheck | None = None,
    language: Language = ENGLISH,
    scale: DiscScale = FROM_MARK,
) -> str:
    """Return the page in a language, as HTML that needs nothing beside it; angles of weights are on a scale."""
    plots = "".join(channel_plots(found, check, language))
    title = html.escape(language.translate("balancing.page", name=found.machine.name))
    return (
        f'<!doctype html><html lang="{language.code}"><head><meta charset="utf-8"/>'
        f"<title>{title}</title><style>{STYLE}</style></head>"
        f"<body><pre>{html.escape(balancing_text(found, check, language, scale))}</pre>{plots}</body></html>\n"
    )


def channel_plots(found: FieldBalancing, check: BalancingCheck | None = None, language: Language = ENGLISH) -> Sequence[str]:
    """Return a vector plot of each channel, at the point where its vibration was largest."""
    plots = []
    for channel in found.machine.channels:
        own = [at for at, point in enumerate(found.runs.points) if point.startswith(f"{channel} at ")]
        if own:
            at = max(own, key=lambda one: float(found.correction.before.amplitude[one]))
            title = in_language(found.runs.points[at], language)
            plots.append(vector_plot(title, _vectors(found, check, at, language), unit="µm pp", language=language))
    return plots


def _vectors(found: FieldBalancing, check: BalancingCheck | None, at: int, language: Language) -> list[PlottedVector]:
    runs = found.runs
    unloaded = ~np.any(runs.added != 0.0, axis=1)
    shown = [
        PlottedVector(name, complex(vector) / MICROMETRES, dashed=bool(not base))
        for name, vector, base in zip(runs.names, runs.vector[:, at], unloaded, strict=True)
        if np.isfinite(vector)
    ][:MOST_RUNS]
    after = found.correction.after
    size = found.correction.influence.widening * CONFIDENCE_95 * float(np.sqrt(np.trace(after.covariance[at]) / 2.0))
    predicted = language.translate("balancing.predicted")
    shown.append(PlottedVector(predicted, complex(after.value[at]) / MICROMETRES, uncertain=size / MICROMETRES))
    if check is not None and np.isfinite(check.vector[at]):
        shown.append(PlottedVector(check.name, complex(check.vector[at]) / MICROMETRES))
    return shown


MOST_RUNS = 6
"""Largest number of runs in one plot."""
