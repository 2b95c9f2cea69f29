"""Case A₁, the thesis's smallest misalignment, as growth of the coupling's and the neighbouring bearings' coefficients.

The thesis prints by how much the first three natural frequencies of its rig rose (Table 5.5, pure angular, 0.16°), and that no
coefficient grew by more than 12 % (§5.7). One factor on all coefficients of the coupling and of the bearings on either side of
it, direct and cross-coupled, stiffness and damping, makes `examples/thesis-chapter-5-rig.yaml` rise by the same on average.
No factor gives each of the three: on the rig's first mode the supports have next to no influence.
"""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import scipy.optimize
import yaml

from estimator.arrays import Floats
from estimator.machine.coupling_neighbours import neighbouring_bearings
from estimator.machine.document import Machine, parse_machine
from estimator.machine.parts import Coupling
from estimator.modes.eigenmodes import natural_frequencies
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.parameters import unknowns

EXAMPLES = Path(__file__).parents[2] / "examples"
RIG = "thesis-chapter-5-rig"
PRINTED_RISE = (0.0200, 0.0140, 0.0054)
"""Relative rise of the first three natural frequencies in case A₁, thesis Table 5.5."""
LARGEST_GROWTH = 2.0


@cache
def example(name: str) -> Machine:
    """Return a machine of `examples/`."""
    return parse_machine(yaml.safe_load((EXAMPLES / f"{name}.yaml").read_text(encoding="utf-8")))


def misaligned_elements(machine: Machine, coupling: Coupling) -> tuple[str, ...]:
    """Return the elements that a misalignment stiffens: the coupling and the bearings on either side of it."""
    return (f"coupling.{coupling.id}", *(f"bearing.{one}" for one in neighbouring_bearings(machine, coupling)))


def rises(machine: Machine, coupling: Coupling, growth: float) -> Floats:
    """Return the relative rise (3,) of the first three natural frequencies at standstill, each the mean of its two planes.

    growth: growth of all coefficients of the coupling and of its neighbouring bearings.
    """
    elements = misaligned_elements(machine, coupling)
    known = unknowns(machine, assemble_rotor(machine)).coefficients
    expected = np.array([one.expected for one in known])
    grown = expected * (1.0 + growth * np.array([one.element in elements for one in known]))
    planes = 2 * len(PRINTED_RISE)
    before = natural_frequencies(machine, coefficients=expected)[:planes]
    after = natural_frequencies(machine, coefficients=grown)[:planes]
    return np.asarray((after / before - 1.0).reshape(-1, 2).mean(axis=1))


@cache
def case_a1() -> float:
    """Return the growth with which the rig's three natural frequencies rise by what the thesis prints, on average."""
    return _solved(lambda rise: float(np.mean(rise - PRINTED_RISE)))


@cache
def case_a1_least_squares() -> float:
    """Return the growth with the smallest sum of squared differences from the three printed rises."""
    rig = example(RIG)

    def misfit(growth: float) -> float:
        return float(np.sum((rises(rig, rig.couplings[0], growth) - PRINTED_RISE) ** 2))

    return float(scipy.optimize.minimize_scalar(misfit, bounds=(0.0, LARGEST_GROWTH), method="bounded").x)


def growth_for(mode: int) -> float:
    """Return the growth with which one of the three rises as printed. Raises ValueError when there is none."""
    return _solved(lambda rise: float(rise[mode] - PRINTED_RISE[mode]))


def _solved(off: Callable[[Floats], float]) -> float:
    rig = example(RIG)

    def at(growth: float) -> float:
        return off(rises(rig, rig.couplings[0], growth))

    return float(scipy.optimize.brentq(at, 0.0, LARGEST_GROWTH, xtol=1e-6))
