"""Trend of one parameter over the period, with intervals and the baseline's band."""

import numpy as np

from service.reports.contents import ReportedTrend
from service.reports.plot_frame import BEFORE, FITTED, PlotFrame, axis_over, time_axis
from service.wording.language import ENGLISH, Language

WIDTH, HEIGHT = 335.0, 140.0


def trend_figure(one: ReportedTrend, language: Language = ENGLISH) -> str:
    """Return the trend as SVG. The axis follows the values and the band: a wide interval is cut, as not to hide them."""
    time = one.time.astype(float)
    band = () if one.band is None else one.band
    frame = PlotFrame(
        time_axis(float(time.min()), float(time.max())),
        axis_over(np.array([*one.value, *band]), f"[{one.unit}]" if one.unit not in ("", "1") else "", language),
        width=WIDTH,
        height=HEIGHT,
    )
    if one.band is not None:
        ends = np.array([frame.x.low, frame.x.high])
        frame.between(ends, np.full(2, one.band[0]), np.full(2, one.band[1]), BEFORE)
    frame.whiskers(time, one.lower, one.upper, FITTED)
    frame.points(time, one.value, FITTED, radius=1.8)
    return frame.drawing()
