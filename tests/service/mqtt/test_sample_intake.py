"""Samples from a real broker with TLS, passwords and rules of access: counted as over zenoh without a log, none twice."""

import gc
import json
import time
from pathlib import Path

import aiomqtt
import pytest
import zenoh

from formats.wire import BINARY, JSON, MESSAGEPACK, encode_body
from service.ingest.ingest_thread import Ingest
from service.mqtt.broker import LARGEST_PACKET
from service.mqtt.sample_intake import MqttSamples, PublishedBody
from service.replication.work_share import WholeShare
from service.runs.collector import Collector
from service.write_path.http_queue import Submissions
from service.write_path.sample_writer import SampleWriter
from storage.database.engine import Database
from storage.measurements import quarantine
from tests.mosquitto import Mosquitto
from tests.plant import KEY, SECOND, START, batch, wait_until
from tests.service.ingest.plant_network import counts, received, rejected, rows, stored_times
from tests.service.mqtt.conftest import Taking, settings_of

TOPIC = f"rundown/v1/{KEY.plant}/{KEY.machine}/samples"


def body(first: int, last: int, encoding: str = JSON, **changes: object) -> bytes:
    """Samples `first` to before `last`, a second apart."""
    return encode_body(batch([900.0] * (last - first), sequence=first, start=START + first * SECOND, **changes), encoding)  # type: ignore[arg-type]


def test_every_encoding_is_taken_with_and_without_its_name(mosquitto: Mosquitto, taking: Taking) -> None:
    with mosquitto.connected("edge") as edge:
        for number, (encoding, named) in enumerate(
            (one, name) for one in (JSON, MESSAGEPACK, BINARY) for name in (True, False)
        ):
            edge.publish(TOPIC, body(5 * number, 5 * number + 5, encoding), kind=encoding if named else "")
        wait_until(lambda: received(taking.database) == 30)
    assert stored_times(taking.database) == list(range(30))
    assert counts(taking.database) == (30, 30, 0)


def test_missing_numbers_are_counted_and_repeated_ones_stored_once(mosquitto: Mosquitto, taking: Taking) -> None:
    with mosquitto.connected("edge") as edge:
        for first in (0, 5, 5, 20, 0, 10):
            edge.publish(TOPIC, body(first, first + 5))
        wait_until(lambda: received(taking.database) == 20 and sum(row.duplicates for row in rows(taking.database)) == 10)
    assert counts(taking.database) == (25, 20, 5)


def test_every_quality_is_taken_and_of_a_message_that_is_too_large_the_numbers_are_missing(
    mosquitto: Mosquitto, taking: Taking
) -> None:
    """The broker keeps what is larger than the service takes to itself; the next one comes."""
    with mosquitto.connected("edge") as edge:
        for qos in (0, 1, 2):
            edge.publish(TOPIC, body(5 * qos, 5 * qos + 5), qos=qos).wait_for_publish(5.0)
        edge.publish(TOPIC, body(15, 20) + b" " * LARGEST_PACKET)
        edge.publish(TOPIC, body(20, 25))
        wait_until(lambda: counts(taking.database)[0] == 25)
    assert counts(taking.database) == (25, 20, 5)
    assert taking.samples.trouble is None


def test_what_is_wrong_is_refused_in_words(mosquitto: Mosquitto, taking: Taking) -> None:
    """A retained message of last year, another plant's machine, an unknown one, and what is no batch at all."""
    with mosquitto.connected("rundown") as anybody:
        other = "rundown/v1/plant-2/pump-7/samples"
        anybody.publish(other, body(0, 1))
        anybody.publish("rundown/v1/plant-1/pump-99/samples", body(0, 1, machine="pump-99"))
        anybody.publish("rundown/v1/plant-1/pump 9/samples", b"{}")
        anybody.publish(TOPIC, b"\xff\xfe nothing")
        anybody.publish(TOPIC, b"")
        wait_until(lambda: sum(rejected(taking.database).values()) == 5)
    found = {name: count for name, count in rejected(taking.database).items() if count}
    assert found == {"key_mismatch": 2, "unknown_machine": 1, "undecodable": 2}
    with taking.database.reading() as session:
        words = [row.detail for row in quarantine.newest(session, reason="key_mismatch", machine_id=None, limit=9)]
        keys = [row.key for row in quarantine.newest(session, reason=None, machine_id=None, limit=9)]
    assert "body says plant-1/pump-7, topic says plant-2/pump-7" in words
    assert f"mqtt {other}" in keys
    assert received(taking.database) == 0


def test_a_retained_sample_is_refused_once(mosquitto: Mosquitto, router: zenoh.Session, plant: Database) -> None:
    """Its age is not known; whoever connects again is not told of it again."""
    submissions = Submissions()
    ingest = Ingest(router, SampleWriter(plant, Collector()), silence_s=60.0, submissions=submissions)
    ingest.start()
    with mosquitto.connected("edge") as edge:
        edge.publish(TOPIC, body(0, 5), retain=True).wait_for_publish(5.0)
        try:
            for _ in range(2):
                samples = MqttSamples(settings_of(mosquitto, mqtt_client_id="retained"), plant, submissions, WholeShare())
                samples.start()
                wait_until(lambda: rejected(plant).get("retained") == 1)
                samples.stop()
        finally:
            samples.stop()
            ingest.stop()
            edge.publish(TOPIC, b"", retain=True).wait_for_publish(5.0)
    assert received(plant) == 0


def test_what_comes_while_the_service_is_away_waits_at_the_broker(
    mosquitto: Mosquitto, router: zenoh.Session, plant: Database
) -> None:
    submissions = Submissions()
    ingest = Ingest(router, SampleWriter(plant, Collector()), silence_s=60.0, submissions=submissions)
    ingest.start()
    try:
        with mosquitto.connected("edge") as edge:
            for first in (0, 10):
                samples = MqttSamples(settings_of(mosquitto, mqtt_client_id="away"), plant, submissions, WholeShare())
                samples.start()
                wait_until(lambda: samples.trouble is None)  # noqa: B023
                edge.publish(TOPIC, body(first, first + 5))
                wait_until(lambda: received(plant) == first + 5)  # noqa: B023
                samples.stop()
                if first == 0:
                    edge.publish(TOPIC, body(5, 10)).wait_for_publish(5.0)
        assert counts(plant) == (15, 15, 0)
    finally:
        ingest.stop()


def test_nothing_is_confirmed_before_it_is_durable(mosquitto: Mosquitto, router: zenoh.Session, plant: Database) -> None:
    """A service that dies with messages in its hands gets them again."""
    never = Submissions()
    samples = MqttSamples(settings_of(mosquitto, mqtt_client_id="dies"), plant, never, WholeShare())
    samples.start()
    wait_until(lambda: samples.trouble is None)
    with mosquitto.connected("edge") as edge:
        edge.publish(TOPIC, body(0, 5))
        wait_until(lambda: len(never) == 1)
        samples.stop()
    submissions = Submissions()
    ingest = Ingest(router, SampleWriter(plant, Collector()), silence_s=60.0, submissions=submissions)
    samples = MqttSamples(settings_of(mosquitto, mqtt_client_id="dies"), plant, submissions, WholeShare())
    ingest.start()
    samples.start()
    try:
        wait_until(lambda: received(plant) == 5)
    finally:
        samples.stop()
        ingest.stop()


def test_a_broker_that_is_away_hinders_nobody_and_is_found_again(tmp_path: Path, taking: Taking) -> None:
    """A message that a killed broker had taken and not passed on is lost, and counted as soon as a later number comes."""
    one = Mosquitto(tmp_path / "mosquitto", tls=False)
    samples = MqttSamples(settings_of(one), taking.database, taking.submissions, WholeShare())
    samples.start()
    try:
        wait_until(lambda: samples.trouble is not None and "cannot be used" in samples.trouble)
        assert samples.gauges["rundown_mqtt_samples_connected"] == 0
        one.start()
        wait_until(lambda: samples.trouble is None)
        with one.connected("edge", "edge-7") as edge:
            edge.publish(TOPIC, body(0, 5))
            wait_until(lambda: received(taking.database) == 5)
            one.kill()
            wait_until(lambda: samples.trouble is not None)
            edge.publish(TOPIC, body(5, 10))
            one.start()
            wait_until(lambda: samples.trouble is None)
            edge.publish(TOPIC, body(10, 15))
            wait_until(lambda: counts(taking.database)[0] == 15)
        _, stored, lost = counts(taking.database)
        assert stored + lost == 15
        assert sorted(set(stored_times(taking.database))) == stored_times(taking.database)
    finally:
        samples.stop()
        one.kill()


@pytest.mark.filterwarnings("ignore::ResourceWarning")  # the library leaves sockets of failed handshakes to the collector
def test_a_wrong_password_and_a_refused_subscription_are_named(mosquitto: Mosquitto, plant: Database) -> None:
    told = settings_of(mosquitto, mqtt_password_file="", mqtt_password="wrong", mqtt_client_id="wrong")
    wrong = MqttSamples(told, plant, Submissions(), WholeShare())
    told = settings_of(mosquitto, mqtt_tls_ca="", mqtt_client_id="strange")
    refused = MqttSamples(told, plant, Submissions(), WholeShare())
    for samples, words in ((wrong, "ot authori"), (refused, "certificate verify failed")):
        samples.start()
        try:
            wait_until(lambda: words in (samples.trouble or ""), seconds=20.0)  # noqa: B023
        finally:
            samples.stop()
    del wrong, refused
    gc.collect()


def test_a_database_that_is_away_keeps_messages_at_the_broker(mosquitto: Mosquitto, taking: Taking) -> None:
    taking.submissions.trouble = "the database is away"
    with mosquitto.connected("edge") as edge:
        edge.publish(TOPIC, body(0, 5))
        deadline = time.monotonic() + 0.5
        while time.monotonic() < deadline:
            taking.submissions.trouble = "the database is away"
        taking.submissions.trouble = None
        wait_until(lambda: received(taking.database) == 5)
    assert taking.samples.gauges["rundown_mqtt_messages_given_up"] == 0


def test_a_message_that_cannot_be_read_is_given_up_and_the_next_one_taken(
    mosquitto: Mosquitto, taking: Taking, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A fault of ours: unconfirmed it would come again at each connection, and nothing behind it."""
    right = taking.samples._bodies_of

    def failing(message: aiomqtt.Message) -> list[PublishedBody]:
        if message.payload == b"fatal":
            raise OverflowError("can't serialize")
        return right(message)

    monkeypatch.setattr(taking.samples, "_bodies_of", failing)
    with mosquitto.connected("edge") as edge:
        edge.publish(TOPIC, b"fatal")
        edge.publish(TOPIC, body(0, 5))
        wait_until(lambda: received(taking.database) == 5)
    assert taking.samples.gauges["rundown_mqtt_messages_given_up"] == 1
    assert taking.samples.trouble is None


def test_json_of_the_schema_is_what_the_documentation_shows() -> None:
    """A batch is one object, its topic that of docs/mqtt.md."""
    assert json.loads(body(0, 1))["schema"] == 1
