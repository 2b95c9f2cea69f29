"""Storage of the effects of single channels' errors on a fit: one compressed block, exact to the bit."""

import io
import zlib

import msgspec
import numpy as np

from estimator.arrays import Floats
from estimator.fit.validation.channel_sensitivity import ChannelEffects

ZIP = b"PK"
"""Prefix of a block that an older release wrote: a numpy archive."""


class _Block(msgspec.Struct, array_like=True):
    """Arrays as bytes of little-endian doubles, row by row; coordinates: rows of `bias`, missing in older blocks."""

    names: tuple[str, ...]
    bias: bytes
    information: bytes
    score: bytes
    phasors: tuple[int, ...]
    amplitude: tuple[float, ...]
    coordinates: int | None = None
    at: bytes = b""  # empty: linearised without errors, as older releases do
    point: bytes = b""  # empty: the fit's own, as in older releases
    covariance: bytes = b""


def encode(effects: ChannelEffects) -> bytes:
    """Encode channel effects as a block."""
    block = _Block(
        names=effects.names,
        bias=_bytes(effects.bias),
        information=_bytes(effects.information),
        score=_bytes(effects.score),
        phasors=effects.phasors,
        amplitude=effects.amplitude,
        coordinates=len(effects.bias),
        at=b"" if effects.at is None else _bytes(effects.at),
        point=b"" if effects.point is None else _bytes(effects.point),
        covariance=b"" if effects.covariance is None else _bytes(effects.covariance),
    )
    return zlib.compress(msgspec.msgpack.encode(block))


def decode(block: bytes) -> ChannelEffects:
    """Decode a block."""
    if block.startswith(ZIP):
        return _decode_zip(block)
    found = msgspec.msgpack.decode(zlib.decompress(block), type=_Block)
    errors, own = len(found.names), len(found.point) // 8
    return ChannelEffects(
        names=found.names,
        bias=np.frombuffer(found.bias, "<f8").reshape(-1 if found.coordinates is None else found.coordinates, errors),
        information=np.frombuffer(found.information, "<f8").reshape(errors, errors),
        score=np.frombuffer(found.score, "<f8"),
        phasors=found.phasors,
        amplitude=found.amplitude,
        at=np.frombuffer(found.at, "<f8") if found.at else None,
        point=np.frombuffer(found.point, "<f8") if found.point else None,
        covariance=np.frombuffer(found.covariance, "<f8").reshape(own, own) if found.covariance else None,
    )


def _bytes(array: Floats) -> bytes:
    return np.ascontiguousarray(array, dtype="<f8").tobytes()


def _decode_zip(block: bytes) -> ChannelEffects:
    with np.load(io.BytesIO(block), allow_pickle=False) as arrays:
        return ChannelEffects(
            names=tuple(map(str, arrays["names"].tolist())),
            bias=arrays["bias"],
            information=arrays["information"],
            score=arrays["score"],
            phasors=tuple(arrays["phasors"].tolist()),
            amplitude=tuple(arrays["amplitude"].tolist()),
        )
