"""Simulation of a plant's machine: its true parameters over the weeks, its coast-downs and run-ups, and noisy phasors."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import scipy

from estimator.arrays import Complexes, Floats
from estimator.bearings.model import ModelParameter
from estimator.machine.coupling_neighbours import neighbouring_bearings
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.machine.rules import Noise
from estimator.machine.scaled_materials import with_scaled_materials
from estimator.phasors.sweep_transient import SweptTrain, sweep_transient
from estimator.quantities import Quantity
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.coefficient_models import expected_coefficients, expects_a_law, governing_models
from estimator.rotor.condensation import condense
from estimator.rotor.parameters import Unknowns, unknowns
from estimator.rotor.response import response
from estimator.runs.segmentation import RunKind
from estimator.simulation.scenarios import Scenario
from estimator.simulation.simulated_films import SimulatedFilms, draw_films
from estimator.trends.covariates import usual_change
from estimator.units import rpm_to_rad_per_s

TRUTH_SPREAD = 0.08
"""Standard deviation of the logarithm of each coefficient by which a machine differs from its document [-]."""
RUN_SCATTER: dict[Quantity, float] = {"damping": 0.02, "angular damping": 0.02, "unbalance": 0.01}
"""Relative run-to-run scatter of the true parameters by quantity [-]."""
OTHER_RUN_SCATTER = 0.005
"""Relative run-to-run scatter of the quantities not named there, stiffnesses and inertias [-]."""
COUPLING_STIFFENING = 0.6
"""Relative growth of a coupling's coefficients at the end of the misalignment scenario [-]."""
BEARING_STIFFENING = 0.25
"""Relative growth of the coefficients of the bearings beside it at the end of the misalignment scenario [-]."""
CONDITION_LEVEL = 5.0
"""Mean of a simulated operating condition in usual changes of it [-]: 50 °C, 100 %."""
SEASON, WEATHER = 1.0, 0.3
"""Swing of a condition over a year, and its scatter from run to run, in usual changes [-]."""
CONDITION_EFFECT = -0.01
"""Change of the logarithm of every bearing coefficient by a usual change of each condition [-]."""
YEAR_S = 365.25 * 86_400.0
"""Length of a year [s]."""
INTERPOLATED_SPEEDS = 33
"""Number of speeds between which the coefficients of a sweep are interpolated."""
UNBALANCE_GROWTH = 1.5 * np.exp(0.7j)
"""Factor on one disc's unbalance at the end of the unbalance scenario: larger and elsewhere [-]."""


@dataclass(frozen=True)
class Truth:
    """True parameters of a simulated machine.

    Attributes:
        unknowns: Names and expectations of coefficients and excitations.
        coefficients: Coefficients (K,), of those that follow a table over speed the values in the middle of the speed range
            [SI].
        unbalances: Complex unbalances (P,) [kg m].
        factors: Factors by name on E and density of the materials that the document does not take as known [-].
        films: Oil films that the bearings' coefficients follow from, in place of those in `coefficients`; None where they
            follow from none.
    """

    unknowns: Unknowns
    coefficients: Floats
    unbalances: Complexes
    factors: dict[str, float]
    films: SimulatedFilms | None = None

    @property
    def parameters(self) -> dict[str, float]:
        """Return the true values by name: coefficients but for those that follow from films, films, factors [SI]."""
        of_films = () if self.films is None else self.films.coefficients
        named = zip((one.name for one in self.unknowns.coefficients), self.coefficients.tolist(), strict=True)
        own = {} if self.films is None else self.films.parameters
        return {name: value for name, value in named if name not in of_films} | dict(own) | self.factors


def draw_truth(machine: Machine, rng: np.random.Generator) -> Truth:
    """Draw a machine near its document: every coefficient off by some per cent, unbalances turned and scaled.

    Args:
        machine: The machine.
        rng: Random generator.

    Returns:
        The truth.

    Raises:
        ValueError: The document leaves a direct term or a disc's unbalance without a nominal value.
    """
    unknown = unknowns(machine, assemble_rotor(machine))
    missing = [c.name for c in unknown.coefficients if c.direct and c.nominal is None and c.form.whole_train is None]
    missing += [p.name for p in unknown.unbalances if p.nominal is None]
    if missing:
        raise ValueError(f"to simulate '{machine.id}' its document must give nominal values of {', '.join(missing)}")
    expected = np.array([c.expected for c in unknown.coefficients])
    factor = np.exp(TRUTH_SPREAD * rng.standard_normal(expected.size))
    nominal = np.array([p.nominal for p in unknown.unbalances], dtype=complex)
    turned = nominal * np.exp(0.1 * rng.standard_normal(nominal.size) + 0.3j * rng.standard_normal(nominal.size))
    train = condense(machine, speed=np.ones(1), direction=np.ones(1))
    drawn = np.exp(train.scale_spread * rng.standard_normal(train.scale_spread.size)).tolist()
    for where, off in _factors_of_laws(unknown, rng, lambda one: one.spread):
        factor[where] = off
    factors = dict(zip(train.scale_names, drawn, strict=True))
    stiffness = _by_name(unknown, expected * factor)
    return Truth(unknown, expected * factor, turned, factors, draw_films(machine, stiffness, rng))


def truth_at_progress(truth: Truth, machine: Machine, scenario: Scenario, progress: float) -> Truth:
    """Return the truth when a scenario has gone a part of its way.

    Args:
        truth: Truth of the healthy machine.
        machine: The machine.
        scenario: The scenario.
        progress: Part of its way, from 0 (healthy) to 1 [-].

    Returns:
        The truth then.

    Raises:
        ValueError: The scenario is of misalignment and the machine has no coupling.
    """
    if scenario == "misalignment":
        return _misaligned(truth, machine, progress)
    if scenario == "unbalance":
        unbalances = truth.unbalances.copy()
        unbalances[0] *= 1.0 + progress * (UNBALANCE_GROWTH - 1.0)
        return replace(truth, unbalances=unbalances)
    return truth


def _misaligned(truth: Truth, machine: Machine, progress: float) -> Truth:
    """Make the first coupling and the bearings beside it stiffer and more damped, cross-coupled terms too (thesis §5.7); on
    oil films, lower the bearings behind it."""
    if not machine.couplings:
        raise ValueError(f"'{machine.id}' has no coupling that could be misaligned")
    coupling = machine.couplings[0]
    if truth.films is not None:
        return replace(truth, films=truth.films.settled(machine, coupling, progress))
    growth = {f"coupling.{coupling.id}": COUPLING_STIFFENING}
    growth |= {f"bearing.{bearing}": BEARING_STIFFENING for bearing in neighbouring_bearings(machine, coupling)}
    factor = np.array([1.0 + progress * growth.get(c.element, 0.0) for c in truth.unknowns.coefficients])
    return replace(truth, coefficients=truth.coefficients * factor)


def truth_of_run(truth: Truth, rng: np.random.Generator) -> Truth:
    """Draw the true parameters of one run: load and temperature differ a little from run to run.

    Args:
        truth: Truth of the machine.
        rng: Random generator.

    Returns:
        Truth of the run.
    """
    size = np.array([RUN_SCATTER.get(c.quantity, OTHER_RUN_SCATTER) for c in truth.unknowns.coefficients])
    factor = 1.0 + size * rng.standard_normal(size.size)
    turn = rng.standard_normal(truth.unbalances.size) + 1j * rng.standard_normal(truth.unbalances.size)
    scatter = {one.name: float(own) for one, own in zip(truth.unknowns.coefficients, size, strict=True)}
    for where, off in _factors_of_laws(truth.unknowns, rng, lambda one: scatter[describe(one.name).coefficient]):
        factor[where] = off
    unbalances = truth.unbalances * (1 + RUN_SCATTER["unbalance"] * turn)
    coefficients = truth.coefficients * factor
    films = None if truth.films is None else truth.films.of_run(rng).with_stiffness(_by_name(truth.unknowns, coefficients))
    return replace(truth, coefficients=coefficients, unbalances=unbalances, films=films)


def _by_name(unknown: Unknowns, coefficients: Floats) -> dict[str, float]:
    return dict(zip((one.name for one in unknown.coefficients), coefficients.tolist(), strict=True))


def _factors_of_laws(
    unknown: Unknowns, rng: np.random.Generator, spread: Callable[[ModelParameter], float]
) -> Iterator[tuple[list[int], Floats]]:
    """Yield the coefficients that follow a law over speed, such as a table, and factors by which they are off.

    They are off as the law's own parameters are, each drawn with its spread [-]: those of an exact table not at all.
    """
    for one in governing_models(unknown.coefficients):
        if expects_a_law(one.model):
            centre = np.array([parameter.centre for parameter in one.model.parameters])
            size = np.array([spread(parameter) for parameter in one.model.parameters])
            curves = one.model.at(np.ones(1))  # a factor at one speed is the factor at all
            drawn = curves.values(centre + size * rng.standard_normal(centre.size))[0]
            yield list(one.coefficients), _ratio(drawn, curves.values(centre)[0])


def drawn_conditions(machine: Machine, time_s: float, rng: np.random.Generator) -> Floats:
    """Draw the operating conditions of one run: a season, and the day's own.

    Args:
        machine: The machine.
        time_s: Time [s].
        rng: Random generator.

    Returns:
        Conditions (k,) in the document's order [units of the document].
    """
    size = np.array([usual_change(condition) or 1.0 for condition in machine.conditions])
    season = SEASON * np.sin(2 * np.pi * time_s / YEAR_S)
    return np.asarray(size * (CONDITION_LEVEL + season + WEATHER * rng.standard_normal(size.size)))


def truth_under_conditions(truth: Truth, machine: Machine, conditions: Floats) -> Truth:
    """Return the truth under operating conditions: oil that is warmer is thinner, and the bearings softer.

    Args:
        truth: Truth of the machine.
        machine: The machine.
        conditions: Conditions (k,) in the document's order [units of the document].

    Returns:
        The truth under these conditions.
    """
    size = np.array([usual_change(condition) or 1.0 for condition in machine.conditions])
    change = float(np.sum(conditions / size - CONDITION_LEVEL))
    if truth.films is not None:
        return replace(truth, films=truth.films.under_conditions(change))
    of_bearing = np.array([describe(c.name).element_kind == "bearing" for c in truth.unknowns.coefficients])
    return replace(truth, coefficients=truth.coefficients * np.where(of_bearing, np.exp(CONDITION_EFFECT * change), 1.0))


def speed_law(machine: Machine, kind: RunKind, *, duration: float, samples: int) -> tuple[Floats, Floats]:
    """Compute a sweep over the machine's speed range.

    A coast-down under dry friction, viscous and windage drag, ω̇ = -(a + bω + cω²), each a third of the drag at full speed; a
    run-up is its mirror image in time. The top is just inside the speed range, the bottom just below it, where a run is over.

    Args:
        machine: The machine.
        kind: Run-up or run-down.
        duration: Length of the sweep [s].
        samples: Number of samples S.

    Returns:
        Times (S,) [s] and spin speeds (S,) [rad/s].
    """
    top = 0.999 * rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    bottom = 0.95 * rpm_to_rad_per_s(machine.speed_range.minimum_rpm)
    grid = np.linspace(1.0, bottom / top, 2001)
    drag = (1.0 + grid + grid**2) / 3.0
    elapsed = np.concatenate([[0.0], np.cumsum(np.diff(1.0 - grid) * (1 / drag[1:] + 1 / drag[:-1]) / 2)])
    elapsed *= duration / elapsed[-1]
    times = np.linspace(0.0, duration, samples)
    speeds = top * np.interp(times, elapsed, grid)
    return times, speeds if kind == "run-down" else speeds[::-1].copy()


def measured_phasors(machine: Machine, truth: Truth, speed: Floats, rng: np.random.Generator) -> Complexes:
    """Compute steady-state 1× phasors with the document's noise.

    Args:
        machine: The machine, with m channels.
        truth: Its true parameters.
        speed: Speeds (S,) [rad/s].
        rng: Random generator.

    Returns:
        Phasors (S, m) [m].
    """
    clean = true_phasors(machine, truth, speed)
    return clean + noise(machine.noise, clean, rng)


def swept_phasors(machine: Machine, truth: Truth, *, time: Floats, speed: Floats, rng: np.random.Generator) -> Complexes:
    """Compute the 1× phasors of a sweep with the document's noise: the steady state, and what the sweep adds by its rate.

    What it adds is that of the modes up to 1.5 times the highest speed, not of an integration in time (`coast_down.py`).

    Source: own derivation: in the docstring of `estimator/phasors/sweep_transient.py`.

    Args:
        machine: The machine, with m channels.
        truth: Its true parameters.
        time: Times (S,), ascending [s].
        speed: Speeds (S,) [rad/s].
        rng: Random generator.

    Returns:
        Phasors (S, m) at these times [m].
    """
    clean = true_phasors(machine, truth, speed)
    known = np.linspace(float(speed.min()), float(speed.max()), INTERPOLATED_SPEEDS)
    coefficients = _over_speed(truth, known)
    follows = coefficients.ndim > 1
    train = SweptTrain(
        machine=with_scaled_materials(machine, truth.factors),
        coefficients=scipy.interpolate.CubicSpline(known, coefficients) if follows else lambda _: coefficients,
        follows_speed=follows,
        excitations=_excitations(truth),
    )
    moving = clean + sweep_transient(train, time=time, speed=speed).instant
    return moving + noise(machine.noise, moving, rng)


def true_phasors(machine: Machine, truth: Truth, speed: Floats) -> Complexes:
    """Compute steady-state 1× phasors without noise.

    Args:
        machine: The machine, with m channels.
        truth: Its true parameters.
        speed: Speeds (S,) [rad/s].

    Returns:
        Phasors (S, m) [m].
    """
    train = condense(machine, speed=speed, direction=np.full(speed.size, float(machine.direction)))
    train = train.scaled(np.array([truth.factors[name] for name in train.scale_names]))
    return response(train, coefficients=_over_speed(truth, speed), excitations=_excitations(truth))


def _excitations(truth: Truth) -> Complexes:
    """Return the excitations (E,) [SI]: a simulated machine has no bow and no misalignment load, even where its document
    allows for them."""
    excitations = np.zeros(len(truth.unknowns.excitations), dtype=complex)
    excitations[: truth.unbalances.size] = truth.unbalances
    return excitations


def _over_speed(truth: Truth, speed: Floats) -> Floats:
    """Return the true coefficients, (K,) or where some follow films or a table (S, K) [SI]; those of a table are off by the
    same factor at every speed."""
    listed = truth.unknowns.coefficients
    over = expected_coefficients(listed, speed)
    middle = np.array([one.expected for one in listed])
    if truth.films is None and np.all(over == middle):
        return truth.coefficients
    found = np.asarray(np.where(over == middle, truth.coefficients, _ratio(truth.coefficients, middle) * over))
    if truth.films is not None:
        place = {one.name: k for k, one in enumerate(listed)}
        found[:, [place[name] for name in truth.films.coefficients]] = truth.films.over_speed(speed)
    return found


def _ratio(values: Floats, reference: Floats) -> Floats:
    """Return values over their references, 1 where the reference is zero [-]."""
    return np.divide(values, reference, out=np.ones_like(values), where=reference != 0.0)


def noise(model: Noise, clean: Complexes, rng: np.random.Generator) -> Complexes:
    """Draw circular complex Gaussian errors whose rms is √((relative·|X|)² + floor²).

    Args:
        model: Noise model.
        clean: Phasors X without noise (S, m) [m].
        rng: Random generator.

    Returns:
        Errors (S, m) [m].
    """
    size = np.sqrt((model.relative * np.abs(clean)) ** 2 + model.floor**2)
    return np.asarray(size / np.sqrt(2) * (rng.standard_normal(clean.shape) + 1j * rng.standard_normal(clean.shape)))
