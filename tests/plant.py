"""A small plant for the tests of storage and service: one machine's document, its messages, samples and identifications."""

import copy
import math
import time
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
import zenoh
from hypothesis import HealthCheck, settings
from sqlalchemy.orm import Session

from estimator.fit.estimates import Estimate
from estimator.fit.identification import Identification
from estimator.fit.validation.channel_sensitivity import ChannelEffects
from estimator.machine.document import Machine, parse_machine
from estimator.machine.film_parameter_names import load_balance
from estimator.machine.parameter_description import is_direct
from estimator.machine.rules import Noise
from estimator.phasors.channel_status import ChannelStatus
from estimator.rotor.condensation import condense
from estimator.units import rpm_to_rad_per_s
from formats.wire import WIRE_SCHEMA, Key, SampleBatch, encode_batch
from service.write_path.batch import ArrivedBatch
from storage.encoding.sample_blocks import Samples
from storage.findings import identifications, jobs
from storage.findings.identifications import Origin
from storage.tables.findings import IdentificationRow

Document = dict[str, Any]

SECOND = 1_000_000_000
START = 1_700_000_000 * SECOND
"""Time of the first sample [ns]: 14 November 2023, 22:13:20 UTC."""
CHANNELS = ("B2X", "B2Y", "B3X", "B3Y")
KEY = Key("plant-1", "pump-7")

few_examples = settings(
    max_examples=50, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
"""The same examples in every run."""


def document(**changes: Any) -> Document:
    """Two short shafts, two bearings and a disc on each, a coupling between them; four probes, the last in volts."""
    lateral = {"kxx": 2e6, "kxy": 1e5, "kyx": -1e5, "kyy": 3e6, "cxx": 2e3, "cxy": 0.0, "cyx": 0.0, "cyy": 2e3}
    disc = {"station": 0.3, "mass": 8.0, "diametral_inertia": 0.02, "polar_inertia": 0.04}
    return {
        "schema_version": 1,
        "id": KEY.machine,
        "plant": KEY.plant,
        "name": "Pump 7",
        "speed_range": {"minimum_rpm": 300, "maximum_rpm": 3000},
        "materials": {"steel": {"young_modulus": 2.1e11, "density": 7800.0, "poisson_ratio": 0.3}},
        "shafts": [
            {"id": name, "sections": [{"length": 0.6, "outer_diameter": 0.04, "material": "steel"}]} for name in ("S1", "S2")
        ],
        "element_length": 0.3,
        "discs": [
            {"id": "D1", "shaft": "S1", **disc, "unbalance": {"magnitude": 1e-3, "angle_deg": 30}},
            {"id": "D2", "shaft": "S2", **disc, "unbalance": {"magnitude": 2e-3, "angle_deg": 200}},
        ],
        "bearings": [
            {"id": f"B{number}", "shaft": shaft, "station": station, **lateral}
            for number, (shaft, station) in enumerate([("S1", 0.0), ("S1", 0.6), ("S2", 0.0), ("S2", 0.6)], start=1)
        ],
        "couplings": [{"id": "C1", "driver": "S1", "driven": "S2", **lateral, "k_phix": 1e4, "k_phiy": 1e4}],
        "probes": [
            {"id": "B2X", "shaft": "S1", "station": 0.6, "angle_deg": 0},
            {"id": "B2Y", "shaft": "S1", "station": 0.6, "angle_deg": 90},
            {"id": "B3X", "shaft": "S2", "station": 0.0, "angle_deg": 0, "sensitivity": 8000.0},
            {"id": "B3Y", "shaft": "S2", "station": 0.0, "angle_deg": 90, "sensitivity": 4000.0},
        ],
        **copy.deepcopy(changes),
    }


def machine(**changes: Any) -> Machine:
    """The machine of `document`."""
    return parse_machine(document(**changes))


def batch(
    rpm: Sequence[float] = (1000.0,), *, sequence: int = 0, start: int = START, step: int = SECOND, **changes: Any
) -> SampleBatch:
    """Consecutive samples at the speeds `rpm`, a second apart: 100 µm peak-to-peak at 30° lag on every channel."""
    count = len(rpm)
    values: dict[str, Any] = {
        "schema": WIRE_SCHEMA,
        "plant": KEY.plant,
        "machine": KEY.machine,
        "source": "monitor",
        "epoch": 1,
        "sequence": sequence,
        "channels": list(CHANNELS),
        "speed_unit": "rpm",
        "amplitude_unit": "um",
        "amplitude_kind": "peak-to-peak",
        "phase_convention": "lag",
        "phase_unit": "deg",
        "direction": "positive",
        "time_ns": [start + i * step for i in range(count)],
        "speed": list(rpm),
        "amplitude": [[100.0] * len(CHANNELS) for _ in rpm],
        "phase": [[30.0] * len(CHANNELS) for _ in rpm],
    }
    return SampleBatch(**(values | changes))


def sweep_rpm(first: float, last: float, count: int = 40) -> list[float]:
    """Speeds of a steady sweep [r/min]."""
    return list(map(float, np.linspace(first, last, count)))


def arrived(one: SampleBatch, *, received_at: int = START + 86_400 * SECOND) -> ArrivedBatch:
    """The batch as the ingest hands it to the write path."""
    return ArrivedBatch(one, KEY.samples, encode_batch(one), received_at)


def samples(count: int = 3, *, start: int = START, step: int = SECOND, rpm: Sequence[float] | None = None) -> Samples:
    """Samples of the machine, the first channel unusable throughout."""
    phasor = np.full((count, len(CHANNELS)), 5e-5 * np.exp(-1j * np.radians(30.0)))
    status = np.full((count, len(CHANNELS)), ChannelStatus.GOOD, np.uint8)
    status[:, 0] = ChannelStatus.NOT_AVAILABLE
    phasor[:, 0] = complex(np.nan, np.nan)
    speeds = np.linspace(1000.0, 2000.0, count) if rpm is None else np.asarray(rpm, dtype=float)
    return Samples(
        time=start + step * np.arange(count, dtype=np.int64),
        speed=rpm_to_rad_per_s(1.0) * speeds,
        direction=np.ones(count, np.int8),
        phasor=phasor,
        status=status,
        scatter=np.full(phasor.shape, np.nan),
        second=np.full(phasor.shape, complex(np.nan, np.nan)),
    )


def assert_same_samples(found: Samples, expected: Samples) -> None:
    """Equal to the bit, NaN with NaN."""
    for name in ("time", "speed", "direction", "phasor", "status", "scatter", "second", "conditions", "gap", "overall"):
        one, other = getattr(found, name), getattr(expected, name)
        assert one.dtype == other.dtype, name
        assert one.shape == other.shape, name
        assert one.tobytes() == other.tobytes(), name


@cache
def _blank_estimates() -> tuple[Estimate, ...]:
    train = condense(machine(), speed=np.array([100.0]), direction=np.array([1.0]))
    direct = tuple(
        Estimate(c.name, c.element, c.quantity, c.unit, c.expected, 0.01 * abs(c.expected), c.expected, c.expected)
        for c in train.unknowns.coefficients
    )
    planes = tuple(
        Estimate(p.name, p.element, "unbalance", p.unit, 1e-3, 1e-5, 9e-4, 1.1e-3, -5e-4, 2e-5)
        for p in train.unknowns.unbalances
    )
    return direct + planes


def _point(estimates: Sequence[Estimate], unknown: Sequence[str], coordinates: Sequence[str]) -> tuple[Any, Any]:
    """Values and covariance over coordinates: 1 % standard errors, wide ones of what is unknown."""
    stems = {one.name: one for one in _blank_estimates()}
    found = {one.name: one for one in estimates}
    value, error = [], []
    for name in coordinates:
        stem, _, part = name.rpartition(".") if name.endswith((".real", ".imaginary")) else (name, "", "")
        blank, one = stems[stem], found[stem]
        shown = blank if one.value is None else one
        held = shown.imaginary if part == "imaginary" else shown.value
        assert held is not None
        value.append(np.log(held) if is_direct(name) else held)
        size = 1.0 if is_direct(name) else abs(held) or 1e5
        error.append((3.0 if stem in unknown else 0.01) * size)
    return np.array(value), np.diag(np.square(error))


def _effects(coordinates: int) -> ChannelEffects:
    """Channels whose errors would not move the fit, and would be seen at once."""
    names = [f"probe.{c}.{what}.{part}" for c in CHANNELS for what in ("gain", "run_out") for part in ("real", "imaginary")]
    size = [1e-2 if ".gain." in name else 1e-7 for name in names]
    return ChannelEffects(
        names=tuple(names),
        bias=np.zeros((coordinates, len(names))),
        information=np.diag(np.array(size) ** -2.0),
        score=np.zeros(len(names)),
        phasors=(40,) * len(CHANNELS),
        amplitude=(5e-5,) * len(CHANNELS),
    )


def identification(
    factors: Mapping[str, float] | None = None, *, unknown: Sequence[str] = (), accepted: bool = True, **changes: Any
) -> Identification:
    """An outcome at the nominal values, 1 % standard error; `factors` on some parameters, `unknown` ones without a value."""

    def changed(one: Estimate) -> Estimate:
        common = (one.name, one.element, one.quantity, one.unit)
        if one.name in unknown or one.value is None:
            return Estimate(*common, None, None, None, None, reason="the data leave it uncertain by 200 % of its value")
        factor = (factors or {}).get(one.name, 1.0)
        value = one.value * factor
        imaginary = None if one.imaginary is None else one.imaginary * factor
        size = value if imaginary is None else math.hypot(value, imaginary)
        return Estimate(*common, value, one.standard_error, 0.98 * size, 1.02 * size, imaginary, one.imaginary_standard_error)

    estimates = tuple(changed(one) for one in _blank_estimates())
    coordinates = [one.name for one in estimates if one.quantity != "unbalance"]
    coordinates += [f"{one.name}.{part}" for one in estimates if one.quantity == "unbalance" for part in ("real", "imaginary")]
    point, covariance = _point(estimates, unknown, coordinates)
    values: dict[str, Any] = {
        "estimates": estimates,
        "coordinates": tuple(coordinates),
        "covariance": covariance,
        "point": point,
        "channel_effects": _effects(len(coordinates)),
        "chi_square": 123.0,
        "degrees_of_freedom": 120,
        "accepted": accepted,
        "verdict": "accepted: χ²/dof 1.02, expected 1 ± 0.13" if accepted else "the model does not fit the data",
        "condition_number": 321.0,
        "starts": 1,
        "iterations": 7,
        "samples": 40,
        "speed_minimum": 31.0,
        "speed_maximum": 314.0,
        "noise": Noise(),
        "outliers": {},
    }
    return Identification(**(values | changes))


def store_identification(
    session: Session,
    outcome: Identification,
    *,
    run_id: int,
    measured_at: int = START,
    scope: str = jobs.RUN,
    run_kind: str = "run-down",
    revision: int = 1,
    machine_id: str = KEY.machine,
) -> IdentificationRow:
    """Ask for an identification of a run, take the job and file this outcome."""
    job = jobs.enqueue(session, machine_id, scope=scope, run_ids=[run_id])
    assert job is not None
    jobs.finish(job, state=jobs.DONE)
    origin = Origin(
        machine_id=machine_id,
        revision=revision,
        job_id=job.id,
        scope=scope,
        run_kind=run_kind,
        run_ids=[run_id],
        measured_at=measured_at,
        options={"starts": 10, "seed": 0},
        code_version="0.1.0",
        load_balance=load_balance(outcome.coordinates),
    )
    return identifications.add(session, origin, outcome)


def sqlite_url(path: object) -> str:
    """URL of an SQLite file."""
    return f"sqlite:///{path}"


def listened_to(publisher: zenoh.Publisher) -> bool:
    """Return whether anybody subscribes to what it publishes."""
    return bool(publisher.matching_status.matching)  # type: ignore[attr-defined]  # zenoh's stub says that it is a bool


def wait_until(holds: Callable[[], bool], *, seconds: float = 60.0) -> None:
    """Wait until something holds; fails when it still does not after so long: with patience, as cores may be busy."""
    deadline = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < deadline, f"still not so after {seconds} s"
        time.sleep(0.01)
