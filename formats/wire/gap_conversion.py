"""Conversion of a batch's gaps from their unit and sign to the place of the shaft along each probe's axis.

A probe looks at the shaft along its axis. Its gap is stored as the mean place of the shaft on that axis, towards the probe, as
vibration is. The zero is the probe's own, so that only changes have a meaning. A gap that cannot be converted is left out by
name, and the vibration beside it stays.
"""

import numpy as np

from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.units import METRES
from formats.wire.rejection import Fault, Rejected
from formats.wire.schema import SampleBatch
from storage.encoding.packing import on_grid

LARGEST_GAP = 0.02
"""No probe looks at a shaft from farther away [m]."""
TOWARDS = {"towards": 1.0, "away": -1.0}
"""Factor from a gap to the shaft's place, which grows towards the probe, by the way in which the gap grows [-]."""


def to_gap(batch: SampleBatch, machine: Machine) -> tuple[Floats, list[Fault]]:
    """Return the shaft's places (S, m) [m] in the document's channel order, NaN where there is none, and every fault.

    Raises Rejected for a unit that there is none of.
    """
    places = np.full((len(batch.time_ns), len(machine.probes)), np.nan)
    if batch.gap is None or batch.gap_unit is None:
        return places, []
    if batch.gap_unit != "V" and batch.gap_unit not in METRES:
        raise Rejected("wrong_unit", f"gap_unit '{batch.gap_unit[:40]}' is not one of {', '.join((*METRES, 'V'))}")
    channels = machine.channels
    columns = [channels.index(channel) for channel in batch.channels]
    probes = [machine.probes[column] for column in columns]
    signs = np.array([np.nan if one.gap_grows is None else TOWARDS[one.gap_grows] for one in probes])
    factors = np.array([_metres(batch.gap_unit, one.sensitivity) for one in probes])
    sent = np.array(batch.gap, dtype=float)  # null becomes NaN
    with np.errstate(over="ignore"):
        size = np.abs(sent) * factors
    faults = _undescribed(batch, signs, factors)
    for index, column in np.argwhere((size > LARGEST_GAP) & np.isfinite(signs)).tolist():
        told = f"a gap of {sent[index, column]:.4g} {batch.gap_unit} is {size[index, column]:.4g} m"
        detail = f"channel {batch.channels[column]}: {told}"
        faults.append(Fault(index, "gap_out_of_range", f"{detail}, at most {LARGEST_GAP} m: is its unit right?"))
    with np.errstate(invalid="ignore"):
        places[:, columns] = np.where(size <= LARGEST_GAP, sent * factors * signs, np.nan)
    return on_grid(places), faults


def as_sent(places: Floats, machine: Machine) -> Floats:
    """Return the gaps (S, m) [µm] that a source sends of the shaft's places [m], as the document says that they grow."""
    signs = np.array([np.nan if one.gap_grows is None else TOWARDS[one.gap_grows] for one in machine.probes])
    return np.asarray(places * signs / METRES["um"])


def _metres(unit: str, sensitivity: float | None) -> float:
    """Return the factor from a unit to metres; NaN where a probe's sensitivity is not known."""
    if unit == "V":
        return np.nan if sensitivity is None else 1.0 / sensitivity
    return METRES[unit]  # type: ignore[index]


def _undescribed(batch: SampleBatch, signs: Floats, factors: Floats) -> list[Fault]:
    """Return what the document lacks for the conversion of a batch's gaps, once for all of its samples."""
    faults = []
    told = np.isfinite(np.array(batch.gap, dtype=float)).any(axis=0)
    unsigned = [channel for channel, sign, gap in zip(batch.channels, signs, told, strict=True) if gap and np.isnan(sign)]
    if unsigned:
        detail = (
            f"gaps need the document's `gap_grows`, away or towards, of the probes {', '.join(unsigned)}; they are left out"
        )
        faults.append(Fault(0, "gap_undescribed", detail))
    unscaled = [channel for channel, one, gap in zip(batch.channels, factors, told, strict=True) if gap and np.isnan(one)]
    if unscaled:
        detail = f"gaps in V need a sensitivity [V/m] in the document for {', '.join(unscaled)}; they are left out"
        faults.append(Fault(0, "gap_undescribed", detail))
    return faults
