"""Simulates a run-down of a machine, to try methods and thresholds on."""

from dataclasses import replace

import numpy as np

from estimator.machine.document import Machine
from estimator.phasors.channel_status import ChannelStatus
from estimator.phasors.measurement import MeasuredGaps, Measurement
from estimator.phasors.recorded_run import RecordedRun
from estimator.simulation.simulated_gaps import simulated_gaps
from estimator.simulation.simulated_plant import draw_truth, measured_phasors, speed_law, truth_at_progress, truth_of_run
from estimator.simulation.stories import Story
from rotorundown.runs import MachineRun

DURATION_S = 600.0


def simulate(
    machine: Machine,
    *,
    story: Story = "healthy",
    progress: float = 1.0,
    samples: int = 200,
    seed: int = 1,
    run_seed: int = 1,
    duration_s: float = DURATION_S,
) -> MachineRun:
    """Simulate one run-down.

    Args:
        machine: The machine; its document must state nominal values.
        story: What happens to it, such as `misalignment`.
        progress: How far that has gone, from 0 to 1 [-].
        samples: Number of samples.
        seed: Seed of the machine: the same one in every run.
        run_seed: Seed of the run: its scatter and noise.
        duration_s: Duration [s].

    Returns:
        The run, with its true parameters.

    Raises:
        ValueError: The document does not say enough to simulate from.
    """
    true = truth_at_progress(draw_truth(machine, np.random.default_rng(seed)), machine, story, progress)
    rng = np.random.default_rng([seed, run_seed])
    time, speed = speed_law(machine, "run-down", duration=duration_s, samples=samples)
    of_run = truth_of_run(true, rng)
    phasor = measured_phasors(machine, of_run, speed, rng)
    place = simulated_gaps(machine, of_run, time=time, speed=speed, rng=rng)
    status = np.full(phasor.shape, ChannelStatus.GOOD, dtype=np.uint8)
    recorded = RecordedRun(time, speed, phasor, status, np.full(phasor.shape, np.nan), machine.channels)
    measurement = Measurement.of(speed=speed, phasor=phasor, direction=machine.direction)
    if place is not None:
        measurement = replace(measurement, gaps=MeasuredGaps(place, time, np.zeros(time.size, np.intp)))
    return MachineRun(
        f"simulated {story}", machine.channels, recorded, measurement, units="as simulated, in SI", truth=of_run.parameters
    )
