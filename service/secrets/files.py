"""Reads secrets from files; a file that others can read is rejected."""

import base64
import binascii
import stat
from pathlib import Path

KEY_BYTES = 32
"""Length of an encryption key [B]."""


def read_secret(path: str) -> str:
    """Return the first line of a file. Raises ValueError, whose message never holds the content."""
    require_private(path)
    try:
        found = Path(path).read_text(encoding="utf-8").strip()
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"{path} cannot be read: {type(error).__name__}") from None
    if not found or "\n" in found:
        raise ValueError(f"{path} must hold the secret in one line, and nothing else")
    return found


def read_keys(path: str) -> list[bytes]:
    """Return the encryption keys of a file, base64 of 32 bytes a line. Raises ValueError, which never holds the content."""
    require_private(path)
    try:
        lines = Path(path).read_text(encoding="ascii").split()
        keys = [base64.b64decode(line.translate(_URL_SAFE), validate=True) for line in lines]
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror}") from None
    except (UnicodeDecodeError, binascii.Error):
        keys = []
    if not keys or any(len(key) != KEY_BYTES for key in keys):
        raise ValueError(f"{path} must hold a sealing key in each line, such as `openssl rand -base64 32` makes")
    return keys


_URL_SAFE = str.maketrans("-_", "+/")


def require_private(path: str) -> None:
    """Raise ValueError for a missing file, or one that others can read or write."""
    try:
        mode = Path(path).stat().st_mode
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror}") from None
    if mode & (stat.S_IROTH | stat.S_IWOTH):
        raise ValueError(f"{path} can be read or written by others: chmod 640 or 600 it")
