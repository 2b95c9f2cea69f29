"""Samples in and alerts out by way of a real MQTT broker, mosquitto on loopback with passwords, which is killed meanwhile.

Samples of 16 channels go to a real service at the rate that is asked for; then more slowly for a minute, in which the broker
is killed twice (SIGKILL) and comes back two seconds later: every number must be stored or counted as missing, none twice.
Alerts change and are delivered to a listener; after each kill of the broker with all that it kept, the last states must be
right again. Then what a service pays in which no broker is configured.

    python -m benchmarks.mqtt [--seconds 20] [--rate 5000] [--format msgpack]

The status is 1 where something falls short of what is asked.
"""

import argparse
import contextlib
import json
import logging
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import paho.mqtt.client as paho

from benchmarks import unconfigured_protocols
from benchmarks.alert_changes import alerting_machine, change_alert
from benchmarks.chain import PLANT, StoredSamples, create_machines
from benchmarks.throughput import template
from formats.wire import JSON, MESSAGEPACK, encode_body
from service.configuration.settings import Settings
from service.delivery.dispatcher import Dispatcher
from service.messaging.session import session as zenoh_session
from service.mqtt.publisher import MqttAlerts
from service.replication.work_share import WholeShare
from storage.alerts import alerts, deliveries
from storage.database.engine import Database
from tests.end_to_end.processes import Service, until
from tests.mosquitto import Mosquitto, broker

MACHINES, CHANNELS, SIZE = 10, 16, 50
RATE_ASKED = 5_000.0
BEHIND_ASKED_S = 5.0
"""Longest time after the last sample was published until all are stored."""
MINUTE_S, AWAY_S = 60.0, 2.0
TRANSITIONS, TRANSITION_RATE, TOLD_ASKED_S = 200, 10.0, 1.0
KILLS, RIGHT_ASKED_S = 3, 5.0


class Publisher:
    """A client of the broker that publishes all machines' samples, numbered from 0."""

    def __init__(self, mosquitto: Mosquitto, client: paho.Client, names: Sequence[str], encoding: str, *, epoch: int) -> None:
        self.mosquitto = mosquitto
        self.client = client
        self.encoding = encoding
        self.published = 0
        self._batches = [template(name, SIZE, CHANNELS) for name in names]
        for one in self._batches:
            one.source, one.epoch, one.sequence, one.plant = "mqtt", epoch, 0, PLANT

    def publish(self, rate: float, seconds: float) -> float:
        """Publish at a rate of all together; return the time that it took [s]."""
        step = SIZE * len(self._batches) / rate
        began, self._begun = time.monotonic(), time.time_ns()
        for number in range(round(seconds / step)):
            time.sleep(max(0.0, began + number * step - time.monotonic()))
            self._publish_round(step, self._begun + round(number * step * 1e9))
        took = time.monotonic() - began
        time.sleep(2.0 * step)  # the next samples are taken later than these
        return took

    def _publish_round(self, step: float, moment: int) -> None:
        """Publish a batch of each machine, whose last sample was taken at a time [ns]."""
        for one in self._batches:
            one.time_ns = (moment + (np.arange(SIZE) * step / SIZE * 1e9).astype(np.int64) - round(step * 1e9)).tolist()
            topic = f"rundown/v1/{one.plant}/{one.machine}/samples"
            self.last = self.client.publish(topic, encode_body(one, self.encoding), qos=1)
            one.sequence += SIZE
            self.published += SIZE


@contextlib.contextmanager
def killing(mosquitto: Mosquitto, *after_s: float) -> Iterator[None]:
    """Kill the broker at some times, each time for AWAY_S."""

    def kill() -> None:
        began = time.monotonic()
        for moment in after_s:
            time.sleep(max(0.0, began + moment - time.monotonic()))
            mosquitto.kill()
            time.sleep(AWAY_S)
            mosquitto.start()

    thread = threading.Thread(target=kill)
    thread.start()
    try:
        yield
    finally:
        thread.join()


def sources(service: Service, epoch: int) -> list[dict[str, Any]]:
    """Return what is stored of each source since an epoch."""
    return [one for one in service.get("/sources") if one["source"] == "mqtt" and one["epoch"] == epoch]


def settled(service: Service, epoch: int, published: int) -> bool:
    """Return whether the last number of every source is known."""
    return sum(int(one["next_sequence"]) for one in sources(service, epoch)) >= published


def samples_in(folder: Path, options: argparse.Namespace) -> bool:
    """Measure samples in; return whether all is as asked."""
    encoding = JSON if options.format == "json" else MESSAGEPACK
    with broker(folder / "mosquitto") as mosquitto:
        service = Service(folder, **mosquitto.environment)
        with service.running(), mosquitto.connected("rundown", "bench") as edge:
            names = create_machines(service, MACHINES, channels=CHANNELS)
            until(lambda: service.get("/health")["parts"]["mqtt_samples"] == "ok", within_s=30, what="the broker is used")
            fast = Publisher(mosquitto, edge.client, names, encoding, epoch=time.time_ns())
            epoch = fast._batches[0].epoch
            took = fast.publish(options.rate, options.seconds)
            ended = time.monotonic()
            until(lambda: settled(service, epoch, fast.published), within_s=120, what="all samples are stored")
            behind, rate = time.monotonic() - ended, fast.published / took
            found = sources(service, epoch)
            lost, stored = sum(one["lost"] for one in found), sum(one["received"] for one in found)
            print(f"samples of {CHANNELS} channels, {options.format}, {MACHINES} machines, batches of {SIZE}")
            print(f"  {'':<52}{'asked':>14}{'measured':>14}")
            print(f"  {'published and stored [1/s]':<52}{f'{options.rate:.0f}':>14}{rate:>14.0f}")
            print(f"  {'the last one stored after the last published [s]':<52}{f'< {BEHIND_ASKED_S:g}':>14}{behind:>14.2f}")
            print(f"  {'lost':<52}{'0':>14}{lost:>14}")
            good = rate >= 0.98 * float(options.rate) and behind < BEHIND_ASKED_S and lost == 0 and stored == fast.published
            good &= with_kills(service, mosquitto, edge.client, names, encoding)
        service.client.close()
    return bool(good)


def with_kills(service: Service, mosquitto: Mosquitto, client: paho.Client, names: list[str], encoding: str) -> bool:
    """Measure what is counted while the broker is killed twice in a minute; return whether it is exact."""
    slow = Publisher(mosquitto, client, names, encoding, epoch=time.time_ns())
    epoch = slow._batches[0].epoch
    before = {name: len(StoredSamples.read(service.database).times.get(name, ())) for name in names}
    with killing(mosquitto, MINUTE_S / 3, 2 * MINUTE_S / 3):
        slow.publish(RATE_ASKED, MINUTE_S)
    slow.publish(RATE_ASKED, 2.0)  # numbers behind the last gap
    until(slow.last.is_published, within_s=60, what="the broker has the last message")
    until(lambda: settled(service, epoch, slow.published), within_s=60, what="the last numbers are known")
    time.sleep(2.0)
    found = sources(service, epoch)
    received, lost = (sum(one[name] for one in found) for name in ("received", "lost"))
    again = sum(one["duplicates"] for one in found)
    samples = StoredSamples.read(service.database)
    stored = {name: samples.times[name][before[name] :] for name in names}
    twice = sum(len(times) - len(np.unique(times)) for times in stored.values())
    uncounted = slow.published - received - lost
    differs = received - sum(map(len, stored.values()))
    print(f"broker killed twice in {MINUTE_S:.0f} s at {RATE_ASKED:.0f}/s: published {slow.published}, stored {received}")
    print(f"  {'missing and counted':<52}{'':>14}{lost:>14}")
    print(f"  {'missing and not counted':<52}{'0':>14}{uncounted:>14}")
    print(f"  {'stored twice':<52}{'0':>14}{twice:>14}")
    print(f"  {'counted as stored and not there':<52}{'0':>14}{differs:>14}")
    print(f"  {'came again, and known by their numbers':<52}{'':>14}{again:>14}")
    return bool(uncounted == twice == differs == 0)


def alerts_out(folder: Path) -> bool:
    """Measure alerts out; return whether all is as asked."""
    logging.disable(logging.WARNING)
    database, number = alerting_machine(folder)
    with database.transaction() as session:
        deliveries.subscribe(session, kind="mqtt", name="broker", target="", secret=None)
    with broker(folder / "out") as mosquitto, zenoh_session(listen=["tcp/127.0.0.1:0"], connect=[]) as network:
        told = {name.removeprefix("RUNDOWN_").lower(): value for name, value in mosquitto.environment.items()}
        settings = Settings(**told)  # type: ignore[arg-type]
        publisher = MqttAlerts(settings, database, WholeShare())
        dispatcher = Dispatcher(database, network, settings, broker=publisher)
        publisher.start()
        dispatcher.start()
        try:
            until(lambda: publisher.trouble is None, within_s=30, what="the broker is used")
            delays = transitions(database, mosquitto, number)
            right = [after_a_kill(database, mosquitto, number) for _ in range(KILLS)]
        finally:
            dispatcher.stop()
            publisher.stop()
    database.close()
    p99 = float(np.quantile(delays, 0.99)) if delays else float("inf")
    print(f"{TRANSITIONS} transitions at {TRANSITION_RATE:g}/s, {len(delays)} heard")
    print(f"  {'transition to subscriber, p99 [s]':<52}{f'< {TOLD_ASKED_S:g}':>14}{p99:>14.3f}")
    print(f"  {f'last states right after each of {KILLS} kills [s]':<52}{f'< {RIGHT_ASKED_S:g}':>14}{max(right):>14.2f}")
    return p99 < TOLD_ASKED_S and max(right) < RIGHT_ASKED_S and len(delays) == TRANSITIONS


def change(database: Database, identified: int, number: int) -> tuple[int, int]:
    """Raise, acknowledge or clear the alert of one of ten elements; return the event's alert and number."""
    with database.transaction() as session:
        row = change_alert(session, f"coupling.C{number % 10}", identified)
        return row.id, row.event_count


def transitions(database: Database, mosquitto: Mosquitto, identified: int) -> list[float]:
    """Return how long after its commit each change of alerts was heard [s]."""
    heard: dict[tuple[int, int], float] = {}
    committed: dict[tuple[int, int], float] = {}

    def hear(_client: object, _data: object, message: paho.MQTTMessage) -> None:
        told = json.loads(message.payload)
        heard.setdefault((told["alert"], told["number"]), time.monotonic())

    with mosquitto.connected("hmi", "", "rundown/v1/+/+/alerts/#") as hmi:
        hmi.client.on_message = hear
        for number in range(TRANSITIONS):
            event = change(database, identified, number)
            committed[event] = time.monotonic()
            time.sleep(1.0 / TRANSITION_RATE)
        deadline = time.monotonic() + 20.0
        while len(heard) < len(committed) and time.monotonic() < deadline:
            time.sleep(0.05)
    return [heard[event] - moment for event, moment in committed.items() if event in heard]


def after_a_kill(database: Database, mosquitto: Mosquitto, identified: int) -> float:
    """Kill the broker with all that it kept, change alerts, start it; return when the last states are right again [s]."""
    mosquitto.kill()
    (mosquitto.folder / "mosquitto.db").unlink(missing_ok=True)
    for number in range(10):
        change(database, identified, number)
    time.sleep(1.0)
    mosquitto.start()
    began = time.monotonic()
    with database.reading() as session:
        wanted = {row.element: row.state for row in alerts.last_events(session, limit=100)}
    with mosquitto.connected("hmi", "", "rundown/v1/+/+/alerts/#") as hmi:
        while time.monotonic() < began + 60.0:
            last = {str(one.topic).rpartition("/")[2]: json.loads(one.payload)["state"] for one in list(hmi.heard)}
            if last == wanted:
                return time.monotonic() - began
            time.sleep(0.02)
    return float("inf")


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the figures; status 1 where one falls short."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.mqtt", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--rate", type=float, default=RATE_ASKED)
    parser.add_argument("--format", choices=["json", "msgpack"], default="msgpack")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        good = [samples_in(Path(folder), options), alerts_out(Path(folder))]
    good.append(unconfigured_protocols.report(unconfigured_protocols.measured(rounds=2)))
    if not all(good):
        sys.exit(1)


if __name__ == "__main__":
    main()
