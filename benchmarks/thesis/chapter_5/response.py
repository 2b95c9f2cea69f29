"""Chapter 5: half-power points of the measured response, and the printed response."""

import math

import numpy as np
import scipy.optimize
import yaml
from numpy.typing import NDArray

from benchmarks.thesis.chapter_5.rig import PRINTED, ROOT, Rig
from benchmarks.thesis.plots import PlottedCurve, chart, save
from benchmarks.thesis.tables import table
from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.half_power import HalfPowerNotReached, HalfPowerPoints, half_power_points, outside, peak_samples
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from estimator.thesis import rigid_train
from estimator.thesis.rig import H1, SPEEDS_HZ, nominal_values


def half_power_section(rig: Rig) -> str:
    """Return the section on which of the thesis's speeds lie outside the half-power points."""
    speed = 2 * math.pi * np.linspace(10.0, 260.0, 2501)
    curve = _amplitudes(rig.machine, speed)
    rows = []
    for channel, name in enumerate(rig.machine.channels):
        for one in _resonances(speed, curve[:, channel]):
            hertz = [value / (2 * math.pi) for value in (one.lower, one.peak, one.upper)]
            rows.append([name, *[f"{value:.1f}" for value in hertz], f"{100 * one.damping_ratio:.1f}"])
    chapter_2 = rigid_train.printed_train()
    speed_2 = np.arange(20.0, 700.0, 0.5)
    condensed = rigid_train.condensed(chapter_2, speed=speed_2, direction=np.ones_like(speed_2))
    curve_2 = np.abs(response(condensed, coefficients=chapter_2.coefficients, excitations=chapter_2.unbalances))
    machine_3 = parse_machine(yaml.safe_load((ROOT / "examples" / "thesis-chapter-3.yaml").read_text(encoding="utf-8")))
    speed_3 = np.arange(20.0, 500.0, 0.25)
    curve_3 = _amplitudes(machine_3, speed_3)
    chosen = [
        ("Chapter 2, Case A", "near, outside", (150, 170, 200, 220), speed_2, curve_2),
        ("Chapter 2, Case B", "away", (100, 185, 240, 330), speed_2, curve_2),
        ("Chapter 3, Case A", "near, outside", (100, 110), speed_3, curve_3),
        ("Chapter 3, Case B", "away", (60, 160), speed_3, curve_3),
        ("Chapter 4, Case A", "near, outside", (99, 109, 121, 136), speed_3, curve_3),
        ("Chapter 4, Case B", "away", (54, 79, 159, 171), speed_3, curve_3),
        ("Chapter 5", "-", tuple(2 * math.pi * np.array(SPEEDS_HZ)), speed, curve),
    ]
    verdicts = []
    for name, claim, speeds, axis, curves in chosen:
        inside = [int(count) for count in _inside(np.array(speeds, dtype=float), axis, curves)]
        shown = ", ".join(f"{one:.0f}: {count}" for one, count in zip(speeds, inside, strict=True))
        verdicts.append([name, claim, shown if any(inside) else "none of them in any channel"])
    return (
        "### Half-power points\n\n"
        "Resonances of the rig in the channels where the amplitude falls to 1/√2 of a peak on both sides [Hz, %]:\n\n"
        + table(["channel", "lower", "peak", "upper", "damping ratio"], rows)
        + f"\n\n![Run-up of the rig]({_run_up_figure(rig, speed, curve)})\n\n"
        "The thesis chooses speeds outside the half-power points (§2.3). For its speeds, the number of channels (of 8) in "
        "which each lies inside [rad/s]:\n\n"
        + table(["", "thesis says", "speed: channels with it inside the half-power points"], verdicts)
        + "\n\nThe rig's speeds lie far below the first resonance, at 150 Hz. Some speeds of the earlier chapters that are "
        "called outside or away lie inside: in Chapter 2 the resonances are so wide that they merge, in Chapters 3 and 4 the "
        "printed critical speeds are not those of the printed data."
    )


def _run_up_figure(rig: Rig, speed: Floats, curve: Floats) -> str:
    """Draw the amplitudes at bearings 2 and 3 over speed."""
    return save(
        "chapter-5-run-up",
        chart(
            title="Rig: unbalance response at bearings 2 and 3, horizontal",
            x_label="speed [Hz]",
            y_label="amplitude [µm]",
            logarithmic=True,
            series=[
                *(
                    PlottedCurve(name, list(speed / (2 * math.pi)), list(1e6 * _of(rig, curve, name)))
                    for name in ("B2H", "B3H")
                ),
                PlottedCurve(
                    "the eight speeds, B3H",
                    list(SPEEDS_HZ),
                    list(1e6 * _of(rig, _amplitudes(rig.machine, PRINTED.speed), "B3H")),
                    points=True,
                ),
            ],
        ),
    )


def _amplitudes(machine: Machine, speed: Floats) -> Floats:
    coefficients, unbalances = nominal_values(machine)
    train = condense(machine, speed=speed, direction=np.ones_like(speed))
    return np.abs(response(train, coefficients=coefficients, excitations=unbalances))


def _of(rig: Rig, curve: Floats, channel: str) -> Floats:
    return np.asarray(curve[:, rig.machine.channels.index(channel)])


def _resonances(speed: Floats, amplitude: Floats) -> list[HalfPowerPoints]:
    """Return the half-power points of all peaks that have them."""
    found = []
    for peak in peak_samples(amplitude):
        try:
            found.append(half_power_points(speed, amplitude, excitation="unbalance", near=float(speed[peak])))
        except HalfPowerNotReached:
            continue  # a shoulder of another resonance
    return found


def _inside(chosen: Floats, speed: Floats, curves: Floats) -> NDArray[np.intp]:
    return np.asarray(np.sum([~outside(chosen, _resonances(speed, curve)) for curve in curves.T], axis=0))


def printed_response_section(rig: Rig) -> str:
    """Return the section on Table 5.3 beside the response to unbalance."""
    model = response(rig.train(PRINTED), coefficients=rig.coefficients, excitations=rig.unbalances)[:, 0]
    rows = []
    for hertz, printed, own in zip(SPEEDS_HZ, H1, model, strict=True):
        ratio = (SPEEDS_HZ[0] / hertz) ** 2
        rows.append(
            [
                f"{hertz:.0f}",
                f"{1e6 * abs(printed):.1f}",
                f"{np.angle(printed, deg=True):.0f}",
                f"{abs(printed) / abs(H1[0]) * ratio:.2f}",
                f"{1e6 * abs(own):.3f}",
                f"{np.angle(own, deg=True):.1f}",
                f"{abs(own) / abs(model[0]) * ratio:.2f}",
            ]
        )
    needed = abs(H1[-1]) / abs(model[-1]) * 10e-6
    constant, growing, amplitude_misfit = _constant_and_growing(1e6 * np.abs(H1))
    phasor_misfit = _best_delayed(1e6 * H1)
    return (
        "### The printed response (Table 5.3)\n\n"
        + table(
            [
                "[Hz]",
                "printed amplitude [µm]",
                "phase [°]",
                "over ω², first = 1",
                "to unbalance [µm]",
                "phase [°]",
                "over ω², first = 1",
            ],
            rows,
        )
        + "\n\nFar below the first natural frequency the response to unbalance grows with ω² at constant phase, whatever the "
        "bearings. The printed one stays between 50 and 69 µm, falls to a fifth of that growth, and its phase goes all ways. "
        "It is not the response of a rotor with a first natural frequency of 150 Hz to unbalance: at 41 Hz that would take an "
        f"eccentricity of {1e3 * needed:.0f} mm.\n\n"
        f"Amplitudes alone fit a constant vector, as run-out or a bow adds, of {constant:.0f} µm and a part that grows with "
        f"ω² to {growing:.0f} µm at 41 Hz, with an rms misfit of {amplitude_misfit:.1f} µm. With their phases they do not: "
        f"the misfit is {phasor_misfit:.0f} µm, even if pulse and record were a constant delay apart. Perhaps the phase "
        "reference changed from speed to speed, or Eq. 5.2 was read from different periods. Eq. 5.3 has no place for a "
        "constant vector, and it needs phases that hang together."
    )


def _constant_and_growing(amplitude: Floats) -> tuple[float, float, float]:
    """Fit |a + b ω²| to the printed amplitudes; returns |a|, |b| at the highest speed, rms misfit [their unit]."""
    growth = (np.array(SPEEDS_HZ) / SPEEDS_HZ[-1]) ** 2

    def misfit(vector: Floats) -> Floats:
        return np.asarray(np.abs(vector[0] + complex(vector[1], vector[2]) * growth) - amplitude)

    starts = [np.array([50.0, 50.0 * math.cos(angle), 50.0 * math.sin(angle)]) for angle in np.arange(0.0, math.pi, 0.5)]
    best = min((scipy.optimize.least_squares(misfit, start) for start in starts), key=lambda found: float(found.cost))
    size = math.hypot(best.x[1], best.x[2])
    return abs(float(best.x[0])), size, float(np.sqrt(np.mean(best.fun**2)))


def _best_delayed(phasor: Complexes) -> float:
    """Return the smallest rms misfit of (a + b ω²) e^{-jωτ} to printed phasors, over complex a, b and delays τ to 0.25 s."""
    speed = 2 * math.pi * np.array(SPEEDS_HZ)
    columns, _ = np.linalg.qr(np.stack([np.ones_like(speed), speed**2], axis=1))
    delays = np.linspace(-0.25, 0.25, 10001)
    turned = phasor * np.exp(1j * speed * delays[:, None])
    left = turned - (turned @ columns) @ columns.T
    return float(np.sqrt(np.mean(np.abs(left) ** 2, axis=1)).min())
