"""Orbits (1×) at the probes, with their uncertainty, and signs of swapped channels and of a wrong sense of rotation.

Below the first critical speed the shaft follows the unbalance's force, so every orbit turns with the shaft, however flat the
bearings make it. A pair of probes whose leads are swapped shows the mirror image, which turns backward; a wrong sense of
rotation turns all of them.
"""

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.machine.part_coefficients import nominal_value
from estimator.modes.critical_speed import undamped_critical_speeds
from estimator.phasors.measurement import Measurement
from estimator.phasors.noise import error_size
from estimator.phasors.probe_axes import AxisPhasors, ProbeStation, axis_phasors, probe_stations
from estimator.rotor.coefficient_models import expected_coefficients
from estimator.rotor.condensation import condense
from estimator.rotor.modal_reduction import modal_basis
from estimator.rotor.system_matrices import system_matrices
from estimator.rotor.whirl import orbit
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s

Sense = Literal["forward", "backward", "undecided"]
FindingCode = Literal["wrong_rotation", "swapped_channels", "swapped_or_wrong_rotation", "orbit_sense_undetectable"]

CLEAR_SENSE = 3.0
"""Standard errors of the semi-minor axis below which the sense of an orbit is undecided [-]."""
CERTAIN_FORWARD = 0.98
"""Chance, over all unbalances, with which the model's orbit must be forward for a backward one to mean anything [-]."""
BELOW_CRITICAL = 0.8
"""Part of the first critical speed below which samples are used [-]."""
FEWEST_SAMPLES = 5
"""Least number of samples of a station below that speed."""
NARROWEST = 0.1
"""Least part of that speed which the samples must span [-]."""
SMALLEST_PART = 0.2
"""Growth of an orbit over that of the largest, each beside what the model expects, below which it is not judged [-]: it may be
the remains of an unbalance far away, which cross-coupling turns as it likes.
"""
LOWEST = 0.1
"""Part of the first critical speed from which on the model's orbits are computed, unless the speed range begins below
it [-]."""
NO_RADIUS = 1e-100
"""Radius [m] that stands for a circle of no radius, whose angle nothing determines."""
EXPECTED_SPEEDS = 40
"""Number of speeds at which the model's orbits are computed."""


@dataclass(frozen=True)
class StationOrbits:
    """Orbits (1×) at one station in S samples; NaN where x and y are not known.

    Attributes:
        place: The station and its probes.
        x: Phasors (S,) along x [m].
        y: Phasors (S,) along y [m].
        semi_major: Semi-major axes (S,) [m], as of `whirl.orbit`.
        semi_minor: Semi-minor axes (S,) [m], above zero for forward whirl.
        inclination: Inclinations (S,) of the major axes [rad].
        semi_major_error: Standard errors (S,) of the semi-major axes [m].
        semi_minor_error: Standard errors (S,) of the semi-minor axes [m].
        inclination_error: Standard errors (S,) of the inclinations [rad].
    """

    place: ProbeStation
    x: Complexes
    y: Complexes
    semi_major: Floats
    semi_minor: Floats
    inclination: Floats
    semi_major_error: Floats
    semi_minor_error: Floats
    inclination_error: Floats

    def sense(self, sample: int) -> Sense:
        """Return the sense in which the shaft whirls in a sample: with its rotation or against it.

        Args:
            sample: Index of the sample.

        Returns:
            The sense; undecided where the orbit is too flat.
        """
        minor, error = float(self.semi_minor[sample]), float(self.semi_minor_error[sample])
        if not abs(minor) > CLEAR_SENSE * error:
            return "undecided"
        return "forward" if minor > 0.0 else "backward"


@dataclass(frozen=True)
class OrbitFinding:
    """Fault of the wiring that orbits show, or doubt about it that they cannot settle.

    Attributes:
        code: Kind of the finding.
        channels: Channels it is about.
        words: The finding in words.
    """

    code: FindingCode
    channels: tuple[str, ...]
    words: str


def station_orbits(machine: Machine, measurement: Measurement) -> tuple[StationOrbits, ...]:
    """Compute the orbits of every sample at the stations whose probes see both axes.

    Errors are those of the phasors, the source's scatter or the document's noise, with the spread of run-outs that were not
    subtracted, to first order.

    Args:
        machine: The machine.
        measurement: S samples of its channels.

    Returns:
        Orbits of each station [m, rad].
    """
    run_out = np.array([probe.run_out_spread for probe in machine.probes])
    error = np.hypot(_noise_error(machine, measurement), run_out)
    found = []
    for place in probe_stations(machine):
        if place.sees_both_axes:
            axes = axis_phasors(place, phasor=measurement.phasor, usable=measurement.usable)
            each = np.where(measurement.usable, error, 0.0)[:, list(place.columns)]
            found.append(_orbits(place, axes.x, axes.y, axes.inverse, each, measurement.direction))
    return tuple(found)


def orbit_findings(machine: Machine, measurement: Measurement) -> tuple[OrbitFinding, ...]:
    """Find swapped channels or a wrong sense of rotation, and the stations at which neither could be seen, with the reason.

    Only the part of each channel that grows with the speed as a response does is judged, so that a run-out or a slow roll does
    not matter. Two machines that are mirror images look alike: all pairs swapped is the same as a wrong sense of rotation.

    Args:
        machine: The machine.
        measurement: Samples of its channels.

    Returns:
        The findings.
    """
    backward: dict[tuple[str, ...], bool] = {}
    findings: list[OrbitFinding] = []
    places = probe_stations(machine)
    try:
        expected = ExpectedOrbits.of(machine)
    except ValueError as error:
        return tuple(_undetectable_finding(place, str(error)) for place in places)
    grown: list[tuple[StationOrbits, float]] = []
    for place in places:
        try:
            one = _growing_orbit(machine, measurement, place, expected)
            grown.append((one, float(one.semi_major[0]) / expected.size(place)))
        except _SenseUndetectable as why:
            findings.append(_undetectable_finding(place, str(why)))
    largest = max((size for _, size in grown), default=0.0)
    for one, size in grown:
        sense = one.sense(0)
        if size < SMALLEST_PART * largest:
            findings.append(
                _undetectable_finding(one.place, "the orbit is small beside those elsewhere, so it may turn either way")
            )
        elif sense == "undecided":
            findings.append(_undetectable_finding(one.place, "the orbit is too flat or too small for the noise"))
        else:
            backward[one.place.channels] = sense == "backward"
    wrong = _backward_findings([place for place in places if backward.get(place.channels)], len(backward))
    return (*wrong, *findings)


def _undetectable_finding(place: ProbeStation, why: str) -> OrbitFinding:
    words = f"whether {_named(place)} {'are swapped' if len(place.channels) > 1 else 'is swapped'} cannot be seen: {why}"
    return OrbitFinding("orbit_sense_undetectable", place.channels, words)


def _backward_findings(backward: list[ProbeStation], judged: int) -> list[OrbitFinding]:
    """Return the findings for backward orbits: one per station, or one for all where all that were judged turn backward."""
    if len(backward) == judged > 1:
        channels = tuple(channel for place in backward for channel in place.channels)
        words = f"the orbits at all {judged} pairs of probes turn backward: the sense of rotation is wrong, or every pair"
        return [OrbitFinding("wrong_rotation", channels, f"{words} is swapped")]
    if 2 * len(backward) >= judged:
        others = "" if judged == 1 else f", as at {len(backward)} of {judged} pairs"
        rest = "" if judged == 1 else " and those of the other pairs are swapped"
        meaning = f"the channels are swapped, or the sense of rotation is wrong{rest}"
        code: FindingCode = "swapped_or_wrong_rotation"
    else:
        others, meaning, code = " as at the other pairs", "these channels are swapped", "swapped_channels"
    return [
        OrbitFinding(code, place.channels, f"the orbit at {_named(place)} turns backward, not forward{others}: {meaning}")
        for place in backward
    ]


def _named(place: ProbeStation) -> str:
    return " and ".join([", ".join(place.channels[:-1]), place.channels[-1]] if len(place.channels) > 1 else place.channels)


@dataclass(frozen=True)
class ExpectedOrbits:
    """Orbits of the document's machine below its first critical speed.

    Attributes:
        critical: First critical speed without damping [rad/s].
        speed: Speeds (S,) up to BELOW_CRITICAL of it [rad/s].
        influence: Responses (S, m, P) of the channels to an unbalance of each disc in proportion to its mass [m per m of
            eccentricity].
    """

    critical: float
    speed: Floats
    influence: Complexes

    @classmethod
    def of(cls, machine: Machine) -> "ExpectedOrbits":
        """Compute the orbits of a machine at its nominal values.

        Source: own derivation: geometry of ellipses that grow over speed, in the module's docstring.

        Args:
            machine: The machine.

        Returns:
            The orbits.

        Raises:
            ValueError: The document gives no stiffness of a bearing, or the machine has no critical speed.
        """
        rpm, terms = machine.speed_range.middle_rpm, ("kxx", "kyy")
        guessed = [one.id for one in machine.bearings if None in [nominal_value(one, term, rpm=rpm) for term in terms]]
        if guessed:
            raise ValueError(f"the document gives no stiffness of bearing {', '.join(guessed)}")
        basis = modal_basis(machine, rpm_to_rad_per_s(machine.speed_range.maximum_rpm))
        undamped = undamped_critical_speeds(system_matrices(machine, basis=basis), direction=machine.direction)
        if not undamped.size:
            raise ValueError("the document's machine has no critical speed")
        critical = float(undamped[0])
        lowest = min(rpm_to_rad_per_s(machine.speed_range.minimum_rpm), LOWEST * critical)
        speed = np.linspace(lowest, BELOW_CRITICAL * critical, EXPECTED_SPEEDS)
        train = condense(machine, speed=speed, direction=np.full(speed.size, float(machine.direction)))
        stiffness = train.dynamic_stiffness(expected_coefficients(train.unknowns.coefficients, speed))
        planes = len(train.unknowns.unbalances)
        response = train.output @ np.linalg.solve(stiffness, train.force[:, :, : 2 * planes : 2])
        return cls(critical, speed, response * np.array([disc.mass for disc in machine.discs]))

    def growth(self, speed: Floats) -> Floats:
        """Compute weights that extract from samples the part that grows as a response does, without a constant part.

        Args:
            speed: Speeds of the samples (S,) [rad/s].

        Returns:
            Weights (S,) to sum the samples with [s²/rad²].
        """
        law = speed**2 / (1.0 - (speed / self.critical) ** 2)
        law = law - np.mean(law)
        return np.asarray(law / (law @ law))

    def chance_forward(self, place: ProbeStation, *, direction: int) -> float:
        """Compute the chance that the orbit's growth turns forward, over independent Gaussian unbalances of all discs.

        For u and v of zero mean P(|u| > |v|) = ½ + ½ (a - b) / √((a + b)² - 4|c|²) with a = E|u|², b = E|v|², c = E u v*.

        Source: own derivation: ratio of two Gaussian quadratic forms, as stated above.

        Args:
            place: The station.
            direction: Sense of rotation, +1 or -1.

        Returns:
            Chance [-].
        """
        x, y = self._axes(place)
        positive, negative = x + 1j * y, x - 1j * y
        a, b = float(np.sum(np.abs(positive) ** 2)), float(np.sum(np.abs(negative) ** 2))
        c = abs(complex(np.vdot(positive, negative)))
        spread = math.sqrt(max((a + b) ** 2 - 4.0 * c**2, (a - b) ** 2))
        return 0.5 if spread == 0.0 else 0.5 + 0.5 * direction * (a - b) / spread

    def size(self, place: ProbeStation) -> float:
        """Compute the rms of the orbit's growth at a station, over such unbalances.

        Source: own derivation: root of the sum over independent unbalances.

        Args:
            place: The station.

        Returns:
            Rms per eccentricity of the discs [s²/rad²], in the same unit for all stations.
        """
        return float(np.linalg.norm(self._axes(place)))

    def _axes(self, place: ProbeStation) -> Complexes:
        """Compute the growth along x and y (2, P) per unbalance of each disc."""
        grown = np.einsum("s,smp->mp", self.growth(self.speed), self.influence[:, list(place.columns)])
        return np.asarray(np.linalg.pinv(place.directions) @ grown)


class _SenseUndetectable(Exception):
    """The sense of an orbit cannot be judged."""


def _growing_orbit(machine: Machine, measurement: Measurement, place: ProbeStation, expected: ExpectedOrbits) -> StationOrbits:
    """Compute the one orbit that grows with the speed at a station. Raises _SenseUndetectable."""
    if len(place.channels) < 2:
        raise _SenseUndetectable("one probe alone sees no orbit")
    if not place.sees_both_axes:
        raise _SenseUndetectable("the probes look along one line")
    chance = expected.chance_forward(place, direction=machine.direction)
    if chance < CERTAIN_FORWARD:
        raise _SenseUndetectable(f"the model's own orbit is forward for {100 * chance:.0f} % of all unbalances only")
    limit = BELOW_CRITICAL * expected.critical
    axes = axis_phasors(place, phasor=measurement.phasor, usable=measurement.usable)
    direction = 1.0 if np.sum(measurement.direction) >= 0.0 else -1.0
    which = axes.known & (measurement.speed <= limit) & (measurement.direction == direction)
    speed = measurement.speed[which]
    below = f"below {rad_per_s_to_rpm(limit):.0f} r/min, where it is certain"
    if speed.size < FEWEST_SAMPLES:
        raise _SenseUndetectable(f"{speed.size} samples {below}; {FEWEST_SAMPLES} are needed")
    if np.ptp(speed) < NARROWEST * limit:
        raise _SenseUndetectable(f"the speeds {below}, lie too near to each other")
    error = np.where(measurement.usable, _noise_error(machine, measurement), 0.0)[which][:, list(place.columns)]
    return _orbit_of_growth(place, axes.pick(which), expected.growth(speed), error, direction)


def _orbit_of_growth(place: ProbeStation, axes: AxisPhasors, growth: Floats, error: Floats, direction: float) -> StationOrbits:
    """Compute the one orbit that grows with the speed; its error is as large as the rest beside it and a constant."""
    x, y = np.asarray(axes.x @ growth, dtype=complex), np.asarray(axes.y @ growth, dtype=complex)
    law = growth / float(growth @ growth)
    left = sum(float(np.sum(np.abs(v - np.mean(v) - one * law) ** 2)) for v, one in ((axes.x, x), (axes.y, y)))
    noise = float(np.sum(np.einsum("sak,sk->as", axes.inverse**2, error**2)))
    if noise > 0.0:
        error = error * max(1.0, math.sqrt(left / noise * growth.size / (growth.size - 2)))
    inverse = np.einsum("s,sak->ask", growth, axes.inverse).reshape(1, 2, -1)
    return _orbits(place, x.reshape(1), y.reshape(1), inverse, error.reshape(1, -1), np.array([direction]))


def _noise_error(machine: Machine, measurement: Measurement) -> Floats:
    """Compute the rms of the complex error (S, m) [m] of each phasor."""
    amplitude = np.where(measurement.usable, np.abs(measurement.phasor), 0.0)
    return error_size(machine.noise, amplitude, measurement.scatter)


def _orbits(
    place: ProbeStation, x: Complexes, y: Complexes, inverse: Floats, error: Floats, direction: Floats
) -> StationOrbits:
    """Compute orbits (S,) from x and y, which `inverse` (S, 2, k) makes from values with independent circular errors
    (S, k)."""
    ellipse = orbit(x, y, direction=1)
    positive, negative = x + 1j * y, x - 1j * y  # twice the circle from +x to +y, twice the conjugate of the other
    # δ|z| = Re(z* δz / |z|) and δ arg z = Im(δz / z), each with δz = Σ row · δ(value).
    with np.errstate(invalid="ignore"):
        by_positive = (inverse[:, 0] + 1j * inverse[:, 1]) / np.where(positive == 0.0, NO_RADIUS, positive)[:, None]
        by_negative = (inverse[:, 0] - 1j * inverse[:, 1]) / np.where(negative == 0.0, NO_RADIUS, negative)[:, None]
    first, second = (np.abs(positive) / 2)[:, None] * by_positive, (np.abs(negative) / 2)[:, None] * by_negative

    def spread(row: NDArray[Any]) -> Floats:
        # The real part of a circular error has half of its variance.
        return np.asarray(np.sqrt(np.sum(np.abs(row) ** 2 * error**2, axis=1) / 2))

    return StationOrbits(
        place=place,
        x=x,
        y=y,
        semi_major=ellipse.semi_major,
        semi_minor=direction * ellipse.semi_minor,
        inclination=ellipse.inclination,
        semi_major_error=spread(first + second),
        semi_minor_error=spread(first - second),
        inclination_error=spread((by_positive - by_negative) / 2),
    )
