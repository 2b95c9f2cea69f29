"""How the effects of single channels' errors on a fit are kept: one compressed block of arrays, exact to the bit."""

import io

import numpy as np

from estimator.channel_effects import ChannelEffects


def encode(effects: ChannelEffects) -> bytes:
    """To a block."""
    block = io.BytesIO()
    np.savez_compressed(
        block,
        names=np.array(effects.names),
        bias=effects.bias,
        information=effects.information,
        score=effects.score,
        phasors=np.array(effects.phasors, dtype=np.int64),
        amplitude=np.array(effects.amplitude, dtype=float),
    )
    return block.getvalue()


def decode(block: bytes) -> ChannelEffects:
    """From a block."""
    with np.load(io.BytesIO(block), allow_pickle=False) as arrays:
        return ChannelEffects(
            names=tuple(map(str, arrays["names"].tolist())),
            bias=arrays["bias"],
            information=arrays["information"],
            score=arrays["score"],
            phasors=tuple(arrays["phasors"].tolist()),
            amplitude=tuple(arrays["amplitude"].tolist()),
        )
