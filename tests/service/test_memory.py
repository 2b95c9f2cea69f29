"""Memory that is free again goes back to the system, though pieces between are still in use."""

import threading

import psutil

from service.memory import give_back

PIECES, SIZE = 4_000, 50_000


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
    give_back()
    assert process.memory_info().rss < before - PIECES * SIZE / 2
    assert all(piece == bytes([1]) * SIZE for piece in kept)
