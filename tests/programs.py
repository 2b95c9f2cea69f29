"""Programs that tests start and that the project does not bring."""

import os
import shutil

import pytest


def program(name: str) -> str:
    """Return the path of a program; the test is skipped without it, unless all are required."""
    found = shutil.which(name, path=f"{os.environ.get('PATH', '')}:/usr/sbin:/usr/local/sbin")
    if found is None:
        if os.environ.get("RUNDOWN_REQUIRE_ALL"):
            pytest.fail(f"{name} is not installed")
        pytest.skip(f"{name} is not installed")
    return found
