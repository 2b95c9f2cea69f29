"""What a machine document costs, counted without building its model, and how much it may cost.

The bounds are looked at where a document enters, not where a stored one is read: what an older release took stays readable.
"""

from dataclasses import dataclass
from math import ceil

from estimator.machine import Bearing, Coupling, DocumentError, Machine, Seal
from estimator.references import (
    ELEMENTS,
    STATION_TOLERANCE,
    coefficient_names,
    coefficient_values,
    planes,
    rules_in_force,
)
from estimator.rotor import shaft_pieces

LARGEST_ELEMENTS = 500
"""Shaft elements of one train: its sections, cut where a part sits and where they are longer than `element_length`."""
LARGEST_UNKNOWNS = 800
"""Real numbers that an identification determines."""
LARGEST_NUMBERS_PER_SPEED = 60_000
"""Complex numbers that an identification holds for each speed: with a thousand speeds a gigabyte."""


@dataclass(frozen=True)
class DocumentSize:
    """elements: of the shafts. unknowns: real numbers that an identification determines. joined: degrees of freedom at which
    something is joined or measured, n. excitations: complex forces, E. probes: m.
    """

    elements: int
    unknowns: int
    joined: int
    excitations: int
    probes: int

    @property
    def numbers_per_speed(self) -> int:
        """Complex numbers for each speed: dynamic stiffness n², forces 2 n E, derivatives of what is measured m · unknowns."""
        return self.joined**2 + 2 * self.joined * self.excitations + self.probes * self.unknowns


def document_size(machine: Machine) -> DocumentSize:
    """Count what a document asks for."""
    held = _held(machine)
    excitations = _excitations(machine, held)
    return DocumentSize(
        elements=sum(count for shaft in machine.shafts for _, _, count in shaft_pieces(machine, shaft)),
        unknowns=_coefficients(machine, held) + 2 * excitations + _materials(machine) + _channels(machine),
        joined=_joined(machine),
        excitations=excitations,
        probes=len(machine.probes),
    )


def require_affordable(machine: Machine) -> None:
    """Raises DocumentError, which names the field, for a document that asks for more than it may."""
    problems = []
    found = document_size(machine)
    if found.elements > LARGEST_ELEMENTS:
        sections = sum(len(shaft.sections) for shaft in machine.shafts)
        field, what = ("element_length", "raise it") if machine.element_length is not None else ("shafts", "join sections")
        words = f"{found.elements} elements of the shafts ({sections} sections); at most {LARGEST_ELEMENTS} are taken: {what}"
        problems.append((field, words))
    if found.unknowns > LARGEST_UNKNOWNS:
        words = f"{found.unknowns} unknowns to identify; at most {LARGEST_UNKNOWNS} are taken"
        problems.append(("document", f"{words}: fix or tie some in `parameters`, or give fewer `knots_rpm`"))
    if found.numbers_per_speed > LARGEST_NUMBERS_PER_SPEED:
        words = (
            f"{found.probes} probes, {found.unknowns} unknowns and {found.joined} degrees of freedom joined or measured make "
            f"{found.numbers_per_speed} numbers for each speed; at most {LARGEST_NUMBERS_PER_SPEED} are taken"
        )
        problems.append(("document", f"{words}: describe the train with fewer probes, bearings, seals or unknowns"))
    if problems:
        raise DocumentError(problems)


def _held(machine: Machine) -> set[str]:
    """Names of the parameters that the rules in force fix or tie."""
    in_force = rules_in_force(machine, [*coefficient_values(machine), *planes(machine)])
    rules = machine.parameters
    return {name for name, i in in_force.items() if rules[i].fixed or rules[i].tied_to is not None}


def _coefficients(machine: Machine, held: set[str]) -> int:
    """Of bearings, seals and couplings that are neither fixed nor tied, one for each knot where they follow the speed."""
    count = 0
    for place, kind in ELEMENTS.items():
        part: Bearing | Seal | Coupling
        for part in getattr(machine, place):
            names = [name for name in coefficient_names(place, part) if f"{kind}.{part.id}.{name}" not in held]
            count += sum(_knots(part, name) for name in names)
    return count


def _knots(part: Bearing | Seal | Coupling, name: str) -> int:
    dependence = part.speed_dependence
    follows = dependence is not None and (dependence.coefficients is None or name in dependence.coefficients)
    return len(dependence.knots_rpm) if dependence is not None and follows else 1


def _excitations(machine: Machine, held: set[str]) -> int:
    """Unbalances, bows and equivalent loads, complex."""
    unbalances = sum(name not in held for name in planes(machine))
    bows = sum(shaft.bow_spread > 0.0 for shaft in machine.shafts)
    loads = sum(coupling.load is not None for coupling in machine.couplings)
    return unbalances + bows + 4 * loads


def _materials(machine: Machine) -> int:
    used = {section.material for shaft in machine.shafts for section in shaft.sections}
    spreads = [(machine.materials[name].young_modulus_spread, machine.materials[name].density_spread) for name in used]
    return sum(one > 0.0 for pair in spreads for one in pair)


def _channels(machine: Machine) -> int:
    return sum(2 * ((probe.gain_spread > 0.0) + (probe.run_out_spread > 0.0)) for probe in machine.probes)


def _joined(machine: Machine) -> int:
    """Two at each place of a bearing, seal or probe, four at each end of a coupling."""
    places = {
        (part.shaft, ceil(part.station / STATION_TOLERANCE))
        for parts in (machine.bearings, machine.seals, machine.probes)
        for part in parts
    }
    return 2 * len(places) + 8 * len(machine.couplings)
