"""Files that the packages read from beside their modules: found wherever the module that reads them lies."""

import pytest

from service.api.operation import dashboard
from service.commands import demo
from storage.database import schema


def test_the_migrations_are_found() -> None:
    assert schema.known_revisions()[-1] == "0001"
    assert len(schema.known_revisions()) >= 26
    assert (schema.MIGRATIONS / "env.py").is_file()


def test_the_built_page_is_found() -> None:
    assert dashboard.FIRST in dashboard.files()


@pytest.mark.parametrize("name", demo.SCENARIOS)
def test_the_machines_of_the_demonstration_are_found(name: str) -> None:
    assert (demo.EXAMPLES / f"{name}.yaml").is_file()
