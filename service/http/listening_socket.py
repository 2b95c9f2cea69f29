"""The listening socket and the certificate of the REST API, checked before anything else starts."""

import socket
import ssl

from service.configuration.settings import Settings
from service.http.slow_clients import end_stuck_connections


class PortUnusable(RuntimeError):
    """The REST API cannot listen on its address or with its certificate."""


def require_certificate(settings: Settings) -> None:
    """Raise PortUnusable where the settings name an unusable certificate or key."""
    if settings.tls_certificate:
        try:
            ssl.create_default_context(ssl.Purpose.CLIENT_AUTH).load_cert_chain(settings.tls_certificate, settings.tls_key)
        except OSError as error:
            raise PortUnusable(
                f"{settings.tls_certificate} with {settings.tls_key}: no certificate and key: {error}"
            ) from error


def listen(host: str, port: int) -> socket.socket:
    """Bind a port and listen on it. Raises PortUnusable where it is in use or its host is not an address of this machine."""
    listener = socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET, socket.SOCK_STREAM)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        end_stuck_connections(listener)
        listener.bind((host, port))
        listener.listen(128)
    except (OSError, UnicodeError, TypeError) as error:
        listener.close()
        reason = error.strerror if isinstance(error, OSError) else error
        raise PortUnusable(f"cannot listen on {host}:{port}: {reason}; choose another with --host or --port") from error
    return listener
