"""Units of parameters: SI, and others for who asks with `?units=rpm,g_mm,n_um`; each series or estimate says which."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, get_args

from fastapi import Depends, Query

from estimator.baseline_band import Band
from estimator.units import RAD_PER_S
from service.api.trend_columns import Columns
from service.api.units import Amplitude, Phase, Speed, names_in, wrong_units

OTHERS: Mapping[str, tuple[str, str, float]] = {
    "rpm": ("rad/s", "rpm", RAD_PER_S["rpm"]),
    "hz": ("rad/s", "Hz", RAD_PER_S["Hz"]),
    "g_mm": ("kg m", "g mm", 1e-6),
    "n_um": ("N/m", "N/µm", 1e6),
    "ns_mm": ("N s/m", "N s/mm", 1e3),
    "kn": ("N", "kN", 1e3),
}
"""By its name in a question: the SI unit in whose place it comes, how it is written, its size in that unit."""

OF_PHASORS = frozenset(get_args(Amplitude) + get_args(Phase) + get_args(Speed)) - frozenset(OTHERS)
"""Names that answers with phasors take: who asks for everything in the same units may, here they change nothing."""

TrendUnits = Mapping[str, tuple[str, float]]
"""By SI unit: how the other one is written, and its size."""


async def _trend_units(
    units: Annotated[
        str | None,
        Query(
            max_length=60,
            description=f"in the place of SI units, with commas between: {', '.join(OTHERS)}; one for each quantity. "
            "Units of vibration change nothing",
            examples=["rpm,g_mm,n_um"],
        ),
    ] = None,
) -> TrendUnits:
    chosen: dict[str, str] = {}
    for name in names_in(units):
        if name in OF_PHASORS:
            continue
        if name not in OTHERS:
            raise wrong_units(units, f"'{name}' is none of {', '.join(OTHERS)}")
        si = OTHERS[name][0]
        if si in chosen:
            raise wrong_units(units, f"'{name}' and '{chosen[si]}' are both in the place of {si}: name one")
        chosen[si] = name
    return {si: OTHERS[name][1:] for si, name in chosen.items()}


TrendUnitChoice = Annotated[TrendUnits, Depends(_trend_units)]


def shown_in(unit: str, units: TrendUnits) -> tuple[str, float]:
    """How a unit is written where others are chosen, and the size of what comes in its place in it."""
    return units.get(unit, (unit, 1.0))


def in_units(columns: Columns, units: TrendUnits) -> Columns:
    """A history, and the bands beside it, in the units chosen for it."""
    history = columns.history
    if history.unit is None or history.unit not in units:
        return columns
    written, size = shown_in(history.unit, units)
    converted = {name: getattr(history, name) / size for name in ("value", "standard_error", "lower", "upper", "imaginary")}
    bands = [replace(one, band=_scaled(one.band, size)) for one in columns.baselines]
    return replace(
        columns,
        history=replace(history, unit=written, **converted),
        value=columns.value / size,
        standard_error=columns.standard_error / size,
        baselines=bands,
    )


def _scaled(band: Band, size: float) -> Band:
    return replace(band, centre=band.centre / size, lower=band.lower / size, upper=band.upper / size)
