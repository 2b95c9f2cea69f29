"""Models of long trains are computed in a process of their own, which others do not feel, within its time and memory."""

import os
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from benchmarks.estimator.large_trains import large_train
from estimator.machine.document import parse_machine
from estimator.modes.eigenmodes import modes
from estimator.rotor.system_matrices import system_matrices
from formats.files.document_files import read_machine
from service.api.cache.model_process import ModelProcess, NotComputed, is_long
from service.http.error_status import status_of
from tests.paths import EXAMPLES
from tests.plant import machine

MEMORY_BYTES = 2**30


@pytest.fixture(scope="module")
def process() -> Iterator[ModelProcess]:
    started = ModelProcess(time_s=20.0, memory_bytes=MEMORY_BYTES)
    yield started
    started.close()


@pytest.fixture
def hasty() -> Iterator[ModelProcess]:
    started = ModelProcess(time_s=1.0, memory_bytes=MEMORY_BYTES)
    yield started
    started.close()


def test_a_train_of_60_sections_is_long_and_an_ordinary_one_is_not() -> None:
    assert is_long(parse_machine(large_train(60, seed=1)))
    assert not is_long(machine())


def test_a_train_on_oil_films_is_long_however_short() -> None:
    """A pad that is not known yet takes seconds."""
    assert is_long(read_machine(EXAMPLES / "turbine-on-tilting-pads.yaml"))


def test_it_is_another_process_and_the_same_one_each_time(process: ModelProcess) -> None:
    first, second = process.compute(os.getpid), process.compute(os.getpid)
    assert first == second != os.getpid()


def test_while_it_computes_another_process_does_what_else_is_asked(process: ModelProcess) -> None:
    assert process.compute(abs, -1) == 1  # it is there
    with ThreadPoolExecutor() as beside:
        slow = beside.submit(process.compute, time.sleep, 10.0)
        time.sleep(0.2)
        assert process.compute(abs, -1) == 1
        assert not slow.done()
        process.close()  # what is computed is given up
        with pytest.raises(NotComputed):
            slow.result(10.0)
    assert process.compute(abs, -1) == 1


def test_what_is_raised_there_is_raised_here(process: ModelProcess) -> None:
    with pytest.raises(ValueError, match="could not convert"):
        process.compute(float, "no number")


def test_too_long_a_computation_is_given_up_and_the_next_one_is_done(hasty: ModelProcess) -> None:
    with pytest.raises(NotComputed, match="could not be computed within 1 s") as refused:
        hasty.compute(time.sleep, 30.0)
    assert status_of(refused.value) == 503
    assert hasty.compute(abs, -1) == 1


def test_too_large_a_computation_is_given_up_and_the_next_one_is_done(process: ModelProcess) -> None:
    with pytest.raises(NotComputed, match=r"1\.0 GiB"):
        process.compute(np.zeros, 2 * MEMORY_BYTES)
    assert process.compute(abs, -1) == 1


def eigenvalue_problem() -> int:
    """One that keeps the interpreter's lock for a second or so."""
    return modes(system_matrices(parse_machine(large_train(120, seed=1))), spin=100.0).eigenvalue.size


def test_others_have_their_turns_meanwhile(process: ModelProcess) -> None:
    assert process.compute(abs, -1) == 1  # it is there
    turns, done = [time.monotonic()], threading.Event()

    def take_turns() -> None:
        while not done.is_set():
            time.sleep(0.001)
            turns.append(time.monotonic())

    taking = threading.Thread(target=take_turns)
    taking.start()
    try:
        assert process.compute(eigenvalue_problem) > 100
    finally:
        done.set()
        taking.join()
    took = turns[-1] - turns[0]
    assert took > 0.3  # there was something to wait for
    assert np.max(np.diff(turns)) < took / 2  # who holds the lock holds it nearly all the time
