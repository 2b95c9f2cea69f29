"""Fixtures of the tests of conventions."""

import pytest

from tests.api_in_process import Api


@pytest.fixture
def api(furnished: Api) -> Api:
    """Conventions hold for all resources: over something of each."""
    return furnished
