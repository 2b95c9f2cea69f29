"""Types of the fields that people write in documents, in SI units, and the base of a document's parts."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Never

from pydantic import ConfigDict, Field, GetCoreSchemaHandler
from pydantic_core import CoreSchema

from estimator.errors import Invalid
from estimator.strict_model import StrictModel


class Within:
    """Bounds of a finite number. The library would apply each bound by itself, for several hundred fields at every start.

    Attributes:
        usual: Least and largest usual value, in the field's unit; None where nothing is declared.
    """

    def __init__(self, *, usual: tuple[float, float] | None = None, **bounds: float) -> None:
        self.usual = usual
        self._schema: Any = {"type": "float", **bounds, "allow_inf_nan": False}

    def __get_pydantic_core_schema__(self, _source: Any, _handler: GetCoreSchemaHandler) -> CoreSchema:
        """Return what pydantic makes of a float with these bounds."""
        return dict(self._schema)  # one for each field: pydantic adds to it


Identifier = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,64}$", description="letters, digits, '_' and '-', up to 64")]
Text = Annotated[str, Field(pattern=r"^[^\x00]*$")]
"""A text that every store takes."""
# Bounds far beyond any machine: they catch slips of the pen before they become numbers that no arithmetic survives.
Positive = Annotated[float, Within(gt=0, lt=1e15)]
Direct = Annotated[float, Within(gt=1e-30, lt=1e15)]
Stiffness = Annotated[float, Within(gt=1e-30, lt=1e15, usual=(1e5, 1e10))]
"""Direct stiffness [N/m]."""
NotNegative = Annotated[float, Within(ge=0, lt=1e15)]
Real = Annotated[float, Within(gt=-1e15, lt=1e15)]
Length = Annotated[float, Within(gt=1e-6, lt=100)]
Angle = Annotated[float, Within(ge=-3600, le=3600)]
Spread = Annotated[float, Within(ge=0, lt=0.5, usual=(0.01, 0.3))]
VibrationLimit = Annotated[float, Within(gt=0, lt=1e15, usual=(1e-6, 1e-3))]
"""Amplitude of a vibration that is a limit [m]."""
SmallLength = Annotated[float, Within(ge=0, lt=1e15, usual=(1e-9, 5e-5))]
"""Run-out or error of a probe, rms; 0 for none [m]."""
ElevationSpread = Annotated[float, Within(ge=0, le=0.01, usual=(1e-5, 1e-3))]
"""Standard deviation of a bearing's centre from its elevation [m]."""

PATTERNS: Mapping[str, str] = {
    r"^[A-Za-z0-9_-]{1,64}$": "an id has 1 to 64 letters, digits, '_' and '-'",
    r"^[^\x00]*$": "a text has no NUL in it",
}
"""Words for the patterns of identifiers and texts: errors show no regular expressions."""


class PartUnchangeable(Invalid, AttributeError):
    """Raised when somebody sets or deletes a field of a part; the message says how a changed document is made."""

    def __init__(self, part: str, name: str) -> None:
        super().__init__(
            f"{name}: {part} stays as it was read; change what the machine's model_dump() returns, and read that with "
            "read_machine(…)"
        )


class Part(StrictModel):
    """A part of a document, which nothing changes once it is read."""

    # Parts are built within the document; by themselves only where somebody makes one.
    model_config = ConfigDict(frozen=True, defer_build=True)

    if not TYPE_CHECKING:  # type checkers refuse it by `frozen`

        def __setattr__(self, name: str, value: Any) -> Never:
            raise PartUnchangeable(type(self).__name__, name)

        def __delattr__(self, name: str) -> Never:
            raise PartUnchangeable(type(self).__name__, name)
