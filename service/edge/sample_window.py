"""The window of waveform samples from which blocks are computed."""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats


@dataclass(frozen=True)
class Chunk:
    """Consecutive samples of the keyphasor and the channels.

    first: number of the first one in its input. values: (1 + C, N), the keyphasor's first. sampling_rate: [Hz]. Sample
    `anchor` was taken at `anchor_ns` [ns, UTC]. follows: whether it continues the chunk before, provided that the numbers do.
    """

    first: int
    values: Floats
    sampling_rate: float
    anchor: int
    anchor_ns: int
    follows: bool = True


class SampleWindow:
    """Consecutive samples, numbered as in their input."""

    def __init__(self, chunk: Chunk) -> None:
        self.first = chunk.first
        self.values: Floats = np.ascontiguousarray(chunk.values)

    @property
    def end(self) -> int:
        """Return the number of the sample behind the last one."""
        return self.first + int(self.values.shape[1])

    def append(self, chunk: Chunk) -> None:
        """Append the samples that follow."""
        self.values = np.concatenate([self.values, np.ascontiguousarray(chunk.values)], axis=1)

    def since(self, number: int) -> Floats:
        """Return the samples from a number on, (1 + C, N)."""
        return self.values[:, number - self.first :]

    def drop_before(self, number: int) -> None:
        """Drop the samples before a number."""
        if number > self.first:
            self.values, self.first = self.since(number).copy(), number
