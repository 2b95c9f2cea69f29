"""An addition to the packages, and how its tests tell that it works."""

from collections.abc import Callable
from dataclasses import dataclass

from tests.additions.package_copy import PackageCopy

LANGUAGE_TESTS = ("tests/service/wording/test_language.py", "tests/service/test_dashboard_messages.py")
"""Files of tests that hold what the service and the page say in each language."""


@dataclass(frozen=True)
class Addition:
    """One more of a kind.

    most_files: how many files it may take. add: writes it into a copy. check: a script that fails where it does not work; it
    finds the text of the service's OpenAPI document as `OPENAPI`. tests: files of tests that must pass with it.
    """

    name: str
    most_files: int
    add: Callable[[PackageCopy], None]
    check: str
    tests: tuple[str, ...] = ()
