"""Comparison of a later identification with one while the machine was healthy, beside what else has happened to it.

A worn bearing, other oil or a probe that reads otherwise would pass for a change of alignment. So what a diagnosis of the two
names is found first, and what it has moved is not held at the baseline's, as in alerts.
"""

from collections.abc import Sequence
from dataclasses import replace

from msgspec import structs

from estimator.alignment.alignment_comparison import AlignmentComparison, compared_alignment
from estimator.alignment.healthy_films import learnt_variation
from estimator.diagnosis.alignment_size import MISALIGNMENT
from estimator.diagnosis.film_reference import film_observation
from estimator.diagnosis.finding_kind import Cause
from estimator.diagnosis.moving_causes import moving_causes
from estimator.diagnosis.observation import Observation, observed_fit
from estimator.diagnosis.open_channels import estimate_beside
from estimator.diagnosis.run_windows import RunWindows
from estimator.fit.identification import Identification
from estimator.machine.document import Machine
from estimator.updated_model.model import UpdatedModel, updated_model


def compared_identifications(
    machine: Machine, baseline: Identification, later: Identification, coupling: str
) -> AlignmentComparison:
    """Compare a coupling's alignment in one identification with that in another, as command and library do.

    Args:
        machine: The machine, whose bearings are described by their films.
        baseline: Its identification while it was healthy.
        later: A later one.
        coupling: Id of the coupling.

    Returns:
        The comparison, with what a static load that both fits doubt does to the loads on films, and with the other causes that
        a diagnosis of the two names.

    Raises:
        ValueError: An identification is of another machine, or no elevation of its bearings is identified.
    """
    before = _model(machine, baseline)
    plain = compared_alignment([before], _model(machine, later), coupling)
    others = [one for one in _causes(machine, before, baseline, later) if one.kind != MISALIGNMENT]
    if not others:
        return plain
    named = tuple((one.kind, one.element) for one in others)
    beside = _model(machine, later, named)
    return replace(compared_alignment([before], beside, coupling, causes=moving_causes(named)), others=named)


def _model(machine: Machine, one: Identification, named: Sequence[tuple[str, str]] = ()) -> UpdatedModel:
    """Return the model of an identification, with errors of channels that are named, or that it has found along, free."""
    own, effects = updated_model(machine, one), one.channel_effects  # of another machine this says what it lacks
    if effects is None:
        return own
    point, covariance = estimate_beside(one.point, one.covariance, effects, named, channels=machine.channels)
    return updated_model(machine, structs.replace(one, point=point, covariance=covariance))


def _causes(machine: Machine, before: UpdatedModel, baseline: Identification, later: Identification) -> tuple[Cause, ...]:
    """Return what a diagnosis of the later identification names, with the other one as its baseline."""
    variation = learnt_variation([before])
    windows = RunWindows.from_baseline(machine, [_observed(machine, baseline)], variation=variation)
    return windows.found([_observed(machine, later)], on_delay=lambda _kind, _element: 1).causes


def _observed(machine: Machine, one: Identification) -> Observation:
    return film_observation(observed_fit(one), machine, {})
