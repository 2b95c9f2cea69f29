"""The task and the outcome of an identification, as they travel between the service and a worker process.

They are pickled: a change of them, or of this module's name, requires a new `service.workers.dask_task.TASK_FORM`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from estimator.fit.identification import Identification, Options
from estimator.machine.rules import QualityRules
from estimator.phasors.quality import Quality
from estimator.phasors.slow_roll import SlowRoll
from estimator.updated_model.derived_quantities import Derived


@dataclass(frozen=True)
class IdentificationTask:
    """One identification: the machine's document, its runs' sample blocks, the fit's options and its time limit [s].

    rules: which samples may be left out. earlier: name and block of a run that a single run is compared with. slow_roll:
    vectors that are subtracted before the fit. beginning: id and `point` of a comparable earlier identification to start from.
    steady: the samples are dwells at constant speed, through which no sweep has gone whatever their times say.
    """

    document: dict[str, Any]
    runs: Sequence[bytes]
    options: Options
    timeout_s: float
    rules: QualityRules | None = None
    earlier: tuple[str, bytes] | None = None
    slow_roll: SlowRoll | None = None
    beginning: tuple[int, bytes] | None = None
    steady: bool = False


@dataclass(frozen=True)
class IdentificationOutcome:
    """Result of an identification task.

    qualities: qualities of the runs, in the task's order. identification: None when the data do not allow one, for `error`.
    derived: quantities derived from an accepted identification; underived: why there are none after all. conditions: mean of
    each operating condition over the runs by name, None where it was not measured. beginning: id of the identification from
    which the fit started, if any. crossed: per run the critical speeds of the document's model that it crossed [r/min].
    load_balance: version of the balance of loads on oil films by which the worker computed, see `load_balance`.
    """

    qualities: tuple[Quality, ...]
    identification: Identification | None
    error: str | None = None
    derived: tuple[Derived, ...] = ()
    underived: str | None = None
    conditions: dict[str, float | None] = field(default_factory=dict)
    beginning: int | None = None
    crossed: tuple[list[float], ...] = ()
    load_balance: int | None = None
