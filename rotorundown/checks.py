"""Checks a machine, and runs against it: what they hold, and what is probably a mistake. `rundown check` prints it."""

from collections.abc import Iterable

import numpy as np
from msgspec import Struct

from estimator.machine.checks.document_warnings import DocumentWarning, document_warnings
from estimator.machine.document import Machine
from estimator.machine.film_speeds import slowest_rpm
from estimator.phasors.quality import Quality, assess
from estimator.statics.whirl_in_range import instability_words
from rotorundown.environment.notebook_text import notebook_text
from rotorundown.machine_files import WrongMachine, checked_machine
from rotorundown.run_columns import WrongRun
from rotorundown.runs import MachineRun, other_channels


class CheckedRun(Struct, frozen=True, eq=False):
    """A run, and the quality of its phasors.

    Attributes:
        run: The run.
        quality: What is wrong with its phasors, and which of them a fit leaves out.
        direction: Sense in which the document says that the machine turns: 1 from +x towards +y, -1 the other way [-].
    """

    run: MachineRun
    quality: Quality
    direction: int

    @property
    def findings(self) -> tuple[str, ...]:
        """Return what is wrong with the run, or doubtful."""
        turning = float(np.sign(np.sum(self.run.measurement.direction)))
        if turning == -self.direction:
            senses = ("negative", "positive") if turning < 0.0 else ("positive", "negative")
            words = (
                f"its direction is {senses[0]}, the document's rotation {senses[1]}: one of them is wrong, or it ran backwards"
            )
            return (words, *self.quality.findings)
        return tuple(self.quality.findings)

    def __str__(self) -> str:
        found = [*self.findings, *([self.quality.words] if self.quality.words else [])]
        return "\n".join([str(self.run), *(f"{self.run.name}: {words}" for words in found)])

    __repr__ = __str__


class Checked(Struct, frozen=True, eq=False):
    """A machine that was checked, with runs of it.

    Attributes:
        machine: The machine.
        warnings: What is probably a mistake in its document; none where nothing is.
        runs: The runs with their quality.
    """

    machine: Machine
    warnings: tuple[DocumentWarning, ...]
    runs: tuple[CheckedRun, ...]

    def __str__(self) -> str:
        return "\n".join([str(self.machine), *(f"warning: {one}" for one in self.warnings), *map(str, self.runs)])

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return the text for a notebook, escaped."""
        return notebook_text(self)


def check(machine: Machine, runs: MachineRun | Iterable[MachineRun] = ()) -> Checked:
    """Check a machine, and runs against it: what they hold, and what is probably a mistake.

    A train that would whirl, or whose journals would touch, within its speed range is warned of; on oil films that takes some
    seconds.

    Args:
        machine: The machine.
        runs: One run of it, or several.

    Returns:
        The machine with its warnings, and each run with its quality.

    Raises:
        WrongMachine: Something in the machine is wrong; the message names each wrong field.
        WrongRun: Something that is given is no run, or one of another machine.
    """
    if not isinstance(machine, Machine):
        raise WrongMachine(f"the machine is a {type(machine).__name__}: read it first, with read_machine(…)")
    those = [runs] if isinstance(runs, MachineRun) or not isinstance(runs, Iterable) else list(runs)
    for one in those:
        if not isinstance(one, MachineRun):
            raise WrongRun(f"one of runs is a {type(one).__name__}: read it first, with read_run(…, machine=machine)")
        if other := other_channels(one, machine):
            raise WrongRun(other)
    checked = checked_machine(machine)
    return Checked(checked, all_warnings(checked), tuple(checked_run(checked, one) for one in those))


def all_warnings(machine: Machine) -> tuple[DocumentWarning, ...]:
    """Return the warnings of a document, and whether films would not carry or the train would whirl.

    Args:
        machine: The machine.

    Returns:
        The warnings.
    """
    warnings = document_warnings(machine)
    never_carried = slowest_rpm(machine) >= machine.speed_range.maximum_rpm  # which is warned of with its field
    unfit = "" if never_carried else instability_words(machine)
    return (*warnings, *([DocumentWarning("bearings", unfit)] if unfit else []))


def checked_run(machine: Machine, run: MachineRun) -> CheckedRun:
    """Return a run with the quality of its phasors.

    Args:
        machine: The machine.
        run: One of its runs.

    Returns:
        Both.
    """
    return CheckedRun(run, assess(run.recorded, noise=machine.noise, rules=machine.quality), machine.direction)
