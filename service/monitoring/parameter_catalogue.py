"""The parameters and derived quantities that a machine can have, under the newest revisions of its document, with their
units."""

from collections.abc import Collection, Iterator

from sqlalchemy.orm import Session

from estimator.errors import Missing
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.rotor.parameter_names import derived_unit, derived_units, number_as_word, parameter_units
from storage.machines import machines

MAXIMUM_REVISIONS = 20
"""Number of newest revisions searched: each takes an assembly of the rotor (some 1 ms), and anybody may ask for any name."""


class ParameterUnknown(Missing):
    """None of the newest revisions of a machine's document has a parameter, or derived quantity, of that name."""

    subject = "parameter"


def units_of(session: Session, machine_id: str, names: Collection[str]) -> dict[str, str]:
    """Return the SI unit of each parameter or derived quantity, identified or not, from the newest revision that has it.

    Raises MachineUnknown, ParameterUnknown.
    """
    found: dict[str, str] = {}
    for document in _newest_first(session, machine_id):
        left = [name for name in names if name not in found]
        if not left:
            break
        parameters = parameter_units(document)
        found |= {name: unit for name in left if (unit := parameters.get(name) or derived_unit(document, name))}
    for name in names:
        if name not in found:
            there = _known_names_text(machines.document(session, machine_id), name)
            raise ParameterUnknown(f"{name} of machine '{machine_id}': {there}")
    return found


def _newest_first(session: Session, machine_id: str) -> Iterator[Machine]:
    newest = machines.get(session, machine_id).revision
    for number in range(newest, max(0, newest - MAXIMUM_REVISIONS), -1):
        yield machines.document(session, machine_id, number)


def _known_names_text(document: Machine, name: str) -> str:
    """Return a text that lists the element's names or, when there is no such element, the elements."""
    names = [*parameter_units(document), *map(number_as_word, derived_units(document))]
    element = _element(name)
    own = [one for one in names if _element(one) == element]
    if own:
        return f"{element} has {', '.join(own)}"
    return f"it has {', '.join(dict.fromkeys(map(_element, names)))}"


def _element(name: str) -> str:
    """Return the element of a name, `bearing.B1` of `bearing.B1.kxx`; for a quantity of the whole train its kind, as
    `critical_speed`."""
    described = describe(name)
    return described.element if described.quantity else described.element_kind
