"""One line of the report: what is measured, what was asked and what came."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """One line: what is measured, what was asked and what came."""

    what: str
    asked: str
    measured: str
    kept: bool

    def __str__(self) -> str:
        return f"  {self.what:<76}{self.asked:>12}{self.measured:>24}{'' if self.kept else '   SHORT'}"
