"""Status of one channel's value in one sample."""

from enum import IntEnum


class ChannelStatus(IntEnum):
    """Status of a value; stored as this number and written as its name in lower case; only a good value enters a fit."""

    GOOD = 0
    NOT_AVAILABLE = 1
    BAD = 2
    OUT_OF_RANGE = 3

    @property
    def label(self) -> str:
        """Return the name used on the wire and in answers."""
        return self.name.lower()
