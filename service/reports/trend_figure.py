"""Trend of one parameter over the period, with intervals and the baseline's band."""

import numpy as np

from service.reports.contents import ReportedTrend
from service.reports.plot_frame import BEFORE, FITTED, PlotFrame, axis_over, time_axis
from service.wording.language import ENGLISH, Language

WIDTH, HEIGHT = 335.0, 140.0
WIDE = 3.0
"""Multiple of the median interval from which on one is cut at the frame."""


def trend_figure(one: ReportedTrend, language: Language = ENGLISH) -> str:
    """Return the trend as SVG. The axis follows values, band and usual intervals: a wide one is cut, as not to hide them."""
    time = one.time.astype(float)
    band = () if one.band is None else one.band
    known = one.upper - one.lower
    usual = (
        known <= WIDE * float(np.median(known[np.isfinite(known)])) if np.isfinite(known).any() else np.zeros(known.size, bool)
    )
    frame = PlotFrame(
        time_axis(float(time.min()), float(time.max())),
        axis_over(
            np.array([*one.value, *one.lower[usual], *one.upper[usual], *band]),
            f"[{one.unit}]" if one.unit not in ("", "1") else "",
            language,
        ),
        width=WIDTH,
        height=HEIGHT,
    )
    if one.band is not None:
        ends = np.array([frame.x.low, frame.x.high])
        frame.between(ends, np.full(2, one.band[0]), np.full(2, one.band[1]), BEFORE)
    frame.whiskers(time, one.lower, one.upper, FITTED)
    frame.points(time, one.value, FITTED, radius=1.8)
    return frame.drawing()
