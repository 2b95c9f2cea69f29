"""Adds nodes to the server's address space, and writes their values."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from asyncua import ua
from asyncua.server.internal_server import InternalServer

from service.opcua.names import NodeNames

READ = int(ua.AccessLevel.CurrentRead.mask)
READ_WITH_HISTORY = READ | int(ua.AccessLevel.HistoryRead.mask)
SUBSCRIBE = int(ua.EventNotifier.SubscribeToEvents.mask)
TYPES = {
    ua.VariantType.Double: ua.ObjectIds.Double,
    ua.VariantType.Int64: ua.ObjectIds.Int64,
    ua.VariantType.UInt32: ua.ObjectIds.UInt32,
    ua.VariantType.UInt16: ua.ObjectIds.UInt16,
    ua.VariantType.Boolean: ua.ObjectIds.Boolean,
    ua.VariantType.String: ua.ObjectIds.String,
    ua.VariantType.ByteString: ua.ObjectIds.ByteString,
    ua.VariantType.DateTime: ua.ObjectIds.UtcTime,
    ua.VariantType.LocalizedText: ua.ObjectIds.LocalizedText,
    ua.VariantType.NodeId: ua.ObjectIds.NodeId,
    ua.VariantType.StatusCode: ua.ObjectIds.StatusCode,
}
"""Data type of each type of values."""
COMPONENT, PROPERTY, ORGANIZES = ua.ObjectIds.HasComponent, ua.ObjectIds.HasProperty, ua.ObjectIds.Organizes


class NodeRefused(RuntimeError):
    """The library refused a node; the message says which and why."""


class NodeTree:
    """The nodes of a server's own namespace."""

    def __init__(self, server: InternalServer, names: NodeNames) -> None:
        self._server = server
        self.names = names

    def holds(self, node: ua.NodeId) -> bool:
        """Return whether there is a node."""
        return node in self._server.aspace

    def add_object(
        self,
        node: ua.NodeId,
        parent: ua.NodeId,
        name: ua.QualifiedName,
        *,
        kind: int = ua.ObjectIds.FolderType,
        reference: int = ORGANIZES,
        notifies: bool = False,
        description: str = "",
    ) -> None:
        """Add an object. kind: its type; notifies: whether clients can subscribe to its events."""
        attributes = ua.ObjectAttributes()
        attributes.EventNotifier = SUBSCRIBE if notifies else 0
        self._add(node, parent, name, ua.NodeClass.Object, attributes, kind=kind, reference=reference, description=description)

    def add_variable(
        self,
        node: ua.NodeId,
        parent: ua.NodeId,
        name: ua.QualifiedName,
        kind: ua.VariantType,
        *,
        value: Any = None,
        type_definition: int = ua.ObjectIds.BaseDataVariableType,
        reference: int = COMPONENT,
        data_type: int | None = None,
        history: bool = False,
        description: str = "",
    ) -> None:
        """Add a variable; without a value it waits for its first one. data_type: where the type of values does not say it."""
        attributes = ua.VariableAttributes()
        attributes.DataType = ua.NodeId(TYPES[kind] if data_type is None else data_type)
        attributes.ValueRank = ua.ValueRank.Scalar
        attributes.ArrayDimensions = None
        attributes.AccessLevel = attributes.UserAccessLevel = READ_WITH_HISTORY if history else READ
        attributes.Historizing = history
        attributes.MinimumSamplingInterval = 100.0
        attributes.Value = ua.Variant(value, kind if value is not None else ua.VariantType.Null)
        if reference == PROPERTY:
            type_definition = ua.ObjectIds.PropertyType
        self._add(
            node,
            parent,
            name,
            ua.NodeClass.Variable,
            attributes,
            kind=type_definition,
            reference=reference,
            description=description,
        )
        if value is None:
            stored = self._server.aspace[node].attributes[ua.AttributeIds.Value]
            stored.value = ua.DataValue(
                ua.Variant(None, ua.VariantType.Null), ua.StatusCode(ua.StatusCodes.BadWaitingForInitialData)
            )

    def refer(self, source: ua.NodeId, target: ua.NodeId, reference: int) -> None:
        """Add a reference in both directions, where it is not there yet."""
        items = []
        for begin, end, forward in ((source, target, True), (target, source, False)):
            item = ua.AddReferencesItem()
            item.SourceNodeId, item.TargetNodeId = begin, end
            item.ReferenceTypeId, item.IsForward = ua.NodeId(reference), forward
            items.append(item)
        _check(self._server.node_mgt_service.add_references(items), source)

    def refer_to_methods(self, source: ua.NodeId, methods: Sequence[int]) -> None:
        """Let an object share methods of its type, as OPC 10000-3, 6.4.2 allows: clients find them below it."""
        for method in methods:
            item = ua.AddReferencesItem()
            item.SourceNodeId, item.TargetNodeId = source, ua.NodeId(method)
            item.ReferenceTypeId, item.IsForward = ua.NodeId(COMPONENT), True
            _check(self._server.node_mgt_service.add_references([item]), source)

    async def write(self, node: ua.NodeId, value: ua.DataValue) -> None:
        """Write a value if it differs from the stored one; subscribers of the node are notified.

        Without a source time it has that of the change.
        """
        held = self._server.aspace[node].attributes[ua.AttributeIds.Value].value
        if held is not None and _same(held, value):
            return
        if value.SourceTimestamp is None:
            value = replace(value, SourceTimestamp=value.ServerTimestamp)
        status = await self._server.aspace.write_attribute_value(node, ua.AttributeIds.Value, value)
        if not status.is_good():
            raise NodeRefused(f"node {node.to_string()} takes no {value.Value}: {status.name}")

    def _add(
        self,
        node: ua.NodeId,
        parent: ua.NodeId,
        name: ua.QualifiedName,
        node_class: ua.NodeClass,
        attributes: ua.ObjectAttributes | ua.VariableAttributes,
        *,
        kind: int,
        reference: int,
        description: str,
    ) -> None:
        attributes.DisplayName = ua.LocalizedText(name.Name)
        attributes.Description = ua.LocalizedText(description or name.Name)
        attributes.WriteMask = attributes.UserWriteMask = 0
        item = ua.AddNodesItem()
        item.RequestedNewNodeId, item.ParentNodeId = node, parent
        item.BrowseName, item.NodeClass, item.NodeAttributes = name, node_class, attributes
        item.ReferenceTypeId, item.TypeDefinition = ua.NodeId(reference), ua.NodeId(kind)
        _check([one.StatusCode for one in self._server.node_mgt_service.add_nodes([item])], node)


def _same(held: ua.DataValue, value: ua.DataValue) -> bool:
    same_time = value.SourceTimestamp in (None, held.SourceTimestamp)
    return held.Value == value.Value and held.StatusCode == value.StatusCode and same_time


def _check(found: Sequence[ua.StatusCode], node: ua.NodeId) -> None:
    for status in found:
        if not status.is_good():
            raise NodeRefused(f"node {node.to_string()} cannot be added: {status.name}")
