"""Protocols of the run and the result that plots are drawn from."""

from collections.abc import Sequence
from typing import Protocol

from estimator.arrays import Floats
from estimator.fit.estimates import Estimate
from estimator.fit.identification import Identification
from estimator.machine.document import Machine


class PlottedRun(Protocol):
    """A run in the units of plots, S samples of m channels."""

    @property
    def name(self) -> str:
        """Return the name of the run."""

    @property
    def speed_rpm(self) -> Floats:
        """Return the speeds (S,) [r/min]."""

    @property
    def amplitude_um_pp(self) -> Floats:
        """Return the amplitudes (S, m) [µm pp]."""

    @property
    def phase_lag_deg(self) -> Floats:
        """Return the phase lags (S, m) [°]."""


class PlottedResult(Protocol):
    """A machine's identification with the runs that it was made from."""

    @property
    def machine(self) -> Machine:
        """Return the machine."""

    @property
    def runs(self) -> Sequence[PlottedRun]:
        """Return the runs."""

    @property
    def identification(self) -> Identification:
        """Return the fit."""

    @property
    def accepted(self) -> bool:
        """Return whether the fit passed its tests."""

    def __getitem__(self, name: str, /) -> Estimate:
        """Return the estimate of a name."""
