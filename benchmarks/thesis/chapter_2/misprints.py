"""The misprints of Chapter 2, each put into an otherwise right regression or simulation, to see what it does."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from msgspec import structs

from benchmarks.thesis.chapter_2.experiments import Experiment
from estimator.arrays import Complexes, Floats
from estimator.machine.parameter_description import describe
from estimator.rotor.condensation import CondensedTrain
from estimator.rotor.elimination import GivenShafts
from estimator.thesis.regression import Regression, solve
from estimator.thesis.rigid_regression import rigid_regression
from estimator.thesis.rigid_train import SIZE, condensed, names

GROUPS = (slice(0, 16), slice(22, 38), slice(16, 20), slice(38, 42), slice(20, 22))
"""Stiffness and damping of bearings, of the coupling, and its bending stiffness, in Table 2.1."""


@dataclass(frozen=True)
class Misprint:
    """name: what is printed. regression: the wrong regression of noise-free phasors, from an experiment."""

    name: str
    regression: Callable[[Experiment], Regression]


def shifts(subject: Experiment, misprint: Misprint) -> Floats:
    """Return the relative shift of each of the 50 unknowns."""
    return np.asarray(solve(misprint.regression(subject)).values / subject.rigid.values - 1.0)


def _rounded_sixteenth(subject: Experiment) -> Regression:
    lateral = np.array([_is_lateral_coupling(one.name) for one in subject.train.unknowns.coefficients])
    left = np.where(lateral, 0.062 * 16 * subject.train.left, subject.train.left)
    return rigid_regression(structs.replace(subject.train, left=left), subject.clean)


def _is_lateral_coupling(name: str) -> bool:
    said = describe(name)
    return said.element_kind == "coupling" and said.term is not None and {said.term.force, said.term.motion} <= {"x", "y"}


def _missing_fives(subject: Experiment) -> Regression:
    """Return the regression with k_{1,18} = k_{5,20} = 0.062 (y_b1 - y_b2 + y_b3 - y_b4), with 1/16 for 0.062."""
    right = rigid_regression(subject.train, subject.clean)
    wrong = subject.clean[:, 4:] @ np.array([1.0, -1.0, 1.0, -1.0]) / 16
    matrix = right.matrix.copy()
    half = matrix.shape[0] // 2
    for name, row in (("coupling.C.kxy", 0), ("coupling.C.kyy", 4)):
        column = names().index(name)
        matrix[row:half:SIZE, column], matrix[half + row :: SIZE, column] = wrong.real, wrong.imag
    return replace(right, matrix=matrix)


def _minus_j(subject: Experiment) -> Regression:
    right = rigid_regression(subject.train, subject.clean)
    sign = np.ones(len(names()))
    sign[22:42] = -1.0
    return replace(right, matrix=right.matrix * sign)


def _angle_times_speed(subject: Experiment) -> Regression:
    """Replace e^{jφ} by e^{jωφ}: with the unknown parts of U multiplied by it, the columns turn with the speed."""
    train = subject.train
    angle = np.repeat(np.angle(subject.rigid.unbalances), 2)
    turned = train.force * np.exp(1j * (train.direction * train.speed)[:, None, None] * angle)
    return rigid_regression(structs.replace(train, shafts=GivenShafts(train.known, turned)), subject.clean)


def _inertia(shaft_inertia: tuple[float, float]) -> Callable[[Experiment], Regression]:
    def build(subject: Experiment) -> Regression:
        wrong = condensed(
            replace(subject.rigid, shaft_inertia=shaft_inertia), speed=subject.train.speed, direction=subject.train.direction
        )
        return rigid_regression(wrong, subject.clean)

    return build


def _data_with(stiffness: Floats, damping: Floats) -> Callable[[Experiment], Regression]:
    """Take data from a dynamic stiffness with these errors added (8, 8), in units of the coupling's own coefficient."""

    def build(subject: Experiment) -> Regression:
        train = subject.train
        value = dict(zip(names(), subject.rigid.values, strict=True))
        xx, yy = np.zeros((SIZE, SIZE), bool), np.zeros((SIZE, SIZE), bool)
        xx[:4, :4], yy[4:, 4:] = True, True
        spring = stiffness * (xx * value["coupling.C.kxx"] + yy * value["coupling.C.kyy"])
        damper = damping * (xx * value["coupling.C.cxx"] + yy * value["coupling.C.cyy"])
        wrong = train.dynamic_stiffness(subject.rigid.coefficients) + spring + 1j * train.speed[:, None, None] * damper
        return rigid_regression(
            train, np.asarray(np.linalg.solve(wrong, _force(train, subject)[..., None])[..., 0], dtype=complex)
        )

    return build


def _data_with_weights(subject: Experiment) -> Regression:
    """Take data with the force vector of Eq. 2.9 as printed, weights 1 and 0.5."""
    train = subject.train
    weights = np.array([[1, 1, 0, 0], [1, 0.5, 0, 0], [0, 0, 1, 1], [0, 0, 0.5, 1.0]])
    # Against +x → +y the mirror image, with the unbalances conjugate.
    unbalance = np.where(train.direction[:, None] > 0, subject.rigid.unbalances, subject.rigid.unbalances.conj())
    along_x = train.speed[:, None] ** 2 * (unbalance @ weights.T)
    force = np.concatenate([along_x, -1j * train.direction[:, None] * along_x], axis=1)
    wrong = train.dynamic_stiffness(subject.rigid.coefficients)
    return rigid_regression(train, np.asarray(np.linalg.solve(wrong, force[..., None])[..., 0], dtype=complex))


def _force(train: CondensedTrain, subject: Experiment) -> Complexes:
    return np.asarray(train.force @ subject.rigid.values[42:])


def _single(*entries: tuple[int, int, float]) -> Floats:
    matrix = np.zeros((SIZE, SIZE))
    for row, column, value in entries:
        matrix[row - 1, column - 1] = value
    return matrix


_NOTHING = np.zeros((SIZE, SIZE))

MISPRINTS = (
    Misprint("regression: 0.062 for 1/16", _rounded_sixteenth),
    Misprint("regression: factors 5 missing in columns 18 and 20", _missing_fives),
    Misprint("regression: -jω for +jω", _minus_j),
    Misprint("regression: e^{jωφ} for e^{jφ}", _angle_times_speed),
    Misprint("regression: shaft I_d 0.0996", _inertia((0.0996, 0.0996))),
    Misprint("regression: discs' m l̄² counted twice", _inertia((0.0498 + 8 * 0.0625, 0.0498 + 8 * 0.0625))),
    Misprint("data: 5/16 for 1/16 in K_44, K_88", _data_with(_single((4, 4, 0.25), (8, 8, 0.25)), _NOTHING)),
    Misprint(
        "data: 0.312 for 1/16 in C_44, C_58, C_88",
        _data_with(_NOTHING, _single((4, 4, 0.2495), (5, 8, -0.2495), (8, 8, 0.2495))),
    ),
    Misprint("data: unbalance weights 1 and 0.5 of Eq. 2.9", _data_with_weights),
)
