"""Units of a table: as whoever reads it says them, and as headers such as `B1L Amplitude (µm pp)` state them."""

import re
from collections.abc import Mapping, Sequence
from typing import Any, get_args

from msgspec import Struct

from estimator.machine.speed_units import NAMES
from estimator.unit_names import declared_unit, stated_units, unknown_unit
from estimator.units import AmplitudeKind, AmplitudeUnit, PhaseConvention, PhaseUnit, SpeedUnit
from rotorundown.run_columns import AMPLITUDE_ENDS, GAP_END, PHASE_ENDS, SPEED_COLUMNS, WrongRun

UNIT_OPTIONS = {
    "speed_unit": SpeedUnit,
    "amplitude_unit": AmplitudeUnit,
    "amplitude_kind": AmplitudeKind,
    "phase_convention": PhaseConvention,
    "phase_unit": PhaseUnit,
}
"""Units of a table, as `read_run` takes them."""
HEADER = re.compile(r"(?P<words>[^\[\]()]+?)[\s_]*(?:[\[(](?P<unit>[^\[\]()]*)[\])])?\s*")
"""A header: words, and behind them perhaps a unit in brackets."""
OF_AMPLITUDE, OF_PHASE = ("amplitude_unit", "amplitude_kind"), ("phase_unit", "phase_convention")
ENDS = (
    {one.removeprefix("_"): (one, OF_AMPLITUDE) for one in AMPLITUDE_ENDS}
    | {one.removeprefix("_"): (one, OF_PHASE) for one in PHASE_ENDS}
    | {"amp": (AMPLITUDE_ENDS[0], OF_AMPLITUDE)}
)
"""End of a standard name, and what its unit may state, by the words behind a channel in a header."""
FIXED_UNITS = {
    "rpm": {"speed_unit": "rpm"},
    AMPLITUDE_ENDS[1]: {"amplitude_unit": "um", "amplitude_kind": "peak-to-peak"},
    PHASE_ENDS[1]: {"phase_unit": "deg", "phase_convention": "lag"},
}
"""Units that standard names give, by their ends."""


class TableUnits(Struct, frozen=True):
    """Units of a table's columns. phase_is_stated: whether somebody has said the phases' unit, which is then believed."""

    speed: SpeedUnit = "rpm"
    amplitude: AmplitudeUnit = "um"
    kind: AmplitudeKind = "peak-to-peak"
    convention: PhaseConvention = "lag"
    phase: PhaseUnit = "deg"
    phase_is_stated: bool = False

    @classmethod
    def named(cls, *, phase_unit: str | None, **given: str) -> "TableUnits":
        """Return units by the names that people give them, as `read_run` takes them. Raises WrongRun for what is none."""
        meant: dict[str, Any] = {}
        for option, unit in {**given, "phase_unit": phase_unit or "deg"}.items():
            known = get_args(UNIT_OPTIONS[option])
            meant[option] = declared_unit(option, unit)
            if meant[option] not in known:
                raise WrongRun(f"{option} {unknown_unit(option, unit, known)}")
        speed, amplitude, kind, convention, phase = (meant[option] for option in UNIT_OPTIONS)
        return cls(speed, amplitude, kind, convention, phase, phase_unit is not None)

    @property
    def by_option(self) -> dict[str, str]:
        """Return the units by their options."""
        given = (self.speed, self.amplitude, self.kind, self.convention, self.phase)
        return dict(zip(UNIT_OPTIONS, given, strict=True))

    @property
    def given(self) -> dict[str, str]:
        """Return those units, by their options, that somebody must have said: that are others than without a word."""
        usual = TableUnits().by_option
        return {
            option: unit
            for option, unit in self.by_option.items()
            if unit != usual[option] or (option == "phase_unit" and self.phase_is_stated)
        }

    @property
    def words(self) -> str:
        """Return the units in words."""
        amplitude = "µm" if self.amplitude == "um" else self.amplitude
        phase = {"deg": "degrees", "rad": "radians"}[self.phase]
        return f"{NAMES[self.speed]}, {amplitude} {self.kind}, phase {self.convention} in {phase}"


def standard_names(headers: Sequence[str], channels: Sequence[str], units: TableUnits) -> dict[str, str]:
    """Return the standard name of each header whose meaning is certain, of any other itself.

    Letter case does not matter, nor do spaces for `_`; `Speed [rpm]` is `speed`. Raises WrongRun where a header states another
    unit than the table's or one that is not known, or two mean the same.
    """
    folded = [_folded(one) for one in channels]
    known = {plain: one for plain, one in zip(folded, channels, strict=True) if folded.count(plain) == 1}
    meant: dict[str, str] = {}
    unknown: dict[str, tuple[str, str, tuple[str, ...]]] = {}
    for header in headers:
        name, unit, options = (header, "", ()) if header in channels else _standard_name(header, known)
        stated = stated_units(unit, options)
        if stated is None:
            unknown[header] = (name, unit, options)
            continue
        _require_stated(header, name, stated, units)
        if name in meant:
            raise WrongRun(f"columns '{meant[name]}' and '{header}' are both '{name}': which one counts?")
        meant[name] = header
    taken = set(map(_unfixed, meant))
    for header, (name, unit, options) in unknown.items():
        if _unfixed(name) not in taken:  # else another column is what this one might have been
            right = " and ".join(f"one of {', '.join(get_args(UNIT_OPTIONS[one]))}" for one in options)
            raise WrongRun(f"column '{header}': its unit '{unit}' is not known: write {right}")
    names = {header: name for name, header in meant.items()}
    return {header: names.get(header, header) for header in headers}


def _standard_name(header: str, channels: Mapping[str, str]) -> tuple[str, str, tuple[str, ...]]:
    """Return a header's standard name, the unit that it states, and the options that this may state."""
    parts = HEADER.fullmatch(header)
    words, unit = (_folded(parts["words"]), (parts["unit"] or "").strip()) if parts else ("", "")
    if words in SPEED_COLUMNS:
        return words, unit, ("speed_unit",)
    of = max((one for one in channels if words.startswith(f"{one}_")), key=len, default=None)
    if of is None:
        return header, "", ()
    rest = words.removeprefix(f"{of}_")
    if rest in ("gap", "gap_um") and declared_unit("gap_unit", unit or rest.removeprefix("gap_")) == "um":
        return f"{channels[of]}{GAP_END}", "", ()
    if rest not in ENDS:
        return header, "", ()
    end, options = ENDS[rest]
    return f"{channels[of]}{end}", unit, options


def _folded(name: str) -> str:
    """Return a name as it is compared: in small letters, `_` for spaces."""
    return "_".join(name.replace("_", " ").split()).casefold()


def _require_stated(header: str, name: str, stated: Mapping[str, str], units: TableUnits) -> None:
    """Raise WrongRun where a header, or its standard name, states another unit than said."""
    fixed = next((fixed for end, fixed in FIXED_UNITS.items() if name.endswith(end)), {})
    for option, one in (*stated.items(), *fixed.items()):
        if one != units.by_option[option]:
            other = f": where that is right, name it {_unfixed(name)}" if option not in stated else ""
            raise WrongRun(f"column '{header}' is in {one}, but {option} says {units.by_option[option]}{other}")


def _unfixed(name: str) -> str:
    """Return the standard name that states no unit, of a column whose name may state one."""
    if name in SPEED_COLUMNS:
        return SPEED_COLUMNS[0]
    for without, stating in (AMPLITUDE_ENDS, PHASE_ENDS):
        if name.endswith(stating):
            return f"{name.removesuffix(stating)}{without}"
    return name
