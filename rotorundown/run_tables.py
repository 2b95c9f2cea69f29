"""Tables of a run without a sidecar: which columns hold what, and what is wrong with their numbers."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.close_matches import MOST_MATCHES, close_names, did_you_mean
from estimator.machine.document import Machine
from estimator.machine.speed_units import NAMES
from estimator.units import METRES, RAD_PER_S, AmplitudeUnit, PhaseUnit, SpeedUnit, rad_per_s_to_rpm
from formats.files.document_files import UnreadableFile
from formats.recordings.exported_table import asks_for_thousands, lost_thousands
from formats.recordings.phase_units import contradicted_phase_unit, is_possible_of_one_channel, look_like_radians
from formats.recordings.plain_table import read_plain_table
from formats.recordings.run_times import EXAMPLE, doubted_times, wrong_times
from formats.recordings.standstill import at_standstill, standstill_words
from formats.wire import LARGEST_AMPLITUDE, OVERSPEED, WIRE_SCHEMA, SampleBatch, to_samples
from rotorundown.run_columns import (
    AMPLITUDE_ENDS,
    GAP_END,
    PHASE_ENDS,
    SPEED_COLUMNS,
    TIME_COLUMNS,
    UNNAMED,
    WrongRun,
    columns_of,
    is_known_name,
    known_name,
    require_different,
)
from rotorundown.run_units import TableUnits, standard_names
from storage.clock import now
from storage.encoding.sample_blocks import Samples

LIKE_TIMES = ("time", "date", "seconds")
"""Beginnings of names, in small letters, of columns that seem to hold times."""
BEGINNING_NS = 946_771_200_000_000_000
"""Time [ns since 1970] given to the first sample: 2 January 2000, as in recordings without a date."""
FIRST_LINE = 2
"""Line of the first row, where the header is the first line of a file."""
MOST_LISTED = 12
"""Most columns of a table that an error lists."""
WIDE_PHASES_DEG = 90.0
"""Spread of the phases of other channels [°] beside which one within a turn in radians is doubted."""
SMALLEST_AMPLITUDE, LIKELY_AMPLITUDE = 1e-9, 1e-7
"""Largest amplitude of a run below which its unit is wrong, and from which on another may be right [m]."""
MOST_NEGATIVE = 0.25
"""Largest share of amplitudes below zero that single bad values may be [-]: a component of a vector has more."""
FEWEST_BELOW_OVERSPEED = 0.5
"""Share of the speeds within the machine's range or somewhat above it below which another unit is likely [-]."""


class RunTable(Struct, frozen=True, eq=False):
    """Columns (S,) of a run by name, what is wrong with those that hold no numbers, and whether its times are dates.

    first_line: line of its file in which the first row is.
    """

    columns: Mapping[str, Floats]
    unread: Mapping[str, str] = {}
    dated: bool = False
    first_line: int = FIRST_LINE

    @classmethod
    def of(cls, source: Any) -> "RunTable":
        """Return the columns of a data frame or a mapping. Raises WrongRun."""
        return cls(*columns_of(source))

    def named(self, machine: Machine, units: TableUnits) -> "RunTable":
        """Return the table with its columns under their standard names. Raises WrongRun where one has no numbers."""
        names = standard_names([*self.columns, *self.unread], machine.channels, units)
        of_run = {*SPEED_COLUMNS, *TIME_COLUMNS}
        of_run |= {f"{one}{end}" for one in machine.channels for end in (*AMPLITUDE_ENDS, *PHASE_ENDS, GAP_END)}
        wrong = next((words for header, words in self.unread.items() if names[header] in of_run), None)
        if wrong is not None:
            raise WrongRun(wrong)
        if {*TIME_COLUMNS} <= {*names.values()}:
            raise WrongRun(f"columns {' and '.join(map(repr, TIME_COLUMNS))} hold the time: which one counts?")
        return replace(self, columns={names[header]: column for header, column in self.columns.items()})

    @property
    def time(self) -> Floats | None:
        """Return the seconds (S,) where a column holds them."""
        return next((self.columns[name] for name in TIME_COLUMNS if name in self.columns), None)

    def samples(self, machine: Machine, units: TableUnits, name: str) -> tuple[Samples, tuple[str, ...]]:
        """Return the run's good samples in SI, and what was left out. Raises WrongRun, Rejected."""
        speed = self.columns[self._first(SPEED_COLUMNS, "the speed")]
        _require_speed_unit(machine, speed, units)
        channels = self._channels(machine)
        amplitude = np.column_stack([self._of_channel(one, AMPLITUDE_ENDS, "amplitude") for one in channels])
        phase = np.column_stack([self._of_channel(one, PHASE_ENDS, "phase") for one in channels])
        _require_positive(channels, amplitude)
        _require_amplitude_unit(amplitude, units.amplitude)
        doubts = _phase_doubts(phase, units)
        gap = self._gaps(channels)
        seconds = np.arange(speed.size, dtype=float) if self.time is None else _seconds(self.time, dated=self.dated)
        batch = SampleBatch(
            schema=WIRE_SCHEMA,
            plant=machine.plant,
            machine=machine.id,
            source="table",
            epoch=0,
            sequence=0,
            channels=channels,
            speed_unit=units.speed,
            amplitude_unit=units.amplitude,
            amplitude_kind=units.kind,
            phase_convention=units.convention,
            phase_unit=units.phase,
            direction=machine.rotation,
            time_ns=[BEGINNING_NS + round(float(one) * 1e9) for one in seconds - seconds[0]],
            speed=speed.tolist(),
            amplitude=_blank(amplitude),
            phase=_blank(phase),
            gap=None if gap is None else _blank(gap),
            gap_unit=None if gap is None else "um",
        )
        samples, taken, faults = to_samples(batch, machine, received_at=now())
        still = at_standstill(samples.speed, taken)
        taken = taken & ~still
        doubts += [] if self.time is None else self._doubted_times(seconds, speed)
        doubted = tuple(f"{name}, {words}" for words in (*doubts, *_doubted_phases(channels, phase, units.phase)))
        rows = [fault.of_row(kept=bool(taken[fault.index])) for fault in faults if not still[fault.index]]
        rejected = (f"{name}, {words}" for words in (*rows, *standstill_words(still)))
        left_out = (*self._foreign(machine, name), *doubted, *rejected)
        if not np.any(taken):
            raise WrongRun(f"no sample of the run can be used: {left_out[-1]}")
        return samples.pick(taken), left_out

    def _doubted_times(self, seconds: Floats, speed: Floats) -> list[str]:
        """Return what is doubted of the times, and where a column beside them holds their dates."""
        doubts = doubted_times(seconds, speed, dated=self.dated)
        date = next((one for one in self.unread if one.casefold().startswith("date")), None)
        if doubts and date is not None:
            doubts.append(f"column '{date}' seems part of the times: write both as one column time, such as {EXAMPLE}")
        return doubts

    def _channels(self, machine: Machine) -> list[str]:
        """Return the channels whose amplitudes the table has. Raises WrongRun where there are none."""
        channels = [one for one in machine.channels if any(f"{one}{end}" in self.columns for end in AMPLITUDE_ENDS)]
        if channels:
            return channels
        wanted = " or ".join(f"{machine.channels[0]}{end}" for end in AMPLITUDE_ENDS)
        begun = tuple(one.casefold() for one in machine.channels)
        like = [one for one in self.columns if one.casefold().startswith(begun) and not is_known_name(one)]
        asked = f"; does {' or '.join(map(repr, like[:MOST_MATCHES]))} hold one?" if like else ""
        raise WrongRun(
            f"no column holds an amplitude of a channel of '{machine.id}' ({', '.join(machine.channels)}): "
            f"name it such as {wanted}; there are {_first_names(self.columns)}{asked}"
        )

    def _gaps(self, channels: Sequence[str]) -> Floats | None:
        """Return the gaps (S, m) [µm] of channels, NaN where there are none; None where no column holds any."""
        names = [f"{one}{GAP_END}" for one in channels]
        if not any(one in self.columns for one in names):
            return None
        none = np.full(next(iter(self.columns.values())).size, np.nan)
        return np.column_stack([self.columns.get(one, none) for one in names])

    def _foreign(self, machine: Machine, name: str) -> Iterator[str]:
        """Name columns of no channel, gaps under other names, and phases without amplitudes."""
        others = []
        for column in (*self.columns, *self.unread):
            if (of := _other_gap(column, machine)) is not None:
                yield f"{name}, column '{column}' left out: give gaps in µm, in a column '{of}{GAP_END}'"
                continue
            end = next((one for one in (*AMPLITUDE_ENDS, GAP_END) if column.endswith(one)), None)
            channel = "" if end is None else column.removesuffix(end)
            if not is_known_name(column):
                others.append(column)
            elif channel and channel not in machine.channels:
                close = did_you_mean(channel, machine.channels)
                yield f"{name}, column '{column}' left out: '{channel}' is no channel of '{machine.id}'{close}"
        if others:
            many = "s" if len(others) > 1 else ""
            times = [one for one in others if self.time is None and one.casefold().startswith(LIKE_TIMES)]
            asked = f"; where '{times[0]}' holds the times, name it time, in seconds or as dates" if times else ""
            yield f"{name}, column{many} {_first_names(map(repr, others))} left out: of no channel of '{machine.id}'{asked}"
        for channel, end in product(machine.channels, PHASE_ENDS):
            wanted = [f"{channel}{one}" for one in AMPLITUDE_ENDS]
            if f"{channel}{end}" in self.columns and not any(one in self.columns for one in wanted):
                yield f"{name}, column '{channel}{end}' left out: no column holds the amplitude, {' or '.join(wanted)}"

    def _of_channel(self, channel: str, ends: tuple[str, ...], what: str) -> Floats:
        return self.columns[self._first(tuple(f"{channel}{end}" for end in ends), f"the {what} of {channel}")]

    def _first(self, names: tuple[str, ...], what: str) -> str:
        found = [name for name in names if name in self.columns]
        if not found:
            unknown = {one.lower(): one for one in self.columns if not is_known_name(one)}
            close = dict.fromkeys(unknown[one] for name in names for one in close_names(name.lower(), unknown))
            asked = f"; does {' or '.join(map(repr, close))} hold it?" if close else ""
            raise WrongRun(
                f"no column holds {what}: name it {' or '.join(names)}; there are {_first_names(self.columns)}{asked}"
            )
        if len(found) > 1:
            raise WrongRun(f"columns {' and '.join(map(repr, found))} hold {what}: which one counts?")
        return found[0]


def _other_gap(column: str, machine: Machine) -> str | None:
    """Return the channel whose gap a column seems to hold under another name, such as `B1L_gap` or `B1L_gap_V`."""
    seemingly = (one for one in machine.channels if column.lower().startswith(f"{one.lower()}_gap"))
    return next((one for one in seemingly if column != f"{one}{GAP_END}"), None)


def read_csv_table(path: Path) -> RunTable:
    """Read a CSV file with a header line; where semicolons or tabs separate columns, decimals may have a comma.

    Raises WrongRun.
    """
    try:
        header, rows, line = read_plain_table(path)
    except UnreadableFile as error:
        raise WrongRun(str(error)) from None
    names = [name or f"{UNNAMED}{place}" for place, name in enumerate(header)]
    require_different(list(map(known_name, names)))
    table = RunTable.of(dict(zip(names, map(list, zip(*rows, strict=True)), strict=True)))
    return replace(table, first_line=line)


def _first_names(columns: Iterable[str]) -> str:
    """Return the first names of columns, and how many more there are."""
    names = list(columns)
    more = len(names) - MOST_LISTED
    return ", ".join(names[:MOST_LISTED]) + (f" and {more} more" if more > 0 else "")


def _seconds(values: Floats, *, dated: bool) -> Floats:
    if not np.all(np.isfinite(values)):
        raise WrongRun(f"the time has no number in row {int(np.argmin(np.isfinite(values))) + 1}")
    if wrong := wrong_times(values, dated=dated):
        raise WrongRun(wrong)
    return values


def _blank(table: Floats) -> list[list[float | None]]:
    return [[None if np.isnan(one) else float(one) for one in row] for row in table]


def _require_speed_unit(machine: Machine, speed: Floats, units: TableUnits) -> None:
    """Raise WrongRun for speeds that never enter the machine's range, and would in another unit."""
    limits = machine.speed_range
    if not np.all(np.isfinite(speed)):
        raise WrongRun(f"the speed has no number in row {int(np.argmin(np.isfinite(speed))) + 1}: leave such rows out")
    if np.all(speed < 0.0):
        raise WrongRun(
            "all speeds are below zero: write them positive, the document says which way it turns "
            f"(rotation: {machine.rotation})"
        )
    if lost := lost_thousands(speed):
        raise WrongRun(lost)
    others = [unit for unit in RAD_PER_S if unit != units.speed and _enters(speed, unit, machine)]
    hint = f": are these in {' or '.join(others)}? Say so with speed_unit" if others else ""
    if _enters(speed, units.speed, machine):
        slow = [_share_below_overspeed(speed, unit, machine) for unit in (units.speed, *others)]
        if slow[0] < FEWEST_BELOW_OVERSPEED and max(slow) == 1.0:
            raise WrongRun(f"most speeds lie far beyond the range of '{machine.id}' when read in {NAMES[units.speed]}{hint}")
        return
    if _enters(1e3 * speed, units.speed, machine) and (asked := asks_for_thousands(speed)):
        hint += f"{', or' if hint else ':'} {asked}"
    highest = rad_per_s_to_rpm(float(np.max(np.abs(speed))) * RAD_PER_S[units.speed])
    raise WrongRun(
        f"the run reaches {highest:.0f} r/min and never enters the range of '{machine.id}', "
        f"{limits.minimum_rpm:g} to {limits.maximum_rpm:g} r/min{hint}"
    )


def _enters(speed: Floats, unit: SpeedUnit, machine: Machine) -> bool:
    rpm = np.abs(speed) * RAD_PER_S[unit] / RAD_PER_S["rpm"]
    return bool(np.any((rpm >= machine.speed_range.minimum_rpm) & (rpm <= machine.speed_range.maximum_rpm)))


def _share_below_overspeed(speed: Floats, unit: SpeedUnit, machine: Machine) -> float:
    rpm = np.abs(speed) * RAD_PER_S[unit] / RAD_PER_S["rpm"]
    return float(np.mean(rpm <= OVERSPEED * machine.speed_range.maximum_rpm))


def _require_positive(channels: Sequence[str], amplitude: Floats) -> None:
    """Raise WrongRun for a channel most of whose amplitudes (S, m) are below zero: decibels, or a component of the vector."""
    for channel, column in zip(channels, amplitude.T, strict=True):
        known = column[np.isfinite(column)]
        if np.count_nonzero(known < 0.0) > MOST_NEGATIVE * known.size:
            raise WrongRun(
                f"the amplitudes of {channel} are below zero, such as {known[known < 0.0][0]:.3g}: write amplitudes with "
                "phases, not decibels or one component of the vector"
            )


def _require_amplitude_unit(amplitude: Floats, unit: AmplitudeUnit) -> None:
    """Raise WrongRun for amplitudes below any probe's resolution; name the units in which they would be plausible."""
    known = np.abs(amplitude[np.isfinite(amplitude)])
    largest = float(np.max(known, initial=0.0))
    if not 0.0 < largest * METRES[unit] < SMALLEST_AMPLITUDE:
        return
    others = [other for other in METRES if LIKELY_AMPLITUDE <= largest * METRES[other] <= LARGEST_AMPLITUDE]
    hint = f": are these in {' or '.join(others)}? Say so with amplitude_unit" if others else ""
    raise WrongRun(f"the largest amplitude is {largest:.2g} {unit}, less than any probe resolves{hint}")


def _phase_doubts(phase: Floats, units: TableUnits) -> list[str]:
    """Return why phases (S, m) are probably in another unit. Raises WrongRun where they are in another one."""
    contradiction = contradicted_phase_unit(phase, units.phase)
    if contradiction is None:
        return []
    why, right = contradiction
    if not is_possible_of_one_channel(phase, right):
        raise WrongRun(f"{why}: say phase_unit={right!r}")
    if not units.phase_is_stated:
        raise WrongRun(f"{why}: say phase_unit={right!r}, or phase_unit={units.phase!r} where they are in degrees")
    return [f"{why}: taken as degrees, as phase_unit says"]


def _doubted_phases(channels: Sequence[str], phase: Floats, unit: PhaseUnit) -> Iterator[str]:
    """Name the channels whose phases look like radians among others in degrees: no error, a stiff place may show as little."""
    known = [column[np.isfinite(column)] for column in phase.T]
    if unit != "deg" or not any(column.size and np.ptp(column) > WIDE_PHASES_DEG for column in known):
        return
    for channel, column in zip(channels, known, strict=True):
        if look_like_radians(column):
            reach = f"{np.max(np.abs(column)):.2f}"
            yield f"{channel}: its phases lie within {reach}, those of others do not: are they in radians? Write degrees"
