"""Blocks of streamed waveforms: the phasors are right, and nothing depends on how the waveform came."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as settings_of_examples
from hypothesis import strategies as st

from estimator.arrays import Floats
from service.edge.block_outcomes import BlockOutcome, BlockSettings, Position
from service.edge.blocks import BlockStream
from service.edge.sample_window import Chunk
from tests.plant import few_examples
from tests.waveforms import RATE, START_NS, keyphasor, probes, recorded, shaft, true_phasors

RAMPED = recorded(6.0, rpm=1500.0, ramp=60.0, noise=0.02)


def settings(**changes: object) -> BlockSettings:
    values: dict[str, object] = {
        "channels": ("B2X", "B2Y"),
        "lowest_rpm": 300.0,
        "highest_rpm": 3000.0,
        "rails": (None, None),
        "seconds": 0.5,
    }
    return BlockSettings(**(values | changes))  # type: ignore[arg-type]


BY_SECONDS, BY_TURNS = settings(), settings(seconds=None, turns=11)


def chunk(values: Floats, first: int = 0, **changes: object) -> Chunk:
    return Chunk(first, values[:, first:], **({"sampling_rate": RATE, "anchor": 0, "anchor_ns": START_NS} | changes))  # type: ignore[arg-type]


def run(values: Floats, used: BlockSettings, cuts: Sequence[int] = (), position: Position | None = None) -> list[BlockOutcome]:
    """All outcomes of a waveform that comes in pieces."""
    stream = BlockStream(used, position)
    first = stream.first_needed()
    bounds = [first, *sorted(cut for cut in cuts if first < cut < values.shape[1]), values.shape[1]]
    found: list[BlockOutcome] = []
    for begin, end in zip(bounds[:-1], bounds[1:], strict=True):
        found += stream.feed(Chunk(begin, values[:, begin:end], RATE, 0, START_NS))
    return found + list(stream.finish())


def assert_same(one: list[BlockOutcome], other: list[BlockOutcome]) -> None:
    """Equal to the last bit."""
    assert [(o.time_ns, o.found, o.position) for o in one] == [(o.time_ns, o.found, o.position) for o in other]
    for left, right in zip(one, other, strict=True):
        assert (left.block is None) == (right.block is None)
        if left.block is not None and right.block is not None:
            assert left.block.phasors.tobytes() == right.block.phasors.tobytes()
            assert left.block.scatter.tobytes() == right.block.scatter.tobytes()
            assert (left.block.speed, left.block.turns, left.block.faults) == (
                right.block.speed,
                right.block.turns,
                right.block.faults,
            )


@pytest.mark.parametrize("used", [BY_SECONDS, BY_TURNS], ids=["seconds", "turns"])
@given(cuts=st.lists(st.integers(1, RAMPED.shape[1] - 1), max_size=30))
@settings_of_examples(few_examples, max_examples=15)
def test_chunks_give_what_the_whole_gives(used: BlockSettings, cuts: list[int]) -> None:
    assert_same(run(RAMPED, used, cuts), run(RAMPED, used))


@pytest.mark.parametrize("used", [BY_SECONDS, BY_TURNS], ids=["seconds", "turns"])
def test_reading_goes_on_from_any_position_as_if_nothing_had_happened(used: BlockSettings) -> None:
    whole = run(RAMPED, used, [5000])
    assert len(whole) >= 11
    for place, outcome in enumerate(whole[:-1]):
        assert_same(run(RAMPED, used, [7000], outcome.position), whole[place + 1 :])


@pytest.mark.parametrize("used", [BY_SECONDS, BY_TURNS], ids=["seconds", "turns"])
def test_the_phasors_are_those_of_the_machine(used: BlockSettings) -> None:
    """At constant speed, without noise, to the interpolation of the keyphasor's edges."""
    found = [one for one in run(recorded(4.0, rpm=1777.0), used) if one.block is not None]
    first, second = true_phasors(2)
    assert len(found) >= 7
    for one in found:
        assert one.block is not None
        assert one.found == ()
        assert one.block.phasors[:, 0] == pytest.approx(first, rel=1e-3)
        assert one.block.phasors[:, 1] == pytest.approx(second, rel=1e-3)
        assert one.block.speed == pytest.approx(1777.0 * math.pi / 30.0, rel=2e-4)
        assert one.time_ns == START_NS + round(one.block.time * 1e9)


def test_blocks_follow_each_other_without_a_hole() -> None:
    """By seconds: everything but what lies before the first pulse and behind the last whole block is used."""
    outcomes = run(RAMPED, BY_SECONDS)
    assert [one.position.begin for one in outcomes] == [0.5 * (k + 1) for k in range(12)]
    used = [one.block.samples for one in outcomes if one.block is not None]
    assert used[1:-1] == [1024] * 10
    assert 1024 - RATE * 60.0 / 1500.0 <= used[0] < 1024
    assert used[-1] <= 1024
    by_turns = [one for one in run(RAMPED, BY_TURNS) if one.block is not None]
    assert {round(one.block.turns, 6) for one in by_turns if one.block} == {11.0}
    ends = [one.position.begin for one in by_turns]
    begins = [one.block.time - (one.position.begin - one.block.time) for one in by_turns if one.block]
    assert begins[1:] == pytest.approx(ends[:-1], abs=1e-9)


def test_memory_is_bounded_by_the_window() -> None:
    stream = BlockStream(BY_SECONDS)
    endless = np.concatenate([RAMPED] * 3, axis=1)
    for begin in range(0, endless.shape[1], 512):
        list(stream.feed(Chunk(begin, endless[:, begin : begin + 512], RATE, 0, START_NS)))
        assert stream._window is not None
        assert stream._window.values.shape[1] <= (0.5 + 2 * 0.25) * RATE + 512


def test_a_hole_begins_again_and_costs_no_more_than_a_block_on_each_side() -> None:
    stream = BlockStream(BY_SECONDS)
    hole = slice(5000, 5100)
    found = list(stream.feed(Chunk(0, RAMPED[:, : hole.start], RATE, 0, START_NS)))
    found += stream.feed(Chunk(hole.stop, RAMPED[:, hole.stop :], RATE, 0, START_NS))
    found += stream.finish()
    assert {one.position.segment for one in found} == {0, hole.stop}
    times = [(one.time_ns - START_NS) / 1e9 for one in found if one.block is not None]
    assert np.max(np.diff(times)) < 1.1
    assert len(times) >= 10


def at_standstill(values: Floats, begin: float, end: float) -> Floats:
    still = values.copy()
    part = slice(round(begin * RATE), round(end * RATE))
    still[0, part] = -10.0
    return still


@pytest.mark.parametrize("used", [BY_SECONDS, BY_TURNS], ids=["seconds", "turns"])
def test_without_a_keyphasor_there_are_no_samples_and_it_goes_on_when_it_returns(used: BlockSettings) -> None:
    outcomes = run(at_standstill(RAMPED, 1.6, 4.4), used)
    names = {found.name for one in outcomes for found in one.found}
    assert names & {"no_pulses", "keyphasor_gap"}
    lost = [one for one in outcomes if 1.9 < (one.time_ns - START_NS) / 1e9 < 4.1]
    assert lost
    assert all(one.block is None and one.found for one in lost)
    times = [(one.time_ns - START_NS) / 1e9 for one in outcomes if one.block is not None]
    assert min(times) < 0.6
    assert max(times) > 5.2
    assert not outcomes[-1].found


def test_a_noisy_keyphasor_gives_no_samples() -> None:
    values = RAMPED.copy()
    values[0] = np.random.default_rng(1).normal(size=values.shape[1])
    outcomes = run(values, BY_SECONDS)
    assert len(outcomes) == 12
    assert all(one.block is None for one in outcomes)
    assert {found.name for one in outcomes for found in one.found} <= {"inconsistent_pulses", "no_pulses"}


def test_marks_that_were_not_declared_are_named() -> None:
    """Evenly spaced ones only by a speed that the machine cannot have, uneven ones by their pattern."""
    at = np.arange(round(3 * RATE)) / RATE
    angle = shaft(at, rpm=2500.0)
    even = np.vstack([keyphasor(angle, marks=2), probes(angle, 2)])
    assert {found.name for one in run(even, BY_SECONDS) for found in one.found} == {"speed_out_of_range"}
    uneven = np.vstack([np.maximum(keyphasor(angle), keyphasor(angle - 2.2)), probes(angle, 2)])
    outcomes = run(uneven, BY_SECONDS)
    assert {found.name for one in outcomes for found in one.found} == {"several_pulses"}
    assert "repeat every 2 pulses" in outcomes[0].found[0].detail


def test_declared_marks_keep_their_count_from_block_to_block() -> None:
    at = np.arange(round(5 * RATE)) / RATE
    angle = shaft(at, rpm=700.0, ramp=15.0)
    values = np.vstack([keyphasor(angle, marks=4), probes(angle, 2)])
    used = settings(pulses_per_turn=4)
    outcomes = run(values, used, [3000, 3001, 8000])
    first, _ = true_phasors(2)
    relative = np.array([one.block.phasors[:, 0] / first for one in outcomes if one.block is not None])
    assert len(relative) >= 9
    turned = np.angle(relative[0, 0])
    assert turned / (math.pi / 2.0) == pytest.approx(round(turned / (math.pi / 2.0)), abs=0.01)
    assert relative == pytest.approx(np.full_like(relative, relative[0, 0]), abs=5e-3)
    assert_same(run(values, used, [4000], outcomes[3].position), outcomes[4:])


def test_when_the_count_of_the_marks_is_lost_the_values_are_not_good_until_standstill() -> None:
    at = np.arange(round(9 * RATE)) / RATE
    angle = shaft(at, rpm=1200.0)
    values = np.vstack([keyphasor(angle, marks=4), probes(angle, 2)])
    values[0, round(2 * RATE) : round(3.5 * RATE)] = math.nan
    values = at_standstill(values, 5.0, 7.0)
    # Below 1.5 times its lowest speed the machine may have stopped when the pulses end.
    outcomes = run(values, settings(pulses_per_turn=4, lowest_rpm=1000.0))

    def lost(begin: float, end: float) -> set[bool]:
        inside = [one for one in outcomes if one.block is not None and begin < (one.time_ns - START_NS) / 1e9 < end]
        return {any(found.name == "phase_reference_lost" for found in one.found) for one in inside}

    assert lost(0.0, 1.7) == {False}
    assert lost(3.6, 4.9) == {True}
    assert lost(7.5, 9.0) == {False}
    faster = run(values, settings(pulses_per_turn=4))
    assert [found.name for found in faster[-1].found] == ["phase_reference_lost"]


def test_what_is_wrong_with_a_channel_is_said_of_it_and_the_others_are_used() -> None:
    values = recorded(4.0, channels=4, rpm=1777.0)
    values[1, 3000:] = 0.0  # unplugged
    values[2, 2500] = math.nan
    values[3] = np.clip(values[3], -9.3, None)
    channels = ("B2X", "B2Y", "B3X", "B3Y")
    used = settings(channels=channels, rails=((-20.0, -0.5),) * 4)
    outcomes = run(values, used)
    first, _ = true_phasors(4)
    for one in outcomes:
        assert one.block is not None
        assert one.block.phasors[3, 0] == pytest.approx(first[3], rel=1e-3)
    said = [{(found.name, found.subject) for found in one.found} for one in outcomes]
    assert ("rail", "B2X") not in said[0]
    assert ("rail", "B2X") in said[-1]
    assert [("not_finite", "B2Y") in one for one in said] == [k == 2 for k in range(8)]
    assert all(("clipped", "B3X") in one for one in said)
    assert not any(subject == "B3Y" for one in said for _, subject in one)


def test_missing_pulses_are_bridged_and_said() -> None:
    values = RAMPED.copy()
    pulses = np.flatnonzero(np.diff((values[0] > -6.0).astype(int)) == 1)
    values[0, pulses[40] - 20 : pulses[40] + 20] = -10.0
    outcomes = run(values, BY_SECONDS)
    told = [found for one in outcomes for found in one.found]
    assert [found.name for found in told] == ["pulses_repaired"]
    assert told[0].detail == "1 missing and 0 extra pulses in a block"
    assert all(one.block is not None for one in outcomes)


def test_a_wrong_sampling_rate_shows_as_a_speed_beyond_the_machine() -> None:
    stream = BlockStream(BY_SECONDS)
    found = list(stream.feed(Chunk(0, recorded(4.0, rpm=2500.0), 2.0 * RATE, 0, START_NS)))
    assert found
    assert all(one.block is None for one in found)
    assert {one.name for outcome in found for one in outcome.found} == {"speed_out_of_range"}
    assert "5000.2 r/min by the keyphasor" in found[0].found[0].detail
