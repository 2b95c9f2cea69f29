"""Ends connections of clients that do not read: data not sent would be held for ever."""

import socket

PATIENCE_S = 30.0
"""Longest time in which a client may acknowledge nothing [s]."""


def end_stuck_connections(listener: socket.socket, *, after_s: float = PATIENCE_S) -> None:
    """Set the socket to end accepted connections whose peer acknowledges nothing for so long; on Linux only.

    Source: RFC 5482; TCP_USER_TIMEOUT in tcp(7), which also holds while the peer's window is closed.
    """
    if hasattr(socket, "TCP_USER_TIMEOUT"):
        listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, round(1000 * after_s))
