"""Names of nodes: texts in the server's own namespace, each of which begins with the plant that the node belongs to."""

from asyncua import ua

NAMESPACE = "urn:rundown:machines"
"""URI of the namespace of all nodes that are not the standard's."""
SEPARATOR = "/"
"""Identifiers of plants and machines hold letters, digits, '_' and '-' only."""
ROOT = 1
"""Numeric identifier of the folder of all plants, the only node that belongs to none."""


class NodeNames:
    """Node ids of a server. index: index of the namespace in its table."""

    def __init__(self, index: int) -> None:
        self.index = index
        self.root = ua.NodeId(ROOT, index)
        """The folder of all plants."""

    def node(self, *parts: str) -> ua.NodeId:
        """Return the node of a plant, or of something in it: plant, machine, then names downwards."""
        return ua.NodeId(SEPARATOR.join(parts), self.index)

    def plant_of(self, node: ua.NodeId) -> str | None:
        """Return the plant that a node belongs to; None for the standard's nodes, which everybody may see."""
        if node.NamespaceIndex != self.index or not isinstance(node.Identifier, str):
            return None
        return node.Identifier.partition(SEPARATOR)[0]

    def qualified(self, name: str) -> ua.QualifiedName:
        """Return a browse name in the server's own namespace."""
        return ua.QualifiedName(name, self.index)
