"""Kinds of findings of a diagnosis, each declared once: `FINDING_KINDS`.

To add one, write its changes (or its fault of the data) and its size here and declare it; the module of its group in
`service/monitoring/rules/` has its texts and limits.

The signs of misalignment are the thesis's (§5.7-5.8): direct and cross-coupled coefficients of the coupling and of the
bearings beside it grow together. A bearing or a coupling that changes alone is no misalignment; an unbalance moves no
coefficient; an error of a channel moves everything that this channel measures, in proportions that the fit itself can tell. Of
a train on oil films misalignment is what moves its bearings (`film_findings`).
"""

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from estimator.alignment.freed_coordinates import MovedCoordinates
from estimator.alignment.healthy_films import VISCOSITIES
from estimator.arrays import Complexes, Floats
from estimator.diagnosis.change_columns import RISE, ChangeColumns
from estimator.diagnosis.data_faults import heavy_loads, light_loads, lost_channels, many_outliers, misfit
from estimator.diagnosis.film_findings import (
    film_changes,
    film_size,
    moved_alignments,
    oil_size,
    oils,
    process_force_size,
    process_forces,
    settlement_size,
    settlements,
    wear_size,
    wears,
)
from estimator.diagnosis.finding_kind import BaselineValues, Cause, ChangeSize, ExpectedChange, FindingKind, SizePart
from estimator.diagnosis.growths import growth_parts, growth_quantities, growths
from estimator.diagnosis.low_stability import low_stability
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.coupling_neighbours import neighbouring_bearings
from estimator.machine.parameter_description import ROTATING_ERRORS, describe

UNEVEN = 0.04
"""Difference by which one element of a misaligned train may rise more than another, of logarithms [-]."""
UNBALANCE = 0.5
"""Expected change of an unbalance, in units of the machine's median one [-]."""
GAIN = 0.15
"""Expected change of a gain, each part [-]."""
ROTATING = {"rotating_offset": 1e-5, "rotating_angle": 1e-4}
"""Expected changes of a coupling's run-outs of bore and face, each part [m, rad]."""
USUAL_ROTATING = {"rotating_offset": 25e-6, "rotating_angle": 250e-6}
"""Run-outs that are usually allowed [m, rad]: a reading of 0.05 mm at the rim, and on a face of 200 mm (J. Piotrowski, Shaft
Alignment Handbook, 3rd ed., CRC Press 2006, ch. 5)."""
ROTATING_WORDS = {"rotating_offset": ("offset", "um", 1e6), "rotating_angle": ("angle", "urad", 1e6)}
"""Name, unit and factor of each run-out's size."""
FORM_SIGNIFICANCE = 2.0
"""Standard errors by which a coupling's lateral and angular stiffness must have risen differently to tell the form [-]."""


# --- misalignment, a coupling or a bearing by itself -------------------------------------------------------------------------


def _misalignments(columns: ChangeColumns) -> Iterator[ExpectedChange]:
    """Yield the common growth of each coupling and of the bearings beside it; on oil films what moves the bearings."""
    yield from moved_alignments(columns)
    for coupling in columns.machine.couplings:
        own = f"coupling.{coupling.id}"
        neighbours = [f"bearing.{bearing}" for bearing in neighbouring_bearings(columns.machine, coupling)]
        beside = [element for element in neighbours if columns.direct_terms(element, "stiffness").any()]
        if beside and columns.direct_terms(own, "stiffness").any():
            yield _misalignment(columns, own, beside)


def _misalignment(columns: ChangeColumns, own: str, beside: list[str]) -> ExpectedChange:
    elements = [own, *beside]
    together = RISE * sum(columns.growth(element) for element in elements)
    each = [UNEVEN * columns.growth(element) for element in elements]
    single = [column for element in elements for column in columns.single_coefficients(element)]
    variants = tuple(np.column_stack([together, *each, *more]) for more in ([], single))
    rising = np.stack([_mean_of(columns.direct_terms(element, "stiffness")) for element in elements])
    return ExpectedChange(own, variants, frozenset(elements), rising)


def _couplings(columns: ChangeColumns) -> Iterator[ExpectedChange]:
    return _single_elements(columns, [f"coupling.{one.id}" for one in columns.machine.couplings])


def _bearings(columns: ChangeColumns) -> Iterator[ExpectedChange]:
    yield from film_changes(columns)
    bearings = [f"bearing.{one.id}" for one in columns.machine.bearings]
    yield from _single_elements(columns, [*bearings, *(f"seal.{one.id}" for one in columns.machine.seals)])


def _pedestals(columns: ChangeColumns) -> Iterator[ExpectedChange]:
    return _single_elements(columns, [f"pedestal.{one.id}" for one in columns.machine.pedestals])


def _single_elements(columns: ChangeColumns, elements: Sequence[str]) -> Iterator[ExpectedChange]:
    """Yield the change of each element by itself, unless the document fixes all its coefficients or ties them to another's."""
    for element in elements:
        if columns.changes(element):
            yield ExpectedChange(element, columns.element_variants(element), frozenset([element]))


def _misalignment_size(cause: Cause, _baseline: BaselineValues) -> ChangeSize:
    """Return the mean growth of the elements' stiffness, with the growth of each stiffness and damping.

    Movements of bearings are left out: they are reported as a change of alignment.
    """
    found = growths(cause)
    if not found:
        return ChangeSize(None)
    stiffness = [one.per_cent for one in found if one.term != "damping"]
    return ChangeSize(float(np.mean(stiffness)), growth_quantities(found), parts=growth_parts(found, first=cause.element))


def _element_size(cause: Cause, baseline: BaselineValues) -> ChangeSize:
    """Return the surest of the growths of stiffness and damping, beside both."""
    found = growths(cause)
    if not found:
        return film_size(cause, baseline)
    surest = max(found, key=lambda one: (one.sigma, one.per_cent))
    return ChangeSize(surest.per_cent, growth_quantities(found), parts=growth_parts(found, first=surest.name))


def misalignment_form(cause: Cause) -> str | None:
    """Return the form of a misalignment, as far as a coupling's lateral and angular stiffness tell it.

    A parallel offset bends the coupling's elements sideways, an angular one tilts them (thesis §5.7): the stiffness that has
    clearly risen more decides.

    Args:
        cause: The misalignment.

    Returns:
        `parallel`, `angular` or `combined`; None where the data do not tell.
    """
    own = [described.term if (described := describe(name)).element == cause.element else None for name in cause.names]
    lateral = _mean_of([term is not None and term.direct and term.quantity == "stiffness" for term in own])
    angular = _mean_of([term is not None and term.direct and term.quantity == "angular stiffness" for term in own])
    if not lateral.any() or not angular.any():
        return None
    rises = np.stack([lateral, angular])
    value, spread = rises @ cause.change, rises @ cause.covariance @ rises.T
    error = np.sqrt(np.diag(spread))
    difference = float(value[0] - value[1])
    difference_error = math.sqrt(max(0.0, float(spread[0, 0] + spread[1, 1] - 2.0 * spread[0, 1])))
    if difference_error > 0.0 and abs(difference) > FORM_SIGNIFICANCE * difference_error:
        return "parallel" if difference > 0.0 else "angular"
    # Where one was not measured by itself, the two only rise together because they are believed to.
    measured = difference_error < float(min(value)) and bool(np.all(value > FORM_SIGNIFICANCE * error))
    return "combined" if measured else None


# --- unbalance ---------------------------------------------------------------------------------------------------------------


def _unbalances(columns: ChangeColumns) -> Iterator[ExpectedChange]:
    """Yield the change of the unbalance in each plane, in any direction."""
    planes = [one for one in columns.unknowns.unbalances if columns.knows(one.name)]
    median = float(np.median([columns.magnitude(one.name) for one in planes])) if planes else 0.0
    for plane in planes:
        size = UNBALANCE * max(median, columns.magnitude(plane.name))
        yield ExpectedChange(plane.element, (columns.complex_pair(plane.name, size),))


def _unbalance_size(cause: Cause, baseline: BaselineValues) -> ChangeSize:
    change = complex(_complex_changes(cause)[0])
    before = complex(*(baseline.quantities[name] for name in cause.names))
    after = before + change
    quantities = {
        "change_g_mm": 1e6 * abs(change),
        "change_deg": math.degrees(np.angle(change)) % 360.0,
        "before_g_mm": 1e6 * abs(before),
        "after_g_mm": 1e6 * abs(after),
        "after_deg": math.degrees(np.angle(after)) % 360.0,
    }
    part = _magnitude(f"{describe(cause.names[0]).whole}", "g mm", cause, 1e6)
    return ChangeSize(100.0 * abs(change) / max(abs(before), 1e-300), quantities, parts=(part,))


# --- what turns with a coupling ----------------------------------------------------------------------------------------------


def _rotating_errors(columns: ChangeColumns) -> Iterator[ExpectedChange]:
    """Yield the run-out of bore and face of each coupling: either of them, or both."""
    for coupling in columns.machine.couplings:
        element = f"coupling.{coupling.id}"
        pairs = tuple(
            columns.complex_pair(name, size)
            for name, size in ((f"{element}.{error}", size) for error, size in ROTATING.items())
            if columns.knows(name)
        )
        if pairs:
            yield ExpectedChange(element, (*pairs, np.concatenate(pairs, axis=1)) if len(pairs) > 1 else pairs)


def _rotating_size(cause: Cause, _baseline: BaselineValues) -> ChangeSize:
    """Return offset and angle with their directions, and how large they are beside what is usual."""
    quantities, usual = {}, []
    for name, change in zip(cause.names[::2], _complex_changes(cause).tolist(), strict=True):
        error = describe(name).quantity
        what, unit, factor = ROTATING_WORDS[error]
        quantities[f"{what}_{unit}"] = factor * abs(change)
        quantities[f"{what}_deg"] = math.degrees(np.angle(change)) % 360.0
        usual.append(abs(change) / USUAL_ROTATING[error])
    return ChangeSize(None, quantities, tolerance_per_cent=100.0 * max(usual))


# --- measuring channels ------------------------------------------------------------------------------------------------------


def _gains(columns: ChangeColumns) -> Iterator[ExpectedChange]:
    """Yield the change of gain and phase of each channel."""
    for probe in columns.machine.probes:
        name = f"probe.{probe.id}.gain"
        if columns.knows(name):
            yield ExpectedChange(f"probe.{probe.id}", (columns.complex_pair(name, GAIN),))


def _gain_size(cause: Cause, _baseline: BaselineValues) -> ChangeSize:
    """Return the change of gain and phase; a lost channel has none."""
    if not cause.names:
        return ChangeSize(None)
    gain = _complex_changes(cause)[0]
    quantities = {"gain_per_cent": 100.0 * (abs(1.0 + gain) - 1.0), "phase_deg": math.degrees(np.angle(1.0 + gain))}
    return ChangeSize(100.0 * abs(gain), quantities, parts=(_magnitude(describe(cause.names[0]).whole, "%", cause, 100.0),))


def _run_outs(columns: ChangeColumns) -> Iterator[ExpectedChange]:
    """Yield the change of the run-out of each channel."""
    for probe in columns.machine.probes:
        if columns.knows(f"probe.{probe.id}.run_out"):
            yield ExpectedChange(f"probe.{probe.id}", columns.run_outs([probe.id]))


def _bows(columns: ChangeColumns) -> Iterator[ExpectedChange]:
    """Yield the change of the run-outs of all channels of each shaft."""
    for shaft in columns.machine.shafts:
        probes = [probe.id for probe in columns.machine.probes if probe.shaft == shaft.id]
        known = [one for one in probes if columns.knows(f"probe.{one}.run_out")]
        if len(known) > 1:
            yield ExpectedChange(f"shaft.{shaft.id}", columns.run_outs(known))


def _run_out_size(cause: Cause, baseline: BaselineValues) -> ChangeSize:
    """Return the largest change of a run-out, of the channel's amplitude in the baseline."""
    channels = [describe(name).element_id for name in cause.names[::2]]
    sizes = np.abs(_complex_changes(cause))
    relative = [size / baseline.amplitudes[channel] for size, channel in zip(sizes, channels, strict=True)]
    largest = 2 * int(np.argmax(sizes))
    part = _magnitude(describe(cause.names[largest]).whole, "um", cause, 1e6, first=largest)
    return ChangeSize(100.0 * max(relative), {"largest_um": 1e6 * float(sizes.max())}, parts=(part,))


def _magnitude(name: str, unit: str, cause: Cause, factor: float, *, first: int = 0) -> SizePart:
    """Return the magnitude of the change of a complex quantity, whose components stand from `first` on.

    Its interval is that of the component along the change (GUM, JCGM 100:2008, 5.1.2), and never below zero.
    """
    pair = slice(first, first + 2)
    change = cause.change[pair]
    size = float(np.hypot(*change))
    along = change / max(size, 1e-300)
    error = math.sqrt(max(0.0, float(along @ cause.covariance[pair, pair] @ along)))
    half = CONFIDENCE_95 * error
    sigma = size / error if error > 0.0 else None
    return SizePart(name, unit, factor * size, factor * max(0.0, size - half), factor * (size + half), sigma)


def _complex_changes(cause: Cause) -> Complexes:
    """Return the changes of complex quantities, of which real and imaginary part stand one after the other."""
    return np.asarray(cause.change[::2] + 1j * cause.change[1::2])


def _mean_of(which: Sequence[bool] | Floats) -> Floats:
    """Return weights of the mean over the entries that are chosen; zeros where none is."""
    chosen = np.array(which, dtype=float)
    return np.asarray(chosen / max(1.0, float(chosen.sum())))


COEFFICIENTS = MovedCoordinates(coefficients=True)
FINDING_KINDS: tuple[FindingKind, ...] = (
    FindingKind(
        "misalignment",
        ("coupling",),
        "machine",
        changes=_misalignments,
        size=_misalignment_size,
        form=misalignment_form,
        ahead_of_chains=True,
    ),
    FindingKind(
        "coupling",
        ("coupling",),
        "machine",
        changes=_couplings,
        size=_element_size,
        moves=COEFFICIENTS,
        beyond_fits=True,
    ),
    FindingKind("bearing", ("bearing", "seal"), "machine", changes=_bearings, size=_element_size, moves=COEFFICIENTS),
    FindingKind("pedestal", ("pedestal",), "machine", changes=_pedestals, size=_element_size, fitted=True, moves=COEFFICIENTS),
    FindingKind("settlement", ("bearing",), "machine", changes=settlements, size=settlement_size, ahead_of_chains=True),
    FindingKind("wear", ("bearing",), "machine", changes=wears, size=wear_size, moves=MovedCoordinates(("clearance",))),
    FindingKind(
        "oil", ("machine",), "machine", changes=oils, size=oil_size, moves=MovedCoordinates(VISCOSITIES, of_all_elements=True)
    ),
    FindingKind(
        "process_force",
        ("static_load",),
        "machine",
        changes=process_forces,
        size=process_force_size,
        moves=MovedCoordinates(("force_x", "force_y")),
    ),
    FindingKind("light_load", ("bearing",), "machine", data_fault=light_loads),
    FindingKind("heavy_load", ("bearing",), "machine", data_fault=heavy_loads),
    FindingKind("low_stability", ("machine",), "machine", data_fault=low_stability),
    FindingKind(
        "unbalance",
        ("disc",),
        "machine",
        changes=_unbalances,
        size=_unbalance_size,
        linear=True,
        moves=MovedCoordinates(("unbalance",)),
    ),
    FindingKind(
        "rotating_coupling",
        ("coupling",),
        "machine",
        changes=_rotating_errors,
        size=_rotating_size,
        linear=True,
        left_out=True,
        moves=MovedCoordinates(ROTATING_ERRORS),
    ),
    FindingKind("bow", ("shaft",), "channels", changes=_bows, size=_run_out_size),
    FindingKind("run_out", ("probe",), "channels", changes=_run_outs, size=_run_out_size, linear=True, errors=("run_out",)),
    FindingKind("sensor", ("probe",), "channels", changes=_gains, size=_gain_size, data_fault=lost_channels, errors=("gain",)),
    FindingKind("misfit", ("machine",), "data", fit_fault=misfit),
    FindingKind("outliers", ("machine",), "data", data_fault=many_outliers),
)
"""Kinds of findings in the order in which they are named to people."""


def _by_kind(declared: Sequence[FindingKind]) -> Mapping[str, FindingKind]:
    found = {one.kind: one for one in declared}
    if len(found) < len(declared):
        raise ValueError(f"a finding kind is declared twice: {', '.join(one.kind for one in declared)}")
    return found


_BY_KIND = _by_kind(FINDING_KINDS)


def finding_kind(kind: str) -> FindingKind:
    """Return the declaration of a kind of finding.

    Args:
        kind: Name of the kind.

    Returns:
        The declaration.

    Raises:
        KeyError: There is none.
    """
    return _BY_KIND[kind]
