"""Kill, freeze, cut: whatever happens to edge, router and service, the store holds what was measured, in order, once.

These are the short forms; `python -m benchmarks.faults` runs every order, longer, and more of them.
"""

import time
from pathlib import Path

import pytest

from tests.faults.chain import Chain, Part

RATE = 100.0


@pytest.mark.parametrize("order", [("service", "router", "edge"), ("edge", "service", "router")], ids="-".join)
def test_parts_killed_in_turn(tmp_path: Path, order: tuple[Part, ...]) -> None:
    with Chain(tmp_path, samples=600, rate=RATE) as chain:
        chain.wait_received(50)
        for part in order:
            chain.kill(part)
            time.sleep(0.3)
        for part in order:
            chain.start(part)
        chain.check_exact()


def test_a_service_that_is_frozen_for_twelve_seconds(tmp_path: Path) -> None:
    """zenoh closes its connection meanwhile, and was seen to deliver damaged messages just after."""
    with Chain(tmp_path, samples=1500, rate=RATE) as chain:
        chain.wait_received(50)
        chain.freeze("service", 12.0)
        chain.check_exact()


def test_a_wire_that_holds_everything_back_and_then_breaks(tmp_path: Path) -> None:
    with Chain(tmp_path, samples=700, rate=RATE, wired=True) as chain:
        chain.wait_received(50)
        assert chain.wire is not None
        chain.wire.hold()
        time.sleep(3.0)
        chain.wire.release()
        chain.check_exact()
