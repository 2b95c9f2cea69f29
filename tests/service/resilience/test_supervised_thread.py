"""The loop of the background threads: an error is told until a turn succeeds, and a stop ends the loop in order."""

import logging

import pytest
from sqlalchemy.exc import OperationalError

from service.resilience.supervised_thread import SupervisedThread
from tests.plant import wait_until


class Counting(SupervisedThread):
    """Counts its turns, of which these fail, by number."""

    def __init__(self, **errors: Exception) -> None:
        super().__init__("counting", failure="nothing is counted", retry_s=0.02)
        self.errors = {int(number.removeprefix("at_")): error for number, error in errors.items()}
        self.turns = 0
        self.finished = 0
        self.troubles: list[str | None] = []

    def run_once(self) -> float:
        self.troubles.append(self.trouble)
        self.turns += 1
        if self.turns in self.errors:
            raise self.errors[self.turns]
        return 0.01

    def finish(self) -> None:
        self.finished += 1
        if 0 in self.errors:
            raise self.errors[0]


def test_a_turn_that_fails_is_reported_until_one_succeeds(caplog: pytest.LogCaptureFixture) -> None:
    away = OperationalError("SELECT", {}, Exception("the server went away"))
    counting = Counting(at_1=away, at_2=LookupError("no such thing"))
    counting.start()
    wait_until(lambda: counting.turns >= 4)
    assert counting.alive
    assert counting.troubles[:4] == [
        None,
        "nothing is counted: the server went away",
        "nothing is counted: unexpected error; the log has it",
        None,
    ]
    counting.stop()
    assert not counting.alive
    first, second = (record for record in caplog.records if record.levelno == logging.ERROR)
    assert (first.name, first.exc_info) == (__name__, None)
    assert second.exc_info is not None
    assert "no such thing" in caplog.text


def test_a_stop_ends_after_the_turn_and_finishes_once() -> None:
    counting = Counting(at_0=LookupError("no such thing"))
    counting.start()
    wait_until(lambda: counting.turns >= 1)
    counting.stop()
    turns = counting.turns
    assert (counting.finished, counting.alive) == (1, False)
    assert counting.trouble == "nothing is counted: unexpected error; the log has it"
    counting.stop()
    assert (counting.turns, counting.finished) == (turns, 1)


def test_one_that_was_never_started_can_be_stopped() -> None:
    counting = Counting()
    counting.stop()
    assert (counting.turns, counting.alive) == (0, False)
