"""Slow-roll vectors of a machine in versions, captured from samples or given; one version is in force."""

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Literal, Self

import numpy as np
from fastapi import APIRouter, Body, Request, Response, status
from pydantic import BaseModel, ConfigDict, Field, model_validator
from sqlalchemy.orm import Session

from estimator.field_types import Identifier
from estimator.machine.document import Machine
from estimator.phasors.slow_roll import SlowRoll, capture
from estimator.strict_model import StrictModel
from estimator.units import METRES, PEAK, RADIANS, rad_per_s_to_rpm, rpm_to_rad_per_s
from service.api.conventions.dependencies import MachineId, Reading, database, moment, requester
from service.api.conventions.paging import ById
from service.api.conventions.preconditions import IfMatch, require, tagged
from service.api.conventions.problems import RESPONSES, WAIT, Unsuitable
from service.api.conventions.times import Time
from service.identification import job_options
from service.runs.run_samples import largest_read
from service.security.requirement import ANALYST, OPERATOR, VIEWER
from storage.clock import to_datetime
from storage.encoding.sample_blocks import Samples
from storage.findings.job_order import RECOMPUTED
from storage.machines import machines, slow_roll
from storage.machines.slow_roll import CAPTURED, GIVEN, Provenance
from storage.measurements import runs, samples
from storage.tables.machines import SlowRollRow

router = APIRouter(prefix="/machines/{machine_id}/slow-roll", tags=["slow roll"], responses=RESPONSES, dependencies=[VIEWER])

LONGEST_CAPTURE_S = 7 * 86_400
"""Longest time range of a capture [s]: temperature and load move the shaft."""
MICROMETRES = METRES["um"] * PEAK["peak-to-peak"]


class VectorIn(StrictModel):
    """A slow-roll vector of one channel, given by a person."""

    amplitude_um_pp: float = Field(ge=0, le=2e4, allow_inf_nan=False, description="peak-to-peak [µm]")
    phase_lag_deg: float = Field(ge=-3600, le=3600, allow_inf_nan=False, description="lag behind the keyphasor [°]")
    standard_error_um_pp: float = Field(
        default=0.0, ge=0, le=2e4, allow_inf_nan=False, description="rms of the vector's error, peak-to-peak [µm]"
    )


class SlowRollIn(StrictModel):
    """Vectors to store: `vectors`, or `band_rpm` with the run or the time range to capture them from."""

    model_config = ConfigDict(populate_by_name=True)

    vectors: dict[Identifier, VectorIn] | None = Field(default=None, min_length=1)
    direction: Literal["positive", "negative"] | None = Field(
        default=None, description="sense of rotation of given vectors; by default the machine's"
    )
    band_rpm: tuple[float, float] | None = Field(default=None, description="lowest and highest speed of the capture [r/min]")
    run: int | None = Field(default=None, ge=0, le=2**62)
    first: Time | None = Field(default=None, alias="from")
    last: Time | None = Field(default=None, alias="to")
    comment: str = Field(default="", max_length=2000)

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if (self.vectors is None) == (self.band_rpm is None):
            raise ValueError("give either vectors, or band_rpm with a run or a time range")
        times = self.first is not None, self.last is not None
        if self.vectors is not None and (self.run is not None or any(times)):
            raise ValueError("a run or a time range goes with band_rpm, not with vectors")
        if self.band_rpm is not None:
            if (self.run is not None) == any(times) or any(times) != all(times):
                raise ValueError("band_rpm needs either a run, or both from and to")
            if not 0.0 < self.band_rpm[0] < self.band_rpm[1] < 1e6:
                raise ValueError("band_rpm needs two positive speeds, the lower one first")
            if self.direction is not None:
                raise ValueError("direction goes with given vectors; samples know theirs")
        return self


class VectorOut(BaseModel):
    """A slow-roll vector of one channel, or the reason why it is missing or must not be used."""

    amplitude_um_pp: float | None = None
    phase_lag_deg: float | None = None
    standard_error_um_pp: float | None = None
    left_out: str | None = Field(default=None, description="why the vector is not subtracted under the document in force")


class SlowRollOut(BaseModel):
    """One version of a machine's slow-roll vectors."""

    machine: str
    version: int
    in_force: bool
    created_at: datetime
    origin: str = Field(description="given or captured")
    direction: str = Field(description="the vectors are of this sense of rotation; in the other one they are conjugated")
    vectors: dict[str, VectorOut]
    speed_minimum_rpm: float | None
    speed_maximum_rpm: float | None
    first: datetime | None
    last: datetime | None
    comment: str


class SlowRollList(BaseModel):
    """Versions of a machine's slow-roll vectors, newest first."""

    machine: str
    in_force: int | None
    versions: list[SlowRollOut]


class VersionInForce(BaseModel):
    """The version of slow-roll vectors that identifications of a machine subtract."""

    machine: str
    version: int | None = Field(description="null: none")


class InForce(StrictModel):
    """The version that identifications subtract from now on."""

    version: int | None = Field(ge=1, le=2**62, description="null: none")
    identify_again: int = Field(
        default=0, ge=0, le=1000, description="number of newest runs that are identified again with it"
    )


@router.get("", operation_id="list_slow_roll")
def list_slow_roll(session: Reading, machine_id: MachineId, paging: ById) -> SlowRollList:
    """List all versions, newest first, with the number of the one in force."""
    rows = slow_roll.versions(session, machine_id, limit=paging.wanted, after=paging.after)
    return _listed(session, machine_id, paging.page(rows, lambda row: (row.version,)))


def _listed(session: Session, machine_id: str, rows: Sequence[SlowRollRow]) -> SlowRollList:
    in_force = machines.get(session, machine_id).slow_roll_version
    document = machines.document(session, machine_id)
    return SlowRollList(machine=machine_id, in_force=in_force, versions=[_rendered(row, document, in_force) for row in rows])


@router.post("", operation_id="add_slow_roll", dependencies=[ANALYST], status_code=status.HTTP_201_CREATED)
def add_slow_roll(request: Request, machine_id: MachineId, body: Annotated[SlowRollIn, Body()]) -> SlowRollOut:
    """Store vectors, given or captured from stored samples, as a new version. It is not in force yet."""
    with database(request).reading() as session:  # a capture reads days of samples, which no writer should wait for
        found = _given(session, machine_id, body) if body.vectors else _captured(session, machine_id, body)
    with database(request).transaction() as session:
        in_force = machines.get(session, machine_id).slow_roll_version
        row = slow_roll.add(session, found.document, found.vectors, found.provenance, reasons=found.reasons)
        return _rendered(row, machines.document(session, machine_id), in_force)


@router.get("/in-force", operation_id="read_slow_roll_in_force")
def read_in_force(session: Reading, response: Response, machine_id: MachineId) -> VersionInForce:
    """Read which version identifications subtract, with the ETag that a change needs."""
    return tagged(response, _in_force(session, machine_id))


@router.put("/in-force", operation_id="put_slow_roll_in_force", dependencies=[OPERATOR], responses=WAIT)
def put_in_force(
    request: Request, response: Response, machine_id: MachineId, body: Annotated[InForce, Body()], if_match: IfMatch = None
) -> SlowRollList:
    """Set the version that identifications subtract from now on. Baselines hold identifications of one version only.

    If-Match and ETag are those of GET on this address. Answers 429 and changes nothing while the quota of waiting
    identifications is used up.
    """
    with database(request).transaction() as session:
        require(if_match, _in_force(session, machine_id))
        slow_roll.put_in_force(session, machine_id, body.version)
        revision = machines.get(session, machine_id).revision
        if body.identify_again:
            newest = runs.newest_closed(session, machine_id, revision=revision, limit=body.identify_again)
            person = requester(request, RECOMPUTED)
            if len(newest) > person.quota.at_once:
                raise Unsuitable(f"identify_again: no more than {person.quota.at_once} runs may wait to be identified again")
            for run in newest:
                job_options.request_identification(session, run.id, job_options.Request(), person)
    with database(request).reading() as session:
        tagged(response, _in_force(session, machine_id))
        return _listed(session, machine_id, slow_roll.versions(session, machine_id, limit=100))


def _in_force(session: Session, machine_id: str) -> VersionInForce:
    return VersionInForce(machine=machine_id, version=machines.get(session, machine_id).slow_roll_version)


@dataclass(frozen=True)
class _Found:
    """Vectors of a new version. document: the one in force when they were measured; reasons: per channel without a vector."""

    document: Machine
    vectors: SlowRoll
    provenance: Provenance
    reasons: Mapping[str, str] | None = None


def _given(session: Session, machine_id: str, body: SlowRollIn) -> _Found:
    document = machines.document(session, machine_id)
    given = body.vectors or {}
    unknown = sorted(set(given) - set(document.channels))
    if unknown:
        raise Unsuitable(f"machine '{machine_id}' has no channel {', '.join(unknown)}; it has {', '.join(document.channels)}")
    vector = np.full(len(document.probes), complex(np.nan, np.nan))
    error = np.full(len(document.probes), np.nan)
    for channel, one in given.items():
        column = document.channels.index(channel)
        vector[column] = cmath.rect(one.amplitude_um_pp * MICROMETRES, -one.phase_lag_deg * RADIANS["deg"])
        error[column] = one.standard_error_um_pp * MICROMETRES
    direction = document.direction if body.direction is None else {"positive": 1, "negative": -1}[body.direction]
    return _Found(document, SlowRoll(direction, vector, error), Provenance(GIVEN, body.comment))


def _captured(session: Session, machine_id: str, body: SlowRollIn) -> _Found:
    document, held = _stored(session, machine_id, body)
    lowest, highest = (rpm_to_rad_per_s(rpm) for rpm in body.band_rpm or (0.0, 0.0))
    which = (held.speed >= lowest) & (held.speed <= highest)
    found = capture(document, held.measurement(), lowest=lowest, highest=highest)
    time = held.time[which]
    provenance = Provenance(CAPTURED, body.comment, found.speed_minimum, found.speed_maximum, int(time.min()), int(time.max()))
    return _Found(document, found.slow_roll, provenance, found.reasons)


def _stored(session: Session, machine_id: str, body: SlowRollIn) -> tuple[Machine, Samples]:
    """Return the samples to capture from, and the document under which they were stored."""
    if body.run is not None:
        run = runs.get(session, body.run)
        held = runs.samples(session, body.run)
        if run.machine_id != machine_id:
            raise Unsuitable(f"run {body.run} is one of machine '{run.machine_id}', not of '{machine_id}'")
        if held is None:
            raise Unsuitable(f"run {body.run} is still open")
        return machines.document(session, machine_id, run.revision), held
    first, last = moment(body.first) or 0, moment(body.last) or 0
    if not first < last <= first + LONGEST_CAPTURE_S * 1_000_000_000:
        raise Unsuitable(f"from must be before to, by at most {LONGEST_CAPTURE_S // 86_400} days")
    revision = machines.get(session, machine_id).revision
    document = machines.document(session, machine_id, revision)
    channels, also = len(document.probes), machines.revisions_with_same_channels(session, machine_id, revision)
    return document, samples.between(
        session,
        machine_id,
        revision=revision,
        also=also,
        channels=channels,
        first=first,
        last=last,
        largest=largest_read(channels),
    )


def _rendered(row: SlowRollRow, document: Machine, in_force: int | None) -> SlowRollOut:
    left_out = slow_roll.doubtful(row, document)
    vectors = {channel: _vector(held, left_out.get(channel)) for channel, held in row.vectors.items()}
    vectors |= {channel: VectorOut(left_out=why) for channel, why in left_out.items() if channel not in vectors}
    return SlowRollOut(
        machine=row.machine_id,
        version=row.version,
        in_force=row.version == in_force,
        created_at=to_datetime(row.created_at),
        origin=row.origin,
        direction="positive" if row.direction > 0 else "negative",
        vectors=vectors,
        speed_minimum_rpm=None if row.speed_minimum is None else rad_per_s_to_rpm(row.speed_minimum),
        speed_maximum_rpm=None if row.speed_maximum is None else rad_per_s_to_rpm(row.speed_maximum),
        first=None if row.time_first is None else to_datetime(row.time_first),
        last=None if row.time_last is None else to_datetime(row.time_last),
        comment=row.comment,
    )


def _vector(held: dict[str, float], left_out: str | None) -> VectorOut:
    if "refused" in held:
        return VectorOut(left_out=left_out)
    vector = complex(held["real"], held["imaginary"])
    return VectorOut(
        amplitude_um_pp=abs(vector) / MICROMETRES,
        phase_lag_deg=-math.degrees(cmath.phase(vector)) % 360.0 % 360.0,
        standard_error_um_pp=held["standard_error"] / MICROMETRES,
        left_out=left_out,
    )
