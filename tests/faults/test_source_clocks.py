"""Sources whose clocks are wrong, jump or overflow: samples keep the source's order, and both times are there to compare.

`python -m benchmarks.faults --only clock` lets more of them wander.
"""

from dataclasses import replace

import pytest

from formats.wire import ENCODINGS, JSON, decode_batch, encode_batch
from storage.clock import FUTURE_TOLERANCE
from storage.database.engine import Database
from tests.faults.clocks import HOUR, MINUTE, SIZE, STEP, TRUE, kept, told, wandering
from tests.plant import KEY, SECOND


@pytest.mark.parametrize("skew", [-5 * MINUTE, 5 * MINUTE], ids=["five minutes behind", "five minutes ahead"])
def test_a_clock_that_is_wrong_is_kept_beside_the_right_one(plant: Database, skew: int) -> None:
    assert abs(skew) < FUTURE_TOLERANCE
    clock = [moment + skew for moment in TRUE]
    found = kept(plant, told(clock))
    assert found.measured == clock
    assert found.received == [moment + STEP for moment in TRUE[SIZE - 1 :: SIZE]]
    assert (found.source.received, found.source.lost, found.rejected) == (len(clock), 0, {})
    assert found.source.last_received_at is not None
    assert found.source.last_time - found.source.last_received_at == skew - STEP


@pytest.mark.parametrize("back", [HOUR, SECOND], ids=["an hour back", "a second said twice: a leap second"])
def test_a_clock_that_steps_back_costs_two_samples_and_no_order(plant: Database, back: int) -> None:
    """Until a third one agrees with them, they may be wrong; they are kept apart, and counted by reason."""
    half = len(TRUE) // 2
    clock = TRUE[:half] + [moment - back for moment in TRUE[half:]]
    found = kept(plant, told(clock))
    assert found.numbers == sorted(found.numbers)
    assert found.measured == clock[:half] + clock[half + 2 :]
    assert found.received == [moment + STEP for moment in TRUE[SIZE - 1 :: SIZE]]
    assert (found.source.received, found.source.next_sequence) == (len(clock) - 2, len(clock))
    assert found.rejected == {"time_out_of_order": 2}


def test_messages_the_wrong_way_round_fill_their_holes(plant: Database) -> None:
    messages = told(TRUE)
    swapped = [messages[place ^ 1] for place in range(len(messages))]
    found = kept(plant, swapped)
    assert sorted(found.numbers) == list(range(0, len(TRUE), SIZE))
    places = sorted(range(len(found.numbers)), key=lambda place: found.numbers[place])
    assert [moment for place in places for moment in found.measured[place * SIZE : (place + 1) * SIZE]] == TRUE
    assert (found.source.received, found.source.lost) == (len(TRUE), 0)


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("moment", [2**63 - 1, 2**63 - SECOND, 2**62, -(2**63), -1])
def test_nanoseconds_that_overflow_cost_their_samples_only(plant: Database, encoding: str, moment: int) -> None:
    messages = told(TRUE)
    wrong = messages[3].batch
    wrong.time_ns = [moment] * SIZE
    read = decode_batch(KEY, encode_batch(wrong, encoding), encoding)
    messages[3] = replace(messages[3], batch=read)
    found = kept(plant, messages)
    assert found.measured == TRUE[: 3 * SIZE] + TRUE[4 * SIZE :]
    assert found.rejected == {"time_out_of_range": SIZE}
    assert (found.source.received, found.source.next_sequence, found.source.lost) == (len(TRUE) - SIZE, len(TRUE), 0)


@pytest.mark.parametrize("moment", [2**63, 2**64, 10**30])
def test_times_beyond_64_bits_are_rejected(plant: Database, moment: int) -> None:
    messages = told(TRUE)
    messages[3].batch.time_ns = [moment] * SIZE
    read = decode_batch(KEY, encode_batch(messages[3].batch, JSON), JSON)
    found = kept(plant, [*messages[:3], replace(messages[3], batch=read), *messages[4:]])
    assert found.measured == TRUE[: 3 * SIZE] + TRUE[4 * SIZE :]
    assert found.rejected == {"time_out_of_range": SIZE}


@pytest.mark.parametrize("seed", range(3))
def test_clocks_that_wander_cost_what_is_known_and_no_order(plant: Database, seed: int) -> None:
    assert wandering(plant, seed=seed).stored > 0.9 * len(TRUE)
