"""Terms of the coefficients of bearings, seals, couplings and pedestals: their names and the axes between which they act."""

from typing import Literal

from msgspec import Struct

from estimator.quantities import ORDER, Quantity

Axis = Literal["x", "y", "phix", "phiy"]
"""Axis of a term: a displacement along x or y, or a slope about x or y."""


class Term(Struct, frozen=True):
    """One term: the force or moment along an axis per motion along another.

    Attributes:
        name: Name of the term.
        quantity: Physical quantity.
        force: Axis of the force or moment.
        motion: Axis of the motion.
        beside: Names of the two direct terms by which a cross-coupled term is measured; of a direct term, its own.
        reciprocal: Whether the same coefficient also gives the force along the motion's axis per motion along the force's.
    """

    name: str
    quantity: Quantity
    force: Axis
    motion: Axis
    beside: tuple[str, str]
    reciprocal: bool = False

    @property
    def direct(self) -> bool:
        """Return whether the term is positive by nature; its logarithm is fitted, compared and averaged then."""
        return self.force == self.motion

    @property
    def order(self) -> int:
        """Return the power of jω with which the term acts."""
        return ORDER.get(self.quantity, 0)

    @property
    def axes(self) -> tuple[tuple[Axis, Axis], ...]:
        """Return the pairs of axes, of the force and of the motion, between which the term acts."""
        own = (self.force, self.motion)
        return (own, own[::-1]) if self.reciprocal else (own,)


LATERAL = (
    Term("kxx", "stiffness", "x", "x", ("kxx", "kxx")),
    Term("kxy", "stiffness", "x", "y", ("kxx", "kyy")),
    Term("kyx", "stiffness", "y", "x", ("kxx", "kyy")),
    Term("kyy", "stiffness", "y", "y", ("kyy", "kyy")),
    Term("cxx", "damping", "x", "x", ("cxx", "cxx")),
    Term("cxy", "damping", "x", "y", ("cxx", "cyy")),
    Term("cyx", "damping", "y", "x", ("cxx", "cyy")),
    Term("cyy", "damping", "y", "y", ("cyy", "cyy")),
)
"""Terms that every bearing, seal and coupling has."""

ANGULAR = (
    Term("k_phix", "angular stiffness", "phix", "phix", ("k_phix", "k_phix")),
    Term("k_phiy", "angular stiffness", "phiy", "phiy", ("k_phiy", "k_phiy")),
)
"""Terms that every coupling has besides."""

COUPLING = (
    Term("k_phixy", "angular stiffness", "phix", "phiy", ("k_phix", "k_phiy")),
    Term("k_phiyx", "angular stiffness", "phiy", "phix", ("k_phix", "k_phiy")),
    Term("c_phix", "angular damping", "phix", "phix", ("c_phix", "c_phix")),
    Term("c_phiy", "angular damping", "phiy", "phiy", ("c_phiy", "c_phiy")),
    Term("kx_phiy", "coupled stiffness", "x", "phiy", ("kxx", "k_phiy"), reciprocal=True),
    Term("ky_phix", "coupled stiffness", "y", "phix", ("kyy", "k_phix"), reciprocal=True),
)
"""Terms of a coupling that are identified only where the document gives them."""

SEAL = (
    Term("mxx", "inertia", "x", "x", ("mxx", "mxx")),
    Term("myy", "inertia", "y", "y", ("myy", "myy")),
)
"""Terms of a seal that are identified only where the document gives them."""

PEDESTAL = tuple(one for one in (*LATERAL, *SEAL) if one.direct)
"""Terms of a pedestal, which moves along x and along y by itself."""

TERMS = {one.name: one for one in (*LATERAL, *ANGULAR, *COUPLING, *SEAL)}
"""Every term by name."""
