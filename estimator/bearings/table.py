"""Coefficients that follow a table over speed, as a maker calculates them, with a scale factor per direct term on request.

Tables for several loads are interpolated to the bearing's own, over the logarithm of the load.

Between the table's speeds they follow the shape-preserving cubics of Fritsch and Carlson (SIAM J. Numer. Anal. 17 (1980) 238,
doi:10.1137/0717021), which never leave the values beside them: monotone values stay monotone, positive ones positive. Beyond
its ends the table is held level.
"""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from msgspec import Struct
from pydantic import Field, field_validator, model_validator
from pydantic.config import JsonDict

from estimator.arrays import Floats
from estimator.bearings.defaults import FormDefaults, NeverLevel
from estimator.bearings.model import CoefficientModel, ModelParameter, OwnParameter
from estimator.bearings.monotone_cubic import MonotoneCubic
from estimator.bearings.table_columns import (
    COLUMNS,
    MOST_LOADS,
    MOST_SPEEDS,
    SMALLEST_STIFFNESS,
    ColumnsAtLoad,
    TableColumns,
    at_load,
    require_alike,
)
from estimator.bearings.terms import LATERAL, TERMS
from estimator.field_types import Positive, Spread
from estimator.quantities import UNITS
from estimator.units import RAD_PER_S, rpm_to_rad_per_s
from estimator.usual_values import question

FEWEST_SPEEDS = 5
"""Least number of speeds of a table."""
LEAST_COVERED = 0.5
"""Least part of a machine's highest speed at which a table in other units is taken to end, as most at its inverse [-]."""
LEAST_DAMPED = 5e-3
"""Direct damping times the speed over the stiffness below which another unit was probably meant [-]."""
WIDEST_GAP = 0.7
"""Part of a machine's speed range without a speed of the table that is warned of [-]."""

MIN_ITEMS: JsonDict = {"minItems": FEWEST_SPEEDS}
Speeds = Annotated[tuple[Positive, ...], Field(max_length=MOST_SPEEDS, fail_fast=True, json_schema_extra=MIN_ITEMS)]


def scale_name(term: str) -> str:
    """Return the last part of the name of a direct term's scale factor.

    Args:
        term: The term, such as `kxx`.

    Returns:
        The name, such as `kxx_scale`.
    """
    return f"{term}_scale"


class TableCurves(Struct, frozen=True, eq=False):
    """C coefficients of a table at S speeds, as functions of P logarithms of scale factors.

    Attributes:
        table: The table's own values (S, C) [SI].
        power: Power (C, P) with which each coefficient goes with each factor [-].
    """

    table: Floats
    power: Floats

    def values(self, fitted: Floats) -> Floats:
        """Compute the coefficients.

        Args:
            fitted: Logarithms of the factors (P,) [-].

        Returns:
            Coefficients (S, C) [SI].
        """
        return np.asarray(self.table * np.exp(self.power @ fitted))

    def derivatives(self, fitted: Floats, block: slice) -> Floats:
        """Compute the derivatives of the coefficients by the logarithms of the factors, at some of the speeds.

        Args:
            fitted: Logarithms of the factors (P,) [-].
            block: The s speeds.

        Returns:
            Derivatives (s, C, P) [SI].
        """
        return np.asarray(self.values(fitted)[block, :, None] * self.power)


class TableModel(NeverLevel, Struct, frozen=True, dict=True):
    """Coefficients of one element that follow a table.

    Each direct term has a factor of its own; a cross-coupled term goes with the geometric mean of those of the direct terms
    beside it. A direct term that is not the model's has the factor 1 for that.

    Attributes:
        coefficients: Names of the C coefficients.
        columns: Values (n,) of each over the table's speeds [SI].
        speed: Speeds of the table (n,), ascending [rad/s].
        scale_spread: Prior standard deviation of the factors' logarithms [-]; 0 for a table that is exact.
        constant: False.
    """

    law: ClassVar[str] = "a table over speed"

    coefficients: tuple[str, ...]
    columns: tuple[tuple[float, ...], ...]
    speed: tuple[float, ...]
    scale_spread: float
    constant: bool = False

    @cached_property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """Return the P factors; none of an exact table."""
        if self.scale_spread == 0.0:
            return ()
        unit, direct = UNITS["scale factor"], [name for name in self.coefficients if TERMS[_term(name)].direct]
        return tuple(
            ModelParameter(scale_name(name), "scale factor", unit, True, 1.0, 1.0, self.scale_spread) for name in direct
        )

    def at(self, speed: Floats) -> TableCurves:
        """Return the coefficients at some speeds.

        Args:
            speed: Spin speeds (S,), without sign [rad/s].

        Returns:
            Their curves.
        """
        columns = np.array(self.columns)
        found = self._interpolant(np.clip(speed, self.speed[0], self.speed[-1]))
        # Rounding must not make anything of a column that spans many decades negative.
        return TableCurves(np.clip(found, columns.min(axis=1), columns.max(axis=1)), self._power)

    @cached_property
    def _interpolant(self) -> MonotoneCubic:
        return MonotoneCubic(np.array(self.speed), np.array(self.columns).T)

    @cached_property
    def _power(self) -> Floats:
        factors = [parameter.name for parameter in self.parameters]
        power = np.zeros((len(self.coefficients), len(factors)))
        for row, name in zip(power, self.coefficients, strict=True):
            element = name.rpartition(".")[0]
            for beside in TERMS[_term(name)].beside:  # a direct term stands beside itself, twice
                factor = scale_name(f"{element}.{beside}")
                if factor in factors:
                    row[factors.index(factor)] += 0.5
        return power


TABLE_FACTORS = tuple(
    OwnParameter(scale_name(term.name), "scale factor", UNITS["scale factor"], positive=True, term=term.name)
    for term in LATERAL
    if term.direct
)
"""Factors on the direct terms of a table, which a fit may find."""


class Table(FormDefaults, TableColumns):
    """Dependence of an element's coefficients on the speed: a table, as from its maker's calculation.

    The coefficients that have a column follow it, between its speeds by shape-preserving cubics and level beyond its ends; the
    others are constant. A table for several loads has its columns in `over_load`, and `load` says at which it is taken.
    Commands that read the document from a file take `csv: FILE` in place of the columns.
    """

    own_parameters: ClassVar[tuple[OwnParameter, ...]] = TABLE_FACTORS
    load_field: ClassVar[str | None] = "load"

    form: Literal["table"] = Field(description="coefficients over speed, as its maker states them")
    speed_rpm: Speeds = Field(description="ascending, at least five [r/min]")
    over_load: tuple[ColumnsAtLoad, ...] | None = Field(
        default=None,
        max_length=MOST_LOADS,
        description="columns for several loads, ascending, in place of those above; between them shape-preserving cubics over "
        "the logarithm of the load",
    )
    load: Positive | None = Field(
        default=None, description="static load on the bearing, at which a table over the load is taken [N]"
    )
    scale_spread: Spread = Field(
        default=0.0, description="how far the table's direct terms may be off, each by a factor, relative rms [-]; 0: exact"
    )

    @model_validator(mode="before")
    @classmethod
    def _columns_not_file(cls, data: Any) -> Any:
        if isinstance(data, Mapping) and "csv" in data:
            raise ValueError(
                f"csv: a file is read only by commands, beside the document; here the columns stand themselves: speed_rpm "
                f"[r/min] and some of {', '.join(COLUMNS)} [N/m, N s/m]"
            )
        return data

    @field_validator("speed_rpm")
    @classmethod
    def _long_and_ascending(cls, speeds: tuple[float, ...]) -> tuple[float, ...]:
        if len(speeds) < FEWEST_SPEEDS:
            raise ValueError(f"a table has at least {FEWEST_SPEEDS} speeds [r/min], usually 10 to 30, not {len(speeds)}")
        for place, (low, high) in enumerate(zip(speeds, speeds[1:], strict=False)):
            if high <= low:
                raise ValueError(f"speeds [r/min] must ascend: {high:g} at place {place + 2} follows {low:g}")
        return speeds

    @field_validator("over_load")
    @classmethod
    def _alike_at_ascending_loads(cls, tables: tuple[ColumnsAtLoad, ...] | None) -> tuple[ColumnsAtLoad, ...] | None:
        if tables is not None:
            if len(tables) == 1:
                raise ValueError("a table over the load has at least two loads [N]; one needs no over_load")
            require_alike(tables)
        return tables

    @model_validator(mode="after")
    def _require_column(self) -> Self:
        if not self.coefficients:
            raise ValueError(f"a table gives at least one of {', '.join(COLUMNS)}")
        for one in self.over_load or (self,):
            one.require_values(len(self.speed_rpm))
        double = [name for name in COLUMNS if self.over_load and getattr(self, name) is not None]
        if double:
            raise ValueError(f"{', '.join(double)} beside over_load: give columns for one load, or for several in over_load")
        if self.over_load and self.load is None:
            raise ValueError("over_load needs the bearing's own static load [N] as load; a quarter of the train's weight, say")
        if self.load is not None and not self.over_load:
            raise ValueError("load is of tables over the load: give the columns for several loads in over_load")
        return self

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Return the terms that have a column."""
        return self.over_load[0].coefficients if self.over_load else super().coefficients

    def column(self, term: str) -> tuple[float, ...]:
        """Compute a term's values over the table's speeds, at the bearing's load.

        Args:
            term: The term, such as `kxx`, which has a column.

        Returns:
            Values (n,) [SI].
        """
        if not self.over_load or self.load is None:
            return tuple(getattr(self, term))
        return at_load(self.over_load, self.load, term)

    def governs(self, term: str) -> bool:
        """Return whether a term has a column.

        Args:
            term: The term, such as `kxx`.

        Returns:
            Whether it has.
        """
        return term in self.coefficients

    def parameter_count(self, terms: Sequence[str]) -> int:
        """Return the number of scale factors: one for each direct term, none of an exact table.

        Args:
            terms: The terms, all of which have a column.

        Returns:
            The number.
        """
        return 0 if self.scale_spread == 0.0 else sum(TERMS[name].direct for name in terms)

    def nominal(self, term: str, rpm: float) -> float | None:
        """Return a term's value in the table.

        Args:
            term: The term, such as `kxx`.
            rpm: Speed [r/min].

        Returns:
            The value [SI]; None for a term without a column.
        """
        if not self.governs(term):
            return None
        return float(self._model((term,), (term,)).at(np.array([rpm_to_rad_per_s(rpm)])).table[0, 0])

    def implausible(self) -> Iterator[tuple[str, str]]:
        """Find stiffnesses, at any load, that are too small for a bearing: their unit must be another.

        Yields:
            Path of a column in the form, and its smallest value with what is usual.
        """
        yield from self.too_soft()
        for number, one in enumerate(self.over_load or ()):
            yield from ((f"over_load[{number}].{name}", words) for name, words in one.too_soft())

    def warnings(self, lowest_rpm: float, highest_rpm: float) -> Iterator[tuple[str, str]]:
        """Find what is probably a mistake: a speed range beyond the table's ends, stiffnesses in another unit.

        Args:
            lowest_rpm: Lowest speed of the machine [r/min].
            highest_rpm: Its highest speed [r/min].

        Yields:
            Name of a field, and a sentence about it.
        """
        first, last = self.speed_rpm[0], self.speed_rpm[-1]
        ranges = [(lowest_rpm, first)] * (lowest_rpm < first) + [(last, highest_rpm)] * (highest_rpm > last)
        if ranges:
            beyond = " and ".join(f"from {low:g} to {high:g}" for low, high in ranges)
            words = f"the table covers {first:g} to {last:g} r/min and is held level beyond its ends, {beyond} r/min"
            meant = question(last, "r/min", (LEAST_COVERED * highest_rpm, highest_rpm / LEAST_COVERED))
            yield "speed_rpm", words + meant
        yield from self._gaps(lowest_rpm, highest_rpm)
        for at, one in {"": self, **{f"over_load[{k}].": one for k, one in enumerate(self.over_load or ())}}.items():
            yield from ((at + name, words) for name, words in one.spikes(self.speed_rpm))
        if self.over_load and self.load is not None:
            least, most = self.over_load[0].load, self.over_load[-1].load
            if not least <= self.load <= most:
                yield "load", f"{self.load:g} N: the table covers loads of {least:g} to {most:g} N and is held at its end"
        for name in ("kxx", "kyy"):
            column = self.column(name) if self.governs(name) else None
            if column is not None and min(column) < SMALLEST_STIFFNESS:
                yield name, f"{min(column):g} N/m: bearings usually have 1e5 to 1e9 N/m; was N/µm meant?"
        for stiffness, damping in (("kxx", "cxx"), ("kyy", "cyy")):
            if self.governs(stiffness) and self.governs(damping):
                k, c = self.column(stiffness)[-1], self.column(damping)[-1]
                part = c * rpm_to_rad_per_s(last) / k
                if part < LEAST_DAMPED:
                    words = (
                        f"{c:g} N s/m at {last:g} r/min, with the speed {part:.2g} of {stiffness} there: films have 0.1 to 10"
                    )
                    yield damping, f"{words} of it; was N s/mm meant?"

    def _gaps(self, lowest_rpm: float, highest_rpm: float) -> Iterator[tuple[str, str]]:
        """Yield wide parts of a machine's speed range [r/min] in which the table has no speed."""
        for low, high in itertools.pairwise(self.speed_rpm):
            part = (min(high, highest_rpm) - max(low, lowest_rpm)) / (highest_rpm - lowest_rpm)
            if part > WIDEST_GAP:
                words = (
                    f"no speed between {low:g} and {high:g} r/min, {100 * part:.0f} % of the machine's range: the course there"
                )
                yield "speed_rpm", f"{words} is a guess; usual are 10 to 30 speeds, evenly spread"

    def models(self, coefficients: Sequence[ModelParameter]) -> Sequence[CoefficientModel]:
        """Return the one model of an element's coefficients.

        Args:
            coefficients: The coefficients as parameters.

        Returns:
            The model, in a list.
        """
        names = tuple(one.name for one in coefficients)
        return [self._model(names, tuple(map(_term, names)))]

    def _model(self, names: tuple[str, ...], terms: tuple[str, ...]) -> TableModel:
        speed = tuple(rpm * RAD_PER_S["rpm"] for rpm in self.speed_rpm)
        return TableModel(names, tuple(self.column(term) for term in terms), speed, self.scale_spread)


def _term(name: str) -> str:
    return name.rpartition(".")[2]
