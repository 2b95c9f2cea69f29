"""Comparison of two views of misalignment for a run: changed coefficients, or equivalent loads in the coupling.

The thesis sees misalignment as changed coefficients of a coupling and the bearings beside it; Sinha, Lees and Friswell (J.
Sound Vib. 272 (2004) 967) as synchronous forces and moments in the coupling that do not depend on speed. Each is fitted to the
run with everything else near what the baseline had, only unbalances free, and they are compared by the Bayesian information
criterion (Schwarz, Ann. Statist. 6 (1978) 461, doi:10.1214/aos/1176344136), beside the view that nothing has changed.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from msgspec.structs import replace

from estimator.fit.changed_coefficients import CLEAR, without_calibrated_coefficients
from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.machine.coupling_neighbours import neighbouring_bearings
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe, is_direct
from estimator.machine.parts import Coupling, EquivalentLoad, Unbalance
from estimator.machine.rules import ParameterRule
from estimator.phasors.measurement import Measurement
from estimator.phasors.noise import OUTLIER_CHANCE
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.coefficient_models import governing_models
from estimator.rotor.parameters import unknowns
from estimator.units import rpm_to_rad_per_s

RUN_SCATTER = 0.01
"""Relative rms difference of coefficients between runs of a machine to which nothing has happened, the baseline's own errors
included [-].
"""
LEAST_UNBALANCE_CHANGE = 0.1
"""Part of an unbalance below which its change is not mentioned [-]."""
FAR = 6.0
"""Largest move of a held coefficient that counts as no change, in units of the run-to-run scatter [-]."""
WIDE_LOAD = 100.0
"""Spread of an equivalent load in units of the largest unbalance force [-]: no limit in practice."""


@dataclass(frozen=True)
class View:
    """One explanation of a run.

    Attributes:
        name: Name of the view.
        identification: Fit under this view.
        unknowns: Number of fitted unknowns that are not held.
        criterion: Bayesian information criterion, smaller is better [-].
        moved: The held coefficient that went farthest from the baseline, if farther than it may; None otherwise.
    """

    name: str
    identification: Identification
    unknowns: int
    criterion: float
    moved: str | None


@dataclass(frozen=True)
class ModelComparison:
    """Views of one run, the best first.

    Attributes:
        coupling: Id of the coupling.
        elements: Names of the coupling and the bearings beside it.
        views: The views, the best first.
        preferred: Name of the best view; None if not clear.
        verdict: The verdict in words.
    """

    coupling: str
    elements: frozenset[str]
    views: tuple[View, ...]
    preferred: str | None
    verdict: str


def compare_misalignment(
    machine: Machine, measurement: Measurement, *, baseline: Identification, coupling: str, options: Options | None = None
) -> ModelComparison:
    """Compare "unchanged", "changed coefficients" and "equivalent load" at a coupling for a run after the baseline.

    Sources: thesis, Sinha, Lees and Friswell (2004), Schwarz (1978); module's docstring.

    Args:
        machine: The machine.
        measurement: Phasors of the run.
        baseline: Identification of the baseline.
        coupling: Id of the coupling.
        options: Options of the fits.

    Returns:
        The comparison.

    Raises:
        KeyError: The machine has no such coupling.
        ValueError: A coefficient follows the speed and cannot be held, or the channels are not the machine's.
        NotEnoughData: There are fewer measured numbers than unknowns.
        FitFailed: No start of a fit leads anywhere.
    """
    following = _speed_dependent_coefficients(machine)
    if following:
        raise ValueError(
            f"views can be compared only where coefficients are constant; {', '.join(following)} follow the speed"
        )
    found = next((one for one in machine.couplings if one.id == coupling), None)
    if found is None:
        raise KeyError(coupling)
    suspects = {f"coupling.{coupling}", *(f"bearing.{bearing}" for bearing in neighbouring_bearings(machine, found))}
    healthy = with_identified_values(without_calibrated_coefficients(machine), baseline)
    unchanged = _with_held_coefficients(healthy, baseline, set())
    views = [
        _view("unchanged", unchanged, measurement, baseline, set(), options),
        _view(
            "changed coefficients",
            _with_held_coefficients(healthy, baseline, suspects),
            measurement,
            baseline,
            suspects,
            options,
        ),
        _view("equivalent load", _with_equivalent_load(unchanged, found, baseline), measurement, baseline, set(), options),
    ]
    views.sort(key=lambda view: view.criterion)
    preferred, verdict = _verdict(views)
    return ModelComparison(
        coupling, frozenset(suspects), tuple(views), preferred, verdict + _unbalances_moved(views[0].identification, baseline)
    )


def _speed_dependent_coefficients(machine: Machine) -> list[str]:
    """List the names of the free coefficients that follow the speed."""
    coefficients = unknowns(machine, assemble_rotor(machine)).coefficients
    models = (one for one in governing_models(coefficients) if not one.model.constant)
    return sorted(coefficients[k].name for one in models for k in one.coefficients)


def _unbalances_moved(found: Identification, baseline: Identification) -> str:
    """Describe changes of unbalances, which are free in every view, beside the verdict."""
    moved = []
    for one in found.estimates:
        before = next((other for other in baseline.estimates if other.name == one.name), None)
        if one.quantity != "unbalance" or one.value is None or before is None or before.value is None:
            continue
        old, new = complex(before.value, before.imaginary or 0.0), complex(one.value, one.imaginary or 0.0)
        spread = math.hypot(one.standard_error or 0.0, before.standard_error or 0.0)
        if abs(new - old) > max(FAR * spread, LEAST_UNBALANCE_CHANGE * abs(old)):
            moved.append(f"{one.name} by {abs(new - old):.2g} kg m ({100 * abs(new - old) / abs(old):.0f} %)")
    return f"; unbalance has changed: {', '.join(moved)}" if moved else ""


def with_identified_values(machine: Machine, baseline: Identification) -> Machine:
    """Return the machine with the values and the noise of an identification in place of the nominal ones.

    Coefficients that follow the speed keep their nominal values.

    Args:
        machine: The machine.
        baseline: Its identification.

    Returns:
        The machine with these values.
    """
    values = {
        name: math.exp(value) if is_direct(name) else float(value)
        for name, value in zip(baseline.coordinates, baseline.point, strict=True)
    }

    def updated(kind: str, part: Any) -> Any:
        own = {
            name: values[f"{kind}.{part.id}.{name}"]
            for name in type(part).model_fields
            if f"{kind}.{part.id}.{name}" in values
        }
        return part.model_copy(update=own)

    discs = []
    for disc in machine.discs:
        stem = f"disc.{disc.id}.unbalance"
        if f"{stem}.real" in values:
            unbalance = complex(values[f"{stem}.real"], values[f"{stem}.imaginary"])
            known = Unbalance(magnitude=abs(unbalance), angle_deg=math.degrees(np.angle(unbalance)))
            disc = disc.model_copy(update={"unbalance": known})
        discs.append(disc)
    return machine.model_copy(
        update={
            "bearings": tuple(updated("bearing", one) for one in machine.bearings),
            "couplings": tuple(updated("coupling", one) for one in machine.couplings),
            "seals": tuple(updated("seal", one) for one in machine.seals),
            "pedestals": tuple(updated("pedestal", one) for one in machine.pedestals),
            "discs": tuple(discs),
            "noise": baseline.noise.model_copy(update={"estimated": False}),
        }
    )


def _with_held_coefficients(machine: Machine, baseline: Identification, free: set[str]) -> Machine:
    """Return the machine with all constant coefficients kept near their values but those of the free elements."""
    rules = tuple(ParameterRule(names=name, spread=RUN_SCATTER) for name in _constant_coefficients(baseline, free))
    return machine.model_copy(update={"parameters": (*machine.parameters, *rules)})


def _constant_coefficients(baseline: Identification, free: set[str]) -> list[str]:
    """List the names of constant coefficients, but for those of the free elements."""
    said = {name: describe(name) for name in baseline.coordinates}
    return [name for name, one in said.items() if one.term is not None and one.knot is None and one.element not in free]


def _moves(found: Identification, baseline: Identification, free: set[str]) -> dict[str, float]:
    """Compute the move of each held coefficient from the baseline, in units of the run-to-run scatter."""
    moves = {}
    for name in _constant_coefficients(baseline, free):
        before, after = (float(one.point[one.coordinates.index(name)]) for one in (baseline, found))
        size = 1.0 if is_direct(name) else abs(before)
        moves[name] = (after - before) / (RUN_SCATTER * size) if size > 0.0 else 0.0
    return moves


def _with_equivalent_load(machine: Machine, coupling: Coupling, baseline: Identification) -> Machine:
    unbalances = [d.unbalance.magnitude for d in machine.discs if d.unbalance is not None]
    force = WIDE_LOAD * max(unbalances, default=1.0) * baseline.speed_maximum**2
    force = force or WIDE_LOAD * rpm_to_rad_per_s(machine.speed_range.maximum_rpm) ** 2
    load = EquivalentLoad(force_spread=force, moment_spread=force * machine.shaft(coupling.driver).length)
    couplings = tuple(c.model_copy(update={"load": load}) if c.id == coupling.id else c for c in machine.couplings)
    return machine.model_copy(update={"couplings": couplings})


def _view(
    name: str,
    machine: Machine,
    measurement: Measurement,
    baseline: Identification,
    free: set[str],
    options: Options | None,
) -> View:
    found = identify(machine, measurement, replace(options or Options(), explain=False))
    phasors = int(np.count_nonzero(measurement.usable))
    # What was left out must cost a view as much as the worst noise would.
    left_out = 2 * math.log(phasors / OUTLIER_CHANCE) * sum(found.outliers.values())
    moves = _moves(found, baseline, free)
    unknowns = len(found.coordinates) - len(moves)
    cost = found.chi_square + left_out + math.fsum(move**2 for move in moves.values())
    farthest = max(moves, key=lambda name: abs(moves[name]), default=None)
    moved = None if farthest is None or abs(moves[farthest]) <= FAR else farthest
    return View(name, found, unknowns, cost + unknowns * math.log(2 * phasors), moved)


def _verdict(views: list[View]) -> tuple[str | None, str]:
    best, second = views[0], views[1]
    margin = second.criterion - best.criterion
    if not best.identification.accepted:
        return None, f"none of the views explains the run; the best is {best.name}: {best.identification.verdict}"
    if best.moved is not None:
        return None, f"none of the views explains the run: something else has changed, most of all {best.moved}"
    if best.name != "unchanged" and next(v for v in views if v.name == "unchanged").criterion - best.criterion <= CLEAR:
        return None, f"no clear change: {best.name} is better than unchanged by {margin:.1f} only, {CLEAR:g} would be clear"
    if margin <= CLEAR:
        return None, f"{best.name} or {second.name}: the run does not tell them apart, the criteria differ by {margin:.1f}"
    return best.name, f"{best.name}: better than {second.name} by {margin:.1f}, above {CLEAR:g} is clear"
