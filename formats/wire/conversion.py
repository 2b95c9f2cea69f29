"""Conversion of a batch from its source's units to SI; no other module converts measured values."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from estimator.machine.document import Machine
from estimator.phasors.channel_status import ChannelStatus
from estimator.units import LEAD, METRES, PEAK, RAD_PER_S, RADIANS, rad_per_s_to_rpm, rpm_to_rad_per_s
from formats.wire.gap_conversion import to_gap
from formats.wire.rejection import Fault, Rejected
from formats.wire.schema import DIRECTIONS, STATUSES, ChannelTable, SampleBatch
from storage.clock import FUTURE_TOLERANCE
from storage.encoding.packing import on_grid
from storage.encoding.sample_blocks import Samples

LARGEST_AMPLITUDE = 0.02
"""No shaft of a running machine moves by more than this [m, 0-to-peak]."""
LARGEST_PHASE = 1e5
"""No source counts phase up to hundreds of turns [° or rad]."""
OVERSPEED = 1.3
"""A speed above this multiple of the machine's maximum is an error, not a speed."""
EARLIEST_TIME = 946_684_800_000_000_000  # 2000-01-01, ns

LATEST_TIME = 4_102_444_800_000_000_000  # 2100-01-01, ns
COARSER_UNITS = {"seconds": 10**9, "milliseconds": 10**6, "microseconds": 10**3}
"""Nanoseconds in each unit that is taken for them by mistake."""

_NO_PHASOR = complex(np.nan, np.nan)


def to_samples(batch: SampleBatch, machine: Machine, *, received_at: int) -> tuple[Samples, NDArray[np.bool_], list[Fault]]:
    """Convert a batch to SI in the document's channel order.

    Returns all samples, which of them are accepted (S,), and every fault. A bad value of a channel makes that channel unusable
    in that sample; a bad time or speed the whole sample. Raises Rejected when the batch as a whole is wrong.
    """
    _check_names(batch, machine)
    factors = _metres(batch, machine) * _factor(batch, "amplitude_kind", PEAK)
    turn = _factor(batch, "phase_convention", LEAD) * _factor(batch, "phase_unit", RADIANS)
    count = len(batch.time_ns)
    shape = (count, len(machine.probes))
    phasor = np.full(shape, _NO_PHASOR)
    second = np.full(shape, _NO_PHASOR)
    scatter = np.full(shape, np.nan)
    status = np.full(shape, ChannelStatus.NOT_AVAILABLE, dtype=np.uint8)
    columns = _columns(batch, machine)
    with np.errstate(invalid="ignore", over="ignore"):
        speed = np.array(batch.speed, dtype=float) * _factor(batch, "speed_unit", RAD_PER_S)
        size, phase = _table(batch.amplitude) * factors, _table(batch.phase)
        number = _is_amplitude(size) & (np.abs(phase) <= LARGEST_PHASE)
        told = np.full(size.shape, np.nan) if batch.scatter is None else _table(batch.scatter) * factors
        sensible = number & (~np.isfinite(told) | _is_amplitude(told))
        phasor[:, columns] = np.where(number, size * np.exp(1j * turn * phase), _NO_PHASOR)
        if batch.amplitude_2x is not None and batch.phase_2x is not None:
            twice, phase_2x = _table(batch.amplitude_2x) * factors, _table(batch.phase_2x)
            number_2x = _is_amplitude(twice) & (np.abs(phase_2x) <= LARGEST_PHASE)
            second[:, columns] = np.where(number_2x, twice * np.exp(1j * turn * phase_2x), _NO_PHASOR)
    called = _source_status(batch, np.isnan(size) | np.isnan(phase))
    wrong = (called == ChannelStatus.GOOD) & ~sensible
    faults = _channel_faults(batch, size, wrong)
    status[:, columns] = np.where(wrong, np.where(_is_too_large(size), ChannelStatus.OUT_OF_RANGE, ChannelStatus.BAD), called)
    scatter[:, columns] = np.where(sensible & np.isfinite(told), told, np.nan)
    time = np.array([min(max(t, -(2**62)), 2**62) for t in batch.time_ns], dtype=np.int64)
    taken = np.ones(count, dtype=bool)
    for fault in _sample_faults(machine, time, speed, received_at):
        faults.append(fault)
        taken[fault.index] = False
    direction = np.full(count, _factor(batch, "direction", DIRECTIONS), dtype=np.int8)
    conditions = _conditions(batch, machine)
    for index, column in np.argwhere(np.isinf(conditions)).tolist():
        faults.append(Fault(index, "not_finite", f"condition {machine.condition_names[column]} is infinite"))
        conditions[index, column] = np.nan
    gap, of_gap = to_gap(batch, machine)
    overall, of_overall = _overall(batch, machine, factors)
    faults += of_gap + of_overall
    phasor = on_grid(phasor.view(np.float64)).view(np.complex128)
    # What is not sent is missing throughout, and needs no rounding.
    second = second if batch.amplitude_2x is None else on_grid(second.view(np.float64)).view(np.complex128)
    scatter = scatter if batch.scatter is None else on_grid(scatter)
    return Samples(time, speed, direction, phasor, status, scatter, second, conditions, gap, overall), taken, faults


def _overall(batch: SampleBatch, machine: Machine, factors: NDArray[np.float64]) -> tuple[NDArray[np.float64], list[Fault]]:
    """Return overall levels (S, m), 0-to-peak [m], NaN where there is none, and why some are left out; the 1× beside stays."""
    levels = np.full((len(batch.time_ns), len(machine.probes)), np.nan)
    if batch.overall is None:
        return levels, []
    with np.errstate(over="ignore", invalid="ignore"):
        size = _table(batch.overall) * factors
        sensible = _is_amplitude(size)
    levels[:, _columns(batch, machine)] = np.where(sensible, size, np.nan)
    faults = []
    for index, column in np.argwhere(~sensible & ~np.isnan(size)).tolist():
        told = f"an overall level of {size[index, column]:.4g} m is not between 0 and {LARGEST_AMPLITUDE} m"
        detail = f"channel {batch.channels[column]}: {told}; it is left out: is its unit right?"
        faults.append(Fault(index, "overall_out_of_range", detail))
    return on_grid(levels), faults


def _is_amplitude(size: NDArray[np.float64]) -> NDArray[np.bool_]:
    return np.asarray((size >= 0.0) & (size <= LARGEST_AMPLITUDE))


def _is_too_large(size: NDArray[np.float64]) -> NDArray[np.bool_]:
    return np.asarray(np.isfinite(size) & ~_is_amplitude(size))


def _factor(batch: SampleBatch, name: str, table: Mapping[Any, float]) -> float:
    value = getattr(batch, name)
    if value not in table:
        raise Rejected("wrong_unit", f"{name} '{value[:40]}' is not one of {', '.join(table)}")
    return table[value]


def _conditions(batch: SampleBatch, machine: Machine) -> NDArray[np.float64]:
    """Return operating conditions (S, k) in the document's order, NaN where one was not measured."""
    table = np.full((len(batch.time_ns), len(machine.conditions)), np.nan)
    for name, values in (batch.conditions or {}).items():
        table[:, machine.condition_names.index(name)] = np.array(values, dtype=float)  # null becomes NaN
    return table


def _check_names(batch: SampleBatch, machine: Machine) -> None:
    channels = machine.channels
    unknown = [channel[:64] for channel in batch.channels if channel not in channels]
    if unknown:
        known = ", ".join(channels)
        raise Rejected("unknown_channel", f"machine '{machine.id}' has no channel {', '.join(unknown)}; it has {known}")
    unknown = [name[:64] for name in batch.conditions or () if name not in machine.condition_names]
    if unknown:
        known = f"it has {', '.join(machine.condition_names)}" if machine.conditions else "its document names none"
        raise Rejected("unknown_condition", f"machine '{machine.id}' has no condition {', '.join(unknown)}; {known}")


def _columns(batch: SampleBatch, machine: Machine) -> list[int]:
    """Return the place of each channel of a batch in the document's order."""
    places = {channel: column for column, channel in enumerate(machine.channels)}
    return [places[channel] for channel in batch.channels]


def _metres(batch: SampleBatch, machine: Machine) -> NDArray[np.float64]:
    """Return the factor to metres per channel of the batch."""
    if batch.amplitude_unit != "V":
        return np.full(len(batch.channels), _factor(batch, "amplitude_unit", METRES))
    sensitivity = {probe.id: probe.sensitivity for probe in machine.probes}
    missing = [channel for channel in batch.channels if sensitivity[channel] is None]
    if missing:
        raise Rejected("wrong_unit", f"amplitudes in V need a sensitivity [V/m] in the document for {', '.join(missing)}")
    return np.array([1.0 / (sensitivity[channel] or np.nan) for channel in batch.channels])


def _table(rows: ChannelTable) -> NDArray[np.float64]:
    return np.array(rows, dtype=float)  # null becomes NaN


def _source_status(batch: SampleBatch, blank: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Return the source's own status of each value; a null counts as `not_available`. blank: where one may be null."""
    if batch.status is None:
        said = np.full(blank.shape, ChannelStatus.GOOD, dtype=np.uint8)
    else:
        unknown = {status for row in batch.status for status in row} - set(STATUSES)
        if unknown:
            raise Rejected("wrong_unit", f"status '{min(unknown)[:40]}' is not one of {', '.join(STATUSES)}")
        said = np.array([[STATUSES[status] for status in row] for row in batch.status], dtype=np.uint8)
    for index, column in np.argwhere(blank & (said == ChannelStatus.GOOD)).tolist():
        if batch.amplitude[index][column] is None or batch.phase[index][column] is None:
            said[index, column] = ChannelStatus.NOT_AVAILABLE
    return said


def _channel_faults(batch: SampleBatch, size: NDArray[np.float64], wrong: NDArray[np.bool_]) -> list[Fault]:
    """Return why values that the source calls good are rejected. size: amplitudes 0-to-peak [m]."""
    faults = []
    for index, column in np.argwhere(wrong):
        channel, amplitude = batch.channels[column], size[index, column]
        if _is_too_large(amplitude):
            detail = f"channel {channel}: {amplitude:.4g} m is not between 0 and {LARGEST_AMPLITUDE} m"
            faults.append(Fault(int(index), "amplitude_out_of_range", detail))
        else:
            detail = f"channel {channel}: amplitude, phase and scatter must be sensible finite numbers"
            faults.append(Fault(int(index), "not_finite", detail))
    return faults


def _time_words(time: int) -> str:
    """Return the fault of a time [ns], and the unit in which it probably was meant."""
    meant = [unit for unit, factor in COARSER_UNITS.items() if EARLIEST_TIME <= time * factor < LATEST_TIME]
    hint = f": it looks like {meant[0]}, and must be nanoseconds since 1970" if meant else ""
    return f"time {time} ns is before 2000 or more than ten minutes ahead{hint}"


def _sample_faults(machine: Machine, time: NDArray[np.int64], speed: NDArray[np.float64], received_at: int) -> Iterator[Fault]:
    fastest = OVERSPEED * rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    latest = received_at + FUTURE_TOLERANCE
    fine = (speed >= 0.0) & (speed <= fastest) & (time >= EARLIEST_TIME) & (time <= latest)
    for index in np.flatnonzero(~fine).tolist():
        if not np.isfinite(speed[index]):
            yield Fault(index, "not_finite", "speed is not a finite number")
        elif not 0.0 <= speed[index] <= fastest:
            detail = (
                f"speed {rad_per_s_to_rpm(speed[index]):.6g} r/min is not between 0 and {rad_per_s_to_rpm(fastest):.6g} r/min"
            )
            yield Fault(index, "speed_out_of_range", detail)
        else:
            yield Fault(index, "time_out_of_range", _time_words(int(time[index])))
