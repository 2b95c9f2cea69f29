"""Result of an identification: estimates by name, as a table, as text that fits a screen, and as plots."""

import cmath
import math
from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import Struct

from estimator.calibration.unbalance_since import UnbalanceSince, unbalance_since
from estimator.close_matches import did_you_mean
from estimator.errors import Invalid
from estimator.fit.estimates import Estimate
from estimator.fit.identification import Identification
from estimator.machine.checks.document_warnings import document_warnings
from estimator.machine.document import Machine
from estimator.phasors.measurement import joined
from estimator.phasors.quality import Quality
from estimator.units import rpm_to_rad_per_s
from rotorundown.environment.notebook_text import notebook_text
from rotorundown.environment.optional_packages import optional_package
from rotorundown.runs import MachineRun
from rotorundown.summaries.estimate_summary import REFUSED_VALUES, element_lines, sample_words, within_screen

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from estimator.identification.experiment_design import HelpfulProbe, HelpfulSpeed
    from rotorundown.machine_model import Model

CANDIDATE_SPEEDS = 60
"""Number of speeds of which the most helpful are chosen."""
ALL_PARAMETERS = "All parameters: to_frame(); one of them: result['NAME']"
COLUMNS = ("element", "quantity", "value", "standard_error", "lower", "upper", "imaginary", "imaginary_standard_error", "unit")
"""Columns of a table of estimates, beside `reason`."""


OF_VECTORS = ("magnitude", "angle_deg")
"""Columns that vectors have besides."""


class NotIdentified(Invalid):
    """Raised for something that is no result of an identification where one is needed."""


def require_result(given: object, what: str) -> None:
    """Require a result of `identify`. what: names what is given, for the error. Raises NotIdentified."""
    if not isinstance(given, Result):
        raise NotIdentified(f"{what} is a {type(given).__name__}: identify first, with identify(machine, runs)")


class NotAccepted(Invalid):
    """Raised for what would follow from a fit that is not accepted."""


class UnknownName(KeyError):
    """Raised for a name that the result does not have; the message suggests names like it."""

    def __str__(self) -> str:
        return str(self.args[0])


class Result(Struct, frozen=True, eq=False, dict=True):
    """Identification of a machine from its runs.

    Attributes:
        machine: The machine.
        runs: The runs that were fitted together.
        identification: The fit: estimates, covariance, χ².
        qualities: Quality of each run.
    """

    machine: Machine
    runs: tuple[MachineRun, ...]
    identification: Identification
    qualities: tuple[Quality, ...]

    @property
    def accepted(self) -> bool:
        """Return whether the fit passed its tests; the estimates of one that did not are not to be used."""
        return self.identification.accepted

    @property
    def verdict(self) -> str:
        """Return the verdict in words."""
        return self.identification.verdict

    @cached_property
    def model(self) -> "Model":
        """Return the model of the machine with the values found and their covariance. Raises NotAccepted."""
        from estimator.updated_model.model import updated_model
        from rotorundown.machine_model import Model

        if not self.accepted:
            raise NotAccepted(f"{self.machine.id}: nothing follows from a fit that is not accepted: {self.verdict}")
        return Model(updated_model(self.machine, self.identification))

    @cached_property
    def unbalance_gained(self) -> UnbalanceSince | None:
        """Return the unbalance gained since the machine's calibration, with its covariance; None of one not calibrated."""
        return unbalance_since(self.machine, self.identification)

    def __getitem__(self, name: str) -> Estimate:
        """Return the estimate of a name such as `coupling.C1.kxx`. Raises UnknownName with close matches."""
        known = list(self)
        for one in self.identification.estimates:
            if one.name == name:
                return one
        close = did_you_mean(str(name), known)
        raise UnknownName(f"'{name}' is not estimated{close or f'; list(result) has all names, such as {known[0]}'}")

    def __iter__(self) -> Iterator[str]:
        return (one.name for one in self.identification.estimates)

    def __len__(self) -> int:
        return len(self.identification.estimates)

    def __contains__(self, name: object) -> bool:
        return any(one == name for one in self)

    def helpful_speeds(self, *, count: int = 3) -> "tuple[HelpfulSpeed, ...]":
        """Return the speeds of the machine's range at which one more sample each would help most, with the effect."""
        from estimator.identification.experiment_design import helpful_speeds

        limits = self.machine.speed_range
        lowest, highest = rpm_to_rad_per_s(limits.minimum_rpm), rpm_to_rad_per_s(limits.maximum_rpm)
        candidates = np.linspace(lowest, highest, CANDIDATE_SPEEDS)
        return helpful_speeds(self.machine, self.identification, candidates=candidates, count=count)

    def helpful_probes(self, *, count: int = 3) -> "tuple[HelpfulProbe, ...]":
        """Return the probes that would have helped most in the same runs, with the effect."""
        from estimator.identification.experiment_design import helpful_probes

        measured = joined([run.measurement for run in self.runs])
        return helpful_probes(self.machine, self.identification, measured, count=count)

    def to_frame(self) -> Any:
        """Return a pandas DataFrame with a row per parameter, in SI units.

        Of a vector, such as an unbalance, `value` and `imaginary` are its parts; `lower` and `upper` bound its `magnitude`,
        which lies at `angle_deg` from the keyphasor mark. `attrs["accepted"]` of the frame says whether they are to be used.
        Raises PackageMissing without pandas.
        """
        pandas = optional_package("pandas", needed_for="data frames")
        rows = [_row(one) for one in self.identification.estimates]
        names = pandas.Index(list(self), name="parameter")
        frame = pandas.DataFrame(rows, index=names, columns=[*COLUMNS, *OF_VECTORS, "reason"])
        frame.attrs["accepted"] = self.accepted
        return frame

    def plot_bode(self, channels: list[str] | str | None = None) -> "Figure":
        """Plot measured and fitted 1× amplitude and phase of some channels over speed, with the fit's 95 % band."""
        from rotorundown.plots.bode import bode

        return bode(self, channels)

    def plot_polar(self, channels: list[str] | str | None = None) -> "Figure":
        """Plot measured and fitted 1× vectors of some channels in the polar plane, with speeds at some points."""
        from rotorundown.plots.polar import polar

        return polar(self, channels)

    def plot_train(self) -> "Figure":
        """Plot the train to scale, from driver to driven."""
        from rotorundown.plots.train import train

        return train(self.machine)

    def plot_campbell(self) -> "Figure":
        """Plot the Campbell diagram of the updated model. Raises NotAccepted."""
        return self.model.plot_campbell()

    def plot_orbit(self, speed_rpm: float) -> "Figure":
        """Plot the fitted 1× orbits at all stations with two probes, at one speed [r/min]."""
        from rotorundown.plots.orbit import orbits

        return orbits(self, speed_rpm)

    def plot_centreline(self) -> "Figure":
        """Plot where each journal stands in its clearance over speed; for bearings described by their film.

        Raises NotAccepted.
        """
        from rotorundown.plots.centreline import centreline

        return centreline(self.model.updated)

    def __str__(self) -> str:
        found = self.identification
        head = found.verdict if found.accepted else f"NOT ACCEPTED, not to be used: {found.verdict}"
        size = f"{sample_words(found, self.machine)}, {len(self)} parameters"
        findings = [
            f"{run.name}: {words}"
            for run, quality in zip(self.runs, self.qualities, strict=True)
            for words in quality.findings
        ]
        heading, doubts = [], []
        if not found.accepted:
            heading, doubts = [REFUSED_VALUES], [f"document: {one}" for one in document_warnings(self.machine)]
        told = [within_screen(line) for line in (f"{self.machine.id}: {head}", size, *findings, *doubts)]
        return "\n".join([*told, "", *heading, *element_lines(found.estimates), "", ALL_PARAMETERS])

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return the text for a notebook; names come from documents, so everything is escaped."""
        return notebook_text(self)


def _row(one: Estimate) -> list[Any]:
    known = [getattr(one, column) for column in COLUMNS]
    if one.value is None or one.imaginary is None:
        return [*known, None, None, one.reason]
    vector = complex(one.value, one.imaginary)
    return [*known, abs(vector), math.degrees(cmath.phase(vector)) % 360.0, one.reason]
