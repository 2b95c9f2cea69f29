"""The distribution: what the base install needs, one version, and a command that says so where the service is missing."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

import rotorundown
from rotorundown.environment.example_machines import examples_folder, found_example
from rotorundown.environment.release import VERSION
from tests.paths import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
EXTRAS = PROJECT["optional-dependencies"]


def names(requirements: list[str]) -> set[str]:
    """Names of distributions, without versions."""
    return {re.split(r"[\[<>=;! ]", one)[0] for one in requirements}


def test_the_base_install_is_the_library() -> None:
    assert PROJECT["name"] == "rotorundown"
    assert names(PROJECT["dependencies"]) == {"numpy", "scipy", "pydantic", "pyyaml", "msgspec"}


def test_developers_have_every_extra() -> None:
    (own,) = [one for one in EXTRAS["dev"] if one.startswith("rotorundown[")]
    assert set(own.partition("[")[2].rstrip("]").split(",")) == set(EXTRAS) - {"dev"}


def test_the_version_is_everywhere_the_same() -> None:
    assert "version" not in PROJECT
    assert rotorundown.__version__ == VERSION
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert cited["version"] == VERSION
    released = re.findall(r"(?m)^## (\d.*)$", (ROOT / "CHANGELOG.md").read_text())[0]
    assert released == f"{VERSION} ({cited['date-released']})"


def test_the_examples_are_found() -> None:
    assert (examples_folder() / "motor-pump.yaml").is_file()


def test_the_examples_are_read_from_anywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert rotorundown.read_machine("examples/motor-pump.yaml").id == "motor-pump"
    with pytest.raises(ValueError, match="No such file"):
        rotorundown.read_machine("examples/pump.yaml")
    assert found_example(Path("examples/recordings/rk4_unbalance_1x.csv")).with_suffix(".yaml").is_file()


@pytest.mark.parametrize(
    ("missing", "arguments"), [("typer", ["--help"]), ("pydantic_settings", ["--help"]), ("sqlalchemy", ["serve"])]
)
def test_without_the_service_s_packages_the_command_says_so_in_one_line(missing: str, arguments: list[str]) -> None:
    code = f"import sys; sys.modules[{missing!r}] = None; from service.__main__ import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments], cwd=ROOT, capture_output=True, text=True, check=False, timeout=60
    )
    assert done.returncode == 1
    assert done.stderr.startswith(f"rundown: {missing} is not installed.")
    assert done.stderr.endswith("pip install 'rotorundown[service]'\n")
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize("hidden", ["estimator", "formats", "storage"])
def test_a_file_that_hides_a_package_is_named_by_the_command_in_one_line(hidden: str, tmp_path: Path) -> None:
    (tmp_path / f"{hidden}.py").write_text("")
    around = os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), str(ROOT)])}
    code = "from service.__main__ import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code, "--version"], cwd=ROOT.parent, env=around, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    hiding = tmp_path / f"{hidden}.py"
    right = "rename that, or start Python elsewhere"
    assert done.stderr == f"rundown: {hiding} hides rotorundown's own package '{hidden}': {right}\n"


def test_output_in_a_narrow_encoding_loses_letters_and_not_the_command() -> None:
    around = os.environ | {"PYTHONIOENCODING": "cp1252", "PYTHONPATH": str(ROOT)}
    arguments = ["identify", "examples/motor-pump.yaml", "examples/recordings/motor-pump.csv"]
    done = subprocess.run(
        [sys.executable, "-m", "service", *arguments], cwd=ROOT, env=around, capture_output=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "accepted: ?\xb2/dof" in done.stdout.decode("cp1252")
