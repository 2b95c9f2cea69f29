"""Gaps of a simulated machine on oil films: where its shaft stands over a run, from zeros of the probes that drift."""

import numpy as np

from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.simulation.simulated_plant import Truth
from estimator.statics.shaft_centreline import ShaftCentreline, probe_views

DISTANCE = 1e-3
"""Distance from which a probe looks at the bearing's centre: the middle of its range [m]."""


def simulated_gaps(machine: Machine, truth: Truth, *, time: Floats, speed: Floats, rng: np.random.Generator) -> Floats | None:
    """Draw the gaps of a run, with the noise and the drift that the document expects.

    Args:
        machine: The machine, with m probes.
        truth: Truth of the run.
        time: Times (S,) [s].
        speed: Spin speeds (S,), without sign [rad/s].
        rng: Random generator.

    Returns:
        Mean places (S, m) of the shaft along the probes' axes, towards them [m]; NaN of probes whose gap the document does not
        describe. None of a machine without such probes or without films.
    """
    told = np.array([one.gap_grows is not None for one in machine.probes])
    if truth.films is None or not told.any():
        return None
    line = ShaftCentreline(truth.films.model.films, probe_views(machine), speed).values(truth.films.fitted)
    elapsed = (time - time.min()) / (float(np.ptp(time)) or 1.0)
    drift = machine.centreline.drift * rng.standard_normal(told.size) * elapsed[:, None]
    noise = machine.centreline.noise * rng.standard_normal(line.shape)
    return np.asarray(np.where(told, line - DISTANCE + drift + noise, np.nan))
