"""The way of a client's request to its session: what the library's does not know, or would do in the event loop's time.

The library (asyncua 2.1) has no BrowseNext, and checks users in the event loop; an issuer's keys may have to be fetched first.
It waits for as long a message as anybody announces, and keeps what has come of it; one address can take all connections.
"""

import asyncio
from typing import Any

from asyncua import Server, ua
from asyncua.common.utils import ServiceError
from asyncua.server.binary_server_asyncio import BinaryServer, OPCUAProtocol
from asyncua.server.uaprocessor import UaProcessor
from asyncua.ua.ua_binary import struct_from_binary

BROWSE_NEXT = ua.NodeId(ua.ObjectIds.BrowseNextRequest_Encoding_DefaultBinary)
ACTIVATE = ua.NodeId(ua.ObjectIds.ActivateSessionRequest_Encoding_DefaultBinary)

LARGEST_CHUNK = 65_535
"""Largest piece of a message that the server takes, which it tells each client (OPC 10000-6, 7.1.2.3) [B]."""
MOST_STRANGERS = 20
"""Largest number of connections of one address over which nobody has logged in yet."""


class ClientRequests(UaProcessor):
    """The requests of one connection."""

    async def _process_message(self, typeid: ua.NodeId, requesthdr: Any, seqhdr: Any, body: Any) -> Any:
        if typeid == ACTIVATE:
            await self.iserver.prepare(struct_from_binary(ua.ActivateSessionParameters, body.copy()))
        if typeid != BROWSE_NEXT:
            return await super()._process_message(typeid, requesthdr, seqhdr, body)
        if self.session is None or not self.session.is_activated():
            raise ServiceError(ua.StatusCodes.BadSessionIdInvalid)
        self.session.touch()
        response = ua.BrowseNextResponse()
        response.Parameters.Results = await self.session.browse_next(struct_from_binary(ua.BrowseNextParameters, body))
        self.send_response(requesthdr.RequestHandle, seqhdr, response)
        return True


class ClientConnection(OPCUAProtocol):
    """One connection."""

    processor: UaProcessor | None
    _buffer: bytes

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Take a connection, or refuse it where there are too many."""
        if self._anonymous_connections(transport.get_extra_info("peername")) >= MOST_STRANGERS:
            transport.close()
            return
        super().connection_made(transport)
        if self.processor is not None:
            requests = ClientRequests(self.iserver, self.transport, self.limits)
            requests.set_policies(self.policies)
            self.processor = requests

    def data_received(self, data: bytes) -> None:
        """Take what has come, and end a connection that sends a larger piece than was agreed on."""
        super().data_received(data)
        if len(self._buffer) > LARGEST_CHUNK and self.transport is not None:
            self._buffer = b""
            self.transport.abort()

    def _anonymous_connections(self, peer: Any) -> int:
        """Count the connections of an address over which nobody has logged in yet."""
        same = [one for one in self.clients if peer and one.peer_name and one.peer_name[0] == peer[0]]
        return sum(
            one.processor is None or one.processor.session is None or not one.processor.session.is_activated() for one in same
        )


class ClientListener(BinaryServer):
    """The listening socket."""

    def _make_protocol(self) -> OPCUAProtocol:
        return ClientConnection(
            iserver=self.iserver,
            policies=self._policies,
            clients=self.clients,
            closing_tasks=self.closing_tasks,
            limits=self.limits,
        )


class ListeningServer(Server):
    """The library's server, whose connections are ours."""

    async def start(self) -> None:
        """Begin to listen. Raises OSError."""
        await self._setup_server_nodes()
        await self.iserver.start()
        host, port = self._get_bind_socket_info()
        assert host is not None
        assert port is not None
        self.bserver = ClientListener(self.iserver, host, port, self.limits)
        self.bserver.set_policies(self._policies)
        try:
            await self.bserver.start()
        except BaseException:
            await self.iserver.stop()
            raise
