"""A session that reaches its own subscriptions only, within limits of number, speed and memory.

The library lets any session change, read or delete the subscriptions of others by their numbers, which it counts up.
"""

import math
from collections.abc import Iterable
from typing import Any

from asyncua import ua
from asyncua.common.utils import ServiceError
from asyncua.server.internal_session import InternalSession
from asyncua.server.internal_subscription import InternalSubscription

MOST_SUBSCRIPTIONS = 20
"""Largest number of subscriptions of one session."""
MOST_QUEUED = 1_000
"""Largest number of values or events that wait for one monitored item to be published."""
FASTEST_MS, SLOWEST_MS = 100.0, 3_600_000.0
"""Shortest and longest publishing interval [ms]: the store is read ten times a second."""


class OwnSubscriptions(InternalSession):
    """A session of the library's that reaches its own subscriptions only."""

    @property
    def subscriptions(self) -> dict[int, InternalSubscription]:
        """Return its own subscriptions."""
        every = self.subscription_service.subscriptions
        return {number: one for number, one in every.items() if one.session_id == self.session_id}

    def own(self, number: int) -> InternalSubscription:
        """Return one of its own subscriptions. Raises ServiceError."""
        found = self.subscriptions.get(number)
        if found is None:
            raise ServiceError(ua.StatusCodes.BadSubscriptionIdInvalid)
        return found

    async def create_subscription(
        self, params: ua.CreateSubscriptionParameters, callback: Any, request_callback: Any = None
    ) -> ua.CreateSubscriptionResult:
        """Create a subscription within the limits. Raises ServiceError."""
        if len(self.subscriptions) >= MOST_SUBSCRIPTIONS:
            raise ServiceError(ua.StatusCodes.BadTooManySubscriptions)
        asked = params.RequestedPublishingInterval
        params.RequestedPublishingInterval = min(max(asked, FASTEST_MS), SLOWEST_MS) if math.isfinite(asked) else 1000.0
        return await super().create_subscription(params, callback, request_callback)

    def modify_subscription(self, params: ua.ModifySubscriptionParameters) -> ua.ModifySubscriptionResult:
        """Update a subscription. Raises ServiceError."""
        self.own(params.SubscriptionId)
        return super().modify_subscription(params)

    async def modify_monitored_items(self, params: ua.ModifyMonitoredItemsParameters) -> list[ua.MonitoredItemModifyResult]:
        """Set sizes of queues; filters stay as they were checked when the item was created. Raises ServiceError."""
        known = self.own(params.SubscriptionId).monitored_item_srv._monitored_items
        results = []
        for item in params.ItemsToModify:
            if item.MonitoredItemId not in known:
                results.append(ua.MonitoredItemModifyResult(ua.StatusCode(ua.StatusCodes.BadMonitoredItemIdInvalid)))
                continue
            item.RequestedParameters.Filter = None
            item.RequestedParameters.QueueSize = min(item.RequestedParameters.QueueSize or MOST_QUEUED, MOST_QUEUED)
            one = ua.ModifyMonitoredItemsParameters(params.SubscriptionId, params.TimestampsToReturn, [item])
            results += await super().modify_monitored_items(one)
        return results

    async def set_monitoring_mode(self, params: ua.SetMonitoringModeParameters) -> list[ua.StatusCode]:
        """Enable or disable items. Raises ServiceError."""
        self.own(params.SubscriptionId)
        return await super().set_monitoring_mode(params)

    async def set_publishing_mode(self, params: ua.SetPublishingModeParameters) -> list[ua.StatusCode]:
        """Enable or disable subscriptions. Raises ServiceError."""
        for number in params.SubscriptionIds:
            self.own(number)
        return await super().set_publishing_mode(params)

    def republish(self, params: ua.RepublishParameters) -> ua.NotificationMessage:
        """Send again a message that was not acknowledged. Raises ServiceError."""
        subscription = self.own(params.SubscriptionId)
        if params.RetransmitSequenceNumber not in subscription._not_acknowledged_results:
            raise ServiceError(ua.StatusCodes.BadMessageNotAvailable)
        return super().republish(params)

    async def delete_subscriptions(self, ids: list[int]) -> list[ua.StatusCode]:
        """Delete its own subscriptions."""
        own = self.subscriptions
        results = []
        for number in ids:
            if number in own:
                results += await super().delete_subscriptions([number])
            else:
                results.append(ua.StatusCode(ua.StatusCodes.BadSubscriptionIdInvalid))
        return results

    async def delete_monitored_items(self, params: ua.DeleteMonitoredItemsParameters) -> list[ua.StatusCode]:
        """Delete items. Raises ServiceError."""
        self.own(params.SubscriptionId)
        return await super().delete_monitored_items(params)

    def publish(self, acks: Iterable[ua.SubscriptionAcknowledgement] | None = None) -> tuple[int, list[ua.StatusCode]]:
        """Take the acknowledgements of its own subscriptions' messages. Raises ServiceError where it has none."""
        own = self.subscriptions
        if not own:
            raise ServiceError(ua.StatusCodes.BadNoSubscription)
        results = []
        for one in acks or ():
            found = own.get(one.SubscriptionId)
            if found is not None:
                found.publish([one.SequenceNumber])
            results.append(ua.StatusCode(ua.StatusCodes.Good if found else ua.StatusCodes.BadSubscriptionIdInvalid))
        return len(own), results

    async def transfer_subscriptions(
        self, params: ua.TransferSubscriptionsParameters, callback: Any
    ) -> list[ua.TransferResult]:
        """Refuse to transfer: a client that comes back activates its old session, or subscribes anew."""
        del params, callback
        raise ServiceError(ua.StatusCodes.BadServiceUnsupported)
