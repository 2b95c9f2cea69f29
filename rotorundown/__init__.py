"""The public Python API of Rundown, without any service; docs/python.md begins with five lines of it. It imports `plots`,
`environment`, `estimator`, `storage`, and of the formats `files`, `recordings` and `wire`; the service's commands use it.
Nothing is imported before a name is used.
"""

import gc
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

from rotorundown.environment.own_packages import require_own_packages

if TYPE_CHECKING:
    __version__: str
    from estimator.errors import Invalid
    from estimator.machine.document import Machine
    from rotorundown.calibration import CalibratedMachine, calibrate
    from rotorundown.checks import Checked, check
    from rotorundown.comparison import CouplingComparison, compare
    from rotorundown.diagnosis import CausesFound, diagnose
    from rotorundown.identification import identify
    from rotorundown.machine_files import read_machine
    from rotorundown.machine_model import Model
    from rotorundown.plots.trend import plot_trend
    from rotorundown.result import Result
    from rotorundown.ross.models import read_ross_model
    from rotorundown.runs import MachineRun, read_run
    from rotorundown.service_client import Service
    from rotorundown.service_requests import ServiceError
    from rotorundown.service_rows import Rows
    from rotorundown.simulation import simulate
    from rotorundown.updated_models import model

__all__ = [
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

_PLACES = {
    "CalibratedMachine": "rotorundown.calibration",
    "CausesFound": "rotorundown.diagnosis",
    "Checked": "rotorundown.checks",
    "CouplingComparison": "rotorundown.comparison",
    "Invalid": "estimator.errors",
    "Machine": "estimator.machine.document",
    "MachineRun": "rotorundown.runs",
    "Model": "rotorundown.machine_model",
    "Result": "rotorundown.result",
    "Rows": "rotorundown.service_rows",
    "Service": "rotorundown.service_client",
    "ServiceError": "rotorundown.service_requests",
    "calibrate": "rotorundown.calibration",
    "check": "rotorundown.checks",
    "compare": "rotorundown.comparison",
    "diagnose": "rotorundown.diagnosis",
    "identify": "rotorundown.identification",
    "model": "rotorundown.updated_models",
    "plot_trend": "rotorundown.plots.trend",
    "read_machine": "rotorundown.machine_files",
    "read_ross_model": "rotorundown.ross.models",
    "read_run": "rotorundown.runs",
    "simulate": "rotorundown.simulation",
}
"""Module of each public name: importing numpy and scipy takes a second that `import` alone must not spend."""

require_own_packages()


def __getattr__(name: str) -> Any:
    """Return a public name, importing its module on first use. Raises AttributeError with close matches."""
    if name == "__version__":
        from rotorundown.environment.release import VERSION

        return VERSION
    if name not in _PLACES:
        from estimator.close_matches import did_you_mean

        raise AttributeError(f"rotorundown has no '{name}'{did_you_mean(name, __all__)}")
    # A module of the package may have the same name as a function; the function is what the user asks for.
    found = getattr(_imported(_PLACES[name]), name)
    globals()[name] = found
    return found


def _imported(module: str) -> ModuleType:
    """Load a module without garbage collection, which would take a sixth of the time and find nothing."""
    if not gc.isenabled():
        return import_module(module)
    gc.disable()
    try:
        return import_module(module)
    finally:
        # What was loaded counts as old now: the next object made would have all of it looked through. No garbage is kept
        # by this; but what a program has frozen by itself stays frozen.
        if not gc.get_freeze_count():
            gc.freeze()
            gc.unfreeze()
        gc.enable()


def __dir__() -> list[str]:
    """List the public names."""
    return sorted(__all__)
