"""Addresses of the service's own endpoints, as this machine reaches them."""

import ssl

from service.configuration.settings import Settings
from service.security.exposure import host_of


def endpoint_here(endpoint: str) -> str:
    """Return an endpoint to connect to for one that is listened on."""
    host = host_of(endpoint)
    return endpoint.replace(f"[{host}]", "127.0.0.1").replace(host, "127.0.0.1") if host in ("0.0.0.0", "::") else endpoint


def reachable(host: str) -> str:
    """Return the address at which this machine reaches one that is listened on."""
    return "127.0.0.1" if host in ("0.0.0.0", "::") else host


def api_url(settings: Settings) -> str:
    """Return the address at which this machine reaches the API."""
    host = reachable(settings.host)
    scheme = "https" if settings.tls_certificate else "http"
    return f"{scheme}://{f'[{host}]' if ':' in host else host}:{settings.port}"


def api_trust(settings: Settings) -> ssl.SSLContext | bool:
    """Return a TLS context that trusts the service's own certificate; its validity is checked separately."""
    if not settings.tls_certificate:
        return True
    context = ssl.create_default_context(cafile=settings.tls_certificate)
    # The file may lack the certificate's authority, or properties that strict verification requires.
    context.verify_flags |= ssl.VERIFY_X509_PARTIAL_CHAIN
    context.verify_flags &= ~ssl.VERIFY_X509_STRICT
    context.check_hostname = False
    return context
