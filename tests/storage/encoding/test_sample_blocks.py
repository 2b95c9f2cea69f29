"""The compressed sample block: exact to the bit whatever it holds, and refused when it is damaged."""

import struct
import zlib
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from msgspec.structs import replace

from benchmarks.disk import noisy
from estimator.phasors.channel_status import ChannelStatus
from storage.encoding.packing import QUANTUM, on_grid
from storage.encoding.sample_blocks import DamagedBlock, Samples, decode, encode, join, mean_conditions
from tests.plant import START, assert_same_samples, few_examples, samples

NAN_WITH_PAYLOAD = struct.unpack("<d", struct.pack("<Q", 0x7FF800000000BEEF))[0]


@st.composite
def any_samples(draw: st.DrawFn) -> Samples:
    """Samples with every float there is: NaN, infinities, subnormal numbers and negative zero among them."""
    count, channels, conditions = draw(st.integers(0, 6)), draw(st.integers(1, 5)), draw(st.integers(0, 3))
    table = (count, channels)
    floats = st.floats(width=64)
    return Samples(
        time=draw(arrays.arrays(np.int64, count)),
        speed=draw(arrays.arrays(np.float64, count, elements=floats)),
        direction=draw(arrays.arrays(np.int8, count, elements=st.sampled_from([1, -1]))),
        phasor=draw(arrays.arrays(np.float64, (count, 2 * channels), elements=floats)).view(np.complex128),
        status=draw(arrays.arrays(np.uint8, table, elements=st.sampled_from(list(map(int, ChannelStatus))))),
        scatter=draw(arrays.arrays(np.float64, table, elements=floats)),
        second=draw(arrays.arrays(np.float64, (count, 2 * channels), elements=floats)).view(np.complex128),
        conditions=draw(arrays.arrays(np.float64, (count, conditions if count else 0), elements=floats)),
        gap=draw(st.just(np.full(table, np.nan)) | arrays.arrays(np.float64, table, elements=floats)),
        overall=draw(st.just(np.full(table, np.nan)) | arrays.arrays(np.float64, table, elements=floats)),
    )


@few_examples
@given(any_samples())
def test_round_trip_is_exact_to_the_bit(held: Samples) -> None:
    assert_same_samples(decode(encode(held)), held)


def test_round_trip_keeps_the_bits_of_nan() -> None:
    held = samples(2)
    held.scatter[0, 0] = NAN_WITH_PAYLOAD
    assert_same_samples(decode(encode(held)), held)


def test_decoded_arrays_can_be_written_to() -> None:
    found = decode(encode(samples(2)))
    found.speed[0] = 1.0
    found.status[0, 0] = ChannelStatus.GOOD
    assert found.usable[0, 0]


def test_a_block_of_usual_samples_is_smaller_than_its_numbers() -> None:
    held = samples(200)
    assert len(encode(held)) < sum(getattr(held, name).nbytes for name in ("time", "speed", "phasor", "scatter")) / 4


@pytest.mark.parametrize(
    "spoil",
    [
        pytest.param(lambda data: data[:0], id="empty"),
        pytest.param(lambda data: data[:7], id="half a header"),
        pytest.param(lambda data: data[:12], id="only a header"),
        pytest.param(lambda data: data[:-5], id="cut off"),
        pytest.param(lambda data: b"XXXX" + data[4:], id="another file"),
        pytest.param(lambda data: data[:4] + struct.pack("<H", 7) + data[6:], id="format of the future"),
        pytest.param(lambda data: data[:4] + struct.pack("<H", 5) + data[6:], id="a gap that is not there"),
        pytest.param(lambda data: data[:4] + struct.pack("<H", 6) + data[6:], id="overall levels that are not there"),
        pytest.param(lambda data: data[:12] + bytes(len(data) - 12), id="zeros"),
        pytest.param(lambda data: data[:12] + zlib.compress(b"short"), id="too little inside"),
        pytest.param(lambda data: data[:8] + struct.pack("<I", 2**32 - 1) + data[12:], id="count too large"),
        pytest.param(lambda data: data[:8] + struct.pack("<I", 2) + data[12:], id="count too small"),
        pytest.param(lambda data: data[:6] + struct.pack("<H", 3) + data[8:], id="channels too few"),
    ],
)
def test_damaged_block_is_refused(spoil: Callable[[bytes], bytes]) -> None:
    with pytest.raises(DamagedBlock):
        decode(spoil(encode(samples(3))))


def test_every_flipped_bit_is_refused_or_harmless() -> None:
    held = samples(5)
    data = encode(held)
    for bit in range(8 * len(data)):
        flipped = bytearray(data)
        flipped[bit // 8] ^= 1 << bit % 8
        try:
            found = decode(bytes(flipped))
        except DamagedBlock:
            continue
        assert_same_samples(found, held)


def test_join_keeps_the_order_given() -> None:
    late, early = samples(2, start=START + 100), samples(3)
    together = join([late, early], channels=4)
    assert together.time.tolist() == [*late.time.tolist(), *early.time.tolist()]
    assert together.phasor.shape == (5, 4)


def as_an_older_release_wrote_it(held: Samples, version: int) -> bytes:
    """Format 2, or 3 with conditions: all numbers side by side."""
    columns = (held.time, held.speed, held.direction, held.phasor, held.status, held.scatter, held.second, held.conditions)
    packed = zlib.compress(b"".join(column.tobytes() for column in columns), 1)
    count, channels = held.phasor.shape
    checksum = zlib.crc32(packed, zlib.crc32(struct.pack("<HI", channels, count)))
    return struct.pack("<4sHHII", b"RDSB", version, channels, count, checksum) + packed


def test_blocks_of_older_releases_are_read() -> None:
    held = samples(5)
    assert_same_samples(decode(as_an_older_release_wrote_it(held, 2)), held)
    warm = replace(samples(2), conditions=np.array([[60.0], [61.0]]))
    assert_same_samples(decode(as_an_older_release_wrote_it(warm, 3)), warm)


def test_what_samples_do_not_have_is_not_written_so_that_older_releases_read_them() -> None:
    held = samples(5)
    assert encode(held)[4:6] == struct.pack("<H", 4)
    with_gap = replace(held, gap=np.full(held.phasor.shape, 1e-4))
    assert encode(with_gap)[4:6] == struct.pack("<H", 5)
    assert np.isnan(decode(encode(held)).gap).all()
    with_overall = replace(held, overall=np.full(held.phasor.shape, 3e-5))
    assert encode(with_overall)[4:6] == struct.pack("<H", 6)
    found = decode(encode(with_overall))
    assert np.isnan(found.gap).all()
    assert found.overall.tolist() == [[3e-5] * 4] * 5
    assert np.isnan(decode(encode(with_gap)).overall).all()


def test_joined_pieces_without_a_gap_have_none() -> None:
    held = samples(2)
    together = join([samples(1), replace(held, gap=np.full(held.phasor.shape, 1e-4))], channels=4)
    assert np.isnan(together.gap[0]).all()
    assert together.pick(slice(1, 3)).gap.tolist() == [[1e-4] * 4] * 2


@few_examples
@given(any_samples())
def test_what_is_rounded_at_the_door_is_exact_in_the_store(held: Samples) -> None:
    near = np.abs(held.scatter) < 1.0
    told = replace(held, scatter=on_grid(np.where(near, held.scatter, np.nan)))
    assert_same_samples(decode(encode(told)), told)
    assert np.all(np.abs(told.scatter - held.scatter)[near] <= QUANTUM / 2)


def test_a_run_takes_less_than_it_may() -> None:
    """10,000 samples of 16 channels with 1×, 2×, scatter, and noise on all of them: 3 MB at most."""
    held = noisy()
    run = encode(held)
    assert_same_samples(decode(run), held)
    assert len(run) < 1.9e6


def test_joined_pieces_without_a_condition_did_not_measure_it() -> None:
    warm = replace(samples(2), conditions=np.array([[60.0, 80.0], [61.0, 82.0]]))
    together = join([samples(1), warm, join([], channels=4)], channels=4)
    assert np.isnan(together.conditions[0]).all()
    assert together.conditions[1:].tolist() == warm.conditions.tolist()
    assert together.pick(slice(1, 2)).conditions.tolist() == [[60.0, 80.0]]


def test_mean_conditions_are_of_what_was_measured() -> None:
    warm = replace(samples(3), conditions=np.array([[60.0, np.nan], [np.nan, np.nan], [66.0, np.nan]]))
    assert mean_conditions([warm, samples(4)], ["oil", "load"]) == {"oil": 63.0, "load": None}
    assert mean_conditions([samples(4)], ["oil"]) == {"oil": None}
    assert mean_conditions([], []) == {}


def test_join_of_nothing_has_the_channels() -> None:
    nothing = join([], channels=4)
    assert len(nothing) == 0
    assert nothing.phasor.shape == nothing.usable.shape == nothing.scatter.shape == (0, 4)
    assert_same_samples(decode(encode(nothing)), nothing)


def test_between_includes_both_ends() -> None:
    held = samples(5, step=10)
    assert held.between(START + 10, START + 30).time.tolist() == [START + 10, START + 20, START + 30]


def test_measurement_is_what_the_estimator_takes() -> None:
    held = samples(4)
    measurement = held.measurement()
    assert measurement.direction.tolist() == [1.0] * 4
    assert measurement.usable.tolist() == held.usable.tolist()
