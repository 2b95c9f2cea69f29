"""The order of the tests: what takes long begins first, however deep in its folder it lies, and runs are told to keep it."""

import pytest

from tests.conftest import FIRST, TESTS, turn


@pytest.mark.parametrize(
    ("path", "place"),
    [
        ("browser/test_alert_page.py", 0),
        ("faults/test_killed_roles.py", 3),
        ("end_to_end/test_main_job.py", 7),
        ("faults/database/test_database_that_hangs.py", 8),
        ("browser/test_plots.py", 9),
        ("service/security/test_proxies.py", len(FIRST)),
        ("test_order.py", len(FIRST)),
    ],
)
def test_sub_folders_keep_the_place_of_their_folder(path: str, place: int) -> None:
    assert turn(TESTS / path) == place


def test_what_comes_first_is_there() -> None:
    assert [name for name in FIRST if not (TESTS / name).exists()] == []


def test_files_begin_in_this_order_in_every_run() -> None:
    """By itself pytest-xdist begins with the file of most tests, and ends with the longest ones alone."""
    lines = (TESTS.parent / "Makefile").read_text().splitlines()
    assert "--no-loadscope-reorder" in next(line for line in lines if line.startswith("IN_PARALLEL"))
    assert all("$(IN_PARALLEL)" in line for line in lines if "/pytest" in line)
