"""Methods of conditions, by which clients act on alerts: each is a change of an alert's life under the client's name.

Source: OPC 10000-9, 5.5 to 5.8 and the result codes there. Acknowledge, Confirm, Reset and shelving need the role operator,
AddComment analyst, as over HTTP; the audit trail has the change in the same transaction, and refusals.
"""

import asyncio
import logging
import math
from collections.abc import Callable
from typing import Any

from asyncua import ua
from asyncua.server.internal_server import InternalServer
from sqlalchemy.exc import DBAPIError
from sqlalchemy.orm import Session

from service.alerts import transitions
from service.alerts.lifecycle import Forbidden
from service.alerts.transitions import LONGEST_SHELVING_NS, MomentRefused, Person
from service.opcua.alert_conditions import AlertConditions
from service.opcua.alert_reading import AlertReading
from service.opcua.client_session import current
from service.opcua.condition_state import LONGEST_SHELVING_MS, alert_and_event
from service.security.principal import Principal
from service.security.repeated_entries import RepeatedEntries
from service.security.role import Role
from service.security.store import AuditedTransactions
from storage.alerts import alerts
from storage.alerts.alerts import AlertUnknown
from storage.clock import now
from storage.database.engine import Database
from storage.operation import audit
from storage.operation.audit import AuditedOperation
from storage.tables.alerting import AlertRow

logger = logging.getLogger(__name__)

LONGEST_COMMENT = 2000
WORSE = ("raised", "severity_changed")
"""Events after which an acknowledgement of what was before is none of what is."""
AlertOperation = Callable[[Session, AlertRow, Person], None]


class CallRefused(Exception):
    """A method's call is refused with a status code."""

    def __init__(self, code: int) -> None:
        super().__init__(code)
        self.status = ua.StatusCode(code)


class ConditionMethods:
    """The methods of all conditions."""

    def __init__(self, database: Database, conditions: AlertConditions) -> None:
        self._database = database
        self._conditions = conditions
        self._repeated = RepeatedEntries(database)

    def link(self, server: InternalServer) -> None:
        """Let the methods of the standard's types end here: conditions share them."""
        ids = ua.ObjectIds
        linked = {
            ids.AcknowledgeableConditionType_Acknowledge: self.acknowledge,
            ids.AcknowledgeableConditionType_Confirm: self.confirm,
            ids.ConditionType_AddComment: self.add_comment,
            ids.AlarmConditionType_Reset: self.reset,
            ids.ShelvedStateMachineType_TimedShelve: self.timed_shelve,
            ids.AlarmConditionType_ShelvingState_TimedShelve: self.timed_shelve,
            ids.ShelvedStateMachineType_Unshelve: self.unshelve,
            ids.AlarmConditionType_ShelvingState_Unshelve: self.unshelve,
            ids.ShelvedStateMachineType_OneShotShelve: self.one_shot_shelve,
            ids.AlarmConditionType_ShelvingState_OneShotShelve: self.one_shot_shelve,
            ids.ConditionType_ConditionRefresh: self.refresh,
            ids.ConditionType_ConditionRefresh2: self.refresh,
        }
        for number, method in linked.items():
            server.isession.add_method_callback(ua.NodeId(number), method)

    async def acknowledge(self, parent: ua.NodeId, *given: ua.Variant) -> ua.StatusCode:
        """Acknowledge an alert, as it was at an event, with a comment."""
        return await self._of_event(parent, given, "acknowledge_alert", transitions.acknowledge)

    async def confirm(self, parent: ua.NodeId, *given: ua.Variant) -> ua.StatusCode:
        """Reset a latched alert, with a comment."""
        return await self._of_event(parent, given, "reset_alert", transitions.reset)

    async def add_comment(self, parent: ua.NodeId, *given: ua.Variant) -> ua.StatusCode:
        """Add a comment to an alert."""
        return await self._of_event(parent, given, "comment_alert", transitions.comment, role=Role.ANALYST)

    async def reset(self, parent: ua.NodeId, *given: ua.Variant) -> ua.StatusCode:
        """Reset a latched alert."""
        del given
        return await self._done(parent, "reset_alert", lambda session, row, person: transitions.reset(session, row, person))

    async def timed_shelve(self, parent: ua.NodeId, *given: ua.Variant) -> ua.StatusCode:
        """Shelve an alert for some time [ms]."""
        try:
            (duration,) = _typed(given, (int | float,))
        except CallRefused as refused:
            return refused.status
        if not math.isfinite(duration) or not 0 < duration <= LONGEST_SHELVING_MS:
            return ua.StatusCode(ua.StatusCodes.BadShelvingTimeOutOfRange)

        return await self._shelved(parent, round(duration * 1e6))

    async def unshelve(self, parent: ua.NodeId, *given: ua.Variant) -> ua.StatusCode:
        """End a shelving."""
        del given
        return await self._done(parent, "unshelve_alert", transitions.unshelve)

    async def one_shot_shelve(self, parent: ua.NodeId, *given: ua.Variant) -> ua.StatusCode:
        """Shelve an alert until its cause is gone, at most for the longest time."""
        if given:
            return ua.StatusCode(ua.StatusCodes.BadTooManyArguments)
        return await self._shelved(parent, LONGEST_SHELVING_NS, until_cleared=True)

    async def _shelved(self, parent: ua.NodeId, duration: int, *, until_cleared: bool = False) -> ua.StatusCode:
        def shelve(session: Session, row: AlertRow, person: Person) -> None:
            transitions.shelve(session, row, person, until=now() + duration, until_cleared=until_cleared)

        return await self._done(parent, "shelve_alert", shelve)

    async def refresh(self, parent: ua.NodeId, *given: ua.Variant) -> ua.StatusCode:
        """Send every open alert to one of the session's subscriptions, or to one item of it."""
        del parent
        values = [one.Value for one in given]
        found = current.get().subscriptions.get(values[0]) if values else None
        if found is None:
            return ua.StatusCode(ua.StatusCodes.BadSubscriptionIdInvalid)
        item = values[1] if len(values) > 1 else None
        if item is not None and item not in found.monitored_item_srv._monitored_items:
            return ua.StatusCode(ua.StatusCodes.BadMonitoredItemIdInvalid)
        await self._conditions.refresh(found, item)
        return ua.StatusCode()

    async def _of_event(
        self,
        parent: ua.NodeId,
        given: tuple[ua.Variant, ...],
        operation: str,
        change: AlertOperation,
        *,
        role: Role = Role.OPERATOR,
    ) -> ua.StatusCode:
        try:
            identifier, comment = _typed(given, (bytes | None, ua.LocalizedText | None))
            words = _comment(comment)
            if operation == "comment_alert" and not words.strip():
                raise CallRefused(ua.StatusCodes.BadInvalidArgument)
        except CallRefused as refused:
            return refused.status
        return await self._done(parent, operation, change, comment=words, identifier=identifier, by_event=True, role=role)

    async def _done(
        self,
        parent: ua.NodeId,
        operation: str,
        change: AlertOperation,
        *,
        comment: str = "",
        identifier: bytes | None = None,
        by_event: bool = False,
        role: Role = Role.OPERATOR,
    ) -> ua.StatusCode:
        """Apply a change to the alert of a condition. by_event: whether the call names the event that it acts on."""
        session = current.get()
        alert = self._conditions.of(parent) if session.sees(parent) else None
        if alert is None:
            return ua.StatusCode(ua.StatusCodes.BadNodeIdUnknown)
        entry = AuditedOperation(session.principal.in_full, session.address, operation, _target(alert), "done")
        if session.principal.role is None or session.principal.role < role:
            await asyncio.to_thread(self._note_refusal, entry)
            return ua.StatusCode(ua.StatusCodes.BadUserAccessDenied)
        named = alert_and_event(identifier)
        if by_event and (named is None or named[0] != alert.id):
            return ua.StatusCode(ua.StatusCodes.BadEventIdUnknown)
        try:
            made = _AlertChange(alert.id, named[1] if named is not None else None, change, comment, operation)
            await asyncio.to_thread(made.make, self._database, session.principal, entry)
        except CallRefused as refused:
            return refused.status
        except DBAPIError as error:
            logger.error("%s over OPC UA of %s: %s", operation, _target(alert), error.orig)
            return ua.StatusCode(ua.StatusCodes.BadResourceUnavailable)
        return ua.StatusCode()

    def _note_refusal(self, entry: AuditedOperation) -> None:
        refused = AuditedOperation(entry.who, entry.address, entry.operation, entry.target, "refused")
        self._repeated.write()
        if self._repeated.first(refused):
            with self._database.transaction() as session:
                audit.append(session, refused)


class _AlertChange:
    """A change of an alert. event: the event that the client acted on; None where the call names none."""

    def __init__(self, alert: int, event: int | None, change: AlertOperation, comment: str, operation: str) -> None:
        self._alert, self._event, self._change = alert, event, change
        self._comment, self._operation = comment, operation

    def make(self, database: Database, who: Principal, entry: AuditedOperation) -> None:
        """Make it, with its entry in the audit trail. Raises CallRefused, DBAPIError."""
        try:
            with AuditedTransactions(database, who.plants, entry).transaction() as session:
                row = alerts.get(session, self._alert, to_change=True)
                self._require_known(session)
                self._change(session, row, Person(who.name, self._comment))
        except AlertUnknown:
            raise CallRefused(ua.StatusCodes.BadNodeIdUnknown) from None
        except MomentRefused:
            raise CallRefused(ua.StatusCodes.BadShelvingTimeOutOfRange) from None
        except Forbidden as forbidden:
            logger.info("%s over OPC UA by %s is refused: %s", self._operation, who.name, forbidden)
            raise CallRefused(_FORBIDDEN[self._operation]) from None

    def _require_known(self, session: Session) -> None:
        """Refuse to acknowledge an unknown event, or an alert that has become worse since the event."""
        if self._event is None:
            return
        found = alerts.history(session, self._alert)
        newer = [one for one in found if one.id > self._event and one.kind in WORSE]
        if (newer and self._operation == "acknowledge_alert") or all(one.id != self._event for one in found):
            raise CallRefused(ua.StatusCodes.BadEventIdUnknown)


_FORBIDDEN = {
    "acknowledge_alert": ua.StatusCodes.BadConditionBranchAlreadyAcked,
    "reset_alert": ua.StatusCodes.BadInvalidState,
    "shelve_alert": ua.StatusCodes.BadConditionAlreadyShelved,
    "unshelve_alert": ua.StatusCodes.BadConditionNotShelved,
    "comment_alert": ua.StatusCodes.BadInvalidState,
}
"""Answer to a change that the alert's state does not allow."""


def _typed(given: tuple[ua.Variant, ...], types: tuple[Any, ...]) -> list[Any]:
    """Return the values of a method's arguments. Raises CallRefused where their number or types are wrong."""
    if len(given) < len(types):
        raise CallRefused(ua.StatusCodes.BadArgumentsMissing)
    if len(given) > len(types):
        raise CallRefused(ua.StatusCodes.BadTooManyArguments)
    values = [one.Value for one in given]
    if any(not isinstance(value, kind) or isinstance(value, bool) for value, kind in zip(values, types, strict=True)):
        raise CallRefused(ua.StatusCodes.BadInvalidArgument)
    return values


def _comment(given: ua.LocalizedText | None) -> str:
    words = "" if given is None else given.Text or ""
    if len(words) > LONGEST_COMMENT or "\x00" in words:
        raise CallRefused(ua.StatusCodes.BadInvalidArgument)
    return words


def _target(alert: AlertReading) -> str:
    return f"OPC UA alert {alert.id}, {alert.machine}: {alert.name}"
