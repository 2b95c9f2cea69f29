"""Samples over HTTP: durable when answered, stored once however often they come, and every refusal names its reason.

The application and the ingest thread are the real ones over a real database; only the socket is left out.
"""

import base64
import hashlib
import json
import re
import threading
from collections.abc import Iterator
from typing import Any, get_args

import httpx
import msgspec
import pytest
import zenoh
from prometheus_client.openmetrics.parser import text_string_to_metric_families
from sqlalchemy import text

from formats.files.document_files import read_machine
from formats.wire import (
    BINARY,
    ENCODINGS,
    JSON,
    LARGEST_MESSAGE,
    MESSAGEPACK,
    InternalErrorReason,
    Reason,
    SampleBatch,
    encode_body,
    unknown_fields,
)
from service.api.measurements import ingestion
from service.api.operation import metrics
from service.api.operation.refusal_words import MEANINGS, refusal_words
from service.ingest import ingest_thread as ingest_module
from service.ingest.ingest_thread import Ingest
from service.runs.collector import Collector
from service.write_path.http_queue import Busy, NotStoring, Submissions
from service.write_path.sample_writer import SampleWriter
from storage.clock import now
from storage.database.engine import Database
from storage.encoding.source_key import SourceKey
from storage.machines import machines
from storage.measurements import quarantine
from storage.measurements import samples as sample_store
from tests.api_in_process import Api
from tests.paths import EXAMPLES, ROOT
from tests.plant import KEY, SECOND, START, batch, machine, wait_until

PATH = f"/api/v1/machines/{KEY.machine}/samples"


class Http(Api):
    """The application with its ingest thread, asked as over HTTP."""

    def __init__(self, database: Database, submissions: Submissions, ingest: Ingest | None = None) -> None:
        super().__init__(database, submissions=submissions, gauges=lambda: {} if ingest is None else ingest.gauges)
        self.submissions = submissions

    def post(self, one: SampleBatch, encoding: str = JSON, **headers: str) -> httpx.Response:
        return self.ask("POST", PATH, content=encode_body(one, encoding), headers={"content-type": encoding} | headers)

    def stored(self) -> list[int]:
        """Seconds after the start of every stored sample."""
        with self.database.reading() as session:
            held = sample_store.latest(session, KEY.machine, revision=1, count=10_000)
        return [(moment - START) // SECOND for moment in held.time.tolist()]


@pytest.fixture
def http(router: zenoh.Session, plant: Database) -> Iterator[Http]:
    submissions = Submissions()
    ingest = Ingest(router, SampleWriter(plant, Collector()), silence_s=60.0, submissions=submissions)
    ingest.start()
    yield Http(plant, submissions, ingest)
    ingest.stop()


def rows(first: int, last: int, **changes: Any) -> SampleBatch:
    """Samples `first` to before `last`."""
    return batch([900.0] * (last - first), sequence=first, start=START + first * SECOND, **changes)


def refused(answer: httpx.Response, status: int, *words: str) -> None:
    """A problem detail with these words."""
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    for word in words:
        assert word in answer.json()["detail"]


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_what_is_answered_is_stored(http: Http, encoding: str) -> None:
    answer = http.post(rows(0, 5), encoding)
    assert answer.status_code == 200, answer.text
    assert answer.json() == {"received": 5, "duplicates": 0, "missing_before": 0, "faults": [], "ignored": []}
    assert http.stored() == [0, 1, 2, 3, 4]


def test_the_same_batch_may_come_again(http: Http) -> None:
    for part, (received, duplicates) in [(rows(0, 5), (5, 0)), (rows(0, 5), (0, 5)), (rows(3, 8), (3, 2))]:
        answer = http.post(part).json()
        assert (answer["received"], answer["duplicates"]) == (received, duplicates)
    assert http.stored() == list(range(8))


def test_a_gap_is_counted_at_once_and_asked_for_nowhere(http: Http) -> None:
    http.post(rows(0, 2))
    assert http.post(rows(5, 7)).json()["missing_before"] == 3
    assert http.stored() == [0, 1, 5, 6]


def test_bad_samples_are_named_and_the_others_stored(http: Http) -> None:
    one = rows(0, 4)
    one.speed[1], one.amplitude[2][3] = 99_999.0, 1e6
    answer = http.post(one)
    assert answer.status_code == 200
    assert answer.json()["received"] == 3
    assert [(fault["index"], fault["reason"]) for fault in answer.json()["faults"]] == [
        (2, "amplitude_out_of_range"),
        (1, "speed_out_of_range"),
    ]
    assert http.stored() == [0, 2, 3]
    with http.database.reading() as session:
        assert quarantine.counts(session) == {"amplitude_out_of_range": 1, "speed_out_of_range": 1}


@pytest.mark.parametrize("encoding", [JSON, MESSAGEPACK])
def test_fields_that_there_are_not_are_named(http: Http, encoding: str) -> None:
    one = msgspec.to_builtins(rows(0, 2)) | {"amplitude_2X": [[1.0] * 4] * 2, "condition": {}, "note": "by hand"}
    body = (msgspec.json if encoding == JSON else msgspec.msgpack).encode(one)
    answer = http.ask("POST", PATH, content=body, headers={"content-type": encoding}).json()
    assert answer["received"] == 2
    first, second, third = answer["ignored"]
    assert first.startswith("amplitude_2X; did you mean 'amplitude_2x'")
    assert second.startswith("condition; did you mean 'conditions'")
    assert third.startswith("note")
    assert unknown_fields(b"\xff", encoding) == []
    assert unknown_fields(encode_body(rows(0, 2), BINARY), BINARY) == []


def test_fields_that_there_are_not_are_named_of_a_batch_that_is_refused_as_well(http: Http) -> None:
    one = msgspec.to_builtins(rows(0, 2)) | {"overal": [[1.0] * 4] * 2}
    fast = http.ask("POST", PATH, content=msgspec.json.encode(one | {"speed": [99_999.0] * 2}), headers={"content-type": JSON})
    assert {"field": "overal", "message": "there is no such field; did you mean 'overall'?"} in fast.json()["errors"]
    whole = http.ask("POST", PATH, content=msgspec.json.encode(one | {"time_ns": [1, 2]}), headers={"content-type": JSON})
    refused(whole, 422, "there is no field overal; did you mean 'overall'?")


def test_where_no_sample_is_taken_the_answer_is_no_success(http: Http) -> None:
    fast = rows(0, 3)
    fast.speed = [99_999.0, 88_888.0, 77_777.0]
    answer = http.post(fast)
    refused(answer, 422, "no sample was taken, 3 faults", "speed_out_of_range", "under new numbers")
    assert [one["field"] for one in answer.json()["errors"]] == ["samples[0]", "samples[1]", "samples[2]"]
    assert http.stored() == []
    (entry, *_) = http.value("/quarantine")["entries"]
    assert entry["meaning"].startswith("the speed is beyond what the machine can reach: look at its unit")


@pytest.mark.parametrize(("factor", "unit"), [(10**3, "microseconds"), (10**6, "milliseconds"), (10**9, "seconds")])
def test_times_in_another_unit_are_called_that(http: Http, factor: int, unit: str) -> None:
    coarse = rows(0, 3)
    coarse.time_ns = [one // factor for one in coarse.time_ns]
    refused(http.post(coarse), 422, "time_out_of_range", f"it looks like {unit}, and must be nanoseconds since 1970")


def test_every_reason_has_a_meaning_for_people() -> None:
    assert MEANINGS.keys() == {*get_args(Reason), *get_args(InternalErrorReason)}
    assert "older release" in refusal_words("rubbish")


REFUSED: dict[Reason, tuple[int, SampleBatch | bytes]] = {
    "undecodable": (400, b"{}"),
    "future_schema": (422, batch(schema=2)),
    "key_mismatch": (422, batch(machine="pump-8")),
    "unknown_machine": (404, batch(plant="elsewhere")),
    "unknown_channel": (422, batch(channels=["a", "b", "c", "d"])),
    "unknown_condition": (422, batch(conditions={"humidity": [40.0]})),
    "wrong_unit": (422, batch(speed_unit="knots")),
    "wrong_shape": (422, batch(speed=[1.0, 2.0])),
    "sequence_out_of_range": (409, batch(sequence=2 * 10**9)),
}


@pytest.mark.parametrize("reason", REFUSED)
def test_a_batch_that_is_not_taken_is_answered_with_its_reason_and_kept(http: Http, reason: Reason) -> None:
    status, sent = REFUSED[reason]
    body = sent if isinstance(sent, bytes) else encode_body(sent, JSON)
    refused(http.ask("POST", PATH, content=body, headers={"content-type": JSON}), status, f"{reason}: ")
    assert http.stored() == []
    with http.database.reading() as session:
        (entry,) = quarantine.newest(session, reason=reason, machine_id=None, limit=9)
    assert entry.key == f"POST {PATH}"
    assert http.post(batch()).json()["received"] == 1  # its numbers are still free


def test_every_reason_for_a_whole_batch_has_been_tried() -> None:
    of_samples = {"not_finite", "speed_out_of_range", "speed_out_of_order", "amplitude_out_of_range"}
    of_samples |= {"time_out_of_range", "time_out_of_order", "gap_out_of_range", "gap_undescribed", "overall_out_of_range"}
    assert set(get_args(Reason)) == {*REFUSED, "too_large", "bad_frame", "retained"} | of_samples
    assert set(ingestion.CATEGORY) <= set(get_args(Reason))


def test_other_content_types_and_sizes_are_refused(http: Http) -> None:
    body = encode_body(batch(), JSON)
    refused(http.ask("POST", PATH, content=body), 415, BINARY, MESSAGEPACK, JSON)
    refused(http.ask("POST", PATH, content=body, headers={"content-type": "text/csv"}), 415, "text/csv")
    refused(http.ask("POST", PATH, content=bytes(LARGEST_MESSAGE + 1), headers={"content-type": JSON}), 413, "too_large")

    def unannounced() -> Iterator[bytes]:
        for _ in range(20):
            yield bytes(LARGEST_MESSAGE // 10)

    refused(http.ask("POST", PATH, content=unannounced(), headers={"content-type": JSON}), 413, "too_large")
    with_charset = {"content-type": "Application/JSON; charset=utf-8"}
    assert http.ask("POST", PATH, content=body, headers=with_charset).status_code == 200


def test_a_digest_is_compared(http: Http) -> None:
    body = encode_body(batch(), JSON)
    right = {
        name: base64.b64encode(hashlib.new(name.replace("-", ""), body).digest()).decode() for name in ("sha-256", "sha-512")
    }
    wrong = base64.b64encode(bytes(32)).decode()
    for digest in (f"sha-256=:{wrong}:", f"sha-512=:{right['sha-512']}:, sha-256=:{wrong}:", "sha-256=::", "sha-256=:A:", "x"):
        refused(http.post(batch(), **{"content-digest": digest}), 400, "bad_frame")
    assert http.stored() == []
    for digest in (f"sha-256=:{right['sha-256']}:", f"sha-512=:{right['sha-512']}:", "md5=:AAAA:"):
        assert http.post(batch(), **{"content-digest": digest}).status_code == 200


def test_who_comes_to_a_full_queue_is_asked_to_come_again(plant: Database) -> None:
    http = Http(plant, Submissions(2))
    for _ in range(2):
        http.submissions.offer(KEY.machine, b"", JSON)
    answer = http.post(batch())
    refused(answer, 429, "2 batches wait")
    assert answer.headers["retry-after"] == "1"


def test_a_thread_that_does_not_answer_is_not_waited_for_for_ever(plant: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ingestion, "PATIENCE_S", 0.05)
    submissions = Submissions()
    refused(Http(plant, submissions).post(batch()), 503, "send it again")
    assert submissions.take() is None  # nobody waits for it any more


def test_nothing_is_answered_as_stored_that_the_database_refused(http: Http, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ingest_module, "RETRY_S", 0.05)
    with http.database.transaction() as session:
        session.execute(text("ALTER TABLE sample_blocks RENAME TO away"))
    answer = http.post(rows(0, 5))
    # PostgreSQL's own messages name more than callers may know.
    refused(answer, 503, "sample_blocks" if http.database.engine.dialect.name == "sqlite" else "UndefinedTable of PostgreSQL")
    assert answer.headers["retry-after"] == "1"
    with http.database.transaction() as session:
        session.execute(text("ALTER TABLE away RENAME TO sample_blocks"))
    wait_until(lambda: http.post(rows(0, 5)).status_code == 200)
    assert http.stored() == [0, 1, 2, 3, 4]


def test_offering_while_nothing_can_be_stored_or_when_full_says_so() -> None:
    submissions = Submissions(1)
    promise = submissions.offer("m", b"1", JSON)
    with pytest.raises(Busy):
        submissions.offer("m", b"2", JSON)
    submissions.trouble = "disk full"
    with pytest.raises(NotStoring, match="disk full"):
        submissions.offer("m", b"3", JSON)
    assert len(submissions) == 1
    promise.cancel()
    assert submissions.take() is None


def test_many_at_once_are_each_answered_for_themselves(http: Http) -> None:
    answers: dict[int, Any] = {}

    def send(number: int) -> None:
        answers[number] = http.post(rows(0, 3 + number % 2, source=f"s{number}", epoch=number)).json()["received"]

    threads = [threading.Thread(target=send, args=(number,)) for number in range(20)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30)
    assert answers == {number: 3 + number % 2 for number in range(20)}


# --- quarantine and metrics -----------------------------------------------------------------------------------------


def test_the_quarantine_is_purged_by_time_and_reason_and_stays_counted(http: Http) -> None:
    for sent in (batch(schema=2), batch(schema=2), batch(speed_unit="knots")):
        http.post(sent)
    first = http.ask("GET", "/api/v1/quarantine").json()
    moments = [entry["received_at"] for entry in first["entries"]]
    assert len(moments) == 3

    def purge(**parameters: str) -> int:
        return int(http.ask("DELETE", "/api/v1/quarantine", params=parameters).json()["deleted"])

    assert purge(before="2000-01-01T00:00:00Z") == 0
    assert purge(reason="wrong_unit") == 1
    assert purge(before=moments[1]) == 1
    assert [entry["received_at"] for entry in http.ask("GET", "/api/v1/quarantine").json()["entries"]] == [moments[1]]
    assert purge() == 1
    left = http.ask("GET", "/api/v1/quarantine").json()
    assert left == {"counts": {"future_schema": 2, "wrong_unit": 1}, "entries": []}
    assert http.ask("DELETE", "/api/v1/quarantine", params={"reason": "boredom"}).status_code == 422


def figures(http: Http) -> dict[tuple[str, ...], float]:
    """Every sample of the metrics, by name and labels, as a monitoring system reads them."""
    answer = http.ask("GET", "/metrics")
    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith("application/openmetrics-text")
    return {
        (sample.name, *sample.labels.values()): sample.value
        for family in text_string_to_metric_families(answer.text)
        for sample in family.samples
    }


def test_metrics_count_what_came(http: Http) -> None:
    empty = figures(http)
    assert empty["rundown_ingest_storing",] == 1
    for part in (rows(0, 5), rows(0, 5), rows(8, 10), batch(schema=2), batch(schema=2)):
        http.post(part)
    found = figures(http)
    assert found["rundown_samples_received_total", KEY.machine] == 7
    assert found["rundown_samples_duplicate_total", KEY.machine] == 5
    assert found["rundown_samples_lost", KEY.machine] == 3
    assert found["rundown_samples_late_total", KEY.machine] == 0
    assert found["rundown_rejected_total", "future_schema"] == 2
    assert found["rundown_http_queue_batches",] == 0
    assert found["rundown_ingest_queue_messages",] == found["rundown_ingest_queue_bytes",] == 0
    assert found["rundown_newest_sample_age_seconds", KEY.machine] > 86_400  # 2023


def test_metrics_do_not_grow_without_bound(http: Http, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(metrics, "LARGEST_MACHINE_COUNT", 0)
    http.post(rows(0, 5))
    found = figures(http)
    assert found["rundown_samples_received_total", "*"] == 5
    assert not any(KEY.machine in name for name in found)


def test_metrics_show_the_machines_that_are_silent_for_longest(
    http: Http, plant: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever their ids: an alarm must see them."""
    monkeypatch.setattr(metrics, "LARGEST_MACHINE_COUNT", 2)
    with plant.transaction() as session:
        for number, minutes in enumerate((1, 70, 2, 90, 80)):
            key = SourceKey(f"pump-{number}", "monitor", 1)
            machines.create(session, machine(id=key.machine_id))
            sample_store.source(session, key).last_time = now() - 60 * minutes * SECOND
    found = figures(http)
    shown = {name[1]: value for name, value in found.items() if name[0] == "rundown_newest_sample_age_seconds"}
    assert shown == {"pump-3": pytest.approx(5400, abs=60), "pump-4": pytest.approx(4800, abs=60)}
    assert found["rundown_silent_machines",] == 3


def test_every_state_of_jobs_and_deliveries_is_counted_from_nought(http: Http) -> None:
    """An alarm looks for a rise: of a series that is not there before the first incident there is none."""
    found = figures(http)
    shown = {name: value for name, value in found.items() if name[0] in ("rundown_identification_jobs", "rundown_deliveries")}
    states = [
        *(("rundown_identification_jobs", state) for state in ("queued", "running", "done", "failed", "quarantined")),
        *(("rundown_deliveries", state) for state in ("pending", "delivered", "given_up")),
    ]
    assert shown == dict.fromkeys(states, 0)


def test_the_metrics_show_the_parts_that_readiness_names(http: Http) -> None:
    """Also the one without which the service is healthy and not ready."""
    for said in ("ok", "no zenoh router answers at tcp/127.0.0.1:7447 yet; trying again until one does"):
        http.parts["stream"] = said
        parts = http.ask("GET", "/api/v1/ready").json()["parts"]
        shown = {name[1]: value for name, value in figures(http).items() if name[0] == "rundown_part_ok"}
        assert shown == {name: int(words == "ok") for name, words in parts.items()}
        assert shown["database"] == 1
    assert shown["stream"] == 0


def test_the_batch_that_the_page_for_integrators_prints_is_taken(http: Http) -> None:
    document = read_machine(EXAMPLES / "motor-pump.yaml").model_dump(mode="json", exclude_none=True)
    assert http.ask("POST", "/api/v1/machines", json=document).status_code == 201
    page = (ROOT / "docs" / "integrators.md").read_text()
    (printed,) = re.findall(r"^```json\n(\{\"schema\".*?)^```", page, re.MULTILINE | re.DOTALL)
    path = "/api/v1/machines/motor-pump/samples"
    answer = http.ask("POST", path, content=printed.encode(), headers={"content-type": JSON})
    assert f"`{json.dumps(answer.json())}`" in page
