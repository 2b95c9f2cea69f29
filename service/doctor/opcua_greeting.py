"""Greets an OPC UA server, which needs no library: the first two messages of its connections.

Source: OPC 10000-6, 7.1.2 (Hello, Acknowledge).
"""

import socket
import struct

_HEADER = struct.Struct("<4sI")
_LIMITS = struct.Struct("<IIIII")
BUFFER = 65_535
ACKNOWLEDGED = b"ACKF"


def greet(host: str, port: int, *, within_s: float) -> None:
    """Say hello and wait for the acknowledgement. Raises OSError, ValueError for another answer."""
    url = f"opc.tcp://{host}:{port}/".encode()
    body = _LIMITS.pack(0, BUFFER, BUFFER, 0, 0) + struct.pack("<i", len(url)) + url
    with socket.create_connection((host, port), timeout=within_s) as connection:
        connection.sendall(_HEADER.pack(b"HELF", _HEADER.size + len(body)) + body)
        answer = connection.recv(_HEADER.size)
    if not answer.startswith(ACKNOWLEDGED):
        raise ValueError("what answers there is no OPC UA server")
