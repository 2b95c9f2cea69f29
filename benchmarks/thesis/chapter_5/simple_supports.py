"""The rig on simple supports as in §5.6: what rotary inertia, mesh and coupling give its 155.7, 239.3 and 419.9 Hz."""

import copy
import math
from dataclasses import dataclass

import numpy as np
import scipy.optimize

from benchmarks.documents import Document
from benchmarks.thesis.flexible.experiments import Subject
from benchmarks.thesis.flexible.misprints import natural_frequencies, with_printed_rotary_inertia
from estimator.arrays import Floats
from estimator.machine.document import parse_machine
from estimator.rotor.assembly import assemble_rotor
from estimator.thesis.flexible_train import flexible_train
from estimator.thesis.rig import nominal_values

PRINTED_HZ = (155.7, 239.3, 419.9)
RIGID = 1e11
"""Stiffness [N/m] of a simple support."""
STARTS = ((1e5, 10.0), (1e7, 1e3))
"""Coupling stiffnesses [N/m, N m/rad] from which the search starts."""
SMALLEST, LARGEST = (1e2, 1e-2), (1e10, 1e7)
"""Bounds of the coupling's stiffnesses [N/m, N m/rad]."""


@dataclass(frozen=True)
class CouplingFit:
    """The coupling that comes nearest to the printed frequencies.

    elements: per shaft. lateral [N/m], angular [N m/rad]: its stiffnesses. frequencies: (3,) [Hz]. misfit: rms of the
    frequencies' logarithms [-].
    """

    elements: int
    lateral: float
    angular: float
    frequencies: Floats
    misfit: float


def fit_coupling(document: Document, *, element_length: float, printed_inertia: bool) -> CouplingFit:
    """Fit the coupling's two stiffnesses to the three frequencies of one plane.

    Shafts of Appendix C (16 and 12 mm, span 0.208 m, no coupling halves), discs of Table 5.1 with its moments of inertia.
    element_length: longest element [m]. printed_inertia: rotary inertia of Eq. A.5-A.8 as printed instead of ρI.
    """
    target = np.log(PRINTED_HZ)

    def frequencies(logarithms: Floats) -> Floats:
        subject = _subject(document, element_length, *np.exp(logarithms))
        whole = natural_frequencies(with_printed_rotary_inertia(subject) if printed_inertia else subject)
        return np.asarray(whole[:6:2] / (2 * math.pi))

    def misfit(logarithms: Floats) -> Floats:
        return np.asarray(np.log(frequencies(logarithms)) - target)

    bounds = (np.log(SMALLEST), np.log(LARGEST))
    candidates = [scipy.optimize.least_squares(misfit, np.log(start), bounds=bounds) for start in STARTS]
    found = min(candidates, key=lambda one: float(one.cost))
    lateral, angular = np.exp(found.x)
    machine = _subject(document, element_length, lateral, angular).machine
    return CouplingFit(
        elements=len(assemble_rotor(machine).stations["S1"]) - 1,
        lateral=float(lateral),
        angular=float(angular),
        frequencies=frequencies(found.x),
        misfit=float(np.sqrt(np.mean(found.fun**2))),
    )


def _subject(document: Document, element_length: float, lateral: float, angular: float) -> Subject:
    changed = copy.deepcopy(document)
    for shaft, diameter in zip(changed["shafts"], (0.016, 0.012), strict=True):
        shaft["sections"] = [{"length": 0.27, "outer_diameter": diameter, "material": "steel"}]
    for disc, inertia in zip(changed["discs"], (8.25e-6, 18.2e-6), strict=True):
        disc.update({"diametral_inertia": inertia, "polar_inertia": 2 * inertia})
    for bearing in changed["bearings"]:
        bearing.update({"kxx": RIGID, "kyy": RIGID, "kxy": 0.0, "kyx": 0.0})
    coupling = {"kxx": lateral, "kyy": lateral, "kxy": 0.0, "kyx": 0.0, "k_phix": angular, "k_phiy": angular}
    changed["couplings"][0].update({name: float(value) for name, value in coupling.items()})
    changed["element_length"] = element_length
    machine = parse_machine(changed)
    coefficients, unbalances = nominal_values(machine)
    return Subject(changed, machine, flexible_train(machine), coefficients, unbalances)
