"""Levels at which a finding becomes an alert or a danger, and the delays of its alerts.

A level is reached when the change is as certain as its `sigma` and as large as any of the sizes that it names.
"""

from collections.abc import Mapping
from typing import Annotated, Literal, Self, get_args

from pydantic import ConfigDict, Field, model_validator

from estimator.strict_model import StrictModel

LimitQuantity = Literal["sigma", "per_cent", "force", "rate_per_cent_per_week", "tolerance_per_cent", "beyond_tolerance"]
QUANTITIES: tuple[LimitQuantity, ...] = get_args(LimitQuantity)
"""Quantities that a level can name."""
SIZES = ("per_cent", "force", "rate_per_cent_per_week", "tolerance_per_cent", "beyond_tolerance")
"""Quantities of a level that are alternatives; `sigma` is required in addition."""
LONGEST_DELAY = 20
"""Largest delay of a rule, in identifications in a row."""

Limit = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class Level(StrictModel):
    """Limits from which a finding is an alert or a danger; null fields are not checked."""

    model_config = ConfigDict(frozen=True)

    sigma: Annotated[Limit, Field(le=100)] | None = Field(
        default=None, description="how certain the change must be, in standard deviations; needed beside any size"
    )
    per_cent: Annotated[Limit, Field(le=10_000)] | None = Field(
        default=None, description="size of the change against the baseline [%]"
    )
    force: Annotated[Limit, Field(le=1e9)] | None = Field(
        default=None, description="misalignment only: force in the coupling at running speed, 0-to-peak [N]"
    )
    rate_per_cent_per_week: Annotated[Limit, Field(le=10_000)] | None = Field(
        default=None, description="rate_of_change only: how fast a parameter drifts [%/week]"
    )
    tolerance_per_cent: Annotated[Limit, Field(le=10_000)] | None = Field(
        default=None, description="on oil films: size of the change against what is allowed at the coupling [%]"
    )
    beyond_tolerance: Annotated[Limit, Field(lt=1)] | None = Field(
        default=None, description="on oil films: probability that the change is larger than what is allowed [-]"
    )

    @property
    def named(self) -> tuple[str, ...]:
        """Return the quantities that have a limit."""
        return tuple(name for name in type(self).model_fields if getattr(self, name) is not None)

    def reached(self, found: Mapping[str, float | None], *, sigma: float | None, part: float) -> bool:
        """Return whether the quantities found reach `part` of these limits. sigma: replaces this level's."""

        def reaches(name: str, limit: float | None) -> bool:
            value = found[name]
            return limit is not None and value is not None and abs(value) >= part * limit

        certain = sigma is None or reaches("sigma", sigma)
        sizes = [name for name in SIZES if getattr(self, name) is not None]
        return certain and (not sizes or any(reaches(name, getattr(self, name)) for name in sizes))


class Rule(StrictModel):
    """Levels of one kind of finding, and how patient its alerts are. Delays count identifications of the same kind of run."""

    # A rule of a machine is completed from the defaults, so that none of its fields is required.
    model_config = ConfigDict(frozen=True, json_schema_extra=lambda schema: schema.pop("required", None))

    alert: Level = Field(description="needed in a rule of a single element; else by default as in the defaults")
    danger: Level | None = Field(default=None, description="null: it never becomes a danger")
    on_delay: int = Field(default=2, ge=1, le=LONGEST_DELAY, description="identifications in a row that must show it")
    off_delay: int = Field(
        default=2, ge=1, le=LONGEST_DELAY, description="identifications in a row that must no longer show it"
    )
    hysteresis: float = Field(
        default=0.2, ge=0, le=0.9, description="part of a limit by which a value must fall below it before the level is left"
    )
    latching: bool = Field(default=False, description="whether a person must reset the alert when its cause is gone")

    @model_validator(mode="after")
    def _levels(self) -> Self:
        for name, level in (("alert", self.alert), ("danger", self.danger)):
            if level is not None and not level.named:
                raise ValueError(f"{name} names no limit: one of {', '.join(Level.model_fields)} is needed")
        if self.danger is None:
            return self
        both = [name for name in self.alert.named if name in self.danger.named]
        for name in both:
            low, high = getattr(self.alert, name), getattr(self.danger, name)
            if high < low:
                raise ValueError(f"danger.{name} {high:g} lies below alert.{name} {low:g}: it must lie above")
        if self.danger == self.alert:
            raise ValueError("danger is the same as alert: one of its limits must lie above")
        return self
