"""Computations of models: who waits for one, who goes, and a process of its own for long trains."""

import asyncio
import socket
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx
import pytest
from anyio.to_thread import current_default_thread_limiter

from benchmarks.serving import serving
from service.api.application import THREADS
from service.api.cache.computation_queue import MAXIMUM_WAITING_PER_CALLER
from service.api.conventions.problems import Unsuitable
from tests.api_in_process import PREFIX, Api, problem
from tests.plant import machine, wait_until
from tests.service.api.findings.modelled import MODEL


@pytest.mark.parametrize("what", ["campbell", "balancing"])
def test_whoever_waits_for_a_model_keeps_nobody_from_reading(
    modelled: Api, what: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Be it a computation of tenths of a second: each one holds a thread, and there are few."""
    finish = threading.Event()

    def computed(*_: Any, **__: Any) -> Any:
        assert finish.wait(60)
        raise Unsuitable("enough")

    for name in ("_diagram", "_correction"):
        monkeypatch.setattr(f"service.api.findings.model.{name}", computed)
    asked = 6 * THREADS

    async def ask() -> list[httpx.Response]:
        transport = httpx.ASGITransport(modelled.app)
        async with (
            modelled.app.router.lifespan_context(modelled.app),
            httpx.AsyncClient(transport=transport, base_url="http://x") as client,
        ):
            url = f"{PREFIX}/identifications/1/model/{what}"
            waiting = [asyncio.create_task(client.get(url, params={"points": 60 + one})) for one in range(asked)]
            try:
                async with asyncio.timeout(30):
                    while sum(one.done() for one in waiting) < asked - MAXIMUM_WAITING_PER_CALLER:
                        await asyncio.sleep(0.01)
                    other = await client.get(f"{PREFIX}/machines/{machine().id}/revisions")
                assert other.status_code == 200
            finally:
                finish.set()
            answers = await asyncio.gather(*waiting)
            assert current_default_thread_limiter().total_tokens == THREADS
            return answers

    answers = asyncio.run(ask())
    assert {one.status_code for one in answers} == {422, 503}
    assert {one.headers["Retry-After"] for one in answers if one.status_code == 503} == {"5"}


def test_computations_whose_clients_have_gone_are_given_up(modelled: Api, monkeypatch: pytest.MonkeyPatch) -> None:
    """And neither they nor those whose clients wait keep the server from stopping."""
    other, finish = Api(modelled.database), threading.Event()
    cache = other.app.state.computed_cache

    def computed(*_: Any, **__: Any) -> Any:
        assert finish.wait(60)
        raise Unsuitable("enough")

    monkeypatch.setattr("service.api.findings.model._diagram", computed)
    with ThreadPoolExecutor(1) as threads:
        with serving(other.app) as url:

            def ask(points: int) -> socket.socket:
                client = socket.create_connection(("127.0.0.1", int(url.split(":")[2].split("/")[0])))
                target = f"{PREFIX}/identifications/1/model/campbell?points={points}"
                client.sendall(f"GET {target} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode())
                return client

            def answer(client: socket.socket) -> bytes:
                try:
                    return client.recv(65536)
                finally:
                    finish.set()

            first = ask(20)
            wait_until(lambda: cache.waiting == 1)
            clients = [ask(21 + number) for number in range(4)]
            wait_until(lambda: cache.waiting == 5)
            for one in clients:
                one.close()
            wait_until(lambda: cache.waiting == 1)
            again = ask(60)
            wait_until(lambda: cache.waiting == 2)
            told = threads.submit(answer, again)
        assert told.result().startswith(b"HTTP/1.1 503")
    for one in (first, again):
        one.close()


@pytest.fixture(scope="module")
def beside(modelled: Api) -> Api:
    """An API over the same store, with the process that is started for the first long train."""
    return Api(modelled.database)


@pytest.mark.parametrize("what", [*(f"model/{one}" for one in MODEL), "bode"])
def test_a_process_of_its_own_answers_the_same(modelled: Api, beside: Api, what: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """As for a long train."""
    expected = modelled.value(f"/identifications/1/{what}")
    monkeypatch.setattr("service.api.cache.model_process.LONG_ELEMENTS", 0)
    computed = []
    compute = beside.app.state.model_process.compute

    def counted(work: Any, *arguments: Any) -> Any:
        computed.append(work)
        return compute(work, *arguments)

    monkeypatch.setattr(beside.app.state.model_process, "compute", counted)
    assert beside.value(f"/identifications/1/{what}") == expected
    assert len(computed) == 1
    assert beside.value(f"/identifications/1/{what}") == expected
    assert len(computed) == 1


def test_what_does_not_suit_is_reported_by_a_process_of_its_own_as_well(beside: Api, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.api.cache.model_process.LONG_ELEMENTS", 0)
    answer = beside.get("/identifications/1/model/balancing", plane=["nowhere"])
    assert "nowhere" in problem(answer, 422)["detail"]
