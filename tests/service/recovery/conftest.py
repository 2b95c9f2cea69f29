"""Fixtures of the tests of gap recovery."""

import pytest


@pytest.fixture(autouse=True)
def _short_waits(short_waits: None) -> None:
    """Wait as little in every test here."""
