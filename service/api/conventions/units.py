"""Units of answers with phasors and speeds: `?units=um_pp,rpm,deg_lag`. The answer names its units."""

from typing import Annotated, Any, Literal, get_args

import numpy as np
from fastapi import Depends, Query
from fastapi.exceptions import RequestValidationError
from numpy.typing import NDArray
from pydantic import BaseModel, Field

from estimator.units import LEAD, METRES, PEAK, RAD_PER_S, RADIANS

Speed = Literal["rpm", "hz", "rad_s"]
Amplitude = Literal["um_pp", "um_p", "mil_pp", "mil_p", "mm_pp", "m_p"]
Phase = Literal["deg_lag", "deg_lead", "rad_lag", "rad_lead"]

OptionalValues = list[float | None]

_SPEED: dict[Speed, float] = {"rpm": RAD_PER_S["rpm"], "hz": RAD_PER_S["Hz"], "rad_s": 1.0}
_PEAK = {"p": PEAK["peak"], "pp": PEAK["peak-to-peak"]}
_LENGTH = {"um": METRES["um"], "mil": METRES["mil"], "mm": METRES["mm"], "m": METRES["m"]}
_ANGLE = {"deg": RADIANS["deg"], "rad": RADIANS["rad"]}


class Units(BaseModel):
    """Units of speeds, vibration amplitudes and phases."""

    speed: Speed = Field(default="rpm", description="rpm, hz or rad_s; of the shaft")
    amplitude: Amplitude = Field(default="um_pp", description="length, and peak (p) or peak-to-peak (pp)")
    phase: Phase = Field(
        default="deg_lag", description="of the displacement's positive peak behind (lag) or ahead of (lead) the mark"
    )

    def speeds(self, rad_per_s: NDArray[np.float64]) -> OptionalValues:
        """Return spin speeds [rad/s], or their errors, in these units."""
        return column(np.asarray(rad_per_s) / _SPEED[self.speed])

    def speed_of(self, rad_per_s: float) -> float:
        """Return one spin speed [rad/s] in these units."""
        return float(rad_per_s) / _SPEED[self.speed]

    def amplitudes(self, metres: NDArray[np.float64]) -> OptionalValues:
        """Return amplitudes, 0-to-peak [m], in these units."""
        length, _, kind = self.amplitude.partition("_")
        return column(np.asarray(metres) / (_LENGTH[length] * _PEAK[kind]))

    def lengths(self, metres: NDArray[np.float64]) -> OptionalValues:
        """Return lengths [m] in the amplitudes' unit of length; no peak has a part in them."""
        return column(np.asarray(metres) / _LENGTH[self.amplitude.partition("_")[0]])

    def phases(self, phasors: NDArray[np.complex128]) -> OptionalValues:
        """Return phases of phasors in these units, from zero to less than a turn."""
        angle, _, sense = self.phase.partition("_")
        turn = 2.0 * np.pi / _ANGLE[angle]
        phase = LEAD["lag" if sense == "lag" else "lead"] * np.angle(phasors) / _ANGLE[angle]
        # The modulo of a tiny negative phase would be a full turn.
        return column(np.where(np.isfinite(phasors), np.mod(np.mod(phase, turn), turn), np.nan))


def column(values: NDArray[Any]) -> OptionalValues:
    """Return numbers as JSON has them: null for non-finite ones."""
    return [value if finite else None for value, finite in zip(values.tolist(), np.isfinite(values).tolist(), strict=True)]


Asked = Annotated[
    str | None,
    Query(
        max_length=60,
        description=f"of the answer, at most one of each, with commas between: {', '.join(get_args(Speed))}; "
        f"{', '.join(get_args(Amplitude))}; {', '.join(get_args(Phase))}. By default rpm,um_pp,deg_lag",
        examples=["mil_pp,rpm,deg_lag"],
    ),
]


async def _units_if_asked(units: Asked = None) -> Units | None:
    return None if units is None else await _units(units)


async def _units(units: Asked = None) -> Units:
    chosen: dict[str, Any] = {}
    for name in names_in(units):
        kind = next((kind for kind, known in _KINDS.items() if name in known), None)
        if kind is None:
            raise wrong_units(units, f"'{name}' is none of {', '.join(one for known in _KINDS.values() for one in known)}")
        if kind in chosen:
            raise wrong_units(units, f"'{name}' and '{chosen[kind]}' are both units of {kind}: name one")
        chosen[kind] = name
    return Units(**chosen)


def names_in(units: str | None) -> list[str]:
    """Return the units that a query names. Raises RequestValidationError for a unit that is given twice."""
    names = [] if units is None else units.split(",")
    if "" in names:
        raise wrong_units(units, "a unit is missing beside a comma")
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise wrong_units(units, f"'{twice}' is given twice: name it once")
    return names


def wrong_units(given: str | None, message: str) -> RequestValidationError:
    """Return the error for wrong units in a request."""
    return RequestValidationError([{"type": "value_error", "loc": ("query", "units"), "msg": message, "input": given}])


_KINDS: dict[str, tuple[str, ...]] = {"speed": get_args(Speed), "amplitude": get_args(Amplitude), "phase": get_args(Phase)}

UnitChoice = Annotated[Units, Depends(_units)]
UnitsIfAsked = Annotated[Units | None, Depends(_units_if_asked)]
"""Units for answers whose field names carry units: values in requested units are added beside them."""
