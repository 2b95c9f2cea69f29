"""Fixtures of the tests of ingest."""

import time

import pytest


@pytest.fixture(autouse=True)
def _short_waits(short_waits: None) -> None:
    """Wait as little in every test here."""


@pytest.fixture
def off(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Return how far this machine's clock is off [ns]; what a test puts there holds at once."""
    by, right = [0], time.time_ns
    monkeypatch.setattr(time, "time_ns", lambda: right() + by[0])
    return by
