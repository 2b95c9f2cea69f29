"""The notebooks of examples/notebooks, each run as a script from the project's folder, in a short form."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.pyplot as plt
import pytest

import rotorundown as rd
from benchmarks.serving import served
from service.alerts import transitions
from service.alerts.transitions import AlertFinding
from storage.database.engine import Database
from storage.machines import machines
from tests.paths import EXAMPLES, ROOT
from tests.plant import SECOND, START, store_identification

NOTEBOOKS = sorted((EXAMPLES / "notebooks").glob("*.py"))
SHOWN = {
    "alignment_over_a_year": ("coupling.C1.kxx: ", "alert: coupling.C1: Misalignment of coupling C1"),
    "first_rotor": ("motor-pump: accepted", "speed_rpm,B1L_um_pp"),
    "fluid_film_train": ("motor-compressor: accepted", "clearance"),
    "how_wrong_can_it_be": ("intervals hold the truth", "standard errors"),
    "measured_rotor_kit": ("accepted", "µm pp"),
    "which_measurement_helps": ("one more sample at", "a probe on shaft"),
}
"""Words that each prints, among others."""
WEEK = 7 * 86_400


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("RUNDOWN_SHORT", "1")
    monkeypatch.chdir(ROOT)
    matplotlib.use("Agg")
    yield
    plt.close("all")


@pytest.fixture
def year(database: Database, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A service whose pump went out of alignment over some run-downs."""
    pump = rd.read_machine(EXAMPLES / "motor-pump.yaml")
    with database.transaction() as session:
        machines.create(session, pump)
        for number, progress in enumerate((0.0, 0.5, 1.0)):
            run = rd.simulate(pump, scenario="misalignment", progress=progress, run_seed=number + 1, samples=100)
            found = rd.identify(pump, run).identification
            row = store_identification(
                session, found, run_id=number, measured_at=START + number * WEEK * SECOND, machine_id=pump.id
            )
        finding = AlertFinding({}, row.id, START)
        transitions.raise_alert(session, pump.id, rule="misalignment", element="coupling.C1", finding=finding)
    with served(database) as url:
        monkeypatch.setenv("RUNDOWN_URL", url.removesuffix("/api/v1"))
        yield


def test_there_are_as_many_as_we_say() -> None:
    assert [one.stem for one in NOTEBOOKS] == sorted(SHOWN)


@pytest.mark.usefixtures("short")
@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda one: one.stem)
def test_it_runs(notebook: Path, request: pytest.FixtureRequest, capsys: pytest.CaptureFixture[str]) -> None:
    if notebook.stem == "alignment_over_a_year":
        request.getfixturevalue("year")
    names: dict[str, Any] = {}
    exec(compile(notebook.read_text(), str(notebook), "exec"), names)
    printed = capsys.readouterr().out
    for words in SHOWN[notebook.stem]:
        assert words in printed


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda one: one.stem)
def test_it_begins_with_a_title_and_has_text_between_its_cells(notebook: Path) -> None:
    cells = re.split(r"^# %%", notebook.read_text(), flags=re.MULTILINE)[1:]
    assert cells[0].startswith(" [markdown]\n# # ")
    assert sum(cell.startswith(" [markdown]") for cell in cells) >= 3
