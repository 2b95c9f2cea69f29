"""Units of a table: as whoever reads it says them, and as headers such as `B1L Amplitude (µm pp)` state them."""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, get_args

from msgspec import Struct

from estimator.machine.speed_units import NAMES
from estimator.unit_names import declared_unit, unknown_unit
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
    | {GAP_END.removeprefix("_"): (GAP_END, ()), "amp": (AMPLITUDE_ENDS[0], OF_AMPLITUDE)}
)
"""End of a standard name, and what its unit may state, by the words behind a channel in a header."""


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
    def words(self) -> str:
        """Return the units in words."""
        amplitude = "µm" if self.amplitude == "um" else self.amplitude
        phase = {"deg": "degrees", "rad": "radians"}[self.phase]
        return f"{NAMES[self.speed]}, {amplitude} {self.kind}, phase {self.convention} in {phase}"


def standard_names(headers: Sequence[str], channels: Sequence[str], units: TableUnits) -> dict[str, str]:
    """Return the standard name of each header whose meaning is certain, of any other itself.

    Letter case does not matter, nor do spaces for `_`; `Speed [rpm]` is `speed`. Raises WrongRun where a header states another
    unit than the table's, or two mean the same.
    """
    folded = [_folded(one) for one in channels]
    known = {plain: one for plain, one in zip(folded, channels, strict=True) if folded.count(plain) == 1}
    names = {header: header if header in channels else _standard_name(header, known, units) for header in headers}
    meant: dict[str, str] = {}
    for header, name in names.items():
        if name in meant:
            raise WrongRun(f"columns '{meant[name]}' and '{header}' are both '{name}': which one counts?")
        meant[name] = header
    return names


def _standard_name(header: str, channels: Mapping[str, str], units: TableUnits) -> str:
    parts = HEADER.fullmatch(header)
    words, unit = (_folded(parts["words"]), parts["unit"]) if parts else ("", None)
    if words in SPEED_COLUMNS:
        return words if unit is None or _is_stated(header, unit, ("speed_unit",), units) else header
    of = max((one for one in channels if words.startswith(f"{one}_")), key=len, default=None)
    if of is None:
        return header
    rest = words.removeprefix(f"{of}_")
    if rest == "gap" and unit is not None and declared_unit("gap_unit", unit) == "um":
        return f"{channels[of]}{GAP_END}"
    if rest not in ENDS:
        return header
    end, options = ENDS[rest]
    return f"{channels[of]}{end}" if unit is None or _is_stated(header, unit, options, units) else header


def _folded(name: str) -> str:
    """Return a name as it is compared: in small letters, `_` for spaces."""
    return "_".join(name.replace("_", " ").split()).casefold()


def _is_stated(header: str, unit: str, options: Iterable[str], units: TableUnits) -> bool:
    """Return whether what stands in a header's brackets is understood. Raises WrongRun where it is another unit than said."""
    rest, meant = unit.replace("_", " ").replace(",", " ").split(), {}
    while rest:
        heads = [(size, option) for size in range(len(rest), 0, -1) for option in options]
        found = next(
            (
                (size, option, one)
                for size, option in heads
                if (one := declared_unit(option, " ".join(rest[:size]))) in get_args(UNIT_OPTIONS[option])
            ),
            None,
        )
        if found is None:
            return False
        size, option, meant[option] = found
        rest = rest[size:]
    for option, one in meant.items():
        if one != units.by_option[option]:
            raise WrongRun(f"column '{header}' is in {one}, but {option} says {units.by_option[option]}")
    return bool(meant)
