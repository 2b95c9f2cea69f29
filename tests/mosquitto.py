"""A real MQTT broker for the tests: Debian's mosquitto on loopback, with TLS and passwords, ended by its process id."""

import contextlib
import os
import socket
import subprocess
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import paho.mqtt.client as mqtt
from paho.mqtt.enums import CallbackAPIVersion
from paho.mqtt.packettypes import PacketTypes
from paho.mqtt.properties import Properties

from tests.paths import ROOT
from tests.ports import free_port
from tests.programs import program

USERS = {"rundown": "taken by the service", "edge": "publishes", "hmi": "listens"}
"""Users of the broker and their passwords."""
ACL = """
user rundown
topic readwrite #
user edge
topic write rundown/v1/plant-1/+/samples
topic readwrite spBv1.0/#
user hmi
topic read rundown/v1/#
"""
"""Access rules: the edge publishes samples of its own plant, the HMI listens."""


class BrokerListener:
    """A client of the broker and what it has heard."""

    def __init__(self, client: mqtt.Client, topics: tuple[str, ...]) -> None:
        self.client = client
        self.heard: list[mqtt.MQTTMessage] = []
        self.subscribed = threading.Event()
        client.on_message = lambda _client, _data, message: self.heard.append(message)
        client.on_subscribe = lambda *_: self.subscribed.set()
        client.on_connect = self._connected
        self._topics = topics

    def _connected(self, client: mqtt.Client, *_: object) -> None:
        if self._topics:
            client.subscribe([(one, 1) for one in self._topics])
        else:
            self.subscribed.set()

    def publish(
        self, topic: str, payload: bytes, *, qos: int = 1, retain: bool = False, kind: str = ""
    ) -> mqtt.MQTTMessageInfo:
        """Publish a message; it is sent again until the broker has it."""
        told = Properties(PacketTypes.PUBLISH)  # type: ignore[no-untyped-call]
        if kind:
            told.ContentType = kind
        return self.client.publish(topic, payload, qos, retain, told)

    def last(self, topic: str) -> bytes | None:
        """Return the last payload under a topic; None before any."""
        found = [bytes(one.payload or b"") for one in self.heard if one.topic == topic]
        return found[-1] if found else None


def _lasting() -> Properties:
    told = Properties(PacketTypes.CONNECT)  # type: ignore[no-untyped-call]
    told.SessionExpiryInterval = 3600
    return told


class Mosquitto:
    """A broker that can be killed and started again at the same port. folder: for its files; it must not be there yet."""

    def __init__(self, folder: Path, *, tls: bool = True) -> None:
        folder.mkdir()
        self.folder = folder
        self.port = free_port()
        self.tls = tls
        self._process: subprocess.Popen[bytes] | None = None
        if tls:
            done = [str(ROOT / "deploy" / "certificates.sh"), str(folder)]
            for words in (["authority"], ["service", "localhost", "127.0.0.1"]):
                subprocess.run([*done, *words], check=True, capture_output=True, timeout=30)
        (folder / "passwords").write_text("".join(f"{name}:{word}\n" for name, word in USERS.items()))
        subprocess.run([program("mosquitto_passwd"), "-U", str(folder / "passwords")], check=True, capture_output=True)
        (folder / "acl").write_text(ACL)
        (folder / "password").write_text(USERS["rundown"])
        for one in folder.iterdir():
            one.chmod(0o600)
        lines = [
            f"listener {self.port} 127.0.0.1",
            "allow_anonymous false",
            f"password_file {folder / 'passwords'}",
            f"acl_file {folder / 'acl'}",
            "persistence true",
            f"persistence_location {folder}/",
            "autosave_interval 1",
            "max_queued_messages 100000",
            f"user {_own_name()}",
        ]
        if tls:
            lines += [f"certfile {folder / 'service.crt'}", f"keyfile {folder / 'service.key'}"]
        (folder / "mosquitto.conf").write_text("\n".join(lines) + "\n")

    @property
    def url(self) -> str:
        """Return the URL by which the service is told of it."""
        return f"{'mqtts' if self.tls else 'mqtt'}://localhost:{self.port}"

    @property
    def environment(self) -> dict[str, str]:
        """Return the settings of a service that uses it."""
        of_tls = {"RUNDOWN_MQTT_TLS_CA": str(self.folder / "authority.crt")} if self.tls else {}
        return of_tls | {
            "RUNDOWN_MQTT_URL": self.url,
            "RUNDOWN_MQTT_USER": "rundown",
            "RUNDOWN_MQTT_PASSWORD_FILE": str(self.folder / "password"),
        }

    def start(self) -> None:
        """Start it, and wait until it listens."""
        with (self.folder / "log").open("ab") as log:
            command = [program("mosquitto"), "-c", str(self.folder / "mosquitto.conf")]
            self._process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
        deadline = time.monotonic() + 15.0
        while True:
            with contextlib.suppress(OSError):
                socket.create_connection(("127.0.0.1", self.port), timeout=1.0).close()
                return
            assert time.monotonic() < deadline, (self.folder / "log").read_text()
            time.sleep(0.02)

    def kill(self) -> None:
        """Kill it, as a power cut does."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            self._process = None

    def client(self, user: str, name: str = "", *, password: str | None = None) -> mqtt.Client:
        """Return a client of one of the users that is not connected yet; with a name its session lasts."""
        client = mqtt.Client(CallbackAPIVersion.VERSION2, client_id=name, protocol=mqtt.MQTTv5)
        client.username_pw_set(user, password or USERS[user])
        if self.tls:
            client.tls_set(str(self.folder / "authority.crt"))
        client.reconnect_delay_set(0.1, 0.5)  # type: ignore[arg-type]
        client.max_queued_messages_set(0)
        return client

    @contextlib.contextmanager
    def connected(self, user: str, name: str = "", *topics: str) -> Iterator[BrokerListener]:
        """A connected client, which hears some topics."""
        client = self.client(user, name)
        heard = BrokerListener(client, topics)
        client.connect_async("localhost", self.port, clean_start=not name, properties=_lasting() if name else None)
        client.loop_start()
        try:
            assert heard.subscribed.wait(15.0), f"{user} cannot connect"
            yield heard
        finally:
            client.disconnect()
            client.loop_stop()


def _own_name() -> str:
    """Return the user who runs the tests: as root the broker would otherwise become another, who may not read its files."""
    import pwd

    return pwd.getpwuid(os.getuid()).pw_name


@contextlib.contextmanager
def broker(folder: Path, *, tls: bool = True) -> Iterator[Mosquitto]:
    """A running broker."""
    one = Mosquitto(folder, tls=tls)
    one.start()
    try:
        yield one
    finally:
        one.kill()
