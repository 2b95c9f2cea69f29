"""A fleet on oil films: every week through the gate, the real fit, and the service's own assessment, without a database."""

import time
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from benchmarks.alignment.film_histories import FilmHistory
from benchmarks.kept_outcomes import kept_or_computed
from estimator.diagnosis.observation import observed_fit
from estimator.fit.identification import Identification, Options
from estimator.identification.quality_gate import identify_gated
from estimator.machine.under_conditions import under_conditions
from estimator.phasors.channel_status import ChannelStatus
from estimator.phasors.measurement import Measurement
from estimator.phasors.recorded_run import RecordedRun
from service.alerts.lifecycle import Severity
from service.monitoring.assessment.alignment_steps import has_step
from service.monitoring.assessment.assess import assess
from service.monitoring.assessment.context import AssessedRun, AssessmentBasis, AssessmentContext, DiagnosedCause
from service.monitoring.rules.diagnosis_rules import cause_severity
from service.monitoring.rules.finding_catalogue import finding_rule
from service.monitoring.rules.limits import Limits
from tests.film_plant.arrays import Complexes, Floats
from tests.film_plant.condensed import CondensedTrain
from tests.film_plant.plant import Plant, noisy
from tests.film_plant.scatter import run_of
from tests.film_plant.statics import NoEquilibrium
from tests.film_plant.sweep import films_between

SAMPLES = 150
FILM_SPEEDS = 31
"""Speeds at which a run's films are solved; splines between them change phasors by less than a twentieth of the noise."""
OPTIONS = Options(starts=2)
WEEK_NS = 7 * 86_400 * 1_000_000_000
GAIN = 1.1


@dataclass(frozen=True)
class OpenedAlert:
    """An alert that was opened, or got worse.

    Attributes:
        week: Week in which it was.
        rule: Its rule.
        element: Its element.
        severity: Its severity.
        offset_um: Change of the vertical offset that it tells [µm]; None where it tells none.
    """

    week: int
    rule: str
    element: str
    severity: str
    offset_um: float | None


@dataclass(frozen=True)
class FleetRecord:
    """Record of what became of one machine.

    Attributes:
        seed, kind, happening, onset: Of its history.
        weeks: Weeks of it, the baseline's included.
        baseline: Runs of its baseline.
        refused: Weeks whose fit was refused.
        missed: Weeks without a run: it would whirl, or its journals touch.
        opened: Alerts that were opened or got worse.
        standing: Per week after the baseline, rule, element and severity of the alerts that stand.
        offsets: Per week the true change of the vertical offset against the baseline's mean, over what is allowed [-].
        told_um: Change of the vertical offset as told three runs after the onset [µm]; None where none is.
        true_um: The truth of that [µm].
        named: Rule and element of the right alert; None for none.
        processor_s: Processor time of fits and assessments [s].
    """

    seed: int
    kind: str
    happening: str
    onset: int
    weeks: int
    baseline: int
    refused: tuple[int, ...]
    missed: tuple[int, ...]
    opened: tuple[OpenedAlert, ...]
    standing: tuple[tuple[tuple[str, str, str], ...], ...]
    offsets: tuple[float, ...]
    told_um: float | None
    true_um: float
    named: tuple[str, str] | None
    processor_s: float


def record_of(history: FilmHistory, *, weeks: int) -> FleetRecord:
    """Return what became of a machine, computed where it is not kept."""
    return kept_or_computed(record_name(history, weeks=weeks), FleetRecord, partial(_lived, history, weeks))


def record_name(history: FilmHistory, *, weeks: int) -> str:
    """Return the name under which it is kept what became of a machine."""
    happens = history.happening if history.beside == "healthy" else f"{history.happening} and {history.beside}"
    return f"fleet, {history.kind}, {happens}, {history.seed}, {weeks} weeks, from {history.onset}"


class _Life:
    """A machine that lives from week to week: its runs, and the alerts that stand."""

    def __init__(self, history: FilmHistory) -> None:
        self.history = history
        self.rng = np.random.default_rng([history.seed, 2])
        self.runs: list[AssessedRun] = []
        self.first: Identification | None = None
        self.processor = 0.0
        self.standing: dict[tuple[str, str], Severity] = {}
        self.steps: dict[str, int] = {}
        self.since: dict[tuple[str, str], int] = {}
        self.opened: list[OpenedAlert] = []
        self.told: float | None = None
        self.missed: list[int] = []
        self.train: CondensedTrain | None = None

    def live(self, week: int) -> None:
        """Measure and identify one week's run, and assess it."""
        try:
            plant = run_of(self.history.plant_in(week), self.rng)
        except (RuntimeError, NoEquilibrium):
            self.missed.append(week)  # it whirls in such oil, or its journals touch: nobody runs it down
            return
        speed = plant.speeds(SAMPLES)
        phasor = noisy(self._phasors(plant, speed), self.rng)
        if self.history.happening == "gain" and week >= self.history.onset:
            phasor[:, self.history.number] *= GAIN
        conditions = self.history.conditions(week)
        began = time.process_time()
        found = self._identified(speed, phasor, conditions)
        if found is not None:
            self.runs.append(AssessedRun(week, week * WEEK_NS, conditions, observed_fit(found)))
            self._judge(week)
        self.processor += time.process_time() - began

    def _phasors(self, plant: Plant, speed: Floats) -> Complexes:
        """Compute a run's phasors without noise: films solved at some of its speeds, the train condensed once."""
        stiffness, damping = films_between(plant.films(plant.speeds(FILM_SPEEDS)), speed)
        if self.train is None or not self.train.is_of(plant.matrices):
            self.train = CondensedTrain(plant.matrices, speed)
        return self.train.phasors(stiffness=stiffness, damping=damping)

    def _identified(self, speed: Any, phasor: Any, conditions: dict[str, float | None]) -> Identification | None:
        machine = under_conditions(self.history.machine, conditions)
        measurement = Measurement.of(speed=speed, phasor=phasor)
        status = np.full(phasor.shape, ChannelStatus.GOOD, np.uint8)
        run = RecordedRun(None, speed, phasor, status, measurement.scatter, machine.channels)
        begin = None if self.first is None else self.first.point
        found = identify_gated(machine, [run], [measurement], options=OPTIONS, beginning=begin).identification
        if self.first is None and found is not None and found.accepted:
            self.first = found
        return found

    def _judge(self, week: int) -> None:
        accepted = [one for one in self.runs if one.fit.accepted]
        wanted = self.history.baseline
        baseline = accepted[:wanted]
        after = [one for one in self.runs if len(baseline) == wanted and one.id > baseline[-1].id]
        if not after or after[-1].id != week:
            return
        context = AssessmentContext(
            machine=self.history.machine,
            limits=Limits(),
            basis=AssessmentBasis(None, None),
            baseline=tuple(baseline),
            after=tuple(after),
            open_causes=tuple(self.standing),
            history=None,
            open_rates={},
            open_steps=self.steps,
        )
        diagnosis = assess(context).diagnosis
        if diagnosis is None:
            return
        now = {key: severity for key, severity in self.standing.items() if key not in diagnosis.gone}
        for one in diagnosis.causes:
            key = one.cause.kind, one.cause.element
            severity = _severity(one, self.standing.get(key))
            if severity is None:
                continue
            now[key] = severity
            if one.cause.kind == "misalignment":
                self._note_step(one, key)
            if severity > self.standing.get(key, 0):
                told = one.size.quantities.get("offset_vertical_um")
                rule = finding_rule(one.cause.kind).rule.name
                self.opened.append(OpenedAlert(week, rule, one.cause.element, severity.label, told))
            if one.cause.kind == "misalignment" and week == self.history.onset + 2:
                self.told = one.size.quantities.get("offset_vertical_um")
        self.standing = now
        self.steps = {element: began for element, began in self.steps.items() if ("misalignment", element) in now}
        self.since = {key: began for key, began in self.since.items() if key in now}

    def _note_step(self, one: DiagnosedCause, key: tuple[str, str]) -> None:
        """Note when a step of an alignment began, as the alert's evidence does."""
        first = min(one.began_at, self.since.get(key, one.began_at))
        self.since[key] = first
        self.steps.pop(one.cause.element, None)
        if has_step({"quantities": one.size.quantities}):
            self.steps[one.cause.element] = first


def _lived(history: FilmHistory, weeks: int) -> FleetRecord:
    life, standing = _Life(history), []
    for week in range(weeks):
        life.live(week)
        standing.append(
            tuple((finding_rule(kind).rule.name, element, one.label) for (kind, element), one in life.standing.items())
        )
    before = float(np.mean([history.offset(week) for week in range(history.baseline)]))
    return FleetRecord(
        seed=history.seed,
        kind=history.kind,
        happening=history.happening,
        onset=history.onset,
        weeks=weeks,
        baseline=history.baseline,
        refused=tuple(one.id for one in life.runs if not one.fit.accepted),
        missed=tuple(life.missed),
        opened=tuple(life.opened),
        standing=tuple(standing),
        offsets=tuple((history.offset(week) - before) / history.allowed.offset for week in range(weeks)),
        told_um=life.told,
        true_um=1e6 * (history.offset(history.onset + 2) - before),
        named=history.named,
        processor_s=life.processor,
    )


def _severity(one: DiagnosedCause, present: Severity | None) -> Severity | None:
    return cause_severity(
        Limits(),
        kind=one.cause.kind,
        element=one.cause.element,
        sigma=one.cause.distance,
        size=one.size,
        force=None,
        present=present,
    )
