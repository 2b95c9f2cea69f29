"""A broker for a module's tests, and a service's ingest that takes samples from it."""

from collections.abc import Iterator
from dataclasses import dataclass
from uuid import uuid4

import pytest
import zenoh

from service.configuration.settings import Settings
from service.ingest.ingest_thread import Ingest
from service.mqtt.sample_intake import MqttSamples
from service.replication.work_share import WholeShare
from service.runs.collector import Collector
from service.write_path.http_queue import Submissions
from service.write_path.sample_writer import SampleWriter
from storage.database.engine import Database
from tests.mosquitto import Mosquitto, broker
from tests.plant import wait_until


@pytest.fixture(scope="module")
def mosquitto(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Mosquitto]:
    with broker(tmp_path_factory.mktemp("broker") / "mosquitto") as one:
        yield one


def settings_of(mosquitto: Mosquitto, **changes: object) -> Settings:
    """Return what a service that uses a broker is told."""
    told = {name.removeprefix("RUNDOWN_").lower(): value for name, value in mosquitto.environment.items()}
    return Settings(**(told | changes))  # type: ignore[arg-type]


@dataclass
class Taking:
    """A service's ingest beside its connection to a broker."""

    database: Database
    submissions: Submissions
    ingest: Ingest
    samples: MqttSamples


@pytest.fixture
def taking(mosquitto: Mosquitto, router: zenoh.Session, plant: Database) -> Iterator[Taking]:
    submissions = Submissions()
    ingest = Ingest(router, SampleWriter(plant, Collector()), silence_s=60.0, submissions=submissions)
    own = settings_of(mosquitto, mqtt_client_id=f"taking-{uuid4().hex[:8]}")  # no session of an earlier test
    samples = MqttSamples(own, plant, submissions, WholeShare())
    ingest.start()
    samples.start()
    try:
        wait_until(lambda: samples.trouble is None)
        yield Taking(plant, submissions, ingest, samples)
    finally:
        samples.stop()
        ingest.stop()
