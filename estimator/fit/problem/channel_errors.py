"""Coordinates of a fit with errors of measuring chains behind its own, which the document takes as exact."""

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from msgspec.structs import replace

from estimator.fit.problem.channel_coordinates import ChannelCoordinates
from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.parameter_description import COMPONENTS

RUN_OUT_UNIT = 1e-6
"""Unit [m] of run-outs while the matrices are built, so that they are of the size of everything else."""
_UNIT = {"gain": 1.0, "run_out": RUN_OUT_UNIT}
UNIT_SPREAD: Mapping[str, float] = {"gain": math.sqrt(0.5), "run_out": math.sqrt(0.5) * RUN_OUT_UNIT}
"""Standard deviations of each part of errors of unit size [-, m]."""


def with_every_channel(coordinates: Coordinates, channels: Sequence[str]) -> Coordinates:
    """Return coordinates with the gains and run-outs of all channels; those that were missing are appended.

    Args:
        coordinates: The coordinates.
        channels: Ids of the m channels.

    Returns:
        The coordinates; those that are added have a prior of unit size.
    """
    every = [(quantity, channel) for quantity in _UNIT for channel in range(len(channels))]
    return with_channel_errors(coordinates, channels, every, spread=UNIT_SPREAD)


def with_channel_errors(
    coordinates: Coordinates, channels: Sequence[str], errors: Iterable[tuple[str, int]], *, spread: Mapping[str, float]
) -> Coordinates:
    """Return coordinates with some errors of channels; those that were missing are appended.

    Args:
        coordinates: The coordinates.
        channels: Ids of the m channels.
        errors: Quantity, `gain` or `run_out`, and place of the channel of each error.
        spread: Standard deviation of each part of an error by quantity, as believed beforehand [-, m].

    Returns:
        The coordinates.
    """
    places = {"gain": coordinates.channels.gain.copy(), "run_out": coordinates.channels.run_out.copy()}
    names: list[str] = []
    unit: list[float] = []
    width: list[float] = []
    for quantity, channel in errors:
        if places[quantity][channel] < 0:
            places[quantity][channel] = coordinates.size + len(names)
            names += [f"probe.{channels[channel]}.{quantity}.{part}" for part in COMPONENTS]
            unit += [_UNIT[quantity]] * len(COMPONENTS)
            width += [spread[quantity] / _UNIT[quantity]] * len(COMPONENTS)
    more, every = np.zeros(len(names)), np.concatenate([coordinates.unit, unit])
    return replace(
        coordinates,
        names=(*coordinates.names, *names),
        centre=np.concatenate([coordinates.centre, more]),
        spread=np.concatenate([coordinates.spread, width]),
        origin=np.concatenate([coordinates.origin, more]),
        unit=every,
        channels=ChannelCoordinates(gain=places["gain"], run_out=places["run_out"], unit=every),
    )
