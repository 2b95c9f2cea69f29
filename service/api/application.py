"""The web application: all routers over one database."""

from collections.abc import Callable
from importlib.metadata import version

from fastapi import APIRouter, FastAPI
from fastapi_offline import FastAPIOffline

from service.api import (
    alerts,
    baselines,
    bode,
    comparisons,
    dashboard,
    deviations,
    diagnoses,
    drawing,
    event_stream,
    fleet,
    identifications,
    ingestion,
    limits,
    machine_state,
    machines,
    measurements,
    metrics,
    model,
    operations,
    orbits,
    run_quality,
    slow_roll,
    stages,
    subscriptions,
    suppressions,
    trends,
)
from service.api.body_size import BodySize
from service.api.event_stream import Broadcaster
from service.api.idempotency import Idempotency
from service.api.kept_answers import KeptAnswers
from service.api.machine_list import MachineList
from service.api.openapi import described
from service.api.operations import Parts
from service.api.problems import add_handlers
from service.api.subscriptions import TryOut
from service.api.trend_columns import KeptHistories
from service.settings import DEFAULT_BASELINE_RUNS
from service.submissions import Submissions
from storage.database import Database

PREFIX = "/api/v1"


def application(
    database: Database,
    parts: Parts,
    *,
    try_out: TryOut | None = None,
    submissions: Submissions | None = None,
    depth: Callable[[], int] | None = None,
    baseline_runs: int = DEFAULT_BASELINE_RUNS,
) -> FastAPI:
    """The application over a database. `parts` tells how each part of the service is doing; `try_out` sends a test message
    to a subscription, where this process delivers; `submissions` takes samples, `depth` tells how many messages wait, where
    this process stores. baseline_runs: as in the settings.

    The documentation page is served without any other host: plants have no internet.
    """
    app = FastAPIOffline(
        title="Rundown",
        version=version("rundown"),
        description="Condition monitoring of coupled rotor trains: runs, identifications, parameter trends, alerts.",
        docs_url=f"{PREFIX}/docs",
        redoc_url=f"{PREFIX}/redoc",
        openapi_url=f"{PREFIX}/openapi.json",
        static_url=f"{PREFIX}/docs/static",
    )
    app.state.database = database
    app.state.parts = parts
    app.state.try_out = try_out
    app.state.submissions = submissions
    app.state.depth = depth
    app.state.machine_list = MachineList()
    app.state.answers = KeptAnswers()
    app.state.histories = KeptHistories(database, baseline_runs=baseline_runs)
    app.state.baseline_runs = baseline_runs
    app.state.broadcaster = Broadcaster(database)
    add_handlers(app)
    app.add_middleware(Idempotency, database=database)
    app.add_middleware(BodySize)
    router = APIRouter(prefix=PREFIX)
    for part in (
        machines,
        fleet,
        machine_state,
        slow_roll,
        measurements,
        ingestion,
        orbits,
        run_quality,
        drawing,
        comparisons,
        identifications,
        model,
        bode,
        trends,
        diagnoses,
        event_stream,
        alerts,
        suppressions,
        baselines,
        deviations,
        limits,
        subscriptions,
        operations,
        stages,
    ):
        router.include_router(part.router)
    app.include_router(router)
    app.include_router(metrics.router)
    app.include_router(dashboard.router)
    app.openapi = lambda: described(app)  # type: ignore[method-assign]
    return app
