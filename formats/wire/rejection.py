"""Reasons for rejecting input; the quarantine, the metrics and the documentation share their names."""

from typing import Literal

from msgspec import Struct

Reason = Literal[
    "too_large",
    "bad_frame",
    "undecodable",
    "future_schema",
    "key_mismatch",
    "retained",
    "unknown_machine",
    "unknown_channel",
    "unknown_condition",
    "wrong_unit",
    "wrong_shape",
    "not_finite",
    "speed_out_of_range",
    "speed_out_of_order",
    "amplitude_out_of_range",
    "gap_out_of_range",
    "gap_undescribed",
    "overall_out_of_range",
    "sequence_out_of_range",
    "time_out_of_range",
    "time_out_of_order",
]
"""Reason for rejecting a message, a sample or a channel's value."""

InternalErrorReason = Literal["unexpected_error", "damaged_block"]
"""Reason why valid input is missing: an error of the service, or of the storage of its data."""


class Rejected(ValueError):
    """A message or a sample is rejected."""

    def __init__(self, reason: Reason, detail: str) -> None:
        super().__init__(detail)
        self.reason = reason
        self.detail = detail


class Fault(Struct, frozen=True):
    """A sample, or one channel of it, that is rejected: its index in the batch and the reason."""

    index: int
    reason: Reason
    detail: str

    def of_row(self, *, kept: bool) -> str:
        """Return the words on the row of a table that it was. kept: whether the rest of the row is taken."""
        return f"row {self.index + 1} left out{' in part' if kept else ''}: {self.detail}"
