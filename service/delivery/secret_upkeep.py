"""Seals stored secrets at a start, and checks whether all of them are usable."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy.exc import DBAPIError

from service.configuration.settings import Settings
from service.delivery.signing import PREFIX
from service.delivery.signing_secrets import SigningSecrets, is_plain, is_sealed
from storage.alerts import deliveries
from storage.backup import scrubbing
from storage.backup.scrubbing import ScrubFailed
from storage.database.engine import Database
from storage.operation import idempotency
from storage.tables.alerting import SubscriptionRow

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class SecretReport:
    """Faults of the secrets, in words. unsigned: webhooks that cannot be served; plain: those with a secret in plain text."""

    unsigned: Sequence[str] = ()
    plain: Sequence[str] = ()

    @classmethod
    def at(cls, rows: Sequence[SubscriptionRow], secrets: SigningSecrets) -> "SecretReport":
        """Check the secrets of subscriptions."""
        troubles = [(row.name, secrets.trouble(row)) for row in rows if row.state == deliveries.ACTIVE]
        why = f": {secrets.reason}" if secrets.sealing is None else ": the next start seals it"
        return cls(
            [f"webhook '{name}' is told nothing: {trouble}" for name, trouble in troubles if trouble],
            [f"the secret of webhook '{row.name}' is stored unencrypted{why}" for row in rows if is_plain(row.secret)],
        )


class SecretWatch:
    """Watch of a delivering service's webhook secrets."""

    def __init__(self, database: Database, secrets: SigningSecrets) -> None:
        self._database = database
        self._secrets = secrets
        self._found = SecretReport()

    def check(self) -> None:
        """Check all secrets; new faults are logged. Raises DBAPIError."""
        with self._database.reading() as session:
            found = SecretReport.at(deliveries.list_subscriptions_with_secret(session), self._secrets)
        for words in found.unsigned:
            if words not in self._found.unsigned:
                logger.error(words)
        self._found = found

    @property
    def warnings(self) -> list[str]:
        """Return the faults of the last check, in words."""
        return [*self._found.unsigned, *self._found.plain]

    @property
    def gauges(self) -> dict[str, float]:
        """Return figures for a monitoring system, by the name of the metric."""
        return {"rundown_webhooks_unsigned": len(self._found.unsigned)}


def open_secrets(database: Database, settings: Settings) -> SigningSecrets:
    """Open the secrets at a start: make a key where permitted, and seal secrets in plain text or under an older key."""
    with database.reading() as session:
        sealed = any(is_sealed(row.secret) for row in deliveries.list_subscriptions_with_secret(session))
    # Where something is sealed already, a new key would only hide that the right one is missing.
    secrets = SigningSecrets.of(settings, make=not sealed)
    if secrets.sealing is None:
        logger.warning("secrets of webhooks cannot be sealed: %s", secrets.reason)
        return secrets
    try:
        if seal(database, secrets):
            scrubbing.scrub(database)
    except DBAPIError as error:
        logger.error("secrets of webhooks stay as they are: %s", error.orig)
    except ScrubFailed as error:
        logger.warning("copies of unencrypted secrets may be left: %s", error)
    return secrets


def seal(database: Database, secrets: SigningSecrets) -> int:
    """Seal secrets in plain text or under an older key; returns how many were plain. Raises DBAPIError."""
    with database.reading() as session:
        if not any(secrets.renewed(row) for row in deliveries.list_subscriptions_with_secret(session)):
            return 0
    with database.transaction() as session:
        scrubbing.overwrite_deleted(session)
        plain = again = 0
        for row in deliveries.list_subscriptions_with_secret(session):
            if (renewed := secrets.renewed(row)) is not None:
                plain, again = plain + is_plain(row.secret), again + is_sealed(row.secret)
                row.secret = renewed
        if plain:  # answers that are kept for who asks again told them as well
            idempotency.forget_answers_with(session, PREFIX.encode())
    logger.info("secrets of webhooks are sealed: %d unencrypted ones, %d again with the newest key", plain, again)
    return plain
