"""Bad input to running processes: it ends in the quarantine or in a clear message, never in a crash."""

import socket
import subprocess
import time
from pathlib import Path

import httpx
import msgspec
import pytest
import zenoh

from formats.wire import LARGEST_MESSAGE, MESSAGEPACK, Key, SampleBatch, encode_batch, frame
from service.messaging.session import session as zenoh_session
from service.messaging.session import wait_connected
from tests.end_to_end.processes import EXAMPLES, Service, example, process, rundown, until
from tests.end_to_end.test_real_input import ROSS, ross_batch
from tests.ports import free_port

KEY = Key("examples", ROSS)


def some(count: int = 3, **changes: object) -> SampleBatch:
    """A short good batch, with changes that spoil it."""
    batch = ross_batch(seed=0, start_s=1_700_000_000)
    batch.source = "bad"
    batch.time_ns, batch.speed = batch.time_ns[:count], batch.speed[:count]
    batch.amplitude, batch.phase = batch.amplitude[:count], batch.phase[:count]
    return msgspec.structs.replace(batch, **changes)


def spoiled(values: list[list[float | None]], value: float) -> list[list[float | None]]:
    """The table with another value in its first place."""
    return [[value, *values[0][1:]], *values[1:]]


def bad_messages() -> dict[str, tuple[str, bytes]]:
    """A message for each reason."""
    good = some()
    step = 1_000_000_000
    late = ross_batch(seed=0, start_s=1_700_000_000).time_ns[0]
    return {
        "too_large": (KEY.samples, frame(b"x" * (LARGEST_MESSAGE + 1))),
        "bad_frame": (KEY.samples, encode_batch(good)[:-1] + b"?"),
        "undecodable": (KEY.samples, frame(b"\xc1 nothing")),
        "future_schema": (KEY.samples, encode_batch(some(schema=2))),
        "key_mismatch": ("rundown/v1/examples/other/samples", encode_batch(good)),
        "unknown_machine": ("rundown/v1/examples/nobody/samples", encode_batch(some(machine="nobody"))),
        "unknown_channel": (KEY.samples, encode_batch(some(source="b1", channels=[*good.channels[:-1], "B9Z"]))),
        "unknown_condition": (KEY.samples, encode_batch(some(source="b10", conditions={"humidity": [40.0] * 3}))),
        "wrong_unit": (KEY.samples, encode_batch(some(source="b2", amplitude_unit="furlong"))),
        "wrong_shape": (KEY.samples, encode_batch(some(source="b3", speed=[1.0]))),
        "not_finite": (KEY.samples, encode_batch(some(source="b4", amplitude=spoiled(good.amplitude, float("nan"))))),
        "speed_out_of_range": (KEY.samples, encode_batch(some(source="b5", speed=[1.0, 1e9, 2.0]))),
        "speed_out_of_order": (KEY.samples, encode_batch(some(source="b6", speed=[10.0, 600.0, 11.0]))),
        "amplitude_out_of_range": (KEY.samples, encode_batch(some(source="b7", amplitude=spoiled(good.amplitude, 7.0)))),
        "time_out_of_range": (KEY.samples, encode_batch(some(source="b8", time_ns=[1, late + step, late + 2 * step]))),
        "time_out_of_order": (KEY.samples, encode_batch(some(source="b9", time_ns=[late, late - step, late + step]))),
    }


def test_each_kind_of_bad_message_is_counted_kept_and_harmless(service: Service) -> None:
    messages = bad_messages()
    with service.running() as serving, zenoh_session(listen=[], connect=[service.endpoint]) as stream:
        service.create(ROSS)
        assert wait_connected(stream, [service.endpoint], give_up=lambda _seconds: False)
        for key, payload in messages.values():
            stream.put(key, payload, encoding=MESSAGEPACK, congestion_control=zenoh.CongestionControl.BLOCK)
        until(
            lambda: set(service.get("/quarantine")["counts"]) == set(messages),
            within_s=20,
            what="every reason is counted",
        )
        assert service.get("/quarantine")["counts"] == dict.fromkeys(messages, 1)
        for reason in messages:
            entries = service.get("/quarantine", reason=reason)["entries"]
            assert len(entries) == 1
            assert entries[0]["detail"]
        stored = service.get(f"/machines/{ROSS}/samples")
        assert all(value is None or abs(value) < 1e5 for column in stored["amplitude_um_pp"] for value in column)
        assert max(stored["speed_rpm"]) < 200
        assert service.get("/health")["healthy"]
        assert serving.poll() is None


@pytest.mark.parametrize("database", ["sqlite:///{folder}", "sqlite:////nowhere/rundown.db", "nonsense"])
def test_unusable_database_is_said_and_ends(tmp_path: Path, database: str) -> None:
    ended = rundown("serve", "--database", database.format(folder=tmp_path), "--port", "0")
    assert ended.returncode == 1
    assert "cannot be used" in ended.stderr
    assert "Traceback" not in ended.stderr


def test_port_in_use_is_said_and_ends(tmp_path: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        url = f"sqlite:///{tmp_path / 'x.db'}"
        rest = rundown("serve", "--database", url, "--port", str(port))
        stream = rundown("serve", "--database", url, "--port", "0", "--zenoh-listen", f"tcp/127.0.0.1:{port}")
    for ended in (rest, stream):
        assert ended.returncode == 1
        assert f"127.0.0.1:{port}" in ended.stderr
        assert "in use" in ended.stderr
        assert "Traceback" not in ended.stderr


def test_no_zenoh_peer_is_said_and_waited_for(tmp_path: Path) -> None:
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    log = tmp_path / "simulate.log"
    arguments = [f"{EXAMPLES / ROSS}.yaml", "--cycles", "1", "--samples", "40", "--rate", "1000", "--connect", endpoint]
    with process(log, "simulate", *arguments) as waiting:
        until(lambda: "no zenoh peer" in log.read_text(), within_s=20, what="the simulator says that it waits")
        time.sleep(0.5)
        assert waiting.poll() is None
        with zenoh_session(listen=[endpoint], connect=[]):
            assert waiting.wait(30) == 0


def test_service_without_its_router_is_healthy_but_not_ready(service: Service, tmp_path: Path) -> None:
    router = f"tcp/127.0.0.1:{free_port()}"
    flags = ["--database", f"sqlite:///{tmp_path / 'x.db'}", "--port", str(service.port), "--zenoh-connect", router]

    def answers(path: str, code: int) -> bool:
        try:
            return service.client.get(path).status_code == code
        except httpx.TransportError:
            return False

    with process(service.log, "serve", *flags) as serving:
        until(lambda: answers("/health", 200), within_s=30, what="healthy")
        assert answers("/ready", 503)
        assert "no zenoh router answers" in service.client.get("/ready").json()["parts"]["stream"]
        assert 'rundown_part_ok{part="stream"} 0.0' in httpx.get(f"http://127.0.0.1:{service.port}/metrics").text
        with zenoh_session(listen=[router], connect=[]):
            until(lambda: answers("/ready", 200), within_s=20, what="ready once its router answers")
        ends_cleanly(serving)


def ends_cleanly(serving: "subprocess.Popen[bytes]") -> None:
    """Return whether it ends on SIGTERM with status 0."""
    serving.terminate()
    assert serving.wait(20) == 0


@pytest.mark.parametrize(
    ("machine", "said"),
    [("rk4-rotor-kit.yaml", "must give nominal values of disc.D1.unbalance"), ("rk4-rotor-kit.yam", "No such file")],
)
def test_machine_that_cannot_be_simulated_is_said_and_ends(machine: str, said: str) -> None:
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    with zenoh_session(listen=[endpoint], connect=[]):
        ended = rundown("simulate", str(EXAMPLES / machine), "--rate", "100", "--connect", endpoint)
    assert ended.returncode == 1
    assert said in ended.stderr
    assert "Traceback" not in ended.stderr


def test_wrong_document_names_the_field_on_the_command_line(tmp_path: Path) -> None:
    document = (EXAMPLES / f"{ROSS}.yaml").read_text().replace("shaft: S2, station: 0.5", "shaft: S7, station: 0.5")
    (tmp_path / "wrong.yaml").write_text(document)
    ended = rundown("identify", str(tmp_path / "wrong.yaml"), str(tmp_path / "none.csv"))
    assert ended.returncode == 1
    assert "discs[2].shaft: 'S7' is not one of the shafts: S1, S2" in ended.stderr


def test_wrong_document_names_the_field_over_rest(service: Service) -> None:
    with service.running():
        document = example(ROSS)
        document["bearings"][1]["kxx"] = -1
        answer = service.client.post("/machines", json=document)
        assert answer.status_code == 422
        assert answer.headers["content-type"] == "application/problem+json"
        assert [error["field"] for error in answer.json()["errors"]] == ["bearings[1].kxx"]
