"""Identifies a machine from its runs, behind the same quality gate as the commands and the service."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, cast

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from estimator.errors import Invalid
from estimator.identification.convention_trials import with_named_conventions
from estimator.identification.quality_gate import GatedIdentification, identify_gated
from estimator.machine.document import Machine
from estimator.machine.rules import QualityRules
from estimator.strict_model import own_words
from rotorundown.copied_runs import copied_run, copy_words
from rotorundown.environment.blas_threads import one_blas_thread
from rotorundown.machine_files import checked_machine
from rotorundown.result import Result
from rotorundown.runs import MachineRun, other_channels


class NothingToIdentify(Invalid):
    """Raised when the runs do not allow an identification; the message says why."""


def identify(
    machine: Machine,
    runs: MachineRun | Sequence[MachineRun],
    *,
    gate: bool = True,
    half_power: bool | None = None,
    accepted_rpm: tuple[float, float] | None = None,
) -> Result:
    """Identify stiffness and damping of bearings and couplings, and the unbalance of discs, from one run or several together.

    Args:
        machine: The machine.
        runs: The run, or several that are fitted together.
        gate: Whether points of bad quality are left out.
        half_power: Whether what lies within half-power points is left out (thesis §2.3); None for the document's rule.
        accepted_rpm: The only speeds that count [r/min]; None for the document's rule.

    Returns:
        The result. A fit that is not accepted is returned too, and says so: look at `accepted` before using it.

    Raises:
        WrongMachine: The machine is a copy that contradicts itself.
        NothingToIdentify: The usable points do not allow an identification, or a rule is wrong.
        ValueError: No start leads anywhere, or the train cannot be condensed at a speed.
    """
    one = not isinstance(runs, Sequence | Iterator)  # a run, or a data frame that was not read as one
    several = [cast(MachineRun, runs)] if one else list(cast(Sequence[MachineRun], runs))
    found = identify_behind_gate(machine, several, gate=gate, half_power=half_power, accepted_rpm=accepted_rpm)
    if found.identification is None:
        raise NothingToIdentify(found.error or "there is nothing to identify from")
    return Result(machine, tuple(several), found.identification, found.qualities)


def _require_read(machine: Machine, runs: Sequence[MachineRun]) -> None:
    """Raise NothingToIdentify for what is no machine or no run of it: files and tables have to be read first."""
    if isinstance(machine, MachineRun):
        raise NothingToIdentify("the run stands in the machine's place: the machine comes first, identify(machine, run)")
    if not isinstance(machine, Machine):
        raise NothingToIdentify(f"the machine is a {type(machine).__name__}: read it first, with read_machine(…)")
    checked_machine(machine)
    if not runs:
        raise NothingToIdentify("no run is given: identify needs one at least")
    for run in runs:
        if not isinstance(run, MachineRun):
            raise NothingToIdentify(f"a run is a {type(run).__name__}: read it first, with read_run(…, machine=…)")
        if other := other_channels(run, machine):
            raise NothingToIdentify(other)
    if copied := copied_run(runs):
        raise NothingToIdentify(copy_words(copied))


def _rule_words(item: ErrorDetails, given: Mapping[str, Any]) -> str:
    """Return what is wrong with a rule, with its name and value where pydantic's words name neither."""
    words = own_words(item["msg"])
    name = str(item["loc"][0]) if item["loc"] else ""
    if name == "accepted_rpm":
        words = "give the lowest and the highest speed that count [r/min], such as (300, 3000)"
    return words if not name or words.startswith(name) else f"{name} is {given.get(name)!r}: {words}"


def identify_behind_gate(
    machine: Machine,
    runs: Sequence[MachineRun],
    *,
    gate: bool = True,
    half_power: bool | None = None,
    accepted_rpm: tuple[float, float] | None = None,
) -> GatedIdentification:
    """Judge runs and identify the machine; a lack of usable points is not raised but said in the outcome.

    Args:
        machine: The machine.
        runs: The runs, fitted together.
        gate: Whether points of bad quality are left out.
        half_power: Whether what lies within half-power points is left out; None for the document's rule.
        accepted_rpm: The only speeds that count [r/min]; None for the document's rule.

    Returns:
        Qualities and identification.

    Raises:
        WrongMachine: The machine is a copy that contradicts itself.
        NothingToIdentify: No run is given, or a rule is wrong.
        ValueError: No start leads anywhere, or the train cannot be condensed at a speed.
    """
    _require_read(machine, runs)
    rules = {"half_power": half_power, "accepted_rpm": accepted_rpm}
    given = {name: value for name, value in rules.items() if value is not None}
    try:
        wanted = QualityRules.model_validate(machine.quality.model_dump() | given)
    except ValidationError as error:
        raise NothingToIdentify("\n".join(dict.fromkeys(_rule_words(item, given) for item in error.errors()))) from None
    with one_blas_thread():
        recorded, measured = [run.recorded for run in runs], [run.measurement for run in runs]
        gated = identify_gated(machine, recorded, measured, rules=wanted, gate=gate)
        names = [run.name for run in runs] if len(runs) > 1 else []
        return with_named_conventions(machine, recorded, measured, gated, rules=wanted, gate=gate, names=names).gated
