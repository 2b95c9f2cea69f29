"""Description of a parameter by its name: its element, the term or quantity it is, the knot, the component.

Names are `element kind.id.term`, with `@knot` behind a value at a knot and `.real` or `.imaginary` behind a component:
`bearing.B1.kxx@1500rpm`, `disc.D1.unbalance.real`, `material.steel.density`.
"""

from functools import lru_cache

from msgspec import Struct

from estimator.bearings.registry import OWN_PARAMETERS
from estimator.bearings.terms import TERMS, Term

SCALE_FACTORS = frozenset({"young_modulus", "density"})
"""Factors on a material's properties, positive and fitted as logarithms."""
ROTATING_ERRORS = ("rotating_offset", "rotating_angle")
"""Run-outs of a coupling's bore and face."""
COMPONENTS = ("real", "imaginary")
"""Parts of a complex parameter."""
CACHE_SIZE = 10_000
"""Number of names whose description is cached."""


class ParameterDescription(Struct, frozen=True):
    """A parameter's name in its parts.

    Attributes:
        element_kind: Kind of the element, such as "bearing".
        element_id: Id of the element, such as "B1".
        quantity: Term or quantity, such as "kxx" or "unbalance".
        knot: Knot, such as "1500rpm"; None for anything but a value at a knot.
        component: "real" or "imaginary" of a complex parameter, else None.
        term: The term; None for anything but a coefficient.
    """

    element_kind: str
    element_id: str
    quantity: str
    knot: str | None
    component: str | None
    term: Term | None

    @property
    def element(self) -> str:
        """Return the name of the element, such as `bearing.B1`."""
        return f"{self.element_kind}.{self.element_id}" if self.element_id else self.element_kind

    @property
    def whole(self) -> str:
        """Return the name of the parameter without knot and component, such as `bearing.B1.kxx` or `disc.D1.unbalance`."""
        return f"{self.element}.{self.quantity}"

    @property
    def channel(self) -> str | None:
        """Return the id of the channel whose gain or run-out it is; None for anything else."""
        return self.element_id if self.element_kind == "probe" else None

    @property
    def error_of(self) -> str | None:
        """Return what has an error that fits leave out unless the document asks for it; None for anything else.

        It is the id of a channel, or the name of a coupling.
        """
        return self.element if self.quantity in ROTATING_ERRORS else self.channel

    @property
    def physical_quantity(self) -> str | None:
        """Return the physical quantity, such as "elevation" of `elevation_x`; None of what no bearing model knows."""
        if self.term is not None:
            return self.term.quantity
        own = OWN_PARAMETERS.get(self.quantity)
        return None if own is None else own.quantity

    @property
    def positive(self) -> bool:
        """Return whether it is positive by nature; its logarithm is fitted, compared and averaged then."""
        if self.term is not None:
            return self.term.direct
        own = OWN_PARAMETERS.get(self.quantity)
        return own.positive if own is not None else self.quantity in SCALE_FACTORS

    @property
    def coefficient(self) -> str:
        """Return the name of the coefficient whose value, or scale factor, it is; `whole` for anything else."""
        own = OWN_PARAMETERS.get(self.quantity)
        return self.whole if own is None or own.term is None else f"{self.element}.{own.term}"

    def of_term(self, term: str) -> str:
        """Return the name of another term of the element, at the same knot.

        Args:
            term: The other term, such as "kyy".

        Returns:
            Its name.
        """
        return f"{self.element}.{term}" + ("" if self.knot is None else f"@{self.knot}")


@lru_cache(maxsize=CACHE_SIZE)
def describe(name: str) -> ParameterDescription:
    """Separate a parameter's name into its parts.

    Args:
        name: The name; names of other things come back with missing parts left empty.

    Returns:
        The description.
    """
    stem, _, knot = name.partition("@")
    element_kind, _, rest = stem.partition(".")
    element_id, _, rest = rest.partition(".")
    quantity, _, component = rest.partition(".")
    return ParameterDescription(
        element_kind, element_id, quantity, knot or None, component if component in COMPONENTS else None, TERMS.get(quantity)
    )


def is_direct(name: str) -> bool:
    """Return whether a parameter is positive by nature: a direct term, a scale factor or another such one.

    Args:
        name: Name, such as `bearing.B1.kxx@1500rpm`.

    Returns:
        Whether it is.
    """
    return describe(name).positive
