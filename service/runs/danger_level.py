"""Level of the newest vibration where it is beyond the danger limit of the machine's document."""

from dataclasses import asdict, dataclass
from typing import Any, Self

import numpy as np

from estimator.machine.document import Machine
from storage.encoding.sample_blocks import Samples


@dataclass(frozen=True)
class DangerLevel:
    """The largest 1× of a sample, as measured, and the limit that it exceeds, both 0-to-peak [m]."""

    channel: str
    amplitude: float
    limit: float

    @classmethod
    def of_newest(cls, machine: Machine, samples: Samples) -> Self | None:
        """Return the level of the newest of some samples; None where none of its good phasors exceeds the limit."""
        limit = machine.operation.vibration_danger
        if limit is None:
            return None
        amplitude = np.where(samples.usable[-1], np.abs(samples.phasor[-1]), 0.0)
        place = int(np.argmax(amplitude))
        return cls(machine.channels[place], float(amplitude[place]), limit) if amplitude[place] > limit else None

    @classmethod
    def restored(cls, stored: dict[str, Any] | None) -> Self | None:
        """Return the level from the data that `stored` gave."""
        return None if stored is None else cls(**stored)

    def stored(self) -> dict[str, Any]:
        """Return the level as plain data."""
        return asdict(self)
