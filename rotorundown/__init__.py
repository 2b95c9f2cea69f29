"""The public Python API of Rundown, without any service; docs/python.md begins with five lines of it. It imports `plots`,
`environment` and `estimator`, and of the service only what reads files; its commands use it in turn. Nothing is imported
before a name is used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from rotorundown.environment.own_packages import require_own_packages

if TYPE_CHECKING:
    from estimator.machine.document import Machine
    from rotorundown.comparison import CouplingComparison, compare
    from rotorundown.diagnosis import CausesFound, diagnose
    from rotorundown.identification import identify
    from rotorundown.machine_files import read_machine
    from rotorundown.machine_model import Model
    from rotorundown.plots.trend import plot_trend
    from rotorundown.result import Result
    from rotorundown.runs import MachineRun, read_run
    from rotorundown.simulation import simulate
    from rotorundown.updated_models import model

__all__ = [
    "CausesFound",
    "CouplingComparison",
    "Machine",
    "MachineRun",
    "Model",
    "Result",
    "compare",
    "diagnose",
    "identify",
    "model",
    "plot_trend",
    "read_machine",
    "read_run",
    "simulate",
]

_PLACES = {
    "CausesFound": "rotorundown.diagnosis",
    "CouplingComparison": "rotorundown.comparison",
    "Machine": "estimator.machine.document",
    "Model": "rotorundown.machine_model",
    "Result": "rotorundown.result",
    "MachineRun": "rotorundown.runs",
    "compare": "rotorundown.comparison",
    "diagnose": "rotorundown.diagnosis",
    "identify": "rotorundown.identification",
    "model": "rotorundown.updated_models",
    "plot_trend": "rotorundown.plots.trend",
    "read_machine": "rotorundown.machine_files",
    "read_run": "rotorundown.runs",
    "simulate": "rotorundown.simulation",
}
"""Module of each public name: importing numpy and scipy takes a second that `import` alone must not spend."""

require_own_packages()


def __getattr__(name: str) -> Any:
    """Return a public name, importing its module on first use. Raises AttributeError with close matches."""
    if name not in _PLACES:
        from estimator.close_matches import did_you_mean

        raise AttributeError(f"rotorundown has no '{name}'{did_you_mean(name, __all__)}")
    # A module of the package may have the same name as a function; the function is what the user asks for.
    found = getattr(import_module(_PLACES[name]), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    """List the public names."""
    return sorted(__all__)
