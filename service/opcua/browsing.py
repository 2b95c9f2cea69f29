"""Browses the address space in pages: no answer is longer than a bound, and BrowseNext goes on where one ended.

Source: OPC 10000-4, 5.9.2 and 5.9.3 (Browse, BrowseNext). A continuation point holds all that the rest needs: nothing is kept
for clients that never come back. Nodes and references are only ever added at the end, so a place in a list stays the same.
"""

import struct
from collections.abc import Callable
from dataclasses import dataclass

from asyncua import ua
from asyncua.common.utils import Buffer
from asyncua.server.address_space import AddressSpace
from asyncua.ua.ua_binary import struct_from_binary, struct_to_binary

PAGE, MOST_REFERENCES = 1_000, 10_000
"""References of one node, and of all, in one answer; more come behind a continuation point."""
VERSION = 1
LONGEST_POINT = 4096
_PLACE = struct.Struct(">BII")
Sees = Callable[[ua.NodeId], bool]


@dataclass(frozen=True)
class BrowsePage:
    """The rest of a browse. asked: its request. place: number of references already sent. size: references in an answer."""

    asked: ua.BrowseDescription
    place: int
    size: int

    def continuation(self) -> bytes:
        """Return it as a continuation point."""
        return _PLACE.pack(VERSION, self.place, self.size) + struct_to_binary(self.asked)

    @classmethod
    def continued(cls, point: bytes) -> "BrowsePage":
        """Return the rest behind a continuation point. Raises ValueError."""
        if not _PLACE.size < len(point) <= LONGEST_POINT or point[0] != VERSION:
            raise ValueError("no continuation point of this server")
        _, place, size = _PLACE.unpack_from(point)
        try:
            asked = struct_from_binary(ua.BrowseDescription, Buffer(point[_PLACE.size :]))
        except Exception as error:  # the library raises many kinds
            raise ValueError("no continuation point of this server") from error
        return cls(asked, place, min(max(size, 1), PAGE))

    @classmethod
    def first(cls, asked: ua.BrowseDescription, most: int) -> "BrowsePage":
        """Return a browse from its beginning. most: references in an answer that the client wants; 0 for any number."""
        return cls(asked, 0, min(most or PAGE, PAGE))


class Browsing:
    """The pages of browses over an address space."""

    def __init__(self, space: AddressSpace) -> None:
        self._space = space
        self._kinds: dict[ua.NodeId, frozenset[ua.NodeId]] = {}

    def page(self, wanted: BrowsePage, sees: Sees, *, most: int) -> ua.BrowseResult:
        """Return what is visible of a page, at most so many references; the rest is behind its continuation point."""
        asked, result = wanted.asked, ua.BrowseResult()
        if asked.NodeId not in self._space or not sees(asked.NodeId):
            result.StatusCode = ua.StatusCode(ua.StatusCodes.BadNodeIdUnknown)
            return result
        kinds = self._kinds_of(asked)
        references = self._space[asked.NodeId].references
        size = min(wanted.size, most)
        place = wanted.place
        while place < len(references):
            one = references[place]
            if _suits(asked, one) and (kinds is None or one.ReferenceTypeId in kinds) and sees(one.NodeId):
                if len(result.References) >= size:
                    result.ContinuationPoint = BrowsePage(asked, place, wanted.size).continuation()
                    return result
                result.References.append(one)
            place += 1
        return result

    def _kinds_of(self, asked: ua.BrowseDescription) -> frozenset[ua.NodeId] | None:
        """Return the kinds of references that are asked for; None for all."""
        kind = asked.ReferenceTypeId
        if kind == ua.NodeId(ua.ObjectIds.Null):
            return None
        if not asked.IncludeSubtypes or kind.NamespaceIndex != 0 or kind not in self._space:
            return frozenset({kind})
        if kind not in self._kinds:
            self._kinds[kind] = frozenset(self._with_subtypes(kind))
        return self._kinds[kind]

    def _with_subtypes(self, kind: ua.NodeId) -> set[ua.NodeId]:
        found, waiting = set(), [kind]
        while waiting:
            one = waiting.pop()
            if one in found or one not in self._space:
                continue
            found.add(one)
            subtype = ua.NodeId(ua.ObjectIds.HasSubtype)
            waiting += [ref.NodeId for ref in self._space[one].references if ref.IsForward and ref.ReferenceTypeId == subtype]
        return found


def _suits(asked: ua.BrowseDescription, one: ua.ReferenceDescription) -> bool:
    if (
        asked.BrowseDirection != ua.BrowseDirection.Both
        and (asked.BrowseDirection == ua.BrowseDirection.Forward) != one.IsForward
    ):
        return False
    return not asked.NodeClassMask or bool(asked.NodeClassMask & one.NodeClass)
