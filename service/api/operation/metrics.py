"""`GET /metrics`: the state of the service as OpenMetrics text for a monitoring system.

The counts are stored, and a restart does not reset them.
"""

import heapq
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import get_args

from fastapi import APIRouter, Request, Response
from fastapi.concurrency import run_in_threadpool
from prometheus_client.core import CollectorRegistry, CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.openmetrics.exposition import CONTENT_TYPE_LATEST, generate_latest
from prometheus_client.registry import Collector
from sqlalchemy.exc import DBAPIError

from formats.wire import InternalErrorReason, Reason
from service.api.conventions.dependencies import database
from service.api.operation.health import health_report
from service.security.requirement import VIEWER
from service.security.store import Store
from storage.alerts import deliveries
from storage.clock import now
from storage.database.claim import DatabaseUnusable
from storage.database.errors import is_database_wide
from storage.findings import jobs
from storage.measurements import quarantine, samples
from storage.measurements.samples import Totals

router = APIRouter(tags=["operations"], dependencies=[VIEWER])

LARGEST_MACHINE_COUNT = 1_000
"""Largest number of machines with a label of their own."""
SILENT_S = 3600.0
"""Time without samples after which a machine counts as silent [s]; examples/monitoring/rundown-rules.yml uses the same."""
OTHERS = "*"
"""Label of all further machines together; no machine can have it as its id."""


@dataclass(frozen=True)
class _StoreFigures:
    """Figures from the store; empty while it does not answer."""

    totals: list[Totals] = field(default_factory=list)
    ages: Mapping[str, float] = field(default_factory=dict)
    silent: int | None = None
    rejected: Mapping[str, int] = field(default_factory=dict)
    jobs: Mapping[str, int] = field(default_factory=dict)
    deliveries: Mapping[str, int] = field(default_factory=dict)


class _Figures(Collector):
    """One scrape: metric families from figures that were read before."""

    def __init__(self, kept: _StoreFigures, parts: Mapping[str, str], gauges: Mapping[str, float]) -> None:
        self._totals = kept.totals
        self._sample_ages = kept.ages
        self._silent = kept.silent
        self._rejected = kept.rejected
        self._by_state = kept.jobs
        self._deliveries = kept.deliveries
        self._parts = parts
        self._gauges = gauges

    def collect(self) -> Iterable[Metric]:
        """Return the families, in the order in which they are written."""
        received = CounterMetricFamily("rundown_samples_received", "samples stored", labels=["machine"])
        duplicates = CounterMetricFamily("rundown_samples_duplicate", "samples that came again", labels=["machine"])
        late = CounterMetricFamily("rundown_samples_late", "samples older than what was known", labels=["machine"])
        lost = GaugeMetricFamily("rundown_samples_lost", "samples that never came; some may yet", labels=["machine"])
        age = GaugeMetricFamily(
            "rundown_newest_sample_age_seconds", "since the newest sample was taken, by its source's clock", labels=["machine"]
        )
        for one in self._totals:
            labels = [one.machine_id]
            received.add_metric(labels, one.received)
            duplicates.add_metric(labels, one.duplicates)
            late.add_metric(labels, one.late)
            lost.add_metric(labels, one.lost)
        # Not of the first ones by id, as the counts are: an alarm must see who is silent.
        for machine, seconds in heapq.nlargest(LARGEST_MACHINE_COUNT, self._sample_ages.items(), key=lambda one: one[1]):
            age.add_metric([machine], seconds)
        yield from (received, duplicates, late, lost, age)
        rejected = CounterMetricFamily("rundown_rejected", "messages, samples and values not taken", labels=["reason"])
        for reason, count in self._rejected.items():
            rejected.add_metric([reason], count)
        yield rejected
        by_state = GaugeMetricFamily("rundown_identification_jobs", "identification jobs", labels=["state"])
        for state, count in self._by_state.items():
            by_state.add_metric([state], count)
        yield by_state
        on_their_way = GaugeMetricFamily("rundown_deliveries", "alert events on their way to subscribers", labels=["state"])
        for state, count in self._deliveries.items():
            on_their_way.add_metric([state], count)
        yield on_their_way
        if self._silent is not None:
            yield GaugeMetricFamily(
                "rundown_silent_machines", "machines of which nothing came for an hour", value=self._silent
            )
        works = GaugeMetricFamily(
            "rundown_part_ok", "1 while a part works: all of them, and samples can be taken", labels=["part"]
        )
        for part, words in self._parts.items():
            works.add_metric([part], int(words == "ok"))
        yield works
        for name, value in self._gauges.items():
            yield GaugeMetricFamily(name, _GAUGES[name], value=value)


_GAUGES = {
    "rundown_longest_transaction_seconds": "longest writing transaction of the last minute or two",
    "rundown_ingest_longest_cycle_seconds": "longest cycle of ingest of the last minute or two",
    "rundown_ingest_queue_messages": "messages from zenoh that wait",
    "rundown_ingest_queue_bytes": "size of the messages from zenoh that wait",
    "rundown_clock_doubted": "1 while this machine's own clock is behind, and live samples wait for it to be set",
    "rundown_http_queue_batches": "batches from HTTP that wait",
    "rundown_mqtt_samples_connected": "1 while samples can come from the MQTT broker",
    "rundown_mqtt_alerts_connected": "1 while alerts and trends can go to the MQTT broker",
    "rundown_mqtt_published": "messages that the broker has taken since the start",
    "rundown_mqtt_messages": "messages with samples that came from the broker since the start",
    "rundown_mqtt_messages_under_way": "of these, those that are being stored",
    "rundown_mqtt_messages_given_up": "of these, those that could not be taken; their samples count as missing",
    "rundown_sparkplug_messages_missing": "messages of Sparkplug nodes that never came, by counts modulo 256",
    "rundown_ingest_storing": "1 while samples can be stored",
    "rundown_database_answers": "1 while the database answers; otherwise only what needs none is shown",
    "rundown_store_damaged": "1 where damage of what is stored was met, until a check of all of it is clean",
    "rundown_database_bytes": "size of the database with its log",
    "rundown_disk_free_bytes": "free on the file system of the database",
    "rundown_disk_budget_bytes": "how large the database may become",
    "rundown_disk_used_ratio": "part of the budget or of the file system that is used, whichever is nearer to its end",
    "rundown_released_sample_blocks": "sample blocks that retention deleted since the start",
    "rundown_released_runs": "runs whose samples retention deleted since the start",
    "rundown_retention_waiting": "machines of which old samples wait for `rundown retention confirm`",
    "rundown_backup_age_seconds": "of the newest complete backup in the folder that is looked at; +Inf: there is none",
    "rundown_certificate_days_left": "until the first of the service's own certificates expires",
    "rundown_webhooks_unsigned": "active webhooks that receive nothing because their secret is unavailable",
    "rundown_stuck_identifications": "identifications whose process or Dask worker stopped answering, since the start",
    "rundown_audit_trail_holds": "1 while the newest entry that was seen before is still there as it was",
    "rundown_opcua_sessions": "clients of the OPC UA server",
    "rundown_opcua_monitored_items": "values and events that OPC UA clients watch",
    "rundown_housekeeping_working": "1 while old samples are deleted as they should be",
}


@router.get("/metrics", operation_id="read_metrics", response_class=Response)
async def read_metrics(request: Request) -> Response:
    """Read the counters and gauges as OpenMetrics text; while the database does not answer, those that do not need it."""
    state = request.app.state
    gauges = dict(state.gauges())
    if state.submissions is not None:
        gauges["rundown_http_queue_batches"] = len(state.submissions)
        gauges["rundown_ingest_storing"] = int(state.submissions.trouble is None)
    # Only the parts: the jobs that are counted there are of all plants, whoever asks.
    look = await health_report(request)
    parts, answers, kept = look.parts, look.answers, _StoreFigures()
    if answers:
        try:
            kept = await run_in_threadpool(_read_figures, database(request))
        except (DatabaseUnusable, DBAPIError) as error:
            answers = not is_database_wide(error) and not isinstance(error, DatabaseUnusable)
            parts["database"] = state.database.damage.trouble or str(error)
    gauges["rundown_database_answers"] = int(answers)
    gauges["rundown_store_damaged"] = int(state.database.damage.trouble is not None)
    registry = CollectorRegistry(auto_describe=False)
    registry.register(_Figures(kept, parts, gauges))
    return Response(generate_latest(registry), media_type=CONTENT_TYPE_LATEST)


def _read_figures(store: Store) -> _StoreFigures:
    with store.reading() as session:
        totals = samples.totals(session)
        by_state = _of_every(jobs.STATES, jobs.count(session))
        on_their_way = _of_every(deliveries.STATES, deliveries.counts(session))
        rejected = _of_every((*get_args(Reason), *get_args(InternalErrorReason)), quarantine.counts(session))
        ages = _sample_ages(totals)
        silent = sum(seconds > SILENT_S for seconds in ages.values())
        return _StoreFigures(_bounded(totals), ages, silent, rejected, by_state, on_their_way)


def _of_every(states: Iterable[str], counts: Mapping[str, int]) -> dict[str, int]:
    """Add states without entries as 0: a monitoring system sees no rise in a series that begins at 1."""
    return dict.fromkeys(states, 0) | dict(counts)


def _sample_ages(totals: list[Totals]) -> dict[str, float]:
    """Return the age of each machine's newest sample [s], where there is one."""
    moment = now()
    return {one.machine_id: (moment - one.last_time) / 1e9 for one in totals if one.last_time}


def _bounded(totals: list[Totals]) -> list[Totals]:
    """Return at most LARGEST_MACHINE_COUNT machines, and the sum of the others as one more."""
    shown, others = totals[:LARGEST_MACHINE_COUNT], totals[LARGEST_MACHINE_COUNT:]
    if others:
        received, duplicates, lost, late = (
            sum(getattr(one, name) for one in others) for name in ("received", "duplicates", "lost", "late")
        )
        shown.append(Totals(OTHERS, received, duplicates, lost, late, last_time=0))
    return shown
