"""Updated model: a machine with the values that an identification found, and their covariance."""

import math
from collections.abc import Callable
from functools import cached_property

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from estimator.arrays import Complexes, Floats
from estimator.fit.identification import Identification
from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.document import Machine
from estimator.machine.film_parameter_names import with_open_forces
from estimator.machine.scaled_materials import with_scaled_materials
from estimator.rotor.condensation import CondensedTrain, condense
from estimator.rotor.identity_cache import cached_for_runs
from estimator.rotor.modal_reduction import Basis, modal_basis
from estimator.rotor.system_matrices import SystemMatrices, system_matrices_over_speed
from estimator.units import rpm_to_rad_per_s

HIGHEST_FREQUENCY = 2.5
"""Multiple of the speed range's end up to which natural frequencies are of interest [-]."""


class UpdatedModel(Struct, frozen=True, eq=False, dict=True):
    """A machine and the n coordinates that an identification found, without those of its measuring chains.

    Attributes:
        machine: The machine with exact probes, so that predictions are of the shaft's motion.
        coordinates: Names of the n coordinates.
        values: Values (n,) [SI, logarithms of direct terms and scale factors].
        covariance: Covariance (n, n) of the values [SI²].

    Raises:
        ValueError: The coordinates are not the machine's, or values and covariance have another shape.
    """

    machine: Machine
    coordinates: tuple[str, ...]
    values: Floats
    covariance: Floats

    def __post_init__(self) -> None:
        expected = _coordinates(self.machine).names
        if self.coordinates != expected:
            raise ValueError(f"machine '{self.machine.id}' has other coordinates: {', '.join(expected)}")
        size = len(expected)
        if np.shape(self.values) != (size,) or np.shape(self.covariance) != (size, size):
            raise ValueError(f"{size} values and a covariance of ({size}, {size}) are needed")

    @classmethod
    def of(cls, machine: Machine, *, coefficients: Floats, unbalances: Complexes, covariance: Floats) -> "UpdatedModel":
        """Build a model of constant coefficients, with no other excitation than unbalances, E and ρ as documented.

        Args:
            machine: The machine.
            coefficients: Coefficients (K,) [SI].
            unbalances: Complex unbalances (P,) [kg m].
            covariance: Covariance (n, n) of the coordinates [SI²].

        Returns:
            The model.

        Raises:
            ValueError: A direct term is not positive.
        """
        exact = with_exact_probes(machine)
        coordinates = _coordinates(exact)
        theta = coordinates.with_coefficients(np.zeros(coordinates.size), np.asarray(coefficients, dtype=float))
        first = coordinates.excitation_place[: len(unbalances)]
        theta[first], theta[first + 1] = np.real(unbalances), np.imag(unbalances)
        return cls(exact, coordinates.names, coordinates.point(theta), covariance)

    def coordinates_at(self, speed: Floats) -> Coordinates:
        """Return the map from coordinates to physical parameters at some speeds.

        Args:
            speed: Speeds (S,) [rad/s].

        Returns:
            The map.
        """
        return _coordinates(self.machine).at_speeds(np.asarray(speed, dtype=float))

    def coefficients(self, speed: float) -> Floats:
        """Compute the coefficients at a spin speed.

        Args:
            speed: Spin speed [rad/s, without sign].

        Returns:
            Coefficients (K,) [SI].
        """
        coordinates = self.coordinates_at(np.array([speed]))
        return np.asarray(coordinates.coefficients(coordinates.theta(self.values)).reshape(-1))

    @property
    def excitations(self) -> Complexes:
        """Return the excitations (E,) [SI], the unbalances first."""
        coordinates = _coordinates(self.machine)
        return coordinates.excitations(coordinates.theta(self.values))

    @property
    def scale_factors(self) -> dict[str, float]:
        """Return the factor [-] on each modulus and density that was identified, by name."""
        coordinates = _coordinates(self.machine)
        factors = coordinates.scales(coordinates.theta(self.values))
        return dict(zip(_reference(self.machine).scale_names, map(float, factors), strict=True))

    @cached_property
    def scaled_machine(self) -> Machine:
        """Return the machine with the identified scale factors of E and ρ put into its materials."""
        return with_scaled_materials(self.machine, self.scale_factors)

    @property
    def basis(self) -> Basis:
        """Return the basis of `matrices`: all degrees of freedom of a mesh that is not large.

        It is the same for all values of a machine. Its modes up to `HIGHEST_FREQUENCY` times its highest speed, and up to the
        frequencies of its impact test, are as on the whole mesh.
        """
        tested = self.machine.impact_test.frequencies_hz if self.machine.impact_test is not None else ()
        highest = HIGHEST_FREQUENCY * rpm_to_rad_per_s(self.machine.speed_range.maximum_rpm)
        return modal_basis(self.machine, max(highest, 2 * math.pi * max(tested, default=0.0)))

    @cached_property
    def matrices(self) -> Callable[[float], SystemMatrices]:
        """Return the function that gives the train's matrices over `basis` at a spin speed [rad/s, without sign]."""
        constant = not _coordinates(self.machine).models
        return system_matrices_over_speed(
            self.scaled_machine,
            coefficients=self.coefficients(1.0) if constant else self.coefficients,
            basis=self.basis,
        )

    def turning(self, direction: int) -> "UpdatedModel":
        """Return the same machine turning in a given sense.

        Args:
            direction: +1 from +x to +y, -1 against it.

        Returns:
            The model.
        """
        if direction == self.machine.direction:
            return self
        rotation = "positive" if direction > 0 else "negative"
        return replace(self, machine=self.machine.model_copy(update={"rotation": rotation}))


def updated_model(machine: Machine, identification: Identification) -> UpdatedModel:
    """Build the model that an identification of the machine leads to.

    Parameters that are not estimable take part with the fit's values, which nobody should read by themselves: the uncertainty
    they leave together with the others is in the covariance. Static loads that the document calls exact and the fit doubts are
    coordinates of the model besides: loads on bearings follow from them at once, and not by the fitted coordinates alone.

    Args:
        machine: The machine.
        identification: Its identification.

    Returns:
        The model.

    Raises:
        ValueError: The identification is of another machine.
    """
    doubted = identification.doubted_forces
    if not doubted:
        return model_at(machine, identification.coordinates, identification.point, identification.covariance)
    opened, stated = with_open_forces(machine, {one.name: one.size for one in doubted})
    along = np.column_stack([one.answer * one.size for one in doubted])
    size = np.diag([one.size for one in doubted])
    covariance = np.block([[identification.covariance, along @ size], [size @ along.T, size**2]])
    names = (*identification.coordinates, *(one.name for one in doubted))
    return model_at(opened, names, np.concatenate([identification.point, stated]), covariance)


def model_at(machine: Machine, coordinates: tuple[str, ...], point: Floats, covariance: Floats | None = None) -> UpdatedModel:
    """Build the model at values of named coordinates; those of measuring chains are left out.

    Args:
        machine: The machine.
        coordinates: Names of the n coordinates.
        point: Values (n,) [SI, logarithms of direct terms and scale factors].
        covariance: Covariance (n, n) [SI²]; None for exact values.

    Returns:
        The model.

    Raises:
        ValueError: The coordinates are of another machine.
    """
    exact = with_exact_probes(machine)
    names = _coordinates(exact).names
    missing = [name for name in names if name not in coordinates]
    if missing:
        raise ValueError(f"the identification is not of machine '{machine.id}': it lacks {', '.join(missing)}")
    rows = [coordinates.index(name) for name in names]
    whole = np.zeros((len(coordinates), len(coordinates))) if covariance is None else covariance
    return UpdatedModel(exact, names, point[rows], whole[np.ix_(rows, rows)])


def expected_model(machine: Machine) -> UpdatedModel:
    """Build the model that a machine's document expects before anything is identified, taken as exactly known.

    Args:
        machine: The machine.

    Returns:
        The model.
    """
    exact = with_exact_probes(machine)
    coordinates = _coordinates(exact)
    size = coordinates.size
    return UpdatedModel(exact, coordinates.names, coordinates.point(coordinates.centre), np.zeros((size, size)))


def documented_model(machine: Machine) -> UpdatedModel:
    """Build the model that a document tells: the values of its calibration with their covariance, all others as expected.

    Args:
        machine: The machine.

    Returns:
        The model; a calibration's unbalances are those on average over its mountings.
    """
    expected, calibration = expected_model(machine), machine.calibration
    if calibration is None:
        return expected
    rows = {name: row for row, name in enumerate(calibration.parameters)}
    places = [place for place, name in enumerate(expected.coordinates) if name in rows]
    known = [rows[expected.coordinates[place]] for place in places]
    values, covariance = expected.values.copy(), expected.covariance.copy()
    values[places] = np.array(calibration.values)[known]
    covariance[np.ix_(places, places)] = np.array(calibration.covariance)[np.ix_(known, known)]
    return replace(expected, values=values, covariance=covariance)


@cached_for_runs
def with_exact_probes(machine: Machine) -> Machine:
    """Return the machine without gain errors and run-outs of its channels.

    Args:
        machine: The machine.

    Returns:
        The machine with exact probes.
    """
    exact = {"gain_spread": 0.0, "run_out_spread": 0.0}
    return machine.model_copy(update={"probes": tuple(probe.model_copy(update=exact) for probe in machine.probes)})


@cached_for_runs
def _reference(machine: Machine) -> CondensedTrain:
    """Condense the machine at any one speed, to learn its coordinates from."""
    return condense(machine, speed=np.ones(1), direction=np.ones(1))


@cached_for_runs
def _coordinates(machine: Machine) -> Coordinates:
    """Return the machine's coordinates at that speed: their names, centre and spread are those at any."""
    return Coordinates.of(_reference(machine), unbalance_scale=1.0)
