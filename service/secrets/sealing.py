"""Secrets that must stand in the database are sealed there: AES-256-GCM, with keys that stand elsewhere.

A sealed secret opens only in the place that it was sealed for: copied into another row it is of no use.
"""

import base64
import os
from collections.abc import Sequence
from pathlib import Path

from cryptography.exceptions import InvalidTag
from cryptography.hazmat.primitives.ciphers.aead import AESGCM

from service.secrets.files import KEY_BYTES, read_keys
from storage.backup.backup_file import sync_folder
from storage.database.private_files import PRIVATE

SEALED = "sealed:"
"""With which every sealed secret begins."""
NONCE_BYTES = 12


class SealBroken(ValueError):
    """No key opens what is sealed; the message says what would."""


class Sealing:
    """Keys: the first one seals, all of them open."""

    def __init__(self, keys: Sequence[bytes]) -> None:
        self._keys = [AESGCM(key) for key in keys]

    @classmethod
    def of(cls, file: Path) -> "Sealing":
        """Read the keys of a file. Raises ValueError."""
        return cls(read_keys(str(file)))

    def seal(self, secret: bytes, *, place: str) -> str:
        """Return a secret as it may stand in the database, in one place only."""
        nonce = os.urandom(NONCE_BYTES)
        return SEALED + base64.b64encode(nonce + self._keys[0].encrypt(nonce, secret, place.encode())).decode()

    def open(self, sealed: str, *, place: str) -> bytes:
        """Return the secret. Raises SealBroken."""
        for key in self._keys:
            if (found := _opened(key, sealed, place)) is not None:
                return found
        raise SealBroken("none of the sealing keys opens it: it was sealed with another one, or changed")

    def is_current(self, sealed: str, *, place: str) -> bool:
        """Tell whether the first key opens it; one that only a later key opens is to be sealed anew."""
        return _opened(self._keys[0], sealed, place) is not None


def _opened(key: AESGCM, sealed: str, place: str) -> bytes | None:
    try:
        held = base64.b64decode(sealed.removeprefix(SEALED), validate=True)
        return key.decrypt(held[:NONCE_BYTES], held[NONCE_BYTES:], place.encode())
    except (InvalidTag, ValueError):
        return None


def make_key(file: Path) -> None:
    """Write a new key into a new private file, which is whole and on the disk before anything is sealed with it.

    Raises OSError, also where the file is there already.
    """
    part = file.with_name(file.name + ".part")
    part.unlink(missing_ok=True)  # of a process that was killed
    number = os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY, PRIVATE)
    with os.fdopen(number, "wb") as opened:
        opened.write(base64.b64encode(os.urandom(KEY_BYTES)) + b"\n")
        opened.flush()
        os.fsync(number)
    try:
        os.link(part, file)
    finally:
        part.unlink()
    sync_folder(file.parent)
