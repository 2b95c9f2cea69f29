"""One line of the report: what is measured, what was asked and what came."""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class ReportLine:
    """One line: what is measured, what was asked and what came.

    Attributes:
        what: What is measured; indented where it belongs to the line before.
        asked: What was asked, empty where nothing was.
        measured: What came.
        kept: Whether that is what was asked.
        coverage: By kind of quantity the part of the intervals that hold the truth, where the line is their mean [-].
    """

    what: str
    asked: str
    measured: str
    kept: bool
    coverage: Mapping[str, float] = field(default_factory=dict)

    def __str__(self) -> str:
        return f"  {self.what:<76}{self.asked:>12}{self.measured:>24}{'' if self.kept else '   SHORT'}"
