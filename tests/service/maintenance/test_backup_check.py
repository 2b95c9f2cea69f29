"""A folder of backups is looked at: how old the newest is, and that there is none."""

import math
from pathlib import Path

import pytest

from service.maintenance import backup_check
from service.maintenance.backup_check import BackupCheck
from storage.backup.backup import back_up
from storage.database.engine import Database
from tests.plant import wait_until


def test_the_age_of_the_newest_backup_is_reported(plant: Database, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(backup_check, "LOOK_S", 0.02)
    watch = BackupCheck(str(tmp_path / "backups"))
    watch.start()
    assert watch.gauges == {"rundown_backup_age_seconds": math.inf}
    (tmp_path / "backups").mkdir()
    back_up(plant.url, tmp_path / "backups" / "nightly")
    wait_until(lambda: watch.gauges["rundown_backup_age_seconds"] < 60.0)
    watch.stop()


def test_where_no_folder_is_named_nothing_is_reported() -> None:
    watch = BackupCheck("")
    watch.start()
    assert watch.gauges == {}
