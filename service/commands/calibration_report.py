"""Renders the unbalance that a machine has gained since its calibration as text for a terminal."""

import numpy as np

from estimator.calibration.unbalance_since import UnbalanceSince
from estimator.fit.estimates import CONFIDENCE_95
from service.sources.trial_weights import DiscScale

GRAM_MILLIMETRES = 1e6
"""g mm per kg m."""


def since_text(since: UnbalanceSince, scale: DiscScale, *, direction: int) -> str:
    """Return the unbalance gained since the calibration, a line per disc, with 95 % intervals, angles on the discs' scale."""
    counted = "from +x towards +y" if scale == DiscScale() else f"on the discs' scale, {scale.counted}"
    heading = "Unbalance gained since the calibration (± 95 %, with the calibration's uncertainty and that of a new mounting)"
    lines = ["", f"{heading}, angles {counted}"]
    for place, (disc, value) in enumerate(zip(since.discs, since.value, strict=True)):
        half = CONFIDENCE_95 * since.standard_error(place) * GRAM_MILLIMETRES
        size, open_angle = abs(value) * GRAM_MILLIMETRES, since.angle_error_deg(place)
        reading = f"{scale.reading(float(np.angle(value)), direction=direction):.1f}"
        angle = f"{reading} ± {open_angle:.1f}°" if open_angle < 180.0 else f"{reading}°, which is left open"
        lines.append(f"  {disc:<12} {size:9.3f} ± {half:.3f} g mm at {angle}")
    return "\n".join(lines)
