"""Converts parameters from SI units to those of `?units=rpm,g_mm,n_um`; each series or estimate names its unit."""

from collections.abc import Mapping
from typing import Annotated, get_args

from fastapi import Depends, Query

from estimator.units import RAD_PER_S
from service.api.conventions.units import Amplitude, Phase, Speed, names_in, wrong_units

OTHERS: Mapping[str, tuple[str, str, float]] = {
    "rpm": ("rad/s", "rpm", RAD_PER_S["rpm"]),
    "hz": ("rad/s", "Hz", RAD_PER_S["Hz"]),
    "g_mm": ("kg m", "g mm", 1e-6),
    "n_um": ("N/m", "N/µm", 1e6),
    "ns_mm": ("N s/m", "N s/mm", 1e3),
    "kn": ("N", "kN", 1e3),
}
"""By name in the query: the SI unit that it replaces, its symbol, its size in the SI unit."""

OF_PHASORS = frozenset(get_args(Amplitude) + get_args(Phase) + get_args(Speed)) - frozenset(OTHERS)
"""Units of phasors: accepted and ignored here, for clients that send the same units with every request."""

ParameterUnits = Mapping[str, tuple[str, float]]
"""By SI unit: the symbol and the size of the unit that replaces it."""


async def _parameter_units(
    units: Annotated[
        str | None,
        Query(
            max_length=60,
            description=f"in the place of SI units, with commas between: {', '.join(OTHERS)}; one for each quantity. "
            "Units of vibration change nothing",
            examples=["rpm,g_mm,n_um"],
        ),
    ] = None,
) -> ParameterUnits:
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


ParameterUnitChoice = Annotated[ParameterUnits, Depends(_parameter_units)]


def shown_in(unit: str, units: ParameterUnits) -> tuple[str, float]:
    """Return the symbol of the unit that replaces a unit, and its size in that unit."""
    return units.get(unit, (unit, 1.0))
