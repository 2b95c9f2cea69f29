"""Renders alerts and suppressions as answers of the API."""

from collections import OrderedDict
from collections.abc import Hashable, Sequence
from threading import Lock
from typing import Any

import msgspec

from service.advice.alert_advice import alert_advice, alert_message
from service.advice.site_texts import SiteTexts
from service.alerts.advice_message import Advice
from service.alerts.lifecycle import Severity
from service.api.alerts import schemas
from service.api.conventions.values import time_or_none
from service.api.findings.evidence import with_moved_in_per_cent
from storage.alerts.alerts import ListedAlert
from storage.clock import to_datetime
from storage.tables.alerting import AlertRow, SuppressionRow

MOST_WORDED = 4000
"""Alerts that are kept in JSON, of some 2 kB each."""


def alert(row: AlertRow, texts: SiteTexts) -> schemas.AlertOut:
    """Return an alert as the API shows it."""
    return schemas.AlertOut(**_fields(row, alert_advice(row, texts), texts))


def alert_json(row: ListedAlert, texts: SiteTexts) -> dict[str, Any]:
    """Return the fields of `AlertOut` as JSON has them, for lists that are encoded without a model."""
    advice = alert_advice(row, texts)
    return _fields(row, advice, texts) | {"advice": None if advice is None else advice.model_dump()}


class RenderedAlertCache:
    """Alerts in JSON as lists have them, in each language that was asked for: wording them takes longer than reading them.

    An alert is worded again when anything in its row has changed.
    """

    def __init__(self) -> None:
        self._worded: OrderedDict[Hashable, msgspec.Raw] = OrderedDict()
        self._lock = Lock()

    def all(self, rows: Sequence[ListedAlert], texts: SiteTexts) -> list[msgspec.Raw]:
        """Return the JSON of each alert, in the language of the texts, which are the site's."""
        places = [_row_place(row, texts) for row in rows]
        with self._lock:
            known = [self._worded.get(place) for place in places]
        found = [one or msgspec.Raw(msgspec.json.encode(alert_json(row, texts))) for one, row in zip(known, rows, strict=True)]
        with self._lock:
            for place, one in zip(places, found, strict=True):
                self._worded[place] = one
                self._worded.move_to_end(place)
            while len(self._worded) > MOST_WORDED:
                self._worded.popitem(last=False)
        return found


def _row_place(row: ListedAlert, texts: SiteTexts) -> Hashable:
    """Return what the JSON of an alert depends on; its evidence changes only together with its time of change."""
    return (
        texts.language,
        *(tuple(one) if type(one) is list else one for name, one in row._mapping.items() if name != "evidence"),
    )


def _fields(row: AlertRow | ListedAlert, advice: Advice | None, texts: SiteTexts) -> dict[str, Any]:
    return {
        "id": row.id,
        "machine": row.machine_id,
        "rule": row.rule,
        "element": row.element,
        "state": row.state,
        "condition": row.condition,
        "severity": Severity(row.severity).label,
        "latching": row.latching,
        "suppressions": row.suppressions,
        "message": alert_message(row, advice, texts),
        "advice": advice,
        "evidence": with_moved_in_per_cent(row.evidence, {}) if "moved" in row.evidence else row.evidence,
        "identification": row.identification_id,
        "measured_at": to_datetime(row.measured_at),
        "first_measured_at": to_datetime(row.first_measured_at),
        "opened_at": to_datetime(row.opened_at),
        "updated_at": to_datetime(row.updated_at),
        "closed_at": time_or_none(row.closed_at),
        "events": row.event_count,
    }


def suppression(row: SuppressionRow) -> schemas.SuppressionOut:
    """Return a suppression as the API shows it."""
    return schemas.SuppressionOut(
        id=row.id,
        machine=row.machine_id,
        kind=row.kind,
        rule=row.rule,
        element=row.element,
        since=to_datetime(row.since),
        until=time_or_none(row.until),
        until_cleared=row.until_cleared,
        by=row.by,
        comment=row.comment,
        ended_at=time_or_none(row.ended_at),
        ended_by=row.ended_by,
    )
