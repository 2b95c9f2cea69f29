"""Browsing a large address space: each reference once over pages, each answer bounded, nothing hidden in any page."""

import asyncio
from collections.abc import Callable

import pytest
from asyncua import ua
from asyncua.server.internal_server import InternalServer

from service.opcua.browsing import PAGE, BrowsePage, Browsing
from service.opcua.client_session import ClientSession
from service.opcua.names import NodeNames
from service.opcua.node_tree import NodeTree

MACHINES = 2_500
NAMES = NodeNames(2)
PLANT = NAMES.node("harbour")
VisibleNodes = Callable[[ua.NodeId], bool]


def everything(node: ua.NodeId) -> bool:
    return bool(node)


@pytest.fixture(scope="module")
def browsing() -> Browsing:
    async def filled() -> Browsing:
        server = InternalServer()
        await server.init()
        tree = NodeTree(server, NAMES)
        objects = ua.NodeId(ua.ObjectIds.ObjectsFolder)
        tree.add_object(PLANT, objects, NAMES.qualified("harbour"))
        for number in range(MACHINES):
            name = f"M{number}"
            tree.add_object(NAMES.node("harbour", name), PLANT, NAMES.qualified(name), reference=ua.ObjectIds.HasNotifier)
        return Browsing(server.aspace)

    return asyncio.run(filled())


def asked(**changes: object) -> ua.BrowseDescription:
    given = {"NodeId": PLANT, "ReferenceTypeId": ua.NodeId(ua.ObjectIds.HierarchicalReferences)} | changes
    return ua.BrowseDescription(**given)


def pages(browsing: Browsing, first: BrowsePage, sees: VisibleNodes = everything, most: int = 10_000) -> list[list[str]]:
    found, wanted = [], first
    while True:
        result = browsing.page(wanted, sees, most=most)
        assert result.StatusCode.is_good()
        found.append([one.BrowseName.Name for one in result.References])
        if not result.ContinuationPoint:
            return found
        wanted = BrowsePage.continued(result.ContinuationPoint)


@pytest.mark.parametrize(("most", "sizes"), [(0, [PAGE, PAGE, 500]), (400, [400] * 6 + [100]), (5_000, [PAGE, PAGE, 500])])
def test_every_machine_comes_once_over_pages(browsing: Browsing, most: int, sizes: list[int]) -> None:
    found = pages(browsing, BrowsePage.first(asked(), most))
    assert [len(one) for one in found] == sizes
    assert [name for one in found for name in one] == [f"M{number}" for number in range(MACHINES)]


def test_no_page_holds_what_is_hidden(browsing: Browsing) -> None:
    hidden = {NAMES.node("harbour", f"M{number}") for number in range(0, MACHINES, 2)}
    found = pages(browsing, BrowsePage.first(asked(), 300), lambda node: node not in hidden)
    names = [name for one in found for name in one]
    assert names == [f"M{number}" for number in range(1, MACHINES, 2)]
    result = browsing.page(BrowsePage(asked(), 10, 5), lambda node: node != PLANT, most=10)
    assert result.StatusCode.name == "BadNodeIdUnknown", "a continuation point opens nothing that a browse does not"


def test_kinds_classes_and_directions_are_kept_over_pages(browsing: Browsing) -> None:
    none = pages(browsing, BrowsePage.first(asked(NodeClassMask=int(ua.NodeClass.Variable)), 5))
    assert none == [[]]
    exactly = asked(IncludeSubtypes=False)
    assert pages(browsing, BrowsePage.first(exactly, 5)) == [[]]
    back = asked(NodeId=NAMES.node("harbour", "M7"), BrowseDirection=ua.BrowseDirection.Inverse)
    assert pages(browsing, BrowsePage.first(back, 5)) == [["harbour"]]


@pytest.mark.parametrize("point", [b"", b"\x01", b"\x02" + b"\0" * 30, b"\x01" + b"\xff" * 30, b"\x01" + b"\0" * 5_000])
def test_what_is_no_continuation_point_is_refused(point: bytes) -> None:
    with pytest.raises(ValueError, match="no continuation point"):
        BrowsePage.continued(point)


def test_one_request_holds_so_many_references_and_the_rest_is_fetched_later(browsing: Browsing) -> None:
    """A thousand times the longest list in one request: the answer is bounded, and others are answered between nodes."""

    class Session(ClientSession):
        def __init__(self) -> None:
            self.browsing = browsing

        def sees(self, node: ua.NodeId) -> bool:
            return everything(node)

    async def attempt() -> tuple[list[ua.BrowseResult], int]:
        turns = 0

        async def others() -> None:
            nonlocal turns
            while True:
                turns += 1
                await asyncio.sleep(0)

        beside = asyncio.create_task(others())
        found = await Session().browse(ua.BrowseParameters(NodesToBrowse=[asked()] * 1_000))
        beside.cancel()
        return found, turns

    found, turns = asyncio.run(attempt())
    assert sum(len(one.References) for one in found) == 10_000
    assert all(one.ContinuationPoint for one in found)
    assert turns >= 1_000
