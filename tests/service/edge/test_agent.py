"""The agent over a real loopback network: what it publishes, what it says of itself, and how it goes on."""

import copy
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
import yaml
import zenoh
from typer.testing import CliRunner

from formats.wire import SampleBatch, decode_batch, to_samples
from service.commands.app import app
from service.commands.edge import open_log
from service.edge import topic as topic_module
from service.edge.agent import Agent
from service.edge.condition import CONDITIONS
from service.edge.configuration import EdgeConfiguration
from service.edge.topic import Topic
from service.edge.waveform_message import encode_waveforms
from service.sources.publisher import Source
from service.sources.sqlite_replay_log import SqliteReplayLog
from storage.encoding.sample_blocks import Samples, join
from tests.plant import KEY, assert_same_samples, document, listened_to, machine, wait_until
from tests.waveforms import RATE, START_NS, edge_document, recorded, true_phasors

TOPIC = "rundown/v1/plant-1/pump-7/waveforms"
SECONDS = 20.0
WAVEFORMS = recorded(SECONDS, rpm=900.0, ramp=30.0, noise=0.02)


def write(path: Path, waveforms: Any = WAVEFORMS) -> None:
    np.savez(path, **dict(zip("KAB", waveforms, strict=True)))


def configured(folder: Path, **changes: Any) -> EdgeConfiguration:
    """Configuration with its paths in a folder."""
    document = copy.deepcopy(edge_document(**changes))
    for file in document["waveforms"].get("files", []):
        file["path"] = str(folder / file["path"])
    document["log"]["path"] = str(folder / document["log"]["path"])
    return EdgeConfiguration.model_validate(document)


@contextmanager
def started(client: zenoh.Session, configuration: EdgeConfiguration) -> Iterator[Agent]:
    with Source(client, KEY, name="edge", log=open_log(configuration)) as source:
        agent = Agent(configuration, source)
        source.declare_status(lambda: msgspec.json.encode(agent.status()))
        yield agent


def logged(configuration: EdgeConfiguration) -> list[SampleBatch]:
    """All that was published, from the log; numbered without a hole."""
    log = open_log(configuration)
    entries = log.entries_from(0, 10_000)
    log.close()
    batches = [decode_batch(KEY, entry.payload, entry.encoding) for entry in entries]
    starts = [batch.sequence for batch in batches]
    assert starts == [sum(len(batch.time_ns) for batch in batches[:k]) for k in range(len(batches))]
    return batches


def samples(configuration: EdgeConfiguration) -> Samples:
    document = machine()
    parts = [to_samples(batch, document, received_at=2 * START_NS) for batch in logged(configuration)]
    assert all(taken.all() and not faults for _, taken, faults in parts)
    return join([part for part, _, _ in parts], channels=len(document.probes))


@pytest.fixture(scope="module")
def undisturbed(client: zenoh.Session, tmp_path_factory: pytest.TempPathFactory) -> Samples:
    folder = tmp_path_factory.mktemp("undisturbed")
    write(folder / "run.npz")
    configuration = configured(folder)
    with started(client, configuration) as agent:
        agent.read_files(threading.Event())
    return samples(configuration)


def test_samples_are_the_machines_phasors_in_metres(undisturbed: Samples) -> None:
    """0.02 V of noise on 0.5 and 0.6 V; sensitivities of 8000 and 4000 V/m."""
    first, second = true_phasors(2)
    assert len(undisturbed) == 40
    for column, sensitivity in enumerate((8000.0, 4000.0)):
        true = first[column] / sensitivity
        error = undisturbed.phasor[:, column] - true
        scatter = undisturbed.scatter[:, column]
        assert np.sqrt(np.mean(np.abs(error) ** 2)) == pytest.approx(np.sqrt(np.mean(scatter**2)), rel=0.4)
        assert np.max(np.abs(error / true)) < 0.01
        assert undisturbed.second[:, column] == pytest.approx(np.full(40, second[column] / sensitivity), rel=0.05)
    assert np.isnan(undisturbed.phasor[:, 2:]).all()
    rpm = undisturbed.speed * 30.0 / np.pi
    assert rpm == pytest.approx(900.0 + 30.0 * (undisturbed.time - START_NS) / 1e9, rel=1e-3)
    assert (np.diff(undisturbed.time) > 0).all()


def test_means_are_sent_as_gaps_only_where_the_configuration_says_so(client: zenoh.Session, tmp_path: Path) -> None:
    marks, *probes = WAVEFORMS
    write(tmp_path / "run.npz", (marks, *(probe - level for probe, level in zip(probes, (3.0, 4.0), strict=True))))
    configuration = configured(tmp_path, gap=True)
    with started(client, configuration) as agent:
        agent.read_files(threading.Event())
    told = [{**probe, "gap_grows": "towards"} for probe in document()["probes"]]
    parts = [to_samples(one, machine(probes=told), received_at=2 * START_NS) for one in logged(configuration)]
    assert all(not faults for _, _, faults in parts)
    found = join([part for part, _, _ in parts], channels=4).gap
    assert found[:, 0] == pytest.approx(np.full(len(found), -12.0 / 8000.0), abs=1e-6)
    assert found[:, 1] == pytest.approx(np.full(len(found), -13.0 / 4000.0), abs=2e-6)
    assert np.isnan(found[:, 2:]).all()


def test_overall_levels_are_sent_where_the_configuration_says_so(client: zenoh.Session, tmp_path: Path) -> None:
    """A line at ten times the speed is in the overall level, not in 1× and 2×."""
    write(tmp_path / "run.npz")
    configuration = configured(tmp_path, overall=True)
    with started(client, configuration) as agent:
        agent.read_files(threading.Event())
    parts = [to_samples(one, machine(), received_at=2 * START_NS) for one in logged(configuration)]
    assert all(not faults for _, _, faults in parts)
    found = join([part for part, _, _ in parts], channels=4)
    one, two = np.abs(found.phasor[:, :2]), np.abs(found.second[:, :2])
    assert np.all(found.overall[:, :2] > one)
    assert np.all(found.overall[:, :2] < 1.3 * (one + two))
    assert np.isnan(found.overall[:, 2:]).all()


def test_without_that_neither_gap_nor_overall_level_is_sent(undisturbed: Samples) -> None:
    assert np.isnan(undisturbed.gap).all()
    assert np.isnan(undisturbed.overall).all()


def interrupted(
    client: zenoh.Session, configuration: EdgeConfiguration, blocks: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Starts that take so many blocks each and are then cut off without a chance to publish what they have gathered."""
    monkeypatch.setattr("service.edge.agent.BATCH_SAMPLES", 3)
    for count in blocks:
        with started(client, configuration) as agent:
            take, left = agent._take, count
            stop = threading.Event()

            def counted(*arguments: Any, take: Any = take, stop: threading.Event = stop) -> None:
                nonlocal left
                if left == 0:
                    stop.set()
                    return
                left -= 1
                take(*arguments)

            monkeypatch.setattr(agent, "_take", counted)
            agent.read_files(stop)


def test_stopped_anywhere_and_started_again_it_publishes_the_same_once(
    client: zenoh.Session, tmp_path: Path, undisturbed: Samples, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path / "run.npz")
    configuration = configured(tmp_path)
    interrupted(client, configuration, [0, 1, 2, 4, 5, 6, 7, 8, 40], monkeypatch)
    assert_same_samples(samples(configuration), undisturbed)


def test_so_it_does_with_times_in_the_file(client: zenoh.Session, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Times to a microsecond show a slightly different sampling rate in every part of the file."""
    part = WAVEFORMS[:, : round(12 * RATE)]
    seconds = np.arange(part.shape[1]) / RATE
    seconds[round(5 * RATE) :] += 2.0
    rows = np.column_stack([seconds, part.T])
    found = []
    for name, blocks in (("whole", [100]), ("parts", [2, 5, 7, 100])):
        folder = tmp_path / name
        folder.mkdir()
        np.savetxt(folder / "run.csv", rows, delimiter=",", header="t,K,A,B", comments="", fmt="%.6f")
        files = [{"path": "run.csv", "start": "2023-11-14T22:13:20Z"}]
        configuration = configured(folder, waveforms={"files": files, "time": "t"})
        interrupted(client, configuration, blocks, monkeypatch)
        found.append(samples(configuration))
    assert len(found[0]) >= 22
    assert_same_samples(found[1], found[0])


def test_files_one_after_the_other_and_one_that_is_not_later(client: zenoh.Session, tmp_path: Path) -> None:
    for name in ("a.npz", "b.npz", "c.npz"):
        write(tmp_path / name, WAVEFORMS[:, : round(4 * RATE)])
    (tmp_path / "broken.npz").write_text("nothing")
    files = [
        {"path": "a.npz", "start": "2023-11-14T22:13:20Z"},
        {"path": "broken.npz", "start": "2023-11-14T22:13:30Z"},
        {"path": "b.npz", "start": "2023-11-14T22:14:00Z"},
        {"path": "c.npz", "start": "2023-11-14T22:13:40Z"},
    ]
    configuration = configured(tmp_path, waveforms={"files": files, "sampling_rate": RATE})
    with started(client, configuration) as agent:
        agent.read_files(threading.Event())
        assert agent.status()["samples"] == 16
        assert agent.conditions.counts() == {"damaged_file": 1, "time_reversed": 8}
        agent.read_files(threading.Event())  # it is done with all of them
        assert agent.status()["samples"] == 16
    times = samples(configuration).time
    assert (np.diff(times) > 0).all()


def answered(router: zenoh.Session) -> dict[str, Any]:
    replies = [reply.ok for reply in router.get(KEY.status, timeout=5.0) if reply.ok is not None]
    return dict(msgspec.json.decode(replies[0].payload.to_bytes())) if replies else {}


def test_it_says_how_it_is_doing(router: zenoh.Session, client: zenoh.Session, tmp_path: Path) -> None:
    waveforms = WAVEFORMS.copy()
    waveforms[1] = -20.0
    write(tmp_path / "run.npz", waveforms)
    configuration = configured(tmp_path, log={"path": "edge.log", "samples": 20})
    with started(client, configuration) as agent:
        for file in configuration.waveforms.files:
            agent._read(file, None, threading.Event(), None)
        agent.conditions.begin("rail", "B2X", "still so")
        agent._publish(threading.Event())
        agent._source.log.flush()
        wait_until(lambda: bool(answered(router)))
        status = answered(router)
    assert (status["blocks"], status["samples"], status["next_sequence"]) == (40, 40, 40)
    assert status["log"]["dropped_samples"] == 20
    assert status["counts"] == {"rail": 41}
    assert [(one["name"], one["subject"]) for one in status["conditions"]] == [("rail", "B2X")]


def test_with_a_full_disk_it_waits_and_loses_nothing(
    client: zenoh.Session, tmp_path: Path, undisturbed: Samples, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.edge.agent.BATCH_SAMPLES", 1)
    write(tmp_path / "run.npz")
    configuration = configured(tmp_path, encoding="json")
    with started(client, configuration) as agent:
        log = agent._source.log
        assert isinstance(log, SqliteReplayLog)
        log._file._database.execute("pragma max_page_count = 1")
        reading = threading.Thread(target=agent.read_files, args=(threading.Event(),))
        reading.start()
        wait_until(lambda: agent.conditions.holds("log_unusable"))
        log._file._database.execute("pragma max_page_count = 100000")
        reading.join(30)
        assert not reading.is_alive()
        assert not agent.conditions.holds("log_unusable")
        assert agent.status()["log"]["trouble"] is None
    assert_same_samples(samples(configuration), undisturbed)


def ended(*arguments: str) -> str:
    """Return what the command says when it cannot start."""
    answer = CliRunner().invoke(app, ["edge", *arguments])
    assert answer.exit_code == 1
    return answer.output


def test_a_file_with_a_wrong_year_does_not_shut_out_the_next_one(client: zenoh.Session, tmp_path: Path) -> None:
    for name in ("wrong.npz", "run.npz"):
        write(tmp_path / name)
    files = [{"path": "wrong.npz", "start": "2062-11-14T22:13:20Z"}, {"path": "run.npz", "start": "2023-11-14T22:13:20Z"}]
    configuration = configured(tmp_path, waveforms={"files": files, "sampling_rate": RATE})
    with started(client, configuration) as agent:
        agent.read_files(threading.Event())
        assert agent.conditions.counts() == {}
    times = np.concatenate([batch.time_ns for batch in logged(configuration)])
    assert len(times) == 80
    assert (np.diff(times[40:]) > 0).all()
    assert times[40] < START_NS + 10**9


def test_what_keeps_it_from_starting_is_said(endpoint: str, tmp_path: Path) -> None:
    path = tmp_path / "edge.yaml"
    path.write_text(yaml.safe_dump(edge_document(connect=[endpoint])))
    log = open_log(configured(tmp_path))
    assert "is in use by another process: a source runs once" in ended(str(path))
    log.close()
    (tmp_path / "edge.log").write_bytes(b"no log" * 1000)
    assert "move it away: a new one begins a new epoch" in ended(str(path))
    path.write_text("plant: a b")
    assert "keyphasor: Field required" in ended(str(path))
    assert "Value error" not in ended(str(path))
    assert "No such file" in ended(str(tmp_path / "nowhere.yaml"))


# --- a topic ----------------------------------------------------------------------------------------------------------


def messages(first: int = 0, last: int = WAVEFORMS.shape[1], **changes: Any) -> list[bytes]:
    """Waveforms in messages of a quarter of a second."""
    size = round(RATE / 4)
    values: dict[str, Any] = {"channels": ("K", "A", "B"), "sampling_rate": RATE, "kind": "<f8"}

    def message(place: int) -> bytes:
        at = {"first": place, "time_ns": START_NS + round(place / RATE * 1e9)}
        return encode_waveforms(WAVEFORMS[:, place : place + size], **(values | at | changes))

    return [message(place) for place in range(first, last, size)]


@contextmanager
def following(client: zenoh.Session, configuration: EdgeConfiguration, stop: threading.Event) -> Iterator[Agent]:
    with started(client, configuration) as agent:
        columns, rate = configuration.columns, configuration.waveforms.sampling_rate
        with Topic(client, TOPIC, columns, agent.conditions, sampling_rate=rate) as topic:
            thread = threading.Thread(target=agent.follow, args=(topic, stop))
            thread.start()
            try:
                yield agent
            finally:
                stop.set()
                thread.join(20)
                assert not thread.is_alive()


def put(router: zenoh.Session, payloads: list[bytes]) -> None:
    publisher = router.declare_publisher(TOPIC, congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: listened_to(publisher))
    for payload in payloads:
        publisher.put(payload)
    publisher.undeclare()


def test_a_topic_gives_what_a_file_gives(
    router: zenoh.Session, client: zenoh.Session, tmp_path: Path, undisturbed: Samples
) -> None:
    configuration = configured(tmp_path, waveforms={"topic": TOPIC, "sampling_rate": RATE})
    with following(client, configuration, threading.Event()) as agent:
        put(router, messages())
        wait_until(lambda: agent.status()["blocks"] >= 39)
    found = samples(configuration)
    # The last block waits for what follows it, or for the agent's end.
    first = np.arange(40) < 39
    assert_same_samples(found.pick(first[: len(found)]), undisturbed.pick(first))


def test_a_message_with_a_wrong_year_does_not_shut_out_those_behind_it(
    router: zenoh.Session, client: zenoh.Session, tmp_path: Path
) -> None:
    configuration = configured(tmp_path, waveforms={"topic": TOPIC, "sampling_rate": RATE})
    with following(client, configuration, threading.Event()) as agent:
        sent = messages(last=round(8 * RATE))
        sent[8:9] = messages(first=round(2 * RATE), last=round(2 * RATE) + 1, time_ns=2 * START_NS)
        put(router, sent)
        wait_until(lambda: agent.status()["samples"] >= 14)
    times = np.concatenate([batch.time_ns for batch in logged(configuration)])
    assert times[-1] > START_NS + 7 * 10**9


def test_bad_messages_are_named_and_the_rest_is_used(
    router: zenoh.Session, client: zenoh.Session, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(topic_module, "SILENCE_S", 0.3)
    good = messages(0, 24 * 512)
    bad = [
        good[3][:-1] + b"?",
        encode_waveforms(WAVEFORMS[:2], channels=("K", "A"), first=0, time_ns=START_NS, sampling_rate=RATE),
        messages(2048, 2560, sampling_rate=2.0 * RATE)[0],
        messages(2048, 2560, time_ns=START_NS)[0],
    ]
    configuration = configured(tmp_path, waveforms={"topic": TOPIC, "sampling_rate": RATE})
    with following(client, configuration, threading.Event()) as agent:
        put(router, [*good[:4], *bad, *good[4:10], *good[14:]])
        expected = {
            "damaged_message": 1,
            "missing_column": 1,
            "wrong_sampling_rate": 1,
            "time_reversed": 1,
            "input_gap": 1,
            "no_waveforms": 1,
        }
        wait_until(lambda: agent.conditions.counts() == expected)
        assert agent.conditions.holds("no_waveforms")
        put(router, messages(24 * 512, 28 * 512))
        wait_until(lambda: not agent.conditions.holds("no_waveforms"))
    seconds = (samples(configuration).time - START_NS) / 1e9
    assert np.count_nonzero(seconds < 2.5) >= 4
    assert np.count_nonzero(seconds > 3.5) >= 6
    assert not np.any((seconds > 2.5) & (seconds < 3.5))
    assert set(agent.conditions.counts()) <= set(CONDITIONS)


def test_waveforms_that_come_too_fast_are_counted(
    router: zenoh.Session, client: zenoh.Session, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(topic_module, "QUEUE_BYTES", 3 * len(messages(0, 512)[0]))
    configuration = configured(tmp_path, waveforms={"topic": TOPIC, "sampling_rate": RATE})
    stop = threading.Event()
    with (
        started(client, configuration) as agent,
        Topic(client, TOPIC, configuration.columns, agent.conditions, sampling_rate=RATE) as topic,
    ):
        put(router, messages(0, 20 * 512))
        wait_until(lambda: topic._left_out == 17)
        thread = threading.Thread(target=agent.follow, args=(topic, stop))
        thread.start()
        wait_until(lambda: agent.conditions.counts() == {"input_overrun": 1})
        put(router, messages(20 * 512, 21 * 512))
        wait_until(lambda: agent.conditions.counts() == {"input_overrun": 1, "input_gap": 1})
        stop.set()
        thread.join(20)
