"""Results that are computed once, in their turn, for whoever still waits, with places for every caller."""

import threading
from collections.abc import Callable, Hashable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor

import pytest

from service.api.cache import computation_queue
from service.api.cache.computation_queue import MAXIMUM_WAITING, MAXIMUM_WAITING_PER_CALLER, ComputationsBusy
from service.api.cache.computed_cache import ComputedCache
from service.http.error_status import status_of
from tests.plant import wait_until


class AskedCache:
    """A cache of which callers ask; its first computation, `first`, runs until `finish` is set."""

    def __init__(self) -> None:
        self.cache, self.made, self.finish = ComputedCache(), list[Hashable](), threading.Event()
        self.threads = ThreadPoolExecutor(100)
        self.first = self("first", caller="somebody")
        wait_until(lambda: self.made == ["first"])

    def __call__(
        self, key: Hashable, *, caller: str, wanted: Callable[[], bool] = lambda: True, long: bool = True
    ) -> "Future[Hashable]":
        def compute() -> Hashable:
            self.made.append(key)
            if key == "wrong":
                raise ValueError("it is wrong")
            assert key != "first" or self.finish.wait(60)
            return key

        return self.threads.submit(self.cache.compute_queued, key, compute, long=long, caller=caller, wanted=wanted)

    def refusal(self, key: Hashable, *, caller: str) -> ComputationsBusy:
        """Return how a caller is refused at once."""
        with pytest.raises(ComputationsBusy) as refused:
            self(key, caller=caller).result(10)
        assert (status_of(refused.value), refused.value.retry_after_s) == (503, 5)
        return refused.value


@pytest.fixture
def ask() -> Iterator[AskedCache]:
    asked = AskedCache()
    yield asked
    asked.finish.set()
    asked.threads.shutdown()
    asked.cache.close()


def test_an_answer_is_computed_once_and_only_so_many_are_kept() -> None:
    cache, made = ComputedCache(entries=2), []

    def ask(name: str) -> str:
        return cache.get_or_compute(name, lambda: made.append(name) or name)  # type: ignore[func-returns-value]

    assert [ask(name) for name in ("a", "a", "b", "c", "a")] == ["a", "a", "b", "c", "a"]
    assert made == ["a", "b", "c", "a"]


def test_equal_requests_share_one_computation_and_one_place(ask: AskedCache) -> None:
    equal = [ask(key, caller="somebody") for key in ("first", "second") for _ in range(30)]
    wait_until(lambda: ask.cache.waiting == 2)
    ask.finish.set()
    assert [one.result(10) for one in equal] == ["first"] * 30 + ["second"] * 30
    assert ask.made == ["first", "second"]
    assert ask("second", caller="another").result(10) == "second"
    assert ask.made == ["first", "second"]
    assert ask.cache.waiting == 0


def test_no_caller_takes_all_places(ask: AskedCache) -> None:
    own = [ask(number, caller="somebody") for number in range(MAXIMUM_WAITING_PER_CALLER - 1)]
    wait_until(lambda: ask.cache.waiting == MAXIMUM_WAITING_PER_CALLER)
    assert "16 computations that you asked for wait already" in ask.refusal("more", caller="somebody").detail
    others = [ask(-1 - number, caller=f"other {number % 2}") for number in range(MAXIMUM_WAITING - MAXIMUM_WAITING_PER_CALLER)]
    wait_until(lambda: ask.cache.waiting == MAXIMUM_WAITING)
    assert "48 computations wait already" in ask.refusal("more", caller="a fourth").detail
    assert ask("short", caller="somebody", long=False).result(10) == "short"
    ask.finish.set()
    assert [one.result(10) for one in (*own, *others)] == [*range(15), *(-1 - number for number in range(32))]


def asked_in_order(ask: AskedCache, names: list[str], *, caller: str) -> "list[Future[Hashable]]":
    """Ask one after the other, each after the one before waits."""
    found = []
    for name in names:
        before = ask.cache.waiting
        found.append(ask(name, caller=caller))
        wait_until(lambda before=before: ask.cache.waiting == before + 1)  # type: ignore[misc]
    return found


def test_callers_take_turns(ask: AskedCache) -> None:
    """A caller who asks for much at once lets one who asks for little wait for one computation only."""
    waiting = asked_in_order(ask, ["a1", "a2", "a3", "a4"], caller="somebody")
    waiting += asked_in_order(ask, ["b1", "b2"], caller="another")
    waiting += asked_in_order(ask, ["c1"], caller="a third")
    ask.finish.set()
    assert [one.result(10) for one in waiting] == ["a1", "a2", "a3", "a4", "b1", "b2", "c1"]
    assert ask.made == ["first", "b1", "c1", "a1", "b2", "a2", "a3", "a4"]


def test_where_two_run_at_a_time_nobody_has_both_places() -> None:
    """A long computation of one caller holds up only what that caller asks for besides."""
    cache, made, finish, threads = ComputedCache(long_at_once=2), list[str](), threading.Event(), ThreadPoolExecutor(8)

    def ask(name: str, caller: str) -> "Future[str]":
        def compute() -> str:
            made.append(name)
            assert not name.startswith("long") or finish.wait(60)
            return name

        return threads.submit(cache.compute_queued, name, compute, long=True, caller=caller, wanted=lambda: True)

    own = [ask("long", "somebody")]
    wait_until(lambda: made == ["long"])
    own += [ask("own", "somebody")]
    wait_until(lambda: cache.waiting == 2)
    assert [ask(f"other {number}", "another").result(10) for number in range(3)] == ["other 0", "other 1", "other 2"]
    assert made == ["long", "other 0", "other 1", "other 2"]
    finish.set()
    assert [one.result(10) for one in own] == ["long", "own"]
    # Both places are free again.
    again = [ask("own again", "somebody"), ask("other again", "another")]
    assert [one.result(10) for one in again] == ["own again", "other again"]
    threads.shutdown()
    cache.close()


def test_who_comes_back_is_behind_those_who_waited(ask: AskedCache) -> None:
    """One who asks again as soon as an answer is there does not stand in front of one who asked for many at once."""
    many = asked_in_order(ask, ["b1", "b2", "b3"], caller="another")
    again = asked_in_order(ask, ["a1"], caller="somebody")
    finished = threading.Event()

    def held() -> str:
        assert finished.wait(60)
        return "held"

    third = ask.threads.submit(ask.cache.compute_queued, "third", held, long=True, caller="a third", wanted=lambda: True)
    wait_until(lambda: ask.cache.waiting == 6)
    ask.finish.set()
    wait_until(lambda: ask.made == ["first", "b1"])  # then the third one, who is new
    again += asked_in_order(ask, ["a2"], caller="somebody")
    finished.set()
    assert [one.result(10) for one in (*many, *again)] == ["b1", "b2", "b3", "a1", "a2"]
    assert third.result(10) == "held"
    assert ask.made == ["first", "b1", "a1", "b2", "a2", "b3"]


def test_what_two_ask_for_comes_in_the_turn_of_either(ask: AskedCache) -> None:
    waiting = asked_in_order(ask, ["a1", "a2", "shared"], caller="somebody")
    asked = threading.Event()
    waiting.append(ask("shared", caller="another", wanted=lambda: asked.set() is None))  # type: ignore[func-returns-value]
    wait_until(asked.is_set)
    ask.finish.set()
    assert [one.result(10) for one in waiting] == ["a1", "a2", "shared", "shared"]
    assert ask.made == ["first", "shared", "a1", "a2"]


def test_only_so_many_requests_wait(ask: AskedCache, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(computation_queue, "MAXIMUM_REQUESTS", 1)
    assert "requests wait already" in ask.refusal("first", caller="another").detail


def test_no_caller_makes_all_requests_for_the_same(ask: AskedCache, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(computation_queue, "MAXIMUM_REQUESTS_PER_CALLER", 3)
    waits = [threading.Event(), threading.Event()]
    own = [ask("first", caller="somebody", wanted=lambda one=one: one.set() is None) for one in waits]  # type: ignore[misc]
    wait_until(lambda: all(one.is_set() for one in waits))
    assert "3 requests of yours wait already" in ask.refusal("first", caller="somebody").detail
    other = ask("second", caller="another")
    ask.finish.set()
    assert [one.result(10) for one in (*own, other)] == ["first", "first", "second"]
    assert ask("third", caller="somebody").result(10) == "third"


def test_what_nobody_waits_for_is_not_computed(ask: AskedCache) -> None:
    gone = threading.Event()
    left = ask("left", caller="somebody", wanted=lambda: not gone.is_set())
    shared = ask("shared", caller="somebody", wanted=lambda: not gone.is_set())
    wait_until(lambda: ask.cache.waiting == 3)
    kept = ask("shared", caller="another")
    gone.set()
    for one in (left, shared):
        with pytest.raises(ComputationsBusy, match="nobody waits"):
            one.result(10)
    wait_until(lambda: ask.cache.waiting == 2)
    ask.finish.set()
    assert kept.result(10) == "shared"
    assert ask.made == ["first", "shared"]


def test_an_error_is_reported_to_all_who_wait_and_not_kept(ask: AskedCache) -> None:
    wrong = [ask("wrong", caller="somebody") for _ in range(3)]
    wait_until(lambda: ask.cache.waiting == 2)
    ask.finish.set()
    for one in wrong:
        with pytest.raises(ValueError, match="it is wrong"):
            one.result(10)
    with pytest.raises(ValueError, match="it is wrong"):
        ask("wrong", caller="somebody").result(10)


def test_what_waits_is_given_up_when_the_service_stops(ask: AskedCache) -> None:
    waiting = ask("second", caller="somebody")
    wait_until(lambda: ask.cache.waiting == 2)
    ask.cache.close()
    with pytest.raises(ComputationsBusy, match="the service stops"):
        waiting.result(10)
    assert "the service stops" in ask.refusal("third", caller="somebody").detail
    ask.finish.set()
    assert ask.first.result(10) == "first"
    assert ask.made == ["first"]
