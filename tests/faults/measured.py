"""Samples as an instrument would have measured them: sample `k` is always the same, so that the store can be compared with
it."""

from pathlib import Path

import numpy as np

from formats.wire import SampleBatch, to_samples
from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples, decode, join
from storage.tables.measurements import SampleBlockRow
from tests.plant import CHANNELS, KEY, START, batch, machine, sqlite_url

STEP = 10_000_000
"""Between samples [ns]."""
SIZE = 5
"""Samples in a batch."""


def measured(first: int, count: int = SIZE, **changes: object) -> SampleBatch:
    """Samples `first` and those after it."""
    k = np.arange(first, first + count)
    columns = np.arange(len(CHANNELS))
    return batch(
        (900.0 + 5.0 * np.sin(k / 50.0)).tolist(),
        sequence=first,
        start=START + first * STEP,
        step=STEP,
        amplitude_unit="um",
        amplitude=(50.0 + 10.0 * np.sin(k[:, np.newaxis] / 7.0 + columns)).tolist(),
        phase=((k[:, np.newaxis] * 0.7 + 90.0 * columns) % 360.0).tolist(),
        **changes,
    )


def expected(count: int) -> Samples:
    """The first samples as the store must hold them."""
    samples, taken, faults = to_samples(measured(0, count), machine(), received_at=START + 86_400 * 10**9)
    assert taken.all()
    assert not faults
    return samples


def stored(file: Path) -> tuple[list[int], Samples]:
    """Samples of the only source and which of those measured they are, in the order in which they were stored."""
    return stored_at(sqlite_url(file))


def stored_at(url: str) -> tuple[list[int], Samples]:
    """The same of a database by URL."""
    database = Database(url)
    try:
        with database.reading() as session:
            rows = session.query(SampleBlockRow).order_by(SampleBlockRow.id).all()
            assert len({(row.machine_id, row.source, row.epoch) for row in rows}) <= 1
            assert {row.machine_id for row in rows} <= {KEY.machine}
            samples = join([decode(row.data) for row in rows], channels=len(CHANNELS))
            return ((samples.time - START) // STEP).tolist(), samples
    finally:
        database.close()
