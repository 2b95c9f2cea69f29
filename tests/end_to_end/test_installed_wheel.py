"""The wheel in a fresh environment without the checkout: the library identifies, the command demonstrates.

Third-party packages are lent by the environment that runs the tests; `python -m benchmarks.installing` downloads them.
"""

import subprocess
import tarfile
import zipfile
from pathlib import Path

import pytest

from rotorundown.environment.release import VERSION
from tests.end_to_end.installed_wheel import build_wheel, make_environment, run
from tests.paths import ROOT

pytestmark = pytest.mark.long

FIVE_LINES = """
import rotorundown as rd
from rotorundown.environment.example_machines import examples_folder
pump = rd.read_machine(examples_folder() / "motor-pump.yaml")
result = rd.identify(pump, rd.simulate(pump))
print(rd.__file__, examples_folder(), result.accepted, sep="\\n")
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_wheel(tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def python(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = make_environment(tmp_path_factory.mktemp("fresh") / "environment", lent=True)
    run([found, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", wheel])
    return found


def test_the_wheel_holds_packages_and_examples_and_nothing_else(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as opened:
        names = opened.namelist()
    tops = {name.partition("/")[0] for name in names}
    assert tops == {"estimator", "storage", "formats", "service", "rotorundown", f"rotorundown-{VERSION}.dist-info"}
    for example in (ROOT / "examples").glob("*.yaml"):
        assert f"rotorundown/examples/{example.name}" in names
    assert "rotorundown/examples/recordings/rk4_unbalance_1x.csv" in names
    for needed in (
        "service/dashboard/index.html",
        "service/commands/first_machine.yaml",
        "storage/migrations/script.py.mako",
        "rotorundown/py.typed",
    ):
        assert needed in names


def test_the_source_distribution_holds_what_the_wheel_needs(wheel: Path) -> None:
    (archive,) = wheel.parent.glob("*.tar.gz")
    with tarfile.open(archive) as opened:
        names = {name.partition("/")[2] for name in opened.getnames()}
    assert {"setup.py", "examples/motor-pump.yaml", "LICENSE", "CHANGELOG.md", "service/dashboard/index.html"} <= names


def test_the_library_identifies(python: Path, tmp_path: Path) -> None:
    package, examples, accepted = run([python, "-c", FIVE_LINES], folder=tmp_path).split()
    environment = python.parents[1]
    assert Path(package).is_relative_to(environment)
    assert Path(examples).is_relative_to(environment)
    assert accepted == "True"


def test_the_command_says_its_version(python: Path, tmp_path: Path) -> None:
    assert run([python.with_name("rundown"), "--version"], folder=tmp_path) == f"rundown {VERSION}\n"


def test_the_demo_runs(python: Path, tmp_path: Path) -> None:
    try:
        text = run([python.with_name("rundown"), "demo", "--exit"], folder=tmp_path)
    except subprocess.CalledProcessError as error:
        pytest.fail(f"the demo ended with status {error.returncode}:\n{error.stdout}")
    assert "misalignment of coupling.C1" in text
    assert "in a browser" not in text, "nothing serves any more"


def test_commands_take_its_examples_where_the_folder_has_none(python: Path, tmp_path: Path) -> None:
    command = python.with_name("rundown")
    assert "is written with 200 samples" in run([command, "sample", "examples/motor-pump.yaml", "run.csv"], folder=tmp_path)
    checked = run([command, "check", "examples/motor-pump.yaml", "run.csv"], folder=tmp_path)
    assert checked.startswith("motor-pump: 2 shafts, 4 discs")
    kit, recording = "examples/rk4-rotor-kit-four-probes.yaml", "examples/recordings/rk4_unbalance_1x.csv"
    assert "read as its sidecar says" in run([command, "check", kit, recording], folder=tmp_path)
    assert not (tmp_path / "examples").exists()
