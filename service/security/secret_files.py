"""Secrets come from files or from the environment; a file that others can read holds no secret."""

import ipaddress
import stat
from pathlib import Path
from urllib.parse import urlsplit


def read_secret(path: str) -> str:
    """The first line of a file. Raises ValueError, which says what is wrong, never what is in it."""
    require_private(path)
    try:
        found = Path(path).read_text(encoding="utf-8").strip()
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"{path} cannot be read: {type(error).__name__}") from None
    if not found or "\n" in found:
        raise ValueError(f"{path} must hold the secret in one line, and nothing else")
    return found


def require_private(path: str) -> None:
    """Raises ValueError for a file that is not there, or that others can read."""
    try:
        mode = Path(path).stat().st_mode
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror}") from None
    if mode & (stat.S_IROTH | stat.S_IWOTH):
        raise ValueError(f"{path} can be read or written by others: chmod 640 or 600 it")


def is_loopback(host: str) -> bool:
    """Whether only this machine reaches an address."""
    try:
        return ipaddress.ip_address(host.strip("[]").split("%")[0]).is_loopback
    except ValueError:
        return host == "localhost"


def is_address(host: str) -> bool:
    """Whether this is an address, not a name."""
    try:
        ipaddress.ip_address(host.strip("[]").split("%")[0])
    except ValueError:
        return False
    return True


def encrypted(url: str) -> bool:
    """Whether nobody between can read what is sent to a URL: https, or loopback."""
    parts = urlsplit(url)
    return parts.scheme == "https" or (parts.scheme == "http" and is_loopback(parts.hostname or ""))
