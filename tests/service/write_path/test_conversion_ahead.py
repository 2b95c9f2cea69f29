"""Batches are converted to SI before the transaction that stores them, and again only where their document was revised."""

import pytest

from formats.wire import to_samples
from service.write_path import batch as batches
from service.write_path.batch import ArrivedBatch
from storage.database.engine import Database
from storage.machines import machines
from storage.measurements import samples as sample_store
from tests.plant import SECOND, START, arrived, batch, machine, sweep_rpm
from tests.prompt_writer import PromptWriter

SPEEDS = sweep_rpm(900.0, 1200.0, 30)


def piece(number: int) -> ArrivedBatch:
    """The `number`th ten samples of a source."""
    return arrived(batch(SPEEDS[10 * number : 10 * number + 10], sequence=10 * number, start=START + 10 * number * SECOND))


def test_what_is_stored_was_converted_outside_of_the_transaction(
    plant: Database, writer: PromptWriter, monkeypatch: pytest.MonkeyPatch
) -> None:
    writer.store([piece(0)], [])  # the document is known from here on
    within: list[bool] = []

    def noting(*given: object, **more: object) -> object:
        within.append(plant._turn._lock.locked())
        return to_samples(*given, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(batches, "to_samples", noting)
    writer.store([piece(1), piece(2)], [])
    assert within == [False, False]
    with plant.reading() as session:
        assert len(sample_store.latest(session, "pump-7", revision=1, count=100)) == 30


def test_a_batch_converted_before_its_document_was_revised_is_converted_again(plant: Database, writer: PromptWriter) -> None:
    writer.store([piece(0)], [])
    waits = piece(1)
    first = machine()
    before = waits.converted(1, first)
    assert waits.converted(1, first) is before
    with plant.transaction() as session:
        changed = tuple(reversed(first.probes))
        machines.revise(session, first.model_copy(update={"probes": changed}))
    writer.store([waits], [])
    with plant.reading() as session:
        stored = sample_store.latest(session, "pump-7", revision=2, count=100)
    assert len(stored) == 10
    assert stored.phasor.tolist() == before.samples.phasor[:, ::-1].tolist(), "in the order of the new document"


@pytest.mark.usefixtures("plant")
def test_there_is_a_pause_after_a_conversion_and_none_where_nothing_was_converted(
    writer: PromptWriter, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pauses for nothing would use up the time that a cycle has for them."""
    writer.store([piece(0)], [])
    pauses: list[None] = []
    monkeypatch.setattr(writer.pacing, "pause", lambda: pauses.append(None))
    writer.store([piece(1)], [])
    with_conversion = len(pauses)
    waits = piece(2)
    waits.converted(1, machine())
    writer.store([waits], [])
    assert len(pauses) - with_conversion == with_conversion - 1
