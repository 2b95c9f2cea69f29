"""What a parameter's name says: the element it belongs to, the term or quantity it is, the knot, the component.

Names are `element kind.id.term`, with `@knot` behind a value at a knot and `.real` or `.imaginary` behind a component:
`bearing.B1.kxx@1500rpm`, `disc.D1.unbalance.real`, `material.steel.density`.
"""

from dataclasses import dataclass
from functools import lru_cache

from estimator.bearings.registry import OWN_PARAMETERS
from estimator.bearings.terms import TERMS, Term

SCALE_FACTORS = frozenset({"young_modulus", "density"})
"""Factors on a material's properties, positive and fitted as logarithms too."""
COMPONENTS = ("real", "imaginary")
"""Parts of a complex parameter."""
REMEMBERED = 10_000
"""Names that are kept with what they say."""


@dataclass(frozen=True)
class ParameterDescription:
    """A parameter's name in its parts.

    element_kind, element_id: such as "bearing" and "B1". quantity: such as "kxx" or "unbalance". knot: such as "1500rpm", None
    of what is no value at a knot. component: "real" or "imaginary" of a complex one, else None. term: None of what is no
    coefficient.
    """

    element_kind: str
    element_id: str
    quantity: str
    knot: str | None
    component: str | None
    term: Term | None

    @property
    def element(self) -> str:
        """Name of the element, such as `bearing.B1`."""
        return f"{self.element_kind}.{self.element_id}" if self.element_id else self.element_kind

    @property
    def whole(self) -> str:
        """Name of the parameter without knot and component, such as `bearing.B1.kxx` or `disc.D1.unbalance`."""
        return f"{self.element}.{self.quantity}"

    @property
    def positive(self) -> bool:
        """Whether it is positive by nature; its logarithm is fitted, compared and averaged then."""
        if self.term is not None:
            return self.term.direct
        own = OWN_PARAMETERS.get(self.quantity)
        return own.positive if own is not None else self.quantity in SCALE_FACTORS

    def of_term(self, term: str) -> str:
        """Return the name that another term of the element has, at the same knot."""
        return f"{self.element}.{term}" + ("" if self.knot is None else f"@{self.knot}")


@lru_cache(maxsize=REMEMBERED)
def describe(name: str) -> ParameterDescription:
    """Return what a parameter's name says. Names of other things come back with what of them is missing left empty."""
    stem, _, knot = name.partition("@")
    element_kind, _, rest = stem.partition(".")
    element_id, _, rest = rest.partition(".")
    quantity, _, component = rest.partition(".")
    return ParameterDescription(
        element_kind, element_id, quantity, knot or None, component if component in COMPONENTS else None, TERMS.get(quantity)
    )


def is_direct(name: str) -> bool:
    """Return whether a parameter, such as `bearing.B1.kxx@1500rpm`, is a direct term or another that is positive by nature."""
    return describe(name).positive
