"""One person floods the service with valid requests that are dear: it says that it is alive, and serves other plants."""

import itertools
import time
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing

import httpx
import numpy as np
import pytest
from sqlalchemy import update

from service.security.role import Role
from storage.alerts import deliveries
from storage.database.engine import Database
from storage.tables.alerting import SubscriptionRow
from tests.end_to_end.alive import probing
from tests.end_to_end.processes import Service, until
from tests.faults.floods import FLOODS, FloodRequest, Prepared, prepare
from tests.faults.neighbour import LONGEST_S, OTHER, OTHER_PLANT, Neighbour, key
from tests.plant import KEY, document
from tests.service.delivery.receivers import receiver

AT_ONCE = 40
SLOW = {"reports", "try-outs"}
"""Their answers take seconds, which the last ones are waited for."""
AT_ONCE_IF_SLOW = 20
FLOOD_S = 2.0
"""Duration of each flood [s]."""
PATIENCE_S = 480.0
"""Longest wait of the impatient person for an answer [s]: twenty reports take 8 s on a machine that does nothing else."""
TAKEN = {200, 201, 202}
REFUSED = {409, 429, 503}
"""Too many, as it is said: by quota, by bound, or by what waits already."""


Attacked = tuple[Service, Prepared, dict[str, str], dict[str, str]]


@pytest.fixture(scope="module")
def attacked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Attacked]:
    """A service with a store that can be asked, and the keys of the impatient person and of the neighbour."""
    folder = tmp_path_factory.mktemp("floods")
    service = Service(folder, RUNDOWN_DELIVERY_NETWORKS='["127.0.0.0/8"]')
    with receiver() as http, service.client, service.running():
        store = Database(service.database)
        stored = prepare(store, http.url("/hang"))
        own = key(store, "impatient", Role.ADMIN, [KEY.plant])
        other = key(store, "neighbour", Role.ADMIN, [OTHER_PLANT])
        until(lambda: service.client.get("/machines").status_code == 401, within_s=20, what="keys are needed")
        assert service.client.post("/machines", json=document(id=OTHER, plant=OTHER_PLANT), headers=other).status_code == 201
        hook = {"kind": "webhook", "name": "hook", "target": http.url("/hang")}
        assert service.client.post("/subscriptions", json=hook, headers=own).json()["id"] == 1
        yield service, stored, own, other
        http.over.set()
        store.close()


@pytest.mark.long
def test_a_flood_of_all_kinds_keeps_nobody_of_another_plant_waiting(attacked: Attacked) -> None:
    kinds = [FLOODS[what] for what in FLOODS if what not in SLOW]
    _hold(attacked, lambda stored, number: kinds[number % len(kinds)](stored, number // len(kinds)), at_once=AT_ONCE)


@pytest.mark.long
@pytest.mark.parametrize("what", FLOODS)
def test_a_flood_of_valid_requests_keeps_nobody_of_another_plant_waiting(attacked: Attacked, what: str) -> None:
    _hold(attacked, FLOODS[what], at_once=AT_ONCE_IF_SLOW if what in SLOW else AT_ONCE)


def _end_subscriptions(service: Service) -> None:
    """Make room for those of the next flood: a plant has a bound of active ones."""
    with closing(Database(service.database)) as store, store.transaction() as session:
        session.execute(update(SubscriptionRow).where(SubscriptionRow.id > 1).values(state=deliveries.DISABLED))


def _hold(attacked: Attacked, flood: Callable[[Prepared, int], FloodRequest], *, at_once: int) -> None:
    """Flood the service for a while from so many connections; what must hold meanwhile."""
    service, stored, own, other = attacked
    _end_subscriptions(service)
    neighbour = Neighbour(service, other)
    limits = httpx.Limits(max_connections=at_once)
    over = time.monotonic() + FLOOD_S
    numbers = itertools.count()
    with httpx.Client(base_url=service.client.base_url, headers=own, timeout=PATIENCE_S, limits=limits) as impatient:

        def ask() -> Counter[int]:
            answers = Counter[int]()
            while time.monotonic() < over:
                method, path, body = flood(stored, next(numbers))
                answers[impatient.request(method, path, json=body).status_code] += 1
            return answers

        neighbour.start()
        try:
            with probing(str(service.client.base_url).rstrip("/")) as alive, ThreadPoolExecutor(at_once) as many:
                asking = [many.submit(ask) for _ in range(at_once)]
                answers = sum((one.result() for one in asking), Counter[int]())
        finally:
            neighbour.ended.set()
            neighbour.join()
    print(
        f"{dict(answers)}; /alive p99 {1e3 * np.percentile(alive, 99):.0f} ms of {len(alive)}; "
        f"neighbour longest {max(neighbour.took):.2f} s, median {np.median(neighbour.took):.3f} s of {len(neighbour.took)}"
    )
    assert set(answers) <= TAKEN | REFUSED, answers
    assert answers.keys() & TAKEN
    assert not neighbour.refused
    assert max(neighbour.took) < LONGEST_S
    assert np.percentile(alive, 99) < LONGEST_S / 10
    (row,) = [one for one in service.client.get("/sources", headers=other).json() if one["machine"] == OTHER]
    assert row["lost"] == 0
