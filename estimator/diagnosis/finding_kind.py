"""Parts of a kind of finding: where it can lie, what it changes, how it shows in the data, and how large it is."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from estimator.arrays import Floats
from estimator.diagnosis.change_columns import ChangeColumns
from estimator.diagnosis.data_faults import DataFault
from estimator.diagnosis.observation import Observation

ElementKind = Literal["coupling", "bearing", "seal", "disc", "shaft", "probe", "machine"]
Place = Literal["machine", "channels", "data"]


@dataclass(frozen=True, eq=False)
class ExpectedChange:
    """Change of the quantities of a diagnosis that one finding at one element makes.

    element: such as `coupling.C1`. variants: each (N, r) columns of the size expected, from simple to free. moves: elements
    whose coefficients it changes. rising: (q, N) functionals of the change that must be positive; None for none.
    """

    element: str
    variants: tuple[Floats, ...]
    moves: frozenset[str] = frozenset()
    rising: Floats | None = None


@dataclass(frozen=True)
class Cause:
    """Something that has happened.

    evidence: log of the factor by which it makes the runs more probable, beside the other causes. names: of the quantities
    that it moves; change: by how much, logarithms or SI; covariance: of the change. distance: of the change, in standard
    deviations. agreement: per run of the window the logarithm of the factor by which the change makes this run by itself
    more probable.
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
        """Standard errors of the change."""
        return np.sqrt(np.diag(self.covariance))


@dataclass(frozen=True)
class ChangeSize:
    """Size of a cause in the units that people reckon in.

    per_cent: of the element's values in the baseline; None where the cause has no size. quantities: the parts of the size, by
    name with the unit at its end, such as `stiffness_per_cent`, `magnitude_g_mm`, `angle_deg`.
    """

    per_cent: float | None
    quantities: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class BaselineValues:
    """Values of a machine in its baseline. quantities: mean by name, logarithms or SI; amplitudes: by channel [m]."""

    quantities: Mapping[str, float]
    amplitudes: Mapping[str, float]


@dataclass(frozen=True)
class FindingKind:
    """Declaration of one kind of finding. Raises ValueError where a part is missing.

    kind: its name. elements: kinds of elements at which it can lie. place: what is at fault: the machine's coefficients and
    forces, the measuring channels, or the data and their model. changes: gives the changes that it can make, one hypothesis
    each. data_fault: finds it in the phasors of the baseline and of a window of runs. fit_fault: finds it in the fits of a
    window, beside the channels that the diagnosis calls faulty. size: how large a cause is; needed beside `changes`. form:
    which form of it the data tell. linear: whether it enters the response linearly, so that it explains what it causes
    exactly.
    """

    kind: str
    elements: tuple[ElementKind, ...]
    place: Place
    changes: Callable[[ChangeColumns], Iterator[ExpectedChange]] | None = None
    data_fault: Callable[[Sequence[Observation], Sequence[Observation]], Iterator[DataFault]] | None = None
    fit_fault: Callable[[Sequence[Observation], frozenset[str]], Iterator[DataFault]] | None = None
    size: Callable[[Cause, BaselineValues], ChangeSize] | None = None
    form: Callable[[Cause], str | None] | None = None
    linear: bool = False

    def __post_init__(self) -> None:
        if not self.elements:
            raise ValueError(f"finding kind '{self.kind}' names no kinds of elements at which it can lie")
        if self.changes is None and self.data_fault is None and self.fit_fault is None:
            raise ValueError(f"finding kind '{self.kind}' has no changes, data_fault or fit_fault: nothing would ever find it")
        if self.changes is not None and self.size is None:
            raise ValueError(f"finding kind '{self.kind}' has changes and no size: nobody could say how large they are")

    def require_element(self, element: str) -> None:
        """Raise ValueError for an element at which the finding cannot lie."""
        if element.split(".", 1)[0] not in self.elements:
            raise ValueError(f"finding kind '{self.kind}' is declared for {', '.join(self.elements)}, not for '{element}'")
