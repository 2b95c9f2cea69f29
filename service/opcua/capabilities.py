"""Tells clients the limits of the server: a client that keeps them is never refused.

Source: OPC 10000-5, 6.3.2 and 6.3.11 (ServerCapabilities, OperationLimits); OPC 10000-11, 5.4.2 (HistoryServerCapabilities).
"""

from collections.abc import Mapping
from typing import Any

from asyncua import ua
from asyncua.server.internal_server import InternalServer

from service.opcua.client_session import MOST_BROWSED, MOST_CALLED, MOST_ITEMS, MOST_READ
from service.opcua.trend_history import MOST_NODES, PAGE

IDS, UINT32, BOOLEAN = ua.ObjectIds, ua.VariantType.UInt32, ua.VariantType.Boolean
TOLD: Mapping[int, tuple[Any, ua.VariantType]] = {
    IDS.Server_ServerCapabilities_OperationLimits_MaxNodesPerRead: (MOST_READ, UINT32),
    IDS.Server_ServerCapabilities_OperationLimits_MaxNodesPerBrowse: (MOST_BROWSED, UINT32),
    IDS.Server_ServerCapabilities_OperationLimits_MaxNodesPerTranslateBrowsePathsToNodeIds: (MOST_BROWSED, UINT32),
    IDS.Server_ServerCapabilities_OperationLimits_MaxNodesPerMethodCall: (MOST_CALLED, UINT32),
    IDS.Server_ServerCapabilities_OperationLimits_MaxNodesPerHistoryReadData: (MOST_NODES, UINT32),
    IDS.Server_ServerCapabilities_OperationLimits_MaxMonitoredItemsPerCall: (MOST_ITEMS, UINT32),
    IDS.HistoryServerCapabilities_AccessHistoryDataCapability: (True, BOOLEAN),
    IDS.HistoryServerCapabilities_AccessHistoryEventsCapability: (False, BOOLEAN),
    IDS.HistoryServerCapabilities_MaxReturnDataValues: (PAGE, UINT32),
    IDS.HistoryServerCapabilities_InsertDataCapability: (False, BOOLEAN),
    IDS.HistoryServerCapabilities_ReplaceDataCapability: (False, BOOLEAN),
    IDS.HistoryServerCapabilities_UpdateDataCapability: (False, BOOLEAN),
    IDS.HistoryServerCapabilities_DeleteRawCapability: (False, BOOLEAN),
    IDS.HistoryServerCapabilities_DeleteAtTimeCapability: (False, BOOLEAN),
    IDS.HistoryServerCapabilities_InsertAnnotationCapability: (False, BOOLEAN),
}
"""Values of the standard's nodes; the library's own would promise ten thousand of everything."""


async def set_capabilities(server: InternalServer) -> None:
    """Write the limits. Raises UaStatusCodeError where the library lacks one of the nodes."""
    for number, (value, kind) in TOLD.items():
        told = ua.DataValue(ua.Variant(value, kind))
        (await server.aspace.write_attribute_value(ua.NodeId(number), ua.AttributeIds.Value, told)).check()
