"""One analyst of one plant asks for far too much at once: other plants store, read and are identified as before."""

from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import httpx
import numpy as np
import pytest

from service.security.role import Role
from storage.database.engine import Database
from storage.findings import jobs
from storage.machines import machines
from storage.tables.findings import JobRow
from tests.end_to_end.alive import probing
from tests.end_to_end.processes import Service, until
from tests.faults.neighbour import LONGEST_S, OTHER, OTHER_PLANT, Neighbour, key
from tests.identification import chapter_3, close_run
from tests.plant import document

JOBS, AT_ONCE = 1_600, 30


@pytest.mark.long
def test_one_impatient_person_keeps_nobody_of_another_plant_waiting(tmp_path: Path) -> None:
    service = Service(tmp_path)
    train = chapter_3()
    with service.client, service.running():
        store = Database(service.database)
        own = key(store, "impatient", Role.ANALYST, [train.plant])
        other = key(store, "neighbour", Role.ADMIN, [OTHER_PLANT])
        neighbour = Neighbour(service, other)
        with store.transaction() as session:
            machines.create(session, train)
        theirs = train.model_copy(update={"id": "other-train", "plant": OTHER_PLANT})
        with store.transaction() as session:
            machines.create(session, theirs)
        until(lambda: service.client.get("/machines").status_code == 401, within_s=20, what="keys are needed")
        assert service.client.post("/machines", json=document(id=OTHER, plant=OTHER_PLANT), headers=other).status_code == 201
        run = close_run(store, train, seed=1, start_s=1_700_000_000)
        limits = httpx.Limits(max_connections=AT_ONCE)
        with httpx.Client(base_url=service.client.base_url, headers=own, timeout=60.0, limits=limits) as impatient:

            def ask(number: int) -> int:
                if number % 2:
                    return impatient.get(f"/machines/{train.id}/jobs", params={"limit": 1 + number % 500}).status_code
                return impatient.post(f"/runs/{run}/identifications", json={"seed": number}).status_code

            neighbour.start()
            try:
                with probing(str(service.client.base_url).rstrip("/")) as alive, ThreadPoolExecutor(AT_ONCE) as many:
                    answers = Counter(many.map(ask, range(2 * JOBS)))
                    close_run(store, theirs, seed=2, start_s=1_700_086_400)
                    until(lambda: _done(store, theirs.id), within_s=120, what="the other plant's run is identified first")
            finally:
                neighbour.ended.set()
                neighbour.join()
        assert set(answers) <= {200, 202, 429}, answers
        assert answers[429] > 0
        with store.reading() as session:
            waiting = session.query(JobRow).filter_by(state=jobs.QUEUED).count()
        assert waiting > 0, "it did not wait for the others"
        assert not neighbour.refused
        assert max(neighbour.took) < LONGEST_S
        assert np.percentile(alive, 99) < LONGEST_S / 10
        (row,) = [one for one in service.client.get("/sources", headers=other).json() if one["machine"] == OTHER]
        assert (row["received"], row["lost"]) == (neighbour.stored, 0)
        store.close()


def _done(store: Database, machine: str) -> bool:
    with store.reading() as session:
        return session.query(JobRow).filter_by(machine_id=machine, state=jobs.DONE).count() > 0
