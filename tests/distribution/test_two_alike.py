"""Two processes of the role `all` on one PostgreSQL database: begun at once, one frozen or killed, a key revoked at one."""

import signal
import time
from functools import partial

import httpx
import numpy as np
import pytest

from formats.wire import JSON, encode_body
from service.security import api_keys
from service.security.role import Role
from storage.database.engine import Database
from storage.findings import jobs
from storage.machines import machines
from tests.distribution.layout import Layout
from tests.end_to_end.alive import probing
from tests.end_to_end.processes import rundown, until
from tests.faults.measured import measured
from tests.faults.roles import POSTED
from tests.identification import chapter_3, close_run, counts, unfinished
from tests.plant import document

BOTH = ("all1", "all2")
REVOKED_WITHIN_S = 3.0
"""As docs/security.md promises."""
LONGEST_ALIVE_S = 2.0
"""Beside other tests; `benchmarks.faults.attacks` asks for 250 ms."""
TAKEN_OVER_WITHIN_S, READY_WITHIN_S = 60.0, 120.0
"""On a busy machine."""


def begin(layout: Layout) -> None:
    """Begin both, and wait until both are ready."""
    for name in BOTH:
        layout.start(name)
    for name in BOTH:
        until(partial(layout._ready, name), within_s=READY_WITHIN_S, what=f"{name} is ready")


def take(layout: Layout, name: str, first: int, count: int) -> int:
    """Send samples to a replica, each batch until it is acknowledged; the number of the next one."""
    began, next_one = time.monotonic(), first
    while next_one < first + count:
        body = encode_body(measured(next_one, 20, machine=POSTED), JSON)
        answer = layout.client(name).post(f"/machines/{POSTED}/samples", content=body, headers={"content-type": JSON})
        assert answer.status_code in (200, 503), answer.text
        assert time.monotonic() < began + TAKEN_OVER_WITHIN_S, answer.text
        if answer.status_code == 200:
            next_one += 20
        else:
            time.sleep(0.2)
    return next_one


@pytest.mark.long
def test_both_begin_at_once_and_one_frozen_or_killed_costs_nothing(layout: Layout) -> None:
    begin(layout)  # both find an empty database, and migrate it
    for name in BOTH:
        assert "Traceback" not in (layout.folder / f"{name}.log").read_text()
    layout.create_machine("all1", document(id=POSTED))
    store, train = Database(layout.database), chapter_3()
    with store.transaction() as session:
        machines.create(session, train)
    for number in range(4):
        close_run(store, train, seed=number, start_s=1_700_000_000 + 3600 * number)
    acknowledged = take(layout, "all1", 0, 100)
    for gone, left, how in (("all1", "all2", signal.SIGSTOP), ("all2", "all1", signal.SIGKILL)):
        url = str(layout.client(left).base_url).rstrip("/")
        if how == signal.SIGSTOP:
            layout.send(gone, how)
        else:
            layout.kill(gone)
        with probing(url) as took:
            acknowledged = take(layout, left, acknowledged, 200)
        assert np.percentile(took, 99) < LONGEST_ALIVE_S
        if how == signal.SIGSTOP:
            layout.send(gone, signal.SIGCONT)
            until(lambda: len(layout.shares("all1")) == 2, within_s=TAKEN_OVER_WITHIN_S, what="both are there again")
            acknowledged = take(layout, gone, acknowledged, 100)
    until(
        lambda: counts(store) == {jobs.DONE: 4},
        within_s=240,
        what="every job is done once",
        seen=lambda: (unfinished(store), layout.shares("all1"), (layout.folder / "all1.log").read_text()[-3000:]),
    )
    (row,) = [one for one in layout.get("all1", "/sources") if one["machine"] == POSTED]
    assert (row["received"], row["next_sequence"], row["lost"]) == (acknowledged, acknowledged, 0)
    store.close()


def _refused(client: httpx.Client) -> bool:
    return client.get("/machines").status_code == 401


@pytest.mark.long
def test_a_key_revoked_at_one_opens_nothing_at_the_other_within_seconds(layout: Layout) -> None:
    store = Database(layout.database)
    begin(layout)
    with store.transaction() as session:
        row, text = api_keys.create(session, name="passing", role=Role.ADMIN, plants=None, days=1)
        prefix = row.prefix
    headers = {"authorization": f"Bearer {text}"}
    for name in BOTH:
        client = layout.client(name)
        until(partial(_refused, client), within_s=10, what="keys are needed")
        assert client.get("/machines", headers=headers).status_code == 200
    assert rundown("key", "revoke", prefix, "--database", layout.database).returncode == 0
    time.sleep(REVOKED_WITHIN_S)
    assert {layout.client(name).get("/machines", headers=headers).status_code for name in BOTH} == {401}
    store.close()
