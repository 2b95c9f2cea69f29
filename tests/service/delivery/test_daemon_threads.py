"""Threads that nobody waits for at the end, and names that are looked up once at a time."""

import asyncio
import ipaddress
import socket
import subprocess
import sys
import threading
import time

import pytest

from service.delivery import addresses
from service.delivery.daemon_threads import DaemonThreads
from tests.plant import wait_until


def test_results_and_errors_come_back() -> None:
    threads = DaemonThreads(2, name="test")
    assert [one.result(5.0) for one in [threads.submit(pow, 2, power) for power in range(5)]] == [1, 2, 4, 8, 16]
    with pytest.raises(ZeroDivisionError):
        threads.submit(lambda: 1 / 0).result(5.0)
    assert threads.submit(pow, 3, 2).result(5.0) == 9


def test_no_more_than_so_many_work_at_once() -> None:
    threads, go, working = DaemonThreads(3, name="test"), threading.Event(), threading.Semaphore(0)

    def hang() -> None:
        working.release()
        go.wait(10.0)

    under_way = [threads.submit(hang) for _ in range(5)]
    assert all(working.acquire(timeout=5.0) for _ in range(3))
    assert not working.acquire(timeout=0.05)
    assert under_way[4].cancel()
    go.set()
    for one in under_way[:4]:
        one.result(5.0)
    assert threads.submit(pow, 2, 2).result(5.0) == 4


def test_the_end_of_the_process_waits_for_none() -> None:
    program = (
        "import time\n"
        "from service.delivery.daemon_threads import DaemonThreads\n"
        "DaemonThreads(1, name='test').submit(time.sleep, 60.0)\n"
        "time.sleep(0.1)\n"
    )
    began = time.monotonic()
    assert subprocess.run([sys.executable, "-c", program], timeout=30.0, check=False).returncode == 0
    assert time.monotonic() - began < 20.0


def test_a_name_is_looked_up_once_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Deliveries to a name that hangs take up one thread, not one each; who gives up takes the answer from nobody else."""
    asked, go = [], threading.Event()

    def slow(name: str, port: int | None, *_: int) -> list[str]:
        if _:
            raise socket.gaierror("a name")
        asked.append((name, port))
        go.wait(10.0)
        return ["192.0.2.1"]

    monkeypatch.setattr(addresses, "_resolve", slow)

    async def several() -> list[list[str]]:
        waiting = [asyncio.create_task(addresses.NAMES.addresses("slow.example", 443)) for _ in range(20)]
        await asyncio.sleep(0.05)
        waiting[0].cancel()
        await asyncio.sleep(0)
        go.set()
        return await asyncio.gather(*waiting[1:])

    assert asyncio.run(several()) == [["192.0.2.1"]] * 19
    assert asked == [("slow.example", 443)]
    wait_until(lambda: not addresses.NAMES._under_way)


def test_names_of_new_targets_take_up_no_thread_of_deliveries_and_only_so_many_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beyond that, as where a name server does not answer: the target is taken, and each delivery looks again."""
    go = threading.Event()

    def slow(name: str, _port: int | None, *flags: int) -> list[str]:
        if flags:
            raise socket.gaierror("a name")
        if name != "known.example":
            go.wait(60.0)
        return ["192.0.2.1"]

    monkeypatch.setattr(addresses, "_resolve", slow)
    monkeypatch.setattr(addresses, "LONGEST_LOOK_UP_S", 600.0)

    async def several() -> None:
        network = (ipaddress.ip_network("192.0.2.0/24"),)
        hanging = [asyncio.create_task(addresses.require_permitted(f"http://new-{n}.example/", network)) for n in range(16)]
        while len(addresses.NEW_NAMES._under_way) < 16:
            await asyncio.sleep(0.001)
        await addresses.require_permitted("http://one-more.example/", network)
        assert str((await addresses.checked("http://known.example/", network)).url) == "http://192.0.2.1/"
        assert not any(one.done() for one in hanging)
        go.set()
        await asyncio.gather(*hanging)

    asyncio.run(several())
    wait_until(lambda: not addresses.NEW_NAMES._under_way)
