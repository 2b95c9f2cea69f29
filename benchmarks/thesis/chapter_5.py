"""Chapter 5 of the thesis: the laboratory rig, aligned and misaligned, with Appendices C and E.

python -m benchmarks.thesis chapter-5 [--speeds printed|resonances|run-up] [--case A1|A2|B1|B2|C1|C2] [--seed 0]
"""

import argparse
import copy
import math
from collections.abc import Sequence

import numpy as np
import scipy.optimize
import yaml
from numpy.typing import NDArray

from benchmarks.thesis import rig_mode_shapes
from benchmarks.thesis.plots import Series, chart, save
from benchmarks.thesis.rig import (
    BELOW,
    BOTH_WAYS,
    CAMPAIGNS,
    DENSE,
    DETERMINED,
    FLOOR,
    KINDS,
    LARGEST_GROWTH,
    LOST,
    PRINTED,
    PRINTED_WITH_FLOOR,
    RELATIVE_NOISE,
    RESONANCES,
    ROOT,
    RUN_UP,
    RUN_UP_WITHOUT_FLOOR,
    SETS,
    Complexes,
    Floats,
    Rig,
    bounds,
    fitted,
    load,
    logarithmic_point,
    one_way,
    regressed,
    regression,
)
from benchmarks.thesis.simple_supports import LARGEST, PRINTED_HZ, SMALLEST, fit_coupling
from benchmarks.thesis.tables import percent, power, table
from estimator.change_size import change_size
from estimator.condensation import condense
from estimator.finding_kind import Cause
from estimator.half_power import HalfPowerNotReached, HalfPowerPoints, half_power_points, outside, peak_samples
from estimator.identification import Identification
from estimator.machine import Machine, parse_machine
from estimator.misalignment import neighbouring_bearings
from estimator.modes import eigenvalues
from estimator.observation import observed
from estimator.response import response
from estimator.simply_supported import SimplySupportedShaft, disc_at_midspan_frequency, span_for
from estimator.thesis import rigid_train
from estimator.thesis.flexible_train import flexible_train, parts
from estimator.thesis.impact_spectrum import Place, impact_spectrum, spectrum_peaks
from estimator.thesis.regression import solve
from estimator.thesis.rig import (
    ALIGNED_HZ,
    CASES,
    H1,
    SPEEDS_HZ,
    BearingGrowth,
    MisalignmentCase,
    nominal_values,
    plane_frequencies,
    printed_growth,
    shaft_factors,
)
from estimator.thesis.signal_noise import decibels, noisy_signal, phasor_error
from estimator.thesis.time_history import band_passed, extrema_phasor, least_squares_phasor
from estimator.watch import Watch


def section() -> str:
    """The chapter's part of the evidence page."""
    rig = load()
    parts_of_page = [
        "## Chapter 5: the laboratory rig",
        "Two shafts, a disc in the middle of each, four ball bearings in soft padding, one coupling; proximity probes at the "
        "four bearings. The measured data are not printed, except one channel (Table 5.3), so the rig is simulated: "
        "`examples/thesis-chapter-5-rig.yaml` says which of its numbers are printed and which were chosen to meet the printed "
        "natural frequencies. Noise is circular, 1 % of the amplitude, with or without a floor of 50 nm. Everything below on "
        "identification holds for this rig; another choice with the same natural frequencies has the same difficulty, since "
        "it comes from where the speeds lie.",
        _geometry(rig),
        _half_power(rig),
        _printed_response(rig),
        _directions(rig),
        _fits(rig),
        _misalignment(rig),
        _natural_frequencies(rig),
        rig_mode_shapes.section(rig),
        _impact_tests(rig),
        _signals(),
    ]
    return "\n\n".join(parts_of_page) + "\n"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of `python -m benchmarks.thesis chapter-5`."""
    parser.add_argument("--speeds", choices=sorted(CAMPAIGNS), default="run-up", help="where to measure, default run-up")
    cases = [plain(case) for case in CASES]
    parser.add_argument("--case", choices=cases, default=None, help="misalignment of Table 5.4, default none")
    parser.add_argument("--seed", type=int, default=0, help="of the noise, default 0")


def run(arguments: argparse.Namespace) -> str:
    """One maximum-likelihood fit of the rig, parameter by parameter."""
    rig = load()
    campaign = CAMPAIGNS[arguments.speeds]
    chosen = [case for case in CASES if plain(case) == arguments.case]
    factors = _printed_factors(rig, chosen[0]) if chosen else np.ones_like(rig.coefficients)
    outcome = fitted(rig, campaign, seed=arguments.seed, factors=factors)
    truth = [*(rig.coefficients * factors), *rig.unbalances]
    rows = []
    for one, true in zip(outcome.estimates, truth, strict=True):
        shown = f"{true.real:.4g}" if one.imaginary is None and one.quantity != "unbalance" else f"{true:.4g}"
        if one.value is None or one.standard_error is None:
            rows.append([one.name, shown, "-", one.reason or "-"])
        else:
            value = f"{one.value:.4g}" if one.imaginary is None else f"{complex(one.value, one.imaginary):.4g}"
            rows.append([one.name, shown, value, f"{one.standard_error:.2g}"])
    return table(["parameter [SI]", "true", "estimated", "standard error"], rows) + f"\n\n{outcome.verdict}"


def plain(case: MisalignmentCase) -> str:
    """A case's name without subscripts: `A1`."""
    return case.name.translate(str.maketrans("₁₂", "12"))


def _printed_factors(rig: Rig, case: MisalignmentCase) -> Floats:
    return printed_growth(case, flexible_train(rig.machine).unknowns)


def _geometry(rig: Rig) -> str:
    """Appendix C: which diameters and which span give Table C.1."""
    steel = rig.machine.materials["steel"]
    rows = []
    for number, printed_hz, printed_diameter, other_diameter, measured_hz in (
        (1, 373.0, 0.012, 0.016, 357.0),
        (2, 169.0, 0.016, 0.012, 144.0),
    ):
        mass = rig.machine.discs[number - 1].mass
        row = [f"rotor {number}", f"{printed_hz:.0f}"]
        for diameter in (printed_diameter, other_diameter):
            shaft = SimplySupportedShaft(
                span=0.208, outer_diameter=diameter, young_modulus=steel.young_modulus, density=steel.density
            )
            span = span_for(
                frequency=2 * math.pi * printed_hz, diameter=diameter, disc_mass=mass, young_modulus=steel.young_modulus
            )
            row.append(f"{1e3 * diameter:.0f} mm: {disc_at_midspan_frequency(shaft, disc_mass=mass) / (2 * math.pi):.1f}")
            row.append(f"{span:.3f} m")
        row.append(f"{disc_at_midspan_frequency(shaft, disc_mass=mass, massless=False) / (2 * math.pi):.0f}")
        row += [f"{_rotor_alone(rig, number, rigid=True)[0]:.0f}", f"{measured_hz:.0f}"]
        row += [_three(_rotor_alone(rig, number)), _three(_rotor_alone(rig, number, half=True))]
        rows.append(row)
    header = [
        "[Hz]",
        "printed, Table C.1",
        "diameter as printed, span 0.208 m",
        "span that gives the print",
        "diameters exchanged, span 0.208 m",
        "span that gives the print",
        "and with 17/35 of the shaft's mass",
        "finite elements, rigid supports",
        "impact test, no coupling",
        "this rig, no coupling",
        "and with the coupling's half",
    ]
    return (
        "### Geometry: Appendix C\n\n"
        + table(header, rows)
        + "\n\nThe bearings' span is not printed. With Table 5.1's diameters the two frequencies need two different spans, "
        "one of them longer than the shaft (0.27 m). With the diameters exchanged, 16 mm for shaft 1 and 12 mm for shaft 2, "
        "both need 0.208 m: that is what Appendix C was computed with. It leaves out the shaft's mass, which lowers rotor 1 "
        "by a tenth: simply supported it cannot reach the 357 Hz that the impact test found and the thesis reads as its "
        "first natural frequency, and soft supports lower it further. The rig of this page was chosen for the frequencies of "
        "the coupled rotors; alone, only rotor 2 comes near the print, and rotor 1 in its second mode, with the coupling's "
        "half left on. What §5.6 takes for a frequency that the coupling adds, 201 Hz, is in this rig the first of rotor 1 "
        "on its bearings.\n\n" + _simple_supports(rig)
    )


SIMPLE_SUPPORT_MESHES = (0.035, 0.0265, 0.0209, 0.0179)
"""Longest elements [m], which make 8, 12, 14 and 16 elements of each shaft."""


def _simple_supports(rig: Rig) -> str:
    alone = sorted([_rotor_alone(rig, 1, rigid=True)[0], _rotor_alone(rig, 2, rigid=True)[0]])
    fits = [("ρI", fit_coupling(rig.document, element_length=0.0265, printed_inertia=False))]
    fits += [
        ("ρAl, Eq. A.5-A.8", fit_coupling(rig.document, element_length=one, printed_inertia=True))
        for one in SIMPLE_SUPPORT_MESHES
    ]
    rows = [
        [
            inertia,
            str(one.elements),
            _stiffness_text(one.lateral, SMALLEST[0], LARGEST[0]),
            _stiffness_text(one.angular, SMALLEST[1], LARGEST[1]),
            ", ".join(f"{value:.1f}" for value in one.frequencies),
            percent(one.misfit),
        ]
        for inertia, one in fits
    ]
    best = min((one for _, one in fits), key=lambda one: one.misfit)
    furthest = float(np.abs(best.frequencies / np.array(PRINTED_HZ) - 1.0).max())
    return (
        "#### On simple supports\n\n"
        f"§5.6 gives {', '.join(str(one) for one in PRINTED_HZ)} Hz for the coupled train on simple supports, by finite "
        f"elements. On supports 0.208 m apart the two rotors alone have {alone[0]:.0f} and {alone[1]:.0f} Hz, and a massless "
        "coupling can only raise the sorted frequencies: with the right rotary inertia a second one of 239 Hz is out of "
        "reach. Appendix A prints a prefix ρAl for the rotary inertia where ρI belongs (see Chapter 3). With it the "
        "frequencies depend on the mesh, which is not printed. The coupling's two stiffnesses, not printed either, are "
        "fitted here to the three frequencies:\n\n"
        + table(
            [
                "rotary inertia",
                "elements per shaft",
                "coupling k [N/m]",
                "k_φ [N m/rad]",
                "three frequencies [Hz]",
                "misfit, rms",
            ],
            rows,
        )
        + f"\n\nWith {best.elements} elements per shaft the printed frequencies come out within {percent(furthest)}. Mesh and "
        "coupling are three choices for three numbers, so this alone proves little; but without the misprint no choice comes "
        "near (the third frequency of the first row is that of discs as light in tilting as Table 5.1 prints them). It fits "
        "what is found in Chapter 3, and if it is so, the thesis's updated model and what it identified on the rig rest on "
        "that inertia."
    )


def _stiffness_text(value: float, smallest: float, largest: float) -> str:
    if value < 2.0 * smallest:
        return "none"
    return "rigid" if value > 0.5 * largest else f"{value:.2g}"


def _rotor_alone(rig: Rig, number: int, *, rigid: bool = False, half: bool = False) -> Floats:
    """First two natural frequencies [Hz] of one rotor without coupling, means of the two planes.

    rigid: on simple supports instead of its bearings. half: with its half of the coupling left on.
    """
    document = copy.deepcopy(rig.document)
    shaft = next(one for one in document["shafts"] if one["id"] == f"S{number}")
    if not half:
        long = max(shaft["sections"], key=lambda section: float(section["length"]))
        shaft["sections"] = [{**long, "length": 0.27}]
    document["shafts"] = [shaft]
    for name in ("discs", "bearings", "probes"):
        document[name] = [one for one in document[name] if one["shaft"] == shaft["id"]]
    document["couplings"] = []
    if rigid:
        for bearing in document["bearings"]:
            bearing.update({"kxx": 1e11, "kyy": 1e11, "kxy": 0.0, "kyx": 0.0})
    alone = parse_machine(document)
    coefficients, _ = nominal_values(alone)
    return plane_frequencies(alone, coefficients=coefficients, count=2)


def _half_power(rig: Rig) -> str:
    """Which of the thesis's speeds lie outside the half-power points."""
    speed = 2 * math.pi * np.linspace(10.0, 260.0, 2501)
    curve = _amplitudes(rig.machine, speed)
    rows = []
    for channel, name in enumerate(rig.machine.channels):
        for one in _resonances(speed, curve[:, channel]):
            hertz = [value / (2 * math.pi) for value in (one.lower, one.peak, one.upper)]
            rows.append([name, *[f"{value:.1f}" for value in hertz], f"{100 * one.damping_ratio:.1f}"])
    figure = save(
        "chapter-5-run-up",
        chart(
            title="Rig: unbalance response at bearings 2 and 3, horizontal",
            x_label="speed [Hz]",
            y_label="amplitude [µm]",
            logarithmic=True,
            series=[
                *(Series(name, list(speed / (2 * math.pi)), list(1e6 * _of(rig, curve, name))) for name in ("B2H", "B3H")),
                Series(
                    "the eight speeds, B3H",
                    list(SPEEDS_HZ),
                    list(1e6 * _of(rig, _amplitudes(rig.machine, PRINTED.speed), "B3H")),
                    points=True,
                ),
            ],
        ),
    )
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
        + f"\n\n![Run-up of the rig]({figure})\n\n"
        "The thesis chooses speeds outside the half-power points (§2.3). For its speeds, the number of channels (of 8) in "
        "which each lies inside [rad/s]:\n\n"
        + table(["", "thesis says", "speed: channels with it inside the half-power points"], verdicts)
        + "\n\nThe rig's speeds lie far below the first resonance, at 150 Hz. Some speeds of the earlier chapters that are "
        "called outside or away lie inside: in Chapter 2 the resonances are so wide that they merge, in Chapters 3 and 4 the "
        "printed critical speeds are not those of the printed data."
    )


def _amplitudes(machine: Machine, speed: Floats) -> Floats:
    coefficients, unbalances = nominal_values(machine)
    train = condense(machine, speed=speed, direction=np.ones_like(speed))
    return np.abs(response(train, coefficients=coefficients, excitations=unbalances))


def _of(rig: Rig, curve: Floats, channel: str) -> Floats:
    return np.asarray(curve[:, rig.machine.channels.index(channel)])


def _resonances(speed: Floats, amplitude: Floats) -> list[HalfPowerPoints]:
    """Half-power points of all peaks that have them."""
    found = []
    for peak in peak_samples(amplitude):
        try:
            found.append(half_power_points(speed, amplitude, excitation="unbalance", near=float(speed[peak])))
        except HalfPowerNotReached:
            continue  # a shoulder of another resonance
    return found


def _inside(chosen: Floats, speed: Floats, curves: Floats) -> NDArray[np.intp]:
    return np.asarray(np.sum([~outside(chosen, _resonances(speed, curve)) for curve in curves.T], axis=0))


def _printed_response(rig: Rig) -> str:
    """Table 5.3 beside the response to unbalance."""
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
    """|a + b ω²| fitted to the printed amplitudes: |a|, |b| at the highest speed, rms misfit [their unit]."""
    growth = (np.array(SPEEDS_HZ) / SPEEDS_HZ[-1]) ** 2

    def misfit(vector: Floats) -> Floats:
        return np.asarray(np.abs(vector[0] + complex(vector[1], vector[2]) * growth) - amplitude)

    starts = [np.array([50.0, 50.0 * math.cos(angle), 50.0 * math.sin(angle)]) for angle in np.arange(0.0, math.pi, 0.5)]
    best = min((scipy.optimize.least_squares(misfit, start) for start in starts), key=lambda found: float(found.cost))
    size = math.hypot(best.x[1], best.x[2])
    return abs(float(best.x[0])), size, float(np.sqrt(np.mean(best.fun**2)))


def _best_delayed(phasor: Complexes) -> float:
    """Smallest rms misfit of (a + b ω²) e^{-jωτ} to printed phasors, over complex a, b and a delay τ up to a quarter "
    "second."""
    speed = 2 * math.pi * np.array(SPEEDS_HZ)
    columns, _ = np.linalg.qr(np.stack([np.ones_like(speed), speed**2], axis=1))
    delays = np.linspace(-0.25, 0.25, 10001)
    turned = phasor * np.exp(1j * speed * delays[:, None])
    left = turned - (turned @ columns) @ columns.T
    return float(np.sqrt(np.mean(np.abs(left) ** 2, axis=1)).min())


def _directions(rig: Rig) -> str:
    """What the speeds determine, by the Fisher information at the truth."""
    rows = []
    for campaign in (PRINTED, PRINTED_WITH_FLOOR, DENSE, BOTH_WAYS, BELOW, RESONANCES, RUN_UP):
        found = bounds(rig, campaign)
        kinds = [float(np.median(found.parameters[_members(rig, start, ends)])) for _, start, ends in KINDS]
        rows.append(
            [
                campaign.title,
                str(int(np.sum(found.directions < DETERMINED))),
                str(int(np.sum(found.directions > LOST))),
                *[percent(value) for value in kinds],
                percent(float(np.median(found.parameters[len(rig.names) :]))),
            ]
        )
    printed = bounds(rig, PRINTED).parameters
    needed = [RELATIVE_NOISE * DETERMINED / float(np.median(printed[_members(rig, *kind[1:])])) for kind in KINDS]
    header = ["speeds", "directions within 10 %", "not within 100 %", *[name for name, _, _ in KINDS], "unbalance"]
    return (
        "### What eight speeds determine\n\n"
        "Cramér-Rao bounds (standard errors; median over the parameters of a kind) at 1 % noise without any prior, and how "
        "many of the 46 independent directions in parameter space the data fix. Direct terms count by their logarithm.\n\n"
        + table(header, rows)
        + "\n\nThe regression counts 128 equations for 46 unknowns (three speeds would do, says §5.5) and the count is not "
        "the difficulty. At 17 to 41 Hz each channel says X = ω² a, one complex number: eight channels fix 16 directions, "
        "and more speeds in the same range only repeat them. What is fixed is displacement per unbalance, each bearing's "
        "flexibility times the force that reaches it: stiffness and unbalance can grow together and nothing changes. Only "
        "the next order, (ω/ωₙ)² or 7 % at the top, tells them apart, and the coupling and all damping come later still. For "
        f"10 % of a bearing's direct stiffness the eight speeds would need a noise of {percent(needed[0])}, for its damping "
        f"{percent(needed[1])}, for the coupling's stiffness {percent(needed[2])}. Eight speeds do determine the rig when "
        "they lie "
        "around two resonances; a run-up through both does better.\n\n" + _bound_figure(rig)
    )


def _bound_figure(rig: Rig) -> str:
    """Bounds over the highest speed of a run-up."""
    highest = [
        41.0,
        60.0,
        80.0,
        100.0,
        120.0,
        135.0,
        145.0,
        150.0,
        155.0,
        170.0,
        185.0,
        200.0,
        215.0,
        240.0,
        280.0,
        330.0,
        380.0,
    ]
    found = [bounds(rig, one_way("", np.linspace(5.0, top, 200), floor=FLOOR)).parameters for top in highest]
    series = [
        Series(name, highest, [100.0 * float(np.median(one[_members(rig, start, ends)])) for one in found])
        for name, start, ends in KINDS
    ]
    figure = save(
        "chapter-5-bounds",
        chart(
            title="Rig: what 200 speeds determine, by the highest of them",
            x_label="highest speed [Hz]",
            y_label="Cramér-Rao bound, median [%]",
            series=series,
            logarithmic=True,
        ),
    )
    return f"![Bounds by the highest speed]({figure})"


def _members(rig: Rig, start: str, ends: tuple[str, ...]) -> list[int]:
    return [k for k, name in enumerate(rig.names) if name.startswith(start) and name.rsplit(".", 1)[1] in ends]


def _fits(rig: Rig) -> str:
    """Three sets of data, by regression and by maximum likelihood."""
    truth = np.concatenate([rig.coefficients, parts(rig.unbalances)])
    exact = regression(rig, PRINTED, seed=None, own_model=True)
    thesis_scaled, norm_scaled = solve(exact, scaling="thesis"), solve(exact, scaling="norm")
    stiffness = _members(rig, "bearing.", ("kxx", "kyy"))
    rows = []
    for campaign in (PRINTED, DENSE, RUN_UP_WITHOUT_FLOOR):
        for own_model in (True, False):
            source = "its own reduced model" if own_model else "the full model"
            for seeds, label in (((None,), "none"), (tuple(SETS), "1 %")):
                values = np.array([regressed(rig, campaign, seed=seed, own_model=own_model) for seed in seeds])
                error = np.abs(values / truth - 1.0)
                ratio = values[:, stiffness] / truth[stiffness]
                spread = (
                    "-" if len(seeds) == 1 else percent(float(np.median(ratio.std(axis=0, ddof=1) / np.abs(ratio.mean(0)))))
                )
                rows.append(
                    [
                        campaign.title,
                        source,
                        label,
                        _or_rounding(float(np.median(error))),
                        _or_rounding(float(np.median(np.abs(ratio - 1.0)))),
                        spread,
                    ]
                )
    return (
        "### Three sets of data\n\n"
        "Chapter 4's regression (Eq. 4.71 as 5.3), columns scaled to equal norm. At the eight speeds its condition number is "
        f"{_power(thesis_scaled.condition_number_before)} before scaling, {_power(thesis_scaled.condition_number_after)} "
        f"after the thesis's (1 over the mean speed) and {_power(norm_scaled.condition_number_after)} after this one: with "
        "the thesis's scaling, rounding alone undoes even data without noise. Errors relative to the truth; spread: "
        "standard deviation over the three sets over their mean, median of the bearings' direct stiffnesses.\n\n"
        + table(
            ["speeds", "data from", "noise", "all: median error", "bearing k direct: median error", "spread over three sets"],
            rows,
        )
        + "\n\n"
        + _likelihood(rig)
    )


def _power(condition_number: float) -> str:
    return "beyond 1e16" if condition_number > 1e16 else power(condition_number)


def _or_rounding(error: float) -> str:
    return "rounding" if error < 1e-6 else percent(error)


def _likelihood(rig: Rig) -> str:
    rows = []
    stiffness = [rig.names[k] for k in _members(rig, "bearing.", ("kxx", "kyy"))]
    for campaign in (PRINTED, PRINTED_WITH_FLOOR, DENSE, BOTH_WAYS, BELOW, RESONANCES, RUN_UP):
        fits = [fitted(rig, campaign, seed=seed) for seed in range(LIKELIHOOD_SETS)]
        outcomes = [outcome for outcome in fits if outcome.accepted]
        within, judged = np.sum([_coverage(rig, outcome) for outcome in outcomes], axis=0)
        rows.append(
            [
                campaign.title,
                f"{len(outcomes)} of {len(fits)}",
                _range([sum(one.value is not None for one in outcome.estimates) for outcome in outcomes]),
                f"{within} of {judged}: {100 * within / judged:.0f} %",
                *_stiffness_errors(rig, outcomes, stiffness),
                power(float(np.median([outcome.condition_number for outcome in outcomes]))),
            ]
        )
    header = [
        "speeds",
        "fits accepted",
        f"estimates given, of {len(rig.names) + rig.unbalances.size}",
        "truth inside the 95 % interval",
        f"bearing k direct given, of {len(stiffness)}",
        "their rms error",
        "spread over the sets",
        "condition number, median",
    ]
    return (
        f"Maximum likelihood on data of the full model, {LIKELIHOOD_SETS} noise seeds, from a document whose coefficients "
        "are off by ± 50 %. What the data leave open is reported as not estimable, with the reason.\n\n"
        + table(header, rows)
        + "\n\nOnly accepted fits are counted. From the eight printed speeds a handful of cross-coupled terms is bounded by "
        "the size of the direct ones beside them. A direct stiffness is hardly ever given, and where one is, it is wrong by "
        "more than its interval says (at most 40 % is let through): intervals are linearised at the point where the fit ends, "
        "and the valley of equal misfit is long and bent. The condition number tells these fits, beyond a million, from the "
        "others, whose intervals hold as often as they say. Both senses of rotation, or speeds up to 130 Hz, give the "
        "bearings' stiffnesses within a tenth or two; only resonances give the coupling.\n\n"
        "Repeatability is no evidence of truth. At a hundred speeds the regression's three sets agree within a per cent or "
        "so, and the stiffnesses are wrong by tens of times: noise in the regressors biases every set alike, and so does the "
        "high-frequency condensation far below the resonances. From data of its own reduced model without noise the "
        "regression is exact; 1 % of noise is enough to undo it. Figure 5.18's agreement of three sets therefore does not "
        "say that its stiffnesses are the rig's."
    )


def _range(counts: Sequence[int]) -> str:
    """Median, smallest and largest."""
    return f"{np.median(counts):.0f} ({min(counts)} to {max(counts)})"


def _coverage(rig: Rig, outcome: Identification) -> tuple[int, int]:
    """How many of the estimated coefficients have the truth inside their interval, and how many there are."""
    given = [
        (one.lower, true, one.upper)
        for one, true in zip(outcome.estimates[: len(rig.names)], rig.coefficients, strict=True)
        if one.lower is not None and one.upper is not None
    ]
    return sum(lower <= true <= upper for lower, true, upper in given), len(given)


def _stiffness_errors(rig: Rig, outcomes: Sequence[Identification], names: Sequence[str]) -> list[str]:
    """How many are given; rms of ln(estimate/truth); rms over parameters of its standard deviation over the sets."""
    true = dict(zip(rig.names, rig.coefficients, strict=True))
    found = np.array([[outcome.estimate(name).value or math.nan for name in names] for outcome in outcomes])
    error = np.log(found / [true[name] for name in names])
    given = np.isfinite(error)
    count = _range([int(one) for one in given.sum(axis=1)])
    if not given.any():
        return [count, "-", "-"]
    whole = error[:, given.all(axis=0)]
    spread = percent(float(np.sqrt(np.mean(whole.var(axis=0, ddof=1))))) if whole.size else "-"
    return [count, percent(float(np.sqrt(np.nanmean(error**2)))), spread]


def _misalignment(rig: Rig) -> str:
    """Before and after: changes imposed, what the diagnosis says of them, and how surely."""
    names = stiffnesses(rig)
    before = [fitted(rig, RUN_UP, seed=seed) for seed in SETS]
    watch = Watch.over(rig.machine, [observed(outcome, rig.machine.channels) for outcome in before])
    low = fitted(rig, PRINTED, seed=0, factors=_printed_factors(rig, CASES[-1]))
    rows = []
    cases = [("aligned again", "none", np.ones_like(rig.coefficients))]
    cases += [(case.name, label, factors) for case in CASES for label, factors in _imposed(rig, case)]
    for number, (name, label, factors) in enumerate(cases):
        runs = [
            fitted(rig, RUN_UP, seed=100 + MISALIGNED_RUNS * number + run, factors=factors) for run in range(MISALIGNED_RUNS)
        ]
        found = [diagnosed(rig, watch, runs[first : first + 2]) for first in range(0, len(runs), 2)]
        imposed = dict(zip(rig.names, factors - 1.0, strict=True))
        mean = float(np.mean([math.log1p(imposed[one]) for one in names]))
        change, error = _change(before, runs[0], LARGEST_GROWTH)
        size = rig.coefficients[rig.names.index(LARGEST_GROWTH)]
        misaligned = [one for causes in found for one in causes if one.kind == "misalignment"]
        others = sum(one.kind != "misalignment" for causes in found for one in causes)
        sizes = [change_size(one, watch.reference, amplitude={}).per_cent or math.nan for one in misaligned]
        rows.append(
            [
                name,
                label,
                percent(mean),
                f"{len(misaligned)} of {len(found)}",
                str(others),
                f"{np.median(sizes):.0f} %" if sizes else "-",
                f"{np.median([one.evidence for one in misaligned]):.0f}" if misaligned else "-",
                f"{100 * imposed[LARGEST_GROWTH]:.0f} %",
                f"{100 * change / size:.0f} ± {100 * error / size:.0f} %",
                str(sum(_beyond(_change(before, runs[0], one)) for one in rig.names)),
            ]
        )
    header = [
        "case",
        "changes imposed",
        "stiffnesses at the coupling, mean of ln",
        "misalignment named in pairs of runs",
        "other causes named",
        "size, median",
        "evidence, median",
        "c_yx of B4 imposed",
        "found",
        f"of {len(rig.names)} coefficients, changed beyond 2 standard errors",
    ]
    known_least = before[0].estimate(LARGEST_GROWTH).standard_error or math.nan
    error_of_largest = known_least / rig.coefficients[rig.names.index(LARGEST_GROWTH.replace("cyx", "cyy"))]
    lacking = [name for name in names if name not in logarithmic_point(low).names]
    return (
        "### Misalignment cases of Table 5.4\n\n"
        "The text prints one change per case, the largest of all (c_yx of bearing 4: 12, 18, 31, 56, 60, 68 %); Figures "
        "5.27-5.29 are not in it. Imposed here are two readings of it. **print**: c_yx of bearing 4 as printed, every other "
        "coefficient of bearings and coupling by half of that, an assumption. **frequencies**: the bearings of each shaft "
        "grow by what brings the rig's natural frequencies nearest to those of Table 5.5, with the coupling growing as the "
        "bearings of shaft 2, an assumption too. Baseline: three aligned runs (seeds 0 to 2); then "
        f"{MISALIGNED_RUNS} runs per case, diagnosed in pairs as the service does (analysts.md); the first gives the changes "
        "of single coefficients. Run-up of 200 speeds, 5 to 200 Hz, 1 % noise and 50 nm floor, no run-to-run scatter added; "
        "the diagnosis itself expects it. Both readings let the bearings away from the coupling grow as well, which the "
        "diagnosis names beside the misalignment or takes for the season.\n\n"
        + table(header, rows)
        + "\n\nThe term that the thesis singles out says nothing. A cross-coupled damping is known no "
        "better than the direct one beside it is large: the standard error of c_yx of bearing 4 is "
        f"{100 * error_of_largest:.0f} % of c_yy. In this rig c_yx is 3 % of it (chosen), so its printed changes of 12 to 68 "
        f"% drown; were it a fifth, as in Chapter 3, an error of {500 * error_of_largest:.0f} % would still leave the "
        "smaller ones open. Direct stiffnesses change less and say more.\n\nFrom the eight printed speeds, Case C₂: "
        f"{len(lacking)} of the {len(names)} direct stiffnesses at the coupling are not estimable. The service compares no "
        "such run with these: it covers other speeds."
    )


def stiffnesses(rig: Rig) -> tuple[str, ...]:
    """Direct stiffnesses of the coupling and of the bearings beside it."""
    coupling = rig.machine.couplings[0]
    beside = [f"bearing.{bearing}" for bearing in neighbouring_bearings(rig.machine, coupling)]
    return tuple(f"{element}.{name}" for element in (f"coupling.{coupling.id}", *beside) for name in ("kxx", "kyy"))


def diagnosed(rig: Rig, watch: Watch, runs: Sequence[Identification]) -> tuple[Cause, ...]:
    """What a diagnosis of some runs, all of which must agree, says."""
    said = [observed(run, rig.machine.channels) for run in runs]
    return watch.found(said, on_delay=lambda _kind, _element: len(said)).causes


def _beyond(change: tuple[float, float]) -> bool:
    return abs(change[0]) > 2.0 * change[1]


def _imposed(rig: Rig, case: MisalignmentCase) -> list[tuple[str, Floats]]:
    """Readings of what a case changed, each with its factors (K,)."""
    readings = [("print", _printed_factors(rig, case))]
    if case.frequencies_hz is not None:
        growth = _growth(rig, case.frequencies_hz)
        readings.append(
            (
                "frequencies",
                shaft_factors(rig.machine, driver=1 + growth.driver, driven=1 + growth.driven),
            )
        )
    return readings


def _growth(rig: Rig, frequencies_hz: tuple[float, float, float]) -> BearingGrowth:
    return BearingGrowth.to_reach(rig.machine, np.array(frequencies_hz) / np.array(ALIGNED_HZ))


def _change(before: Sequence[Identification], after: Identification, name: str) -> tuple[float, float]:
    """Change of a parameter from the mean of several fits, and its standard error [SI]."""
    now = after.estimate(name)
    then = [outcome.estimate(name) for outcome in before]
    if now.value is None or now.standard_error is None or any(one.value is None for one in then):
        return math.nan, math.nan
    values = np.array([one.value for one in then], dtype=float)
    errors = np.array([one.standard_error for one in then], dtype=float)
    return now.value - float(values.mean()), math.hypot(now.standard_error, float(np.linalg.norm(errors)) / len(then))


def _natural_frequencies(rig: Rig) -> str:
    """Tables 5.5 and 5.6."""
    rows = [
        [
            "aligned",
            "150, 203-204, 363-364",
            "150, 205, 363",
            _three(plane_frequencies(rig.machine, coefficients=rig.coefficients)),
            "-",
        ]
    ]
    shares = []
    for case in CASES:
        if case.frequencies_hz is None:
            continue
        values = {
            label: plane_frequencies(rig.machine, coefficients=rig.coefficients * factors)
            for label, factors in _imposed(rig, case)
        }
        growth = _growth(rig, case.frequencies_hz)
        model = "157, 207, 360" if case.name == "C₁" else "-"
        rows.append(
            [case.name, _three(np.array(case.frequencies_hz)), model, _three(values["print"]), _three(values["frequencies"])]
        )
        share = ((case.frequencies_hz[0] / ALIGNED_HZ[0]) ** 2 - 1.0) / case.growth
        shares.append(
            f"{case.name} {100 * growth.driver:.0f} % and {100 * growth.driven:.0f} % (printed largest change "
            f"{100 * case.growth:.0f} %, least share {100 * share:.0f} %)"
        )
    own = _energy_share(rig)
    worst = max(float(np.abs(_growth(rig, case.frequencies_hz).misfit).max()) for case in CASES if case.frequencies_hz)
    return (
        "### Natural frequencies: Tables 5.5 and 5.6\n\n"
        "At standstill [Hz], mean of the two planes:\n\n"
        + table(
            [
                "",
                "impact test, printed",
                "updated FE model, printed",
                "rig, changes as in *print*",
                "rig, changes as in *frequencies*",
            ],
            rows,
        )
        + "\n\nThe rig's aligned frequencies were fitted to the print when the document was written; they prove nothing. The "
        "changes can be held against each other. ω² is a concave function of stiffness, so a growth of all bearing and "
        "coupling stiffnesses by at most g raises ω² by at most g times the share of the mode's elastic energy in them. "
        "Growth of the bearings of shaft 1 and of shaft 2 that this rig needs for the printed frequencies, and the least "
        f"share that any rig needs in its first mode: {'; '.join(shares)}. This rig has a share of {100 * own:.0f} % in its "
        f"first mode. Its two growths leave misfits of up to {100 * worst:.1f} %: the second and the third frequency depend "
        "on the same bearings. For Case A₁ print and frequencies therefore fit together only for a rig whose bearings and "
        "coupling hold a third of the first mode's energy, though the thesis's own model on simple supports "
        "has no more than 155.7 Hz there; the 156 Hz measured (157 Hz updated model) in Case C₁ lie above this limit, unless "
        "the "
        "coupling stiffened as well.\n\n" + _splitting(rig)
    )


def _three(values: Floats) -> str:
    return ", ".join(f"{value:.0f}" for value in values)


def _energy_share(rig: Rig) -> float:
    """Share of the first mode's elastic energy in bearings and coupling: ½ d ln ω² / d ln k of all of them together."""
    viscous = np.array([name.rsplit(".", 1)[1].startswith("c") for name in rig.names])
    step = 1e-4
    grown = plane_frequencies(rig.machine, coefficients=rig.coefficients * np.where(viscous, 1.0, 1.0 + step))
    return float(2.0 * np.log(grown[0] / plane_frequencies(rig.machine, coefficients=rig.coefficients)[0]) / math.log1p(step))


def _splitting(rig: Rig) -> str:
    """The additional peak at 307 Hz that the thesis explains by anisotropy."""
    bearings = np.array([name.startswith(("bearing.B1", "bearing.B2")) and name.endswith("kxx") for name in rig.names])

    def lower_third(factor: float) -> Floats:
        roots = eigenvalues(rig.machine, coefficients=rig.coefficients * np.where(bearings, factor, 1.0))
        return np.abs(roots[:6]) / (2 * math.pi)

    factor = float(scipy.optimize.brentq(lambda one: lower_third(one)[4] - 307.0, 0.2, 1.0))
    found = lower_third(factor)
    return (
        "An additional peak at 307 Hz in the combined misalignment is explained in §5.8 by anisotropy that splits the third "
        f"frequency. In this rig that takes k_xx of bearings 1 and 2 reduced to {100 * factor:.0f} %, and then the second "
        f"frequency splits as well, into {found[2]:.0f} and {found[3]:.0f} Hz; the third lies at {found[4]:.0f} and "
        f"{found[5]:.0f} Hz. Table 5.5 shows no second split, and stiffness that only grows cannot lower a frequency, so the "
        "explanation does not fit this rig. That 307 Hz is near twice the first natural frequency (2 × 156 = 312 Hz) may be "
        "chance; a linear model cannot tell."
    )


def _impact_tests(rig: Rig) -> str:
    """Figure 5.25: which blows bring out which mode."""
    frequency = np.arange(100.0, 450.0, 0.5)
    first, second, opposite = Place("S1", 0.135), Place("S2", 0.135), Place("S2", 0.135, size=-1.0)
    against = Place("S1", 0.27, size=-1.0)
    patterns = (
        ("both discs alike (first mode)", [first, second]),
        ("discs opposite (second mode)", [first, opposite]),
        ("discs alike, coupling against them (third mode)", [first, second, against]),
    )
    rows = []
    for name, blows in patterns:
        row = [name]
        for sensor in (Place("S1", 0.239), Place("S2", 0.031)):
            spectrum = impact_spectrum(
                rig.machine, coefficients=rig.coefficients, blows=blows, sensor=sensor, frequency=frequency
            )
            places, sizes = spectrum_peaks(frequency, spectrum)
            order = np.argsort(-sizes)[:3]
            row.append(", ".join(f"{places[k]:.0f} Hz ({sizes[k] / sizes.max():.2f})" for k in order))
        rows.append(row)
    return (
        "### Impact tests: Figures 5.24 and 5.25\n\n"
        "Simulated at standstill, horizontal blows and accelerometer; the largest peaks, their height relative to the "
        "largest.\n\n"
        + table(["blows", "sensor at bearing 2", "sensor at bearing 3"], rows)
        + "\n\nThe third pattern brings out the third mode, as in the thesis. Between the first two it is the sensor that "
        "decides: the coupling of this rig is soft, so its first mode belongs to shaft 2 and its second to shaft 1, "
        "whichever way the discs are struck."
    )


LIKELIHOOD_SETS = 20
MISALIGNED_RUNS = 10
READINGS = 200
RECORD = 2.0
"""Length of a record [s]; the thesis does not print it."""


def _signals() -> str:
    """Appendix E, and what the thesis's way of reading a phasor costs."""
    table_e = [
        [f"{one:g} %", printed, f"{decibels(one):.2f}"]
        for one, printed in ((1, "40.00"), (2, "33.98"), (5, "26.02"), (100, "0"))
    ]
    rng = np.random.default_rng(0)
    rows = []
    for hertz in (SPEEDS_HZ[0], SPEEDS_HZ[3], SPEEDS_HZ[-1]):
        errors = np.array([_reading_errors(hertz, rng) for _ in range(READINGS)])
        rms = np.sqrt(np.mean(np.abs(errors) ** 2, axis=0))
        rows.append([f"{hertz:.0f}", *[percent(float(one)) for one in rms], percent(phasor_error(percent=5.0, samples=2000))])
    return (
        "### Appendix E: noise in decibels, and from signal to phasor\n\n"
        + table(["noise", "printed [dB]", "here [dB]"], table_e)
        + "\n\nThe thesis reads one maximum and one minimum of the band-passed signal (±2 Hz, Eq. 5.1) and the time from the "
        f"keyphasor's pulse (Eq. 5.2), at 1 kHz sampling. Relative rms error of the phasor over {READINGS} simulated records "
        f"of {RECORD:g} s with 5 % white noise (seed 0), random phase and random instant of the pulse:\n\n"
        + table(
            [
                "[Hz]",
                "one maximum and minimum, pulse known to a sample",
                "least squares, pulse known to a sample",
                "least squares, exact pulse",
                "the last one by formula",
            ],
            rows,
        )
        + "\n\nThe noise is not the matter; time is. A millisecond is 15° at 41 Hz. What the pulse adds turns all channels "
        "of a record together, half a sample on average; what the maximum adds differs from channel to channel, and every "
        "bound above grows with it. An interpolated pulse and a least-squares fit over the whole record bring 5 % of noise "
        "down to a part of a per cent."
    )


def _reading_errors(hertz: float, rng: np.random.Generator) -> list[complex]:
    """Relative errors of three ways to read one record."""
    rate = 1000.0
    time = np.arange(int(RECORD * rate)) / rate
    pulse = 0.8 + rng.uniform(0.0, 1.0 / hertz)
    phase = rng.uniform(-math.pi, math.pi)
    signal = np.cos(2 * math.pi * hertz * (time - pulse) + phase)
    noisy = noisy_signal(signal, decibels=decibels(5.0), rng=rng)
    seen = math.ceil(pulse * rate) / rate
    filtered = band_passed(noisy, sampling_rate=rate, frequency=hertz)
    found = (
        extrema_phasor(filtered, time=time, pulse=seen, frequency=hertz),
        least_squares_phasor(noisy, time=time, pulse=seen, frequency=hertz),
        least_squares_phasor(noisy, time=time, pulse=pulse, frequency=hertz),
    )
    return [one * complex(math.cos(phase), -math.sin(phase)) - 1.0 for one in found]
