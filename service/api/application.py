"""The web application: all routers over one database."""

import functools
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager

from anyio.to_thread import current_default_thread_limiter
from fastapi import APIRouter, Depends, FastAPI, Request
from fastapi_offline import FastAPIOffline
from starlette.routing import BaseRoute

from rotorundown.environment.release import VERSION
from service.advice.site_texts import SiteTexts
from service.api.alerts.event_stream import Broadcaster
from service.api.alerts.event_stream import router as event_stream
from service.api.alerts.rendering import RenderedAlertCache
from service.api.alerts.routes import lists as alert_lists
from service.api.alerts.routes import router as alerts
from service.api.alerts.subscriptions import SendTest
from service.api.alerts.subscriptions import router as subscriptions
from service.api.alerts.suppressions import router as suppressions
from service.api.cache.computed_cache import ComputedCache
from service.api.cache.known_requests import ResponseCacheMiddleware
from service.api.cache.model_process import AT_ONCE, ModelProcess
from service.api.cache.response_cache import ResponseCache
from service.api.conventions.changes_in_turn import HeldPlaces, wait_for_turn
from service.api.conventions.error_handlers import add_handlers
from service.api.conventions.extra_threads import another_thread
from service.api.conventions.request_places import READERS, WRITERS, RequestPlaces
from service.api.conventions.unknown_parameters import reject_unknown_parameters
from service.api.findings.alignment import router as alignment
from service.api.findings.bode import router as bode
from service.api.findings.comparisons import router as comparisons
from service.api.findings.deviations import router as deviations
from service.api.findings.diagnoses import router as diagnoses
from service.api.findings.film_coefficients import router as film_coefficients
from service.api.findings.gained_unbalance import router as gained_unbalance
from service.api.findings.identifications import router as identifications
from service.api.findings.model import router as model
from service.api.findings.shaft_line import router as shaft_line
from service.api.machines.balancings import router as balancings
from service.api.machines.baselines import router as baselines
from service.api.machines.calibrations import router as calibrations
from service.api.machines.fleet import router as fleet
from service.api.machines.limits import router as limits
from service.api.machines.machine_list import MachineList
from service.api.machines.machine_state import router as machine_state
from service.api.machines.model_calibrations import router as model_calibrations
from service.api.machines.overview import Overview
from service.api.machines.report import router as report
from service.api.machines.routes import router as machines
from service.api.machines.slow_roll import router as slow_roll
from service.api.machines.stability import router as stability
from service.api.machines.timeline import router as timeline
from service.api.machines.train_drawing import router as train_drawing
from service.api.measurements.ingestion import router as ingestion
from service.api.measurements.orbits import router as orbits
from service.api.measurements.routes import router as measurements
from service.api.measurements.run_quality import router as run_quality
from service.api.measurements.run_vectors import RunVectorCache
from service.api.measurements.vibration import router as vibration
from service.api.openapi import described
from service.api.operation.audit import router as audit
from service.api.operation.dashboard import router as dashboard
from service.api.operation.database_check import DatabaseCheck
from service.api.operation.documentation import add_documentation, add_openapi_document
from service.api.operation.health import Parts
from service.api.operation.health import router as health
from service.api.operation.metrics import router as metrics
from service.api.operation.replicas import router as replicas
from service.api.operation.stages import router as stages
from service.api.trends.columns import HistoryCache
from service.api.trends.filed import router as filed
from service.api.trends.routes import router as trends
from service.configuration.settings import DEFAULT_BASELINE_RUNS
from service.delivery.addresses import Network
from service.delivery.signing_secrets import SigningSecrets
from service.http.body_limit import BodyLimit
from service.http.compression import Compression
from service.http.conditional_get import ConditionalGet
from service.http.error_status import require_every_status
from service.http.fair_scheduling import FairScheduling
from service.http.head_requests import HeadRequests
from service.http.idempotency import Idempotency
from service.http.security_headers import SecurityHeaders
from service.identification.job_quota import JobQuota
from service.reports.report_process import ReportProcess
from service.resilience.rate_limit import RateLimit
from service.security.authentication import Authentication
from service.security.configuration import Security
from service.security.guard import AccessRules, Guard, RequestLimits
from service.security.login import router as login
from service.security.operations import Operations
from service.security.repeated_entries import RepeatedEntries
from service.security.requirement import Requirement
from service.security.scope import FREE, ScopedRows, Visibility
from service.write_path.http_queue import SubmissionSink
from storage.database.engine import Database
from storage.tables.alerting import AlertRow, DeliveryRow, SubscriptionRow, SuppressionRow
from storage.tables.findings import IdentificationRow, JobRow
from storage.tables.machines import BalancingRow, MachineRow, ModelCalibrationRow
from storage.tables.measurements import RunRow

PREFIX = "/api/v1"
THREADS = 6
"""Threads that serve requests: more of them would slow each other down."""
REPORTS = 16
"""Printed reports that are kept, of some 0.3 MB each."""
DOCUMENTATION = ("/docs/static",)
"""Public paths without a route of ours: they are equal in every installation and hold no data."""
ROWS: ScopedRows = {
    "machine_id": (MachineRow, "machine"),
    "job_id": (JobRow, "job"),
    "run_id": (RunRow, "run"),
    "identification_id": (IdentificationRow, "identification"),
    "balancing_id": (BalancingRow, "balancing"),
    "calibration_id": (ModelCalibrationRow, "calibration"),
    "alert_id": (AlertRow, "alert"),
    "suppression_id": (SuppressionRow, "suppression"),
    "subscription_id": (SubscriptionRow, "subscription"),
    "delivery_id": (DeliveryRow, "delivery"),
}
"""Table and subject of each path parameter. The application does not start with an undeclared one."""
OF_MACHINE = "GET /api/v1/machines/<id>"
LISTED: Mapping[str, str] = {
    "machine": ": GET /api/v1/machines lists those there are",
    "revision": f": {OF_MACHINE}/revisions lists them",
    "parameter": "",
    "run": f": {OF_MACHINE}/runs lists those of a machine",
    "balancing": f": {OF_MACHINE}/balancings lists those of a machine",
    "calibration": f": {OF_MACHINE}/model-calibrations lists those of a machine",
    "identification": f": {OF_MACHINE}/identifications lists them",
    "slow-roll vectors": f"; {OF_MACHINE}/slow-roll lists the versions",
    "job": f": {OF_MACHINE}/jobs lists those of a machine",
    "alert": ": GET /api/v1/alerts lists those there are",
    "suppression": f": {OF_MACHINE}/suppressions lists those in force",
    "subscription": ": GET /api/v1/subscriptions lists those there are",
    "key": ": `rundown key list` shows them",
    "delivery": ": GET /api/v1/subscriptions/<id>/deliveries lists them",
}
"""Hint on where existing objects are listed, by the subject of the missing one."""


def application(
    database: Database,
    parts: Parts,
    *,
    send_test: SendTest | None = None,
    submissions: SubmissionSink | None = None,
    baseline_runs: int = DEFAULT_BASELINE_RUNS,
    security: Security | None = None,
    job_quota: JobQuota | None = None,
    secrets: SigningSecrets | None = None,
    warnings: Callable[[], list[str]] = list,
    gauges: Callable[[], Mapping[str, float]] = dict,
    texts: SiteTexts | None = None,
    delivery_networks: tuple[Network, ...] = (),
    report_units: str = "um_pp,rpm",
) -> FastAPI:
    """Build the application over a database.

    parts: returns the state of each part of the service. send_test: sends a test message to a subscription, where this process
    delivers. submissions: takes samples. baseline_runs: as in the settings. security: access rules; by default open until
    there is an API key. job_quota: limit of waiting identifications asked for by people. secrets: signing secrets of webhooks;
    by default none can be stored. warnings: returns the service's warnings. gauges: returns figures of its parts for a
    monitoring system. texts: texts of findings; by default the service's own. delivery_networks: private ones to deliver to.
    report_units: units of reports that are asked for without any.

    The documentation page loads nothing from other hosts: plants have no internet.
    """
    require_every_status()
    app = _bare()
    app.state.database = database
    app.state.parts = parts
    app.state.database_check = DatabaseCheck(database)
    app.state.send_test = send_test
    app.state.submissions = submissions
    app.state.secrets = secrets or SigningSecrets()
    app.state.warnings = warnings
    app.state.gauges = gauges
    app.state.machine_list = MachineList()
    app.state.overview = Overview(database)
    app.state.reading_places, app.state.changing_places = RequestPlaces(READERS), RequestPlaces(WRITERS)
    app.state.computed_cache = ComputedCache(another_thread, long_at_once=AT_ONCE)
    app.state.model_process = ModelProcess()
    app.state.report_cache = ComputedCache(another_thread, entries=REPORTS)
    app.state.report_process = ReportProcess()
    app.state.response_cache = ResponseCache(database)
    app.state.worded_alerts = RenderedAlertCache()
    app.state.run_vectors = RunVectorCache()
    app.state.histories = HistoryCache(database, baseline_runs=baseline_runs)
    app.state.baseline_runs = baseline_runs
    app.state.job_quota = job_quota or JobQuota()
    app.state.texts = texts or SiteTexts()
    app.state.delivery_networks, app.state.report_units = delivery_networks, report_units
    app.state.broadcaster = Broadcaster(database, app.state.texts)
    add_handlers(app, LISTED)
    _handle_answers(app, database)
    _guard(app, database, security or Security())
    app.add_middleware(HeadRequests)  # around the guard, which knows each operation by its own method
    app.add_middleware(FairScheduling, at_once={f"{PREFIX}/alive"})
    app.openapi = lambda: described(app)  # type: ignore[method-assign]
    return app


def _handle_answers(app: FastAPI, database: Database) -> None:
    """Install what stands between the guard and the routes."""
    app.add_middleware(Idempotency, database=database, sealing=app.state.secrets.sealing)
    app.add_middleware(HeldPlaces)
    app.add_middleware(BodyLimit)
    app.add_middleware(Compression)
    app.add_middleware(ResponseCacheMiddleware, cached=app.state.response_cache.current)
    app.add_middleware(ConditionalGet)


def _bare() -> FastAPI:
    """Build an application with all routes and no state."""
    app = FastAPIOffline(
        title="Rundown",
        version=VERSION,
        description="Condition monitoring of coupled rotor trains: runs, identifications, parameter trends, alerts.",
        docs_url=None,
        redoc_url=None,
        openapi_url=f"{PREFIX}/openapi.json",
        static_url=f"{PREFIX}/docs/static",
        lifespan=_served,
        redirect_slashes=False,  # a redirect would go to the host named in the Host header
    )
    add_openapi_document(app, path=f"{PREFIX}/openapi.json")
    add_documentation(app, path=f"{PREFIX}/docs", files=f"{PREFIX}/docs/static", openapi=f"{PREFIX}/openapi.json")
    app.router.routes.extend(_routes())
    return app


def operations_of(app: FastAPI) -> Operations:
    """Return every route with its required role. Raises Undeclared."""
    anybody = Requirement(None, recorded=False)
    public = {PREFIX + path: anybody for path in DOCUMENTATION}
    return Operations(app, public=public, scoped=frozenset(ROWS), free=FREE)


def every_operation() -> Operations:
    """Return the operations of the application without building its state."""
    return operations_of(_bare())


async def _before_each(request: Request) -> None:
    """Do what comes before each operation; one dependency, as each costs a request some 0.05 ms."""
    await reject_unknown_parameters(request)
    await wait_for_turn(request)


@functools.cache
def _routes() -> list[BaseRoute]:
    """Build all routes once per process: the framework needs a tenth of a second for them."""
    router = APIRouter()
    # The most frequent first: a request is matched against the routes in this order.
    for part in (
        health,
        machines,
        fleet,
        trends,
        alert_lists,
        alerts,
        machine_state,
        slow_roll,
        calibrations,
        measurements,
        ingestion,
        orbits,
        run_quality,
        vibration,
        train_drawing,
        stability,
        report,
        comparisons,
        identifications,
        model,
        bode,
        shaft_line,
        film_coefficients,
        gained_unbalance,
        diagnoses,
        event_stream,
        suppressions,
        timeline,
        balancings,
        model_calibrations,
        baselines,
        deviations,
        alignment,
        limits,
        filed,
        subscriptions,
        replicas,
        stages,
        audit,
    ):
        # Not through another router: the framework rebuilds each operation for every level.
        router.include_router(part, prefix=PREFIX, dependencies=[Depends(_before_each)])
    router.include_router(metrics)
    router.include_router(dashboard)
    router.include_router(login)
    return router.routes


@asynccontextmanager
async def _served(app: FastAPI) -> AsyncIterator[None]:
    """Set up the resources of a running server and release them at its end."""
    current_default_thread_limiter().total_tokens = THREADS
    async with app.state.repeated.regular_writing():
        yield
    app.state.model_process.close()
    app.state.report_process.close()


def end_waiting(app: FastAPI) -> None:
    """End answers that would keep a server from stopping: event streams, models and reports that wait or are being made."""
    app.state.broadcaster.end()
    app.state.computed_cache.close()
    app.state.report_cache.close()
    app.state.model_process.close()
    app.state.report_process.close()


def _guard(app: FastAPI, database: Database, security: Security) -> None:
    """Install the guard in front of all routes. Raises Undeclared for a route without access rules."""
    app.state.security = security
    app.state.operations = operations_of(app)
    app.state.authentication = Authentication(database, tokens=security.tokens, required=security.required)
    app.state.visibility = Visibility(database, ROWS)
    app.state.failures = RateLimit(per_s=security.failures[0], burst=security.failures[1])
    app.state.repeated = RepeatedEntries(database)
    app.add_middleware(
        Guard,
        database=database,
        rules=AccessRules(
            app.state.operations,
            app.state.authentication,
            app.state.visibility,
            public_url=security.public_url,
            names_checked=security.names_checked,
        ),
        limits=RequestLimits(
            requests=RateLimit(per_s=security.requests[0], burst=security.requests[1]), failures=app.state.failures
        ),
        repeated=app.state.repeated,
    )
    app.add_middleware(SecurityHeaders)
