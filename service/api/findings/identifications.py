"""Identifications and the jobs that compute them."""

from typing import Annotated

from fastapi import APIRouter, Body, Request, Response, status

from service.api.conventions.dependencies import MachineId, Number, Period, Reading, database, requester
from service.api.conventions.paging import ById, ByTime
from service.api.conventions.parameter_units import ParameterUnitChoice
from service.api.conventions.problems import RESPONSES, WAIT
from service.api.findings import rendering, schemas
from service.http.problem import Problem
from service.identification import job_options
from service.security.requirement import ANALYST, VIEWER
from storage.findings import derived, identifications, jobs
from storage.machines import machines

router = APIRouter(tags=["identifications"], responses=RESPONSES, dependencies=[VIEWER])


@router.get("/machines/{machine_id}/identifications", operation_id="list_identifications")
def list_identifications(
    session: Reading, machine_id: MachineId, period: Period, paging: ByTime
) -> list[schemas.IdentificationSummary]:
    """List identifications measured in a time range, newest first."""
    machines.get(session, machine_id)
    rows = identifications.of_machine(
        session, machine_id, first=period.first, last=period.last, limit=paging.wanted, after=paging.after
    )
    return [rendering.identification(row) for row in paging.page(rows, lambda row: (row.measured_at, row.id))]


@router.get("/identifications/{identification_id}", operation_id="read_identification")
def read_identification(
    session: Reading, identification_id: Number, units: ParameterUnitChoice, covariance: bool = False
) -> schemas.IdentificationDetail:
    """Read one identification with every estimate, its uncertainty, and the reason where there is none.

    Estimates and derived quantities are in the requested units, as trends are; the covariance is in SI.
    """
    row = identifications.get(session, identification_id)
    return schemas.IdentificationDetail(
        **rendering.identification(row).model_dump(),
        estimates=[rendering.estimate(one, units) for one in identifications.estimates(session, identification_id)],
        derived=[rendering.derived(one, units) for one in derived.of_identification(session, identification_id)],
        coordinates=row.coordinates if covariance else None,
        covariance=identifications.covariance(row).tolist() if covariance else None,
    )


@router.post(
    "/runs/{run_id}/identifications",
    operation_id="identify_run",
    dependencies=[ANALYST],
    status_code=status.HTTP_202_ACCEPTED,
    responses={409: {"model": Problem}, **WAIT},
)
def identify_run(
    request: Request, response: Response, run_id: Number, body: Annotated[schemas.IdentificationAsked, Body()]
) -> schemas.JobOut:
    """Identify a closed run again, or a run of dwells; the answer is the job, and its Location is the address of its progress.

    With the usual options the new identification, once accepted, replaces earlier ones of this run in trends and baselines.
    With others it is a variant beside them, which neither trends nor baselines use. That of a run of dwells is always one, and
    takes its samples as measured at constant speed. Answers 429 while the quota of waiting identifications is used up.
    """
    with database(request).transaction() as session:
        row = job_options.request_identification(session, run_id, job_options.Request(**body.model_dump()), requester(request))
    response.headers["Location"] = f"/api/v1/jobs/{row.id}"
    return rendering.job(row)


@router.get("/jobs/{job_id}", operation_id="read_job")
def read_job(session: Reading, job_id: Number) -> schemas.JobOut:
    """Read one identification job with its state: waiting, running, done, or failed with the reason."""
    return rendering.job(jobs.get(session, job_id))


@router.get("/machines/{machine_id}/jobs", operation_id="list_jobs")
def list_jobs(session: Reading, machine_id: MachineId, paging: ById) -> list[schemas.JobOut]:
    """List identification jobs, newest first, with their states and the reasons of failures."""
    machines.get(session, machine_id)
    rows = jobs.of_machine(session, machine_id, limit=paging.wanted, after=paging.after)
    return [rendering.job(row) for row in paging.page(rows, lambda row: (row.id,))]
