"""The public surface: its names, what importing it needs, and what it says where something is in its way."""

import inspect
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel

import rotorundown as rd
from tests.paths import ROOT

SURFACE = [
    "CalibratedMachine",
    "CausesFound",
    "Checked",
    "CouplingComparison",
    "Invalid",
    "Machine",
    "MachineRun",
    "Model",
    "Result",
    "Rows",
    "Service",
    "ServiceError",
    "calibrate",
    "check",
    "compare",
    "diagnose",
    "identify",
    "model",
    "plot_trend",
    "read_machine",
    "read_ross_model",
    "read_run",
    "simulate",
]
SERVICE_ONLY = ("sqlalchemy", "alembic", "fastapi", "zenoh", "typer", "uvicorn", "httpx", "aiohttp", "pydantic_settings")


def python(code: str, *, folder: Path = ROOT) -> subprocess.CompletedProcess[str]:
    """Run code in a fresh interpreter that finds the packages of this checkout."""
    return subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path.append({str(ROOT)!r})\n{code}"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


def test_the_surface_is_what_users_rely_on() -> None:
    assert sorted(rd.__all__) == SURFACE
    assert dir(rd) == SURFACE


@pytest.mark.parametrize("name", SURFACE)
def test_each_name_is_documented(name: str) -> None:
    found = getattr(rd, name)
    assert callable(found)
    assert len(inspect.getdoc(found) or "") > 20


def parts(name: str) -> list[tuple[str, Any]]:
    """A public name, and where it is a class of ours the methods and properties that users see, each as a function."""
    found = getattr(rd, name)
    if not isinstance(found, type):
        return [(name, found)]
    inherited = vars(BaseModel).keys() | vars(object).keys()
    own = [(key, one) for key, one in vars(found).items() if not key.startswith("_") and key not in inherited]
    functions = [(key, getattr(one, "fget", None) or getattr(one, "func", None) or one) for key, one in own]
    return [(f"{name}.{key}", one) for key, one in functions if inspect.isfunction(one)]


@pytest.mark.parametrize("name", SURFACE)
def test_each_function_and_method_is_documented_and_typed(name: str) -> None:
    for title, function in parts(name):
        assert inspect.getdoc(function), title
        signature = inspect.signature(function)
        assert signature.return_annotation is not inspect.Signature.empty, title
        named = [one for key, one in signature.parameters.items() if key != "self"]
        assert [one.name for one in named if one.annotation is inspect.Parameter.empty] == [], title


def test_a_wrong_name_gets_its_close_matches() -> None:
    with pytest.raises(AttributeError, match=r"no 'identfy'; did you mean 'identify'"):
        rd.identfy  # noqa: B018


def test_importing_needs_nothing_but_python() -> None:
    done = python("import rotorundown; print([one for one in ('numpy', 'scipy', 'pydantic') if one in sys.modules])")
    assert done.stdout == "[]\n", done.stderr


def test_what_reads_recordings_is_loaded_with_the_first_of_them() -> None:
    unneeded = ("yaml", "html", "formats.recordings.recorded_runs", "scipy.optimize", "scipy.interpolate", "scipy.stats")
    done = python(
        "import rotorundown as rd; rd.read_machine, rd.read_run, rd.identify, rd.Result\n"
        f"print([one for one in {unneeded!r} if one in sys.modules])"
    )
    assert done.stdout == "[]\n", done.stderr


def test_what_identifies_is_made_of_structs() -> None:
    """A frozen dataclass takes half a millisecond to define; hundreds of them were a third of what is waited for."""
    done = python(
        "import dataclasses, rotorundown as rd; rd.read_machine, rd.read_run, rd.identify, rd.Result\n"
        "own = [one for name, one in sys.modules.items() if name.startswith(('estimator', 'formats', 'rotorundown'))]\n"
        "kinds = [kind for one in own for kind in vars(one).values() if dataclasses.is_dataclass(kind)]\n"
        "print([kind.__name__ for kind in kinds if kind.__module__.startswith(('estimator', 'formats', 'rotorundown'))])"
    )
    assert done.stdout == "[]\n", done.stderr


@pytest.mark.parametrize(("before", "frozen"), [("", "False"), ("gc.freeze()", "True")])
def test_what_is_loaded_is_not_looked_through_for_garbage(before: str, frozen: str) -> None:
    """A tenth of what is waited for; what the program has frozen by itself stays so."""
    done = python(
        f"import gc, rotorundown as rd\n{before}\n"
        "collected = lambda: sum(one['collections'] for one in gc.get_stats())\n"
        "earlier = collected()\n"
        "rd.read_machine, rd.read_run, rd.identify, rd.Result\n"
        "print(collected() - earlier if not gc.get_freeze_count() else '-', gc.isenabled(), gc.get_freeze_count() > 0)"
    )
    assert done.stdout == f"{'-' if before else 0} True {frozen}\n", done.stderr


def test_identifying_needs_nothing_of_the_service() -> None:
    done = python(
        f"import rotorundown as rd\n"
        f"pump = rd.read_machine({str(ROOT / 'examples/motor-pump.yaml')!r})\n"
        f"run = rd.simulate(pump)\n"
        f"rd.read_run({{'speed': run.speed_rpm, 'B1L_amplitude': run.amplitude_um_pp[:, 0], "
        f"'B1L_phase': run.phase_lag_deg[:, 0]}}, machine=pump)\n"
        f"[getattr(rd, name) for name in dir(rd)]\n"
        f"print([one for one in {SERVICE_ONLY!r} if one in sys.modules])"
    )
    assert done.stdout == "[]\n", done.stderr


def test_a_file_that_hides_one_of_our_packages_is_named_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "storage.py").write_text("")
    done = python("import rotorundown", folder=tmp_path)
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1].startswith(f"ImportError: {tmp_path / 'storage.py'} hides rotorundown's own package")


def test_a_folder_that_hides_one_of_our_packages_is_named(tmp_path: Path) -> None:
    (tmp_path / "estimator").mkdir()
    (tmp_path / "estimator/__init__.py").write_text("")
    said = python("import rotorundown", folder=tmp_path).stderr.splitlines()[-1]
    assert said.startswith(f"ImportError: {tmp_path / 'estimator'} hides rotorundown's own package 'estimator'")
