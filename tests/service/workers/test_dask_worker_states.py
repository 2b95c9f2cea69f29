"""States of Dask workers, from what a scheduler reports of them: silence, other releases, refusals."""

from typing import Any

import pytest

from service.workers import dask_worker_states
from service.workers.dask_task import RELEASE, worker_name
from service.workers.dask_worker_states import DaskWorkerStates

ONE, OTHER = "tcp://10.0.0.1:4000", "tcp://10.0.0.2:4000"


@pytest.fixture
def now(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The monotonic time, which a test moves."""
    time = [1000.0]
    monkeypatch.setattr("service.workers.dask_worker_states.time.monotonic", lambda: time[0])
    return time


def reported(**names: Any) -> dict[str, Any]:
    return {
        ONE: {"name": names.get("one", worker_name()), "last_seen": names.get("seen", 7.0)},
        OTHER: {"name": worker_name(), "last_seen": names.get("other_seen", 7.0)},
    }


def test_a_worker_is_silent_when_the_scheduler_hears_nothing_new_of_it(now: list[float]) -> None:
    states = DaskWorkerStates()
    states.observe(reported())
    assert states.unusable(reported()) == {}
    now[0] += dask_worker_states.SILENT_S + 1.0
    states.observe(reported(other_seen=30.0))
    assert states.unusable(reported()) == {ONE: f"the Dask worker at {ONE} has said nothing for 30 s or longer"}
    states.observe(reported(seen=31.0))
    assert states.silent() == {}


def test_a_worker_of_another_release_is_named_with_both() -> None:
    states = DaskWorkerStates()
    old = states.unusable(reported(one="rundown 0.1.0, tasks of form 3 #1"))
    assert old == {
        ONE: f"the Dask worker at {ONE} runs release 0.1.0, tasks of form 3, this service {RELEASE}: upgrade the older one"
    }
    assert "start it as `rundown worker`" in states.unusable(reported(one="somebody"))[ONE]


def test_a_worker_that_refused_a_task_gets_none_for_a_while(now: list[float]) -> None:
    states = DaskWorkerStates()
    words = f"the Dask worker at {ONE} refuses its tasks"
    assert str(states.refuse(ONE, RELEASE)) == words
    assert states.unusable(reported()) == {ONE: words}
    now[0] += dask_worker_states.REFUSED_S + 1.0
    assert states.unusable(reported()) == {}
