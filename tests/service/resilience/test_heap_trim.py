"""Memory that is free again goes back to the system, though pieces between are still in use."""

import subprocess
import sys
import threading

import psutil

from service.resilience.heap_trim import release_free_memory

PIECES, SIZE = 4_000, 50_000

AT_THE_END = """
import threading, psutil
from service.resilience.heap_trim import release_free_memory, share_one_heap
share_one_heap()
bytes(16_000_000)  # who has once let go of so much is thought to need it again
begun, go_on = threading.Event(), threading.Event()
def allocate():
    pieces = [bytes([1]) * 50_000 for _ in range(400)]
    del pieces
    begun.set()
    go_on.wait(30)
thread = threading.Thread(target=allocate)
before = psutil.Process().memory_info().rss
thread.start()
begun.wait(30)
release_free_memory()
print(psutil.Process().memory_info().rss - before)
go_on.set()
"""
"""20 MB in a thread that lives on; nothing is in use behind them."""


def test_memory_between_what_is_in_use_goes_back() -> None:
    kept: list[bytes] = []

    def allocate() -> None:
        pieces = [bytes([1]) * SIZE for _ in range(PIECES)]
        kept.extend(pieces[::50])

    threads = [threading.Thread(target=allocate) for _ in range(2)]
    process = psutil.Process()
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    before = process.memory_info().rss
    release_free_memory()
    assert process.memory_info().rss < before - PIECES * SIZE / 2
    assert all(piece == bytes([1]) * SIZE for piece in kept)


def test_memory_at_the_end_of_a_threads_heap_goes_back() -> None:
    found = subprocess.run([sys.executable, "-c", AT_THE_END], capture_output=True, text=True, timeout=60, check=True)
    assert int(found.stdout) < 2_000_000
