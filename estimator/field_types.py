"""Types of the fields that people write in documents, in SI units, and the base of a document's parts."""

from typing import Annotated

from pydantic import ConfigDict, Field

from estimator.strict_model import StrictModel

Identifier = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,64}$", description="letters, digits, '_' and '-', up to 64")]
Text = Annotated[str, Field(pattern=r"^[^\x00]*$")]
"""A text that every store takes."""
# Bounds far beyond any machine: they catch slips of the pen before they become numbers that no arithmetic survives.
Positive = Annotated[float, Field(gt=0, lt=1e15, allow_inf_nan=False)]
Direct = Annotated[float, Field(gt=1e-30, lt=1e15, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, lt=1e15, allow_inf_nan=False)]
Real = Annotated[float, Field(gt=-1e15, lt=1e15, allow_inf_nan=False)]
Length = Annotated[float, Field(gt=1e-6, lt=100, allow_inf_nan=False)]
Angle = Annotated[float, Field(ge=-3600, le=3600, allow_inf_nan=False)]
Spread = Annotated[float, Field(ge=0, lt=0.5, allow_inf_nan=False)]


class Part(StrictModel):
    """A part of a document, which nothing changes once it is read."""

    # Parts are built within the document; by themselves only where somebody makes one.
    model_config = ConfigDict(frozen=True, defer_build=True)
