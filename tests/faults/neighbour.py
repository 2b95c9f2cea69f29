"""Somebody of another plant who stores samples and reads while one impatient person asks for far too much, and their keys."""

import threading
import time
from collections import Counter

import httpx

from formats.wire import JSON, encode_body
from service.security import api_keys
from service.security.role import Role
from storage.database.engine import Database
from tests.end_to_end.processes import Service
from tests.faults.measured import measured

OTHER_PLANT, OTHER = "orchard", "pump-8"
LONGEST_S = 10.0
"""No answer to another plant takes longer, beside other tests; `benchmarks.faults.attacks` asks how long `/alive` takes."""


def key(store: Database, name: str, role: Role, plants: list[str] | None) -> dict[str, str]:
    """The header of a new key."""
    with store.transaction() as session:
        _, text = api_keys.create(session, name=name, role=role, plants=plants, days=1)
    return {"authorization": f"Bearer {text}"}


class Neighbour(threading.Thread):
    """Stores and reads until it is told to end; took: how long each pair of answers was waited for [s]."""

    def __init__(self, service: Service, headers: dict[str, str]) -> None:
        super().__init__()
        self._client = httpx.Client(base_url=service.client.base_url, headers=headers, timeout=60.0)
        self.ended = threading.Event()
        self.stored, self.took, self.refused = 0, [0.0], Counter[int]()

    def run(self) -> None:
        """Run until it is told to end."""
        while not self.ended.wait(0.2):
            batch = measured(self.stored, 20, machine=OTHER, plant=OTHER_PLANT)
            began = time.perf_counter()
            path = f"/machines/{OTHER}/samples"
            answer = self._client.post(path, content=encode_body(batch, JSON), headers={"content-type": JSON})
            read = self._client.get(f"/machines/{OTHER}/timeline", params={"limit": 1 + self.stored % 100})
            self.took.append(time.perf_counter() - began)
            self.stored += 20 if answer.status_code == 200 else 0
            self.refused.update(one.status_code for one in (answer, read) if one.status_code != 200)
        self._client.close()
