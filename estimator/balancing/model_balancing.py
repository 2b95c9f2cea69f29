"""Balancing with the updated model: which unbalance to add in which plane, and what vibration is left then.

Influence coefficients (Goodman, J. Eng. Ind. 86 (1964) 273, doi:10.1115/1.3670532) come from the model, so that no trial
weights are run. The correction minimises the weighted squares of the vibration predicted at chosen probes and speeds.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from estimator.arrays import Complexes, Floats
from estimator.updated_model.forced_response import ForcedResponse, forced_response
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.uncertainty import PhasorBand

OPTIMAL = 1e-6
"""Part of the squares by which no single plane may lower them for a limited correction to be accepted."""


class BalancingFailed(ValueError):
    """Raised when no correction within the limits was found to be the best one."""


@dataclass(frozen=True)
class Correction:
    """Unbalances to add to Q planes, and their effect at m channels and S speeds.

    Attributes:
        planes: Ids of the Q discs.
        channels: Ids of the m probes.
        speed: Speeds (S,) [rad/s].
        unbalance: Unbalances to add (Q,) [kg m]; angles count as those of the residual unbalances: from the keyphasor mark, +x
            to +y.
        before: Vibration (S, m) before the correction, 0-to-peak [m], with 95 % bands.
        after: Vibration (S, m) predicted for this very correction, 0-to-peak [m], with 95 % bands.
        condition_number: Condition number of the influence coefficients [-], columns scaled to equal length; beyond some
            hundreds different corrections do nearly the same, and limits are advisable.
    """

    planes: tuple[str, ...]
    channels: tuple[str, ...]
    speed: Floats
    unbalance: Complexes
    before: PhasorBand
    after: PhasorBand
    condition_number: float


@dataclass(frozen=True)
class CorrectionMass:
    """A mass to add to a plane.

    Attributes:
        plane: Id of the disc.
        grams: Mass [g].
        angle_deg: Angle [°], 0 to 360, from the keyphasor mark, +x to +y.
    """

    plane: str
    grams: float
    angle_deg: float


def influence_coefficients(
    model: UpdatedModel, *, planes: Sequence[str], speed: Floats, channels: Sequence[str] | None = None
) -> Complexes:
    """Compute the vibration per unbalance in each plane (Goodman 1964, doi:10.1115/1.3670532).

    The vibration is Σ H U for rotation from +x to +y, and Σ H conj(U) against it.

    Args:
        model: The identified model.
        planes: Ids of Q discs.
        speed: Speeds (S,), positive [rad/s].
        channels: Ids of m probes; None for all.

    Returns:
        Influence coefficients H (S, m, Q) [m/(kg m)].

    Raises:
        ValueError: A plane or channel is unknown or named twice, none is named, or a speed is not positive.
    """
    picked, seen = _planes(model, planes), _channels(model, channels)
    found = forced_response(model, speed=speed)
    return _of_planes(found, picked, seen)


def balance(
    model: UpdatedModel,
    *,
    planes: Sequence[str],
    speed: Floats,
    channels: Sequence[str] | None = None,
    weight: Floats | None = None,
    limit: Floats | None = None,
) -> Correction:
    """Compute the correction that leaves the least weighted squares of vibration.

    Influence coefficients of the model (Goodman 1964, doi:10.1115/1.3670532).

    Args:
        model: The identified model.
        planes: Ids of Q discs to correct in.
        speed: Speeds (S,), positive [rad/s].
        channels: Ids of m probes; None for all.
        weight: Weight (S, m) of each vibration [-]; None for 1 everywhere.
        limit: Largest correction (Q,) in each plane [kg m]; None for no limit.

    Returns:
        The correction, with the vibration before and after it.

    Raises:
        ValueError: A plane or channel is unknown or named twice, none is named, a speed is not positive, or weights or limits
            have another shape or are negative.
        BalancingFailed: No best correction was found within the limits.
    """
    speed = np.asarray(speed, dtype=float)
    picked, seen = _planes(model, planes), _channels(model, channels)
    found = forced_response(model, speed=speed)
    influence = _of_planes(found, picked, seen)
    weights = _checked(weight, "weight", influence.shape[:2], default=1.0)
    limits = _checked(limit, "limit", (len(planes),), default=np.inf)
    matrix = (influence * weights[:, :, None]).reshape(-1, len(planes))
    # With one column per plane of equal length, the solver sees planes alike.
    length = np.linalg.norm(matrix, axis=0)
    length = np.where(length > 0.0, length, 1.0)
    scaled, target = matrix / length, -(found.phasor[:, seen] * weights).reshape(-1)
    phasor = least_squares_within(scaled, target, limits * length) / length
    unbalance = phasor if model.machine.direction > 0 else np.conj(phasor)
    added = np.zeros_like(model.excitations)
    added[picked] = unbalance
    return Correction(
        planes=tuple(planes),
        channels=tuple(model.machine.channels[number] for number in seen),
        speed=speed,
        unbalance=unbalance,
        before=_at_channels(found, seen).band(model),
        after=_at_channels(forced_response(model, speed=speed, added=added), seen).band(model),
        condition_number=float(np.linalg.cond(scaled)),
    )


def correction_masses(correction: Correction, *, radius: Sequence[float]) -> tuple[CorrectionMass, ...]:
    """Convert a correction to masses at a radius of each plane.

    Args:
        correction: Correction in Q planes.
        radius: Radius of each of the Q planes [m].

    Returns:
        Mass [g] and angle [°] for each plane.

    Raises:
        ValueError: The radii are not Q positive numbers.
    """
    if len(radius) != len(correction.planes) or not all(one > 0 for one in radius):
        raise ValueError(f"a positive radius [m] is needed for each of {len(correction.planes)} planes, not {list(radius)}")
    return tuple(
        CorrectionMass(plane=plane, grams=1e3 * abs(one) / at, angle_deg=float(np.degrees(np.angle(one)) % 360.0))
        for plane, one, at in zip(correction.planes, correction.unbalance, radius, strict=True)
    )


def least_squares_within(matrix: Complexes, target: Complexes, limit: Floats) -> Complexes:
    """Minimise |A c - b|² with |c_q| ≤ limit_q.

    The shortest c is taken where several minimise it. Units are those of the arguments.

    Source: standard result: least squares within bounds, by sequential quadratic programming.

    Args:
        matrix: A (n, Q) [-].
        target: b (n,) [-].
        limit: Largest magnitude (Q,) of each unknown [-]; may be infinite.

    Returns:
        c (Q,) [-].

    Raises:
        BalancingFailed: The solver ended at a point that is not the minimum.
    """
    free: Complexes = np.linalg.lstsq(matrix, target, rcond=None)[0].astype(complex)
    if np.all(np.abs(free) <= limit):
        return free
    result = np.zeros(limit.size, dtype=complex)
    used = limit > 0.0
    if np.any(used):
        scale = float(np.linalg.norm(target))
        # A plane without limit gets one that no sensible answer reaches.
        bound = np.where(np.isfinite(limit), limit, 1e6 * (scale + np.abs(free))) / scale
        result[used] = scale * _limited(matrix[:, used], target / scale, bound[used])
    return result


def _limited(matrix: Complexes, target: Complexes, bound: Floats) -> Complexes:
    """Minimise for targets of length 1 and bounds that are positive and finite, by sequential quadratic programming."""
    normal, moment = np.conj(matrix).T @ matrix, np.conj(matrix).T @ target

    def squares(parts: Floats) -> float:
        c = _paired(parts)
        return float(np.vdot(c, normal @ c).real - 2 * np.vdot(moment, c).real)

    def slope(parts: Floats) -> Floats:
        return 2 * _interleaved(normal @ _paired(parts) - moment)

    def room(parts: Floats) -> Floats:
        return np.asarray(1.0 - (parts[::2] ** 2 + parts[1::2] ** 2) / bound**2)

    def room_slope(parts: Floats) -> Floats:
        rows = np.arange(bound.size)
        whole = np.zeros((bound.size, parts.size))
        whole[rows, 2 * rows], whole[rows, 2 * rows + 1] = -2 * parts[::2] / bound**2, -2 * parts[1::2] / bound**2
        return whole

    found = scipy.optimize.minimize(
        squares,
        np.zeros(2 * bound.size),
        jac=slope,
        method="SLSQP",
        constraints=scipy.optimize.NonlinearConstraint(room, 0.0, np.inf, jac=room_slope),
        options={"ftol": 1e-14, "maxiter": 1000},
    )
    c = _shortened(_paired(found.x), bound)
    # Each plane alone: the best it can do is where the squares are least, or as near to it as the bound lets it.
    own = np.real(np.diag(normal))
    wanted = c + (moment - normal @ c) / np.where(own > 0.0, own, 1.0)
    gain = own * (np.abs(c - wanted) ** 2 - np.abs(_shortened(wanted, bound) - wanted) ** 2)
    if np.max(gain) > OPTIMAL:
        raise BalancingFailed(f"no best correction within the limits was found: {found.message}")
    return c


def _shortened(phasors: Complexes, bound: Floats) -> Complexes:
    return np.asarray(phasors * np.minimum(1.0, bound / np.maximum(np.abs(phasors), 1e-300)), dtype=complex)


def _paired(parts: Floats) -> Complexes:
    return np.asarray(parts[::2] + 1j * parts[1::2], dtype=complex)


def _interleaved(phasors: Complexes) -> Floats:
    return np.asarray(np.stack([phasors.real, phasors.imag], axis=-1).reshape(-1), dtype=float)


def _of_planes(found: ForcedResponse, planes: list[int], seen: list[int]) -> Complexes:
    """Pick the influence (S, m, Q) of the real part of each plane's unbalance; discs' unbalances are the first excitations."""
    return np.asarray(found.influence[:, seen][:, :, [2 * plane for plane in planes]])


def _at_channels(found: ForcedResponse, seen: list[int]) -> ForcedResponse:
    return replace(found, phasor=found.phasor[:, seen], slope=found.slope[:, seen])


def _planes(model: UpdatedModel, planes: Sequence[str]) -> list[int]:
    return _numbers("plane", planes, [disc.id for disc in model.machine.discs])


def _channels(model: UpdatedModel, channels: Sequence[str] | None) -> list[int]:
    known = list(model.machine.channels)
    return _numbers("channel", known if channels is None else channels, known)


def _numbers(kind: str, wanted: Sequence[str], known: list[str]) -> list[int]:
    for one in wanted:
        if one not in known:
            raise ValueError(f"'{one}' is not one of the {kind}s: {', '.join(known)}")
    if len(set(wanted)) != len(wanted) or not wanted:
        raise ValueError(f"{kind}s must be named once each, at least one: {', '.join(wanted)}")
    return [known.index(one) for one in wanted]


def _checked(values: Floats | None, name: str, shape: tuple[int, ...], *, default: float) -> Floats:
    if values is None:
        return np.full(shape, default)
    checked = np.asarray(values, dtype=float)
    if checked.shape != shape or not np.all(checked >= 0.0):
        raise ValueError(f"{name} must hold {' × '.join(map(str, shape))} numbers that are not negative")
    return checked
