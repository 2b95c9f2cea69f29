"""The context from which a machine's newest runs are assessed, and the assessment that `assess.py` makes of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from estimator.diagnosis.observation import ObservedFit
from estimator.machine.document import Machine
from estimator.machine.rules import Condition
from estimator.trends.parameter_vector import Point
from service.alerts.lifecycle import Severity
from service.monitoring.rules.limits import Limits

if TYPE_CHECKING:
    from estimator.diagnosis.change_progress import ChangeProgress
    from estimator.diagnosis.finding_kind import Cause, ChangeSize
    from service.monitoring.assessment.rate_of_change import RateFinding

WEEK = 7 * 86_400 * 1_000_000_000
"""One week [ns]."""
MeanConditions = Mapping[str, float | None]
"""Mean of each operating condition over a run by name; None for one that was not measured."""


@dataclass(frozen=True)
class AssessedRun:
    """An identification of one run. fit: its result; measured_at: [ns]."""

    id: int
    measured_at: int
    conditions: MeanConditions
    fit: ObservedFit


@dataclass(frozen=True)
class BaselineHistory:
    """Runs after a baseline, oldest first. times: [weeks since 1970]. conditions: operating conditions of the machine, that
    parameters may follow.

    baseline, after: the parameters that each run determined, and its operating conditions.
    """

    conditions: Sequence[Condition]
    baseline: Sequence[tuple[Point, MeanConditions]]
    times: Sequence[float]
    after: Sequence[tuple[Point, MeanConditions]]


@dataclass(frozen=True)
class ComparedRuns:
    """The parameters that the baseline's runs and the newest run determined, with their operating conditions."""

    baseline: Sequence[tuple[Point, MeanConditions]]
    newest: tuple[Point, MeanConditions]


@dataclass(frozen=True)
class ComparedValue:
    """A derived quantity of the newest run and of its baseline, such as `coupling.C1.misalignment_force`.

    unit: SI unit. newest: value of the newest run. baseline: value of each run of the baseline, with the half width of its
    95 % interval.
    """

    name: str
    element: str
    unit: str
    newest: float
    baseline: Sequence[tuple[float, float | None]]


@dataclass(frozen=True)
class AssessmentBasis:
    """The settings that a person may change during an assessment: the baseline and the limits in force, by number."""

    baseline_id: int | None
    limits_version: int | None


@dataclass(frozen=True)
class StoredNumbers:
    """Numbers of an identification that are stored beside its fit, and told with its diagnosis.

    forces: those that findings have as their force, by name, such as `coupling.C1.misalignment_force` [N]; None where one has
    no value. not_estimable: parameters that it does not determine.
    """

    forces: Mapping[str, float | None]
    not_estimable: tuple[str, ...]


@dataclass(frozen=True)
class AssessmentContext:
    """The complete input of an assessment of a machine.

    baseline, after: oldest first; without a baseline nothing is diagnosed. open_causes: kind and element of the machine's open
    alerts of a diagnosis. history: None when rates of change are not assessed; open_rates: severity of the open alerts of that
    rule by element. compared: comparison of the newest run, None where it was not accepted. loads: those in its couplings.
    second_orders: amplitudes of the 2× near running speed, of the probes that measure it. numbers: those of the newest run.
    open_steps: when the step of an alignment began that an open alert reports [ns], by element.
    """

    machine: Machine
    limits: Limits
    basis: AssessmentBasis
    baseline: tuple[AssessedRun, ...]
    after: tuple[AssessedRun, ...]
    open_causes: tuple[tuple[str, str], ...]
    history: BaselineHistory | None
    open_rates: Mapping[str, Severity]
    compared: ComparedRuns | None = None
    loads: tuple[ComparedValue, ...] = ()
    second_orders: tuple[ComparedValue, ...] = ()
    numbers: StoredNumbers = StoredNumbers({}, ())
    open_steps: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class MovedParameter:
    """Deviation of a parameter of the newest run from the baseline, as the table of deviations has it.

    change: in its unit; of a vector its length. per_cent, lower_per_cent, upper_per_cent: see `ParameterDeviation`.
    """

    parameter: str
    element: str
    change: float
    unit: str | None
    per_cent: float
    lower_per_cent: float
    upper_per_cent: float
    sigma: float


@dataclass(frozen=True)
class SecondOrderGrowth:
    """Growth of the 2× at a probe beside a coupling, and at none elsewhere.

    before: in the baseline; now: in the newest run [m]. decided: whether it has decided between two explanations that are
    about as good as each other.
    """

    probe: str
    before: float
    now: float
    decided: bool = False


@dataclass(frozen=True)
class DiagnosedCause:
    """A cause, its runners-up as an explanation, its size, form and progress.

    began_at, began: time [ns] and identification of the run with which it most probably began. second_order: where a growth of
    the 2× speaks for it.
    """

    cause: "Cause"
    runners_up: tuple["Cause", ...]
    size: "ChangeSize"
    form: str | None
    progress: "ChangeProgress"
    began_at: int
    began: int
    second_order: SecondOrderGrowth | None = None


@dataclass(frozen=True)
class MachineDiagnosis:
    """Causes of a machine's change from its baseline.

    baseline: ids of the identifications that form it. gone: the context's `open_causes` that have gone. moved: all parameters
    that the newest run and the baseline determine.
    """

    baseline: tuple[int, ...]
    causes: tuple[DiagnosedCause, ...]
    gone: frozenset[tuple[str, str]]
    moved: tuple[MovedParameter, ...] = ()


@dataclass(frozen=True)
class RateAssessment:
    """Parameters that change too fast. gone: elements of the context's `open_rates` that no longer do."""

    findings: tuple["RateFinding", ...]
    gone: frozenset[str]


@dataclass(frozen=True)
class Assessment:
    """The assessment of a machine. diagnosis, rates: None when none can be made. left_out: errors of measuring chains and
    couplings that the diagnosis has named and that the newest run's estimates on oil films do not allow for."""

    diagnosis: MachineDiagnosis | None
    rates: RateAssessment | None
    left_out: frozenset[str] = frozenset()
