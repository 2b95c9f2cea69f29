"""Encrypts ("seals") secrets in the database: AES-256-GCM, with keys kept elsewhere.

A sealed secret is bound to its place by authenticated data: copied into another row it does not open.
"""

import base64
import os
from collections.abc import Sequence
from pathlib import Path

from cryptography.exceptions import InvalidTag
from cryptography.hazmat.primitives.ciphers.aead import AESGCM

from service.secrets.files import KEY_BYTES, read_keys
from storage.backup.backup_file import sync_folder
from storage.files.private_files import PRIVATE

SEALED = "sealed:"
"""Prefix of every sealed secret."""
NONCE_BYTES = 12


class SealBroken(ValueError):
    """No key opens a sealed secret; the message says which would."""


class Sealing:
    """Encryption keys: the first seals, all of them open."""

    def __init__(self, keys: Sequence[bytes]) -> None:
        self._keys = [AESGCM(key) for key in keys]

    @classmethod
    def of(cls, file: Path) -> "Sealing":
        """Read the keys of a file. Raises ValueError."""
        return cls(read_keys(str(file)))

    def seal(self, secret: bytes, *, place: str) -> str:
        """Encrypt a secret for one place in the database."""
        nonce = os.urandom(NONCE_BYTES)
        return SEALED + base64.b64encode(nonce + self._keys[0].encrypt(nonce, secret, place.encode())).decode()

    def open(self, sealed: str, *, place: str) -> bytes:
        """Decrypt a secret. Raises SealBroken."""
        for key in self._keys:
            if (found := _decrypt(key, sealed, place)) is not None:
                return found
        raise SealBroken("none of the sealing keys opens it: it was sealed with another one, or changed")

    def is_current(self, sealed: str, *, place: str) -> bool:
        """Check whether the first key opens it; a secret that only a later key opens must be sealed again."""
        return _decrypt(self._keys[0], sealed, place) is not None


def _decrypt(key: AESGCM, sealed: str, place: str) -> bytes | None:
    try:
        held = base64.b64decode(sealed.removeprefix(SEALED), validate=True)
        return key.decrypt(held[:NONCE_BYTES], held[NONCE_BYTES:], place.encode())
    except (InvalidTag, ValueError):
        return None


def make_key(file: Path) -> None:
    """Write a new key into a new private file, complete and synced to disk before anything is sealed with it.

    Raises OSError, also where the file exists.
    """
    part = file.with_name(file.name + ".part")
    part.unlink(missing_ok=True)  # left by a killed process
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
