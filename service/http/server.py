"""The web server of the service, over sockets that listen already."""

import functools
import socket
from collections.abc import Callable

import uvicorn

from service.configuration.settings import DEFAULT_CONNECTIONS_PER_ADDRESS
from service.http.connections import Acceptor
from service.http.protocol import HttpProtocol


def _no_exemption(_address: str) -> bool:
    return False


class Server(uvicorn.Server):
    """Server that accepts connections itself, and ends long answers when it stops: it would wait for them."""

    def __init__(
        self,
        config: uvicorn.Config,
        end_waiting: Callable[[], None],
        *,
        connections_per_address: int = DEFAULT_CONNECTIONS_PER_ADDRESS,
        exempt: Callable[[str], bool] = _no_exemption,
    ) -> None:
        """Set what ends long answers when the server stops. For connections_per_address and exempt see `Acceptor`."""
        super().__init__(config)
        self._end_waiting = end_waiting
        self._connections_per_address = connections_per_address
        self._exempt = exempt
        self._acceptors: list[Acceptor] = []

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to answer."""
        await super().startup(sockets=[])  # no listening sockets of its own
        state = self.lifespan.state
        protocol = functools.partial(HttpProtocol, config=self.config, server_state=self.server_state, app_state=state)
        for one in sockets or []:
            acceptor = Acceptor(one, protocol, tls=self.config.ssl, most=self._connections_per_address, exempt=self._exempt)
            acceptor.start()
            self._acceptors.append(acceptor)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Answer pending requests and accept no more."""
        for one in self._acceptors:
            one.close()
        self._end_waiting()
        await super().shutdown(sockets)
