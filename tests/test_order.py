"""The order of the tests: what takes long begins first, however deep in its folder it lies."""

import pytest

from tests.conftest import TESTS, takes_long


@pytest.mark.parametrize(
    ("path", "long"),
    [
        ("end_to_end/test_main_job.py", True),
        ("faults/database/test_database_that_hangs.py", True),
        ("service/security/test_proxies.py", False),
        ("test_order.py", False),
    ],
)
def test_sub_folders_keep_the_place_of_their_folder(path: str, *, long: bool) -> None:
    assert takes_long(TESTS / path) == long
