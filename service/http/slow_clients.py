"""Clients that take nothing of what they are sent: their connections end, or what was not sent would be held for ever."""

import socket

PATIENCE_S = 30.0
"""How long a client may take nothing [s]."""


def end_stuck_connections(listener: socket.socket, *, after_s: float = PATIENCE_S) -> None:
    """End accepted connections whose peer takes nothing for so long; only where Linux does it.

    Source: RFC 5482; TCP_USER_TIMEOUT in tcp(7), which also holds while the peer's window is closed.
    """
    if hasattr(socket, "TCP_USER_TIMEOUT"):
        listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, round(1000 * after_s))
