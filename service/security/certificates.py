"""Expiry of certificates."""

from datetime import UTC, datetime
from pathlib import Path

DAY_S = 86_400.0


def good_until(file: Path) -> datetime:
    """Return the expiry of the first certificate in a file. Raises OSError, ValueError for a file that holds none."""
    from cryptography import x509  # the import takes a tenth of a second

    return x509.load_pem_x509_certificate(file.read_bytes()).not_valid_after_utc


def days_left(file: Path) -> float:
    """Return the days until the certificate expires, negative afterwards [d]. Raises OSError, ValueError."""
    return (good_until(file) - datetime.now(UTC)).total_seconds() / DAY_S
