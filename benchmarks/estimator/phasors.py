"""Phasors from waveforms: least squares over a block beside the thesis's band-pass and peak picking, both against the truth.

Probe at 1 kHz unless the case says otherwise, 3.2 s, blocks of 1 s of which the middle one is judged. The thesis's chain gets
the whole record for its filter and reads one maximum and one minimum behind the first pulse past the middle of that block,
where the truth is taken for it. Keyphasor: one pulse per turn with flanks of 2.5 % of a turn and noise of 1 % of its height,
at 25.6 kHz unless the case says otherwise. Phase, place of the mark and noise are drawn anew in each run, from seeds 0, 1,
2 … for every case.

The agent: `rundown edge`'s own parts, from an NPZ file of 16 channels and a keyphasor at 25.6 kHz through blocks of 1 s to the
durable log and a zenoh session, on one core, for 10 s of waveforms.

    python -m benchmarks.estimator.phasors [--runs N]
"""

import cmath
import math
import tempfile
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from benchmarks.estimator.arguments import runs_asked
from estimator.arrays import Floats
from estimator.signal.keyphasor import ShaftAngle, read_keyphasor
from estimator.signal.order_tracking import track_orders
from estimator.thesis.time_history import band_passed, extrema_phasor
from estimator.units import rpm_to_rad_per_s
from formats.wire import BINARY, Key
from service.commands.edge import open_log
from service.edge.agent import Agent
from service.edge.configuration import EdgeConfiguration
from service.messaging.session import session
from service.sources.publisher import Source

RUNS = 400
SECONDS = 3.2
BLOCK = 1.0
PROBE_RATE = 1000.0
KEYPHASOR_RATE = 25_600.0
FLANK = 0.025
"""Time of a keyphasor's flank, part of a turn."""
PULSE = 0.1
"""Length of its pulse, part of a turn."""
KEYPHASOR_NOISE = 0.01
"""Rms, part of the pulse's height."""
CHANNELS = 16
TIMED_RATE = 25_600.0
TIMED_SECONDS = 10.0

ASKED_OVER_BOUND = 1.2
ASKED_BETTER = 5.0
ASKED_AMPLITUDE = 0.5
ASKED_PHASE = 0.5
ASKED_SPEED = 5.0
ASKED_CLAIM = (0.7, 1.5)


@dataclass(frozen=True)
class ProbeSignal:
    """A simulated probe signal. Amplitudes are parts of the 1× amplitude, which grows as the square of the speed.

    rpm: at the middle of the record. ramp: [r/min per s]. snr: signal-to-noise ratio of the 1× against white noise [dB].
    second: 2×.
    hum: at hum_frequency [Hz]. step: step of the converter. probe_rate, keyphasor_rate: [Hz]. flank: flank of the keyphasor,
    part of a turn.
    """

    name: str
    rpm: float = 3000.0
    ramp: float = 0.0
    snr: float | None = None
    second: float = 0.0
    hum: float = 0.0
    hum_frequency: float = 50.0
    step: float = 0.0
    probe_rate: float = PROBE_RATE
    keyphasor_rate: float = KEYPHASOR_RATE
    flank: float = FLANK

    @property
    def noise(self) -> float:
        """Return the standard deviation of the white noise."""
        return 0.0 if self.snr is None else math.sqrt(0.5) * math.pow(10.0, -self.snr / 20.0)


NOISE = ProbeSignal("noise 26 dB, 3000 r/min", snr=26.0)
RAMP = ProbeSignal("ramp 100 r/min per s, no noise", ramp=100.0)
STEEP = ProbeSignal(
    "26 dB, 2963.7 r/min, steep keyphasor at 1 kHz", rpm=2963.7, snr=26.0, keyphasor_rate=PROBE_RATE, flank=1e-6
)
CASES = (
    ProbeSignal("nothing but 1×, 3000 r/min"),
    NOISE,
    ProbeSignal("noise 26 dB, 2963.7 r/min (off the grid)", rpm=2963.7, snr=26.0),
    STEEP,
    ProbeSignal("26 dB, 2963.7 r/min, probe at 25.6 kHz", rpm=2963.7, snr=26.0, probe_rate=KEYPHASOR_RATE),
    RAMP,
    ProbeSignal("ramp 100 r/min per s, noise 26 dB", ramp=100.0, snr=26.0),
    ProbeSignal("2× of 50 %, 2963.7 r/min", rpm=2963.7, second=0.5),
    ProbeSignal("50 Hz hum of 10 %, 2963.7 r/min (0.6 Hz off)", rpm=2963.7, hum=0.1),
    ProbeSignal("50 Hz hum of 10 %, 2850.3 r/min (2.5 Hz off)", rpm=2850.3, hum=0.1),
    ProbeSignal("50 Hz hum of 10 %, 26 dB, 2909.7 r/min (1.5 Hz off)", rpm=2909.7, hum=0.1, snr=26.0),
    ProbeSignal("50 Hz hum of 10 %, 26 dB, 2520.3 r/min (8 Hz off)", rpm=2520.3, hum=0.1, snr=26.0),
    ProbeSignal("steps of a tenth, 2963.7 r/min", rpm=2963.7, step=0.1),
    ProbeSignal("all at once: ramp, 26 dB, 2×, hum, steps", rpm=2850.3, ramp=100.0, snr=26.0, second=0.5, hum=0.1, step=0.1),
)


@dataclass(frozen=True)
class Errors:
    """Relative errors of one chain over all runs: of the phasor (rms of the complex error), mean of amplitude and phase."""

    rms: float
    amplitude_percent: float
    phase_deg: float

    @classmethod
    def of(cls, ratios: Sequence[complex]) -> "Errors":
        """Return the errors of phasors, each over the true one."""
        found = np.array(ratios)
        return cls(
            float(np.sqrt(np.mean(np.abs(found - 1.0) ** 2))),
            100.0 * float(np.mean(np.abs(found)) - 1.0),
            math.degrees(float(np.mean(np.angle(found)))),
        )


@dataclass(frozen=True)
class ChainComparison:
    """Both chains on one signal. bound: Cramér-Rao bound of the relative complex rms error; claimed: rms of own scatter."""

    case: ProbeSignal
    own: Errors
    thesis: Errors
    bound: float
    claimed: float


@dataclass(frozen=True)
class Record:
    """One draw: the waveform, the keyphasor's, and what is true."""

    probe: Floats
    keyphasor: Floats
    phase: complex
    speed_middle: float
    acceleration: float

    def phasor(self, at: float) -> complex:
        """Return the true 1× phasor at an instant [s]."""
        return self.phase * (1.0 + self.acceleration * (at - SECONDS / 2.0) / self.speed_middle) ** 2


def keyphasor_pulses(angle: Floats, flank: float) -> Floats:
    """Return the pulse height, 0 to 1, at shaft angles [rad]; the middle of the rising flank is at angle 0."""
    part = (angle / (2.0 * math.pi) + 0.5) % 1.0 - 0.5
    return np.asarray(np.clip(part / flank + 0.5, 0.0, 1.0) - np.clip((part - PULSE) / flank + 0.5, 0.0, 1.0))


def drawn(case: ProbeSignal, seed: int) -> Record:
    """Return one record of a case."""
    rng = np.random.default_rng(seed)
    speed, acceleration = rpm_to_rad_per_s(case.rpm), rpm_to_rad_per_s(case.ramp)
    mark, phase, second_phase, hum_phase = rng.uniform(0.0, 2.0 * math.pi, 4)

    def shaft(at: Floats) -> Floats:
        passed = at - SECONDS / 2.0
        return np.asarray(mark + speed * passed + acceleration * passed**2 / 2.0)

    at = np.arange(round(SECONDS * case.probe_rate)) / case.probe_rate
    angle = shaft(at)
    growth = (1.0 + acceleration * (at - SECONDS / 2.0) / speed) ** 2
    probe = growth * (np.cos(angle + phase) + case.second * np.cos(2.0 * angle + second_phase))
    probe += case.hum * np.cos(2.0 * math.pi * case.hum_frequency * at + hum_phase)
    probe += case.noise * rng.normal(size=at.size)
    if case.step:
        probe = case.step * np.round(probe / case.step)
    pulses = keyphasor_pulses(shaft(np.arange(round(SECONDS * case.keyphasor_rate)) / case.keyphasor_rate), case.flank)
    keyphasor = pulses + KEYPHASOR_NOISE * rng.normal(size=pulses.size)
    return Record(probe, keyphasor, cmath.exp(1j * phase), speed, acceleration)


def thesis_reading(record: Record, probe_rate: float, angle: ShaftAngle, middle: float) -> tuple[complex, float]:
    """Return the phasor of the thesis's chain and the instant of the pulse it was read at [s]."""
    at = np.arange(record.probe.size) / probe_rate
    pulse = float(angle.edge_time[np.searchsorted(angle.edge_time, middle)])
    frequency = float(angle.speed(np.array(pulse))) / (2.0 * math.pi)
    filtered = band_passed(record.probe, sampling_rate=probe_rate, frequency=frequency)
    return extrema_phasor(filtered, time=at, pulse=pulse, frequency=frequency), pulse


def outcome(case: ProbeSignal, runs: int) -> ChainComparison:
    """Return the results of both chains over seeds 0 to runs - 1."""
    own, thesis, scatter = [], [], []
    samples = 0
    for seed in range(runs):
        record = drawn(case, seed)
        angle = read_keyphasor(record.keyphasor, sampling_rate=case.keyphasor_rate)
        block = track_orders(record.probe[None], sampling_rate=case.probe_rate, angle=angle, seconds=BLOCK).blocks[1]
        samples = block.samples
        own.append(complex(block.phasors[0, 0]) / record.phasor(block.time))
        scatter.append(float(block.scatter[0, 0]))
        found, pulse = thesis_reading(record, case.probe_rate, angle, block.time)
        thesis.append(found / record.phasor(pulse))
    claimed = float(np.sqrt(np.mean(np.square(scatter))))
    return ChainComparison(case, Errors.of(own), Errors.of(thesis), 2.0 * case.noise / math.sqrt(samples), claimed)


def timed_waveforms() -> Floats:
    """Return a keyphasor and 16 channels at 25.6 kHz (17, N)."""
    at = np.arange(round(TIMED_SECONDS * TIMED_RATE)) / TIMED_RATE
    angle = rpm_to_rad_per_s(2963.7) * at
    rng = np.random.default_rng(0)
    keyphasor = keyphasor_pulses(angle, FLANK) + KEYPHASOR_NOISE * rng.normal(size=at.size)
    waveforms = np.cos(angle + rng.uniform(0.0, 2.0 * math.pi, (CHANNELS, 1))) + 0.05 * rng.normal(size=(CHANNELS, at.size))
    return np.vstack([keyphasor, waveforms])


def functions_times_real_time(waveforms: Floats) -> float:
    """Return the seconds of waveforms that the estimator's functions process per second of processor time, in blocks of 1
    s."""
    begin = time.process_time()
    found = read_keyphasor(waveforms[0], sampling_rate=TIMED_RATE)
    track_orders(waveforms[1:], sampling_rate=TIMED_RATE, angle=found, seconds=BLOCK)
    return TIMED_SECONDS / (time.process_time() - begin)


def agent_times_real_time(waveforms: Floats) -> float:
    """Return the seconds of waveforms that the whole agent, all its threads together, processes per second of processor
    time."""
    names = ["K", *(f"P{number}" for number in range(CHANNELS))]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.npz"
        np.savez(path, **dict(zip(names, waveforms, strict=True)))
        configuration = EdgeConfiguration.model_validate(
            {
                "plant": "benchmark",
                "machine": "train",
                "speed_range": {"minimum_rpm": 300, "maximum_rpm": 3600},
                "waveforms": {"files": [{"path": str(path), "start": "2024-01-01T00:00:00Z"}], "sampling_rate": TIMED_RATE},
                "keyphasor": {"column": "K"},
                "channels": [{"probe": name, "column": name, "sensitivity": 8000} for name in names[1:]],
                "block": {"seconds": BLOCK},
                "log": {"path": str(Path(folder) / "edge.log")},
            }
        )
        key = Key(configuration.plant, configuration.machine)
        with (
            session(listen=[], connect=[]) as opened,
            Source(opened, key, name="edge", encoding=BINARY, log=open_log(configuration)) as source,
        ):
            agent = Agent(configuration, source)
            begin = time.process_time()
            agent.read_files(threading.Event())
            spent = time.process_time() - begin
            if source.log.status().next_sequence < TIMED_SECONDS - 1:
                raise RuntimeError(f"{source.log.status().next_sequence} samples of {TIMED_SECONDS:g} s in the log")
    return TIMED_SECONDS / spent


def report(runs: int) -> str:
    """Return all cases, then the required figures."""
    lines = [f"phasors from waveforms, {runs} runs of each case, seeds 0 to {runs - 1}", ""]
    lines.append(f"  {'':<49}{'least squares over 1 s':^56}{'band-pass, one maximum, one minimum':^40}")
    heads = ("rms error", "of bound", "claimed", "of error", "ampl.", "phase", "rms error", "ampl.", "phase", "ratio")
    lines.append(f"  {'':<49}" + "".join(f"{head:>10}" for head in heads))
    outcomes = {case: outcome(case, runs) for case in CASES}
    for case, one in outcomes.items():
        own, thesis = one.own, one.thesis
        over_bound = f"{own.rms / one.bound:.3f}" if one.bound else "-"
        ratio = f"{thesis.rms / own.rms:.1f}" if own.rms > 1e-9 else "-"
        lines.append(
            f"  {case.name:<49}{100 * own.rms:>8.4f} %{over_bound:>10}"
            f"{100 * one.claimed:>8.4f} %{one.claimed / own.rms:>10.2f}"
            f"{own.amplitude_percent:>+8.3f} %{own.phase_deg:>+9.4f}°"
            f"{100 * thesis.rms:>8.3f} %{thesis.amplitude_percent:>+8.3f} %{thesis.phase_deg:>+9.3f}°{ratio:>10}"
        )
    noise, ramp = outcomes[NOISE], outcomes[RAMP]
    claims = [one.claimed / one.own.rms for one in outcomes.values()]
    others = [one.claimed / one.own.rms for case, one in outcomes.items() if case != STEEP]
    waveforms = timed_waveforms()
    lines += [
        "",
        "  rms error: of the complex phasor, part of it; claimed: what the blocks themselves say; ampl., phase: mean error;",
        "  of bound: over the Cramér-Rao bound of white noise; ratio: rms error of the second chain over the first's.",
        "",
        f"  {'':<66}{'asked':>10}{'measured':>12}",
        _figure("26 dB: rms error over the Cramér-Rao bound", f"≤ {ASKED_OVER_BOUND:g}", f"{noise.own.rms / noise.bound:.3f}"),
        _figure("26 dB: times smaller than peak picking", f"≥ {ASKED_BETTER:g}", f"{noise.thesis.rms / noise.own.rms:.1f}"),
        _figure(
            "100 r/min per s at 3000 r/min: bias of the amplitude",
            f"< {ASKED_AMPLITUDE:g} %",
            f"{abs(ramp.own.amplitude_percent):.4f} %",
        ),
        _figure("100 r/min per s at 3000 r/min: bias of the phase", f"< {ASKED_PHASE:g}°", f"{abs(ramp.own.phase_deg):.4f}°"),
        _figure("claimed over true rms error, smallest of all cases", f"≥ {ASKED_CLAIM[0]:g}", f"{min(claims):.2f}"),
        _figure("claimed over true rms error, largest of all cases", f"≤ {ASKED_CLAIM[1]:g}", f"{max(claims):.2f}"),
        _figure("the same without the steep keyphasor at 1 kHz", f"≤ {ASKED_CLAIM[1]:g}", f"{max(others):.2f}"),
        _figure(
            f"{CHANNELS} channels at {TIMED_RATE / 1000:g} kHz on one core, functions: times real time",
            "",
            f"{functions_times_real_time(waveforms):.0f}",
        ),
        _figure("the same, the whole agent", f"≥ {ASKED_SPEED:g}", f"{agent_times_real_time(waveforms):.0f}"),
    ]
    return "\n".join(lines)


def _figure(what: str, asked: str, measured: str) -> str:
    return f"  {what:<66}{asked:>10}{measured:>12}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Run and print."""
    name = "benchmarks.estimator.phasors"
    runs = runs_asked(arguments, name=name, description=__doc__, default=RUNS, what="draws of each case")
    with threadpool_limits(limits=1):
        print(report(runs))


if __name__ == "__main__":
    main()
