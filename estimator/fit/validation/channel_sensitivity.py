"""Effects of errors that a fit leaves out: a channel's gain, a channel's run-out, and the run-out of a coupling.

A fit takes the measuring chains, and the bores and faces of couplings, as the document describes them. Beside its estimates it
can say, to first order, how each would move if a gain or run-out were another, and how much better the data would then be
explained: the score and the information of those errors (Rao, Proc. Camb. Phil. Soc. 44 (1948) 50,
doi:10.1017/S0305004100023987), from one more linearisation at the fitted point. A diagnosis tells a drifting probe from a
changing bearing by this, and a coupling's run-out, which turns with the shaft, from an unbalance.
"""

from collections.abc import Mapping

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.fit.optimisation.reweighting import with_fitted_noise
from estimator.fit.problem.channel_errors import with_every_channel
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.machine.document import Machine
from estimator.machine.parameter_description import COMPONENTS, ROTATING_ERRORS, describe
from estimator.machine.parts import RotatingError
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.condensation import condense
from estimator.rotor.parameters import unknowns
from estimator.rotor.response import excitation_responses

MOSTLY_LEFT_OUT = 0.3
"""Part of a channel's phasors [-]; where more was left out, the channel itself is at fault and all of its phasors are used."""
LARGE = RotatingError(offset_spread=1e-4, angle_spread=1e-3)
"""Run-outs of which hardly anything is believed."""
ROTATING_UNIT = {"rotating_offset": 1e-6, "rotating_angle": 1e-5}
"""Units of couplings' errors meanwhile [m, rad]."""


class ChannelEffects(Struct, frozen=True, eq=False):
    """Errors of channels and couplings that a fit of n coordinates left out, e of them.

    Attributes:
        names: Names of the errors, such as `probe.B1L.gain.real` [-], `probe.B1L.run_out.real` [m] and
            `coupling.C1.rotating_offset.real` [m].
        bias: Shift (n, e) of the fit's point, taken off it when an error of one unit is allowed for [SI per unit of the
            error].
        information: Information (e, e) of the errors beside all coordinates [1/unit²].
        score: Half the derivative (e,) of -χ² by the errors [1/unit].
        phasors: Number of used phasors of each of the m channels.
        amplitude: Median amplitude of the used phasors of each of the m channels [m], 0 where none was used.
        at: Errors (e,) that the fit was linearised at [unit]; None for none at all.
        point: Values (n,) of the fit with these errors [SI or 1]; None where they are its own.
        covariance: Covariance (n, n) of these, the errors being what they are [SI² or 1]; None where it is its own.
    """

    names: tuple[str, ...]
    bias: Floats
    information: Floats
    score: Floats
    phasors: tuple[int, ...]
    amplitude: tuple[float, ...]
    at: Floats | None = None
    point: Floats | None = None
    covariance: Floats | None = None

    @property
    def errors(self) -> Floats:
        """Return the errors (e,) that it was linearised at, 0 where it was so without them [unit]."""
        return np.zeros(len(self.names)) if self.at is None else self.at

    def estimate(self, point: Floats, covariance: Floats) -> tuple[Floats, Floats]:
        """Return the estimates that the effects are about.

        Args:
            point: Values (n,) of the fit itself [SI or 1].
            covariance: Their covariance (n, n) [SI² or 1].

        Returns:
            Values (n,) and covariance (n, n) with the errors that were found along, else those of the fit [SI or 1].
        """
        return (
            point if self.point is None else self.point,
            covariance if self.covariance is None else self.covariance,
        )


def channel_effects(
    problem: FitProblem, found: FitResult, *, inflation: float = 1.0, at: Mapping[str, float] | None = None
) -> ChannelEffects:
    """Compute the effects of every gain and run-out, of channels and couplings, that the fit did not identify along.

    Source: score and information after Rao (1948, doi:10.1017/S0305004100023987).

    Args:
        problem: The fit's problem.
        found: The fit.
        inflation: Factor by which the fit's covariance was widened [-]; the information and the score are divided by it.
        at: Errors of channels, by name, that the fit found along, at which everything is linearised [unit]; None for none.

    Returns:
        Effects of e errors.
    """
    final, own = with_fitted_noise(problem, found), problem.coordinates
    extended = with_every_channel(own, problem.train.channels)
    whole = final.with_channels(extended, found.theta)
    doubtful = _discarded_channels(whole)
    theta = np.concatenate([found.theta, np.zeros(extended.size - own.size)])
    for name, error in (at or {}).items():
        place = extended.names.index(name)
        theta[place] = error / extended.unit[place]
    turning = _rotating_errors(whole, theta)
    index, added = np.arange(own.size), np.arange(own.size, extended.size + len(turning.names))

    amplitude = np.abs(whole.model(theta))
    gradient, curvature = turning.beside(whole, theta, whole.weight(amplitude, 0.0))
    unit = np.concatenate([extended.unit, turning.unit])
    precision = own.prior.precision / np.outer(own.unit, own.unit)
    among = curvature[np.ix_(index, index)] / np.outer(unit[index], unit[index]) + precision
    across = curvature[np.ix_(index, added)] / np.outer(unit[index], unit[added])
    size = np.sqrt(np.diag(among))
    bias = np.linalg.solve(among / np.outer(size, size), across / size[:, None]) / size[:, None]
    information = curvature[np.ix_(added, added)] / np.outer(unit[added], unit[added]) - across.T @ bias
    score = gradient[added] / unit[added]
    if doubtful.any():
        bias, information, score = _assess_separately(whole, theta, doubtful, added, (bias, information, score))
    used, names = whole.used, (*extended.names[own.size :], *turning.names)
    return ChannelEffects(
        names=names,
        bias=bias,
        information=information / inflation,
        score=score / inflation,
        phasors=tuple(int(count) for count in np.count_nonzero(used, axis=0)),
        amplitude=tuple(
            float(np.median(amplitude[used[:, c], c])) if used[:, c].any() else 0.0 for c in range(amplitude.shape[1])
        ),
        at=None if at is None else np.array([at.get(name, 0.0) for name in names]),
    )


def _discarded_channels(problem: FitProblem) -> NDArray[np.bool_]:
    """Mark the channels that the fit has given up (m,)."""
    usable = np.count_nonzero(problem.measurement.usable, axis=0)
    left_out = np.count_nonzero(problem.outlier & problem.measurement.usable, axis=0)
    return np.asarray(left_out > MOSTLY_LEFT_OUT * np.maximum(usable, 1))


def _assess_separately(
    problem: FitProblem,
    theta: Floats,
    doubtful: NDArray[np.bool_],
    added: NDArray[np.intp],
    effects: tuple[Floats, Floats, Floats],
) -> tuple[Floats, Floats, Floats]:
    """Compute the effects of doubtful channels' errors from all their phasors, against the fit of the others.

    Gain and run-out enter a channel's phasors linearly, so that this holds for errors of any size; the fit's own error there
    is small beside them and left out.
    """
    added = added[: problem.coordinates.size - len(effects[0])]  # behind the channels' errors stand those of couplings
    restored = replace(problem, outlier=problem.outlier & ~doubtful)
    amplitude = np.abs(restored.model(theta))
    _, gradient, curvature = restored.linearised(theta, restored.weight(amplitude, 0.0))
    unit = problem.coordinates.unit[added]
    channels = [channel for channel, bad in zip(problem.train.channels, doubtful, strict=True) if bad]
    theirs = np.array([describe(problem.coordinates.names[place]).element_id in channels for place in added])
    bias, information, score = (array.copy() for array in effects)
    theirs = np.flatnonzero(theirs)
    bias[:, theirs] = 0.0
    information[theirs], information[:, theirs] = 0.0, 0.0
    own = np.ix_(theirs, theirs)
    information[own] = (curvature[np.ix_(added, added)] / np.outer(unit, unit))[own]
    score[theirs] = (gradient[added] / unit)[theirs]
    return bias, information, score


class _RotatingErrors(Struct, frozen=True, eq=False):
    """Run-outs of couplings that are no coordinates.

    Attributes:
        names: Names of their parts (r,).
        unit: Unit of each while the matrices are built (r,) [m, rad].
        moved: What a unit of each adds to the readings (r, S, m) [m].
    """

    names: tuple[str, ...]
    unit: Floats
    moved: Complexes

    def beside(self, problem: FitProblem, theta: Floats, weight: Floats) -> tuple[Floats, Floats]:
        """Return -½ of the gradient (n + r,) of χ² and its curvature (n + r, n + r), by the coordinates and by these [-]."""
        _, gradient, curvature = problem.linearised(theta, weight)
        if not self.names:
            return gradient, curvature
        rows = len(self.names)
        weight = np.where(problem.used, weight, 0.0)
        mixed, own, score = np.zeros((theta.size, rows)), np.zeros((rows, rows)), np.zeros(rows)
        for found in problem.linear_phasors(theta):
            along, residual = found.weighted(problem.measurement.phasor, weight)
            parts = (self.moved[:, found.block] * weight[found.block]).reshape(rows, -1).view(float)
            mixed += along @ parts.T
            own += parts @ parts.T
            score += parts @ residual
        return np.concatenate([gradient, score]), np.block([[curvature, mixed], [mixed.T, own]])


def _rotating_errors(problem: FitProblem, theta: Floats) -> _RotatingErrors:
    """Return the run-outs of those couplings of which the document does not ask for them."""
    described = None if problem.train.machine is None else with_run_outs(problem.train.machine, keep=False)
    if described is None:
        return _RotatingErrors((), np.zeros(0), np.zeros((0, 0, 0), dtype=complex))
    excitations = unknowns(described, assemble_rotor(described)).excitations
    turning = [k for k, one in enumerate(excitations) if describe(one.name).quantity in ROTATING_ERRORS]
    unit = np.repeat([ROTATING_UNIT[describe(excitations[k].name).quantity] for k in turning], 2)
    moved = np.concatenate([_moved(problem, described, theta, turning, block) for block in problem.train.blocks()], axis=1)
    names = tuple(f"{excitations[k].name}.{part}" for k in turning for part in COMPONENTS)
    return _RotatingErrors(names, unit, moved * unit[:, None, None] * problem.coordinates.channels.gains(theta))


def _moved(problem: FitProblem, described: Machine, theta: Floats, turning: list[int], block: slice) -> Complexes:
    """Return what a unit of each part of some excitations adds to the readings at a block of speeds (r, S, m) [m]."""
    whole = problem.train
    train = condense(described, speed=whole.speed[block], direction=whole.direction[block])
    if problem.coordinates.scale_place.size:
        train = train.scaled(problem.coordinates.scales(theta))
    coefficients = problem.coordinates.coefficients(theta)
    each = excitation_responses(train, coefficients=coefficients if coefficients.ndim == 1 else coefficients[block])
    return each.reshape(-1, 2, *each.shape[1:])[turning].reshape(-1, *each.shape[1:])


def with_run_outs(machine: Machine, *, keep: bool) -> Machine | None:
    """Return a machine that also fits the run-outs of the couplings whose run-outs its document does not ask for.

    Args:
        machine: The machine.
        keep: Whether the run-outs that the document asks for are fitted as well.

    Returns:
        The machine; None where there is no such coupling.
    """
    if all(one.rotating_error is not None for one in machine.couplings):
        return None
    couplings = tuple(
        one.model_copy(
            update={"rotating_error": LARGE if one.rotating_error is None else one.rotating_error if keep else None}
        )
        for one in machine.couplings
    )
    return machine.model_copy(update={"couplings": couplings})
