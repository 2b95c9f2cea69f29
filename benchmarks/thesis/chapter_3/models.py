"""Chapter 3: critical speeds of the flexible train, and the damping of its shafts (Appendix B)."""

import numpy as np

from benchmarks.documents import Document
from benchmarks.thesis.chapter_3.cases import BEST, DAMPING_FREQUENCIES, damped, measured
from benchmarks.thesis.flexible.experiments import Subject, load, regression
from benchmarks.thesis.flexible.misprints import natural_frequencies, with_printed_rotary_inertia
from benchmarks.thesis.flexible.printed import CRITICAL_SPEEDS
from benchmarks.thesis.tables import percent, table
from estimator.modes.critical_speed import critical_speeds
from estimator.thesis.reduction import eliminated


def critical_speeds_section(subject: Subject) -> str:
    """Write the section on critical speeds."""
    variants = {
        "critical speeds, data as printed": subject,
        "elements of 0.05 m": load(_finer),
        "no cross-coupled coefficients": load(_without_cross),
        "E halved": load(_halved),
        "shaft 15 mm": load(_thinner),
        "discs twice as heavy": load(_heavier),
    }
    rows = [["thesis §3.4", *[f"{one:.1f}" for one in CRITICAL_SPEEDS]]]
    misprinted = with_printed_rotary_inertia(subject)
    for name, one in (("rotary inertia ρI", subject), ("rotary inertia ρAl of Eq. A.5-A.8", misprinted)):
        rows.append([f"undamped, at rest, {name}", *[f"{value:.1f}" for value in natural_frequencies(one)[:8]]])
    for name, one in variants.items():
        found = critical_speeds(one.machine, highest=700.0)[:8]
        rows.append([name, *[f"{value:.1f}" for value in found], *["-"] * (8 - len(found))])
    return (
        "### Critical speeds\n\n"
        + table(["[rad/s]", *[str(k) for k in range(1, 9)]], rows)
        + "\n\nThe printed speeds do not follow from the printed data. The model's response agrees with that of ROSS "
        "(`python -m "
        "benchmarks.estimator`), and none of the slips of the pen tried in the data explains the difference. What "
        "does, with "
        "nothing adjusted, up to 6 % (3.4 % rms; without it 61 % and 41 %), is the rotary inertia of Appendix A taken as "
        "it is "
        "printed: its prefix ρAl where ρI belongs makes it 10⁴ times too large for these elements. Most likely the thesis's "
        "responses come from that mass matrix too; the tables below try it beside the right one."
    )


def _finer(document: Document) -> None:
    document["element_length"] = 0.05


def _without_cross(document: Document) -> None:
    for part in (*document["bearings"], *document["couplings"]):
        part.update(kxy=0.0, kyx=0.0, cxy=0.0, cyx=0.0)


def _halved(document: Document) -> None:
    document["materials"]["steel"]["young_modulus"] /= 2


def _thinner(document: Document) -> None:
    for shaft in document["shafts"]:
        shaft["sections"][0]["outer_diameter"] = 0.015


def _heavier(document: Document) -> None:
    for disc in document["discs"]:
        for name in ("mass", "diametral_inertia", "polar_inertia"):
            disc[name] *= 2


def damping_section(subject: Subject) -> str:
    """Write the section on the damping of the shafts."""
    rows = []
    for ratio in (0.001, 0.01):
        other = damped(subject, ratio)
        model, clean = measured(other, BEST)
        same = np.abs(regression(other, model, clean).values / subject.truth - 1)
        lacking = eliminated(subject.train, speed=BEST.speed, direction=BEST.direction)
        biased = np.abs(regression(subject, lacking, clean).values / subject.truth - 1)
        rows.append(
            [f"{100 * ratio:g} %", *[f"{percent(float(np.median(e)))} / {percent(float(e.max()))}" for e in (same, biased)]]
        )
    lower, upper = DAMPING_FREQUENCIES
    return (
        "### Rayleigh damping of the shafts (Eq. 3.5, Appendix B)\n\n"
        "The thesis gives the equations but neither a₀ and a₁ nor the ratios, and says elsewhere that no internal damping "
        "is "
        f"considered. With the stated ratio at {lower:g} and {upper:g} rad/s, Case C of Method II, no noise, median / "
        f"largest "
        "error:\n\n" + table(["ratio", "model has it too", "model lacks it"], rows)
    )
