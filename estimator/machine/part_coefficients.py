"""Coefficients and unbalances of a document's parts by name, and the values that the document gives them."""

from collections.abc import Sequence
from typing import Protocol

from estimator.bearings.terms import ANGULAR, COUPLING, LATERAL, SEAL, Term
from estimator.machine.parts import Bearing, Coupling, Disc, Seal

ELEMENTS = {"bearings": "bearing", "couplings": "coupling", "seals": "seal"}
"""Lists of the document whose parts have coefficients, and what their parameters' names begin with."""


class Elements(Protocol):
    """Parts of a train that have coefficients."""

    @property
    def bearings(self) -> Sequence[Bearing]:
        """Bearings in the document's order."""

    @property
    def couplings(self) -> Sequence[Coupling]:
        """Couplings in the document's order."""

    @property
    def seals(self) -> Sequence[Seal]:
        """Seals in the document's order."""


def coefficient_values(train: Elements) -> dict[str, float | None]:
    """Return the nominal value by name, such as `bearing.B1.kxx`, of every coefficient that is identified."""
    return {
        f"{kind}.{part.id}.{name}": getattr(part, name)
        for place, kind in ELEMENTS.items()
        for part in getattr(train, place)
        for name in coefficient_names(part)
    }


def coefficient_names(part: Bearing | Coupling | Seal) -> tuple[str, ...]:
    """Return the names of the coefficients that are identified of a part, such as `kxx`."""
    return tuple(term.name for term in coefficient_terms(part))


def coefficient_terms(part: Bearing | Coupling | Seal) -> tuple[Term, ...]:
    """Return the terms that are identified of a part: those of its kind, and optional ones that its document gives."""
    always = LATERAL + (ANGULAR if isinstance(part, Coupling) else ())
    optional = COUPLING if isinstance(part, Coupling) else SEAL if isinstance(part, Seal) else ()
    return always + tuple(term for term in optional if getattr(part, term.name) is not None)


def planes(discs: Sequence[Disc]) -> dict[str, float | None]:
    """Return the nominal magnitude by name, such as `disc.D1.unbalance`, of every residual unbalance."""
    return {f"disc.{d.id}.unbalance": None if d.unbalance is None else d.unbalance.magnitude for d in discs}
