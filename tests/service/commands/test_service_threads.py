"""The threads of a service process: what stops before what."""

from contextlib import ExitStack
from typing import Any

import pytest
import zenoh

from service.commands.service_threads import ServiceThreads
from service.configuration.settings import Settings
from service.delivery.dispatcher import Dispatcher
from service.delivery.signing_secrets import SigningSecrets
from service.identification.scheduler import JobScheduler
from service.ingest.ingest_thread import Ingest
from service.replication.lease_keeper import LeaseKeeper
from service.runs.closing import Closing
from storage.database.engine import Database

PARTS: dict[Any, str] = {
    JobScheduler: "identifying",
    Dispatcher: "delivery",
    Closing: "closing",
    Ingest: "ingest",
    LeaseKeeper: "leasing",
}


def test_identifications_are_given_up_before_what_has_come_is_stored(
    plant: Database, router: zenoh.Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Their processes would slow the storing down; the lease goes last, as storing needs it."""
    stopped = []

    def noting(part: Any) -> None:
        stop = part.stop

        def noted(self: object) -> None:
            stopped.append(PARTS[part])
            stop(self)

        monkeypatch.setattr(part, "stop", noted)

    for part in PARTS:
        noting(part)
    threads = ServiceThreads(plant, router, Settings(), SigningSecrets())
    with ExitStack() as closing:
        threads.start(closing)
        assert set(threads.states().values()) == {"ok"}
    assert stopped == list(PARTS.values())
    assert set(threads.states().values()) != {"ok"}
