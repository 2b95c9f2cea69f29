"""Settings from a TOML file: below the environment and the command line, and named where they are wrong."""

import re
from pathlib import Path

import pytest

from service.configuration.settings import DEFAULT_ZENOH_ENDPOINT, SettingsWrong, settings_of
from tests.paths import ROOT
from tests.service.commands.command_line import run


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    path = tmp_path / "rundown.toml"
    monkeypatch.setenv("RUNDOWN_CONFIG", str(path))
    return path


def test_options_go_before_the_environment_before_the_file_before_the_default(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file.write_text('port = 1\nworkers = 3\nhost = "10.0.0.1"\nzenoh_listen = ["tcp/127.0.0.1:1"]\n')
    monkeypatch.setenv("rundown_workers", "4")
    monkeypatch.setenv("RUNDOWN_HOST", "10.0.0.2")
    found = settings_of(host="10.0.0.3")
    assert (found.host, found.workers, found.port, found.silence_s) == ("10.0.0.3", 4, 1, 120.0)
    assert found.zenoh_listen == ["tcp/127.0.0.1:1"]


def test_what_follows_from_settings_follows_from_those_of_the_file_too(file: Path) -> None:
    file.write_text('role = "api"\ndatabase = "postgresql+psycopg://db/rundown"\n')
    assert settings_of().zenoh_connect == [DEFAULT_ZENOH_ENDPOINT]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("prot = 1\n", "'prot' is no setting; did you mean 'port'"),
        ("nothing = 1\n", "'nothing' is no setting$"),
        ("[serve]\nport = 1\n", "'serve' is no setting: settings are written at the top of the file, in no table$"),
        ("RUNDOWN_PORT = 1\n", "'RUNDOWN_PORT' is no setting; did you mean 'port'"),
        ("raw-days = 1\n", "'raw-days' is no setting; did you mean 'raw_days'"),
        ('workers = "70000x"\n', r"rundown.toml: setting workers: needs a whole number$"),
        ('zenoh_listen = "70000"\n', r"setting zenoh_listen: needs a list, in brackets, such as "),
        ("backups = 70000\n", "setting backups: needs a text, in quotes"),
        ("port = \n", "is no TOML"),
        ("port = 70000\n", "setting port: Input should be less than or equal to 65535"),
        (None, "No such file"),
    ],
)
def test_what_is_wrong_is_named_without_values(file: Path, content: str | None, words: str) -> None:
    if content is not None:
        file.write_text(content)
    with pytest.raises(SettingsWrong, match=words) as wrong:
        settings_of()
    assert "70000" not in str(wrong.value)


def test_serve_takes_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RUNDOWN_CONFIG", "")
    (tmp_path / "rundown.toml").write_text("raw_day = 1\n")
    assert "'raw_day' is no setting; did you mean" in run("serve", "--config", str(tmp_path / "rundown.toml"), status=1)


def test_the_example_in_the_page_for_operators_is_taken(file: Path) -> None:
    (block,) = re.findall(r"^```toml\n(.*?)^```", (ROOT / "docs" / "operators.md").read_text(), re.MULTILINE | re.DOTALL)
    file.write_text(block)
    assert settings_of().raw_days == 90.0
