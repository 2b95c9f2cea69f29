"""2× of a simulated machine: a stated part of its 1×, which grows beside a coupling that goes out of alignment.

Both parts are choices of this simulation, not measured ones. A misalignment shows in the 2× at the probes beside its coupling
(J. Piotrowski, Shaft Alignment Handbook, 3rd ed., CRC Press 2006, ch. 2); by how much is different from train to train.
"""

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.machine.coupling_neighbours import probes_beside
from estimator.machine.document import Machine
from estimator.simulation.scenarios import Scenario
from estimator.simulation.simulated_plant import noise

PART = 0.1
"""Amplitude of the 2× over that of the 1× of a healthy machine [-]."""
MISALIGNED_PART = 0.3
"""Ratio beside a misaligned coupling at the end of its scenario [-]."""


def second_parts(machine: Machine, scenario: Scenario, progress: float) -> Floats:
    """Return the 2× over the 1× at each probe when a scenario has gone a part of its way.

    Args:
        machine: The machine, with m channels.
        scenario: The scenario.
        progress: Part of its way, from 0 (healthy) to 1 [-].

    Returns:
        Parts (m,) [-].
    """
    beside = set(probes_beside(machine, machine.couplings[0])) if scenario == "misalignment" and machine.couplings else set()
    return np.array([PART + progress * (MISALIGNED_PART - PART) * (one in beside) for one in machine.channels])


def simulated_second(
    machine: Machine, phasors: Complexes, *, parts: Floats, phases: Floats, rng: np.random.Generator
) -> Complexes:
    """Draw the 2× phasors of samples, with the document's noise.

    Args:
        machine: The machine, with m channels.
        phasors: 1× phasors (S, m) [m].
        parts: The 2× over the 1× (m,) [-].
        phases: Phases of the 2× (m,) against twice those of the 1× [rad].
        rng: Random generator.

    Returns:
        Phasors (S, m) [m].
    """
    clean = parts * np.abs(phasors) * np.exp(1j * (2.0 * np.angle(phasors) + phases))
    return np.asarray(clean + noise(machine.noise, clean, rng))
