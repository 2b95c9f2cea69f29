"""Simulates a run-down of a machine, to try methods and thresholds on."""

import cmath
import math
from collections.abc import Mapping
from dataclasses import replace
from numbers import Integral, Real
from typing import get_args

import numpy as np
from msgspec import structs

from estimator.arrays import Complexes
from estimator.close_matches import did_you_mean
from estimator.errors import Invalid
from estimator.machine.document import Machine
from estimator.phasors.channel_status import ChannelStatus
from estimator.phasors.measurement import MeasuredGaps, Measurement
from estimator.phasors.recorded_run import RecordedRun
from estimator.simulation.scenarios import Scenario
from estimator.simulation.simulated_gaps import simulated_gaps
from estimator.simulation.simulated_plant import draw_truth, speed_law, swept_phasors, truth_at_progress, truth_of_run
from estimator.units import KILOGRAM_METRES
from rotorundown.machine_files import checked_machine
from rotorundown.runs import MachineRun, sent_gaps

DURATION_S = 600.0
FEWEST_SAMPLES = 2


class NotSimulated(Invalid):
    """Raised for a run that cannot be simulated; the message says what can."""


def simulate(
    machine: Machine,
    *,
    scenario: Scenario = "healthy",
    progress: float = 1.0,
    samples: int = 200,
    seed: int = 1,
    run_seed: int = 1,
    duration_s: float = DURATION_S,
    weights: Mapping[str, tuple[float, float]] | None = None,
) -> MachineRun:
    """Simulate one run-down.

    Args:
        machine: The machine; its document must state nominal values.
        scenario: What happens to it, such as `misalignment`.
        progress: How far that has gone, from 0 to 1 [-].
        samples: Number of samples.
        seed: Seed of the machine: the same one in every run.
        run_seed: Seed of the run: its scatter and noise.
        duration_s: Duration [s].
        weights: Trial weights that are on by disc: what each adds to the unbalance [g mm], and its angle from +x towards +y
            when the keyphasor's pulse comes [°].

    Returns:
        The run, with its true parameters.

    Raises:
        WrongMachine: The machine is a copy that contradicts itself.
        NotSimulated: There is no such scenario, or a number is out of its range.
        ValueError: The document does not say enough to simulate from.
    """
    _require_possible(machine, scenario, progress, samples, duration_s)
    _require_seeds(seed=seed, run_seed=run_seed)
    true = truth_at_progress(draw_truth(machine, np.random.default_rng(seed)), machine, scenario, progress)
    rng = np.random.default_rng([seed, run_seed])
    time, speed = speed_law(machine, "run-down", duration=duration_s, samples=samples)
    of_run = truth_of_run(true, rng)
    added = _added(machine, weights or {})
    loaded = replace(of_run, unbalances=of_run.unbalances + added)
    phasor = swept_phasors(machine, loaded, time=time, speed=speed, rng=rng)
    place = simulated_gaps(machine, of_run, time=time, speed=speed, rng=rng)
    status = np.full(phasor.shape, ChannelStatus.GOOD, dtype=np.uint8)
    recorded = RecordedRun(time, speed, phasor, status, np.full(phasor.shape, np.nan), machine.channels)
    measurement = Measurement.of(speed=speed, phasor=phasor, direction=machine.direction)
    if weights:
        measurement = structs.replace(measurement, added=np.tile(added, (samples, 1)))
    if place is not None:
        measurement = structs.replace(measurement, gaps=MeasuredGaps(place, time, np.zeros(time.size, np.intp)))
    return MachineRun(
        f"simulated {scenario}",
        machine.channels,
        recorded,
        measurement,
        units="as simulated, in SI",
        truth=of_run.parameters,
        gap_um=sent_gaps(measurement, machine),
    )


def _require_possible(machine: Machine, scenario: str, progress: float, samples: int, duration_s: float) -> None:
    if not isinstance(machine, Machine):
        raise NotSimulated(f"the machine is a {type(machine).__name__}: read it first, with read_machine(…)")
    checked_machine(machine)
    scenarios = get_args(Scenario)
    if scenario not in scenarios:
        raise NotSimulated(
            f"there is no scenario {scenario!r}: there are {', '.join(scenarios)}{did_you_mean(str(scenario), scenarios)}"
        )
    if not 0.0 <= progress <= 1.0:
        raise NotSimulated(f"progress {progress:g} is not from 0 to 1")
    if not isinstance(samples, Integral):
        raise NotSimulated(f"samples is a whole number, not {samples!r}")
    if samples < FEWEST_SAMPLES:
        raise NotSimulated(f"a run has {FEWEST_SAMPLES} samples at least, not {samples}")
    if not 0.0 < duration_s < float("inf"):
        raise NotSimulated(f"a run takes some time: duration_s {duration_s:g} is not above 0 s")


def _require_seeds(**seeds: int) -> None:
    for name, seed in seeds.items():
        if not isinstance(seed, Integral) or seed < 0:
            raise NotSimulated(f"{name} is a whole number from 0 up, not {seed!r}")


def _added(machine: Machine, weights: Mapping[str, tuple[float, float]]) -> Complexes:
    """Return the unbalance (P,) that trial weights add [kg m]. Raises NotSimulated."""
    discs = [disc.id for disc in machine.discs]
    added = np.zeros(len(discs), dtype=complex)
    if not isinstance(weights, Mapping) or any(not isinstance(one, tuple | list) or len(one) != 2 for one in weights.values()):
        raise NotSimulated(f"weights are an amount [g mm] and an angle [°] by disc, such as {{'{discs[0]}': (50.0, 90.0)}}")
    for disc, (amount, angle) in weights.items():
        if disc not in discs:
            known = did_you_mean(str(disc), discs) or f": there are {', '.join(discs)}"
            raise NotSimulated(f"there is no disc {disc!r} for a trial weight{known}")
        numbers = isinstance(amount, Real) and isinstance(angle, Real)
        if not (numbers and 0.0 < amount < math.inf and math.isfinite(angle)):
            raise NotSimulated(f"a trial weight has an amount above 0 g mm and an angle, not {amount!r} g mm at {angle!r}°")
        added[discs.index(disc)] = cmath.rect(amount * KILOGRAM_METRES["g mm"], math.radians(angle))
    return added
