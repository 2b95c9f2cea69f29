"""Secrets and keys in files: private ones of the right form are read, and no refusal tells what is in a file."""

import base64
from pathlib import Path

import pytest

from service.secrets.files import read_keys, read_secret, require_private

SECRET = "s3cret"
KEYS = [bytes(32), bytes(range(32))]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """A private file with a secret."""
    found = tmp_path / "secret"
    found.write_text(f"{SECRET}\n")
    found.chmod(0o640)
    return found


def test_a_secret_is_the_one_line_of_a_private_file(file: Path) -> None:
    assert read_secret(str(file)) == SECRET


@pytest.mark.parametrize("content", [b"", b"\n \n", b"s3cret\nmore\n", b"s3cret\xff"])
def test_what_is_no_single_line_of_text_is_refused_untold(file: Path, content: bytes) -> None:
    file.write_bytes(content)
    with pytest.raises(ValueError, match="secret") as refused:
        read_secret(str(file))
    assert SECRET not in str(refused.value)


@pytest.mark.parametrize("mode", [0o644, 0o602, 0o666])
def test_a_file_of_others_is_refused(file: Path, mode: int) -> None:
    file.chmod(mode)
    for read in (read_secret, read_keys, require_private):
        with pytest.raises(ValueError, match="chmod 640 or 600"):
            read(str(file))


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    for read in (read_secret, read_keys, require_private):
        with pytest.raises(ValueError, match=r"none cannot be read: No such file"):
            read(str(tmp_path / "none"))


def test_keys_may_be_of_either_alphabet_of_base64(file: Path) -> None:
    keys = [*KEYS, bytes([0xFB] * 32)]
    plain, of_urls = base64.b64encode(keys[2]).decode(), base64.urlsafe_b64encode(keys[2]).decode()
    assert plain != of_urls
    for last in (plain, of_urls):
        file.write_text("\n".join([*(base64.b64encode(one).decode() for one in KEYS), last]))
        assert read_keys(str(file)) == keys


@pytest.mark.parametrize("text", ["", "rubbish", base64.b64encode(bytes(31)).decode(), "ü"])
def test_what_are_no_keys_is_refused_untold(file: Path, text: str) -> None:
    file.write_text(text)
    with pytest.raises(ValueError, match="openssl rand -base64 32") as refused:
        read_keys(str(file))
    assert not text or text not in str(refused.value)
