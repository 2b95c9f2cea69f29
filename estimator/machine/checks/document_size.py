"""Cost of computing with a machine document, and its bounds: checked wherever a document enters.

A document that is stored already is read whatever its size, so that nothing is lost where a bound changes.

The cost model. A fit of S samples keeps the shafts' dynamic stiffness at the r plane degrees of freedom at which parts sit,
for either sense of whirl: 2 · 16 S r² bytes; and of a block of 256 samples the derivatives of m probes by n real unknowns and
K coefficients: 48 · 256 m (n + K), and the system over both planes: 64 · 256 (2r)²; where there are films,
the derivatives by their sharp deviations, up to 2.1 for each unknown: 33 · 256 m n. One evaluation takes some S (4 n² m + 16/3
(2r)³ + 32 r m K) operations, and a fit some tens of them. A document is taken while both stay within the bounds below for 500
samples; of a large one, samples are thinned out to as many as do. How many of them a fit takes depends on the data: a worker's
own limits of time and memory hold beside these bounds.
"""

import math
from collections.abc import Iterator
from typing import Any

from msgspec import Struct

from estimator.bearings.registry import CONSTANT
from estimator.machine.bearings_on_films import bearings_on_films
from estimator.machine.checks.document_warnings import document_warnings
from estimator.machine.checks.plausibility import implausible_values
from estimator.machine.document import DocumentError, Machine, parse_machine
from estimator.machine.films import JournalFilm
from estimator.machine.mesh import element_count
from estimator.machine.part_coefficients import ELEMENTS, coefficient_names
from estimator.machine.parts import Bearing, Probe, Seal
from estimator.units import rpm_to_rad_per_s

LARGEST_SECTIONS = 400
"""Most shaft sections of a train."""
LARGEST_ELEMENTS = 600
"""Most shaft elements of a train."""
LARGEST_UNKNOWNS = 1200
"""Most real unknowns of a train's identification."""
LARGEST_PLACES = 100
"""Most plane degrees of freedom at which bearings, seals, couplings and probes sit."""
LARGEST_MODES = 60
"""Most bending modes of the shafts in a plane up to `MODES_UP_TO` times the highest speed, where there are many elements."""
MODES_UP_TO = 2.5
"""Multiple of the highest speed up to which bending modes are counted [-]."""
FEW_ELEMENTS = 50
"""Number of elements up to which all modes are cheap."""
LARGEST_PADS = 16
"""Most different pads of oil films: each takes up to 13 s before the first fit, of the some minutes that a fit may take."""
FEWEST_SAMPLES = 500
"""Least number of samples that a fit of a train must manage."""
MEMORY = 1.5e9
"""Most memory of a fit, beside the programs themselves [bytes]."""
OPERATIONS = 1e11
"""Most operations of one evaluation: some seconds; more where E and density are unknowns, as the shafts are eliminated anew
then.
"""
BLOCK = 256
"""Number of samples whose derivatives are held at a time."""


class DocumentSize(Struct, frozen=True):
    """Counts of a train.

    Attributes:
        sections: Number of shaft sections.
        elements: Number of shaft elements.
        modes: Number of bending modes as in `LARGEST_MODES`, about.
        coefficients: Number of coefficients of bearings, seals, couplings and pedestals.
        unknowns: Number of real unknowns.
        probes: Number of probes.
        places: Number of plane degrees of freedom at which parts sit.
        pads: Number of different pads of the oil films that coefficients follow from.
    """

    sections: int
    elements: int
    modes: int
    coefficients: int
    unknowns: int
    probes: int
    places: int
    pads: int

    @property
    def samples(self) -> int:
        """Return the most samples of one fit; fewer than FEWEST_SAMPLES where the document is too large."""
        n, m, k, r = self.unknowns, self.probes, self.coefficients, self.places
        held = 48 * BLOCK * m * (n + k) + 64 * BLOCK * (2 * r) ** 2
        held += 33 * BLOCK * m * n if self.pads else 0
        by_memory = (MEMORY - held) / (32 * r**2)
        by_time = OPERATIONS / (4 * n**2 * m + 16 / 3 * (2 * r) ** 3 + 32 * r * m * k)
        return max(0, int(min(by_memory, by_time)))


def accepted_machine(document: Any) -> Machine:
    """Read the machine that a decoded document describes, where that is neither too large nor implausible.

    Args:
        document: The decoded document.

    Returns:
        The machine.

    Raises:
        DocumentError: The document is wrong, too large, or has a value that only a slip of the unit explains.
    """
    try:
        machine = parse_machine(document)
    except DocumentError as error:
        raise DocumentError([*error.problems, *_hidden_by_rules(document, error)]) from None
    return require_acceptable(machine)


def require_acceptable(machine: Machine) -> Machine:
    """Return the machine, where its document is neither too large nor implausible.

    Args:
        machine: The machine.

    Returns:
        The same machine.

    Raises:
        DocumentError: The document is too large, or has a value that only a slip of the unit explains; the error names what is
            wrong and what would be right.
    """
    sections = _sections(machine)
    if sections > LARGEST_SECTIONS:  # nothing else is counted then
        raise DocumentError(
            [("shafts", f"{sections} sections in all; at most {LARGEST_SECTIONS}: make one of neighbours that differ little")]
        )
    problems = [*implausible_values(machine), *_problems(machine, document_size(machine))]
    if problems:
        raise DocumentError(problems)
    return machine


def _hidden_by_rules(document: Any, error: DocumentError) -> Iterator[tuple[str, str]]:
    """Yield what is probably in another unit of a document in which nothing else than rules for parameters is wrong."""
    if isinstance(document, dict) and all(field.startswith("parameters[") for field, _ in error.problems):
        try:
            machine = parse_machine({**document, "parameters": []})
        except DocumentError:  # the rest is not right without rules either
            return
        doubted = {one.field: one.words for one in document_warnings(machine) if "meant" in one.words}
        yield from (doubted | dict(implausible_values(machine))).items()


def document_size(machine: Machine) -> DocumentSize:
    """Count the parts of a machine without assembling it.

    Args:
        machine: The machine.

    Returns:
        The counts.
    """
    return DocumentSize(
        sections=_sections(machine),
        elements=sum(element_count(machine, shaft) for shaft in machine.shafts),
        modes=_modes(machine),
        coefficients=sum(len(coefficient_names(part)) for kind in ELEMENTS for part in getattr(machine, kind)),
        unknowns=_unknowns(machine),
        probes=len(machine.probes),
        places=_places(machine),
        pads=_pads(machine),
    )


def _problems(machine: Machine, size: DocumentSize) -> list[tuple[str, str]]:
    found: list[tuple[str, str]] = []
    if size.elements > LARGEST_ELEMENTS:
        given = machine.element_length is not None
        advice = "a longer element_length would do" if given else "fewer sections, or a given element_length, would do"
        words = f"{size.elements} elements of the shafts; at most {LARGEST_ELEMENTS}: {advice}"
        found.append(("element_length" if given else "shafts", words))
    if size.elements > FEW_ELEMENTS and size.modes > LARGEST_MODES:
        words = (
            f"{machine.speed_range.maximum_rpm:g} r/min: the shafts have about {size.modes} bending modes up to "
            f"{MODES_UP_TO:g} times that; at most {LARGEST_MODES}: is the speed right?"
        )
        found.append(("speed_range.maximum_rpm", words))
    if size.unknowns > LARGEST_UNKNOWNS:
        words = (
            f"{size.unknowns} real unknowns; at most {LARGEST_UNKNOWNS}: fewer knots_rpm of speed_dependence, "
            "or gains and run-outs of channels taken as exact, would do"
        )
        found.append(("document", words))
    if size.places > LARGEST_PLACES:
        words = (
            f"bearings, seals, couplings and probes sit at {size.places} plane degrees of freedom; at most {LARGEST_PLACES}: "
            "those at one station count once, a coupling counts four"
        )
        found.append(("document", words))
    if size.pads > LARGEST_PADS:
        words = (
            f"the oil films have {size.pads} different pads; at most {LARGEST_PADS}: films of one profile, groove, arc, pivot "
            "and length over diameter count once"
        )
        found.append(("bearings", words))
    if not found and size.samples < FEWEST_SAMPLES:
        words = (
            f"{size.unknowns} real unknowns with {size.probes} probes at {size.places} places: only {size.samples} samples "
            f"could be fitted at a time; at least {FEWEST_SAMPLES}: fewer unknowns or fewer probes would do"
        )
        found.append(("document", words))
    return found


def _sections(machine: Machine) -> int:
    return sum(len(shaft.sections) for shaft in machine.shafts)


def _modes(machine: Machine) -> int:
    """Estimate the number of bending modes from the length of waves at that frequency.

    ω = c κ k² with κ the radius of gyration.
    """
    highest = MODES_UP_TO * rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    half_waves = 0.0
    for section in (section for shaft in machine.shafts for section in shaft.sections):
        material = machine.materials[section.material]
        gyration = math.hypot(section.outer_diameter, section.inner_diameter) / 4
        wave_number = math.sqrt(highest / (math.sqrt(material.young_modulus / material.density) * gyration))
        half_waves += section.length * wave_number / math.pi
    return math.ceil(half_waves)


def _unknowns(machine: Machine) -> int:
    """Count the real unknowns as if nothing were held fixed or tied."""
    count = 2 * len(machine.discs)
    for kind in ELEMENTS:
        for part in getattr(machine, kind):
            names = coefficient_names(part)
            form = part.speed_dependence or CONSTANT
            governed = [name for name in names if form.governs(name)]
            count += len(names) - len(governed) + form.parameter_count(governed)
    count += 2 * sum(shaft.bow_spread > 0.0 for shaft in machine.shafts)
    count += 8 * sum(coupling.load is not None for coupling in machine.couplings)
    count += 4 * sum(coupling.rotating_error is not None for coupling in machine.couplings)
    count += 2 * sum((probe.gain_spread > 0.0) + (probe.run_out_spread > 0.0) for probe in machine.probes)
    return count + sum((one.young_modulus_spread > 0.0) + (one.density_spread > 0.0) for one in machine.materials.values())


def _places(machine: Machine) -> int:
    """Count plane degrees of freedom: of a bearing, seal, pedestal or probe the displacement, of a coupling both of either
    end."""
    lengths = {shaft.id: shaft.length for shaft in machine.shafts}
    parts: list[Bearing | Seal | Probe] = [*machine.bearings, *machine.seals, *machine.probes]
    sitting = {(part.shaft, round(part.station, 9), "displacement") for part in parts}
    sitting |= {("pedestal", number, "displacement") for number in range(len(machine.pedestals))}
    for coupling in machine.couplings:
        for shaft, station in ((coupling.driver, round(lengths[coupling.driver], 9)), (coupling.driven, 0.0)):
            sitting |= {(shaft, station, "displacement"), (shaft, station, "slope")}
    return len(sitting)


def _pads(machine: Machine) -> int:
    """Count the pads whose films are tabulated; where bearings are alike but for size, clearance and oil, they have one."""
    films = [one.film for one in bearings_on_films(machine.bearings)]
    return len({(_shape(film), film.length / film.diameter) for film in films})


def _shape(film: JournalFilm) -> tuple[str | float, ...]:
    """Return what a pad's film depends on beside its length over its diameter; a plain bore has no groove."""
    if film.pads is not None:
        return film.profile, film.pads.arc_deg, film.pads.pivot
    return (film.profile,) if film.profile == "plain" else (film.profile, film.groove_deg)
