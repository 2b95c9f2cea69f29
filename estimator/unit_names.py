"""Names of units as people and instruments write them: which declared unit each stands for, and close ones to misspelt names.

Sources of samples declare units by their own names alone; these are for tables, sidecars and arguments.
"""

from collections.abc import Iterable
from itertools import product
from typing import Any

from estimator.close_matches import close_names

LENGTHS = {
    "m": ("metre", "meter", "metres", "meters"),
    "mm": ("millimetre", "millimeter", "millimetres", "millimeters"),
    "um": ("µm", "micron", "microns", "micrometre", "micrometer", "micrometres", "micrometers"),
    "mil": ("mils", "thou"),
    "V": ("volt", "volts"),
}
UNIT_NAMES: dict[str, dict[str, tuple[str, ...]]] = {
    "speed_unit": {
        "rpm": ("r/min", "rev/min", "1/min", "min-1", "min^-1", "min⁻¹"),
        "rad/s": ("rad/sec", "rad s-1"),
        "Hz": ("hertz", "rev/s", "r/s"),
    },
    "amplitude_unit": LENGTHS,
    "amplitude_kind": {
        "peak": ("pk", "p", "0-peak", "0-pk", "0-p", "0-to-peak", "zero-to-peak"),
        "peak-to-peak": ("pp", "p-p", "pk-pk", "pkpk", "peak-peak", "pk-to-pk", "ptp"),
    },
    "phase_convention": {"lag": ("lagging", "phase lag"), "lead": ("leading", "phase lead")},
    "phase_unit": {"deg": ("°", "degree", "degrees"), "rad": ("radian", "radians")},
    "gap_unit": LENGTHS,
    "weight_unit": {
        "kg m": ("kgm",),
        "kg mm": ("kgmm",),
        "g mm": ("gmm",),
        "g in": ("gin",),
        "oz in": ("ozin",),
        "kg": (),
        "g": ("gram", "grams", "gramme", "grammes"),
        "oz": ("ounce", "ounces"),
    },
    "radius_unit": {"m": LENGTHS["m"], "mm": LENGTHS["mm"], "in": ("inch", "inches", '"')},
}
"""Other names of each unit, by the field that declares it."""

NEAR_LENGTH = 2
"""Most letters by which a misspelt name is longer or shorter: inches (`in`) are no microns."""


def _plain(name: str) -> str:
    """Return a name as it is compared: in small letters, µ as Greek has it, one kind of sign between its words."""
    folded = name.casefold()
    for sign in "_-·⋅*":
        folded = folded.replace(sign, " ")
    return " ".join(folded.split())


_MEANT = {
    field: {_plain(name): unit for unit, others in units.items() for name in (unit, *others)}
    for field, units in UNIT_NAMES.items()
}


def declared_unit(field: str, name: Any) -> Any:
    """Return the unit that a name stands for, such as `um` for `µm`.

    Args:
        field: Field that declares it, of `UNIT_NAMES`.
        name: The name as a person wrote it.

    Returns:
        The unit; what was given where it names none.
    """
    return _MEANT[field].get(_plain(name), name) if isinstance(name, str) else name


def stated_units(text: str, fields: Iterable[str]) -> dict[str, str] | None:
    """Return the units that a text such as `µm pp` states.

    Args:
        text: What stands in a header's brackets, or below it in a line of units.
        fields: Fields that may be stated, of `UNIT_NAMES`.

    Returns:
        The unit of each field that it states; None where a part of the text is no unit, or states a field twice.
    """
    fields, rest = tuple(fields), text.replace("_", " ").replace(",", " ").split()
    meant: dict[str, str] = {}
    while rest:
        for size, field in product(range(len(rest), 0, -1), fields):
            unit = declared_unit(field, " ".join(rest[:size]))
            if unit in UNIT_NAMES[field] and meant.get(field, unit) == unit:
                break
        else:
            return None
        meant[field], rest = unit, rest[size:]
    return meant


def unknown_unit(field: str, name: Any, units: Iterable[str]) -> str:
    """Return that a name is no unit, with those that there are and the one that was probably meant.

    Args:
        field: Field that declares it, of `UNIT_NAMES`.
        name: The name.
        units: Units that the field may have here.

    Returns:
        What is wrong, in words.
    """
    known = list(units)
    length = len(_plain(name)) if isinstance(name, str) else 0
    names = {plain: unit for plain, unit in _MEANT[field].items() if unit in known and abs(len(plain) - length) <= NEAR_LENGTH}
    close = dict.fromkeys(names[one] for one in close_names(_plain(name), names)) if isinstance(name, str) else {}
    meant = f"; did you mean {' or '.join(map(repr, close))}?" if close else ""
    return f"{name!r} is not one of {', '.join(known)}{meant}"
