"""A client's session: it sees the nodes of its principal's plants, and no other session's subscriptions.

The library's sessions know no such limits; this one checks each service before the library's part of it runs.
"""

import asyncio
import secrets
from collections.abc import Callable, Sequence
from contextvars import ContextVar
from typing import Any, cast

from asyncua import ua
from asyncua.common.utils import ServiceError
from asyncua.server.internal_subscription import InternalSubscription

from service.opcua.browsing import MOST_REFERENCES, BrowsePage, Browsing
from service.opcua.client_users import ClientUser, named
from service.opcua.event_filter import ConditionFilter, EventFilterWrong
from service.opcua.issued_tokens import as_password
from service.opcua.own_subscriptions import OwnSubscriptions
from service.opcua.trend_history import TrendHistory
from service.security.principal import Principal

MOST_READ, MOST_BROWSED, MOST_CALLED = 10_000, 1_000, 100
"""Largest number of nodes that one request reads, browses, and calls methods of."""
MOST_ITEMS = 5_000
"""Largest number of monitored items of one session."""

current: ContextVar["ClientSession"] = ContextVar("opcua_session")
"""The session whose method call is being handled."""


class ClientSession(OwnSubscriptions):
    """A session of a client; the server that creates it sets the first four attributes, the library `user`."""

    visible: Callable[[Principal, ua.NodeId], bool]
    require_trusted: Callable[[bytes | None, str | None], None]
    history: TrendHistory
    browsing: Browsing
    user: Any

    def __init__(self, *arguments: Any, **named_arguments: Any) -> None:
        super().__init__(*arguments, **named_arguments)
        # The library counts its tokens: whoever guessed one could take the session over.
        self.iserver.unregister_external_session(self)
        self.auth_token = ua.NodeId(secrets.token_bytes(32), 0)
        self.iserver.register_external_session(self)
        self.application: str | None = None
        self.certificate: bytes | None = None

    @property
    def principal(self) -> Principal:
        """Return who uses the session. Raises ServiceError before that is known."""
        if not isinstance(self.user, ClientUser):
            raise ServiceError(ua.StatusCodes.BadSessionNotActivated)
        return self.user.principal

    @property
    def address(self) -> str:
        """Return the address that it comes from."""
        return str(self.name[0]) if isinstance(self.name, tuple) else "unknown"

    def sees(self, node: ua.NodeId) -> bool:
        """Return whether its principal may see a node."""
        return self.visible(self.principal, node)

    async def create_session(
        self, params: ua.CreateSessionParameters, sockname: tuple[str, int] | None = None
    ) -> ua.CreateSessionResult:
        """Create the session, and note the client's application."""
        self.application = params.ClientDescription.ApplicationUri
        return await super().create_session(params, sockname)

    def activate_session(
        self, params: ua.ActivateSessionParameters, peer_certificate: bytes | None
    ) -> ua.ActivateSessionResult:
        """Check the certificate of the channel and the user. Raises ServiceError."""
        # The channel's: the certificate that the client names when it creates the session proves nothing.
        self.require_trusted(peer_certificate, self.application)
        if ua.IssuedIdentityToken in self.iserver.supported_tokens:
            as_password(params, encrypted=bool(peer_certificate))
        before = self.user if isinstance(self.user, ClientUser) else None
        result = super().activate_session(params, peer_certificate)
        user = named(cast(ClientUser, self.user), self.application or "")
        if before is not None and before.principal != user.principal:
            self.user = before  # its subscriptions tell what that one may know
            raise ServiceError(ua.StatusCodes.BadIdentityChangeNotSupported)
        self.user, self.certificate = user, peer_certificate
        return result

    async def read(self, params: ua.ReadParameters) -> list[ua.DataValue]:
        """Read attributes; invisible nodes are answered like unknown ones."""
        _at_most(params.NodesToRead, MOST_READ)
        found = await super().read(params)
        unknown = ua.DataValue(StatusCode=ua.StatusCode(ua.StatusCodes.BadNodeIdUnknown))
        return [value if self.sees(one.NodeId) else unknown for one, value in zip(params.NodesToRead, found, strict=True)]

    async def write(self, params: ua.WriteParameters) -> list[ua.StatusCode]:
        """Refuse to write: clients change alerts by methods, and nothing else."""
        return [ua.StatusCode(ua.StatusCodes.BadNotWritable) for _ in params.NodesToWrite]

    async def browse(self, params: ua.BrowseParameters) -> list[ua.BrowseResult]:
        """List references in pages, without those to invisible nodes."""
        _at_most(params.NodesToBrowse, MOST_BROWSED)
        most = params.RequestedMaxReferencesPerNode
        return await self._pages([BrowsePage.first(one, most) for one in params.NodesToBrowse])

    async def browse_next(self, parameters: ua.BrowseNextParameters) -> list[ua.BrowseResult]:
        """List the references behind continuation points."""
        points = parameters.ContinuationPoints
        _at_most(points, MOST_BROWSED)
        if parameters.ReleaseContinuationPoints:
            return [ua.BrowseResult() for _ in points]
        wanted: list[BrowsePage | None] = []
        for one in points:
            try:
                wanted.append(BrowsePage.continued(one or b""))
            except ValueError:
                wanted.append(None)
        return await self._pages(wanted)

    async def _pages(self, wanted: Sequence[BrowsePage | None]) -> list[ua.BrowseResult]:
        """Return pages; their total size is bounded, and continuation points lead to the rest."""
        left, found = MOST_REFERENCES, []
        for one in wanted:
            if one is None:
                invalid = ua.StatusCode(ua.StatusCodes.BadContinuationPointInvalid)
                found.append(ua.BrowseResult(StatusCode=invalid))
                continue
            result = self.browsing.page(one, self.sees, most=left)
            left -= len(result.References)
            found.append(result)
            await asyncio.sleep(0)  # others' requests between two nodes
        return found

    async def translate_browsepaths_to_nodeids(self, params: list[ua.BrowsePath]) -> list[ua.BrowsePathResult]:
        """Follow paths; a path over an invisible node leads nowhere."""
        _at_most(params, MOST_BROWSED)
        found = await super().translate_browsepaths_to_nodeids(params)
        for asked, result in zip(params, found, strict=True):
            seen = self.sees(asked.StartingNode)
            result.Targets = [one for one in result.Targets if seen and self.sees(one.TargetId)]
            if not result.Targets and result.StatusCode.is_good():
                result.StatusCode = ua.StatusCode(ua.StatusCodes.BadNoMatch)
        return found

    async def history_read(self, params: ua.HistoryReadParameters) -> list[ua.HistoryReadResult]:
        """Read trends, in pages."""
        return await self.history.read(params, self.sees)

    async def call(self, params: list[ua.CallMethodRequest]) -> list[ua.CallMethodResult]:
        """Call methods; they find this session in `current`."""
        _at_most(params, MOST_CALLED)
        token = current.set(self)
        try:
            return await super().call(params)
        finally:
            current.reset(token)

    async def create_monitored_items(self, params: ua.CreateMonitoredItemsParameters) -> list[ua.MonitoredItemCreateResult]:
        """Monitor values and events that are visible, within limits of number. Raises ServiceError."""
        subscription = self.own(params.SubscriptionId)
        count = sum(len(one.monitored_item_srv._monitored_items) for one in self.subscriptions.values())
        results: list[ua.MonitoredItemCreateResult] = []
        for item in params.ItemsToCreate:
            if not isinstance(item.RequestedParameters.Filter, ua.EventFilter | ua.DataChangeFilter | ua.AggregateFilter):
                item.RequestedParameters.Filter = None  # an empty structure stands for none
            refusal = _refusal(item, seen=self.sees(item.ItemToMonitor.NodeId))
            if refusal is None and count >= MOST_ITEMS:
                refusal = ua.StatusCodes.BadTooManyMonitoredItems
            if refusal is not None:
                results.append(ua.MonitoredItemCreateResult(StatusCode=ua.StatusCode(refusal)))
                continue
            count += 1
            one = ua.CreateMonitoredItemsParameters(params.SubscriptionId, params.TimestampsToReturn, [item])
            results += await super().create_monitored_items(one)
            _use_own_filter(subscription, item, results[-1])
        return results


def _at_most(asked: Sequence[object], most: int) -> None:
    if len(asked) > most:
        raise ServiceError(ua.StatusCodes.BadTooManyOperations)


def _refusal(item: ua.MonitoredItemCreateRequest, *, seen: bool) -> int | None:
    """Return why an item is not watched; None where it can be."""
    asked = item.ItemToMonitor
    wanted = item.RequestedParameters.Filter
    if not seen:
        return int(ua.StatusCodes.BadNodeIdUnknown)
    if asked.AttributeId == ua.AttributeIds.EventNotifier:
        if not isinstance(wanted, ua.EventFilter) or not wanted.SelectClauses:
            return int(ua.StatusCodes.BadEventFilterInvalid)
        try:
            ConditionFilter(wanted.WhereClause)
        except EventFilterWrong:
            return int(ua.StatusCodes.BadEventFilterInvalid)
        return None
    if wanted is None:
        return None
    if not isinstance(wanted, ua.DataChangeFilter):
        return int(ua.StatusCodes.BadFilterNotAllowed)
    # The library would fail at each change of a value that is no number.
    return None if wanted.DeadbandType == ua.DeadbandType.None_ else int(ua.StatusCodes.BadMonitoredItemFilterUnsupported)


def _use_own_filter(
    subscription: InternalSubscription, item: ua.MonitoredItemCreateRequest, result: ua.MonitoredItemCreateResult
) -> None:
    """Replace the library's evaluation of a where clause by our own."""
    if item.ItemToMonitor.AttributeId == ua.AttributeIds.EventNotifier and result.StatusCode.is_good():
        stored: Any = subscription.monitored_item_srv._monitored_items[result.MonitoredItemId]
        stored.where_clause_evaluator = ConditionFilter(item.RequestedParameters.Filter.WhereClause)
