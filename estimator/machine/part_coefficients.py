"""Coefficients and unbalances of a document's parts by name, with the values that the document gives them."""

from collections.abc import Sequence
from typing import Protocol

from estimator.bearings.terms import ANGULAR, COUPLING, LATERAL, PEDESTAL, SEAL, Term
from estimator.machine.parts import Bearing, Coupling, Disc, LateralCoefficients, Pedestal, Seal

ELEMENTS = {"bearings": "bearing", "couplings": "coupling", "seals": "seal", "pedestals": "pedestal"}
"""Lists of the document whose parts have coefficients, and the beginning of their parameters' names."""


class Elements(Protocol):
    """Parts of a train that have coefficients."""

    @property
    def bearings(self) -> Sequence[Bearing]:
        """Return the bearings in the document's order."""

    @property
    def couplings(self) -> Sequence[Coupling]:
        """Return the couplings in the document's order."""

    @property
    def seals(self) -> Sequence[Seal]:
        """Return the seals in the document's order."""

    @property
    def pedestals(self) -> Sequence[Pedestal]:
        """Return the pedestals in the document's order."""


def coefficient_values(train: Elements) -> dict[str, float | None]:
    """Return the nominal value of every coefficient that is identified, as its part gives it.

    Args:
        train: Parts with coefficients.

    Returns:
        Nominal value by name, such as `bearing.B1.kxx` [SI]; None where the document gives none.
    """
    return {
        f"{kind}.{part.id}.{name}": getattr(part, name)
        for place, kind in ELEMENTS.items()
        for part in getattr(train, place)
        for name in coefficient_names(part)
    }


def given_over_speed(train: Elements, *, rpm: float) -> frozenset[str]:
    """Return the names of the coefficients with nominal values from a form over speed, such as a table.

    Args:
        train: Parts with coefficients.
        rpm: Any speed of the machine [r/min].

    Returns:
        Names, such as `bearing.B1.kxx`.
    """
    return frozenset(
        f"{kind}.{part.id}.{name}"
        for place, kind in ELEMENTS.items()
        for part in getattr(train, place)
        for name in coefficient_names(part)
        if part.speed_dependence is not None and part.speed_dependence.nominal(name, rpm) is not None
    )


def nominal_value(part: LateralCoefficients, term: str, *, rpm: float) -> float | None:
    """Return the nominal value of a term of a part: that of its form, where the form gives one, else its own.

    Args:
        part: The part.
        term: The term, such as `kxx`.
        rpm: Speed [r/min].

    Returns:
        The value [SI]; None where the document gives none.
    """
    form = part.speed_dependence
    given = None if form is None else form.nominal(term, rpm)
    value: float | None = getattr(part, term)
    return value if given is None else given


def coefficient_names(part: Bearing | Coupling | Seal | Pedestal) -> tuple[str, ...]:
    """Return the names of the coefficients that are identified of a part.

    Args:
        part: The part.

    Returns:
        Names, such as `kxx`.
    """
    return tuple(term.name for term in coefficient_terms(part))


def coefficient_terms(part: Bearing | Coupling | Seal | Pedestal) -> tuple[Term, ...]:
    """Return the terms that are identified of a part: those of its kind, and optional ones that its document gives.

    Args:
        part: The part.

    Returns:
        The terms.
    """
    if isinstance(part, Pedestal):
        return PEDESTAL
    always = LATERAL + (ANGULAR if isinstance(part, Coupling) else ())
    optional = COUPLING if isinstance(part, Coupling) else SEAL if isinstance(part, Seal) else ()
    return always + tuple(term for term in optional if getattr(part, term.name) is not None)


def planes(discs: Sequence[Disc]) -> dict[str, float | None]:
    """Return the nominal magnitude of every residual unbalance.

    Args:
        discs: The discs.

    Returns:
        Magnitude by name, such as `disc.D1.unbalance` [kg m]; None where the document gives none.
    """
    return {f"disc.{d.id}.unbalance": None if d.unbalance is None else d.unbalance.magnitude for d in discs}
