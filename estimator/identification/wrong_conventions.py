"""Conventions of a source that may be wrong, each as a hypothesis: what it would make of a run that was sent so.

A source declares units, the sign of its phases, the sense of rotation and which lead is which probe; Rundown converts by what
is declared. Each hypothesis undoes one wrong declaration on the converted run. Derived here.
"""

import itertools
import math

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from estimator.arrays import Complexes
from estimator.machine.document import Machine
from estimator.machine.speed_units import speed_units
from estimator.phasors.measurement import Measurement
from estimator.phasors.probe_axes import probe_stations
from estimator.phasors.recorded_run import RecordedRun
from estimator.units import METRES, AmplitudeUnit

AMPLITUDE_NAMES: dict[AmplitudeUnit, str] = {"m": "m", "mm": "mm", "um": "µm", "mil": "mil"}
LARGEST_PHASE = 1.02 * 2.0 * math.pi * math.pi / 180.0
"""Largest phase [rad] of radians that were taken for degrees, up to a whole turn, with some noise."""
MOSTLY = 0.95
"""Part of the phasors that must show what a hypothesis needs [-]: the others may be outliers."""


class WrongConvention(Struct, frozen=True):
    """A wrong declaration, and how a run that was converted with it becomes right.

    Attributes:
        name: Short name, such as `phase-sign`.
        words: What is taken otherwise, in words that follow "the run fits better with".
        speed: Factor on speeds [-].
        amplitude: Factor on amplitudes [-].
        phase: Factor on phases [-].
        turned: Whether the shaft turns the other way.
        order: Index of the column that each channel is in; None for its own.
    """

    name: str
    words: str
    speed: float = 1.0
    amplitude: float = 1.0
    phase: float = 1.0
    turned: bool = False
    order: tuple[int, ...] | None = None

    def run(self, run: RecordedRun) -> RecordedRun:
        """Return a run as it is under this hypothesis.

        Args:
            run: The run as it was converted.

        Returns:
            The run with right conventions.
        """
        order = self._order(len(run.channels))
        return replace(
            run,
            speed=self.speed * run.speed,
            phasor=self._phasor(run.phasor)[:, order],
            status=run.status[:, order],
            scatter=self.amplitude * run.scatter[:, order],
        )

    def measurement(self, measurement: Measurement) -> Measurement:
        """Return a measurement as it is under this hypothesis.

        Args:
            measurement: The measurement as it was converted.

        Returns:
            The measurement with right conventions.
        """
        order = self._order(measurement.phasor.shape[1])
        return replace(
            measurement,
            speed=self.speed * measurement.speed,
            direction=-measurement.direction if self.turned else measurement.direction,
            phasor=self._phasor(measurement.phasor)[:, order],
            usable=measurement.usable[:, order],
            scatter=self.amplitude * measurement.scatter[:, order],
        )

    def _order(self, channels: int) -> list[int]:
        return list(range(channels) if self.order is None else self.order)

    def _phasor(self, phasor: Complexes) -> Complexes:
        if self.phase == -1.0:
            phasor = phasor.conj()
        elif self.phase != 1.0:
            phasor = np.abs(phasor) * np.exp(1j * self.phase * np.angle(phasor))
        return self.amplitude * phasor


def wrong_conventions(machine: Machine, measurement: Measurement) -> tuple[WrongConvention, ...]:
    """List the hypotheses that a run does not exclude at first sight, without two swapped probes and amplitudes.

    Args:
        machine: The machine.
        measurement: All samples of its run or runs.

    Returns:
        The hypotheses.
    """
    listed = [
        WrongConvention("phase-sign", "the opposite sign of the phase: lead sent as lag, or lag as lead", phase=-1.0),
        WrongConvention("rotation", "the opposite sense of rotation", turned=True),
    ]
    phases = np.abs(np.angle(measurement.phasor[measurement.usable]))
    if phases.size and np.mean(phases <= LARGEST_PHASE) >= MOSTLY:
        listed.append(WrongConvention("phase-unit", "phases in rad that were sent as degrees", phase=180.0 / math.pi))
    listed += [
        WrongConvention("speed-unit", one.words, speed=one.factor)
        for one in speed_units(machine.speed_range, measurement.speed)
    ]
    pairs = _pairs(machine)
    if len(pairs) > 1:
        every = _swapped(machine, pairs)
        listed.append(replace(every, words="the probes of every pair swapped with each other"))
    return tuple(listed)


def amplitude_scales() -> list[WrongConvention]:
    """List the units and kinds of amplitudes that may have been taken for each other.

    Returns:
        The hypotheses.
    """
    found = [
        WrongConvention("amplitude-kind", "0-to-peak amplitudes that were sent as peak-to-peak", amplitude=2.0),
        WrongConvention("amplitude-kind", "peak-to-peak amplitudes that were sent as 0-to-peak", amplitude=0.5),
    ]
    for sent, declared in itertools.permutations(METRES, 2):
        words = f"amplitudes in {AMPLITUDE_NAMES[sent]} that were sent as {AMPLITUDE_NAMES[declared]}"
        found.append(WrongConvention("amplitude-unit", words, amplitude=METRES[sent] / METRES[declared]))
    return found


def swapped_probes(machine: Machine) -> list[WrongConvention]:
    """List the hypotheses of two probes that are swapped with each other.

    Args:
        machine: The machine.

    Returns:
        The hypotheses.
    """
    return [_swapped(machine, [pair]) for pair in itertools.combinations(range(len(machine.channels)), 2)]


def has_known_weights(measurement: Measurement) -> bool:
    """Check whether unbalances that were added differ within a measurement, which fixes the scale of all amplitudes.

    Args:
        measurement: All samples.

    Returns:
        Whether they do.
    """
    return measurement.added is not None and bool(np.any(measurement.added != measurement.added[0]))


def _pairs(machine: Machine) -> list[tuple[int, int]]:
    """Return the columns of the two probes at each station that has a pair."""
    found = []
    for place in probe_stations(machine):
        if len(place.columns) == 2 and place.sees_both_axes:
            first, second = place.columns
            found.append((first, second))
    return found


def _swapped(machine: Machine, pairs: list[tuple[int, int]]) -> WrongConvention:
    order = list(range(len(machine.channels)))
    for first, second in pairs:
        order[first], order[second] = second, first
    names = "; ".join(f"{machine.channels[first]} and {machine.channels[second]}" for first, second in pairs)
    return WrongConvention("swapped-probes", f"{names} swapped with each other", order=tuple(order))
