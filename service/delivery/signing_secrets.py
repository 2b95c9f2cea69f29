"""Keeps the secrets that sign webhooks: sealed in the database, or referenced there and held in a file or a variable.

The creator of a subscription chooses the reference. Therefore it may name only files of one folder and variables with one
prefix, and the content must have the form of a webhook's secret: nothing else on the machine can be named, used or guessed.
"""

import os
import re
import stat
from dataclasses import dataclass
from pathlib import Path

from estimator.errors import Conflict
from service.configuration.settings import Settings
from service.delivery.signing import PREFIX, key_of
from service.secrets.references import FILE_NAME, VARIABLE, VARIABLE_PREFIX
from service.secrets.sealing import SEALED, SealBroken, Sealing, make_key
from storage.database.claim import file_of
from storage.database.engine import engine_of
from storage.tables.alerting import SubscriptionRow

FILE, ENVIRONMENT = "file:", "env:"
"""Prefixes of references in the database."""
LARGEST_FILE = 1024
"""Largest size of a secret's file [B]."""
SHORTEST, LONGEST = 24, 64
"""Bounds of the key's length in a referenced secret, after Standard Webhooks [B]."""


class SecretUnusable(Conflict):
    """A secret cannot be stored or read; the message says why and what would be right, never the secret."""


@dataclass(frozen=True)
class SigningSecrets:
    """Access to the secrets. sealing: None where there is no key, with the reason."""

    sealing: Sealing | None = None
    folder: Path | None = None
    reason: str = "no sealing key is set: RUNDOWN_SEALING_KEY_FILE names the file of one"

    @classmethod
    def of(cls, settings: Settings, *, make: bool = False) -> "SigningSecrets":
        """Read the settings. make: whether a key may be made where none is set, beside an SQLite file."""
        folder = Path(settings.webhook_secrets_folder) if settings.webhook_secrets_folder else None
        file = key_file(settings)
        if file is None:
            return cls(None, folder)
        try:
            if make and not settings.sealing_key_file and not file.exists():
                make_key(file)
            return cls(Sealing.of(file), folder)
        except (ValueError, OSError) as error:
            right = "put back the one that belongs to this database; where nothing is sealed yet, the next start makes one"
            return cls(None, folder, f"there is no sealing key: {error}: {right}")

    def sealed(self, secret: str, subscription_id: int) -> str:
        """Encrypt a secret for the database. Raises SecretUnusable."""
        if self.sealing is None:
            raise SecretUnusable(
                f"a webhook's secret is not kept in plain, and {self.reason}; or give secret_file or secret_env"
            )
        return self.sealing.seal(secret.encode(), place=_place(subscription_id))

    def referred(self, *, file: str | None, variable: str | None) -> str:
        """Return a reference for the database, after a check of its secret. Raises SecretUnusable."""
        if file is not None:
            self._from_file(file)
            return FILE + file
        _from_environment(variable or "")
        return f"{ENVIRONMENT}{variable}"

    def reveal(self, row: SubscriptionRow) -> str:
        """Return a subscription's secret. Raises SecretUnusable."""
        kept = row.secret or ""
        if kept.startswith(FILE):
            return self._from_file(kept.removeprefix(FILE))
        if kept.startswith(ENVIRONMENT):
            return _from_environment(kept.removeprefix(ENVIRONMENT))
        if not is_sealed(kept):
            return kept
        if self.sealing is None:
            raise SecretUnusable(f"its secret is sealed, and {self.reason}")
        try:
            return self.sealing.open(kept, place=_place(row.id)).decode()
        except SealBroken as error:
            raise SecretUnusable(
                f"its secret is sealed, and {error}; put back the key that belongs to this database"
            ) from error

    def trouble(self, row: SubscriptionRow) -> str | None:
        """Return the reason why a subscription's messages cannot be signed, or None."""
        try:
            self.reveal(row)
        except SecretUnusable as error:
            return str(error)
        return None

    def renewed(self, row: SubscriptionRow) -> str | None:
        """Return the replacement of a secret in plain text or under an older key; None where it needs none."""
        kept = row.secret or ""
        if self.sealing is None or kept.startswith((FILE, ENVIRONMENT)):
            return None
        if is_sealed(kept) and (self.sealing.is_current(kept, place=_place(row.id)) or self.trouble(row)):
            return None
        return self.sealed(self.reveal(row), row.id)

    def _from_file(self, name: str) -> str:
        if self.folder is None:
            raise SecretUnusable("secret_file needs RUNDOWN_WEBHOOK_SECRETS_FOLDER, the folder in which such files are")
        if not re.fullmatch(FILE_NAME, name):
            raise SecretUnusable("secret_file is the name of a file in the folder, without any folder")
        try:
            held = _read(self.folder, name)
        except OSError as error:
            raise SecretUnusable(f"the file {name} cannot be used: {error.strerror}") from None
        return _fit(held, f"the file {name}")


def key_file(settings: Settings) -> Path | None:
    """Return the file of the encryption key: as set, or beside an SQLite file; None where it must be set."""
    if settings.sealing_key_file:
        return Path(settings.sealing_key_file)
    path = file_of(engine_of(settings.database))
    return None if path is None else path.with_name(path.name + ".key")


def is_sealed(kept: str | None) -> bool:
    """Check whether a stored secret is sealed."""
    return (kept or "").startswith(SEALED)


def is_plain(kept: str | None) -> bool:
    """Check whether a stored secret is plain text."""
    return bool(kept) and not (kept or "").startswith((SEALED, FILE, ENVIRONMENT))


def describe_storage(kept: str | None) -> str | None:
    """Describe in words where a secret is stored; None where there is none."""
    if not kept:
        return None
    if is_sealed(kept):
        return "sealed"
    return "plain" if is_plain(kept) else kept.replace(":", " ", 1)


def _place(subscription_id: int) -> str:
    return f"subscription {subscription_id}"


def _from_environment(name: str) -> str:
    if not re.fullmatch(VARIABLE, name):
        raise SecretUnusable(f"secret_env is a variable whose name begins with {VARIABLE_PREFIX}")
    if name not in os.environ:
        raise SecretUnusable(f"the service's environment has no {name}")
    return _fit(os.environ[name].strip(), name)


def _read(folder: Path, name: str) -> str:
    """Read a file; links may lead only inside the folder, as those of mounted secrets do. Raises OSError, SecretUnusable."""
    real = Path(os.path.realpath(folder / name))
    if not real.is_relative_to(os.path.realpath(folder)):
        raise SecretUnusable(f"the file {name} leads out of the folder")
    mode = real.stat().st_mode
    if not stat.S_ISREG(mode):  # reading a pipe would block
        raise SecretUnusable(f"{name} is no file")
    if mode & (stat.S_IROTH | stat.S_IWOTH):
        raise SecretUnusable(f"the file {name} can be read or written by others: chmod 640 or 600 it")
    with real.open("rb") as opened:
        return opened.read(LARGEST_FILE + 1).decode("ascii", "replace").strip()


def _fit(secret: str, what: str) -> str:
    """Return a well-formed secret. Raises SecretUnusable for other content, which must sign nothing."""
    wanted = f"{what} must hold {PREFIX} and base64 of {SHORTEST} to {LONGEST} bytes, in one line"
    try:
        fits = secret.startswith(PREFIX) and SHORTEST <= len(key_of(secret)) <= LONGEST
    except ValueError:
        fits = False
    if not fits:
        raise SecretUnusable(wanted)
    return secret
