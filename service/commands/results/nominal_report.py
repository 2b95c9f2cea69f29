"""Reports what a document alone gives, before any run: critical speeds, natural frequencies, and what a calibration adds."""

from typing import Any

import numpy as np

from rotorundown.machine_model import Model
from service.commands.results.model_report import impact_test_lines
from service.commands.results.result_content import critical_speed_content, impact_test_content, model_content


def nominal_text(model: Model, *, service_rpm: float, grade: float) -> str:
    """Return the report, which says that no run was measured. service_rpm: service speed [r/min]; grade: G wanted [mm/s]."""
    parts = [origin_words(model), str(model.critical_speeds()), str(model.campbell()), str(model.modes(service_rpm))]
    if _is_excited(model):
        asked = (model.response(service_rpm), model.coupling_loads(service_rpm), model.balance(service_rpm))
        parts += [*map(str, asked), str(model.balance_grades(service_rpm, grade=grade))]
    else:
        parts.append("Unbalances are not known: response, loads of couplings and balance need a run")
    parts.append("\n".join(impact_test_lines(model.updated)))
    return "\n\n".join(part for part in parts if part)


def nominal_content(model: Model, *, service_rpm: float, grade: float) -> dict[str, Any]:
    """Return the same by names: with the results of a model where a calibration holds unbalances."""
    diagram = model.campbell()
    found = {
        "machine": model.machine.id,
        "nominal": not np.any(model.updated.covariance),
        "origin": origin_words(model),
        "service_rpm": service_rpm,
        "critical_speeds": critical_speed_content(model),
        "campbell": {
            "speed_rpm": diagram.speed_rpm,
            "modes": [
                {
                    "frequency_cpm": diagram.frequency_cpm[:, mode],
                    "damping_ratio": diagram.si.damping_ratio[:, mode],
                    "whirl": diagram.si.whirl[:, mode],
                }
                for mode in range(diagram.frequency_cpm.shape[1])
            ],
        },
        "modes": list(model.modes(service_rpm)),
    }
    if not _is_excited(model):
        return found | impact_test_content(model)
    at = model.response(service_rpm)
    response = [
        {"channel": channel, "um_pp": amplitude, "lag_deg": lag}
        for channel, amplitude, lag in zip(at.channels, at.amplitude_um_pp[0], at.phase_lag_deg[0], strict=True)
    ]
    return found | {"response": response} | model_content(model, service_rpm=service_rpm, grade=grade)


def origin_words(model: Model) -> str:
    """Return where the values come from, no run being given."""
    if model.machine.calibration is None:
        return "No run is given: these are the document's nominal values, nothing of them is identified"
    return "No run is given: these are the values of the document's calibration, all others are nominal"


def _is_excited(model: Model) -> bool:
    return bool(np.any(model.updated.excitations))
