"""Parts of a kind of finding: its elements, the changes it makes, its signs in the data, and its size."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np

from estimator.alignment.freed_coordinates import MovedCoordinates
from estimator.arrays import Floats
from estimator.diagnosis.change_columns import ChangeColumns
from estimator.diagnosis.data_faults import DataFault
from estimator.diagnosis.observation import Observation
from estimator.machine.parameter_description import describe

ElementKind = Literal["coupling", "bearing", "seal", "pedestal", "disc", "shaft", "probe", "static_load", "machine"]
ELEMENT_LISTS: Mapping[ElementKind, str] = {
    "coupling": "couplings",
    "bearing": "bearings",
    "seal": "seals",
    "pedestal": "pedestals",
    "disc": "discs",
    "shaft": "shafts",
    "probe": "probes",
    "static_load": "static_loads",
}
"""List of a machine's document that names the elements of each kind; the machine as a whole is in none."""
FindingPlace = Literal["machine", "channels", "data"]
ComparedWith = Literal["baseline", "runs_before"]
"""Runs that a change is told against: those of the baseline, or the ones just before the change."""


@dataclass(frozen=True, eq=False)
class ExpectedChange:
    """Change of the N quantities of a diagnosis that one finding at one element makes.

    Attributes:
        element: Name of the element, such as `coupling.C1`.
        variants: Columns (N, r) of the size expected, from simple to free [SI, logarithms of direct terms].
        moves: Names of the elements whose coefficients it changes.
        rising: Functionals (q, N) of the change that must be positive [-]; None for none.
    """

    element: str
    variants: tuple[Floats, ...]
    moves: frozenset[str] = frozenset()
    rising: Floats | None = None


@dataclass(frozen=True)
class Cause:
    """Something that has happened.

    Attributes:
        kind: Kind of the finding.
        element: Name of the element.
        evidence: Logarithm of the factor by which it makes the runs more probable, beside the other causes [-].
        names: Names of the k quantities that it moves.
        change: Change (k,) of these [SI, logarithms of direct terms].
        covariance: Covariance (k, k) of the change [SI²].
        distance: Size of the change in standard deviations [-].
        agreement: Per run of the window the logarithm of the factor by which the change makes this run by itself more probable
            [-].
    """

    kind: str
    element: str
    evidence: float
    names: tuple[str, ...]
    change: Floats
    covariance: Floats
    distance: float
    agreement: tuple[float, ...]

    @property
    def error(self) -> Floats:
        """Return the standard errors (k,) of the change [SI, logarithms of direct terms]."""
        return np.sqrt(np.diag(self.covariance))


@dataclass(frozen=True)
class SizePart:
    """One figure of the size of a cause, with its 95 % interval.

    Attributes:
        name: Name of what has changed, such as `bearing.B2.clearance`, or `coupling.C1.coefficients` for all together.
        unit: Unit of the figures, such as `%`, `um`, `urad`, `g mm`, `deg`.
        value: By how much it has changed against the baseline [unit].
        lower: Lower end of the 95 % interval [unit].
        upper: Upper end of the 95 % interval [unit].
        sigma: The change in its standard errors [-]; None where that is not said.
        allowed: What is allowed of its magnitude [unit]; None where nothing is.
        before: Value in the baseline [unit]; None where the change is all that is said.
        members: Names of the quantities whose common change it is.
        against: Runs that the change is told against.
    """

    name: str
    unit: str
    value: float
    lower: float
    upper: float
    sigma: float | None = None
    allowed: float | None = None
    before: float | None = None
    members: tuple[str, ...] = ()
    against: ComparedWith = "baseline"


def is_step_beside(step: float, half: float, *, whole: float) -> bool:
    """Check whether a step is certain, and another number than the change since the baseline, so that both are told.

    Args:
        step: The step [any unit].
        half: Half width of its 95 % interval [that unit].
        whole: The change since the baseline [that unit].

    Returns:
        Whether it is.
    """
    return abs(step) > half and abs(step - whole) > 0.5 * half


@dataclass(frozen=True)
class ChangeSize:
    """Size of a cause in customary units.

    Attributes:
        per_cent: Change in per cent of the element's values in the baseline [%]; None where the cause has no size.
        quantities: Parts of the size by name with the unit at its end, such as `stiffness_per_cent`, `magnitude_g_mm`,
            `angle_deg` [unit of the name].
        tolerance_per_cent: Change in per cent of what is allowed [%]; None where nothing is.
        beyond_tolerance: Probability that it is larger than what is allowed [-]; None where nothing is.
        parts: Figures of the size with their intervals, the one that matters most first.
    """

    per_cent: float | None
    quantities: Mapping[str, float] = field(default_factory=dict)
    tolerance_per_cent: float | None = None
    beyond_tolerance: float | None = None
    parts: tuple[SizePart, ...] = ()

    @property
    def limited(self) -> float | None:
        """Return the size that a level of a limit names: per cent of what is allowed, else of the baseline [%]."""
        return self.per_cent if self.tolerance_per_cent is None else self.tolerance_per_cent

    @property
    def unknown(self) -> bool:
        """Return whether the cause has no size that a limit could name."""
        return self.per_cent is None and self.tolerance_per_cent is None


@dataclass(frozen=True)
class BaselineValues:
    """Values of a machine in its baseline.

    Attributes:
        quantities: Mean of each quantity by name [SI, logarithms of direct terms].
        amplitudes: Median amplitude by channel [m].
    """

    quantities: Mapping[str, float]
    amplitudes: Mapping[str, float]


@dataclass(frozen=True)
class FindingKind:
    """Declaration of one kind of finding.

    Attributes:
        kind: Its name.
        elements: Kinds of elements at which it can lie.
        place: Place of the fault: the machine's coefficients and forces, the measuring channels, or the data and their model.
        changes: Function that yields the changes that it can make, one hypothesis each.
        data_fault: Function that finds it in the phasors of the baseline and of a window of runs.
        fit_fault: Function that finds it in the fits of a window, beside the channels that the diagnosis calls faulty.
        size: Function that returns the size of a cause; needed beside `changes`.
        form: Function that returns the form of a cause, as far as the data tell.
        linear: Whether it enters the response linearly, so that it explains its effect exactly.
        fitted: Whether each of the coefficients that it moves is an unknown of every fit by itself, so that nothing of it is
            left over for another cause.
        left_out: Whether it moves an error that fits leave out unless the document asks for it.
        moves: Coordinates of a train on oil films that it moves: a change of alignment must not hold them at the baseline's.
        errors: Quantities of its channel's chain that it makes wrong: a change of alignment beside it leaves them open.
        ahead_of_chains: Whether it is told only where it is clearly ahead of every fault of a measuring chain.
        beyond_fits: Whether it is told only where it changes a stiffness by more than single fits leave open of that.

    Raises:
        ValueError: A part of the declaration is missing.
    """

    kind: str
    elements: tuple[ElementKind, ...]
    place: FindingPlace
    changes: Callable[[ChangeColumns], Iterator[ExpectedChange]] | None = None
    data_fault: Callable[[Sequence[Observation], Sequence[Observation]], Iterator[DataFault]] | None = None
    fit_fault: Callable[[Sequence[Observation], frozenset[str]], Iterator[DataFault]] | None = None
    size: Callable[[Cause, BaselineValues], ChangeSize] | None = None
    form: Callable[[Cause], str | None] | None = None
    linear: bool = False
    fitted: bool = False
    left_out: bool = False
    moves: MovedCoordinates | None = None
    errors: tuple[str, ...] = ()
    ahead_of_chains: bool = False
    beyond_fits: bool = False

    @property
    def beside_fit(self) -> bool:
        """Return whether it lies in what fits leave out, and so may explain why one is refused."""
        return self.left_out or self.place == "channels"

    def __post_init__(self) -> None:
        if not self.elements:
            raise ValueError(f"finding kind '{self.kind}' names no kinds of elements at which it can lie")
        if unknown := [one for one in self.elements if one not in get_args(ElementKind)]:
            raise ValueError(f"finding kind '{self.kind}' names {', '.join(unknown)}, which is no kind of element")
        if self.changes is None and self.data_fault is None and self.fit_fault is None:
            raise ValueError(f"finding kind '{self.kind}' has no changes, data_fault or fit_fault: nothing would ever find it")
        if self.changes is not None and self.size is None:
            raise ValueError(f"finding kind '{self.kind}' has changes and no size: nobody could say how large they are")

    def require_element(self, element: str) -> None:
        """Check that the finding can lie at an element.

        Args:
            element: Name of the element.

        Raises:
            ValueError: It cannot.
        """
        if describe(element).element_kind not in self.elements:
            raise ValueError(f"finding kind '{self.kind}' is declared for {', '.join(self.elements)}, not for '{element}'")
