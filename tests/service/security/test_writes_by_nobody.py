"""What somebody without a role makes the store write: nothing, or so much and no more."""

import pytest
from sqlalchemy import func, select

from storage.database import Database
from storage.tables import IdempotencyKeyRow
from tests.asking import PREFIX, Api
from tests.plant import KEY
from tests.service.security.conftest import Filled, bearer

NOTES = f"{PREFIX}/machines/{KEY.machine}/timeline"


def idempotency_keys(database: Database) -> int:
    with database.reading() as session:
        return session.scalar(select(func.count()).select_from(IdempotencyKeyRow)) or 0


@pytest.mark.parametrize("path", ["/logout", "/login", "/login/callback", "/nothing", NOTES])
@pytest.mark.parametrize("key", [None, "viewer"])
def test_no_idempotency_key_is_kept_for_who_may_change_nothing(api: Api, filled: Filled, path: str, key: str | None) -> None:
    for number in range(3):
        headers = bearer(filled.keys[key]) if key else {}
        api.ask("POST", path, headers=headers | {"Idempotency-Key": f"new-{number}"})
    assert idempotency_keys(api.database) == 0
