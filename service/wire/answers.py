"""Answers of the two sides to queries: JSON, without a frame."""

import msgspec


class SourceReceived(msgspec.Struct, kw_only=True):
    """How far one start of a source is durable: what it need no longer keep ends before `next_sequence`."""

    source: str
    epoch: int
    next_sequence: int
    received: int
    duplicates: int
    lost: int


class Received(msgspec.Struct, kw_only=True):
    """The service's answer on `…/received`: every source of the machine that it ever heard of."""

    plant: str
    machine: str
    sources: list[SourceReceived]
