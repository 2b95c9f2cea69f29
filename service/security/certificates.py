"""Until when certificates are good."""

from datetime import UTC, datetime
from pathlib import Path

DAY_S = 86_400.0


def good_until(file: Path) -> datetime:
    """Tell when the first certificate of a file expires. Raises OSError, ValueError for a file that holds none."""
    from cryptography import x509  # takes a tenth of a second to import

    return x509.load_pem_x509_certificate(file.read_bytes()).not_valid_after_utc


def days_left(file: Path) -> float:
    """From now until then, negative once it is over [d]. Raises OSError, ValueError."""
    return (good_until(file) - datetime.now(UTC)).total_seconds() / DAY_S
