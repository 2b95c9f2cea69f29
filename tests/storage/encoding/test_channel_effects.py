"""Effects of channels' errors come back exactly, also from blocks that an older release wrote."""

import io
import zlib

import msgspec
import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fit.validation.channel_sensitivity import ChannelEffects
from storage.encoding import channel_effects


@pytest.fixture
def effects() -> ChannelEffects:
    """Effects of 3 errors in 2 channels on a fit of 5 coordinates."""
    random = np.random.default_rng(7)
    return ChannelEffects(
        names=("probe.Ä.gain.real", "probe.Ä.gain.imaginary", "probe.B.run_out.real"),
        bias=random.standard_normal((5, 3)).T.copy().T,  # in columns, as a fit may leave it
        information=random.standard_normal((3, 3)),
        score=random.standard_normal(3),
        phasors=(100, 0),
        amplitude=(1.5e-6, 0.0),
    )


def test_estimates_beside_a_large_gain_come_back_and_are_missing_from_older_blocks(effects: ChannelEffects) -> None:
    random = np.random.default_rng(8)
    about = replace(effects, point=random.standard_normal(5), covariance=random.standard_normal((5, 5)))
    found = channel_effects.decode(channel_effects.encode(about))
    assert found.point is not None
    assert found.covariance is not None
    np.testing.assert_array_equal(found.point, about.point)
    np.testing.assert_array_equal(found.covariance, about.covariance)
    fields = msgspec.msgpack.decode(zlib.decompress(channel_effects.encode(about)))
    before = channel_effects.decode(zlib.compress(msgspec.msgpack.encode(fields[:8])))
    assert before.point is None
    assert before.covariance is None


def assert_same(one: ChannelEffects, other: ChannelEffects) -> None:
    assert (one.names, one.phasors, one.amplitude) == (other.names, other.phasors, other.amplitude)
    for name in ("bias", "information", "score"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), strict=True)


def test_they_come_back_exactly(effects: ChannelEffects) -> None:
    assert_same(channel_effects.decode(channel_effects.encode(effects)), effects)


def test_a_fit_that_knows_all_errors_as_parameters_has_none_left(effects: ChannelEffects) -> None:
    none = ChannelEffects((), np.zeros((5, 0)), np.zeros((0, 0)), np.zeros(0), effects.phasors, effects.amplitude)
    assert_same(channel_effects.decode(channel_effects.encode(none)), none)


def test_blocks_of_older_releases_are_read(effects: ChannelEffects) -> None:
    block = io.BytesIO()
    np.savez_compressed(
        block,
        names=np.array(effects.names),
        bias=effects.bias,
        information=effects.information,
        score=effects.score,
        phasors=np.array(effects.phasors, dtype=np.int64),
        amplitude=np.array(effects.amplitude),
    )
    assert_same(channel_effects.decode(block.getvalue()), effects)


def test_errors_that_a_fit_was_linearised_at_come_back_and_the_release_before_had_none(effects: ChannelEffects) -> None:
    at = np.array([0.0, 0.0, 3e-6])
    block = channel_effects.encode(replace(effects, at=at))
    np.testing.assert_array_equal(channel_effects.decode(block).at, at)
    fields = msgspec.msgpack.decode(zlib.decompress(channel_effects.encode(effects)))
    before = channel_effects.decode(zlib.compress(msgspec.msgpack.encode(fields[:6])))
    assert_same(before, effects)
    assert before.at is None
