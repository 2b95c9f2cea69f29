"""Replies to queries of the service and of sources: JSON, without a frame."""

import msgspec


class SourceReceived(msgspec.Struct, kw_only=True):
    """Durable reception state of one start of a source, which need no longer keep samples before `next_sequence`."""

    source: str
    epoch: int
    next_sequence: int
    received: int
    duplicates: int
    lost: int


class Received(msgspec.Struct, kw_only=True):
    """The service's reply on `…/received`: every source of the machine that it knows."""

    plant: str
    machine: str
    sources: list[SourceReceived]
