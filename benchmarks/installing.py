"""From a wheel to the demo's summary, and what importing the library takes: asked beside measured.

The wheel is built and all packages are downloaded first; then `pip install` from these files and the demo are timed, in a
fresh environment. Imports are the best of several fresh interpreters in turns, less one that imports nothing, by processor
time: it hardly depends on what else the machine does. They are measured in the base installation of the wheel, as users have
it; with `--imports-only` in the environment and the checkout that run this.

    python -m benchmarks.installing [--imports-only] [--tries 5]
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import rotorundown
from tests.end_to_end.installed_wheel import build_wheel, make_environment, run
from tests.paths import ROOT

INSTALL_ASKED_S = 90.0
IMPORT_ASKED_S = 0.1
READY_ASKED = 1.3
"""Bound of the library's import until it can identify, as a multiple of importing numpy, scipy.linalg and pydantic [-]."""
BASE = {"numpy", "scipy", "pydantic", "PyYAML", "msgspec"}
NEEDED_BY_THESE = {"pydantic_core", "annotated-types", "typing-extensions", "typing-inspection"}
UNDERLYING = "import numpy, scipy.linalg, pydantic"
WITH_A_MODEL = f"{UNDERLYING}\nclass Empty(pydantic.BaseModel): pass"
READY = "import rotorundown as rd; rd.read_machine, rd.read_run, rd.identify, rd.Result"
EXAMPLE = "examples/motor-pump.yaml"
ONE_FIT = "rd.identify(machine, run)"
ENDED = "\nimport os; os._exit(0)"
"""Ends an interpreter as it is: what it tidies up at its end is no part of getting ready."""


def processor_seconds(python: Path, codes: Sequence[str], *, folder: Path, tries: int) -> list[float]:
    """Return the least processor time of fresh interpreters that run each code, in turns [s]; modules are compiled before."""
    clean = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME")}
    compiling = clean | {"PYTHONDONTWRITEBYTECODE": "", "OPENBLAS_NUM_THREADS": "1"}
    found = [[_processor_seconds_of(python, code + ENDED, folder, compiling) for code in codes] for _ in range(1 + tries)]
    return [min(column) for column in zip(*found[1:], strict=True)]


def first_fit(run_down: Path) -> str:
    """Return what identifies the example from a file."""
    read = f"machine = rd.read_machine({EXAMPLE!r}); run = rd.read_run({str(run_down)!r}, machine=machine)"
    return f"{READY}\n{read}\n{ONE_FIT}"


def _processor_seconds_of(python: Path, code: str, folder: Path, environment: Mapping[str, str]) -> float:
    process = subprocess.Popen([python, "-c", code], cwd=folder, env=environment)
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, code)
    return used.ru_utime + used.ru_stime


def imports(python: Path, *, folder: Path, tries: int) -> bool:
    """Print what imports take an interpreter in a folder; return whether the bounds hold."""
    with tempfile.TemporaryDirectory(prefix="rundown-example-") as beside:
        run_down = Path(beside) / "run-down.csv"
        rotorundown.simulate(rotorundown.read_machine(EXAMPLE)).to_frame().to_csv(run_down, index=False)
        fit = first_fit(run_down)
        codes = ["pass", "import rotorundown", UNDERLYING, WITH_A_MODEL, READY, fit, f"{fit}\n{ONE_FIT}"]
        nothing, *found = processor_seconds(python, codes, folder=folder, tries=tries)
    lazy, underlying, with_a_model, ready, first, second = (one - nothing for one in found)
    print(f"import of the library: asked {IMPORT_ASKED_S} s, measured {lazy:.3f} s of processor time")
    print(
        f"until it can identify: asked {READY_ASKED} times {underlying:.3f} s (numpy, scipy.linalg, pydantic), "
        f"measured {ready / underlying:.2f} times, {ready:.3f} s; pydantic's first model alone takes "
        f"{(with_a_model - underlying) / underlying:.2f} times"
    )
    loading = first - (second - first)
    print(
        f"scipy.linalg is loaded by what first needs it: until the example of a run-down is identified {first:.3f} s, "
        f"of which the fit's own computing takes {second - first:.3f} s and all else {loading / underlying:.2f} times"
    )
    return lazy <= IMPORT_ASKED_S and ready <= READY_ASKED * underlying


def install(folder: Path, *, tries: int) -> bool:
    """Print what an installation takes, and the imports of a base installation; return whether the bounds hold."""
    wheel = build_wheel(folder)
    files = folder / "files"
    base = make_environment(folder / "base")
    pip = ["-m", "pip", "--disable-pip-version-check"]
    run([base, *pip, "download", "--quiet", "--dest", files, f"{wheel}[service]"])
    offline: list[str | Path] = [*pip, "install", "--quiet", "--no-index", "--find-links", files]
    before = _distributions(base)
    run([base, *offline, wheel])
    installed = _distributions(base) - before - {"rotorundown"}
    unasked = installed - {_normal(one) for one in BASE | NEEDED_BY_THESE}
    print(f"base install: asked {', '.join(sorted(BASE))} and what these need; beside these: {', '.join(unasked) or 'none'}")
    imported = imports(base, folder=folder, tries=tries)
    began = time.perf_counter()
    python = make_environment(folder / "service")
    run([python, *offline, f"{wheel}[service]"])
    installed_s = time.perf_counter() - began
    run([python.with_name("rundown"), "demo", "--exit"], folder=folder)
    whole = time.perf_counter() - began
    print(
        f"pip install 'rotorundown[service]' to the demo's summary: asked {INSTALL_ASKED_S:.0f} s, measured {whole:.0f} s "
        f"({installed_s:.0f} s of them the installation)"
    )
    return imported and whole <= INSTALL_ASKED_S and not unasked


def _distributions(python: Path) -> set[str]:
    code = "from importlib.metadata import distributions as all; print(*(one.metadata['Name'] for one in all()))"
    return {_normal(one) for one in run([python, "-c", code]).split()}


def _normal(name: str) -> str:
    return name.lower().replace("_", "-")


def main() -> int:
    """Measure, and print; status 1 where a bound does not hold."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--imports-only", action="store_true", help="leave out the installation")
    parser.add_argument("--tries", type=int, default=5, help="fresh interpreters per import")
    options = parser.parse_args()
    if options.imports_only:
        return 0 if imports(Path(sys.executable), folder=ROOT, tries=options.tries) else 1
    with tempfile.TemporaryDirectory(prefix="rundown-install-") as folder:
        return 0 if install(Path(folder), tries=options.tries) else 1


if __name__ == "__main__":
    sys.exit(main())
