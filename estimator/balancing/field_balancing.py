"""Field balancing of a machine from an initial run and trial runs: the correction, and what it will leave.

Influence coefficients are measured at the speeds that all runs have in common (Goodman, J. Eng. Ind. 86 (1964) 273,
doi:10.1115/1.3670532), planes that cannot be told apart are left out, and the residual unbalance is judged by ISO 21940-11
in the planes of the bearings.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.balancing.balance_quality import RotorBalance, balance_of_unbalances
from estimator.balancing.criterion import Criterion
from estimator.balancing.influence_choice import ChosenInfluence, InfluenceMethod, choose_influence
from estimator.balancing.influence_correction import InfluenceCorrection, correct
from estimator.balancing.measured_influence import MeasuredInfluence
from estimator.balancing.plane_separation import PlaneSeparation, separate_planes
from estimator.balancing.plausible_weights import doubtful_corrections, require_plausible_weights, underrated_trials
from estimator.balancing.trial_runs import (
    TrialRuns,
    TrialsUnusable,
    in_sense_of_rotation,
    weak_trials,
)
from estimator.balancing.vectors_at_speeds import WINDOW, common_speeds, vectors_at
from estimator.balancing.weight_places import SplitWeight, WeightPlaces, split_weight
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s

ROUNDING = 1e-9
"""Part of a speed, or of a weight, by which rounding may change it [-]."""
ModelInfluence = Callable[[tuple[str, ...], Floats], Complexes]
"""Function of planes and speeds (S,) that returns a model's influence coefficients (S, m, Q) [m/(kg m)]."""


@dataclass(frozen=True)
class BalancingRun:
    """A run of a machine that is to be balanced.

    Attributes:
        name: Name of the run.
        measurement: Its phasors, with the unbalances that were added; no unbalance stated means none was.
    """

    name: str
    measurement: Measurement

    @property
    def added(self) -> Complexes | None:
        """Return the unbalances (P,) that were added during the run [kg m]; None where none is stated."""
        return None if self.measurement.added is None else self.measurement.added[0]


@dataclass(frozen=True)
class BalancingOptions:
    """Bounds of a correction, and the grade by which it is judged.

    Attributes:
        planes: Ids of the discs to correct in; None for those that had trial weights.
        criterion: What is minimised.
        limit: Largest correction by disc [kg m]; discs that are not named have none.
        places: Places for weights by disc.
        grade: Balance quality grade G asked for [mm/s].
        service_speed: Speed at which the machine works [rad/s]; None for the end of its speed range.
        method: Method of the influence coefficients; None for the one that predicts best.
        speed: Speeds to balance at (S,) [rad/s]; None for all that the runs have in common.
    """

    planes: tuple[str, ...] | None = None
    criterion: Criterion = "least-squares"
    limit: Mapping[str, float] = field(default_factory=dict)
    places: Mapping[str, WeightPlaces] = field(default_factory=dict)
    grade: float = 2.5
    service_speed: float | None = None
    method: InfluenceMethod | None = None
    speed: Floats | None = None


@dataclass(frozen=True)
class FieldBalancing:
    """A correction from trial runs, with all that it came from.

    Attributes:
        machine: The machine.
        options: What was asked.
        speed: Speeds at which it is balanced (S,) [rad/s].
        runs: The runs' vectors at these speeds; points are channels at speeds, speed by speed.
        choice: Influence coefficients of all planes that had trial weights.
        separation: Planes that can be told apart.
        correction: The correction in these planes.
        known: Influence coefficients of all planes with trial weights that can be told apart, corrected in or not.
        splits: Masses by plane, where its places are known.
        before: Residual unbalance before the correction by rotor; not known on a rotor with a disc of which it is not.
        after: Residual unbalance predicted after it.
        notes: Sentences on what is doubtful.
    """

    machine: Machine
    options: BalancingOptions
    speed: Floats
    runs: TrialRuns
    choice: ChosenInfluence
    separation: PlaneSeparation
    correction: InfluenceCorrection
    known: MeasuredInfluence
    splits: Mapping[str, SplitWeight]
    before: tuple[RotorBalance, ...]
    after: tuple[RotorBalance, ...]
    notes: tuple[str, ...]

    @property
    def unknown_discs(self) -> tuple[str, ...]:
        """Return the discs whose own unbalance the runs do not tell."""
        return tuple(disc.id for disc in self.machine.discs if disc.id not in self.known.planes)

    @property
    def unbalance(self) -> Complexes:
        """Return the correction (Q,), angles from +x to +y [kg m]."""
        return in_sense_of_rotation(self.correction.weight, self.machine.direction)

    @property
    def service_speed(self) -> float:
        """Return the speed at which residual unbalances are judged [rad/s]."""
        return self.options.service_speed or rpm_to_rad_per_s(self.machine.speed_range.maximum_rpm)


def balance_from_trials(
    machine: Machine,
    initial: Sequence[BalancingRun],
    trials: Sequence[BalancingRun],
    *,
    options: BalancingOptions | None = None,
    model: ModelInfluence | None = None,
) -> FieldBalancing:
    """Compute a correction from initial runs and trial runs (Goodman 1964, doi:10.1115/1.3670532).

    Args:
        machine: The machine.
        initial: Runs before any trial weight, or with the weights that they state.
        trials: Runs with trial weights, each with all that was on.
        options: What the correction may be; None for the usual.
        model: A model's influence coefficients, to be compared with the measured ones; None without a model.

    Returns:
        The correction, with what it will leave.

    Raises:
        TrialsUnusable: The runs cannot determine a correction.
        NoCommonSpeed: The runs have no speed in common.
        BalancingFailed: No best correction was found within the limits.
    """
    asked = options or BalancingOptions()
    _require_weights(machine, trials)
    speed = _speeds(machine, [*initial, *trials], asked)
    every, left_points = vectors_of(machine, [*initial, *trials], speed).determined()
    choice = choose_influence(every, model=_at_points(every, speed, machine, model), method=asked.method)
    separation = separate_planes(choice.influence.pick(_planes(machine, every, asked)))
    if not separation.planes:
        raise TrialsUnusable("; ".join(separation.words))
    proposal, splits = _proposal(machine, choice.influence.pick(separation.planes), asked)
    found = FieldBalancing(
        machine=machine,
        options=asked,
        speed=speed,
        runs=every,
        choice=choice,
        separation=separation,
        correction=proposal,
        known=choice.influence.pick(separate_planes(choice.influence).planes),
        splits=splits,
        before=(),
        after=(),
        notes=(
            *separation.words,
            *weak_trials(every),
            *underrated_trials(machine, every),
            *_point_notes(left_points),
            *_disc_notes(machine, every),
            *_repeat_notes(choice),
        ),
    )
    doubts = doubtful_corrections(machine, separation.planes, found.unbalance, speed=found.service_speed)
    return _with_residuals(replace(found, notes=(*found.notes, *doubts)))


def _require_weights(machine: Machine, trials: Sequence[BalancingRun]) -> None:
    if not trials:
        raise TrialsUnusable("no run has a trial weight: a correction needs the initial run and a trial on each plane")
    for run in trials:
        if run.added is None or not np.any(run.added != 0.0):
            raise TrialsUnusable(
                f"{run.name} states no trial weight: its sidecar, or the request, needs the disc, amount and angle"
            )
        require_plausible_weights(machine, run.added, name=run.name)


def _proposal(
    machine: Machine, influence: MeasuredInfluence, asked: BalancingOptions
) -> tuple[InfluenceCorrection, dict[str, SplitWeight]]:
    """Compute the correction, and put it on the places that planes have; the prediction is of what these really give."""
    limit = np.array([asked.limit.get(plane, np.inf) for plane in influence.planes])
    best = correct(influence, criterion=asked.criterion, limit=limit)
    unbalances = in_sense_of_rotation(best.weight, machine.direction)
    splits = {
        plane: split_weight(complex(one), asked.places[plane])
        for plane, one in zip(influence.planes, unbalances, strict=True)
        if plane in asked.places
    }
    given = [
        splits[plane].unbalance if plane in splits else one for plane, one in zip(influence.planes, unbalances, strict=True)
    ]
    return best.installed(in_sense_of_rotation(np.array(given, dtype=complex), machine.direction)), splits


def _with_residuals(found: FieldBalancing) -> FieldBalancing:
    """Add the residual unbalances before the correction, and as they are predicted after it."""
    free = correct(found.known)
    covariance = found.known.widening**2 * free.covariance
    put_on = dict(zip(found.separation.planes, found.correction.weight.tolist(), strict=True))
    after = np.array([put_on.get(plane, 0.0) for plane in found.known.planes]) - free.weight
    return replace(
        found,
        before=residual_balance(found, -free.weight, covariance),
        after=residual_balance(found, after, covariance),
    )


def vectors_of(machine: Machine, runs: Sequence[BalancingRun], speed: Floats) -> TrialRuns:
    """Collect the vectors of runs at some speeds.

    Args:
        machine: The machine.
        runs: The runs.
        speed: Speeds (S,) [rad/s].

    Returns:
        The runs with the planes that have a trial weight in any of them.

    Raises:
        TrialsUnusable: A run turned against the document's rotation.
    """
    for run in runs:
        if np.any(run.measurement.direction != machine.direction):
            raise TrialsUnusable(f"{run.name} turned against the rotation of the document, which is {machine.rotation}")
    found = [vectors_at(run.measurement, speed, noise=machine.noise) for run in runs]
    discs = [disc.id for disc in machine.discs]
    added = np.array([np.zeros(len(discs)) if run.added is None else run.added for run in runs], dtype=complex)
    whole = TrialRuns(
        names=tuple(run.name for run in runs),
        planes=tuple(discs),
        points=tuple(f"{channel} at {rad_per_s_to_rpm(one):.0f} r/min" for one in speed for channel in machine.channels),
        vector=np.array([vector.reshape(-1) for vector, _ in found]),
        added=in_sense_of_rotation(added, machine.direction),
        error=np.array([error.reshape(-1) for _, error in found]),
    )
    loaded = [disc for disc, column in zip(discs, added.T, strict=True) if np.any(column != 0.0)]
    return whole.with_planes(loaded)


def residual_balance(found: FieldBalancing, weight: Complexes, covariance: Complexes) -> tuple[RotorBalance, ...]:
    """Judge residual unbalances of the rotors (ISO 21940-11).

    A rotor's are not known where one of its discs had no trial run, or cannot be told apart from others.

    Args:
        found: The correction, for these planes and what was asked.
        weight: Residual unbalances as weights (Q,) [kg m].
        covariance: Their covariance (Q, Q), E[e eᴴ], of the widths that intervals shall have [kg² m²].

    Returns:
        One balance per rotor that has discs and two bearings or more.
    """
    discs = [disc.id for disc in found.machine.discs]
    rows = [discs.index(plane) for plane in found.known.planes]
    unbalance = np.zeros(len(discs), dtype=complex)
    unbalance[rows] = in_sense_of_rotation(weight, found.machine.direction)
    turned = in_sense_of_rotation(covariance, found.machine.direction) / 2.0
    whole = np.zeros((len(discs), 2, len(discs), 2))
    for row, disc in enumerate(rows):
        for column, other in enumerate(rows):
            one = turned[row, column]
            whole[disc, :, other, :] = [[one.real, -one.imag], [one.imag, one.real]]
    speed = found.service_speed
    judged = balance_of_unbalances(
        found.machine,
        unbalance=unbalance,
        covariance=whole.reshape(2 * len(discs), -1),
        grade=found.options.grade,
        service_speed=speed,
        maximum_continuous_speed=speed,
    )
    shafts = {disc.shaft for disc in found.machine.discs}
    return tuple(_as_far_as_known(found, one) for one in judged if one.shaft in shafts)


def _as_far_as_known(found: FieldBalancing, rotor: RotorBalance) -> RotorBalance:
    """Return a rotor's balance with what is not known of it: residuals are zero where they were never looked for."""
    own = [disc.id for disc in found.machine.discs if disc.shaft == rotor.shaft and disc.id in found.unknown_discs]
    untried = [disc for disc in own if disc not in found.runs.planes]
    alike = [disc for disc in own if disc in found.runs.planes]
    untold = "; ".join(
        [f"plane {disc} had no trial run" for disc in untried]
        + [f"plane {disc} cannot be told apart from others, or from the scatter" for disc in alike]
    )
    first, second = (replace(one, untold=untold, is_whole=not found.unknown_discs) for one in rotor.planes)
    return replace(rotor, planes=(first, second))


def _speeds(machine: Machine, runs: Sequence[BalancingRun], asked: BalancingOptions) -> Floats:
    """Return the speeds to balance at, inside the document's range."""
    if asked.service_speed is not None:
        _require_in_range(machine, [asked.service_speed], "the service speed ")
    lowest, highest = _range(machine)
    if asked.speed is None:
        return common_speeds([run.measurement for run in runs], lowest=lowest, highest=highest)
    _require_in_range(machine, asked.speed, "")
    _require_recorded(runs, asked.speed)
    # Measuring points are told to 1 r/min: speeds nearer to each other are one.
    _, first = np.unique(np.round(rad_per_s_to_rpm(1.0) * asked.speed), return_index=True)
    return np.asarray(asked.speed, dtype=float)[first]


def _require_recorded(runs: Sequence[BalancingRun], speed: Iterable[float]) -> None:
    """Check for speeds [rad/s] that fewer than two runs have. Raises TrialsUnusable."""
    recorded = [run.measurement.speed for run in runs]
    unseen = [
        rad_per_s_to_rpm(one) for one in speed if sum(bool(np.any(np.abs(own - one) <= WINDOW * one)) for own in recorded) < 2
    ]
    if unseen:
        known = "; ".join(
            f"{run.name} has {rad_per_s_to_rpm(float(own.min())):.0f} to {rad_per_s_to_rpm(float(own.max())):.0f} r/min"
            for run, own in zip(runs, recorded, strict=True)
            if own.size
        )
        raise TrialsUnusable(
            f"{', '.join(f'{one:.6g}' for one in unseen)} r/min was not recorded by two runs, within {100 * WINDOW:g} %: "
            f"{known}"
        )


def _range(machine: Machine) -> tuple[float, float]:
    """Return the document's speed range [rad/s]."""
    return rpm_to_rad_per_s(machine.speed_range.minimum_rpm), rpm_to_rad_per_s(machine.speed_range.maximum_rpm)


def _require_in_range(machine: Machine, speed: Iterable[float], what: str) -> None:
    """Check for speeds [rad/s] outside the document's range. what: words before them. Raises TrialsUnusable."""
    lowest, highest = _range(machine)
    outside = [rad_per_s_to_rpm(one) for one in speed if not lowest * (1 - ROUNDING) <= one <= highest * (1 + ROUNDING)]
    if outside:
        raise TrialsUnusable(
            f"{what}{', '.join(f'{one:.6g}' for one in outside)} r/min lies outside the document's range, "
            f"{machine.speed_range.minimum_rpm:g} to {machine.speed_range.maximum_rpm:g} r/min"
        )


def _planes(machine: Machine, runs: TrialRuns, asked: BalancingOptions) -> tuple[str, ...]:
    planes = runs.planes if asked.planes is None else asked.planes
    discs = [disc.id for disc in machine.discs]
    unknown = [plane for plane in (*planes, *asked.limit, *asked.places) if plane not in discs]
    if unknown:
        raise TrialsUnusable(f"{', '.join(unknown)}: no such disc; the discs are {', '.join(discs)}")
    bare = [plane for plane in planes if plane not in runs.planes]
    if bare:
        raise TrialsUnusable(
            f"no trial weight was on {', '.join(bare)}: its influence is not known; run a trial with a weight there"
        )
    return tuple(plane for plane in runs.planes if plane in planes)


def _at_points(runs: TrialRuns, speed: Floats, machine: Machine, model: ModelInfluence | None) -> Complexes | None:
    """Return a model's coefficients (K, Q) at the measuring points that the runs show."""
    if model is None:
        return None
    names = [f"{channel} at {rad_per_s_to_rpm(one):.0f} r/min" for one in speed for channel in machine.channels]
    whole = model(runs.planes, speed).reshape(len(names), -1)
    return np.asarray(whole[[names.index(point) for point in runs.points]])


def _disc_notes(machine: Machine, runs: TrialRuns) -> list[str]:
    bare = [disc.id for disc in machine.discs if disc.id not in runs.planes]
    if not bare:
        return []
    return [
        f"no trial weight was on {', '.join(bare)}: what their unbalances do counts as if it came from "
        f"{', '.join(runs.planes)}, in the residual unbalance, too"
    ]


def _repeat_notes(choice: ChosenInfluence) -> list[str]:
    if np.isfinite(choice.influence.freedom):
        return []
    return [
        "no run was repeated: intervals and promises hold the noise of the vectors, but not how the rotor settles anew at "
        "each start; a repeated initial run would tell"
    ]


def _point_notes(left_out: tuple[str, ...]) -> list[str]:
    shown = ", ".join(left_out[:4]) + (f" and {len(left_out) - 4} more" if len(left_out) > 4 else "")
    return [f"left out, as the runs do not all show them: {shown}"] if left_out else []
