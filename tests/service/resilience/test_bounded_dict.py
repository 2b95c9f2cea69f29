"""A bounded dictionary is one, until it is full: then the oldest goes."""

import pytest

from service.resilience.bounded_dict import BoundedDict


def test_the_oldest_is_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.resilience.bounded_dict.CAPACITY", 3)
    known: BoundedDict[str, int] = BoundedDict()
    for number, name in enumerate("abc"):
        known[name] = number
    known["a"] = 10  # no new one
    assert known == {"a": 10, "b": 1, "c": 2}
    assert known.setdefault("b", 7) == 1
    assert known.setdefault("d", 3) == 3
    assert known == {"b": 1, "c": 2, "d": 3}
