"""Sealed secrets: each opens in its own place with its own key, and a key is complete before anything is sealed with it."""

import stat
from pathlib import Path

import pytest

from service.secrets.files import read_keys
from service.secrets.sealing import SealBroken, Sealing, make_key

FIRST, SECOND = bytes(32), bytes(range(32))


def test_what_is_sealed_opens_in_its_own_place_with_its_own_key_only() -> None:
    sealing, later = Sealing([FIRST]), Sealing([SECOND, FIRST])
    sealed = sealing.seal(b"whsec_x", place="subscription 1")
    assert sealed != sealing.seal(b"whsec_x", place="subscription 1")
    assert later.open(sealed, place="subscription 1") == b"whsec_x"
    assert sealing.is_current(sealed, place="subscription 1")
    assert not later.is_current(sealed, place="subscription 1")
    for other, place, text in (
        (Sealing([SECOND]), "subscription 1", sealed),
        (sealing, "subscription 2", sealed),
        (sealing, "subscription 1", sealed[:-8] + "AAAAAAA="),
        (sealing, "subscription 1", "sealed:"),
        (sealing, "subscription 1", "sealed:%"),
    ):
        with pytest.raises(SealBroken, match="another one, or changed"):
            other.open(text, place=place)


def test_a_new_key_is_private_and_another_one_each_time(tmp_path: Path) -> None:
    for name in ("a", "b"):
        make_key(tmp_path / name)
        assert stat.S_IMODE((tmp_path / name).stat().st_mode) == 0o600
    (first,), (second,) = read_keys(str(tmp_path / "a")), read_keys(str(tmp_path / "b"))
    assert first != second


def test_a_key_that_was_half_written_by_a_process_that_was_killed_does_not_stay(tmp_path: Path) -> None:
    file = tmp_path / "x.key"
    file.with_name("x.key.part").write_text("half")
    make_key(file)
    Sealing.of(file)
    assert [one.name for one in tmp_path.iterdir()] == ["x.key"]
    with pytest.raises(FileExistsError):
        make_key(file)
